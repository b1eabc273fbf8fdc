//! Ctrl-C.

use crate::failure::Failure;
use std::sync::atomic::{AtomicBool, Ordering};

/// The flag that Ctrl-C sets, so that a run stops after the part that it is at; pressed again it ends the program.
#[derive(Clone, Copy, Debug)]
pub struct Interruption(&'static AtomicBool);

impl Interruption {
    /// Listens to Ctrl-C from now on.
    ///
    /// # Errors
    /// [`Failure::Signals`] where that is not possible.
    pub fn watch() -> Result<Self, Failure> {
        static INTERRUPTED: AtomicBool = AtomicBool::new(false);
        /// The exit code of programs that end by the signal SIGINT.
        const ENDED_BY_SIGNAL: i32 = 130;
        ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(ENDED_BY_SIGNAL);
            }
        })
        .map_err(Failure::Signals)?;
        Ok(Self(&INTERRUPTED))
    }

    /// The flag.
    pub fn flag(self) -> &'static AtomicBool {
        self.0
    }

    /// That nobody pressed Ctrl-C on the way along a branch, whose result has been delivered.
    ///
    /// # Errors
    /// [`Failure::BranchInterrupted`].
    pub fn check_branch(self) -> Result<(), Failure> {
        if self.0.load(Ordering::Relaxed) { Err(Failure::BranchInterrupted) } else { Ok(()) }
    }
}
