//! Fits that are interrupted and go on.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use serde_json::Value;

use crate::fit::spec_file;
use crate::support::{command, ltc, names_in, text};

/// A specification that takes some seconds, most of them in the joint refinement.
fn slow(folder: &Path) -> String {
    let path = spec_file(folder, "slow.toml", "");
    let content = std::fs::read_to_string(&path).unwrap();
    let content = content
        .replace("len = 6", "len = 24")
        .replace("len = 5", "len = 24")
        .replace("samples = 64, iterations = 10", "samples = 512, iterations = 40")
        .replace("steps = 20, queries = 64, samples = 32", "steps = 400, queries = 1024, samples = 128");
    std::fs::write(&path, content).unwrap();
    path
}

/// A fit at work.
struct Running {
    child: Child,
    stderr: BufReader<std::process::ChildStderr>,
}

impl Running {
    fn start(spec: &str, output: &Path) -> Self {
        let mut child = command(&["fit", spec, "-o", text(output), "--json"]).spawn().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        Self { child, stderr }
    }

    /// Reads what it says up to a line that is waited for; all that it said.
    fn until(&mut self, wanted: impl Fn(&Value) -> bool) -> Vec<Value> {
        let mut said = Vec::new();
        loop {
            let mut line = String::new();
            assert!(self.stderr.read_line(&mut line).unwrap() > 0, "it ended before: {said:?}");
            let value: Value = serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"));
            let found = wanted(&value);
            said.push(value);
            if found {
                return said;
            }
        }
    }

    fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.child.id().to_string()]).status().unwrap().success());
    }

    /// The exit code and the last words.
    fn end(mut self) -> (Option<i32>, String) {
        let code = self.child.wait().unwrap().code();
        let mut rest = String::new();
        std::io::Read::read_to_string(&mut self.stderr, &mut rest).unwrap();
        (code, rest.lines().last().unwrap_or_default().to_owned())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It has ended already unless a test failed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn at(stage: &'static str, from: u64) -> impl Fn(&Value) -> bool {
    move |line| line["stage"] == stage && line["done"].as_u64() >= Some(from)
}

/// The one checkpoint of a folder of tables.
fn checkpoint(output: &Path) -> PathBuf {
    let all = output.join(".checkpoints");
    let names = names_in(&all);
    assert_eq!(names.len(), 1, "{names:?}");
    all.join(&names[0]).join("state")
}

fn resumed(said: &[Value]) -> bool {
    said.iter()
        .any(|line| line["text"].as_str().is_some_and(|text| text.contains("going on from a checkpoint")))
}

#[test]
fn kills_and_interruptions_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (spec, output) = (slow(folder.path()), folder.path().join("tables"));
    let whole = folder.path().join("whole");
    let expected = ltc(&["fit", &spec, "-o", text(&whole), "--json", "--threads", "1"]).json();

    // Killed among the entries, before there is anything to go on from; then amid the refinement, again and again.
    let mut running = Running::start(&spec, &output);
    running.until(at("entries", 1));
    running.signal("-KILL");
    running.end();
    // Asked to end, it keeps what is done and says how to go on.
    let moments = [(1, "-KILL"), (30, "-INT"), (60, "-KILL"), (90, "-TERM"), (120, "-KILL")];
    for (round, (from, signal)) in moments.into_iter().enumerate() {
        let mut running = Running::start(&spec, &output);
        let said = running.until(at("joint refinement", from));
        assert!(round == 0 || resumed(&said), "{said:?}");
        running.signal(signal);
        let (code, words) = running.end();
        if signal != "-KILL" {
            assert_eq!(code, Some(if signal == "-INT" { 130 } else { 143 }), "{words}");
            assert!(words.starts_with("interrupted; the same command goes on from here"), "{words}");
        }
        assert_eq!(names_in(&output), [".checkpoints"], "no table, nothing else");
        checkpoint(&output);
    }
    let run = ltc(&["fit", &spec, "-o", text(&output), "--json", "--threads", "2"]).good();
    let said: Vec<Value> = run.err.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(resumed(&said), "{said:?}");
    let manifest: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(manifest["digest"], expected["digest"]);
    assert_eq!(manifest["errors"], expected["errors"]);
    assert_eq!(names_in(&output), ["small"], "the checkpoint is gone");
}

#[test]
fn a_spoilt_checkpoint_is_ignored_and_a_fresh_start_asks_for_none() {
    let folder = tempfile::tempdir().unwrap();
    let (spec, output) = (slow(folder.path()), folder.path().join("tables"));
    let interrupt = || {
        let mut running = Running::start(&spec, &output);
        running.until(at("joint refinement", 2));
        running.signal("-INT");
        assert_eq!(running.end().0, Some(130));
    };
    interrupt();
    let file = checkpoint(&output);
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, bytes).unwrap();
    let mut running = Running::start(&spec, &output);
    let said = running.until(at("entries", 1));
    let ignored =
        |line: &Value| line["text"].as_str().is_some_and(|text| text.contains("ignored: it is damaged"));
    assert!(said.iter().any(ignored) && !resumed(&said), "{said:?}");
    running.until(at("joint refinement", 2));
    running.signal("-INT");
    running.end();
    // From the beginning although there is a checkpoint.
    let run = ltc(&["fit", &spec, "-o", text(&output), "--fresh"]).good();
    assert!(!run.err.contains("going on"), "{}", run.err);
    assert_eq!(names_in(&output), ["small"]);
}
