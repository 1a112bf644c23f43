//! `ltc probe`.

use crate::support::ltc;

#[test]
fn a_device_is_probed_by_feature() {
    let run = ltc(&["probe", "--json"]);
    if run.code == Some(1) && run.err.contains("no GPU adapter") && std::env::var_os("CI").is_none() {
        eprintln!("skipped: {}", run.err);
        return;
    }
    let report = run.json();
    assert_eq!(report["good"], true, "{report}");
    assert!(report["device"]["name"].is_string());
    let findings = report["findings"].as_array().unwrap();
    for feature in ["NaN", "arc tangent", "derivatives", "light sphere"] {
        let finding = findings.iter().find(|f| f["feature"] == feature).unwrap_or_else(|| panic!("{report}"));
        assert_eq!(finding["verdict"], "good", "{finding}");
        assert!(finding["measured"].as_f64() <= finding["allowed"].as_f64(), "{finding}");
    }
}
