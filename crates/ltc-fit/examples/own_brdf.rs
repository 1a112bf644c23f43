//! A table for a BRDF of one's own, Blinn–Phong: `cargo run --release -p ltc-fit --example own_brdf`.

use glam::DVec3;
use ltc_core::Alpha;
use ltc_fit::{Brdf, FitError, FitSpec, fit_with, silent};

struct BlinnPhong;

impl Brdf for BlinnPhong {
    fn name(&self) -> &'static str {
        "blinn-phong"
    }

    /// `ρ cos θi = (n + 2)(n + 4) / (8π (2^(−n/2) + n)) cosⁿ θh cos θi`, as wide as a GGX lobe of α when n = 2/α².
    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        let n = 2.0 / alpha.major().powi(2);
        let norm = (n + 2.0) * (n + 4.0) / (8.0 * std::f64::consts::PI * ((-0.5 * n).exp2() + n));
        norm * (wo + wi).normalize_or(DVec3::Z).z.powf(n) * wi.z
    }
}

/// Fits a small table and prints its error.
pub fn main() -> Result<(), FitError> {
    let mut spec = FitSpec::preset("beckmann-isotropic")?;
    (spec.name, spec.brdf) = ("my-blinn-phong".to_owned(), BlinnPhong.name().to_owned());
    spec.axes.iter_mut().for_each(|axis| axis.len = 8);
    (spec.joint.queries, spec.channels.samples) = (256, 2048);
    (spec.measure.queries, spec.measure.samples) = (300, 2048);
    let (table, errors) = fit_with(&BlinnPhong, &spec, &silent)?;
    let query = ltc_table::Query { theta: 0.7, phi: 0.0, alpha_x: 0.4, alpha_y: 0.4 };
    println!("at theta 0.7, alpha 0.4: {:?}", table.lookup(&query)?);
    println!("mean total variation of {} entries: {:.4}", table.m().len(), errors.standard_draw.tv_mean);
    Ok(())
}
