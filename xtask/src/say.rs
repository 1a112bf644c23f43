//! Words to the person who is watching.

use std::fmt::Display;
use std::io::Write as _;

/// Prints one line to standard output. A reader that has gone away (`… | head`) is no reason to stop the work.
pub fn say(line: impl Display) {
    let _ = writeln!(std::io::stdout().lock(), "{line}");
}

/// Prints one line to standard error, under the same rule.
pub fn complain(line: impl Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
