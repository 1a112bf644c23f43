//! Figure 5 of the 2022 paper: the sorted projections whose mean difference is the sliced Wasserstein distance.

use std::error::Error;
use std::path::Path;

use glam::DMat3;
use ltc_fit::objective::SlicedWasserstein;
use ltc_fit::{Objective, Pattern, refine_by};

use crate::canvas::Canvas;
use crate::cases::Case;
use crate::colour::{BLUE, FAINT, INK, ORANGE, Rgb};
use crate::text::ADVANCE;

const SIZE: usize = 260;
const LEFT: usize = 60;
const TOP: usize = 62;
const GAP: usize = 40;
const AREA: Rgb = [236, 228, 200];

/// Plots projections on one axis against rank, at the identity and after the fit.
pub fn figure(path: &Path) -> Result<(), Box<dyn Error>> {
    let case = Case { theta: 50.0, phi: 45.0, alpha: [0.4, 0.2], cap: None };
    let lobe = case.lobe(4096, [0.5, 0.5])?;
    let sliced = SlicedWasserstein::new(&lobe);
    let fit = refine_by(&Objective::SlicedWasserstein.towards(&lobe), DMat3::IDENTITY, Pattern::General, 300);
    let mut canvas = Canvas::new(LEFT + 3 * (SIZE + GAP), TOP + SIZE + 60);
    let title = format!("GGX {}, SORTED PROJECTIONS:", case.name());
    canvas.write(&title, LEFT, 8, 2, INK);
    let right = LEFT + 2 * ADVANCE * (title.chars().count() + 1);
    canvas.write("GGX", right, 8, 2, ORANGE);
    canvas.write("LTC", right + 8 * ADVANCE, 8, 2, BLUE);
    // The axis along which the identity is farthest off.
    let off = |a: usize| mean_difference(&sliced.projections(DMat3::IDENTITY, a));
    let axes = sliced.axes();
    let worst = (0..axes.len()).fold(0, |best, a| if off(a) > off(best) { a } else { best });
    let other = (0..axes.len()).min_by(|a, b| {
        let across = |k: &usize| axes[*k].dot(axes[worst]).abs();
        across(a).total_cmp(&across(b))
    });
    let panels = [
        ("IDENTITY", DMat3::IDENTITY, worst),
        ("FITTED", fit.m, worst),
        ("FITTED, ACROSS", fit.m, other.unwrap_or(0)),
    ];
    for (i, (name, m, a)) in panels.into_iter().enumerate() {
        let projections = sliced.projections(m, a);
        let title = format!("{name}: {:.4}", mean_difference(&projections));
        panel(&mut canvas, LEFT + i * (SIZE + GAP), &title, &projections);
    }
    println!(
        "\nFigure 5 of the 2022 paper, {}: sliced Wasserstein {:.4} at the identity, {:.4} fitted\n",
        case.name(),
        sliced.value(DMat3::IDENTITY),
        fit.value
    );
    canvas.save(path)
}

fn mean_difference((f, g): &(Vec<f64>, Vec<f64>)) -> f64 {
    f.iter().zip(g).map(|(f, g)| (f - g).abs()).sum::<f64>() / f.len() as f64
}

fn panel(canvas: &mut Canvas, left: usize, title: &str, (f, g): &(Vec<f64>, Vec<f64>)) {
    canvas.write(title, left, TOP - 22, 2, INK);
    // Projections are in [−1, 1].
    let height = |p: f64| TOP + ((1.0 - p) * 0.5 * (SIZE - 1) as f64).round().max(0.0) as usize;
    for value in [-1.0, 0.0, 1.0] {
        canvas.fill(left, height(value), SIZE, 1, FAINT);
        canvas.write_centred(&value.to_string(), left - 16, height(value) - 3, 1, INK);
    }
    canvas.fill(left, TOP, 1, SIZE, FAINT);
    let at = |values: &[f64], column: usize| values[(column * values.len()) / SIZE];
    for column in 0..SIZE {
        let (a, b) = (height(at(f, column)), height(at(g, column)));
        canvas.fill(left + column, a.min(b), 1, a.abs_diff(b), AREA);
    }
    for (values, colour) in [(g, ORANGE), (f, BLUE)] {
        for column in 0..SIZE {
            let (here, next) = (height(at(values, column)), height(at(values, (column + 1).min(SIZE - 1))));
            canvas.fill(left + column, here.min(next), 1, here.abs_diff(next) + 2, colour);
        }
    }
    canvas.write_centred("RANK OF THE SAMPLE", left + SIZE / 2, TOP + SIZE + 10, 1, INK);
}
