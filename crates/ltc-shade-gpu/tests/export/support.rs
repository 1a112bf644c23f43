//! Outside programs.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Whether the program is here. With `CI` set a missing one fails the test; otherwise a word is said about it.
pub fn has(program: &str) -> bool {
    let found =
        Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !found {
        let hint = "`cargo xtask setup` installs it";
        assert!(std::env::var_os("CI").is_none(), "{program} is missing: {hint}");
        eprintln!("skipped, because {program} is missing: {hint}");
    }
    found
}

/// What a program says of a file, when it refuses it.
pub fn verdict(program: &str, args: &[&str], file: &Path) -> Result<(), String> {
    let Output { status, stdout, stderr } = Command::new(program).args(args).arg(file).output().unwrap();
    if status.success() {
        return Ok(());
    }
    let said = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    Err(format!("{program} refuses {}: {}", file.display(), said.concat()))
}

/// Does `work` on all items, on two threads, and gives the errors.
pub fn errors<T: Sync>(items: &[T], work: impl Fn(usize, &T) -> Result<(), String> + Sync) -> Vec<String> {
    let half = items.len().div_ceil(2).max(1);
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = items
            .chunks(half)
            .enumerate()
            .map(|(part, chunk)| {
                scope.spawn(move || {
                    let each = chunk.iter().enumerate().map(|(i, item)| work(part * half + i, item));
                    each.filter_map(Result::err).collect::<Vec<_>>()
                })
            })
            .collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    })
}

/// Runs a program that is not to fail.
pub fn run_program(program: &str, args: &[&str]) -> String {
    let Output { status, stdout, stderr } = Command::new(program).args(args).output().unwrap();
    let [stdout, stderr] = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(status.success(), "{program} {args:?}: {stdout}{stderr}");
    stdout
}

/// The folder `examples/hosts`.
pub fn hosts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/hosts")
}

/// SplitMix64 (Steele, Lea, Flood 2014), as numbers in [0, 1).
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
