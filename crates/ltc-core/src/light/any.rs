//! Lights as plain numbers, whatever their shape.

use super::{Cylinder, Disk, Ellipse, Horizon, Light, Line, Polygon, Sides, Sphere, Strip};
use crate::{InputError, Ltc, Real, Vector};

/// A light of any shape as the numbers that define it, relative to the shading point in the shading frame: for input files,
/// lists of mixed lights, and tests.
///
/// The numbers are checked and rounded to the precision asked for at every evaluation; who shades many points takes the
/// shapes themselves.
///
/// ```
/// use ltc_core::{AnyLight, Horizon, Ltc};
/// let light = AnyLight::Sphere { center: [0.0, 0.0, 2.0], radius: 0.5 };
/// let fraction: f64 = light.integrate(&Ltc::cosine(), Horizon::BOTH)?;
/// assert!((fraction - 0.0625).abs() < 1e-12); // (radius / distance)²
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are those of the shapes' constructors, described there")]
pub enum AnyLight {
    /// [`Polygon`]
    Polygon { vertices: Vec<[f64; 3]>, sides: Sides },
    /// [`Line`]
    Line { p0: [f64; 3], p1: [f64; 3], radius: f64 },
    /// [`Strip`]
    Strip { p0: [f64; 3], p1: [f64; 3], width: f64, normal: [f64; 3], sides: Sides },
    /// [`Cylinder`]
    Cylinder { p0: [f64; 3], p1: [f64; 3], radius: f64, caps: bool },
    /// [`Disk`]
    Disk { center: [f64; 3], normal: [f64; 3], radius: f64, sides: Sides },
    /// [`Ellipse`]
    Ellipse { center: [f64; 3], axis_u: [f64; 3], axis_v: [f64; 3], sides: Sides },
    /// [`Sphere`]
    Sphere { center: [f64; 3], radius: f64 },
}

impl AnyLight {
    /// The name of its shape, as in input files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Polygon { .. } => "polygon",
            Self::Line { .. } => "line",
            Self::Strip { .. } => "strip",
            Self::Cylinder { .. } => "cylinder",
            Self::Disk { .. } => "disk",
            Self::Ellipse { .. } => "ellipse",
            Self::Sphere { .. } => "sphere",
        }
    }

    /// [`Light::integrate_within`] of the shape, in precision `R`.
    ///
    /// # Errors
    /// Those of the shape's constructor; [`InputError::NotFinite`] for a number that `R` cannot hold.
    pub fn integrate<R: Real>(&self, ltc: &Ltc<R>, horizon: Horizon) -> Result<R, InputError> {
        let v = |[x, y, z]: &[f64; 3]| R::Vec3::new(R::of(*x), R::of(*y), R::of(*z));
        let r = |x: &f64| R::of(*x);
        Ok(match self {
            Self::Polygon { vertices, sides } => {
                let vertices: Vec<R::Vec3> = vertices.iter().map(v).collect();
                Polygon::new(&vertices, *sides)?.integrate_within(ltc, horizon)
            }
            Self::Line { p0, p1, radius } => {
                Line::new(v(p0), v(p1), r(radius))?.integrate_within(ltc, horizon)
            }
            Self::Strip { p0, p1, width, normal, sides } => {
                Strip::new(v(p0), v(p1), r(width), v(normal), *sides)?.integrate_within(ltc, horizon)
            }
            Self::Cylinder { p0, p1, radius, caps } => {
                Cylinder::new(v(p0), v(p1), r(radius), *caps)?.integrate_within(ltc, horizon)
            }
            Self::Disk { center, normal, radius, sides } => {
                Disk::new(v(center), v(normal), r(radius), *sides)?.integrate_within(ltc, horizon)
            }
            Self::Ellipse { center, axis_u, axis_v, sides } => {
                Ellipse::new(v(center), v(axis_u), v(axis_v), *sides)?.integrate_within(ltc, horizon)
            }
            Self::Sphere { center, radius } => {
                Sphere::new(v(center), r(radius))?.integrate_within(ltc, horizon)
            }
        })
    }
}
