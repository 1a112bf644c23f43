//! Help, and misuse.

use crate::support::ltc;

const VERBS: [&str; 16] = [
    "serve",
    "fit",
    "tables",
    "inspect",
    "diff",
    "verify",
    "lookup",
    "integrate",
    "export",
    "render",
    "shader",
    "probe",
    "bench",
    "token",
    "backup",
    "restore",
];

#[test]
fn every_verb_is_listed_and_its_help_has_an_example() {
    let all = ltc(&["--help"]).good().out;
    let listed = |verb: &str| all.lines().any(|line| line.trim_start().starts_with(&format!("{verb} ")));
    for verb in VERBS {
        assert!(listed(verb), "{verb} is not in {all}");
        let help = ltc(&[verb, "--help"]).good().out;
        // The example may be broken into several lines.
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        let example = words.split_once("Example: ").map(|(_, rest)| rest.split(" Usage: ").next().unwrap());
        assert!(example.is_some_and(|e| e.contains(&format!("ltc {verb}"))), "{verb}: {help}");
    }
    let known = all.split_once("Commands:").unwrap().1.split_once("Options:").unwrap().0;
    let is_verb = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
    assert_eq!(known.lines().filter(is_verb).count(), VERBS.len() + 1, "a verb is not tested here: {known}");
}

#[test]
fn misuse_is_told_from_failure() {
    ltc(&["nonsense"]).misused(&["nonsense"]);
    ltc(&["lookup"]).misused(&["required"]);
    ltc(&["export", "ggx-isotropic", "--format", "tga", "-o", "x"]).misused(&["tga"]);
    ltc(&["export", "ggx-isotropic", "--format", "npz", "--precision", "f8", "-o", "x"]).misused(&["f8"]);
    ltc(&["export", "ggx-isotropic", "--format", "npz", "--crop", "beta=0..1", "-o", "x"]).misused(&["beta"]);
    ltc(&["export", "ggx-isotropic", "--format", "npz", "--channels", "colour", "-o", "x"])
        .misused(&["colour"]);
    ltc(&["integrate", "--precision", "f16"]).misused(&["f16"]);
    ltc(&["fit", "ggx-isotropic", "-o", "x", "--threads", "0"]).misused(&["threads"]);
}
