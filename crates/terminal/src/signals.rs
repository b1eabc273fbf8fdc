//! The signals that ask a program to end, told on a thread of their own, where everything is allowed.

use std::io;

/// A signal that asks the program to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Signal {
    /// Ctrl-C.
    Interrupt,
    /// What `kill` and batch systems send; only where there are such signals.
    #[cfg_attr(not(unix), expect(dead_code, reason = "there are no such signals there"))]
    Terminate,
}

impl Signal {
    /// The exit code of a program that it ended, as shells have it: 128 and the number of the signal.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Interrupt => 130,
            Self::Terminate => 143,
        }
    }
}

/// Tells every signal from now on.
///
/// # Errors
/// The signals cannot be listened to.
#[cfg(unix)]
pub(crate) fn listen(tell: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for number in signals.forever() {
            tell(if number == SIGTERM { Signal::Terminate } else { Signal::Interrupt });
        }
    })?;
    Ok(())
}

/// Tells every Ctrl-C from now on.
///
/// # Errors
/// It cannot be listened to.
#[cfg(not(unix))]
pub(crate) fn listen(tell: impl Fn(Signal) + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(move || tell(Signal::Interrupt)).map_err(io::Error::other)
}
