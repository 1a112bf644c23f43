//! One measure over time, as SVG.

use std::fmt::Write;

use ltc_records::{Interval, Verdict, short};

use super::tracks::{Dot, History, Measure};
use crate::routes::index::escaped;

const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 190.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 26.0;
/// Tracks are told apart by so many colours; further ones begin again.
pub(super) const COLOURS: usize = 6;

/// The vertical axis: linear, or logarithmic where values lie more than a factor of ten apart.
struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Scale {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let values = values.filter(|x| x.is_finite()).map(within);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low > high {
            return Self { low: 0.0, high: 1.0, logarithmic: false };
        }
        let logarithmic = low > 0.0 && high > 10.0 * low;
        let (low, high) = if logarithmic { (low.ln(), high.ln()) } else { (low, high) };
        let width = high - low;
        // A level line lies in the middle, and noise of a thousandth does not look like a mountain range.
        let least = if logarithmic { 0.1 } else { 0.04 * high.abs().max(low.abs()).max(1e-300) };
        let margin = 0.08 * width + 0.5 * (least - width).max(0.0);
        Self { low: low - margin, high: high + margin, logarithmic }
    }

    fn y(&self, value: f64) -> f64 {
        let value = if self.logarithmic { value.max(1e-300).ln() } else { within(value) };
        let part = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        HEIGHT - BOTTOM - part * (HEIGHT - BOTTOM - TOP)
    }

    /// Three values to label.
    fn ticks(&self) -> [f64; 3] {
        [0.1, 0.5, 0.9].map(|part| {
            let value = (1.0 - part) * self.low + part * self.high;
            if self.logarithmic { value.exp() } else { value }
        })
    }
}

/// Small enough that sums and differences are numbers, too.
fn within(value: f64) -> f64 {
    value.clamp(-1e300, 1e300)
}

/// Where a run lies along the horizontal axis: runs are as far apart as any others, however long it was between them.
fn x(run: usize, runs: usize) -> f64 {
    let part = if runs > 1 { run as f64 / (runs - 1) as f64 } else { 0.5 };
    LEFT + 8.0 + part * (WIDTH - LEFT - RIGHT - 16.0)
}

/// The unit of a measure.
pub(super) fn unit(measure: &Measure) -> String {
    match measure.kind.as_str() {
        "time" => format!("ns per {}", cut(&measure.per, 24)),
        "bytes" => "bytes".to_owned(),
        _ => "error".to_owned(),
    }
}

/// A text of at most so many characters.
pub(super) fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}

/// The chart; `summary` is what it says in words.
pub(super) fn svg(history: &History, measure: &Measure, summary: &str) -> String {
    let count = history.runs.len();
    let ends = |Interval { median, low, high }: Interval| [median, low, high];
    let dots = || measure.lines.iter().flat_map(|line| &line.dots);
    let scale = Scale::of(dots().flat_map(|dot| ends(dot.value)));
    let mut out =
        format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">", escaped(summary));
    for tick in scale.ticks() {
        let y = scale.y(tick);
        // Writing to a string cannot fail, here and below.
        let _ = write!(
            out,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>\
             <text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            y + 4.0,
            short(tick),
        );
    }
    let first = dots().map(|dot| dot.run).min().unwrap_or(0);
    let last = dots().map(|dot| dot.run).max().unwrap_or(0);
    let mut ends = vec![(first, if first == last { "middle" } else { "start" })];
    ends.extend((first != last).then_some((last, "end")));
    for (run, anchor) in ends {
        let _ = write!(
            out,
            "<text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            x(run, count),
            HEIGHT - 8.0,
            escaped(&day(&history.runs[run].at)),
        );
    }
    for line in &measure.lines {
        let _ = write!(out, "<g class=\"t{}\">", line.track % COLOURS);
        let points =
            line.dots.iter().map(|dot| format!("{:.1},{:.1}", x(dot.run, count), scale.y(dot.value.median)));
        let _ = write!(out, "<polyline points=\"{}\"/>", points.collect::<Vec<_>>().join(" "));
        for dot in &line.dots {
            write_dot(&mut out, dot, x(dot.run, count), &scale, &title(history, measure, dot));
        }
        out.push_str("</g>");
    }
    out.push_str("</svg>");
    out
}

fn write_dot(out: &mut String, dot: &Dot, x: f64, scale: &Scale, title: &str) {
    let [y, low, high] = [dot.value.median, dot.value.low, dot.value.high].map(|value| scale.y(value));
    let title = escaped(title);
    if low - high > 1.0 {
        let _ = write!(out, "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{low:.1}\" y2=\"{high:.1}\"/>");
    }
    // Told apart by shape as well as by colour.
    let _ = match dot.verdict() {
        Verdict::Same => {
            write!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"><title>{title}</title></circle>")
        }
        Verdict::Worse => write!(
            out,
            "<path class=\"worse\" d=\"M{x:.1} {:.1}l7 12h-14z\"><title>{title}</title></path>",
            y - 8.0
        ),
        Verdict::Better => write!(
            out,
            "<path class=\"better\" d=\"M{x:.1} {:.1}l6 -10h-12z\"><title>{title}</title></path>",
            y + 6.0
        ),
    };
}

/// What a dot says when the pointer rests on it.
fn title(history: &History, measure: &Measure, dot: &Dot) -> String {
    let kept = &history.runs[dot.run];
    let commit =
        kept.run.commit.as_deref().map(|commit| format!(", {}", cut(commit, 12))).unwrap_or_default();
    format!("{}{commit}: {} {}{}", cut(&kept.at, 20), value(dot.value), unit(measure), change(dot))
}

/// A value with its interval, where it has one.
pub(super) fn value(Interval { median, low, high }: Interval) -> String {
    if low == high { short(median) } else { format!("{} ({} to {})", short(median), short(low), short(high)) }
}

/// What changed, where something did.
pub(super) fn change(dot: &Dot) -> String {
    let Some(change) = dot.change.as_ref().filter(|change| change.verdict != Verdict::Same) else {
        return String::new();
    };
    let how = if change.verdict == Verdict::Worse { "worse" } else { "better" };
    format!(", {how}: × {}", value(change.ratio))
}

/// The day of a time.
pub(super) fn day(at: &str) -> String {
    cut(at.split('T').next().unwrap_or(at), 10)
}

#[cfg(test)]
mod tests {
    use super::super::tracks::tests::posted;
    use super::*;

    #[test]
    fn every_run_is_in_the_chart_and_changes_have_shapes_of_their_own() {
        let times = [40.0, 48.0, 48.0, 40.0];
        let runs = (1..).zip(times).map(|(day, time)| posted("a", day, time, 1e-6));
        let history = History::of(runs.collect());
        let time = history.measures.iter().find(|m| m.kind == "time").unwrap();
        let svg = svg(&history, time, "a summary");
        for (needle, count) in
            [("<circle", 2), ("class=\"worse\"", 1), ("class=\"better\"", 1), ("<polyline", 1)]
        {
            assert_eq!(svg.matches(needle).count(), count, "{needle}");
        }
        assert!(
            svg.contains("2026-01-02T00:00:00Z, c2: 48 (47.5 to 48.5) ns per light, worse: × 1.2"),
            "{svg}"
        );
        assert!(svg.contains("aria-label=\"a summary\""));
    }

    #[test]
    fn no_value_leaves_the_chart() {
        for values in [
            &[0.0, 0.0][..],
            &[1e308, -1e308],
            &[1e-300, 1e300],
            &[5.0],
            &[],
            &[-3.0, 2.0],
            &[1e-320, 1e-318],
        ] {
            let scale = Scale::of(values.iter().copied());
            for value in values {
                let y = scale.y(*value);
                assert!((TOP..=HEIGHT - BOTTOM).contains(&y), "{values:?}: {y}");
            }
            for tick in scale.ticks() {
                assert!(tick.is_finite(), "{values:?}: {tick}");
            }
        }
        // A thousandth more is not the whole height.
        let scale = Scale::of([100.0, 100.1].into_iter());
        assert!(scale.y(100.0) - scale.y(100.1) < 0.1 * HEIGHT);
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(cut("äöü", 3), "äöü");
        assert_eq!(cut("äöüß", 3), "äö…");
        assert_eq!(day("2026-01-02T03:04:05Z"), "2026-01-02");
    }
}
