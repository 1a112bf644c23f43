//! How much memory the process keeps that nothing uses.

/// From so many bytes on an allocation is pages of its own. A table's file in any form is larger, what a request takes is smaller.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const OF_ITS_OWN: i32 = 64 << 10;

/// Lets all threads of this process share two heaps, and gives large files pages of their own. To be called before there is a second
/// thread; later it does little.
///
/// The C library of Linux gives threads heaps of their own, eight for each processor, and memory that was let go of in one of them serves no
/// other. Threads come and go with refits and differences, and large files are made on one and let go of on another. It also learns
/// from the first large file that was let go of to keep as large ones in the heap, where holes are left that no later one fits. By
/// both, a service's memory would grow for hours (`tests/load/soak.py`). Whoever has set `MALLOC_ARENA_MAX` or `GLIBC_TUNABLES` knows
/// better.
pub fn share_heaps() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if ["MALLOC_ARENA_MAX", "GLIBC_TUNABLES"].iter().all(|name| std::env::var_os(name).is_none()) {
        for (setting, value) in [(libc::M_ARENA_MAX, 2), (libc::M_MMAP_THRESHOLD, OF_ITS_OWN)] {
            #[expect(unsafe_code, reason = "the C library's allocator is set by calls of C")]
            // SAFETY: it takes two numbers and may be called at any time; a refusal changes nothing.
            let _ = unsafe { libc::mallopt(setting, value) };
        }
    }
}

/// Gives pages of the heaps that nothing is on back to the system: the C library keeps those that lie below others. The heaps
/// are small, so that this takes about a millisecond.
pub(crate) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        #[expect(unsafe_code, reason = "the C library's allocator is asked by a call of C")]
        // SAFETY: it takes a number, may be called at any time by any thread, and moves nothing that is in use.
        let _ = unsafe { libc::malloc_trim(0) };
    }
}
