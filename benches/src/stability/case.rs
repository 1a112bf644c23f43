//! One lobe and one light.

use glam::DMat3;
use ltc_core::{AnyLight, Horizon, InputError, Light as _, Ltc, Matrix, Quad, Real, Vector as _};

/// A lobe and a light whose numbers are all exact in `f32`, so that every precision has the same input.
#[derive(Clone, Debug)]
pub struct Case {
    /// `M`, row-major.
    pub m: [f64; 9],
    /// The light.
    pub light: AnyLight,
    /// Whether a polygon of four vertices is evaluated as a [`Quad`].
    pub as_quad: bool,
}

fn rounded(x: f64) -> f64 {
    f64::from(x as f32)
}

fn rounded_point(p: [f64; 3]) -> [f64; 3] {
    p.map(rounded)
}

impl Case {
    /// The case with every number rounded to `f32`.
    pub fn new(m: DMat3, light: AnyLight, as_quad: bool) -> Self {
        let p = rounded_point;
        let light = match light {
            AnyLight::Polygon { vertices, sides } => {
                AnyLight::Polygon { vertices: vertices.into_iter().map(p).collect(), sides }
            }
            AnyLight::Line { p0, p1, radius } => {
                AnyLight::Line { p0: p(p0), p1: p(p1), radius: rounded(radius) }
            }
            AnyLight::Strip { p0, p1, width, normal, sides } => {
                AnyLight::Strip { p0: p(p0), p1: p(p1), width: rounded(width), normal: p(normal), sides }
            }
            AnyLight::Cylinder { p0, p1, radius, caps } => {
                AnyLight::Cylinder { p0: p(p0), p1: p(p1), radius: rounded(radius), caps }
            }
            AnyLight::Disk { center, normal, radius, sides } => {
                AnyLight::Disk { center: p(center), normal: p(normal), radius: rounded(radius), sides }
            }
            AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
                AnyLight::Ellipse { center: p(center), axis_u: p(axis_u), axis_v: p(axis_v), sides }
            }
            AnyLight::Sphere { center, radius } => {
                AnyLight::Sphere { center: p(center), radius: rounded(radius) }
            }
        };
        Self { m: m.to_row_array().map(rounded), light, as_quad }
    }

    /// The fraction of the lobe that sees the light, computed in `R`.
    ///
    /// # Errors
    /// Those of [`Ltc::new`] and [`AnyLight::integrate`].
    pub fn fraction<R: Real>(&self) -> Result<f64, InputError> {
        let ltc = Ltc::<R>::new(R::Mat3::from_row_array(self.m.map(R::of)))?;
        let value = match &self.light {
            AnyLight::Polygon { vertices, sides } if self.as_quad => {
                let corner = |i: usize| vertices.get(i).copied().unwrap_or_default().map(R::of);
                let corners = [0, 1, 2, 3].map(corner).map(|[x, y, z]| R::Vec3::new(x, y, z));
                Quad::new(corners, *sides)?.integrate(&ltc)
            }
            light => light.integrate(&ltc, Horizon::BOTH)?,
        };
        Ok(value.to_f64())
    }

    /// Condition number of `M`.
    pub fn condition(&self) -> f64 {
        ltc_fit::measure::condition(DMat3::from_row_array(self.m))
    }
}
