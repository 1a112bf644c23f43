//! Sampling a cylinder by the area of what is seen of it.

use super::Cylinder;
use super::view::{Axis, Beside, End, View};
use crate::light::{LightSample, SampleLight};
use crate::{Real, Vector};

/// Uniform over the area that faces the shading point: the mantle between the two generators that are seen edge-on, and with
/// caps the end that faces it. From inside a closed cylinder uniform over all directions.
impl<R: Real> SampleLight<R> for Cylinder<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        match View::of(self.ends, self.radius) {
            View::Inside(axis) if self.caps => {
                let wi = uniform_direction(u);
                let distance = axis.exit(wi) * axis.unit;
                Some(LightSample { wi, distance, pdf: uniform_pdf() })
            }
            View::InLine(end) if self.caps => {
                let normal = end.normal()?;
                let sample = LightSample::of_area(end.point(u), normal, end.area())?;
                Some(self.unscaled(sample))
            }
            View::Beside(view) => view.sample(self.caps, u).map(|sample| self.unscaled(sample)),
            View::Nothing | View::Inside(_) | View::InLine(_) => None,
        }
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        let pdf = match View::of(self.ends, self.radius) {
            View::Inside(_) if self.caps => Some(uniform_pdf()),
            View::InLine(end) if self.caps => end
                .hit(wi)
                .and_then(|point| Some(LightSample::<R>::of_area(point, end.normal()?, end.area())?.pdf)),
            View::Beside(view) => view.pdf(self.caps, wi),
            View::Nothing | View::Inside(_) | View::InLine(_) => None,
        };
        pdf.unwrap_or(R::ZERO)
    }
}

impl<R: Real> Cylinder<R> {
    /// The sample with its distance in the light's own unit.
    fn unscaled(&self, sample: LightSample<R>) -> LightSample<R> {
        let unit = self.ends[0].max_abs().max(self.ends[1].max_abs()).max(self.radius);
        LightSample { distance: sample.distance * unit, ..sample }
    }
}

fn uniform_pdf<R: Real>() -> R {
    R::ONE / (R::of(4.0) * R::PI)
}

fn uniform_direction<R: Real>(u: [R; 2]) -> R::Vec3 {
    let z = R::ONE - R::of(2.0) * u[0];
    let r = ((R::ONE - z) * (R::ONE + z)).max(R::ZERO).sqrt();
    let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
    R::Vec3::new(r * cos, r * sin, z)
}

impl<R: Real> Axis<R> {
    /// From inside: how far the surface is in the direction `wi`.
    fn exit(&self, wi: R::Vec3) -> R {
        let up = wi.dot(self.along);
        let to_end = if up > R::ZERO {
            self.ends[1] / up
        } else if up < R::ZERO {
            self.ends[0] / up
        } else {
            R::ONE / R::TINY
        };
        let flat = wi - self.along * up;
        let (flat_squared, half) = (flat.dot(flat), flat.dot(self.offset));
        let inside = self.radius.squared() - self.offset.dot(self.offset);
        let root = (half.squared() + flat_squared * inside).max(R::ZERO).sqrt();
        let to_mantle = if flat_squared > R::ZERO { (half + root) / flat_squared } else { to_end };
        to_end.min(to_mantle)
    }
}

impl<R: Real> End<R> {
    fn area(&self) -> R {
        R::PI * self.axes[0].dot(self.axes[0])
    }

    fn normal(&self) -> Option<R::Vec3> {
        self.axes[0].cross(self.axes[1]).try_unit()
    }

    fn point(&self, u: [R; 2]) -> R::Vec3 {
        let (sin, cos) = (R::of(2.0) * R::PI * u[1]).sin_cos();
        self.centre + (self.axes[0] * cos + self.axes[1] * sin) * u[0].sqrt()
    }

    /// Where the ray along `wi` hits the circle.
    fn hit(&self, wi: R::Vec3) -> Option<R::Vec3> {
        let normal = self.normal()?;
        let t = normal.dot(self.centre) / normal.dot(wi);
        let point = wi * t;
        let offset = point - self.centre;
        let inside = offset.dot(offset) <= self.axes[0].dot(self.axes[0]);
        (t > R::ZERO && t.is_finite() && inside).then_some(point)
    }
}

impl<R: Real> Beside<R> {
    /// Half the angle around the axis that is seen of the mantle.
    fn half_angle(&self) -> R {
        self.tangent.atan2(self.axis.radius)
    }

    fn mantle_area(&self) -> R {
        R::of(2.0) * self.half_angle() * self.axis.radius * (self.axis.ends[1] - self.axis.ends[0])
    }

    /// The end that is seen.
    fn facing_end(&self, caps: bool) -> Option<End<R>> {
        let (height, _) = *self.heights.iter().find(|(_, faces)| *faces && caps)?;
        Some(self.end(height))
    }

    fn area(&self, caps: bool) -> R {
        self.mantle_area() + self.facing_end(caps).map_or(R::ZERO, |end| end.area())
    }

    fn sample(&self, caps: bool, u: [R; 2]) -> Option<LightSample<R>> {
        let (area, mantle) = (self.area(caps), self.mantle_area());
        let at = u[0] * area;
        let (point, normal) = match self.facing_end(caps) {
            Some(end) if at >= mantle => {
                let rest = ((at - mantle) / (area - mantle)).clamped(R::ZERO, R::ONE);
                (end.point([rest, u[1]]), end.normal()?)
            }
            _ => {
                let [low, high] = self.axis.ends;
                let angle = (R::of(2.0) * u[1] - R::ONE) * self.half_angle();
                let (sin, cos) = angle.sin_cos();
                let normal = self.aside * sin - self.towards * cos;
                let height = low + (high - low) * (at / mantle).min(R::ONE);
                (self.axis.offset + self.axis.along * height + normal * self.axis.radius, normal)
            }
        };
        LightSample::of_area(point, normal, area)
    }

    fn pdf(&self, caps: bool, wi: R::Vec3) -> Option<R> {
        let area = self.area(caps);
        let (point, normal) = match self.mantle_hit(wi) {
            Some(hit) => hit,
            None => {
                let end = self.facing_end(caps)?;
                (end.hit(wi)?, end.normal()?)
            }
        };
        Some(LightSample::<R>::of_area(point, normal, area)?.pdf)
    }

    /// Where the ray along `wi` enters the mantle, and the normal there. `None` where it does so beyond an end or not at
    /// all.
    fn mantle_hit(&self, wi: R::Vec3) -> Option<(R::Vec3, R::Vec3)> {
        let (ahead, beside) = (wi.dot(self.towards), wi.dot(self.aside));
        let flat_squared = ahead.squared() + beside.squared();
        let miss = self.distance * beside;
        let inside = flat_squared * self.axis.radius.squared() - miss.squared();
        if !(inside >= R::ZERO && ahead > R::ZERO) {
            return None;
        }
        // The smaller root of t² f − 2 t D a + (D² − r²), by its stable form.
        let t = self.tangent.squared() / (self.distance * ahead + inside.sqrt());
        let height = t * wi.dot(self.axis.along);
        let [low, high] = self.axis.ends;
        let normal = (wi - self.axis.along * wi.dot(self.axis.along)) * t - self.axis.offset;
        (height >= low && height <= high).then_some((wi * t, normal * (R::ONE / self.axis.radius)))
    }
}
