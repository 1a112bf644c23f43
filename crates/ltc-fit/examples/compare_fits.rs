//! What the choice of objective, method, form and start comes to: the tables of `docs/fit-objectives.md`.
//!
//! ```sh
//! cargo run --release -p ltc-fit --example compare_fits -- draw|forms|continuation
//! ```

use std::error::Error;
use std::time::Instant;

use glam::DMat3;
use ltc_core::{Alpha, InputError, Ltc, points::r2};
use ltc_fit::entries::{EntrySettings, EntryStage};
use ltc_fit::objective::{SlicedWasserstein, cube_of_lobe, kl, l3};
use ltc_fit::{
    Brdf as _, DiskPoints, EntryFit, FitError, FitSpec, GgxFamily, Lattice, Lobe, Node, Objective, Optimiser,
    Pattern, direction, draw, measure, median_start, refine_by, refine_by_simplex, silent, total_variation,
};
use ltc_table::Query;
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    match std::env::args().nth(1).as_deref() {
        Some("draw") => compare_on_draw()?,
        Some("forms") => compare_forms()?,
        Some("continuation") => compare_starts()?,
        _ => return Err("usage: compare_fits draw|forms|continuation".into()),
    }
    Ok(())
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    sum / f64::from(count.max(1))
}

/// Samples that no fit here sees.
fn unseen() -> DiskPoints {
    DiskPoints::new(4096, [0.1, 0.7])
}

fn sampled(query: &Query, points: &DiskPoints) -> Result<Lobe, InputError> {
    let mut lobe = Lobe::default();
    let alpha = Alpha::new(query.alpha_x, query.alpha_y)?;
    GgxFamily.sample_lobe(direction(query.theta, query.phi), alpha, points, &mut lobe);
    Ok(lobe)
}

fn at_node(node: &Node, points: &DiskPoints) -> Result<Lobe, InputError> {
    let alpha = node.widths()?;
    sampled(&Query { theta: node.theta, phi: node.phi, alpha_x: alpha.x(), alpha_y: alpha.y() }, points)
}

/// Every objective's best LTC for each query of the standard draws, and what the others say of it.
fn compare_on_draw() -> Result<(), InputError> {
    const QUERIES: usize = 500;
    println!("| draw | lowered | by | TV | W / spread | L³ / ∫p³ | KL | leak | evaluations | ms an entry |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for isotropic in [true, false] {
        let queries = draw::standard(QUERIES, 77, isotropic);
        for objective in Objective::ALL {
            on_draw(isotropic, &queries, objective, false)?;
        }
        on_draw(isotropic, &queries, Objective::TotalVariation, true)?;
    }
    Ok(())
}

fn on_draw(
    isotropic: bool,
    queries: &[Query],
    objective: Objective,
    simplex: bool,
) -> Result<(), InputError> {
    let points = DiskPoints::new(2048, [0.5, 0.5]);
    let start = Instant::now();
    let fits: Result<Vec<EntryFit>, InputError> = queries
        .par_iter()
        .map(|query| {
            let lobe = sampled(query, &points)?;
            let start = median_start(&lobe, direction(query.theta, query.phi), Pattern::General);
            let goal = objective.towards(&lobe);
            Ok(if simplex {
                refine_by_simplex(&goal, start, Pattern::General, 1000)
            } else {
                refine_by(&goal, start, Pattern::General, 300)
            })
        })
        .collect();
    let (fits, seconds) = (fits?, start.elapsed().as_secs_f64());
    let points = unseen();
    let scores: Result<Vec<[f64; 4]>, InputError> = queries
        .par_iter()
        .zip(&fits)
        .map(|(query, fit)| {
            let lobe = sampled(query, &points)?;
            let sliced = SlicedWasserstein::new(&lobe);
            let wasserstein = sliced.value(fit.m) / sliced.spread();
            Ok([
                total_variation(&lobe, fit.m),
                wasserstein,
                l3(&lobe, fit.m) / cube_of_lobe(&lobe),
                kl(&lobe, fit.m),
            ])
        })
        .collect();
    let scores = scores?;
    let score = |k: usize| mean(scores.iter().map(|s| s[k]));
    println!(
        "| {} | {} | {} | {:.4} | {:.4} | {:.4} | {:.4} | {:.2} % | {:.0} | {:.1} |",
        if isotropic { "isotropic" } else { "anisotropic" },
        objective.name(),
        if simplex { "Nelder-Mead" } else { "BFGS" },
        score(0),
        score(1),
        score(2),
        score(3),
        100.0 * mean(fits.iter().map(|fit| measure::leak(fit.m))),
        mean(fits.iter().map(|fit| fit.evaluations as f64)),
        1e3 * seconds * rayon::current_num_threads() as f64 / queries.len() as f64,
    );
    Ok(())
}

/// A preset's lattice, fitted entry by entry.
fn fitted(
    spec: &FitSpec,
    lattice: &Lattice,
    objective: Objective,
    settings: EntrySettings,
) -> Result<Vec<EntryFit>, FitError> {
    let owners = lattice.owners();
    let (axes, brdf) = (&spec.axes, &GgxFamily);
    let stage = EntryStage { brdf, axes, lattice, owners: &owners, objective, settings };
    stage.fit(0..owners.len(), &silent)
}

/// The forms of the papers and the blog over the isotropic preset's 64² entries.
fn compare_forms() -> Result<(), FitError> {
    let spec = FitSpec::preset("ggx-isotropic")?;
    let lattice = Lattice::new(&spec.axes, &spec.floors);
    println!("| lowered | by | TV mean | TV max | L³ / ∫p³ | behind | evaluations | s of two cores |");
    println!("|---|---|---|---|---|---|---|---|");
    for objective in [Objective::TotalVariation, Objective::L3] {
        for optimiser in Optimiser::ALL {
            let settings = EntrySettings { optimiser, ..EntrySettings::new(512, 300) };
            let start = Instant::now();
            let fits = fitted(&spec, &lattice, objective, settings)?;
            let seconds = start.elapsed().as_secs_f64();
            form_row(&lattice, objective, optimiser, &fits, seconds)?;
        }
    }
    Ok(())
}

fn form_row(
    lattice: &Lattice,
    objective: Objective,
    optimiser: Optimiser,
    fits: &[EntryFit],
    seconds: f64,
) -> Result<(), FitError> {
    let points = unseen();
    let mut tv = Vec::new();
    let mut l3_share = Vec::new();
    let mut behind = Vec::new();
    for (node, fit) in lattice.nodes.iter().zip(fits) {
        let lobe = at_node(node, &points)?;
        tv.push(total_variation(&lobe, fit.m));
        l3_share.push(l3(&lobe, fit.m) / cube_of_lobe(&lobe));
        if node.theta > 1.2 && node.alpha < 0.3 {
            behind.push(share_behind(fit.m)?);
        }
    }
    println!(
        "| {} | {} | {:.4} | {:.3} | {:.4} | {:.1} % | {:.0} | {seconds:.1} |",
        objective.name(),
        optimiser.name(),
        mean(tv.iter().copied()),
        tv.iter().copied().fold(0.0, f64::max),
        mean(l3_share.into_iter()),
        100.0 * mean(behind.into_iter()),
        mean(fits.iter().map(|fit| fit.evaluations as f64)),
    );
    Ok(())
}

/// The share of an LTC above the ground on the viewer's side (φ = 0).
fn share_behind(m: DMat3) -> Result<f64, InputError> {
    const N: usize = 1000;
    let ltc = Ltc::<f64>::new(m)?;
    let samples = (0..N).map(|i| ltc.sample(r2(i, [0.5, 0.5])));
    Ok(samples.filter(|w| w.x > 0.0 && w.z > 0.0).count() as f64 / N as f64)
}

/// What continuing from the neighbours adds to the median start.
fn compare_starts() -> Result<(), FitError> {
    println!(
        "| preset | lowered | entries | lower by > 1e-4 | > 1e-3 | > 1e-2 | mean gain | mean gain, unseen samples |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for preset in ["ggx-isotropic", "ggx-anisotropic"] {
        let spec = FitSpec::preset(preset)?;
        let lattice = Lattice::new(&spec.axes, &spec.floors);
        for objective in [Objective::TotalVariation, Objective::L3] {
            let with = |continuation| {
                let settings = EntrySettings { continuation, ..spec.entries };
                fitted(&spec, &lattice, objective, settings)
            };
            let (alone, continued) = (with(false)?, with(true)?);
            starts_row(&lattice, preset, objective, &alone, &continued)?;
        }
    }
    Ok(())
}

fn starts_row(
    lattice: &Lattice,
    preset: &str,
    objective: Objective,
    alone: &[EntryFit],
    continued: &[EntryFit],
) -> Result<(), FitError> {
    let points = unseen();
    let (mut gains, mut gains_unseen) = (Vec::new(), Vec::new());
    for ((index, a), b) in lattice.owners().into_iter().zip(alone).zip(continued) {
        let lobe = at_node(&lattice.nodes[index], &points)?;
        let goal = objective.towards(&lobe);
        gains.push((a.value - b.value) / goal.unit());
        gains_unseen.push((goal.value(a.m) - goal.value(b.m)) / goal.unit());
    }
    let above = |limit: f64| gains.iter().filter(|gain| **gain > limit).count();
    println!(
        "| {preset} | {} | {} | {} | {} | {} | {:.1e} | {:.1e} |",
        objective.name(),
        gains.len(),
        above(1e-4),
        above(1e-3),
        above(1e-2),
        mean(gains.iter().copied()),
        mean(gains_unseen.into_iter()),
    );
    Ok(())
}
