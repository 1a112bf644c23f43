//! A test of this program run as a process of its own, to be killed or to go without something.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Names the folder that the child works on; without it the child's test has nothing to do.
const FOLDER: &str = "LTC_TEST_FOLDER";

/// In the child: its folder.
pub fn folder() -> Option<PathBuf> {
    std::env::var_os(FOLDER).map(PathBuf::from)
}

/// In the parent: the command that runs one test of this program on a folder.
pub fn command(test: &str, folder: &Path) -> Command {
    with(Command::new(std::env::current_exe().unwrap()), test, folder)
}

/// The same behind a command that runs the one after it.
pub fn with(mut command: Command, test: &str, folder: &Path) -> Command {
    command.args([test, "--exact", "--nocapture"]).env(FOLDER, folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// # Panics
/// Unless the child's one test passed.
pub fn assert_passed(output: &Output) {
    let [said, complained] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success() && said.contains("1 passed"), "{said}\n{complained}");
}
