//! Running `ltc`, and what every refusal must hold.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

/// What a run left.
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// `ltc` with these arguments, away from the user's own settings.
pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ltc"));
    for variable in ["RUST_LOG", "RUST_BACKTRACE"] {
        command.env_remove(variable);
    }
    for (variable, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("LTC_")) {
        command.env_remove(variable);
    }
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs `ltc` to its end.
pub fn ltc(args: &[&str]) -> Run {
    finish(command(args).spawn().unwrap())
}

/// Runs `ltc` with these lines on stdin.
pub fn ltc_with(args: &[&str], input: &str) -> Run {
    let mut child = command(args).stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let run = finish(child);
    writer.join().unwrap().unwrap();
    run
}

fn finish(child: std::process::Child) -> Run {
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

impl Run {
    /// It went well and said what it said on stdout.
    pub fn good(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }

    /// Stdout as one JSON document.
    pub fn json(self) -> Value {
        let run = self.good();
        serde_json::from_str(&run.out).unwrap_or_else(|e| panic!("{e}: {}", run.out))
    }

    /// Stdout as JSON lines.
    pub fn lines(self) -> Vec<Value> {
        let run = self.good();
        run.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// It was refused: exit code 1, nothing on stdout, one line on stderr that holds these words.
    pub fn refused(self, words: &[&str]) {
        assert_eq!((self.code, self.out.as_str()), (Some(1), ""), "{}", self.err);
        // A graphics driver may have had its own say before.
        let said: Vec<&str> = self.err.lines().filter(|line| !line.contains("XDG_RUNTIME_DIR")).collect();
        assert!(said.len() == 1 && said[0].starts_with("error: "), "{}", self.err);
        for word in words {
            assert!(said[0].contains(word), "no {word:?} in {}", said[0]);
        }
        let causes: Vec<&str> = said[0].split(": ").collect();
        let repeated = causes.iter().enumerate().any(|(i, cause)| causes[..i].contains(cause));
        assert!(!repeated, "a cause is told twice: {}", said[0]);
    }

    /// Clap refused the arguments: exit code 2, nothing on stdout, the cause on the first line of stderr.
    pub fn misused(self, words: &[&str]) {
        assert_eq!((self.code, self.out.as_str()), (Some(2), ""), "{}", self.err);
        let first = self.err.lines().next().unwrap();
        assert!(first.starts_with("error: "), "{}", self.err);
        for word in words {
            assert!(first.contains(word), "no {word:?} in {first}");
        }
    }
}

/// Names of what lies in a folder, sorted.
pub fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A path as an argument.
pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The numbers of a JSON array.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}
