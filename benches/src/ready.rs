//! Lights and matrices ready made in a precision, so that what is timed is the integral alone.

use glam::DMat3;
use ltc_core::{
    AnyLight, Cylinder, Disk, Ellipse, InputError, Light, Line, Matrix, Polygon, Real, Sphere, Strip, Vector,
};

/// A number that `f32` holds.
fn number<R: Real>(x: &f64) -> R {
    R::of(f64::from(*x as f32))
}

/// A vector whose numbers `f32` holds.
pub(crate) fn vector<R: Real>([x, y, z]: &[f64; 3]) -> R::Vec3 {
    R::Vec3::new(number(x), number(y), number(z))
}

pub(crate) fn matrix<R: Real>(m: &DMat3) -> R::Mat3 {
    R::Mat3::from_row_array(Matrix::to_row_array(*m).map(R::of))
}

/// The light; `corners` are those of a polygon, in that precision.
pub(crate) fn ready<'a, R: Real>(
    light: &AnyLight,
    corners: &'a [R::Vec3],
) -> Result<Box<dyn Light<R> + 'a>, InputError> {
    let (v, r) = (vector::<R>, number::<R>);
    Ok(match light {
        AnyLight::Polygon { sides, .. } => Box::new(Polygon::new(corners, *sides)?),
        AnyLight::Line { p0, p1, radius } => Box::new(Line::new(v(p0), v(p1), r(radius))?),
        AnyLight::Strip { p0, p1, width, normal, sides } => {
            Box::new(Strip::new(v(p0), v(p1), r(width), v(normal), *sides)?)
        }
        AnyLight::Cylinder { p0, p1, radius, caps } => {
            Box::new(Cylinder::new(v(p0), v(p1), r(radius), *caps)?)
        }
        AnyLight::Disk { center, normal, radius, sides } => {
            Box::new(Disk::new(v(center), v(normal), r(radius), *sides)?)
        }
        AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
            Box::new(Ellipse::new(v(center), v(axis_u), v(axis_v), *sides)?)
        }
        AnyLight::Sphere { center, radius } => Box::new(Sphere::new(v(center), r(radius))?),
    })
}
