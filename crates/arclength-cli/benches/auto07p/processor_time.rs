//! Processor time of this process and of those that it has started and waited for.

/// Whose time.
#[derive(Clone, Copy)]
pub(crate) enum Of {
    ThisProcess,
    Children,
}

/// Processor time used so far, by user and system together, in seconds.
pub(crate) fn used(of: Of) -> f64 {
    let who = match of {
        Of::ThisProcess => libc::RUSAGE_SELF,
        Of::Children => libc::RUSAGE_CHILDREN,
    };
    let mut usage = std::mem::MaybeUninit::<libc::rusage>::zeroed();
    // SAFETY: the pointer is to memory of this type, and zeros are a value of it.
    let usage = unsafe {
        libc::getrusage(who, usage.as_mut_ptr());
        usage.assume_init()
    };
    [usage.ru_utime, usage.ru_stime].iter().map(|time| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64).sum()
}

/// The result of a computation and the processor time that it took, in seconds.
///
/// # Errors
/// Those of the computation.
pub(crate) fn of<T>(whose: Of, run: impl FnOnce() -> Result<T, String>) -> Result<(T, f64), String> {
    let before = used(whose);
    let result = run()?;
    Ok((result, used(whose) - before))
}

/// The middle one of some times.
pub(crate) fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
