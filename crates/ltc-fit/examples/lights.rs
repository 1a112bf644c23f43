//! The error that is seen: random square lights by tables of isotropic LTCs against sampled GGX.
//!
//!     cargo run --release -p ltc-fit --example lights -- [TABLES [PUBLISHED]]
//!
//! 3,600 lights over the isotropic draw: squares of half-width 0.1 to 1.6 at distance 2, facing the shading point, centred within 40°
//! of the mirror direction, turned at random. The error is in the fraction of the lobe that sees the light. Beside its size, its
//! mean with sign: positive is too bright. `relative` is the RMSE over the root
//! mean square of the fractions themselves, as pictures are judged.

use std::error::Error;
use std::path::Path;

use glam::{DMat3, DVec3};
use ltc_core::{Alpha, Horizon, Light, Ltc, Matrix, Polygon, Sides, points::SplitMix64};
use ltc_fit::{Brdf, DiskPoints, GgxFamily, Layout, Lobe, Pattern, Reader, direction, draw, fit_entry};
use ltc_table::{Catalogue, DropIn, Query};
use rayon::prelude::*;

const LIGHTS: usize = 3600;
const SAMPLES: usize = 1 << 15;
const DISTANCE: f64 = 2.0;
/// Farthest from the mirror direction.
const SPREAD_DEGREES: f64 = 40.0;

struct Case {
    query: Query,
    corners: [DVec3; 4],
    truth: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let tables = arguments.next().unwrap_or_else(|| "tables".to_owned());
    let published = arguments.next();
    let cases = cases()?;
    let bright = cases.iter().map(|c| c.truth).sum::<f64>() / LIGHTS as f64;
    println!("{LIGHTS} lights, mean fraction {bright:.3}");
    println!(
        "{:34} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}",
        "", "RMSE", "mean", "p95", "max", "signed", "relative"
    );
    if let Some(folder) = published {
        let read = |file: &str| std::fs::read(Path::new(&folder).join("ltc_code").join(file));
        let textures = Reader::DropIn(Box::new(DropIn::read_dds(&read("ltc_1.dds")?, &read("ltc_2.dds")?)?));
        through(&textures, "published 64²", &cases)?;
    }
    let catalogue = Catalogue::read_folder(Path::new(&tables))?;
    for (name, layout) in [("ggx-isotropic", Layout::Matrix), ("ggx-isotropic-dropin", Layout::DropIn)] {
        through(&layout.reader(catalogue.find(name)?.table())?, name, &cases)?;
    }
    let points = DiskPoints::new(2048, [0.5, 0.5]);
    let best: Result<Vec<DMat3>, ltc_core::InputError> = cases
        .par_iter()
        .map_init(Lobe::default, |lobe, case| {
            let wo = direction(case.query.theta, 0.0);
            GgxFamily.sample_lobe(wo, case.query.validate()?, &points, lobe);
            Ok(fit_entry(lobe, wo, Pattern::MirrorY, 300).m)
        })
        .collect();
    report("least TV of any single LTC", &cases, &best?)?;
    Ok(())
}

fn through(reader: &Reader<'_>, name: &str, cases: &[Case]) -> Result<(), Box<dyn Error>> {
    let m: Result<Vec<DMat3>, _> = cases
        .iter()
        .map(|case| reader.lookup(&case.query).map(|found| DMat3::from_row_array(found.lobes[0].m)))
        .collect();
    report(name, cases, &m?)
}

fn report(name: &str, cases: &[Case], m: &[DMat3]) -> Result<(), Box<dyn Error>> {
    for (horizon, what) in [(Horizon::BOTH, ""), (Horizon::COSINE, ", leaking")] {
        let mut errors = Vec::new();
        for (case, m) in cases.iter().zip(m) {
            let polygon = Polygon::<f64>::new(&case.corners, Sides::Two)?;
            errors.push(polygon.integrate_within(&Ltc::<f64>::new(*m)?, horizon) - case.truth);
        }
        let n = LIGHTS as f64;
        let rmse = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
        let truth = (cases.iter().map(|c| c.truth * c.truth).sum::<f64>() / n).sqrt();
        let mut sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        println!(
            "{:34} {rmse:8.4} {:8.4} {:8.4} {:8.4} {:+9.4} {:8.2} %",
            format!("{name}{what}"),
            sizes.iter().sum::<f64>() / n,
            sizes[LIGHTS * 95 / 100],
            sizes[LIGHTS - 1],
            errors.iter().sum::<f64>() / n,
            100.0 * rmse / truth,
        );
    }
    Ok(())
}

fn cases() -> Result<Vec<Case>, Box<dyn Error>> {
    let mut rng = SplitMix64::new(41);
    let mut places = Vec::new();
    for query in draw::standard(LIGHTS, 42, true) {
        let query = Query { phi: 0.0, ..query };
        let mirror = direction(query.theta, core::f64::consts::PI);
        let centre = loop {
            // Uniform in the cap around the mirror direction, above the horizon.
            let cos = 1.0 - (1.0 - SPREAD_DEGREES.to_radians().cos()) * rng.unit();
            let (sin, turn) = ((1.0 - cos * cos).max(0.0).sqrt(), rng.range(0.0, core::f64::consts::TAU));
            let (t, b) = mirror.any_orthonormal_pair();
            let centre = mirror * cos + (t * turn.cos() + b * turn.sin()) * sin;
            if centre.z > 0.0 {
                break centre;
            }
        };
        let half = rng.range(0.1, 1.6);
        let (t, b) = centre.any_orthonormal_pair();
        let (sin, cos) = rng.range(0.0, core::f64::consts::TAU).sin_cos();
        let (u, v) = ((t * cos + b * sin) * half, (b * cos - t * sin) * half);
        let c = centre * DISTANCE;
        places.push((query, [c - u - v, c + u - v, c + u + v, c - u + v]));
    }
    let points = DiskPoints::new(SAMPLES, [0.13, 0.58]);
    let cases: Result<Vec<Case>, ltc_core::InputError> = places
        .par_iter()
        .map_init(Lobe::default, |lobe, (query, corners)| {
            let alpha = Alpha::new(query.alpha_x, query.alpha_y)?;
            GgxFamily.sample_lobe(direction(query.theta, 0.0), alpha, &points, lobe);
            let hits = |i: usize| inside(corners, lobe.direction(i));
            let truth = (0..lobe.len()).filter(|i| hits(*i)).map(|i| lobe.weight[i]).sum();
            Ok(Case { query: *query, corners: *corners, truth })
        })
        .collect();
    Ok(cases?)
}

/// Whether a ray from the origin meets a parallelogram.
fn inside([c0, c1, _, c3]: &[DVec3; 4], ray: DVec3) -> bool {
    let (u, v) = (*c1 - *c0, *c3 - *c0);
    let normal = u.cross(v);
    let along = ray.dot(normal);
    let distance = c0.dot(normal) / along;
    if !(distance > 0.0 && distance.is_finite()) {
        return false;
    }
    let place = ray * distance - *c0;
    let (a, b) = (place.dot(u) / u.length_squared(), place.dot(v) / v.length_squared());
    (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b)
}
