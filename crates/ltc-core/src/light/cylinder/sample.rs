//! Sampling what is seen of a cylinder.

use core::f64::consts::PI;

use glam::DVec3;

use super::Cylinder;
use super::view::{Axis, Beside, End, View};
use crate::light::wide::{narrowed, widened};
use crate::light::{LightSample, SampleLight};
use crate::{Real, Vector as _};

/// The mantle uniform in the azimuth around the axis' direction, and for each azimuth uniform in the sine of the elevation
/// between the ends: `pdf = 1/(Δφ Δ(sin E))`, bounded also where the mantle is seen edge-on. An end uniform over its area.
/// Mantle and end are chosen by their areas. From inside a closed cylinder uniform over all directions.
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

/// The mantle in one direction of the plane across the axis.
struct Slice {
    /// Unit vector, at right angles to the axis.
    flat: DVec3,
    /// How far the mantle is along it.
    reach: f64,
    /// Sines of the ends' elevations.
    sines: [f64; 2],
}

impl Beside {
    /// Half the azimuth that the mantle spans.
    fn half_azimuth(&self) -> f64 {
        self.axis.radius.atan2(self.tangent)
    }

    /// In the direction `towards · cos + aside · sin`; `None` beside the mantle.
    fn slice(&self, [cos, sin]: [f64; 2]) -> Option<Slice> {
        let (radius, miss) = (self.axis.radius, self.distance * sin);
        if cos <= 0.0 || miss.abs() > radius {
            return None;
        }
        // The smaller root of t² − 2 t D cos + (D² − r²), by its stable form.
        let half_chord = ((radius - miss) * (radius + miss)).sqrt();
        let reach = self.tangent.powi(2) / (self.distance * cos + half_chord);
        let sines = self.axis.ends.map(|z| z / z.hypot(reach));
        Some(Slice { flat: self.towards * cos + self.aside * sin, reach, sines })
    }

    /// The end that is seen.
    fn facing_end(&self, caps: bool) -> Option<End> {
        let (height, _) = *self.heights.iter().find(|(_, faces)| *faces && caps)?;
        Some(self.end(height))
    }

    /// The probability to sample the mantle.
    fn mantle_share(&self, caps: bool) -> f64 {
        let half_angle = self.tangent.atan2(self.axis.radius);
        let mantle = 2.0 * half_angle * self.axis.radius * (self.axis.ends[1] - self.axis.ends[0]);
        mantle / (mantle + self.facing_end(caps).map_or(0.0, |end| end.area()))
    }

    fn sample(&self, caps: bool, u: [f64; 2]) -> Option<LightSample<f64>> {
        let share = self.mantle_share(caps);
        if u[0] >= share {
            let rest = ((u[0] - share) / (1.0 - share)).clamp(0.0, 1.0);
            let end = self.facing_end(caps)?;
            let sample = LightSample::<f64>::of_area(end.point([rest, u[1]]), end.normal()?, end.area())?;
            return Some(LightSample { pdf: sample.pdf * (1.0 - share), ..sample });
        }
        let (sin, cos) = ((2.0 * u[1] - 1.0) * self.half_azimuth()).sin_cos();
        let slice = self.slice([cos, sin])?;
        let [low, high] = slice.sines;
        let sine = low + (high - low) * (u[0] / share);
        let cosine = ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt();
        let wi = (slice.flat * cosine + self.axis.along * sine).try_unit()?;
        let (distance, pdf) = (slice.reach / cosine, share * self.slice_pdf(&slice));
        (distance.is_finite() && pdf.is_finite()).then_some(LightSample { wi, distance, pdf })
    }

    fn slice_pdf(&self, slice: &Slice) -> f64 {
        1.0 / (2.0 * self.half_azimuth() * (slice.sines[1] - slice.sines[0]))
    }

    fn pdf(&self, caps: bool, wi: DVec3) -> Option<f64> {
        let share = self.mantle_share(caps);
        let flat = [wi.dot(self.towards), wi.dot(self.aside)];
        let length = flat[0].hypot(flat[1]);
        let sine = wi.dot(self.axis.along);
        let slice = if length > 0.0 { self.slice(flat.map(|x| x / length)) } else { None };
        match slice.filter(|slice| (slice.sines[0]..=slice.sines[1]).contains(&sine)) {
            Some(slice) => Some(share * self.slice_pdf(&slice)),
            None => {
                let end = self.facing_end(caps)?;
                let sample = LightSample::<f64>::of_area(end.hit(wi)?, end.normal()?, end.area())?;
                Some((1.0 - share) * sample.pdf)
            }
        }
    }
}
