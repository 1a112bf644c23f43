//! A base whose directions are moved by a matrix.

use core::marker::PhantomData;

use glam::DVec3;

use super::{Base, Distribution, PolygonBase};
use crate::light::widen;
use crate::{Horizon, InputError, Matrix, Polygon, Real, Vector};

/// A base distribution `Do` whose directions are moved by a matrix `M`, `ω = Mωo / ‖Mωo‖`:
/// `D(ω) = Do(M⁻¹ω / ‖M⁻¹ω‖) · |M⁻¹| / ‖M⁻¹ω‖³` (Heitz et al. 2016, eq. 1). It integrates to 1 over the sphere.
///
/// `M = target_from_base` maps the base's space to the lobe; det M > 0. Its scale is free and kept at 1 for the largest
/// entry. With a [`crate::ClampedCosine`] it is an [`crate::Ltc`].
///
/// ```
/// use glam::{DMat3, DVec3};
/// use ltc_core::{Horizon, LinearlyTransformed, Polygon, Sides, UniformHemisphere};
///
/// let flat = LinearlyTransformed::<f64, UniformHemisphere>::new(DMat3::from_diagonal(DVec3::new(2.0, 2.0, 1.0)))?;
/// let w = flat.sample([0.4, 0.1]);
/// assert!(flat.density(w) > 0.0 && flat.median() == DVec3::Z);
/// // A triangle above the shading point.
/// let light = [DVec3::new(-1.0, -1.0, 1.0), DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)];
/// let fraction = flat.integrate_polygon(&Polygon::new(&light, Sides::One)?, Horizon::BOTH);
/// assert!(fraction > 0.0 && fraction < 1.0);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearlyTransformed<R: Real, B: Base<R>> {
    target_from_base: R::Mat3,
    base_from_target: R::Mat3,
    /// `|M⁻¹|`
    inverse_determinant: R,
    base: PhantomData<B>,
}

impl<R: Real, B: Base<R>> LinearlyTransformed<R, B> {
    /// The distribution of `M = target_from_base`, any positive scale.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite entry; [`InputError::SingularMatrix`] unless det M > 0 and both M⁻¹
    /// and the density are finite in this precision.
    #[inline]
    pub fn new(target_from_base: R::Mat3) -> Result<Self, InputError> {
        let columns = target_from_base.columns();
        if !columns.iter().all(|c| c.is_finite()) {
            return Err(InputError::NotFinite { name: "matrix m" });
        }
        let largest = columns[0].max_abs().max(columns[1].max_abs()).max(columns[2].max_abs());
        if largest <= R::ZERO {
            return Err(InputError::SingularMatrix { determinant: 0.0 });
        }
        // In f64 for either precision: the minors of a narrow lobe cancel, and with f32 products the determinant would be
        // wrong by ε · cond² (six parts in 1e4 at a condition of 100). Polygons do not see that scale; lines do.
        let [c0, c1, c2] = columns.map(|c| widen::<R>(c) / largest.to_f64());
        let rows = [c1.cross(c2), c2.cross(c0), c0.cross(c1)];
        let determinant = c0.dot(rows[0]);
        let inverse_scale = 1.0 / determinant;
        let [r0, r1, r2] = rows.map(|r| narrow::<R>(r * inverse_scale));
        let inverse_determinant = R::of(inverse_scale);
        let valid = determinant > 0.0
            && peak_bound::<R, B>(inverse_determinant).is_finite()
            && [r0, r1, r2].iter().all(|r| r.is_finite());
        if !valid {
            return Err(InputError::SingularMatrix { determinant });
        }
        Ok(Self {
            target_from_base: R::Mat3::from_columns(narrow::<R>(c0), narrow::<R>(c1), narrow::<R>(c2)),
            base_from_target: R::Mat3::from_columns(r0, r1, r2).transposed(),
            inverse_determinant,
            base: PhantomData,
        })
    }

    /// The base itself (M = identity).
    pub fn identity() -> Self {
        let (o, l) = (R::ZERO, R::ONE);
        let identity =
            R::Mat3::from_columns(R::Vec3::new(l, o, o), R::Vec3::new(o, l, o), R::Vec3::new(o, o, l));
        Self {
            target_from_base: identity,
            base_from_target: identity,
            inverse_determinant: l,
            base: PhantomData,
        }
    }

    /// `M`, with its largest entry scaled to 1.
    pub fn target_from_base(&self) -> R::Mat3 {
        self.target_from_base
    }

    /// `M⁻¹`, the inverse of [`LinearlyTransformed::target_from_base`].
    pub fn base_from_target(&self) -> R::Mat3 {
        self.base_from_target
    }

    /// `|M⁻¹|`, above 0.
    pub fn inverse_determinant(&self) -> R {
        self.inverse_determinant
    }

    /// Density at the unit direction `w`, in 1/sr. Finite and not negative for every `w`.
    pub fn density(&self, w: R::Vec3) -> R {
        let density = B::density(self.base_from_target.apply(w), self.inverse_determinant);
        // M⁻¹w of a matrix that is nearly singular in this precision can cancel to nothing.
        if density.is_finite() { density } else { peak_bound::<R, B>(self.inverse_determinant) }
    }

    /// A direction of density [`LinearlyTransformed::density`], from `u` ∈ [0, 1)² (2016 paper, Algorithm 1).
    pub fn sample(&self, u: [R; 2]) -> R::Vec3 {
        self.target_from_base.apply(B::sample(u)).try_unit().unwrap_or_else(|| self.median())
    }

    /// The median direction: every plane through it and the origin halves the lobe (2016 paper, §3.1).
    pub fn median(&self) -> R::Vec3 {
        let [_, _, c2] = self.target_from_base.columns();
        c2.try_unit().unwrap_or(R::Vec3::new(R::ZERO, R::ZERO, R::ONE))
    }

    /// The fraction of the distribution that sees `polygon`, in [0, 1] (2016 paper, eq. 3), in closed form. It is the
    /// integral of the base over the polygon transformed by M⁻¹.
    ///
    /// [`Horizon::cosine`] stands for z = 0 of the base's space, where three of the four bases end. Without it the base is
    /// taken to go on below as its formula has it: the uniform hemisphere uniformly, the cosine negatively, the squared
    /// cosine positively. A uniform sphere has no such horizon.
    ///
    /// Like [`crate::Light::integrate_within`]: exactly 0 for a polygon without area, for a shading point in its plane or
    /// behind a one-sided one, and below the surface's horizon.
    pub fn integrate_polygon(&self, polygon: &Polygon<'_, R>, horizon: Horizon) -> R
    where
        B: PolygonBase<R>,
    {
        B::integrate_polygon(self, polygon, horizon)
    }
}

/// `v`, rounded.
#[inline]
fn narrow<R: Real>(v: DVec3) -> R::Vec3 {
    R::Vec3::new(R::of(v.x), R::of(v.y), R::of(v.z))
}

/// No density exceeds this: ‖M⁻¹ω‖ ≥ ⅓ for a matrix whose largest entry is 1.
fn peak_bound<R: Real, B: Base<R>>(inverse_determinant: R) -> R {
    R::of(27.0 * B::PEAK) * inverse_determinant
}

impl<R: Real, B: Base<R>> Distribution<R> for LinearlyTransformed<R, B> {
    fn density(&self, w: R::Vec3) -> R {
        self.density(w)
    }

    fn sample(&self, u: [R; 2]) -> R::Vec3 {
        self.sample(u)
    }
}
