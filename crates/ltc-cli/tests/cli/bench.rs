//! `ltc bench`: one short run, and what is made of two.

use std::path::Path;

use serde_json::{Value, json};

use crate::support::ltc;

const FILES: [&str; 5] =
    ["bench.json", "bench.csv", "bench.html", "bencher.json", "github-action-benchmark.json"];

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

#[test]
fn a_quick_run_writes_a_page_and_what_dashboards_read() {
    let folder = tempfile::tempdir().unwrap();
    let output = path(folder.path(), "new/bench");
    ltc(&["bench", "--quick", "--commit", "abc123", "-o", &output]).good();
    let read = |name: &str| std::fs::read_to_string(Path::new(&output).join(name)).unwrap();
    for name in FILES {
        assert!(!read(name).is_empty(), "{name}");
    }
    let run: Value = serde_json::from_str(&read("bench.json")).unwrap();
    assert_eq!((&run["schema"], &run["quick"], &run["commit"]), (&json!(1), &json!(true), &json!("abc123")));
    let records = run["records"].as_array().unwrap();
    for group in ["table/", "lookup/", "integral/", "image/"] {
        assert!(records.iter().any(|r| r["id"].as_str().unwrap().starts_with(group)), "{group}");
    }
    // Where there is a graphics device, its forms, and the ratios that are asked of them.
    let starts = |with: &str| records.iter().filter(|r| r["id"].as_str().unwrap().starts_with(with)).count();
    if run["machine"]["gpu"].is_string() {
        assert!(starts("gpu/") > 20 && starts("ratio/gpu/") > 10 && starts("yardstick/gpu/") == 1);
        assert!(run["machine"]["gpu_clock"].is_string());
        assert_eq!(records.iter().filter(|r| r["asked"].is_number()).count(), 8);
    } else {
        assert_eq!(starts("gpu/") + starts("ratio/gpu/"), 0);
    }
    for record in records {
        let id = record["id"].as_str().unwrap();
        let beside = ["lookup/", "integral/", "gpu/"].iter().any(|group| id.starts_with(group))
            || (id.starts_with("image/") && !id.ends_with("ltc_gpu"));
        assert!(!beside || record["relative"]["median"].is_number(), "{id} was timed beside no yardstick");
        let times = ["low", "median", "high"].map(|k| record["time"][k].as_f64());
        if let [Some(low), Some(median), Some(high)] = times {
            assert!(0.0 < low && low <= median && median <= high, "{record}");
        }
        for error in record["errors"].as_object().into_iter().flat_map(|e| e.values()) {
            assert!((0.0..=1e3).contains(&error.as_f64().unwrap()), "{record}");
        }
    }
    // Four plots of tables and integrals and two of each scene, and nothing fetched from anywhere.
    let page = read("bench.html");
    assert!(page.matches("<svg").count() >= 9);
    for outside in ["http://", "https://", "src=", "<script", "<link", "@import", "NaN", "inf"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let bencher: Value = serde_json::from_str(&read("bencher.json")).unwrap();
    let quad = &bencher["integral/quad/exact/f32"];
    assert!(quad["latency"]["lower_value"].as_f64() <= quad["latency"]["upper_value"].as_f64());
    assert!(quad["error-max"]["value"].as_f64().unwrap() < 1e-4);
    let action: Value = serde_json::from_str(&read("github-action-benchmark.json")).unwrap();
    let entry = &action.as_array().unwrap()[0];
    assert!(entry["name"].is_string() && entry["value"].is_number() && entry["unit"].is_string());
    // A run is no worse than itself.
    ltc(&["bench", "compare", &output, &path(Path::new(&output), "bench.json")]).good();
}

fn document(time: f64, error: f64) -> Value {
    json!({
        "schema": 1, "tool": "0.1.0", "quick": true, "date": "2026-01-01T00:00:00Z", "commit": null,
        "machine": {"cpu": "a", "threads": 2, "system": "linux", "build": "optimised"},
        "records": [{
            "id": "integral/quad/exact/f32", "per": "light",
            "time": {"median": time, "low": 0.98 * time, "high": 1.02 * time}, "errors": {"max": error},
        }],
    })
}

#[test]
fn planted_changes_are_caught_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, time: f64, error: f64| {
        let file = path(folder.path(), name);
        std::fs::write(&file, document(time, error).to_string()).unwrap();
        file
    };
    let before = write("before.json", 40.0, 6e-7);
    let same = ltc(&["bench", "compare", &before, &write("same.json", 41.0, 6e-7)]).good();
    assert!(same.out.contains("nothing worse among 2"), "{}", same.out);
    let slow = ltc(&["bench", "compare", &before, &write("slow.json", 48.0, 6e-7)]);
    assert_eq!(slow.code, Some(1));
    assert!(slow.out.contains("WORSE  integral/quad/exact/f32 time"), "{}", slow.out);
    assert!(slow.err.contains("1 worse, 0 gone, of 2"), "{}", slow.err);
    let wrong = ltc(&["bench", "compare", &before, &write("wrong.json", 40.0, 6.06e-7)]);
    assert_eq!(wrong.code, Some(1));
    assert!(wrong.out.contains("WORSE  integral/quad/exact/f32 max"), "{}", wrong.out);
    // Who allows more gets more.
    let allowed = ["--time-threshold", "25", &before, &path(folder.path(), "slow.json")];
    ltc(&[&["bench", "compare"][..], &allowed[..]].concat()).good();
}

#[test]
fn what_is_no_result_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "other.json");
    std::fs::write(&file, "{\"schema\": 1}").unwrap();
    ltc(&["bench", "compare", &file, &file]).refused(&["other.json", "no result"]);
    ltc(&["bench", "compare", "/nowhere/a.json", &file]).refused(&["/nowhere/a.json"]);
    let mut newer = document(1.0, 1.0);
    newer["schema"] = json!(2);
    std::fs::write(&file, newer.to_string()).unwrap();
    ltc(&["bench", "compare", &file, &file]).refused(&["schema 2"]);
    ltc(&["bench", "compare", &file]).misused(&["required"]);
    ltc(&["bench", "compare", "--time-threshold=-1", &file, &file]).refused(&["--time-threshold"]);
}
