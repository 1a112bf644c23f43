//! Where magnitude and Fresnel term are off, and what no values of the entries could mend: the limits in `docs/table-shapes.md`.
//!
//!     cargo run --release -p ltc-fit --example channel_limits -- [TABLES]

use std::error::Error;
use std::path::Path;

use ltc_core::Alpha;
use ltc_fit::{Brdf, DiskRule, GgxFamily, Lobe, direction, draw};
use ltc_table::{Catalogue, Mapping};
use rayon::prelude::*;

const THETA_MAPPINGS: [Mapping; 4] =
    [Mapping::Linear, Mapping::HalfTangent, Mapping::GrazingHalfTangent, Mapping::SqrtOneMinusCos];

/// Views, roughnesses and errors of 20,000 lookups up to 89° that no fit has seen, worst first.
fn worst(tables: &Catalogue, name: &str, isotropic: bool) -> Result<(), Box<dyn Error>> {
    let version = tables.find(name)?;
    let table = version.table();
    let rule = DiskRule::of_about(8192);
    let queries = draw::up_to(draw::ALBEDO_THETA_MAX_DEGREES, 20_000, 4711, isotropic);
    let mut errors: Vec<_> = queries
        .par_iter()
        .map_init(Lobe::default, |lobe, query| {
            let widths = Alpha::new(query.alpha_x, query.alpha_y)?;
            let (n, f) = GgxFamily.albedo(direction(query.theta, query.phi), widths, &rule, lobe);
            let found = table.lookup(query)?;
            Ok::<_, Box<dyn Error + Send + Sync>>((found.magnitude - n, found.fresnel - f, *query))
        })
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    errors.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let count = errors.len() as f64;
    for (channel, of) in [("magnitude", 0), ("Fresnel", 1)] {
        let sizes = || errors.iter().map(|(n, f, _)| [n, f][of].abs());
        let (mean, most) = (sizes().sum::<f64>() / count, sizes().fold(0.0, f64::max));
        let beyond = |limit: f64| sizes().filter(|size| *size > limit).count() as f64 / count * 100.0;
        println!(
            "{}@{}, {channel}: mean {mean:.2e}, largest {most:.4}, off by more than 0.01 in {:.2} %, 0.02 in {:.2} %",
            version.manifest().name,
            version.manifest().version,
            beyond(0.01),
            beyond(0.02)
        );
    }
    for (n, f, q) in errors.iter().take(8) {
        println!(
            "  {n:+.4} {f:+.4} at θ {:.2}°, φ {:.1}°, α {:.4} × {:.4}",
            q.theta.to_degrees(),
            q.phi.to_degrees(),
            q.alpha_x,
            q.alpha_y
        );
    }
    Ok(())
}

/// Half the least largest deviation of `values` at `at` from any straight line: by the widest gap over all slopes.
fn best_line(at: &[f64], values: &[f64]) -> f64 {
    let gap = |slope: f64| {
        let residuals = at.iter().zip(values).map(|(x, y)| y - slope * x);
        let (low, high) =
            residuals.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r), h.max(r)));
        0.5 * (high - low)
    };
    // The gap is convex in the slope.
    let (mut low, mut high) = (-100.0, 100.0);
    for _ in 0..200 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if gap(a) < gap(b) { high = b } else { low = a }
    }
    gap(0.5 * (low + high))
}

/// The least largest error of magnitude over θ to 89° on lines where all other axes stand on nodes, so that a lookup is a
/// straight line between two entries, whatever those hold.
fn limit(mapping: Mapping, len: usize) -> (f64, f64, f64) {
    let [low, high] = [0.0, core::f64::consts::FRAC_PI_2].map(|theta| mapping.coordinate(theta));
    let theta_at = |u: f64| mapping.value(low + u * (high - low));
    let rule = DiskRule::of_about(8192);
    let alphas: Vec<f64> = (0..40).map(|i| 0.01 * 100.0_f64.powf(f64::from(i) / 39.0)).collect();
    let rows: Vec<(f64, f64, f64)> = alphas
        .par_iter()
        .map_init(Lobe::default, |lobe, &alpha| {
            let mut worst = (0.0, alpha, 0.0);
            for cell in 0..len - 1 {
                let (from, to) = (cell as f64 / (len - 1) as f64, (cell + 1) as f64 / (len - 1) as f64);
                let (mut at, mut values) = (Vec::new(), Vec::new());
                for i in 0..=24 {
                    let u = from + (to - from) * f64::from(i) / 24.0;
                    let theta = theta_at(u);
                    if theta <= 89_f64.to_radians() {
                        let widths = Alpha::new(alpha, alpha).expect("it is in range");
                        at.push(u);
                        values.push(GgxFamily.albedo(direction(theta, 0.0), widths, &rule, lobe).0);
                    }
                }
                let error = if at.len() > 2 { best_line(&at, &values) } else { 0.0 };
                if error > worst.0 {
                    worst = (error, alpha, theta_at(from).to_degrees());
                }
            }
            worst
        })
        .collect();
    rows.into_iter().fold((0.0, 0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}

/// Degrees between two views of [`cells_needed`].
const STEP: f64 = 0.25;

/// How many cells of θ from 0 to 89° it takes at least, wherever the nodes are, for straight lines in `coordinate` of θ to stay
/// within `error` of magnitude for all α: each cell reaches as far as the best line of each α, whatever its ends, allows.
fn cells_needed(curves: &[Vec<f64>], coordinate: Mapping, error: f64) -> usize {
    let views: Vec<f64> = (0..curves[0].len()).map(|i| (STEP * i as f64).to_radians()).collect();
    let at: Vec<f64> = views.iter().map(|theta| coordinate.coordinate(*theta)).collect();
    let fits = |from: usize, to: usize| {
        curves.iter().all(|values| best_line(&at[from..=to], &values[from..=to]) <= error)
    };
    let (mut from, mut cells) = (0, 0);
    while from + 1 < at.len() {
        let mut to = from + 1;
        while to + 1 < at.len() && fits(from, to + 1) {
            to += 1;
        }
        (from, cells) = (to, cells + 1);
    }
    cells
}

/// Magnitude over θ from 0 to 89° for isotropic α from 0.01 to 1.
fn curves() -> Vec<Vec<f64>> {
    let rule = DiskRule::of_about(8192);
    let alphas: Vec<f64> = (0..24).map(|i| 0.01 * 100.0_f64.powf(f64::from(i) / 23.0)).collect();
    let count = (89.0 / STEP) as usize + 1;
    alphas
        .par_iter()
        .map_init(Lobe::default, |lobe, &alpha| {
            let widths = Alpha::new(alpha, alpha).expect("it is in range");
            let magnitude = |i: usize, lobe: &mut Lobe| {
                let theta = (STEP * i as f64).to_radians();
                GgxFamily.albedo(direction(theta, 0.0), widths, &rule, lobe).0
            };
            (0..count).map(|i| magnitude(i, lobe)).collect()
        })
        .collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let tables = std::env::args().nth(1).unwrap_or_else(|| "tables".to_owned());
    let catalogue = Catalogue::read_folder(Path::new(&tables))?;
    worst(&catalogue, "ggx-isotropic", true)?;
    for version in ["ggx-anisotropic@2", "ggx-anisotropic", "ggx-anisotropic-closed-form"] {
        worst(&catalogue, version, false)?;
    }
    for mapping in THETA_MAPPINGS {
        for len in [8, 12, 16, 24, 32, 64] {
            let (error, alpha, theta) = limit(mapping, len);
            println!("{mapping:?} {len}: at least {error:.4}, at α {alpha:.3} from θ {theta:.1}°");
        }
    }
    let curves = curves();
    for coordinate in THETA_MAPPINGS {
        for error in [0.01, 0.015, 0.02, 0.025] {
            let cells = cells_needed(&curves, coordinate, error);
            println!("nodes anywhere, lines in {coordinate:?}: error {error} takes {} nodes", cells + 1);
        }
    }
    Ok(())
}
