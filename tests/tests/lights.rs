//! Lights of every kind: CPU f32 and every GPU driver that can run here against CPU f64, by one body.

use core::f64::consts::FRAC_PI_2;

use ltc_fit::draw;
use ltc_shade_gpu::{LightJob, LightKind};
use ltc_tests::{
    LightBackEnd, LightsF64, condition, light_back_ends, light_jobs, lit_share, matrix, table, tolerance,
    wide,
};

/// Triples of material, view and light for each kind of light.
const TRIPLES: usize = 100_000;

/// Half of the triples over the standard draw of the anisotropic table, half over wider domains of both tables.
fn triples(kind: LightKind) -> Vec<LightJob> {
    let (anisotropic, isotropic) = (table("ggx-anisotropic"), table("ggx-isotropic"));
    let seed = 100 + kind as u64;
    let standard = draw::standard(TRIPLES / 2, seed, false);
    let mut jobs = light_jobs(kind, &anisotropic, &standard, seed);
    jobs.extend(light_jobs(kind, &anisotropic, &wide(TRIPLES / 4, 0.0, FRAC_PI_2, seed), seed + 50));
    jobs.extend(light_jobs(kind, &isotropic, &wide(TRIPLES / 4, 1.0, FRAC_PI_2, seed), seed + 60));
    jobs
}

/// The largest error over what is allowed at each job's condition number, and where it is.
fn largest_excess(jobs: &[LightJob], values: &[f64], truth: &[f64]) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (i, (job, (value, truth))) in jobs.iter().zip(values.iter().zip(truth)).enumerate() {
        assert!((0.0..=1.0).contains(value), "{value}: {job:?}");
        let allowed = tolerance::LIGHTS * (condition(matrix(job)) / 100.0).max(1.0);
        let excess = (value - truth).abs() / allowed;
        if excess > worst.0 {
            worst = (excess, i);
        }
    }
    worst
}

#[test]
fn random_triples_agree_on_all_back_ends() {
    let back_ends = light_back_ends();
    let mut failures = Vec::new();
    for kind in LightKind::ALL {
        let jobs = triples(kind);
        let truth = LightsF64.fractions(&jobs).unwrap();
        let lit = lit_share(&truth);
        assert!(lit > 0.05, "{kind}: only {lit} of the triples are lit");
        for back_end in &back_ends {
            let values = back_end.fractions(&jobs).unwrap();
            let absolute = values.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let (excess, at) = largest_excess(&jobs, &values, &truth);
            println!(
                "{kind}, {}: up to {absolute:.1e}, {excess:.2} of what is allowed; {:.0} % lit",
                back_end.name(),
                100.0 * lit
            );
            if excess > 1.0 {
                failures.push(format!(
                    "{kind}, {}: {} for {}, {excess} of what is allowed: {:?}",
                    back_end.name(),
                    values[at],
                    truth[at],
                    jobs[at]
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
