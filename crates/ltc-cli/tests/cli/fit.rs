//! `ltc fit`: what it makes, and what it refuses.

use std::path::Path;

use serde_json::Value;

use crate::support::{command, ltc, names_in, text};

/// A fit of a moment, every stage included.
const SMALL: &str = "
preset = 'ggx-isotropic'
name = 'small'
entries = { samples = 64, iterations = 10 }
joint = { steps = 20, queries = 64, samples = 32 }
channels = { samples = 256, queries = 100 }
measure = { samples = 256, queries = 100 }
[[axes]]
quantity = 'theta'
mapping = 'sqrt_one_minus_cos'
len = 6
[[axes]]
quantity = 'alpha'
mapping = 'sqrt'
len = 5
";

/// A specification file in a folder, `SMALL` with something more.
pub fn spec_file(folder: &Path, name: &str, more: &str) -> String {
    let path = folder.join(name);
    // What is added comes before the first section.
    std::fs::write(&path, format!("{more}\n{SMALL}")).unwrap();
    text(&path).to_owned()
}

#[test]
fn a_specification_makes_a_version_and_again_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (spec, output) = (spec_file(folder.path(), "small.toml", ""), folder.path().join("tables"));
    let args = ["fit", &spec, "-o", text(&output), "--json"];
    let manifest = ltc(&args).json();
    assert_eq!((&manifest["name"], &manifest["version"]), (&"small".into(), &1.into()));
    assert_eq!(manifest["axes"][1]["len"], 5);
    assert_eq!(names_in(&output), ["small"], "no checkpoint is left");
    assert_eq!(names_in(&output.join("small")), ["1"]);
    assert_eq!(names_in(&output.join("small/1")), ["manifest.json", "table.npz"]);
    // What was written is what was told, and whole: its digest is checked on reading.
    let digest = manifest["digest"].as_str().unwrap();
    assert_eq!(ltc(&["inspect", digest, "--json", "--tables", text(&output)]).json(), manifest);
    // The same specification is the same table, on any number of threads.
    let again = ltc(&[&args[..], &["--threads", "3"]].concat()).good();
    assert!(again.err.contains("version 1 is this very table"), "{}", again.err);
    assert_eq!(serde_json::from_str::<Value>(&again.out).unwrap(), manifest);
    assert_eq!(names_in(&output.join("small")), ["1"]);
    // Another one of the same name is the next version.
    let other = spec_file(folder.path(), "other.toml", "joint.seed = 9").replace("\\", "/");
    std::fs::write(&other, SMALL.replace("steps = 20", "steps = 21")).unwrap();
    assert_eq!(ltc(&["fit", &other, "-o", text(&output), "--json"]).json()["version"], 2);
    ltc(&["verify", "small@1", "--refit", "--tables", text(&output)]).good();
}

#[test]
fn a_preset_makes_a_table_as_good_as_the_shipped_one() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = ltc(&["fit", "ggx-isotropic", "-o", text(folder.path()), "--json"]).json();
    let tv = |m: &Value| m["errors"]["standard_draw"]["tv_mean"].as_f64().unwrap();
    let shipped = ltc(&["inspect", "ggx-isotropic", "--json"]).json();
    assert!((tv(&manifest) - tv(&shipped)).abs() < 1e-3, "{} {}", tv(&manifest), tv(&shipped));
}

#[test]
fn a_printed_preset_is_a_specification() {
    let folder = tempfile::tempdir().unwrap();
    for preset in ["ggx-isotropic", "ggx-anisotropic"] {
        let printed = ltc(&["fit", "--print-spec", preset]).good().out;
        assert!(printed.contains("# Samples of each lobe.\nsamples = "), "{printed}");
        let file = folder.path().join("printed.toml");
        std::fs::write(&file, printed).unwrap();
        let of = |what: &str| ltc(&["fit", what, "--print-spec", "--json"]).json();
        assert_eq!(of(text(&file)), of(preset));
    }
    assert_eq!(names_in(folder.path()), ["printed.toml"]);
}

#[test]
fn a_report_has_every_entry_and_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (spec, output) = (spec_file(folder.path(), "small.toml", ""), folder.path().join("tables"));
    let reports = folder.path().join("reports");
    let run = ltc(&["fit", &spec, "-o", text(&output), "--report", text(&reports)]).good();
    assert!(run.out.contains("million lobe samples a second") && run.out.contains("the best single LTC"));
    assert_eq!(names_in(&reports), ["small-1.json", "small-1.png"]);
    assert_eq!(names_in(&output.join("small/1")), ["manifest.json", "table.npz"], "the version is as ever");
    let report: Value =
        serde_json::from_slice(&std::fs::read(reports.join("small-1.json")).unwrap()).unwrap();
    assert_eq!(report["entries"].as_array().unwrap().len(), 30);
    assert_eq!(report["centre_tv"].as_array().unwrap().len(), 20);
    let manifest = ltc(&["inspect", "small", "--json", "--tables", text(&output)]).json();
    let [table, optimum] =
        ["table_tv_mean", "optimum_tv_mean"].map(|key| report["draw"][key].as_f64().unwrap());
    assert!((table - manifest["errors"]["standard_draw"]["tv_mean"].as_f64().unwrap()).abs() < 1e-12);
    assert!(0.0 < optimum && optimum < table, "{optimum} {table}");
    let queries = |value: &Value| value["queries"].as_u64().unwrap();
    let regions = report["regions"].as_array().unwrap();
    assert_eq!(
        regions.iter().map(queries).sum::<u64>(),
        queries(&report["draw"]),
        "each query in one region"
    );
    for entry in report["entries"].as_array().unwrap() {
        for key in ["theta", "alpha", "tv", "leak", "condition", "tv_alone", "iterations"] {
            assert!(entry[key].as_f64().unwrap() >= 0.0, "{key}: {entry}");
        }
        assert!(entry["stop"] == "converged" || entry["stop"] == "iterations", "{entry}");
    }
    let png = std::fs::read(reports.join("small-1.png")).unwrap();
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
}

#[test]
fn machines_get_lines_and_nobody_else_gets_progress() {
    let folder = tempfile::tempdir().unwrap();
    let spec = spec_file(folder.path(), "small.toml", "");
    let plain = ltc(&["fit", &spec, "-o", text(&folder.path().join("a"))]).good();
    assert_eq!(plain.err.lines().count(), 1, "{}", plain.err);
    let json = ltc(&["fit", &spec, "-o", text(&folder.path().join("b")), "--json"]).good();
    let lines: Vec<Value> = json.err.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let progress: Vec<&Value> = lines.iter().filter(|line| line["event"] == "progress").collect();
    let stages = ["entries", "joint refinement", "magnitude and Fresnel", "measurement"];
    for stage in stages {
        assert!(progress.iter().any(|line| line["stage"] == stage), "{stage}");
    }
    let fractions: Vec<f64> = progress.iter().map(|line| line["fraction"].as_f64().unwrap()).collect();
    assert!(fractions.is_sorted() && fractions.last() == Some(&1.0), "{fractions:?}");
}

#[test]
fn what_cannot_be_fitted_or_stored_is_told_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("tables");
    ltc(&["fit", "phong", "-o", text(&output)]).refused(&["no preset named \"phong\"", "ggx-isotropic"]);
    ltc(&["fit", "none.toml", "-o", text(&output)]).refused(&["none.toml"]);
    ltc(&["fit", text(folder.path()), "-o", text(&output)]).refused(&[text(folder.path())]);
    assert!(!output.exists(), "nothing is made for a fit that there is not");
    std::fs::write(&output, "a file").unwrap();
    ltc(&["fit", "ggx-isotropic", "-o", text(&output)]).refused(&[text(&output)]);
    assert_eq!(std::fs::read_to_string(&output).unwrap(), "a file");
    ltc(&["fit", "ggx-isotropic"]).misused(&["required"]);
}

#[test]
fn a_specification_that_makes_no_sense_names_line_field_and_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |more: &str, words: &[&str]| {
        let spec = spec_file(folder.path(), "wrong.toml", more);
        let all = [&["wrong.toml: line 1: "], words].concat();
        ltc(&["fit", &spec, "-o", text(&folder.path().join("tables"))]).refused(&all);
    };
    refused("speed = 3", &["speed: unknown field"]);
    refused("objective = 7", &["objective: invalid type"]);
    refused("floors.alpha = nan", &["floors.alpha: is NaN, must be in"]);
    refused("floors.theta_max = 1.6", &["floors.theta_max: is 1.6, must be in [1, π/2)"]);
    refused("name =", &["wrong.toml: line 1: "]);
    assert!(!folder.path().join("tables").exists());
}

#[test]
fn what_is_too_large_is_refused_with_the_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("large.toml");
    let refused = |content: String, words: &[&str]| {
        std::fs::write(&spec, content).unwrap();
        ltc(&["fit", text(&spec), "-o", text(&folder.path().join("tables"))]).refused(words);
    };
    let large = SMALL.replace("len = 6", "len = 2000").replace("len = 5", "len = 1500");
    refused(large, &["3000000 entries would take about", "MiB of memory", "--no-limits"]);
    let larger = SMALL.replace("len = 6", "len = 4096").replace("len = 5", "len = 4096");
    refused(larger, &["axes: have 16777216 nodes in all, must have at most"]);
    refused(
        SMALL.replace("steps = 20", "steps = 1000000").replace("queries = 64", "queries = 1000000"),
        &["30 entries would take about", " h on one core", "24 h"],
    );
}

#[test]
fn fits_into_the_same_folder_do_not_meet() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("tables");
    let same = spec_file(folder.path(), "same.toml", "");
    let other = folder.path().join("other.toml");
    std::fs::write(&other, SMALL.replace("steps = 20", "steps = 22")).unwrap();
    let specs = [&same, &same, text(&other), &same, text(&other)];
    let running: Vec<_> =
        specs.iter().map(|spec| command(&["fit", spec, "-o", text(&output)]).spawn().unwrap()).collect();
    for child in running {
        let ended = child.wait_with_output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    }
    assert_eq!(names_in(&output), ["small"]);
    assert_eq!(names_in(&output.join("small")), ["1", "2"], "each table once");
    for table in ["small@1", "small@2"] {
        ltc(&["verify", table, "--tables", text(&output)]).good();
    }
}
