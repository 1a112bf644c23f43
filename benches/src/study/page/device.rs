//! The page's part about forms on a graphics device.

use std::fmt::Write;

use super::super::plot::{Mark, Plot, Series, escape, short};
use super::super::{Record, Run};
use super::{group, section};

/// Plots and the ratios, for each picture; nothing where there was no device.
pub fn sections(body: &mut String, run: &Run) {
    let mut pictures: Vec<&str> = group(run, "gpu").map(|r| r.word(1)).collect();
    pictures.dedup();
    if pictures.is_empty() {
        return;
    }
    let _ = writeln!(
        body,
        "<h2>Forms on the graphics device</h2>\n<p>{}. Told by {}. Every form runs over the same floor, whose materials and views vary from pixel to pixel, and is held against the processor in f64 first; a lookup is a frame less one that only reads and writes pixels, a light is a frame with many lights less one with few.{}</p>",
        escape(run.machine.gpu.as_deref().unwrap_or("unknown device")),
        escape(run.machine.gpu_clock.as_deref().unwrap_or("an unknown clock")),
        software_words(run)
    );
    for picture in pictures {
        section(
            body,
            &format!("Lookups and lights on the device, {picture}: error against time"),
            "Largest error against the processor in f64, of the cosines and the reflectance that a lobe gives, and of the fraction of a lobe that sees a light.",
            &errors(run, picture),
        );
        section(
            body,
            &format!("A frame over its number of lights, {picture}"),
            "One isotropic lookup for all lights of a pixel, quads with both horizons.",
            &lights(run, picture),
        );
    }
    ratios(body, run);
}

fn software_words(run: &Run) -> &'static str {
    let software = run.machine.gpu.as_deref().is_some_and(|gpu| gpu.contains("(software"));
    if software {
        " <b>This is a software driver</b>: it does not jump over branches that no pixel takes, and its times say little about hardware."
    } else {
        ""
    }
}

fn of<'a>(run: &'a Run, picture: &'a str, what: &'a str) -> impl Iterator<Item = &'a Record> {
    group(run, "gpu").filter(move |r| r.word(1) == picture && r.word(3) == what)
}

fn errors(run: &Run, picture: &str) -> Plot {
    let mark = |r: &Record| {
        let words: Vec<String> = r.id.split('/').skip(4).map(|word| word.replace('_', " ")).collect();
        let time = r.time?.median * 1e-6;
        // A difference of two times that are alike may come out below 0.
        let error = *r.errors.get("max")?;
        (time > 0.0).then(|| Mark { x: time, y: error, label: words.join(", ").replace(", exact", "") })
    };
    let series = |name: &str, what: &str, published: bool, stage: &str| Series {
        name: name.to_owned(),
        marks: of(run, picture, what)
            .filter(|r| r.word(2) == stage && r.id.contains("published") == published)
            .filter_map(mark)
            .collect(),
        joined: false,
        labelled: true,
    };
    let all = [
        series("lookup of a frame", "lookup", false, "compute"),
        series("lookup, published", "lookup", true, "compute"),
        series("one light of a frame", "integral", false, "compute"),
        series("one light, published", "integral", true, "compute"),
        series("lookup, fragment stage", "lookup", false, "fragment"),
        series("one light, fragment stage", "integral", false, "fragment"),
    ];
    let series = all.into_iter().filter(|series| !series.marks.is_empty()).collect();
    Plot { x: "milliseconds".to_owned(), y: "largest error".to_owned(), series }
}

fn lights(run: &Run, picture: &str) -> Plot {
    let counted = |r: &&Record| r.word(5).ends_with("_lights");
    let mut kinds: Vec<&str> = of(run, picture, "shade").filter(counted).map(|r| r.word(4)).collect();
    kinds.dedup();
    let series = kinds.into_iter().map(|kind| {
        let mark = |r: &Record| {
            let count: f64 = r.word(5).strip_suffix("_lights")?.parse().ok()?;
            Some(Mark { x: count, y: r.time?.median * 1e-6, label: short(count) })
        };
        let marks: Vec<Mark> =
            of(run, picture, "shade").filter(|r| r.word(4) == kind).filter_map(mark).collect();
        Series { name: kind.replace('_', " "), joined: marks.len() > 1, marks, labelled: false }
    });
    Plot { x: "lights".to_owned(), y: "milliseconds of a frame".to_owned(), series: series.collect() }
}

fn ratios(body: &mut String, run: &Run) {
    body.push_str("<h3>Ratios</h3>\n<p>Turn by turn, so that what slows the device down falls on both; the interval holds the median with 95 % confidence.</p>\n<table><thead><tr><th>picture</th><th>ratio</th><th>median</th><th>95 % interval</th><th>asked</th><th></th></tr></thead><tbody>\n");
    for record in group(run, "ratio").filter(|r| r.word(1) == "gpu") {
        let Some(ratio) = record.ratio else { continue };
        let verdict = match record.asked {
            None => "",
            Some(asked) if ratio.high <= asked => "holds",
            Some(asked) if ratio.low > asked => "does not hold",
            Some(_) => "undecided",
        };
        let _ = writeln!(
            body,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{} to {}</td><td>{}</td><td>{verdict}</td></tr>",
            escape(record.word(2)),
            escape(&record.word(3).replace('_', " ")),
            short(ratio.median),
            short(ratio.low),
            short(ratio.high),
            record.asked.map(|asked| format!("≤ {}", short(asked))).unwrap_or_default()
        );
    }
    body.push_str("</tbody></table>\n");
}

#[cfg(test)]
mod tests {
    use super::super::super::{Interval, Machine};
    use super::*;

    fn run() -> Run {
        let time = |median: f64| Interval { median, low: 0.9 * median, high: 1.1 * median };
        let lookup = Record::new("gpu/1080p/compute/lookup/isotropic/texture_f32", "frame").timed(time(1e6));
        let ratio = |name: &str, median, asked| {
            Record::new(format!("ratio/gpu/1080p/{name}"), "ratio").ratio(time(median), asked)
        };
        let records = vec![
            lookup.error("max", 1e-6),
            Record::new("gpu/1080p/compute/shade/isotropic/16_lights", "frame").timed(time(5e6)),
            Record::new("gpu/1080p/compute/shade/published_2016/01_lights", "frame").timed(time(2e6)),
            Record::new("gpu/1080p/compute/shade/isotropic/each_light", "light of a frame").timed(time(3e5)),
            ratio("line_over_quad", 0.3, Some(0.5)),
            ratio("quad_over_published", 2.0, Some(1.0)),
            ratio("anisotropic_over_isotropic_lookup", 1.5, Some(1.5)),
        ];
        let machine = Machine { gpu: Some("x (software, vulkan, y)".into()), ..Machine::default() };
        Run { schema: 1, tool: "0".into(), quick: true, date: String::new(), commit: None, machine, records }
    }

    #[test]
    fn what_is_asked_is_judged_by_the_interval() {
        let mut body = String::new();
        sections(&mut body, &run());
        for words in ["<td>holds</td>", "<td>does not hold</td>", "<td>undecided</td>", "a software driver"] {
            assert_eq!(body.matches(words).count(), 1, "{words}");
        }
        assert!(body.contains("isotropic, texture f32") && !body.contains("NaN"));
        assert_eq!(body.matches(">isotropic</text>").count(), 1, "each kind is in the legend once");
    }

    #[test]
    fn without_a_device_there_is_nothing() {
        let mut body = String::new();
        sections(&mut body, &Run { records: Vec::new(), ..run() });
        assert!(body.is_empty());
    }
}
