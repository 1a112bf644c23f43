//! Sampling a cylinder by the area of what is seen of it.

use core::f64::consts::PI;

use glam::DVec3;

use super::Cylinder;
use super::view::{Axis, Beside, End, View};
use crate::light::wide::{narrowed, widened};
use crate::light::{LightSample, SampleLight};
use crate::{Real, Vector as _};

/// Uniform over the area that faces the shading point: the mantle between the two generators that are seen edge-on, and with
/// caps the end that faces it. From inside a closed cylinder uniform over all directions.
impl<R: Real> SampleLight<R> for Cylinder<R> {
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>> {
        let (sample, unit) = self.view().sample(self.caps, u.map(R::to_f64))?;
        let sample = LightSample {
            wi: narrowed::<R>(sample.wi),
            distance: R::of(sample.distance * unit),
            pdf: R::of(sample.pdf),
        };
        sample.pdf.is_finite().then_some(sample)
    }

    fn pdf(&self, wi: R::Vec3) -> R {
        let pdf = R::of(self.view().pdf(self.caps, widened::<R>(wi)).unwrap_or(0.0));
        if pdf.is_finite() { pdf } else { R::ZERO }
    }
}

impl View {
    /// A sample and its unit of length.
    fn sample(&self, caps: bool, u: [f64; 2]) -> Option<(LightSample<f64>, f64)> {
        match self {
            Self::Inside(axis) if caps => {
                let wi = uniform_direction(u);
                Some((LightSample { wi, distance: axis.exit(wi), pdf: UNIFORM_PDF }, axis.unit))
            }
            Self::InLine(end, unit) if caps => {
                Some((LightSample::of_area(end.point(u), end.normal()?, end.area())?, *unit))
            }
            Self::Beside(view) => Some((view.sample(caps, u)?, view.axis.unit)),
            Self::Nothing | Self::Inside(_) | Self::InLine(..) => None,
        }
    }

    fn pdf(&self, caps: bool, wi: DVec3) -> Option<f64> {
        match self {
            Self::Inside(_) if caps => Some(UNIFORM_PDF),
            Self::InLine(end, _) if caps => {
                Some(LightSample::<f64>::of_area(end.hit(wi)?, end.normal()?, end.area())?.pdf)
            }
            Self::Beside(view) => view.pdf(caps, wi),
            Self::Nothing | Self::Inside(_) | Self::InLine(..) => None,
        }
    }
}

/// Over all directions.
const UNIFORM_PDF: f64 = 0.25 / PI;

fn uniform_direction(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let r = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
    DVec3::new(r * cos, r * sin, z)
}

impl Axis {
    /// From inside: how far the surface is in the direction `wi`.
    fn exit(&self, wi: DVec3) -> f64 {
        let up = wi.dot(self.along);
        let to_end = if up > 0.0 {
            self.ends[1] / up
        } else if up < 0.0 {
            self.ends[0] / up
        } else {
            1.0 / f64::MIN_POSITIVE
        };
        let flat = wi - self.along * up;
        let (flat_squared, half) = (flat.dot(flat), flat.dot(self.offset));
        let inside = self.radius.powi(2) - self.offset.dot(self.offset);
        let root = (half.powi(2) + flat_squared * inside).max(0.0).sqrt();
        let to_mantle = if flat_squared > 0.0 { (half + root) / flat_squared } else { to_end };
        to_end.min(to_mantle)
    }
}

impl End {
    fn area(&self) -> f64 {
        PI * self.axes[0].dot(self.axes[0])
    }

    fn normal(&self) -> Option<DVec3> {
        self.axes[0].cross(self.axes[1]).try_unit()
    }

    fn point(&self, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        self.centre + (self.axes[0] * cos + self.axes[1] * sin) * u[0].sqrt()
    }

    /// Where the ray along `wi` hits the circle.
    fn hit(&self, wi: DVec3) -> Option<DVec3> {
        let normal = self.normal()?;
        let t = normal.dot(self.centre) / normal.dot(wi);
        let point = wi * t;
        let offset = point - self.centre;
        let inside = offset.dot(offset) <= self.axes[0].dot(self.axes[0]);
        (t > 0.0 && t.is_finite() && inside).then_some(point)
    }
}

impl Beside {
    /// Half the angle around the axis that is seen of the mantle.
    fn half_angle(&self) -> f64 {
        self.tangent.atan2(self.axis.radius)
    }

    fn mantle_area(&self) -> f64 {
        2.0 * self.half_angle() * self.axis.radius * (self.axis.ends[1] - self.axis.ends[0])
    }

    /// The end that is seen.
    fn facing_end(&self, caps: bool) -> Option<End> {
        let (height, _) = *self.heights.iter().find(|(_, faces)| *faces && caps)?;
        Some(self.end(height))
    }

    fn area(&self, caps: bool) -> f64 {
        self.mantle_area() + self.facing_end(caps).map_or(0.0, |end| end.area())
    }

    fn sample(&self, caps: bool, u: [f64; 2]) -> Option<LightSample<f64>> {
        let (area, mantle) = (self.area(caps), self.mantle_area());
        let at = u[0] * area;
        let (point, normal) = match self.facing_end(caps) {
            Some(end) if at >= mantle => {
                let rest = ((at - mantle) / (area - mantle)).clamp(0.0, 1.0);
                (end.point([rest, u[1]]), end.normal()?)
            }
            _ => {
                let [low, high] = self.axis.ends;
                let angle = (2.0 * u[1] - 1.0) * self.half_angle();
                let (sin, cos) = angle.sin_cos();
                let normal = self.aside * sin - self.towards * cos;
                let height = low + (high - low) * (at / mantle).min(1.0);
                (self.axis.offset + self.axis.along * height + normal * self.axis.radius, normal)
            }
        };
        LightSample::<f64>::of_area(point, normal, area)
    }

    fn pdf(&self, caps: bool, wi: DVec3) -> Option<f64> {
        let area = self.area(caps);
        let (point, normal) = match self.mantle_hit(wi) {
            Some(hit) => hit,
            None => {
                let end = self.facing_end(caps)?;
                (end.hit(wi)?, end.normal()?)
            }
        };
        Some(LightSample::<f64>::of_area(point, normal, area)?.pdf)
    }

    /// Where the ray along `wi` enters the mantle, and the normal there. `None` where it does so beyond an end or not at
    /// all.
    fn mantle_hit(&self, wi: DVec3) -> Option<(DVec3, DVec3)> {
        let (ahead, beside) = (wi.dot(self.towards), wi.dot(self.aside));
        let flat_squared = ahead.powi(2) + beside.powi(2);
        let miss = self.distance * beside;
        let inside = flat_squared * self.axis.radius.powi(2) - miss.powi(2);
        if !(inside >= 0.0 && ahead > 0.0) {
            return None;
        }
        // The smaller root of t² f − 2 t D a + (D² − r²), by its stable form.
        let t = self.tangent.powi(2) / (self.distance * ahead + inside.sqrt());
        let height = t * wi.dot(self.axis.along);
        let [low, high] = self.axis.ends;
        let normal = (wi - self.axis.along * wi.dot(self.axis.along)) * t - self.axis.offset;
        (height >= low && height <= high).then_some((wi * t, normal * (1.0 / self.axis.radius)))
    }
}
