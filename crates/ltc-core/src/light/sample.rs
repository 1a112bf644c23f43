//! Sampling lights, for reference use.

use crate::{Real, Vector as _};

/// A direction towards a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample<R: Real> {
    /// Unit direction from the shading point.
    pub wi: R::Vec3,
    /// Distance of the point of the light that was sampled.
    pub distance: R,
    /// Density of `wi` per solid angle, in 1/sr.
    pub pdf: R,
}

impl<R: Real> LightSample<R> {
    /// The sample at `point`, drawn with density `1 / area` on a light whose unit normal there is `normal`:
    /// `pdf = d² / (area |cos|)`. `None` where the light is seen edge-on or has no extent.
    pub fn of_area(point: R::Vec3, normal: R::Vec3, area: R) -> Option<Self> {
        let wi = point.try_unit()?;
        let distance = point.length();
        let projected = wi.dot(normal).abs() * area;
        let pdf = distance.squared() / projected;
        (projected > R::ZERO && pdf.is_finite()).then_some(Self { wi, distance, pdf })
    }
}

/// A light with directions to draw: one that spans a solid angle.
pub trait SampleLight<R: Real> {
    /// A direction towards the light from `u` ∈ [0, 1)², or `None` where nothing of it is to be seen.
    fn sample(&self, u: [R; 2]) -> Option<LightSample<R>>;

    /// Density per solid angle with which [`SampleLight::sample`] draws the unit direction `wi`; 0 off the light.
    fn pdf(&self, wi: R::Vec3) -> R;
}
