//! Polygons whose colour varies: a prefiltered texture fetched once.

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

/// A place and width to fetch a texture at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureFetch<R: Real> {
    /// Coordinates, anywhere: the texture is defined beyond its square.
    pub uv: [R; 2],
    /// Standard deviation of the filter in units of the texture's sides; may be infinite.
    pub sigma: R,
}

/// A flat polygon with a texture: the exact form for how much of the lobe sees it, one prefiltered fetch for its colour
/// (Heitz et al. 2016, §5.2–5.4, eq. 12: `I ≈ I_D · I_L`).
///
/// Radiance is the texture's colour. Exact for a texture of one colour. For others the colour is that of a round Gaussian
/// around the shading point's projection onto the light in cosine space; it knows neither the cosine's fall-off nor what the
/// horizons cut away, so that rough lobes near large, busy textures see a colour that is off. Measured against cubature
/// over random lobes and lights (`tests/textured.rs`), as a fraction of the brightest texel: a smooth gradient RMSE 0.015, a
/// checkerboard of 4 × 4 RMSE 0.026. The paper's σ is right: 0.85 or 1.2 times it gains nothing on both, half of it doubles the
/// error.
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
        if !(frame.origin.is_finite() && frame.axis_u.is_finite() && frame.axis_v.is_finite()) {
            return Err(InputError::NotFinite { name: "texture frame" });
        }
        let spans = frame.axis_u.try_unit().zip(frame.axis_v.try_unit());
        if spans.and_then(|(u, v)| u.cross(v).try_unit()).is_none() {
            return Err(InputError::Degenerate { name: "texture frame" });
        }
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
        let [origin, second, _, last] = *vertices;
        let frame = TextureFrame { origin, axis_u: second - origin, axis_v: last - origin };
        Self::new(vertices, sides, frame, texture)
    }

    /// What `ltc` sees of the light, per channel: the share of the lobe times the filtered colour, in the texture's units.
    pub fn integrate_colour(&self, ltc: &Ltc<R>, horizon: Horizon) -> [R; 3] {
        let share = self.integrate_within(ltc, horizon);
        if share <= R::ZERO {
            return [R::ZERO; 3];
        }
        let TextureFetch { uv, sigma } = self.texture_fetch(ltc);
        let colour = self.texture.fetch(uv.map(Real::to_f64), sigma.to_f64());
        colour.map(|c| share * R::of(f64::from(c)))
    }

    /// Where the texture is fetched: the projection of the shading point onto the light's plane in cosine space, with
    /// `σ = √(r²/2A)`, r its distance from the plane and A the texture's area there (§5.4).
    pub fn texture_fetch(&self, ltc: &Ltc<R>) -> TextureFetch<R> {
        let m = ltc.cosine_from_target();
        let [o, u, v] = [self.frame.origin, self.frame.axis_u, self.frame.axis_v].map(|x| m.apply(x));
        let middle = TextureFetch { uv: [R::of(0.5); 2], sigma: R::ONE / R::TINY };
        // Common scale out: the fetch does not depend on it, and its fourth power must neither over- nor underflow.
        let scale = o.max_abs().max(u.max_abs()).max(v.max_abs());
        let shrink = R::ONE / scale;
        if !(scale > R::ZERO && shrink.is_finite()) {
            return middle;
        }
        let [o, u, v] = [o * shrink, u * shrink, v * shrink];
        let normal = u.cross(v);
        let square = normal.dot(normal);
        if square <= R::TINY {
            return middle;
        }
        let height = normal.dot(o);
        // −o = u·x + v·y + normal·z
        let x = v.cross(o).dot(normal) / square;
        let y = o.cross(u).dot(normal) / square;
        let variance = height * height / (R::of(2.0) * square * square.sqrt());
        let fetch = TextureFetch { uv: [x, y], sigma: variance.sqrt() };
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
