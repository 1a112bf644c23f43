//! The cone of directions over an ellipse, and its axes by confocal coordinates.

use crate::{Real, Vector};

/// How often the root of [`confocal`] is improved at most. Two to four times are usual; more, near the ellipse's rim, do not
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<R: Real> {
    /// Along the longer half-axis, the shorter one, and the normal on the far side.
    frame: [R::Vec3; 3],
    /// r₁ ≥ r₂ > 0.
    radii: [R; 2],
    /// (x, y, h) in the frame; h > 0.
    centre: [R; 3],
    lambda: R,
    /// g in the frame, not of unit length.
    gradient: [R; 3],
}

impl<R: Real> Cone<R> {
    /// The cone over `c + u cos t + v sin t`, whose largest coordinate should be near 1: squares must not overflow.
    /// `None` without area.
    #[inline]
    pub fn new(c: R::Vec3, u: R::Vec3, v: R::Vec3) -> Option<Self> {
        let cross = u.cross(v);
        let area = cross.length();
        // Written so that NaN, too, is no cone.
        let valid = area > R::TINY;
        if !valid {
            return None;
        }
        let [cos, sin] = longer_half_axis(u.dot(u), v.dot(v), u.dot(v));
        let along = u * cos + v * sin;
        let r1 = along.length();
        let r2 = area / r1;
        let volume = cross.dot(c);
        let k = cross * (if volume < R::ZERO { -R::ONE } else { R::ONE } / area);
        let i = along * (R::ONE / r1);
        let j = k.cross(i);
        // The floor keeps h/λ in range; it is far below what the rounding of the input leaves of h.
        let h = (volume.abs() / area).max(R::EPSILON.squared());
        let (x, y) = (c.dot(i), c.dot(j));
        let (a, b) = (r1.squared(), r2.squared());
        let lambda = confocal(a, b, [x.squared(), y.squared(), h.squared()]);
        let gradient = [x / (lambda + a), y / (lambda + b), h / lambda];
        Some(Self { frame: [i, j, k], radii: [r1, r2], centre: [x, y, h], lambda, gradient })
    }

    /// A vector given in the frame.
    fn vector(&self, [x, y, z]: [R; 3]) -> R::Vec3 {
        self.frame[0] * x + self.frame[1] * y + self.frame[2] * z
    }

    /// |g|²
    fn gradient_squared(&self) -> R {
        let [x, y, z] = self.gradient;
        x.squared() + y.squared() + z.squared()
    }

    /// `∫ ω·n / π dω` over the cone, nothing cut.
    ///
    /// The vector irradiance of an elliptical cone of half-widths atan A and atan B lies along its axis and has length
    /// `AB/√((1 + A²)(1 + B²))`. In confocal terms it is `r₁ r₂ h g / (λ |g|² √((λ + r₁²)(λ + r₂²)))`.
    #[inline]
    pub fn uncut(&self, normal: R::Vec3) -> R {
        let ([r1, r2], h) = (self.radii, self.centre[2]);
        let root = ((self.lambda + r1.squared()) * (self.lambda + r2.squared())).sqrt();
        let along = self.vector(self.gradient).dot(normal);
        r1 * r2 * (h / self.lambda) * along / (self.gradient_squared() * root)
    }

    /// The cone's own axes. `None` where rounding leaves nothing of them.
    ///
    /// The boost that takes the cone's axis to the centre of the cross-section, applied to the half-axes, gives conjugate
    /// half-axes of the cross-section; one more Jacobi rotation its principal ones.
    pub fn axes(&self) -> Option<ConeAxes<R>> {
        let ([r1, r2], [x, y, h], [gx, gy, gz]) = (self.radii, self.centre, self.gradient);
        let root = self.lambda.sqrt();
        let length = self.gradient_squared().sqrt();
        let axis = [gx / length, gy / length, gz / length];
        let gamma = R::ONE / (length * root);
        let (bu, bv) = (r1 * gx * gamma, r2 * gy * gamma);
        let (fu, fv) = (bu / (R::ONE + gamma), bv / (R::ONE + gamma));
        let u = self.vector([r1 + fu * bu * r1 - bu * x, fu * bv * r2 - bu * y, -bu * h]);
        let v = self.vector([fv * bu * r1 - bv * x, r2 + fv * bv * r2 - bv * y, -bv * h]);
        let [cos, sin] = longer_half_axis(u.dot(u), v.dot(v), u.dot(v));
        let e3 = self.vector(axis).try_unit()?;
        let longer = u * cos + v * sin;
        // Rounding can leave a little of the axis in a short half-axis.
        let longer = longer - e3 * longer.dot(e3);
        let width = longer.length();
        let e1 = longer.try_unit()?;
        let widths = [width / root, r1 * r2 * (h / root) / (width * root)];
        let finite = widths.iter().all(|w| w.is_finite());
        finite.then_some(ConeAxes {
            widths: [widths[0], widths[1].min(widths[0])],
            axes: [e1, e3.cross(e1), e3],
        })
    }
}

/// The weights of u and v in the longer half-axis of the ellipse `u cos t + v sin t`: a Jacobi rotation of the Gram matrix,
/// divided by its larger entry so that nothing underflows.
#[inline]
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

/// The root λ > 0 of `x²/(λ + a) + y²/(λ + b) + h²/λ = 1` for a ≥ b > 0, h² > 0, given the squares.
///
/// The first two terms are replaced by one with the same value and slope; the quadratic that is left has a closed form. For a
/// circle this is exact at once, and for a distant ellipse nearly so; it converges quadratically.
#[inline]
fn confocal<R: Real>(a: R, b: R, [xx, yy, hh]: [R; 3]) -> R {
    let enough = R::of(0.125) * R::EPSILON.sqrt();
    let weight = xx + yy;
    let pole = if weight > R::ZERO { (xx * a + yy * b) / weight } else { a };
    let mut root = one_pole(weight, pole, hh);
    for _ in 0..MAX_STEPS {
        let (ia, ib) = (R::ONE / (root + a), R::ONE / (root + b));
        let (fx, fy) = (xx * ia, yy * ib);
        let slope = fx * ia + fy * ib;
        if slope <= R::ZERO {
            break;
        }
        let distance = (fx + fy) / slope;
        let next = one_pole((fx + fy) * distance, (distance - root).clamped(b, a), hh);
        let moved = (next - root).abs();
        root = next;
        if moved <= enough * root {
            break;
        }
    }
    root
}

/// The root λ > 0 of `w/(λ + p) + h²/λ = 1`.
#[inline]
fn one_pole<R: Real>(w: R, p: R, hh: R) -> R {
    let half = R::of(0.5) * (w + hh - p);
    let product = hh * p;
    let root = (half.squared() + product).sqrt();
    let lambda = if half >= R::ZERO { half + root } else { product / (root - half) };
    lambda.max(hh)
}
