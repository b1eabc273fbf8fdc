//! Writing that a flag stops, for whoever waits for it.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// A writer that fails once a flag is set.
#[derive(Debug)]
pub struct Stoppable<'a, W> {
    out: W,
    stop: &'a AtomicBool,
}

impl<'a, W: Write> Stoppable<'a, W> {
    /// Writes to another writer until the flag is set.
    pub fn new(out: W, stop: &'a AtomicBool) -> Self {
        Self { out, stop }
    }
}

impl<W: Write> Write for Stoppable<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Not the error `Interrupted`, after which one tries again.
        if self.stop.load(Ordering::Relaxed) {
            Err(io::Error::other("stopped"))
        } else {
            self.out.write(bytes)
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
