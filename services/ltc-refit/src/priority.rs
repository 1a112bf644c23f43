//! Threads that run when nobody else wants to.

/// Lowers the priority of the calling thread as far as it goes: whoever answers requests gets the cores first. Where the
/// system does not let it, the thread runs as any other.
#[cfg(target_os = "linux")]
pub(crate) fn lower() {
    /// The largest niceness there is.
    const NICEST: i32 = 19;
    // On Linux the process of number 0 is the calling thread alone.
    let _ = rustix::process::setpriority_process(None, NICEST);
}

/// Threads have no priority of their own here.
#[cfg(not(target_os = "linux"))]
pub(crate) fn lower() {}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn only_the_thread_itself_gets_nicer() {
        let of = || rustix::process::getpriority_process(None).unwrap();
        let before = of();
        let nicest = std::thread::spawn(move || {
            super::lower();
            of()
        });
        assert_eq!(nicest.join().unwrap(), 19);
        assert_eq!(of(), before);
        assert!(before < 19, "the test cannot tell");
    }
}
