//! A run as one page that needs nothing else.

mod device;

use std::fmt::Write;

use super::plot::{Mark, Plot, Series, escape, short};
use super::{Interval, Record, Run};

const STYLE: &str = include_str!("page.css");
const METHOD: &str = include_str!("method.html");

/// The whole page: plots, what to choose, how it was measured, all figures.
pub fn page(run: &Run) -> String {
    let mut body = head(run);
    section(
        &mut body,
        "Error of tables against bytes",
        "Total variation between GGX and its likeness: the largest share of the reflected light that any light can be wrong by, mean over the standard draw.",
        &tables(run, |r| r.bytes.map(|b| b as f64), "bytes of the table"),
    );
    section(
        &mut body,
        "Error of tables against time of a lookup",
        "The same error, over what one lookup of lobe, magnitude and Fresnel term costs on one core, with the inverse of the matrix that shading needs.",
        &tables(run, |r| lookup_time(run, r), "nanoseconds of a lookup"),
    );
    section(
        &mut body,
        "Error of integrals against time",
        "One light over one lobe, on one core: the largest error against an oracle of 31 digits over the time. A batch counts each of its lights.",
        &integrals(run),
    );
    pictures(&mut body, run);
    device::sections(&mut body, run);
    let _ = writeln!(body, "{METHOD}");
    all(&mut body, run);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>Run time against error</title>\n<style>\n{STYLE}</style>\n<body>\n{body}</body>\n</html>\n"
    )
}

fn head(run: &Run) -> String {
    let machine = &run.machine;
    let mut text = String::from("<h1>Run time against error</h1>\n<dl>\n");
    let mut row = |name: &str, value: &str| {
        let _ = writeln!(text, "<dt>{name}</dt><dd>{}</dd>", escape(value));
    };
    row("Processor", &format!("{}, {} threads, {}", machine.cpu, machine.threads, machine.system));
    row("Build", &format!("ltc {}, {}", run.tool, machine.build));
    if let Some(clock) = &machine.gpu_clock {
        row("Clock of its forms", clock);
    }
    row("Graphics", machine.gpu.as_deref().unwrap_or("no device: frames are shaded on the processor alone"));
    row("Commit", run.commit.as_deref().unwrap_or("not named"));
    row("Date", &run.date);
    row("Length", if run.quick { "quick: fewer cases, smaller pictures, wider intervals" } else { "full" });
    if let Some(load) = machine.load {
        let busy = if load > 1.0 { ": a busy machine, times are too long" } else { "" };
        row("Load before", &format!("{load}{busy}"));
    }
    text.push_str("</dl>\n");
    text
}

fn section(body: &mut String, title: &str, words: &str, plot: &Plot) {
    let _ = writeln!(body, "<h2>{}</h2>\n<p>{}</p>\n{}", escape(title), escape(words), plot.svg());
}

fn group<'a>(run: &'a Run, name: &'a str) -> impl Iterator<Item = &'a Record> {
    run.records.iter().filter(move |r| r.word(0) == name)
}

fn tables(run: &Run, x: impl Fn(&Record) -> Option<f64>, title: &str) -> Plot {
    let mark = |r: &Record| {
        let label = format!("{} {}", r.word(1).trim_start_matches("ggx-"), r.word(2));
        Some(Mark { x: x(r)?, y: *r.errors.get("tv_mean")?, label })
    };
    let series = ["ggx-isotropic", "ggx-anisotropic"].map(|kind| Series {
        name: kind.to_owned(),
        marks: group(run, "table").filter(|r| r.word(1).starts_with(kind)).filter_map(mark).collect(),
        joined: false,
        labelled: true,
    });
    Plot { x: title.to_owned(), y: "mean total variation".to_owned(), series: series.into() }
}

/// What a lookup in a shipped table costs. Precision of the file makes no difference to it.
fn lookup_time(run: &Run, table: &Record) -> Option<f64> {
    let name = table.word(1).split('@').next()?;
    if table.word(2) != "f32" {
        return None;
    }
    let id = format!("lookup/{name}/inverted");
    run.records.iter().find(|r| r.id == id)?.time.map(|time| time.median)
}

fn integrals(run: &Run) -> Plot {
    let mut shapes: Vec<&str> = group(run, "integral").map(|r| r.word(1)).collect();
    shapes.dedup();
    let series = shapes.into_iter().map(|shape| Series {
        name: shape.to_owned(),
        marks: group(run, "integral")
            .filter(|r| r.word(1) == shape)
            .filter_map(|r| {
                let way = r.word(2).replace('_', " ");
                // Quads have many ways, most other shapes one.
                let name = if way == "exact" { shape } else { way.as_str() };
                let label = format!("{name} {}", r.word(3));
                Some(Mark { x: r.time?.median, y: *r.errors.get("max")?, label })
            })
            .collect(),
        joined: false,
        labelled: true,
    });
    Plot { x: "nanoseconds of a light".to_owned(), y: "largest error".to_owned(), series: series.collect() }
}

fn pictures(body: &mut String, run: &Run) {
    let mut scenes: Vec<&str> = group(run, "image").map(|r| r.word(1)).collect();
    scenes.dedup();
    body.push_str("<h2>Error of pictures against time of a frame</h2>\n<p>Against a converged reference of the same direct light. Sampling is of light, visible normals and cosine by multiple importance sampling, on all cores; the number is samples a light and pixel.</p>\n");
    for scene in scenes {
        let of = |way: &str| -> Vec<&Record> {
            group(run, "image").filter(|r| r.word(1) == scene && r.word(2).starts_with(way)).collect()
        };
        for (kind, title) in [("relative_rmse", "relative RMSE"), ("flip", "mean ꟻLIP, 0 to 1")] {
            let marks = |records: &[&Record]| {
                let mark = |r: &&Record| {
                    let label = r.word(2).trim_start_matches("sampling_").trim_start_matches('0');
                    let label = label.replace('_', ", ");
                    Some(Mark { x: r.time?.median * 1e-6, y: *r.errors.get(kind)?, label })
                };
                records.iter().filter_map(mark).collect::<Vec<Mark>>()
            };
            let series = vec![
                Series { name: "LTC".into(), marks: marks(&of("ltc")), joined: false, labelled: true },
                Series {
                    name: "sampling".into(),
                    marks: marks(&of("sampling")),
                    joined: true,
                    labelled: true,
                },
            ];
            let plot = Plot { x: "milliseconds of shading a frame".into(), y: title.into(), series };
            let _ = writeln!(body, "<h3>{}: {title}</h3>\n{}", escape(scene), plot.svg());
        }
        if let Some(words) = overtaking(&of("ltc_cpu"), &of("sampling")) {
            let _ = writeln!(body, "<p>{words}</p>");
        }
    }
}

/// Where sampling becomes better than the closed form, on the line between two of its points.
fn overtaking(ltc: &[&Record], sampling: &[&Record]) -> Option<String> {
    let ltc = ltc.first()?;
    let (time, error) = (ltc.time?.median, *ltc.errors.get("relative_rmse")?);
    let points: Vec<(f64, f64, f64)> = sampling
        .iter()
        .filter_map(|r| {
            let samples: f64 = r.word(2).trim_start_matches("sampling_").parse().ok()?;
            Some((samples, r.time?.median, *r.errors.get("relative_rmse")?))
        })
        .collect();
    let Some(pair) = points.windows(2).find(|pair| pair[1].2 < error) else {
        let (samples, ..) = points.last()?;
        return Some(format!("Sampling stays above the closed form's error to {samples} samples."));
    };
    if points[0].2 < error {
        return Some(format!("Sampling is below the closed form's error from {} samples.", points[0].0));
    }
    let part = (pair[0].2 / error).ln() / (pair[0].2 / pair[1].2).ln();
    let between = |a: f64, b: f64| (a.ln() + part * (b / a).ln()).exp();
    let (samples, at) = (between(pair[0].0, pair[1].0), between(pair[0].1, pair[1].1));
    Some(format!(
        "Sampling overtakes the closed form at {} samples, which take {} times as long as the closed form on the same cores.",
        short(samples.round()),
        short(at / time)
    ))
}

fn all(body: &mut String, run: &Run) {
    body.push_str("<h2>All figures</h2>\n<table><thead><tr><th>what</th><th>time</th><th>95 % interval</th><th>bytes</th><th>errors</th></tr></thead><tbody>\n");
    for record in &run.records {
        let unit = if record.per.ends_with("frame") { (1e-6, "ms") } else { (1.0, "ns") };
        let range = |t: Interval, unit: f64| format!("{} to {}", short(t.low * unit), short(t.high * unit));
        let (time, range) = match (record.time, record.ratio) {
            (Some(t), _) => {
                (Some(format!("{} {}", short(t.median * unit.0), unit.1)), Some(range(t, unit.0)))
            }
            (None, Some(r)) => (Some(format!("× {}", short(r.median))), Some(range(r, 1.0))),
            (None, None) => (None, None),
        };
        let errors: Vec<String> =
            record.errors.iter().map(|(kind, x)| format!("{kind} {}", short(*x))).collect();
        let _ = writeln!(
            body,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escape(&record.id),
            time.unwrap_or_default(),
            range.unwrap_or_default(),
            record.bytes.map(|b| b.to_string()).unwrap_or_default(),
            errors.join(", ")
        );
    }
    body.push_str("</tbody></table>\n");
}
