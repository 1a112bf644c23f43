//! The cone of directions over an ellipse, and its axes by confocal coordinates.

use crate::{Real, Vector};

/// How often the root of [`confocal`] is improved at most. One to three times are usual; more, near the ellipse's rim, do not
/// help against the rounding of the input.
const MAX_STEPS: usize = 16;

/// The directions from the origin to the ellipse `c + u cos t + v sin t`, for the clamped cosine's integral over them.
///
/// In axes along the ellipse's half-axes r₁ ≥ r₂ and its normal, with the centre at (x, y, h), the confocal ellipsoid of the
/// ellipse through the origin belongs to the one positive root λ of
///
/// ```text
/// x²/(λ + r₁²) + y²/(λ + r₂²) + h²/λ = 1
/// ```
///
/// and its normal there, g = (x/(λ + r₁²), y/(λ + r₂²), h/λ), is the axis of the cone. All terms are positive: neither
/// coincident eigenvalues of the cone's quadric nor an ellipse that is seen edge-on, near by or far away cancel digits.
/// (λ and the two other roots of the cubic are the quadric's eigenvalues.)
///
/// The half-axes themselves are not needed. With the unit normal k, c′ the part of c in the plane, u⊥ = k × u, v⊥ = k × v,
/// q = u⊥ (u⊥·c) + v⊥ (v⊥·c) and D = λ² + λ (u² + v²) + |u × v|², the first two terms are
/// `(λ c′² + (u⊥·c)² + (v⊥·c)²) / D`, and g = (λ c′ + q)/D + k h/λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<R: Real> {
    c: R::Vec3,
    u: R::Vec3,
    v: R::Vec3,
    /// |u × v|
    area: R,
    /// Distance of the plane.
    h: R,
    lambda: R,
    /// D
    d: R,
    /// Not of unit length.
    g: R::Vec3,
    /// Its part in the ellipse's plane: near the plane the other one would drown products with u and v in rounding.
    g_in_plane: R::Vec3,
}

impl<R: Real> Cone<R> {
    /// The cone over `c + u cos t + v sin t`, whose coordinates should be near 1: sixth powers must not overflow. `u × v`
    /// points away from the origin; where rounding says otherwise the origin is next to the ellipse's plane, on that
    /// side. `None` without area.
    #[inline]
    pub fn new(c: R::Vec3, u: R::Vec3, v: R::Vec3) -> Option<Self> {
        let cross = u.cross(v);
        let area = cross.length();
        // Written so that NaN, too, is no cone.
        let valid = area > R::TINY;
        if !valid {
            return None;
        }
        let k = cross * (R::ONE / area);
        // The floor keeps h/λ in range; it is far below what the rounding of the input leaves of h.
        let h = c.dot(k).max(R::EPSILON.squared());
        let in_plane = c - k * h;
        let (u_turned, v_turned) = (k.cross(u), k.cross(v));
        let (uc, vc) = (u_turned.dot(c), v_turned.dot(c));
        let q = u_turned * uc + v_turned * vc;
        let ellipse = Confocal {
            trace: u.dot(u) + v.dot(v),
            determinant: area.squared(),
            offset: in_plane.dot(in_plane),
            crossed: uc.squared() + vc.squared(),
            twice_crossed: q.dot(q),
            height: h.squared(),
        };
        let lambda = ellipse.root();
        let d = ellipse.denominator(lambda);
        let g_in_plane = (in_plane * lambda + q) * (R::ONE / d);
        let g = g_in_plane + k * (h / lambda);
        Some(Self { c: in_plane + k * h, u, v, area, h, lambda, d, g, g_in_plane })
    }

    /// `∫ ω·n / π dω` over the cone, nothing cut.
    ///
    /// The vector irradiance of an elliptical cone of half-widths atan A and atan B lies along its axis and has length
    /// `AB/√((1 + A²)(1 + B²))`. In confocal terms it is `|u × v| h g / (λ |g|² √D)`.
    #[inline]
    pub fn uncut(&self, n: R::Vec3) -> R {
        self.area * (self.h / self.lambda) * self.g.dot(n) / (self.g.dot(self.g) * self.d.sqrt())
    }

    /// The cone's own axes. `None` where rounding leaves nothing of them.
    ///
    /// (u·g, v·g, 1)/(|g| √λ) is a unit vector of the Lorentz metric; the boost that belongs to it takes u and v to conjugate
    /// half-axes of the cross-section at right angles to g.
    pub fn axes(&self) -> Option<ConeAxes<R>> {
        let root = self.lambda.sqrt();
        let gamma = R::ONE / (self.g.length() * root);
        let (bu, bv) = (self.u.dot(self.g_in_plane) * gamma, self.v.dot(self.g_in_plane) * gamma);
        let shift = (self.u * bu + self.v * bv) * (R::ONE / (R::ONE + gamma)) - self.c;
        let (u, v) = (self.u + shift * bu, self.v + shift * bv);
        let e3 = self.g.try_unit()?;
        let [cos, sin] = longer_half_axis(u.dot(u), v.dot(v), u.dot(v));
        let longer = u * cos + v * sin;
        // Rounding can leave a little of the axis in a short half-axis.
        let longer = longer - e3 * longer.dot(e3);
        let width = longer.length();
        let e1 = longer.try_unit()?;
        let widths = [width / root, self.area * (self.h / root) / (width * root)];
        let finite = widths.iter().all(|w| w.is_finite());
        finite.then_some(ConeAxes {
            widths: [widths[0], widths[1].min(widths[0])],
            axes: [e1, e3.cross(e1), e3],
        })
    }
}

/// The weights of u and v in the longer half-axis of the ellipse `u cos t + v sin t`: a Jacobi rotation of the Gram matrix,
/// divided by its larger entry so that nothing underflows.
fn longer_half_axis<R: Real>(uu: R, vv: R, uv: R) -> [R; 2] {
    let (larger, smaller) = if uu >= vv { (uu, vv) } else { (vv, uu) };
    let half_gap = R::of(0.5) * (R::ONE - smaller / larger);
    let mixed = uv / larger;
    let radius = (half_gap.squared() + mixed.squared()).sqrt();
    let (cos, sin) = if radius > R::ZERO {
        let cos = (R::of(0.5) * (R::ONE + half_gap / radius)).sqrt();
        (cos, mixed / (R::of(2.0) * radius * cos))
    } else {
        (R::ONE, R::ZERO)
    };
    if uu >= vv { [cos, sin] } else { [sin, cos] }
}

/// The cone's principal axes: it is over the ellipse `(A cos τ, B sin τ, 1)` in the right-handed axes (e₁, e₂, e₃).
#[derive(Clone, Copy, Debug)]
pub(super) struct ConeAxes<R: Real> {
    /// A ≥ B ≥ 0, tangents of the half-widths.
    pub widths: [R; 2],
    /// Orthonormal; the last one is the cone's axis.
    pub axes: [R::Vec3; 3],
}

/// `(λ P + W)/(λ² + λ T + A²) + h²/λ = 1`, with all coefficients ≥ 0; in principal axes P = x² + y², W = r₂²x² + r₁²y²,
/// T = r₁² + r₂², A = r₁r₂.
struct Confocal<R: Real> {
    /// T
    trace: R,
    /// A²
    determinant: R,
    /// P
    offset: R,
    /// W
    crossed: R,
    /// r₂⁴x² + r₁⁴y²
    twice_crossed: R,
    /// h², above 0
    height: R,
}

impl<R: Real> Confocal<R> {
    #[inline]
    fn denominator(&self, lambda: R) -> R {
        lambda * (lambda + self.trace) + self.determinant
    }

    /// The root λ > 0.
    ///
    /// The first term is replaced by `w/(λ + p)` with the same value and slope; the quadratic that is left has a closed form. For
    /// a circle this is exact at once, for a distant ellipse nearly so; it converges quadratically.
    #[inline]
    fn root(&self) -> R {
        let enough = R::EPSILON.sqrt();
        let pole = if self.offset > R::ZERO { self.trace - self.crossed / self.offset } else { R::ZERO };
        let mut root = one_pole(self.offset, pole.max(R::ZERO), self.height);
        for _ in 0..MAX_STEPS {
            let numerator = root * self.offset + self.crossed;
            let slope = root * (root * self.offset + R::of(2.0) * self.crossed) + self.twice_crossed;
            if slope <= R::ZERO {
                break;
            }
            let weight = numerator / slope;
            // Above 0 but for rounding.
            let pole = self.denominator(root) * weight - root;
            let pole = if pole > R::ZERO { pole } else { R::ZERO };
            let next = one_pole(numerator * weight, pole, self.height);
            let moved = (next - root).abs();
            root = next;
            if moved <= enough * root {
                break;
            }
        }
        // h²/λ is one of the terms that sum to 1.
        root.max(self.height)
    }
}

/// The root λ > 0 of `w/(λ + p) + h²/λ = 1`.
#[inline]
fn one_pole<R: Real>(w: R, p: R, hh: R) -> R {
    let half = R::of(0.5) * (w + hh - p);
    let product = hh * p;
    let root = (half.squared() + product).sqrt();
    if half >= R::ZERO { half + root } else { product / (root - half) }
}
