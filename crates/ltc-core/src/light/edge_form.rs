//! Edge terms, exact and fast, each a named choice.

use super::boundary::clip_to_surface;
use super::{Horizon, Polygon, Quad};
use crate::{Ltc, Matrix as _, Real, Vector as _};

/// How an edge of a polygon is integrated over the clamped cosine: by `θ / sin θ` from `cos θ`, θ the angle it spans.
///
/// The term of an edge is `(a × b) θ / sin θ` for unit vectors a, b (2016 paper, eq. 11); its z component sums to the
/// irradiance. [`crate::Light::integrate`] does not go through here: it is exact, and on a CPU it is faster, too. These are
/// the forms that shaders choose from, clipped geometrically as theirs, but at both horizons.
///
/// | form | `θ / sin θ`, relative, θ ≤ 90° | fraction, max | fraction, RMS |
/// |---|---|---|---|
/// | [`Exact`] | 0 | 1e-6 | 5e-8 |
/// | [`Rational`] | 6.9e-7 | 1e-6 | 1e-7 |
/// | [`PublishedRational`] | 1.5e-6 | 2e-5; up to ½ for edges near π | 3e-7 |
/// | [`Cubic`] | 6.9e-4 | 6e-4 | 1e-4 |
///
/// Fractions: in `f32`, against the exact value in `f64`, over 100,000 rectangles of half-widths 0.1 to 1.6, two units
/// away and up to 100° off the axes of lobes of widths 0.01 to 1, which lean by up to 75° (kept true by
/// `tests/edge_forms.rs`).
pub trait EdgeForm {
    /// `θ / sin θ` for unit vectors with `cosine` between them and `sine` ≥ 0, the length of their cross product.
    fn angle_over_sine<R: Real>(cosine: R, sine: R) -> R;
}

/// `atan2(sin θ, cos θ) / sin θ`.
#[derive(Clone, Copy, Debug)]
pub enum Exact {}

/// A rational function of own making, (2, 2) in |cos θ|; beyond 90° by `π / sin θ − f(|cos θ|)` with the sine from the
/// cross product, so that edges near π keep their value.
#[derive(Clone, Copy, Debug)]
pub enum Rational {}

/// The rational function that is in wide use (the 2016 paper's published code), with its floor of 1e-7 on `1 − cos² θ`: beyond
/// 179.98° an edge loses up to all of its value.
#[derive(Clone, Copy, Debug)]
pub enum PublishedRational {}

/// A cubic polynomial in |cos θ|: no division up to 90°.
#[derive(Clone, Copy, Debug)]
pub enum Cubic {}

impl EdgeForm for Exact {
    fn angle_over_sine<R: Real>(cosine: R, sine: R) -> R {
        if sine <= R::TINY { R::ONE } else { sine.atan2(cosine) / sine }
    }
}

impl EdgeForm for Rational {
    fn angle_over_sine<R: Real>(cosine: R, sine: R) -> R {
        let x = cosine.abs();
        let p = (x * R::of(0.02636736429281853) + R::of(0.9094871845950676)) * x + R::of(1.5707956598117154);
        let q = (x * R::of(0.29106498538762376) + R::of(1.215583519207149)) * x + R::ONE;
        beyond_a_right_angle(p / q, cosine, sine)
    }
}

impl EdgeForm for PublishedRational {
    fn angle_over_sine<R: Real>(cosine: R, _sine: R) -> R {
        let x = cosine.abs();
        let p = (x * R::of(0.0145206) + R::of(0.4965155)) * x + R::of(0.8543985);
        let q = (x + R::of(4.1616724)) * x + R::of(3.4175940);
        let turns = p / q;
        let floored = (R::ONE - cosine * cosine).max(R::of(1e-7));
        let turns = if cosine > R::ZERO { turns } else { R::of(0.5) / floored.sqrt() - turns };
        turns * R::of(core::f64::consts::TAU)
    }
}

impl EdgeForm for Cubic {
    fn angle_over_sine<R: Real>(cosine: R, sine: R) -> R {
        let x = cosine.abs();
        let f = ((R::of(0.5693809462627465) - R::of(0.17653781982590686) * x) * x
            - R::of(0.9632504391472412))
            * x
            + R::of(1.5697257840000132);
        beyond_a_right_angle(f, cosine, sine)
    }
}

/// `π / sin θ − f` for obtuse θ, where `f` belongs to π − θ.
fn beyond_a_right_angle<R: Real>(f: R, cosine: R, sine: R) -> R {
    if cosine < R::ZERO && sine > R::TINY { R::PI / sine - f } else { f }
}

/// Clips against z ≥ 0 as vertices come in, and sums the edges of what is left.
struct EdgeSum<R: Real> {
    cut: bool,
    first_in: Option<R::Vec3>,
    previous_in: Option<R::Vec3>,
    /// Of what is left, as unit vectors.
    first: Option<R::Vec3>,
    previous: Option<R::Vec3>,
    sum: R::Vec3,
}

impl<R: Real> EdgeSum<R> {
    fn push<F: EdgeForm>(&mut self, vertex: R::Vec3) {
        if let Some(previous) = self.previous_in {
            self.clip::<F>(previous, vertex);
        } else {
            self.first_in = Some(vertex);
        }
        self.previous_in = Some(vertex);
    }

    /// Emits where the edge crosses the horizon, and its end.
    fn clip<F: EdgeForm>(&mut self, from: R::Vec3, to: R::Vec3) {
        if !self.cut {
            return self.emit::<F>(to);
        }
        let (from_in, to_in) = (from.z() >= R::ZERO, to.z() >= R::ZERO);
        if from_in != to_in {
            let point = from * to.z().abs() + to * from.z().abs();
            self.emit::<F>(R::Vec3::new(point.x(), point.y(), R::ZERO));
        }
        if to_in {
            self.emit::<F>(to);
        }
    }

    fn emit<F: EdgeForm>(&mut self, vertex: R::Vec3) {
        let Some(v) = vertex.try_unit() else { return };
        match self.previous {
            Some(previous) => self.edge::<F>(previous, v),
            None => self.first = Some(v),
        }
        self.previous = Some(v);
    }

    fn edge<F: EdgeForm>(&mut self, a: R::Vec3, b: R::Vec3) {
        let normal = a.cross(b);
        self.sum += normal * F::angle_over_sine(a.dot(b), normal.length());
    }

    /// The sum over all edges: 2π times the vector form factor.
    fn finish<F: EdgeForm>(mut self) -> R::Vec3 {
        if let (Some(last), Some(first)) = (self.previous_in, self.first_in) {
            self.clip::<F>(last, first);
        }
        if let (Some(last), Some(first)) = (self.previous, self.first) {
            self.edge::<F>(last, first);
        }
        self.sum
    }
}

/// 2π times the vector form factor of a polygon in cosine space, cut as asked.
fn vector_sum<R: Real, F: EdgeForm>(vertices: &[R::Vec3], ltc: &Ltc<R>, horizon: Horizon) -> R::Vec3 {
    let zero = R::Vec3::new(R::ZERO, R::ZERO, R::ZERO);
    let mut sum: EdgeSum<R> = EdgeSum {
        cut: horizon.cosine,
        first_in: None,
        previous_in: None,
        first: None,
        previous: None,
        sum: zero,
    };
    let inverse = ltc.cosine_from_target();
    // Any scale will do; a largest coordinate of about 1 keeps products in range.
    let largest = vertices.iter().fold(R::TINY, |m, v| m.max(v.max_abs()));
    let mut push = |v: R::Vec3| {
        let scaled = R::Vec3::new(v.x() / largest, v.y() / largest, v.z() / largest);
        sum.push::<F>(inverse.apply(scaled));
    };
    if horizon.surface {
        clip_to_surface::<R>(vertices, push);
    } else {
        vertices.iter().for_each(|v| push(*v));
    }
    sum.finish::<F>()
}

impl<R: Real> Polygon<'_, R> {
    /// [`crate::Light::integrate_within`] with the edge term `F`, clipped geometrically at both horizons, in the precision
    /// `R` throughout. For what each form costs in accuracy see [`EdgeForm`].
    ///
    /// ```
    /// use glam::Vec3;
    /// use ltc_core::{Horizon, Light, Ltc, Polygon, Rational, Sides};
    /// let light = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| Vec3::new(x, y, 1.0));
    /// let polygon = Polygon::<f32>::new(&light, Sides::One)?;
    /// let fast = polygon.integrate_with::<Rational>(&Ltc::cosine(), Horizon::BOTH);
    /// assert!((fast - polygon.irradiance()).abs() < 1e-6);
    /// # Ok::<(), ltc_core::InputError>(())
    /// ```
    pub fn integrate_with<F: EdgeForm>(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let Some(orientation) = self.orientation() else { return R::ZERO };
        let sum = vector_sum::<R, F>(self.vertices(), ltc, horizon);
        (orientation * sum.z() / (R::of(2.0) * R::PI)).clamped(R::ZERO, R::ONE)
    }

    /// The vector form factor in cosine space, `∫ ω dω / π` over the light, from the edge term `F`: not cut by the horizon
    /// of cosine space, and 0 where the light is not seen.
    pub fn vector_form_factor<F: EdgeForm>(&self, ltc: &Ltc<R>, surface: bool) -> R::Vec3 {
        let orientation = self.orientation().unwrap_or(R::ZERO);
        let horizon = Horizon { surface, cosine: false };
        vector_sum::<R, F>(self.vertices(), ltc, horizon) * (orientation / (R::of(2.0) * R::PI))
    }
}

impl<R: Real> Quad<R> {
    /// As [`Polygon::integrate_with`].
    pub fn integrate_with<F: EdgeForm>(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        self.polygon().integrate_with::<F>(ltc, horizon)
    }

    /// As [`Polygon::vector_form_factor`].
    pub fn vector_form_factor<F: EdgeForm>(&self, ltc: &Ltc<R>, surface: bool) -> R::Vec3 {
        self.polygon().vector_form_factor::<F>(ltc, surface)
    }
}
