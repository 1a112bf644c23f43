//! A straight segment seen from the shading point, and the integral along it that all thin lights share.

use super::angle::azimuth;
use super::{Horizon, LineSample};
use crate::{Ltc, Matrix, Real, Vector};

/// A segment and the plane through it and the shading point.
///
/// All lengths are divided by a power of two near the distance of the farther end, which rounds nothing, so that
/// squares neither over- nor underflow.
pub(super) struct Segment<R: Real> {
    ends: [R::Vec3; 2],
    /// From the first end to the second.
    along: R::Vec3,
    /// A normal of the plane through both ends and the shading point: `p0 × p1 = normal · moment`.
    normal: R::Vec3,
    /// 1, but where the square of `p0 × p1` would be very small.
    moment: R,
    /// `‖normal‖²`.
    squared_normal: R,
    /// Scaled lengths per length.
    shrink: R,
}

/// Below this `‖p0 × p1‖²`, of scaled ends, the normal is normalised: then `‖Mᵀ normal‖²` does not underflow in f32 up to a
/// condition of 1e7.
const SMALL: f64 = 1e-24;

impl<R: Real> Segment<R> {
    /// `None` for a segment that spans no angle: of zero length, on a ray from the shading point, or through it.
    ///
    /// What matters is `p0 × p1`. Its direction and length are taken with [`Real::product_difference`]: as plain differences
    /// they would lose a relative ε · distance / d for a line that passes close by, or that points at the shading point.
    #[inline(always)]
    pub fn new(p0: R::Vec3, p1: R::Vec3) -> Option<Self> {
        let scale = p0.max_abs().max(p1.max_abs()).floor_power_of_two();
        if scale <= R::ZERO {
            return None;
        }
        let shrink = R::ONE / scale;
        let (p0, p1) = (p0 * shrink, p1 * shrink);
        let mut normal = R::Vec3::new(
            R::product_difference(p0.y(), p1.z(), p0.z(), p1.y()),
            R::product_difference(p0.z(), p1.x(), p0.x(), p1.z()),
            R::product_difference(p0.x(), p1.y(), p0.y(), p1.x()),
        );
        let (mut moment, mut squared_normal) = (R::ONE, normal.dot(normal));
        if squared_normal < R::of(SMALL) {
            let unit = normal.try_unit()?;
            (moment, squared_normal) = (normal.dot(unit), unit.dot(unit));
            normal = unit;
        }
        Some(Self { ends: [p0, p1], along: p1 - p0, normal, moment, squared_normal, shrink })
    }

    /// Scaled lengths per length.
    pub fn shrink(&self) -> R {
        self.shrink
    }

    /// Unit vector from the shading point towards the nearest point of the line.
    #[inline]
    pub fn towards_line(&self) -> Option<R::Vec3> {
        unit::<R>(self.along.cross(self.normal))
    }

    /// `∫ D(ω) ‖ω × ω_t‖ / ‖p‖² dl` along the segment, per scaled length: half of eq. 1.6 of the 2017 chapter, by its
    /// closed form, eq. 1.20 to 1.26.
    ///
    /// With `q = M⁻¹p` and ω⊥ the unit normal above this is, by eq. 1.26, `1/‖Mᵀω⊥‖` times the same integral of the clamped
    /// cosine along q. That one is, over the angle Δ that the transformed segment spans, d the distance of
    /// its line and c the unit vector to the line's nearest point,
    ///
    /// `1/2π [ (c_z/d) (Δ − sin Δ) + tan(Δ/2) (q̂0_z + q̂1_z) (1/|q0| + 1/|q1|) ]`.
    ///
    /// It equals eq. 1.21 to 1.23, whose differences of arc tangents and of `l/(d (d² + l²))` cancel as d → 0 and for short,
    /// distant and radial lines. Here the second term is a product of sums of positive numbers, and the first takes away
    /// at most a third of it, so nothing cancels: the relative error is some ε · cond(M) for every segment above the horizon.
    #[inline(always)]
    pub fn integral(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let mut kept = R::ONE;
        let mut ends = self.ends;
        if horizon.surface {
            kept = clip_above::<R>(&mut ends, self.normal * self.moment);
            if kept <= R::ZERO {
                return R::ZERO;
            }
        }
        // q0 × q1 = (det M)⁻¹ Mᵀ (p0 × p1), not the product of rounded ends.
        let [c0, c1, c2] = ltc.target_from_cosine().columns();
        let width = R::Vec3::new(c0.dot(self.normal), c1.dot(self.normal), c2.dot(self.normal));
        let squared_width = width.dot(width);
        let inverse = R::ONE / squared_width;
        let stretch = self.moment * ltc.inverse_determinant();
        let cosine_from_target = ltc.cosine_from_target();
        let mut ends = ends.map(|p| cosine_from_target.apply(p));
        if horizon.cosine {
            kept = kept * clip_above::<R>(&mut ends, width * (kept * stretch));
            if kept <= R::ZERO {
                return R::ZERO;
            }
        }
        let along = cosine_from_target.apply(self.along);
        // c_z / d = (along × m)_z / |m|², m = q0 × q1.
        let nearness = (along.x() * width.y() - along.y() * width.x()) * inverse / stretch;
        let sine = kept * stretch * squared_width.sqrt();
        let half = R::of(0.5) / R::PI;
        half * (self.squared_normal * inverse).sqrt() * cosine_integral(ends, sine, nearness)
    }
}

/// The bracket of [`Segment::integral`] for the ends `q0`, `q1`, with `sine = |q0 × q1|` and `nearness = c_z/d`.
#[inline(always)]
fn cosine_integral<R: Real>([q0, q1]: [R::Vec3; 2], sine: R, nearness: R) -> R {
    let (r0, r1) = (length::<R>(q0), length::<R>(q1));
    let (product, cosine) = (r0 * r1, q0.dot(q1));
    // 1 + cos Δ cancels near π, 1 − cos Δ near 0.
    let half_tangent = if cosine >= R::ZERO { sine / (product + cosine) } else { (product - cosine) / sine };
    let inverse = R::ONE / product;
    let ends = half_tangent * ((q0.z() * r1 + q1.z() * r0) * inverse) * ((r0 + r1) * inverse);
    let x = half_tangent * half_tangent;
    let bow = if x < R::of(1.0 / 64.0) {
        half_tangent * x * angle_less_sine_series(x)
    } else {
        azimuth(sine, cosine) - sine * inverse
    };
    nearness * bow + ends
}

/// The length of a vector whose square may underflow: an end that a horizon cuts is as near as the line is.
#[inline(always)]
fn length<R: Real>(v: R::Vec3) -> R {
    let length = v.length();
    if length > R::of(SMALL).sqrt() {
        return length;
    }
    let scale = v.max_abs();
    if scale > R::ZERO { scale * (v * (R::ONE / scale)).length() } else { R::ZERO }
}

/// `(Δ − sin Δ) / t³` as a series in `x = t²`, t = tan(Δ/2) ≤ 1/8, with a relative error below ε.
///
/// `Δ − sin Δ = 2 (atan t − t/(1 + t²)) = Σ (−1)^(j+1) 4j/(2j+1) t^(2j+1)`.
#[inline]
fn angle_less_sine_series<R: Real>(x: R) -> R {
    const TERMS: [f64; 9] = [
        4.0 / 3.0,
        8.0 / 5.0,
        12.0 / 7.0,
        16.0 / 9.0,
        20.0 / 11.0,
        24.0 / 13.0,
        28.0 / 15.0,
        32.0 / 17.0,
        36.0 / 19.0,
    ];
    let count = if R::EPSILON.to_f64() > 1e-10 { 4 } else { 9 };
    TERMS[..count].iter().rev().fold(R::ZERO, |sum, &term| R::of(term) - x * sum)
}

/// [`Vector::try_unit`], without its scaling for the usual vectors whose square is in range.
#[inline]
pub(super) fn unit<R: Real>(v: R::Vec3) -> Option<R::Vec3> {
    let squared = v.dot(v);
    let usual = squared > R::of(SMALL) && squared < R::of(1.0 / SMALL);
    if usual { Some(v * (R::ONE / squared.sqrt())) } else { v.try_unit() }
}

/// Moves the end that lies below z = 0, if any, onto it, and says which fraction of the segment is left: 0 for one that
/// lies in the horizon or below it.
///
/// `moment = p0 × p1` decides where: the point p of the line with z = 0 is `(ẑ × moment) / (z1 − z0)`, which cancels nowhere,
/// where interpolation between the ends loses ε · distance for a line that crosses the horizon close by.
#[inline(always)]
pub(super) fn clip_above<R: Real>(ends: &mut [R::Vec3; 2], moment: R::Vec3) -> R {
    let [z0, z1] = [ends[0].z(), ends[1].z()];
    if z0 <= R::ZERO && z1 <= R::ZERO {
        return R::ZERO;
    }
    if z0 >= R::ZERO && z1 >= R::ZERO {
        return R::ONE;
    }
    let inverse_rise = R::ONE / (z1 - z0);
    let crossing = R::Vec3::new(-moment.y() * inverse_rise, moment.x() * inverse_rise, R::ZERO);
    if z0 < R::ZERO {
        ends[0] = crossing;
        z1 * inverse_rise
    } else {
        ends[1] = crossing;
        -(z0 * inverse_rise)
    }
}

/// Sampling uniform in angle.
impl<R: Real> Segment<R> {
    /// The angle between the ends, in (0, π).
    fn angle(&self) -> R {
        (self.moment * self.squared_normal.sqrt()).atan2(self.ends[0].dot(self.ends[1]))
    }

    pub fn sample(&self, u: R) -> Option<LineSample<R>> {
        let angle = self.angle();
        let [r0, r1] = self.ends.map(Vector::length);
        // By areas of triangles, which cancel nowhere.
        let (sin, rest) = ((u * angle).sin_cos().0, ((R::ONE - u) * angle).sin_cos().0);
        let t = r0 * sin / (r0 * sin + r1 * rest);
        let point = self.ends[0] + self.along * t;
        let wi = point.try_unit()?;
        Some(LineSample {
            wi,
            distance: point.length() / self.shrink,
            pdf_length: self.pdf_length(t),
            pdf_angle: R::ONE / angle,
        })
    }

    /// `dΔ/dl / Δ = d / (‖p‖² Δ)`, d the distance of the line.
    pub fn pdf_length(&self, t: R) -> R {
        let point = self.ends[0] + self.along * t;
        let distance = self.moment * self.squared_normal.sqrt() / self.along.length();
        self.shrink * distance / (point.dot(point) * self.angle())
    }
}
