//! `ltc tables`, `inspect`, `verify`, and names that are no table's.

use crate::support::{command, ltc, names_in, text};

const NAMES: [&str; 8] = [
    "beckmann-isotropic",
    "charlie-sheen",
    "disney-diffuse",
    "ggx-anisotropic",
    "ggx-anisotropic-closed-form",
    "ggx-isotropic",
    "ggx-isotropic-dropin",
    "oren-nayar",
];

#[test]
fn tables_are_listed_and_inspected() {
    let listing = ltc(&["tables", "--json"]).json();
    let listed = listing["tables"].as_array().unwrap();
    assert_eq!(listed.iter().map(|t| t["name"].as_str().unwrap()).collect::<Vec<_>>(), NAMES);
    for table in listed {
        let name = table["name"].as_str().unwrap();
        assert!(table["versions"].as_array().unwrap().contains(&table["latest"]), "{table}");
        let manifest = ltc(&["inspect", name, "--json"]).json();
        assert_eq!((&manifest["name"], &manifest["version"]), (&table["name"], &table["latest"]));
        assert_eq!(manifest["digest"], table["digest"]);
        assert!(manifest["digest"].as_str().unwrap().starts_with("sha256:"));
        // The published GGX table's, and what one LTC can do for Beckmann.
        let bound = if name.starts_with("ggx") { 0.0996 } else { 0.13 };
        assert!(manifest["errors"]["standard_draw"]["tv_mean"].as_f64().unwrap() < bound);
        for field in ["axes", "channels", "lobes", "brdf", "fit", "created", "licence"] {
            assert!(!manifest[field].is_null(), "{name} has no {field}");
        }
        // By digest, and by number, it is the same.
        let digest = manifest["digest"].as_str().unwrap();
        let numbered = format!("{name}@{}", manifest["version"]);
        assert_eq!(ltc(&["inspect", digest, "--json"]).json(), manifest);
        assert_eq!(ltc(&["inspect", &numbered, "--json"]).json(), manifest);
        // For people, too.
        assert!(ltc(&["inspect", name]).good().out.contains(digest));
        assert!(ltc(&["tables"]).good().out.contains(digest));
    }
}

#[test]
fn unknown_tables_are_named_with_those_there_are() {
    let there_are =
        ["no table named \"nonesuch\"", "ggx-anisotropic, ggx-anisotropic-closed-form, ggx-isotropic"];
    ltc(&["inspect", "nonesuch"]).refused(&there_are);
    ltc(&["verify", "nonesuch"]).refused(&there_are);
    ltc(&["lookup", "--table", "nonesuch"]).refused(&there_are);
    ltc(&["export", "nonesuch", "--format", "npz", "-o", "never.npz"]).refused(&there_are);
    ltc(&["inspect", "ggx-isotropic@99"]).refused(&["has no version \"99\"", "latest"]);
    ltc(&["inspect", "line\nbreak"]).refused(&["line"]);
    assert!(!std::path::Path::new("never.npz").exists());
}

#[test]
fn verify_agrees_with_the_manifest() {
    let found = ltc(&["verify", "ggx-isotropic", "--json"]).json();
    assert_eq!(found["ok"], true, "{found}");
    assert_eq!(found["faults"].as_array().unwrap().len(), 0);
    let manifest = ltc(&["inspect", "ggx-isotropic", "--json"]).json();
    assert_eq!(found["digest"], manifest["digest"]);
    let tv = |errors: &serde_json::Value| errors["standard_draw"]["tv_mean"].as_f64().unwrap();
    assert!((tv(&found["errors"]) - tv(&manifest["errors"])).abs() < 1e-6);
}

/// A copy of a shipped table in a folder of its own, its manifest changed.
fn copy_with(change: impl Fn(&mut serde_json::Value)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let version = folder.path().join("ggx-isotropic/7");
    std::fs::create_dir_all(&version).unwrap();
    let mut manifest = ltc(&["inspect", "ggx-isotropic", "--json"]).json();
    manifest["version"] = 7.into();
    change(&mut manifest);
    let payload = version.join("table.npz");
    ltc(&["export", "ggx-isotropic", "--format", "npz", "--precision", "f64", "-o", text(&payload)]).good();
    std::fs::write(version.join("manifest.json"), manifest.to_string()).unwrap();
    folder
}

#[test]
fn a_folder_of_tables_joins_the_embedded_ones() {
    let folder = copy_with(|_| ());
    let listed = ltc(&["tables", "--json", "--tables", text(folder.path())]).json();
    let isotropic = listed["tables"].as_array().unwrap().iter().find(|t| t["name"] == "ggx-isotropic");
    assert_eq!(isotropic.unwrap()["latest"], 7);
    // By the environment, too.
    let output = command(&["tables", "--json"]).env("LTC_TABLES", folder.path()).output().unwrap();
    assert_eq!(serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap(), listed);
    ltc(&["tables", "--tables", "no/such/folder"]).refused(&["no/such/folder"]);
}

#[test]
fn a_manifest_that_flatters_is_found_out() {
    let folder = copy_with(|manifest| manifest["errors"]["standard_draw"]["tv_mean"] = 0.001.into());
    let run = ltc(&["verify", "ggx-isotropic@7", "--json", "--tables", text(folder.path())]);
    assert_eq!(run.code, Some(1));
    assert_eq!(run.err.lines().count(), 1);
    assert!(run.err.contains("errors.standard_draw.tv_mean"), "{}", run.err);
    let found: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(found["ok"], false);
}

#[test]
fn tables_are_compared() {
    let folder = copy_with(|manifest| manifest["licence"] = "MIT".into());
    let tables = ["--json", "--tables", text(folder.path())];
    let diff = |a, b| ltc(&[&["diff", a, b], &tables[..]].concat()).json();
    let same = diff("ggx-isotropic@2", "ggx-isotropic@7");
    assert_eq!((&same["same_payload"], &same["entries"]["all"]["tv_max"]), (&true.into(), &0.0.into()));
    assert_eq!(same["manifest"]["licence"], serde_json::json!(["CC0-1.0", "MIT"]));
    assert_eq!(same["manifest"].as_object().unwrap().len(), 2, "licence and version: {}", same["manifest"]);
    // Other axes: no entry has a counterpart, lookups have.
    let other = diff("ggx-isotropic", "ggx-anisotropic");
    assert!(other["entries"].is_null() && other["same_payload"] == false);
    let tv = other["lookups"]["tv_mean"].as_f64().unwrap();
    assert!(tv > 0.001 && tv < 0.1, "{tv}");
    assert!(ltc(&["diff", "ggx-isotropic", "ggx-anisotropic"]).good().out.contains("their axes differ"));
    ltc(&["diff", "ggx-isotropic", "nonesuch"]).refused(&["no table named \"nonesuch\""]);
}

#[test]
fn damaged_tables_are_refused() {
    let folder = copy_with(|_| ());
    let version = folder.path().join("ggx-isotropic/7");
    let payload = version.join("table.npz");
    let mut bytes = std::fs::read(&payload).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&payload, bytes).unwrap();
    let tables = |args: &[&str]| ltc(&[args, &["--tables", text(folder.path())]].concat());
    tables(&["tables"]).refused(&["digest", "manifest says"]);
    tables(&["verify", "ggx-isotropic"]).refused(&["digest"]);
    std::fs::write(version.join("manifest.json"), "{").unwrap();
    tables(&["tables"]).refused(&["manifest"]);
    assert_eq!(names_in(&version), ["manifest.json", "table.npz"]);
}

#[test]
fn a_reader_that_has_had_enough_is_no_failure() {
    for args in [&["tables"][..], &["inspect", "ggx-isotropic", "--json"], &["tables", "--json"]] {
        let mut child = command(args).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]), "{args:?}");
    }
}
