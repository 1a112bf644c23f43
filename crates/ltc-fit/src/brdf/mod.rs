//! The materials that tables are fitted to: one trait, and a file for each family.

use glam::DVec3;
use ltc_core::{Alpha, Vector, schlick_weight};
use serde_json::{Value, json};

use crate::{DiskPoints, DiskRule, Lobe};

mod beckmann;
mod charlie;
mod check;
mod disney_diffuse;
mod ggx;
mod oren_nayar;
mod presets;
pub mod proposal;

pub use beckmann::Beckmann;
pub use charlie::CharlieSheen;
pub(crate) use check::check;
pub use disney_diffuse::DisneyDiffuse;
pub use ggx::GgxFamily;
pub(crate) use ggx::lambda_cos;
pub use oren_nayar::OrenNayar;
pub(crate) use presets::preset;

/// A BRDF family of two widths.
///
/// [`Brdf::name`] and [`Brdf::eval_cos`] are all that a new material has to say; everything else has a default that
/// suits lobes of any width. Whoever knows how to draw from his lobes says so by [`Brdf::sample`] and [`Brdf::pdf`] and
/// gets the same accuracy from fewer samples.
///
/// What the widths mean is each family's own choice, said in its documentation. Tables fold α_x < α_y into a turn by 90°,
/// so that exchanging both widths must turn the lobe.
pub trait Brdf: Sync {
    /// Its name in manifests and specifications.
    fn name(&self) -> &'static str;

    /// The cosine-weighted BRDF `ρ(ωo, ωi) cos θi` in 1/sr, at F = 1 or base colour 1; finite and ≥ 0.
    ///
    /// `wo` and `wi` are unit vectors above the horizon (z > 0) in the shading frame.
    fn eval_cos(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64;

    /// The weight of F90 against F0 in [0, 1], for the table's Fresnel channel `f = ∫ weight ρ cos`.
    ///
    /// The default is Schlick's `(1 − ωo·ωh)^5` for a mirror-like microsurface. A material without such a term returns 0:
    /// its channel is then 0 and the reflectance `F0·n + (F90 − F0)·f` is colour × magnitude, whatever F90 is.
    fn fresnel_weight(&self, wo: DVec3, wi: DVec3) -> f64 {
        (wo + wi).try_unit().map_or(0.0, |wh| schlick_weight(wo.dot(wh)))
    }

    /// No magnitude `n = ∫ ρ cos` is larger: fitted channels are kept below. 1 unless the model makes energy; may be infinite.
    fn max_magnitude(&self) -> f64 {
        1.0
    }

    /// What a manifest says about it: the variant, the meaning of α, magnitude and Fresnel.
    fn parameters(&self) -> Value {
        json!({})
    }

    /// A light direction for the point `u` of [0, 1)², with density [`Brdf::pdf`]; it may lie below the horizon.
    ///
    /// The default mixes the cosine, the whole hemisphere, and visible normals of GGX of the same widths
    /// ([`proposal::mixture`]). Evaluated with the density of the mixture, that is multiple importance sampling with
    /// the balance heuristic.
    fn sample(&self, wo: DVec3, alpha: Alpha, u: [f64; 2]) -> DVec3 {
        proposal::mixture(wo, alpha, u)
    }

    /// The density of [`Brdf::sample`] in 1/sr; positive wherever [`Brdf::eval_cos`] is.
    fn pdf(&self, wo: DVec3, wi: DVec3, alpha: Alpha) -> f64 {
        proposal::mixture_pdf(wo, wi, alpha)
    }

    /// Magnitude and Fresnel term of the lobe, by `rule`. Unless a BRDF knows better, by as many samples of the lobe.
    fn albedo(&self, wo: DVec3, alpha: Alpha, rule: &DiskRule, lobe: &mut Lobe) -> (f64, f64) {
        self.sample_lobe(wo, alpha, &rule.points, lobe);
        (lobe.magnitude, lobe.fresnel)
    }

    /// Replaces `lobe` by samples of the cosine-weighted BRDF seen from `wo`, one for each of `points` that leads above
    /// the horizon.
    ///
    /// Values that are negative or no number count as 0 (a fit refuses such a BRDF before it begins). A lobe without any
    /// energy has magnitude 0 and the shape of the clamped cosine, so that its entry is a valid one.
    fn sample_lobe(&self, wo: DVec3, alpha: Alpha, points: &DiskPoints, lobe: &mut Lobe) {
        let n = points.len();
        lobe.clear();
        for u in &points.square {
            let wi = self.sample(wo, alpha, *u);
            if wi.z.is_nan() || wi.z <= 0.0 {
                continue;
            }
            let pdf = self.pdf(wo, wi, alpha);
            let inverse = 1.0 / (n as f64 * pdf);
            if !(inverse > 0.0 && inverse.is_finite()) {
                continue;
            }
            let weight = self.eval_cos(wo, wi, alpha) / pdf;
            let weight = if weight > 0.0 && weight.is_finite() { weight } else { 0.0 };
            lobe.push(wi, weight, inverse);
            lobe.fresnel += weight * self.fresnel_weight(wo, wi);
        }
        if lobe.is_dark() {
            lobe.become_cosine();
        } else {
            lobe.finish(n);
        }
    }
}

/// The families of this crate.
static FAMILIES: [&dyn Brdf; 5] = [&GgxFamily, &Beckmann, &DisneyDiffuse, &OrenNayar, &CharlieSheen];

/// The family of that name, if this crate has it.
pub fn by_name(name: &str) -> Option<&'static dyn Brdf> {
    FAMILIES.into_iter().find(|brdf| brdf.name() == name)
}

/// Names of the families of this crate, separated by commas.
pub fn names() -> String {
    FAMILIES.map(Brdf::name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_family_is_found_by_its_name() {
        for brdf in FAMILIES {
            assert_eq!(by_name(brdf.name()).unwrap().name(), brdf.name());
        }
        assert!(by_name("phong").is_none());
        assert!(names().contains("oren-nayar, charlie-sheen"));
    }

    /// Reflects into a cone that no sample of the default reaches, or not at all.
    struct Dark;

    impl Brdf for Dark {
        fn name(&self) -> &'static str {
            "dark"
        }

        fn eval_cos(&self, _: DVec3, _: DVec3, _: Alpha) -> f64 {
            0.0
        }
    }

    #[test]
    fn a_lobe_without_energy_has_magnitude_0_and_the_shape_of_the_cosine() {
        let (alpha, points) = (Alpha::isotropic(0.3).unwrap(), DiskPoints::new(4096, [0.5, 0.5]));
        let mut lobe = Lobe::default();
        for theta in [0.0, 1.5] {
            Dark.sample_lobe(crate::direction(theta, 0.0), alpha, &points, &mut lobe);
            assert_eq!((lobe.magnitude, lobe.fresnel), (0.0, 0.0));
            assert!((lobe.weight.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(crate::total_variation(&lobe, glam::DMat3::IDENTITY) < 0.02);
            assert!(
                crate::total_variation(&lobe, glam::DMat3::from_diagonal(DVec3::new(0.2, 0.2, 1.0))) > 0.3
            );
        }
    }
}
