//! The page and the plot of all sweeps.

use std::fmt::Write;

use super::{Bound, Form, Outcome, Sweep};

/// Everything measured: for each sweep, its values, and for each value the outcome of each shape.
pub struct Page {
    /// By sweep, value and shape.
    pub sweeps: Vec<(Sweep, Vec<f64>, Vec<Vec<Outcome>>)>,
    /// Nanoseconds in `f32` and `f64`, by shape.
    pub times: Vec<[f64; 2]>,
    /// Cases at each value.
    pub count: usize,
}

impl Page {
    /// Runs every sweep with `count` cases for each shape and value.
    pub fn measure(count: usize, times: Vec<[f64; 2]>) -> Self {
        let sweeps = Sweep::ALL.map(|sweep| {
            let values = sweep.values();
            let row = |value: f64| Form::ALL.map(|form| Outcome::of(sweep, value, form, count)).to_vec();
            let outcomes = std::thread::scope(|scope| {
                let rows: Vec<_> = values.iter().map(|value| scope.spawn(move || row(*value))).collect();
                rows.into_iter().map(|row| row.join().unwrap_or_default()).collect()
            });
            (sweep, values, outcomes)
        });
        Self { sweeps: sweeps.to_vec(), times, count }
    }

    /// The page, in Markdown. `command` is what makes it, `machine` what it ran on.
    pub fn markdown(&self, command: &str, machine: &str) -> String {
        let mut page = format!(
            "# Rounding errors of every light, and what each costs\n\n\
             Made by `{command}`: {} random cases of each shape at each value. Inputs are exact in `f32`; errors are absolute, of a \
             fraction in [0, 1], against quadrature along the light's boundary (for lines and strips, along the line) in numbers of 31 \
             digits, which shares no code with `ltc-core` and is itself tested against quadrature over surfaces. The bounds: `f64` \
             1e-9 for polygons, lines and strips, 1e-8 for disks, ellipses and spheres, 1e-6 for wide cylinders; `f32` 2e-5 for \
             polygons, 1e-4 for the rest, times cond(M)/100 where that exceeds 1. A share of 1 would reach the bound of `f32`.\n\n\
             ![Largest errors over each sweep](images/stability.svg)\n\n## Cost\n\n\
             One integration over a lobe with both horizons cut, shapes and lobes ready made, on {machine}.\n\n\
             | shape | f32, ns | f64, ns | f32 max error over all sweeps | its share of the bound | f64 max error |\n|---|---|---|---|---|---|\n",
            self.count
        );
        for (i, form) in Form::ALL.iter().enumerate() {
            let worst = self.worst(i);
            let [single, double] = self.times[i];
            let _ = writeln!(
                page,
                "| {} | {single:.0} | {double:.0} | {:.1e} | {:.2} | {:.1e} |",
                form.name(),
                worst.f32_max,
                worst.f32_share,
                worst.f64_max
            );
        }
        for (sweep, values, outcomes) in &self.sweeps {
            table(&mut page, *sweep, values, outcomes);
        }
        page + include_str!("hazards.md")
    }

    /// The largest of everything that shape `i` has shown.
    pub fn worst(&self, i: usize) -> Outcome {
        let mut worst = Outcome::default();
        for outcome in self.sweeps.iter().flat_map(|(_, _, outcomes)| outcomes).map(|row| row[i]) {
            worst.f32_max = worst.f32_max.max(outcome.f32_max);
            worst.f32_rms = worst.f32_rms.max(outcome.f32_rms);
            worst.f32_share = worst.f32_share.max(outcome.f32_share);
            worst.f64_max = worst.f64_max.max(outcome.f64_max);
            worst.brightest = worst.brightest.max(outcome.brightest);
        }
        worst
    }

    /// Shapes that exceed their [`Bound`], in words.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (sweep, values, outcomes) in &self.sweeps {
            for (value, row) in values.iter().zip(outcomes) {
                for (form, o) in Form::ALL.iter().zip(row) {
                    if o.f32_share > 1.0 || o.f64_max > Bound::of(*form).f64_at_most {
                        faults.push(format!(
                            "{}, {} {value:e}: f32 {:.1e} ({:.2} of {:?}), f64 {:.1e}",
                            form.name(),
                            sweep.name(),
                            o.f32_max,
                            o.f32_share,
                            Bound::of(*form),
                            o.f64_max
                        ));
                    }
                }
            }
        }
        faults
    }
}

/// Powers of ten as such, moderate numbers in full.
fn label(value: f64) -> String {
    if (0.01..=100.0).contains(&value) { value.to_string() } else { format!("{value:e}") }
}

fn table(page: &mut String, sweep: Sweep, values: &[f64], outcomes: &[Vec<Outcome>]) {
    let _ = writeln!(page, "\n## Over {}\n\nf32 max (RMS), f64 max.\n", sweep.name());
    let names: Vec<_> = Form::ALL.iter().map(|form| form.name()).collect();
    let _ = writeln!(page, "| | {} |\n|---{}|", names.join(" | "), "|---".repeat(names.len()));
    for (value, row) in values.iter().zip(outcomes) {
        let cells: Vec<String> =
            row.iter().map(|o| format!("{:.0e} ({:.0e}), {:.0e}", o.f32_max, o.f32_rms, o.f64_max)).collect();
        let _ = writeln!(page, "| {} | {} |", label(*value), cells.join(" | "));
    }
}

const COLOURS: [&str; 9] =
    ["#111111", "#1f77b4", "#d62728", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#17becf"];
const PANEL: [f64; 2] = [380.0, 270.0];
/// Errors from 1e-18 to 1.
const DECADES: f64 = 18.0;

/// One panel a sweep; solid lines for `f32`, dashed for `f64`, logarithmic both ways.
pub fn chart(page: &Page) -> String {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1320 720\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"1320\" height=\"720\" fill=\"white\"/>\n",
    );
    for (i, (sweep, values, outcomes)) in page.sweeps.iter().enumerate() {
        let (left, top) = (60.0 + 430.0 * (i % 3) as f64, 50.0 + 340.0 * (i / 3) as f64);
        panel(&mut svg, [left, top], *sweep, values, outcomes);
    }
    for (i, form) in Form::ALL.iter().enumerate() {
        let x = 60.0 + 112.0 * i as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{x} 18h22\" stroke=\"{}\" stroke-width=\"2\"/><text x=\"{}\" y=\"22\">{}</text>",
            COLOURS[i],
            x + 27.0,
            form.name()
        );
    }
    svg += "<text x=\"1110\" y=\"22\">solid: f32, dashed: f64</text>\n</svg>\n";
    svg
}

fn panel(svg: &mut String, [left, top]: [f64; 2], sweep: Sweep, values: &[f64], outcomes: &[Vec<Outcome>]) {
    let [width, height] = PANEL;
    let x = |value: f64| {
        let (low, high) = (values[0].log10(), values[values.len() - 1].log10());
        left + width * (value.log10() - low) / (high - low)
    };
    let y = |error: f64| top + height * (-error.max(1e-18).log10() / DECADES).clamp(0.0, 1.0);
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#888\"/>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        left + width / 2.0,
        top + height + 32.0,
        sweep.name()
    );
    for decade in (0..=18).step_by(3) {
        let at = y(10f64.powi(-decade));
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {at}h{width}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            left - 5.0,
            at + 4.0,
            label(10f64.powi(-decade))
        );
    }
    for value in values {
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            x(*value),
            top + height + 15.0,
            label(*value)
        );
    }
    for (i, colour) in COLOURS.iter().enumerate() {
        for (dash, error) in
            [("none", (|o: &Outcome| o.f32_max) as fn(&Outcome) -> f64), ("5 4", |o| o.f64_max)]
        {
            let points: Vec<String> = values
                .iter()
                .zip(outcomes)
                .map(|(value, row)| format!("{:.1},{:.1}", x(*value), y(error(&row[i]))))
                .collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\" stroke-dasharray=\"{dash}\"/>",
                points.join(" ")
            );
        }
    }
}
