//! `ltc fit`

use std::time::Duration;

use crate::support::{command, ltc, names_in, text};

#[test]
fn a_killed_fit_leaves_no_version_and_the_next_one_works() {
    let folder = tempfile::tempdir().unwrap();
    let output = text(folder.path());
    let mut killed = command(&["fit", "ggx-isotropic", "-o", output, "--threads", "1"]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    assert!(killed.try_wait().unwrap().is_none(), "it was killed at work, not after");
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(names_in(folder.path()).is_empty(), "{:?}", names_in(folder.path()));

    let manifest = ltc(&["fit", "ggx-isotropic", "-o", output, "--json"]).json();
    assert_eq!((&manifest["name"], &manifest["version"]), (&"ggx-isotropic".into(), &1.into()));
    assert_eq!(names_in(&folder.path().join("ggx-isotropic/1")), ["manifest.json", "table.npz"]);
    // What was written is what was told, and whole: its digest is checked on reading.
    let digest = manifest["digest"].as_str().unwrap();
    assert_eq!(ltc(&["inspect", digest, "--json", "--tables", output]).json(), manifest);
    // The committed command makes a table as good as the shipped one.
    let tv = |m: &serde_json::Value| m["errors"]["standard_draw"]["tv_mean"].as_f64().unwrap();
    let shipped = ltc(&["inspect", "ggx-isotropic", "--json"]).json();
    assert!((tv(&manifest) - tv(&shipped)).abs() < 1e-3, "{} {}", tv(&manifest), tv(&shipped));
}

#[test]
fn what_cannot_be_fitted_or_stored_is_told_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("tables");
    ltc(&["fit", "phong", "-o", text(&output)]).refused(&["no preset named \"phong\"", "ggx-isotropic"]);
    assert!(!output.exists(), "nothing is made for a fit that there is not");
    std::fs::write(&output, "a file").unwrap();
    ltc(&["fit", "ggx-isotropic", "-o", text(&output)]).refused(&[text(&output)]);
    assert_eq!(std::fs::read_to_string(&output).unwrap(), "a file");
}
