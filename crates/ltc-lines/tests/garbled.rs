//! Lines that somebody garbled: an answer in [0, 1], or one line that says what is wrong. The body of `fuzz/lines`, on lines
//! from a seed.

use ltc_core::points::SplitMix64;
use ltc_lines::{Integration, lookup};

const SEEDS: [&str; 8] = [
    r#"{"theta":0.7,"phi":0.3,"alpha_x":0.4,"alpha_y":0.1}"#,
    r#"{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"polygon","vertices":[[0,0,1],[0,1,1],[1,0,1]],"two_sided":true}}"#,
    r#"{"m":[0.2,0,0.5,0,0.1,0,-0.1,0,0.9],"light":{"type":"line","p0":[1,0.3,1],"p1":[-1,0.3,1],"radius":0.05}}"#,
    r#"{"table":"ggx-anisotropic","theta":0.7,"phi":0.3,"alpha_x":0.4,"alpha_y":0.1,"light":{"type":"sphere","center":[0,0,2],"radius":0.5}}"#,
    r#"{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"strip","p0":[1,2,1],"p1":[-1,2,1],"width":0.1,"normal":[0,-1,0],"two_sided":true}}"#,
    r#"{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"cylinder","p0":[1,2,1],"p1":[-1,2,1],"radius":0.5,"caps":true}}"#,
    r#"{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"disk","center":[0,0,2],"normal":[0,0,-1],"radius":1,"two_sided":false}}"#,
    r#"{"m":[1,0,0,0,1,0,0,0,1],"light":{"type":"ellipse","center":[0,0,2],"axis_u":[1,0,0],"axis_v":[0,0.5,0],"two_sided":true}}"#,
];

const PIECES: [&str; 22] = [
    "0",
    "-1",
    "1e308",
    "1e-320",
    "1e999",
    "null",
    "true",
    "[]",
    "{}",
    "[",
    "}",
    ",",
    ":",
    "\"",
    "\\",
    "NaN",
    "\"type\":\"disk\"",
    "0.5",
    "1e30",
    "-1e-40",
    "\u{fffd}",
    "\"m\":[1,2,3]",
];

/// One to four pieces of a line replaced, cut, doubled or swapped for pieces of others.
fn garbled(rng: &mut SplitMix64) -> String {
    let pick = |rng: &mut SplitMix64, n: usize| (rng.bits() % n as u64) as usize;
    let mut line: Vec<char> = SEEDS[pick(rng, SEEDS.len())].chars().collect();
    for _ in 0..=pick(rng, 4) {
        let at = pick(rng, line.len() + 1);
        let end = (at + pick(rng, 6)).min(line.len());
        match pick(rng, 4) {
            0 => drop(line.drain(at..end)),
            1 => drop(line.splice(at..end, PIECES[pick(rng, PIECES.len())].chars())),
            2 => {
                // A whole number by another: what a garbled key rarely survives, a garbled value does.
                let digits = |c: &char| c.is_ascii_digit() || ".-e".contains(*c);
                let start = (at..line.len()).find(|i| digits(&line[*i])).unwrap_or(end);
                let stop = (start..line.len()).find(|i| !digits(&line[*i])).unwrap_or(line.len());
                drop(line.splice(start..stop, PIECES[pick(rng, 5)].chars()));
            }
            _ => {
                let copy: Vec<char> = line[at..end].to_vec();
                drop(line.splice(at..at, copy));
            }
        }
    }
    line.into_iter().collect()
}

#[test]
fn garbled_lines_have_an_answer_or_a_reason() {
    let tables = ltc_tables::shipped().unwrap();
    let table = tables.find("ggx-anisotropic").unwrap().table();
    let mut rng = SplitMix64::new(4);
    let (mut answers, mut reasons) = (0, 0);
    for _ in 0..60_000 {
        let line = garbled(&mut rng);
        let looked_up = lookup(table, &line).map(|_| ());
        let integrated = Integration::parse(&tables, &line)
            .and_then(|job| Ok([job.on_cpu::<f32>()?, job.on_cpu::<f64>()?]))
            .map(|answers| {
                for answer in answers {
                    assert!((0.0..=1.0).contains(&answer.value), "{answer:?} for {line}");
                }
            });
        for result in [looked_up, integrated] {
            match result {
                Ok(()) => answers += 1,
                Err(reason) => {
                    assert!(!reason.contains('\n') && !reason.is_empty(), "{reason:?} for {line}");
                    reasons += 1;
                }
            }
        }
    }
    // Both ends are reached, or the test is none.
    assert!(answers > 2000 && reasons > 2000, "{answers} answers, {reasons} reasons");
}

#[test]
fn every_light_has_its_line() {
    let tables = ltc_tables::shipped().unwrap();
    for line in &SEEDS[1..] {
        let job = Integration::parse(&tables, line).unwrap();
        let (single, double) = (job.on_cpu::<f32>().unwrap(), job.on_cpu::<f64>().unwrap());
        assert!(double.value > 1e-3 && (single.value - double.value).abs() < 1e-4, "{line}: {double:?}");
        assert_eq!((single.precision, double.precision), ("f32", "f64"));
    }
}
