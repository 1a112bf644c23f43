//! Checks of scene fields, each with an error that names the field.

use glam::DVec3;

use crate::SceneError;

/// The largest magnitude of a coordinate: far within `f32`, in which the GPU computes.
const FARTHEST: f64 = 1e9;

/// An error about `field`.
pub(crate) fn problem(field: impl Into<String>, problem: impl Into<String>) -> SceneError {
    SceneError { field: field.into(), problem: problem.into() }
}

/// A finite point or vector within the world.
pub(crate) fn vector(field: &str, value: [f64; 3]) -> Result<DVec3, SceneError> {
    for (axis, x) in ["x", "y", "z"].iter().zip(value) {
        if !x.is_finite() {
            return Err(problem(field, format!("has {axis} = {x}, must be finite")));
        }
        if x.abs() > FARTHEST {
            return Err(problem(field, format!("has {axis} = {x}, must be within ±{FARTHEST:e}")));
        }
    }
    Ok(DVec3::from_array(value))
}

/// A unit vector from one that has a direction.
pub(crate) fn direction(field: &str, value: [f64; 3]) -> Result<DVec3, SceneError> {
    let v = vector(field, value)?;
    v.try_normalize().ok_or_else(|| problem(field, "is zero, must have a direction"))
}

/// A number in `[min, max]`.
pub(crate) fn range(field: &str, value: f64, min: f64, max: f64) -> Result<f64, SceneError> {
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(problem(field, format!("is {value}, must be in [{min}, {max}]")))
    }
}

/// A length: finite, above 0, within the world.
pub(crate) fn length(field: &str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value <= FARTHEST {
        Ok(value)
    } else if value.is_finite() && value > FARTHEST {
        Err(problem(field, format!("is {value}, must be at most {FARTHEST:e}")))
    } else {
        Err(problem(field, format!("is {value}, must be above 0")))
    }
}

/// Three channels in `[0, max]`.
pub(crate) fn color(field: &str, value: [f64; 3], max: f64) -> Result<DVec3, SceneError> {
    for (channel, x) in ["red", "green", "blue"].iter().zip(value) {
        if !(0.0..=max).contains(&x) {
            return Err(problem(field, format!("has {channel} = {x}, must be in [0, {max}]")));
        }
    }
    Ok(DVec3::from_array(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_never_accepted() {
        assert!(vector("v", [0.0, f64::NAN, 0.0]).is_err());
        assert!(direction("v", [f64::NAN; 3]).is_err());
        assert!(range("x", f64::NAN, 0.0, 1.0).is_err());
        assert!(length("r", f64::NAN).is_err());
        assert!(color("c", [f64::NAN, 0.0, 0.0], 1.0).is_err());
    }

    #[test]
    fn errors_name_the_field_and_the_bound() {
        assert_eq!(
            length("objects[2].radius", -1.0).unwrap_err().to_string(),
            "objects[2].radius is -1, must be above 0"
        );
        assert_eq!(direction("up", [0.0; 3]).unwrap_err().to_string(), "up is zero, must have a direction");
        assert!(length("r", f64::INFINITY).is_err());
    }
}
