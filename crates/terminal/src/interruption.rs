//! Ctrl-C and the signal to terminate, from the first line of a program to its last.
//!
//! A signal stops an analysis under way, which then says what there is of its result; it lets a result be written that is written
//! within a tenth of a second. At any other time, and when it comes again, it ends the program at once. In no case is an unfinished file left.

use crate::failure::Failure;
use crate::signals::{self, Signal};
use crate::streams::say;
use kingpin_report::abandon_unfinished;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time after which an analysis that a signal has not stopped yet is worth a word.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time after which a result that is not written yet is given up.
const DELIVERY: Duration = Duration::from_millis(100);

/// What the program is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Reading what is asked for; nothing has been written.
    Preparation,
    /// An analysis that looks at the flag.
    Analysis,
    /// Writing the result.
    Delivery,
}

/// What the program is at, and the last signal that came.
static STATE: Mutex<(Stage, Option<Signal>)> = Mutex::new((Stage::Preparation, None));
/// The flag at which the analysis looks.
static STOP: AtomicBool = AtomicBool::new(false);

/// An analysis that a signal stops.
#[derive(Clone, Copy, Debug)]
pub struct Interruption(());

impl Interruption {
    /// Listens to signals from now on. Until there is an analysis they end the program at once.
    ///
    /// # Errors
    /// [`Failure::Signals`] where that is not possible.
    pub fn listen() -> Result<(), Failure> {
        signals::listen(received).map_err(Failure::Signals)
    }

    /// Runs something that goes on until a signal sets the flag; when the signal comes again it ends the program.
    pub fn during<T>(work: impl FnOnce(&'static AtomicBool) -> T) -> T {
        let interruption = Self::of_analysis();
        let outcome = work(interruption.flag());
        interruption.analysis_has_ended();
        outcome
    }

    /// From now on a signal stops the analysis by the flag; when it comes again it ends the program.
    pub(crate) fn of_analysis() -> Self {
        enter(Stage::Analysis);
        Self(())
    }

    /// From now on a signal ends the program at once again.
    pub(crate) fn analysis_has_ended(self) {
        enter(Stage::Delivery);
    }

    /// The flag.
    pub(crate) fn flag(self) -> &'static AtomicBool {
        &STOP
    }

    /// The exit code of a program that a signal has stopped; `None` where there was none.
    pub(crate) fn exit_code() -> Option<u8> {
        STATE.lock().unwrap_or_else(PoisonError::into_inner).1.map(Signal::exit_code)
    }

    /// That no signal came on the way along a branch, whose result has been delivered.
    ///
    /// # Errors
    /// [`Failure::BranchInterrupted`].
    pub fn check_branch(self) -> Result<(), Failure> {
        if STOP.load(Ordering::Relaxed) { Err(Failure::BranchInterrupted) } else { Ok(()) }
    }
}

fn enter(stage: Stage) {
    STATE.lock().unwrap_or_else(PoisonError::into_inner).0 = stage;
}

/// Says what can be done where an analysis does not stop soon.
fn tell_patience() {
    std::thread::sleep(PATIENCE);
    if STATE.lock().unwrap_or_else(PoisonError::into_inner).0 == Stage::Analysis {
        say("note", "it stops after the step that it is at; once more ends it at once, without a result");
    }
}

/// What happens when a signal has come, on a thread of its own.
fn received(signal: Signal) {
    let (stage, is_first) = {
        let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
        (state.0, state.1.replace(signal).is_none())
    };
    match stage {
        Stage::Analysis if !STOP.swap(true, Ordering::Relaxed) => {
            std::thread::spawn(tell_patience);
            return;
        }
        // A result that was computed is not thrown away where it is written soon.
        Stage::Delivery if is_first => std::thread::sleep(DELIVERY),
        _ => {}
    }
    // The program ends before anything else can be begun.
    let _nothing_is_begun = abandon_unfinished();
    say(
        "error",
        match stage {
            Stage::Preparation => "interrupted; nothing was written",
            Stage::Analysis => {
                "interrupted again, ended at once: no result was written; what a journal has is kept"
            }
            Stage::Delivery => {
                "interrupted while the result was written: files that were told of are whole, no other was touched"
            }
        },
    );
    std::process::exit(signal.exit_code().into());
}
