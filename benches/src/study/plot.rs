//! Points over two logarithmic axes, as SVG.

use std::fmt::Write;

pub use ltc_records::short;

/// A point and what it is.
pub struct Mark {
    pub x: f64,
    pub y: f64,
    /// Shown beside the point where there is room, and when the pointer rests on it.
    pub label: String,
}

/// Points of one colour.
pub struct Series {
    pub name: String,
    pub marks: Vec<Mark>,
    /// Whether a line joins them.
    pub joined: bool,
    /// Whether each has its label beside it.
    pub labelled: bool,
}

/// A plot.
pub struct Plot {
    pub x: String,
    pub y: String,
    pub series: Vec<Series>,
}

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 460.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 16.0;
const BOTTOM: f64 = 52.0;
/// Colours that people tell apart whose eyes see colours differently (Okabe and Ito 2008).
const COLOURS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c8c00"];

/// One logarithmic axis.
#[derive(Clone, Copy)]
struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// Holds all `values` with a margin; at least a factor of four wide.
    fn of(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values
            .filter(|x| *x > 0.0 && x.is_finite())
            .fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if low > high { (1.0, 10.0) } else { (low, high) };
        let margin = (high / low).ln().mul_add(0.06, 0.0).max((4.0 / (high / low)).ln() / 2.0).max(0.05);
        Self { low: low.ln() - margin, high: high.ln() + margin, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        let part = (value.max(1e-300).ln() - self.low) / (self.high - self.low);
        self.from + part.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Powers of ten, with 2 and 5 between them where the axis is short, and more where it is very short.
    fn ticks(&self) -> Vec<f64> {
        let decades = (self.high - self.low) / std::f64::consts::LN_10;
        let steps: &[f64] = match decades {
            ..1.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            ..3.5 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let first = (self.low / std::f64::consts::LN_10).floor() as i32;
        let last = (self.high / std::f64::consts::LN_10).ceil() as i32;
        (first..=last)
            .flat_map(|power| steps.iter().map(move |step| step * 10_f64.powi(power)))
            .filter(|x| (self.low..=self.high).contains(&x.ln()))
            .collect()
    }
}

impl Plot {
    /// The plot as an `<svg>` element.
    pub fn svg(&self) -> String {
        let marks = || self.series.iter().flat_map(|s| &s.marks);
        let x = Scale::of(marks().map(|m| m.x), LEFT, WIDTH - RIGHT);
        let y = Scale::of(marks().map(|m| m.y), HEIGHT - BOTTOM, TOP);
        let mut svg = String::new();
        self.axes(&mut svg, x, y);
        // Labels keep off points, too.
        let mut taken: Vec<[f64; 4]> = marks()
            .map(|m| (x.at(m.x), y.at(m.y)))
            .map(|(x, y)| [x - 5.0, y - 5.0, x + 5.0, y + 5.0])
            .collect();
        for (i, series) in self.series.iter().enumerate() {
            series.draw(&mut svg, COLOURS[i % COLOURS.len()], x, y, &mut taken);
        }
        let height = self.legend(&mut svg);
        format!(
            "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{} over {}\">\n{svg}</svg>\n",
            escape(&self.y),
            escape(&self.x)
        )
    }

    fn axes(&self, svg: &mut String, x: Scale, y: Scale) {
        for tick in x.ticks() {
            let at = x.at(tick);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                HEIGHT - BOTTOM,
                HEIGHT - BOTTOM + 18.0,
                short(tick)
            );
        }
        for tick in y.ticks() {
            let at = y.at(tick);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                WIDTH - RIGHT,
                LEFT - 8.0,
                at + 4.0,
                short(tick)
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" class=\"title\">{}</text>",
            0.5 * (LEFT + WIDTH - RIGHT),
            HEIGHT - 8.0,
            escape(&self.x)
        );
        let middle = 0.5 * (TOP + HEIGHT - BOTTOM);
        let _ = writeln!(
            svg,
            "<text transform=\"translate(16 {middle:.1}) rotate(-90)\" text-anchor=\"middle\" class=\"title\">{}</text>",
            escape(&self.y)
        );
    }

    /// What the colours mean, in lines below the plot, where nothing else is; gives the height of all.
    fn legend(&self, svg: &mut String) -> f64 {
        if self.series.len() < 2 {
            return HEIGHT;
        }
        let (mut x, mut y) = (LEFT, HEIGHT + 14.0);
        for (series, colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            let width = 34.0 + text_width(&series.name);
            if x + width > WIDTH && x > LEFT {
                (x, y) = (LEFT, y + 18.0);
            }
            let _ = writeln!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"5\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
                x + 5.0,
                y - 4.0,
                x + 15.0,
                escape(&series.name)
            );
            x += width;
        }
        y + 10.0
    }
}

/// About as wide as a text is.
fn text_width(text: &str) -> f64 {
    6.6 * text.chars().count() as f64
}

impl Series {
    fn draw(&self, svg: &mut String, colour: &str, x: Scale, y: Scale, taken: &mut Vec<[f64; 4]>) {
        if self.joined {
            let points: Vec<String> =
                self.marks.iter().map(|m| format!("{:.1},{:.1}", x.at(m.x), y.at(m.y))).collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
                points.join(" ")
            );
        }
        for mark in &self.marks {
            let (cx, cy) = (x.at(mark.x), y.at(mark.y));
            let _ = writeln!(
                svg,
                "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"4.5\" fill=\"{colour}\"><title>{}: {}, {}</title></circle>",
                escape(&mark.label),
                short(mark.x),
                short(mark.y)
            );
            if self.labelled
                && let Some((tx, ty)) = room(taken, (cx, cy), &mark.label)
            {
                let _ = writeln!(
                    svg,
                    "<text x=\"{tx:.1}\" y=\"{ty:.1}\" style=\"fill:{colour}\">{}</text>",
                    escape(&mark.label)
                );
            }
        }
    }
}

/// Where a label has room beside its point: right or left of it, level or a line above or below.
fn room(taken: &mut Vec<[f64; 4]>, (cx, cy): (f64, f64), label: &str) -> Option<(f64, f64)> {
    let width = text_width(label);
    for line in [0.0, -15.0, 15.0, -30.0, 30.0] {
        for left in [cx + 8.0, cx - 8.0 - width] {
            let area = [left, cy + line - 7.0, left + width, cy + line + 7.0];
            let inside = area[0] > LEFT && area[2] < WIDTH && area[1] > TOP && area[3] < HEIGHT - BOTTOM;
            let free =
                taken.iter().all(|t| area[2] < t[0] || t[2] < area[0] || area[3] < t[1] || t[3] < area[1]);
            if inside && free {
                taken.push(area);
                return Some((left, cy + line + 4.0));
            }
        }
    }
    None
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_the_plot() {
        let mark = |x: f64, y: f64| Mark { x, y, label: "a <b>".into() };
        let series = Series {
            name: "s".into(),
            marks: vec![mark(1.0, 1e-9), mark(1e6, 1.0), mark(5.0, 0.0)],
            joined: true,
            labelled: true,
        };
        let svg = Plot { x: "x".into(), y: "y & z".into(), series: vec![series] }.svg();
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(svg.contains("a &lt;b&gt;") && svg.contains("y &amp; z") && !svg.contains("NaN"));
        // A short axis has several ticks, too.
        for high in [1.01, 3.9, 9.0, 1e3, 1e9] {
            let ticks = Scale::of([1.0, high].into_iter(), 0.0, 1.0).ticks().len();
            assert!((2..15).contains(&ticks), "{ticks} ticks from 1 to {high}");
        }
        let empty = Plot { x: "x".into(), y: "y".into(), series: Vec::new() }.svg();
        assert!(!empty.contains("NaN") && !empty.contains("inf"));
    }
}
