//! Lobes: densities over directions that lights are integrated against.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::error::ReferenceError;
use crate::ggx::Ggx;
use crate::points::{R2, cosine_direction};

/// How many directions tell an integrator where a lobe's mass is.
const HINTS: u64 = 192;

/// A density over unit directions, per steradian, normalised or not.
///
/// Every closure `Fn(DVec3) -> f64` is a lobe, too.
pub trait Lobe {
    /// The density at the unit direction `wi`; finite and ≥ 0.
    fn density(&self, wi: DVec3) -> f64;

    /// Inward normals of the half-spaces `n · wi > 0` outside of which the density is zero. Integrators clip there
    /// and so see no kink; the list may be empty.
    fn half_spaces(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// Normals of the planes through the origin along which the density is not smooth. Integrators cut there. The default
    /// is [`Lobe::half_spaces`], whose planes need not be repeated.
    fn kinks(&self) -> Vec<DVec3> {
        self.half_spaces()
    }

    /// Directions spread like the density, so that integrators find a narrow lobe. They place the nodes and do not
    /// enter the result. The default suits lobes that are no narrower than some 10°.
    fn hints(&self) -> Vec<DVec3> {
        hints_from(|u| Some(cosine_direction(u)))
    }
}

impl<F: Fn(DVec3) -> f64> Lobe for F {
    fn density(&self, wi: DVec3) -> f64 {
        self(wi)
    }
}

/// The directions that `sample` makes of a fixed set of points.
pub(crate) fn hints_from(sample: impl Fn([f64; 2]) -> Option<DVec3>) -> Vec<DVec3> {
    let points = R2::new();
    (0..HINTS).filter_map(|i| sample(points.point(i))).collect()
}

/// The clamped cosine `max(0, cos θ) / π`: Lambert's lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CosineLobe;

impl Lobe for CosineLobe {
    fn density(&self, wi: DVec3) -> f64 {
        wi.z.max(0.0) / PI
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }
}

/// A linearly transformed cosine with matrix `M = target_from_cosine`.
///
/// `D(w) = max(0, z') / π · |det M⁻¹| / |M⁻¹ w|³`, z' the z of the unit vector along `M⁻¹ w`
/// (Aakash et al. 2022, eq. 7 with a clamped cosine; Heitz et al. 2016, eq. 1). It integrates to 1 over the sphere, part
/// of which may lie below the surface's horizon: wrap it in [`AboveHorizon`] to cut that off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LtcLobe {
    target_from_cosine: DMat3,
    cosine_from_target: DMat3,
    /// `|det M⁻¹|`.
    inverse_determinant: f64,
}

impl LtcLobe {
    /// The lobe of an invertible matrix; its overall scale has no effect.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`], [`ReferenceError::SingularMatrix`].
    pub fn new(target_from_cosine: DMat3) -> Result<Self, ReferenceError> {
        if !target_from_cosine.is_finite() {
            return Err(ReferenceError::NonFiniteInput { what: "LTC matrix" });
        }
        // Scaling to unit size first keeps the determinant of tiny and huge matrices representable.
        let size = target_from_cosine.to_cols_array().into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let determinant = target_from_cosine.determinant();
        if size == 0.0 {
            return Err(ReferenceError::SingularMatrix { determinant });
        }
        let scaled = target_from_cosine * (1.0 / size);
        let cosine_from_target = scaled.inverse();
        let inverse_determinant = cosine_from_target.determinant().abs();
        if scaled.determinant() == 0.0 || !cosine_from_target.is_finite() || !inverse_determinant.is_finite()
        {
            return Err(ReferenceError::SingularMatrix { determinant });
        }
        Ok(Self { target_from_cosine: scaled, cosine_from_target, inverse_determinant })
    }

    /// M, scaled so that its largest entry has size 1.
    pub fn target_from_cosine(&self) -> DMat3 {
        self.target_from_cosine
    }

    /// M⁻¹ of the scaled M.
    pub fn cosine_from_target(&self) -> DMat3 {
        self.cosine_from_target
    }

    /// Draws a direction with density [`Lobe::density`] from a point of [0, 1)².
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        (self.target_from_cosine * cosine_direction(u)).normalize_or(DVec3::Z)
    }
}

impl Lobe for LtcLobe {
    fn density(&self, wi: DVec3) -> f64 {
        let w = self.cosine_from_target * wi;
        let length = w.length();
        if w.z <= 0.0 || length == 0.0 {
            return 0.0;
        }
        let cosine = w.z / length;
        cosine / PI * self.inverse_determinant / (length * length * length)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![self.cosine_from_target.row(2)]
    }

    fn hints(&self) -> Vec<DVec3> {
        hints_from(|u| Some(self.sample(u)))
    }
}

/// A convex combination of LTCs.
#[derive(Clone, Debug, PartialEq)]
pub struct LtcMixture {
    /// (weight, lobe); weights are ≥ 0 and sum to 1 in a normalised mixture.
    pub parts: Vec<(f64, LtcLobe)>,
}

impl Lobe for LtcMixture {
    fn density(&self, wi: DVec3) -> f64 {
        self.parts.iter().map(|(weight, lobe)| weight * lobe.density(wi)).sum()
    }

    fn kinks(&self) -> Vec<DVec3> {
        self.parts.iter().flat_map(|(_, lobe)| lobe.kinks()).collect()
    }

    fn hints(&self) -> Vec<DVec3> {
        self.parts.iter().flat_map(|(_, lobe)| lobe.hints()).collect()
    }
}

/// The cosine-weighted GGX BRDF at F = 1, seen from `wo`. Its integral is the magnitude n, not 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GgxLobe {
    /// The material.
    pub ggx: Ggx,
    /// Unit view direction, at or above the horizon.
    pub wo: DVec3,
}

impl Lobe for GgxLobe {
    fn density(&self, wi: DVec3) -> f64 {
        self.ggx.eval_cos(self.wo, wi)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }

    fn hints(&self) -> Vec<DVec3> {
        hints_from(|u| self.ggx.sample(self.wo, u).map(|(wi, _)| wi))
    }
}

/// A lobe cut off at the surface's horizon: its density is zero for `wi.z <= 0`. Nothing is renormalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AboveHorizon<L>(pub L);

impl<L: Lobe> Lobe for AboveHorizon<L> {
    fn density(&self, wi: DVec3) -> f64 {
        if wi.z > 0.0 { self.0.density(wi) } else { 0.0 }
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        let mut half_spaces = self.0.half_spaces();
        half_spaces.push(DVec3::Z);
        half_spaces
    }

    fn kinks(&self) -> Vec<DVec3> {
        let mut kinks = self.0.kinks();
        kinks.push(DVec3::Z);
        kinks
    }

    fn hints(&self) -> Vec<DVec3> {
        self.0.hints()
    }
}

/// A lobe times a constant, e.g. GGX divided by its magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<L> {
    /// The lobe.
    pub lobe: L,
    /// The factor.
    pub factor: f64,
}

impl<L: Lobe> Lobe for Scaled<L> {
    fn density(&self, wi: DVec3) -> f64 {
        self.factor * self.lobe.density(wi)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        self.lobe.half_spaces()
    }

    fn kinks(&self) -> Vec<DVec3> {
        self.lobe.kinks()
    }

    fn hints(&self) -> Vec<DVec3> {
        self.lobe.hints()
    }
}
