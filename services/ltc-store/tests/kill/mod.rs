//! Processes killed at random moments.

use std::io::{BufRead, BufReader};
use std::process::Child;
use std::time::{Duration, Instant};

/// What a child says at the beginning of lines that are meant for its parent.
pub const MARK: &str = "child: ";

/// Waits for the child's first line, lets it work for a while, and kills it. What it said after the first line.
pub fn kill_after(mut child: Child, time: Duration) -> Vec<String> {
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let first = lines.by_ref().find(|line| line.contains(MARK));
    assert!(first.is_some(), "the child said nothing");
    let start = Instant::now();
    // On Unix this is SIGKILL, which no process sees coming.
    std::thread::sleep(time.saturating_sub(start.elapsed()));
    child.kill().unwrap();
    child.wait().unwrap();
    lines.filter_map(|line| line.split_once(MARK).map(|(_, said)| said.to_owned())).collect()
}

/// Moments in a range, the same in each run of the test; what the machine does in them is not.
pub fn moments(count: u32, range: std::ops::Range<u64>) -> impl Iterator<Item = Duration> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..count).map(move |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        Duration::from_micros(range.start + state % (range.end - range.start))
    })
}
