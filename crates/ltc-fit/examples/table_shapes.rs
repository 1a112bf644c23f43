//! Error against bytes for shapes of GGX tables, each fitted as the presets are.
//!
//!     cargo run --release -p ltc-fit --example table_shapes -- docs/images/table-shapes.svg
//!
//! Prints the table of `docs/table-shapes.md` and draws its plot.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use ltc_fit::{FitSpec, fit, measure, silent};
use ltc_table::{Axis, Mapping, Quantity};

/// Bytes of an entry in a texture: three RGBA texels of half floats.
const ENTRY_BYTES: usize = 24;

struct Shape {
    name: &'static str,
    axes: Vec<Axis>,
}

struct Outcome {
    name: &'static str,
    isotropic: bool,
    kilobytes: f64,
    tv: f64,
    row: String,
}

fn main() -> Result<(), Box<dyn Error>> {
    let plot = std::env::args().nth(1).ok_or("name the SVG file to draw")?;
    let mut outcomes = Vec::new();
    for shape in shapes() {
        eprintln!("{}", shape.name);
        outcomes.push(outcome(shape)?);
    }
    println!(
        "| table | axes | entries | f16 texture | mean TV | p95 | max | α<0.14 | α≥0.14 | n mean / max | f mean / max | fit |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for outcome in &outcomes {
        println!("{}", outcome.row);
    }
    let optima = [false, true].map(|isotropic| {
        let queries = ltc_fit::draw::standard(3000, 77, isotropic);
        measure::optimum(&ltc_fit::GgxFamily, &queries, 4096)
            .map(|tv| tv.iter().sum::<f64>() / tv.len() as f64)
    });
    let [anisotropic, isotropic] = optima;
    let (anisotropic, isotropic) = (anisotropic?, isotropic?);
    println!("\nLeast mean TV of any single LTC: anisotropic {anisotropic:.4}, isotropic {isotropic:.4}");
    std::fs::write(plot, draw(&outcomes, [anisotropic, isotropic]))?;
    Ok(())
}

/// As the preset has its axes, with other numbers of nodes.
fn resized(preset: &str, lengths: &[usize]) -> Vec<Axis> {
    let spec = FitSpec::preset(preset).map(|spec| spec.axes).unwrap_or_default();
    spec.into_iter().zip(lengths).map(|(axis, len)| Axis { len: *len, ..axis }).collect()
}

/// Evenly spaced over the whole ranges, as KT et al. 2022 published theirs.
fn published() -> Vec<Axis> {
    use Quantity::{Alpha, Lambda, Phi, Theta};
    [Theta, Phi, Alpha, Lambda].map(|q| Axis::full(q, Mapping::Linear, 8)).to_vec()
}

fn shapes() -> Vec<Shape> {
    let of = |name, lengths: &[usize]| Shape { name, axes: resized("ggx-anisotropic-closed-form", lengths) };
    let square = |name, len| Shape { name, axes: resized("ggx-isotropic", &[len, len]) };
    vec![
        of("4⁴", &[4, 4, 4, 4]),
        of("5⁴", &[5, 5, 5, 5]),
        of("6⁴", &[6, 6, 6, 6]),
        Shape { name: "8⁴, published axes", axes: published() },
        of("8⁴", &[8, 8, 8, 8]),
        of("8×12×7×6", &[8, 12, 7, 6]),
        of("12×8×8×6", &[12, 8, 8, 6]),
        of("8×8×12×6", &[8, 8, 12, 6]),
        of("10⁴", &[10, 10, 10, 10]),
        of("24×8×8×6", &[24, 8, 8, 6]),
        of("12⁴", &[12, 12, 12, 12]),
        square("8²", 8),
        square("16²", 16),
        square("32²", 32),
        square("64²", 64),
    ]
}

fn outcome(shape: Shape) -> Result<Outcome, Box<dyn Error>> {
    let isotropic = shape.axes.len() == 2;
    let mut spec = FitSpec::preset(if isotropic { "ggx-isotropic" } else { "ggx-anisotropic-closed-form" })?;
    spec.axes = shape.axes;
    let start = Instant::now();
    let (table, errors) = fit(&spec, &silent)?;
    let seconds = start.elapsed().as_secs_f64();
    let entries = table.m().len();
    let kilobytes = (entries * ENTRY_BYTES) as f64 / 1024.0;
    let d = &errors.standard_draw;
    let mappings: Vec<&str> = spec.axes.iter().map(|axis| axis.mapping.name()).collect();
    let row = format!(
        "| {} | {} | {entries} | {kilobytes:.1} KiB | {:.4} | {:.4} | {:.3} | {:.4} | {:.4} | {:.1e} / {:.1e} | {:.1e} / {:.1e} | {seconds:.0} s |",
        shape.name,
        mappings.join(", "),
        d.tv_mean,
        d.tv_p95,
        d.tv_max,
        d.tv_mean_alpha_below_0_14,
        d.tv_mean_alpha_from_0_14,
        errors.magnitude_mean,
        errors.magnitude_max,
        errors.fresnel_mean,
        errors.fresnel_max,
    );
    Ok(Outcome { name: shape.name, isotropic, kilobytes, tv: d.tv_mean, row })
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
const MARGINS: [f64; 4] = [70.0, 30.0, 20.0, 55.0]; // left, right, top, bottom
/// Ends of the axes: kibibytes, in powers of two, and mean TV.
const KILOBYTES: [f64; 2] = [1.0, 1024.0];
const TV: [f64; 2] = [0.03, 0.10];

fn place(kilobytes: f64, tv: f64) -> (f64, f64) {
    let [left, right, top, bottom] = MARGINS;
    let x = (kilobytes / KILOBYTES[0]).log2() / (KILOBYTES[1] / KILOBYTES[0]).log2();
    let y = (TV[1] - tv) / (TV[1] - TV[0]);
    (left + x * (WIDTH - left - right), top + y.clamp(0.0, 1.0) * (HEIGHT - top - bottom))
}

/// Mean TV over bytes, with what no single LTC can go below.
fn draw(outcomes: &[Outcome], optima: [f64; 2]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    let mut line = |from: (f64, f64), to: (f64, f64), style: &str| {
        let ((x1, y1), (x2, y2)) = (from, to);
        let _ = writeln!(svg, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>");
    };
    for tv in (3..=10).map(|i| f64::from(i) / 100.0) {
        line(place(KILOBYTES[0], tv), place(KILOBYTES[1], tv), "stroke=\"#ddd\"");
    }
    for power in 0..=10 {
        let kilobytes = f64::from(1 << power);
        line(place(kilobytes, TV[0]), place(kilobytes, TV[1]), "stroke=\"#eee\"");
    }
    for (optimum, colour) in optima.into_iter().zip(["#b33", "#36a"]) {
        let style = format!("stroke=\"{colour}\" stroke-dasharray=\"6 4\"");
        line(place(KILOBYTES[0], optimum), place(KILOBYTES[1], optimum), &style);
    }
    let mut text = |(x, y): (f64, f64), anchor: &str, colour: &str, words: &str| {
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{words}</text>"
        );
    };
    for tv in (3..=10).map(|i| f64::from(i) / 100.0) {
        let (x, y) = place(KILOBYTES[0], tv);
        text((x - 8.0, y + 4.0), "end", "#333", &format!("{tv:.2}"));
    }
    for power in (0..=10).step_by(2) {
        let (x, y) = place(f64::from(1 << power), TV[0]);
        text((x, y + 20.0), "middle", "#333", &format!("{}", 1 << power));
    }
    let (x, y) = place((KILOBYTES[0] * KILOBYTES[1]).sqrt(), TV[0]);
    text((x, y + 42.0), "middle", "#333", "KiB of a half-float texture");
    text((MARGINS[0] + 8.0, MARGINS[2] + 14.0), "start", "#333", "mean total variation");
    // On the left, where no table is near the lines.
    let left = MARGINS[0] + 8.0;
    let mut leaders = Vec::new();
    for ((optimum, colour), words) in optima
        .into_iter()
        .zip(["#b33", "#36a"])
        .zip(["least of any single LTC, anisotropic draw", "least of any single LTC, isotropic draw"])
    {
        text((left, place(1.0, optimum).1 + 16.0), "start", colour, words);
    }
    for (outcome, (at, point)) in outcomes.iter().zip(label_places(outcomes)) {
        let colour = if outcome.isotropic { "#36a" } else { "#b33" };
        text(at, "start", colour, outcome.name);
        leaders.push((at, point));
    }
    for ((x1, y1), (x2, y2)) in leaders {
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {:.1}L{x2:.1} {y2:.1}\" stroke=\"#999\" stroke-width=\"0.7\"/>",
            x1 - 2.0,
            y1 - 4.0
        );
    }
    for outcome in outcomes {
        let (x, y) = place(outcome.kilobytes, outcome.tv);
        let colour = if outcome.isotropic { "#36a" } else { "#b33" };
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Where the labels start, each with its point: to the right, above or below the point, ever farther where other labels are in
/// the way.
fn label_places(outcomes: &[Outcome]) -> Vec<((f64, f64), (f64, f64))> {
    const LINE: f64 = 15.0;
    let mut taken: Vec<(f64, f64, f64)> = Vec::new();
    let mut places = Vec::new();
    for outcome in outcomes {
        let point = place(outcome.kilobytes, outcome.tv);
        let left = point.0 + 12.0;
        let right = left + 5.0 + 7.5 * outcome.name.chars().count() as f64;
        let is_free =
            |y: f64| taken.iter().all(|&(l, r, at)| right < l || r < left || (at - y).abs() >= LINE);
        // 0, 1, −1, 2, −2, … lines away.
        let y = (0..)
            .map(|i: i32| if i % 2 == 1 { -(i + 1) / 2 } else { i / 2 })
            .map(|lines| point.1 + 4.0 + LINE * f64::from(lines))
            .find(|y| is_free(*y))
            .unwrap_or(point.1);
        taken.push((left, right, y));
        places.push(((left, y), point));
    }
    places
}
