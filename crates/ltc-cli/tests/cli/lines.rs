//! `ltc lookup` and `ltc integrate`: JSON lines in, JSON lines out.

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use serde_json::{Value, json};

use crate::support::{command, ltc, ltc_with, numbers};

const COSINE: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// A square of half-width 1 at height 1; its form factor is known.
const SQUARE: [[f64; 3]; 4] = [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]];

fn lookup(table: &str, lines: &str) -> Vec<Value> {
    ltc_with(&["lookup", "--table", table], lines).lines()
}

fn integrate(options: &[&str], lines: &[Value]) -> Vec<Value> {
    let input: String = lines.iter().map(|line| format!("{line}\n")).collect();
    ltc_with(&[&["integrate"], options].concat(), &input).lines()
}

fn polygon(vertices: impl serde::Serialize) -> Value {
    json!({ "type": "polygon", "vertices": vertices })
}

#[test]
fn lookups_have_the_shape_that_pipelines_read() {
    let lines = r#"{"theta":0.7,"phi":0.3,"alpha_x":0.4,"alpha_y":0.1}
{"theta":0.7,"phi":-12.0,"alpha_x":0.1,"alpha_y":0.4}

{"theta":0,"alpha_x":1,"alpha_y":1}
"#;
    let answers = lookup("ggx-anisotropic", lines);
    assert_eq!(answers.len(), 3, "the empty line has no answer");
    for answer in &answers {
        let lobes = answer["lobes"].as_array().unwrap();
        let weights: f64 = lobes.iter().map(|lobe| lobe["weight"].as_f64().unwrap()).sum();
        assert!((weights - 1.0).abs() < 1e-12);
        for lobe in lobes {
            let m: [f64; 9] = numbers(&lobe["m"]).try_into().unwrap();
            assert!(glam::DMat3::from_cols_array(&m).determinant() > 0.0, "{lobe}");
        }
        // 0.307 at least over all materials, and lookups are within 0.02 of it.
        assert!(answer["magnitude"].as_f64().unwrap() > 0.307 - 0.02);
        assert!(answer["fresnel"].as_f64().unwrap() >= 0.0);
        assert_eq!(answer.as_object().unwrap().len(), 3, "{answer}");
    }
    assert_eq!(lookup("ggx-isotropic", r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.4}"#).len(), 1);
}

#[test]
fn bad_lookups_are_told_on_their_line_and_the_run_goes_on() {
    let good = r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.4}"#;
    for (bad, word) in [
        ("not json", "line 1"),
        (r#"{"theta":NaN,"alpha_x":0.4,"alpha_y":0.4}"#, "expected value"),
        (r#"{"theta":null,"alpha_x":0.4,"alpha_y":0.4}"#, "null"),
        (r#"{"theta":1e999,"alpha_x":0.4,"alpha_y":0.4}"#, "out of range"),
        (r#"{"theta":2,"alpha_x":0.4,"alpha_y":0.4}"#, "theta is 2"),
        (r#"{"theta":0.7,"alpha_x":-0.4,"alpha_y":0.4}"#, "alpha_x is -0.4"),
        (r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.1}"#, "must be equal"),
        (r#"{"theta":0.7,"alpha_x":0.4}"#, "alpha_y"),
        (r#"{"theta":0.7,"alpha_x":0.4,"alpha_y":0.4,"alpha_z":1}"#, "alpha_z"),
        ("[]", "must be a JSON object"),
        ("[0.7,0,0.4,0.4]", "must be a JSON object"),
    ] {
        let answers = lookup("ggx-isotropic", &format!("{good}\n{bad}\n{good}"));
        assert_eq!(answers.len(), 3, "{bad}");
        assert_eq!(answers[0], answers[2]);
        assert!(answers[0]["error"].is_null());
        let error = answers[1]["error"].as_str().unwrap();
        assert!(error.contains(word), "{bad}: {error}");
        assert_eq!(answers[1].as_object().unwrap().len(), 1);
    }
    let bytes = lookup("ggx-isotropic", "\u{fffd}\u{0}\n");
    assert!(bytes[0]["error"].is_string());
    assert!(lookup("ggx-isotropic", "").is_empty());
}

#[test]
fn an_answer_comes_before_the_next_question() {
    let mut child = command(&["lookup", "--table", "ggx-isotropic"]).stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    for theta in ["0.1", "0.2"] {
        writeln!(stdin, r#"{{"theta":{theta},"alpha_x":0.4,"alpha_y":0.4}}"#).unwrap();
        let mut answer = String::new();
        stdout.read_line(&mut answer).unwrap();
        assert!(answer.contains("lobes"), "{answer}");
    }
    drop(stdin);
    assert!(child.wait().unwrap().success());
}

#[test]
fn integrals_are_right_in_every_precision_and_place() {
    // Four times the factor of a square above its corner (Howell, B-4).
    let exact = 4.0 / (std::f64::consts::PI * 2_f64.sqrt()) * 0.5_f64.sqrt().atan();
    let backwards: Vec<_> = SQUARE.iter().rev().collect();
    let lines = [
        json!({ "m": COSINE, "light": polygon(SQUARE) }),
        json!({ "m": COSINE.map(|x| 1e3 * x), "light": polygon(SQUARE) }),
        json!({ "m": COSINE, "light": polygon(&backwards) }),
        json!({ "m": COSINE, "light": { "type": "polygon", "vertices": backwards, "two_sided": true } }),
        json!({ "m": COSINE, "light": polygon([SQUARE[0], SQUARE[0], SQUARE[0]]) }),
        json!({ "m": COSINE, "light": polygon(SQUARE.map(|[x, y, z]| [x, y, -z])) }),
    ];
    for (options, precision, tolerance) in [
        (&["--precision", "f64"][..], "f64", 1e-12),
        (&["--precision", "f32"], "f32", 1e-6),
        (&[], "f32", 1e-6),
        (&["--backend", "gpu"], "f32", 1e-5),
    ] {
        if options.contains(&"gpu") && !has_gpu() {
            continue;
        }
        let answers = integrate(options, &lines);
        for (answer, expected) in answers.iter().zip([exact, exact, 0.0, exact, 0.0, 0.0]) {
            let value = answer["value"].as_f64().unwrap();
            assert!((value - expected).abs() < tolerance, "{options:?}: {value} {expected}");
            assert!(expected > 0.0 || value == 0.0);
            assert_eq!(answer, &json!({ "value": value, "precision": precision }));
        }
        assert_eq!(answers.len(), lines.len());
    }
}

/// Every light of the manual, overhead or thin enough for a textbook form factor.
#[test]
fn every_light_has_its_form_factor() {
    let (p0, p1) = ([-1e3, 0.0, 2.0], [1e3, 0.0, 2.0]);
    let lights = [
        (json!({ "type": "disk", "center": [0, 0, 2], "normal": [0, 0, -1], "radius": 1 }), 0.2),
        (json!({ "type": "disk", "center": [0, 0, 2], "normal": [0, 0, 1], "radius": 1 }), 0.0),
        (
            json!({ "type": "disk", "center": [0, 0, 2], "normal": [0, 0, 1], "radius": 1, "two_sided": true }),
            0.2,
        ),
        (json!({ "type": "ellipse", "center": [0, 0, 2], "axis_u": [0, 1, 0], "axis_v": [1, 0, 0] }), 0.2),
        (json!({ "type": "ellipse", "center": [0, 0, 2], "axis_u": [1, 0, 0], "axis_v": [0, 1, 0] }), 0.0),
        (json!({ "type": "sphere", "center": [0, 0, 2], "radius": 0.5 }), 0.0625),
        (json!({ "type": "sphere", "center": [0, 0, 0.1], "radius": 0.5 }), 1.0),
        // Of a long line overhead: radius over distance, for a wide one, too.
        (json!({ "type": "line", "p0": p0, "p1": p1, "radius": 0.02 }), 0.01),
        (json!({ "type": "strip", "p0": p0, "p1": p1, "width": 0.04, "normal": [0, 0, -1] }), 0.01),
        (json!({ "type": "strip", "p0": p0, "p1": p1, "width": 0.04, "normal": [0, 0, 1] }), 0.0),
        (json!({ "type": "cylinder", "p0": p0, "p1": p1, "radius": 1 }), 0.5),
        (json!({ "type": "cylinder", "p0": [0, 0, 2], "p1": [0, 0, 3], "radius": 1, "caps": true }), 0.2),
        (json!({ "type": "cylinder", "p0": [0, 0, 2], "p1": [0, 0, 3], "radius": 1, "caps": false }), 0.0),
    ];
    let lines: Vec<Value> = lights.iter().map(|(light, _)| json!({ "m": COSINE, "light": light })).collect();
    for (precision, tolerance) in [("f64", 1e-6), ("f32", 3e-6)] {
        let answers = integrate(&["--precision", precision], &lines);
        assert_eq!(answers.len(), lines.len());
        for (answer, (light, expected)) in answers.iter().zip(&lights) {
            let value = answer["value"].as_f64().unwrap_or(f64::NAN);
            assert!((value - expected).abs() < tolerance, "{light}: {answer}, not {expected}");
            assert!(*expected > 0.0 || value == 0.0, "{light}: {answer}");
        }
    }
}

/// One that is none is told on its line, whatever its shape.
#[test]
fn bad_lights_of_every_shape_are_refused() {
    let bad = [
        (json!({ "type": "disk", "center": [0, 0, 2], "normal": [0, 0, 0], "radius": 1 }), "normal"),
        (json!({ "type": "sphere", "center": [0, 0, 2], "radius": -1 }), "radius"),
        (json!({ "type": "line", "p0": [0, 0, 1], "p1": [1, 0, 1], "radius": -1 }), "radius"),
        (json!({ "type": "cylinder", "p0": [0, 0, 1], "p1": [1, 0, 1], "radius": -1 }), "radius"),
        (
            json!({ "type": "strip", "p0": [0, 0, 1], "p1": [1, 0, 1], "width": 1, "normal": [1, 0, 0] }),
            "normal",
        ),
        (json!({ "type": "ellipse", "center": [0, 0, 2], "axis_u": [1, 0, 0] }), "axis_v"),
    ];
    let lines: Vec<Value> = bad.iter().map(|(light, _)| json!({ "m": COSINE, "light": light })).collect();
    let answers = integrate(&[], &lines);
    assert_eq!(answers.len(), bad.len());
    for (answer, (light, word)) in answers.iter().zip(&bad) {
        assert!(answer["error"].to_string().contains(word), "{light}: {answer}");
    }
}

/// As the GPU tests of the workspace: a machine without any driver skips, a build server does not.
fn has_gpu() -> bool {
    let run = ltc(&["integrate", "--backend", "gpu"]);
    if run.err.contains("no GPU adapter") {
        assert!(std::env::var_os("CI").is_none(), "{}", run.err);
        println!("skipped the GPU: {}", run.err);
        return false;
    }
    run.code == Some(0)
}

#[test]
fn a_table_gives_the_lobe_of_its_lookup() {
    let query = json!({ "theta": 0.7, "phi": 0.3, "alpha_x": 0.4, "alpha_y": 0.1 });
    let m = lookup("ggx-anisotropic", &query.to_string())[0]["lobes"][0]["m"].clone();
    let mut by_table = query.clone();
    by_table["table"] = "ggx-anisotropic".into();
    by_table["light"] = polygon(SQUARE);
    let answers =
        integrate(&["--precision", "f64"], &[by_table.clone(), json!({ "m": m, "light": polygon(SQUARE) })]);
    assert_eq!(answers[0], answers[1]);
    let value = answers[0]["value"].as_f64().unwrap();
    assert!(value > 0.1 && value < 1.0, "{value}");
    // The control: another azimuth, another lobe.
    by_table["phi"] = 2.0.into();
    assert_ne!(integrate(&["--precision", "f64"], &[by_table])[0], answers[0]);
}

#[test]
fn bad_integrals_are_told_on_their_line_and_the_run_goes_on() {
    let good = json!({ "m": COSINE, "light": polygon(SQUARE) }).to_string();
    let line = |m: &str, vertices: &str| {
        format!(r#"{{"m":{m},"light":{{"type":"polygon","vertices":{vertices}}}}}"#)
    };
    let (m, square) = (json!(COSINE).to_string(), json!(SQUARE).to_string());
    let bad = [
        (line(&m, "[[0,0,1],[0,1,1],[1,0,1e999]]"), "out of range"),
        (line(&m, "[[0,0,1],[0,1,1],[1,0,null]]"), "null"),
        (line(&m, "[[0,0,1],[0,1,1],[1,0,NaN]]"), "expected value"),
        (line(&m, "[[0,0,1],[0,1,1]]"), "at least 3 vertices"),
        (line(&m, "[]"), "at least 3 vertices"),
        (line(&m, "[[0,0],[0,1],[1,0]]"), "length"),
        (line("[1,0,0,0,1,0,0,0,0]", &square), "determinant above 0"),
        (line("[1,0,0,0,1,0,0,0,-1]", &square), "determinant above 0"),
        (line("[1,0,0,0,1,0,0,0]", &square), "length"),
        (line("[1,0,0,0,1,0,0,0,null]", &square), "null"),
        (json!({ "light": polygon(SQUARE) }).to_string(), "\\\"m\\\""),
        (json!({ "m": COSINE }).to_string(), "light"),
        (json!({ "m": COSINE, "light": { "type": "moon" } }).to_string(), "moon"),
        (json!({ "m": COSINE, "theta": 1.0, "light": polygon(SQUARE) }).to_string(), "either"),
        (
            json!({ "table": "nonesuch", "theta": 0.1, "alpha_x": 0.5, "alpha_y": 0.5, "light": polygon(SQUARE) })
                .to_string(),
            "ggx-isotropic",
        ),
        ("{".to_owned(), "EOF"),
    ];
    let input: String = bad.iter().map(|(line, _)| format!("{line}\n{good}\n")).collect();
    for precision in ["f32", "f64"] {
        let answers = ltc_with(&["integrate", "--precision", precision], &input).lines();
        assert_eq!(answers.len(), 2 * bad.len());
        for ((line, word), pair) in bad.iter().zip(answers.chunks(2)) {
            let error = pair[0]["error"].to_string();
            assert!(pair[0]["value"].is_null() && error.contains(word), "{line}: {}", pair[0]);
            assert!(pair[1]["value"].as_f64().unwrap() > 0.5, "{}", pair[1]);
        }
    }
}

#[test]
fn the_gpu_has_no_double_precision() {
    ltc(&["integrate", "--backend", "gpu", "--precision", "f64"]).refused(&["f32", "--precision"]);
}
