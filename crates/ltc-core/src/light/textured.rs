//! Polygons whose colour varies: a prefiltered texture fetched twice.

use glam::DVec3;

use super::wide::{shrink, widened};
use super::{Horizon, Light, Polygon, Sides};
use crate::texture::PrefilteredTexture;
use crate::{InputError, Ltc, Matrix, Real, Vector};

/// How a texture lies in space: (u, v) is at `origin + u · axis_u + v · axis_v`, relative to the shading point in the
/// shading frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureFrame<R: Real> {
    /// Where (0, 0) is.
    pub origin: R::Vec3,
    /// From (0, 0) to (1, 0).
    pub axis_u: R::Vec3,
    /// From (0, 0) to (0, 1).
    pub axis_v: R::Vec3,
}

impl<R: Real> TextureFrame<R> {
    /// A parallelogram's own: (0, 0) at the first corner, (1, 0) at the second, (0, 1) at the last.
    pub fn filling(corners: &[R::Vec3; 4]) -> Self {
        let [origin, second, _, last] = *corners;
        Self { origin, axis_u: second - origin, axis_v: last - origin }
    }

    /// Whether it spans a plane.
    ///
    /// # Errors
    /// [`InputError::NotFinite`]; [`InputError::Degenerate`] for axes that are zero or parallel.
    pub fn check(&self) -> Result<(), InputError> {
        if !(self.origin.is_finite() && self.axis_u.is_finite() && self.axis_v.is_finite()) {
            return Err(InputError::NotFinite { name: "texture frame" });
        }
        let spans = self.axis_u.try_unit().zip(self.axis_v.try_unit());
        let normal = spans.and_then(|(u, v)| u.cross(v).try_unit());
        normal.map(drop).ok_or(InputError::Degenerate { name: "texture frame" })
    }
}

/// A place and width to fetch a texture at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureFetch<R: Real> {
    /// Coordinates, anywhere: the texture is defined beyond its square.
    pub uv: [R; 2],
    /// Standard deviation of the paper's one Gaussian in units of the texture's sides; may be infinite.
    pub sigma: R,
}

/// The standard deviations of the two Gaussians whose mean is the filter, over [`TextureFetch::sigma`]: √½ and √5.
pub const TEXTURE_SIGMAS: [f64; 2] = [core::f64::consts::FRAC_1_SQRT_2, 2.236_067_977_499_79];

/// A flat polygon with a texture: the exact form for how much of the lobe sees it, prefiltered fetches for its colour
/// (Heitz et al. 2016, §5.2–5.4, eq. 12: `I ≈ I_D · I_L`).
///
/// Radiance is the texture's colour. Exact for a texture of one colour. For others the colour is what two round Gaussians
/// around the shading point's projection onto the light in cosine space see in the mean. The paper has one. But a cosine at
/// distance r from a plane falls as `(1 + ρ²/r²)⁻²` with the distance ρ there, the mean of Gaussians whose `r²/2σ²` is
/// exponentially distributed: a narrow and a wide one ([`TEXTURE_SIGMAS`]) come nearer. What is left: the filter is round in
/// the texture while the light may be stretched in cosine space, and it does not know what the horizons cut away, so that lobes
/// that are stretched along large, busy textures see a colour that is off.
///
/// RMSE against cubature over random lobes and lights (`tests/textured.rs`), as a fraction of the brightest texel:
///
/// | | gradient | checkerboard of 4 × 4 |
/// |---|---|---|
/// | two Gaussians | 0.013 | 0.016 |
/// | one, as in the paper | 0.0145 | 0.026 |
#[derive(Clone, Copy, Debug)]
pub struct TexturedPolygon<'a, R: Real> {
    polygon: Polygon<'a, R>,
    frame: TextureFrame<R>,
    texture: &'a PrefilteredTexture,
}

impl<'a, R: Real> TexturedPolygon<'a, R> {
    /// A polygon of any shape in the plane of `frame`. Where it does not fill the square, the texture's coverage should be
    /// the polygon's.
    ///
    /// # Errors
    /// Those of [`Polygon::new`]; [`InputError::NotFinite`] and [`InputError::Degenerate`] for a frame that spans no plane.
    pub fn new(
        vertices: &'a [R::Vec3],
        sides: Sides,
        frame: TextureFrame<R>,
        texture: &'a PrefilteredTexture,
    ) -> Result<Self, InputError> {
        let polygon = Polygon::new(vertices, sides)?;
        frame.check()?;
        Ok(Self { polygon, frame, texture })
    }

    /// A parallelogram that the texture fills: (0, 0) at the first vertex, u towards the second, v towards the last.
    ///
    /// # Errors
    /// Those of [`TexturedPolygon::new`].
    pub fn filled(
        vertices: &'a [R::Vec3; 4],
        sides: Sides,
        texture: &'a PrefilteredTexture,
    ) -> Result<Self, InputError> {
        Self::new(vertices, sides, TextureFrame::filling(vertices), texture)
    }

    /// What `ltc` sees of the light, per channel: the share of the lobe times the filtered colour, in the texture's units.
    pub fn integrate_colour(&self, ltc: &Ltc<R>, horizon: Horizon) -> [R; 3] {
        let share = self.integrate_within(ltc, horizon);
        if share <= R::ZERO {
            return [R::ZERO; 3];
        }
        let TextureFetch { uv, sigma } = self.texture_fetch(ltc);
        let uv = uv.map(Real::to_f64);
        let [narrow, wide] = TEXTURE_SIGMAS.map(|factor| self.texture.fetch(uv, factor * sigma.to_f64()));
        core::array::from_fn(|c| share * R::of(0.5 * (f64::from(narrow[c]) + f64::from(wide[c]))))
    }

    /// Where the texture is fetched: the projection of the shading point onto the light's plane in cosine space, with
    /// `σ = √(r²/2A)`, r its distance from the plane and A the texture's area there (§5.4).
    ///
    /// Nothing is taken to cosine space for it: with o, u, v the frame, `w = u × v` and `b = Mᵀ w`, the normal there up to its
    /// length, the place is `(Mᵀ(v × o)·b, Mᵀ(o × u)·b) / b²`, and `σ² = det M (w·o)² / (2 |b|³)`. In f64 for either precision.
    pub fn texture_fetch(&self, ltc: &Ltc<R>) -> TextureFetch<R> {
        let middle = TextureFetch { uv: [R::of(0.5); 2], sigma: R::ONE / R::TINY };
        let m = ltc.target_from_cosine().columns().map(widened::<R>);
        let transposed = |v: DVec3| DVec3::from_array(m.map(|column| column.dot(v)));
        let [o, u, v] = [self.frame.origin, self.frame.axis_u, self.frame.axis_v].map(widened::<R>);
        // Common scale out: the fetch does not depend on it, and its sixth power must neither over- nor underflow.
        let scale = [o, u, v].map(|x| x.abs().max_element()).into_iter().fold(0.0, f64::max);
        let Some(factor) = shrink(scale) else { return middle };
        let [o, u, v] = [o * factor, u * factor, v * factor];
        let w = u.cross(v);
        let b = transposed(w);
        let square = b.length_squared();
        if square <= f64::MIN_POSITIVE {
            return middle;
        }
        let place = [v.cross(o), o.cross(u)].map(|along| transposed(along).dot(b) / square);
        let height = w.dot(o) / b.length();
        let determinant = m[0].dot(m[1].cross(m[2])).max(0.0);
        let sigma = height.abs() * (0.5 * determinant / b.length()).sqrt();
        let fetch = TextureFetch { uv: place.map(R::of), sigma: R::of(sigma) };
        let sound = fetch.uv.iter().all(|c| c.is_finite()) && fetch.sigma.is_finite();
        if sound { fetch } else { middle }
    }
}

impl<R: Real> Light<R> for TexturedPolygon<'_, R> {
    /// As if the texture were white.
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        self.polygon.integrate_within(ltc, horizon)
    }
}
