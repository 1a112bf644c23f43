//! Materials: anisotropic GGX over Lambert.

use glam::DVec3;
use ltc_core::{Alpha, InputError, PerceptualRoughness};
use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::validate::{color, problem, range};

/// A material. Its width is given either by `roughness` (with `anisotropy`) or by `alpha_x` and `alpha_y`.
///
/// Reflected light is that of the specular lobe plus that of the diffuse one; the diffuse one is not dimmed by what the
/// specular one reflects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Perceptual roughness in [0, 1]; the GGX width is its square.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roughness: Option<f64>,
    /// With `roughness`: 0 (isotropic, default) to 1, as glTF's `KHR_materials_anisotropy` has it: the width along the
    /// tangent grows to `mix(roughness², 1, anisotropy²)`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anisotropy: Option<f64>,
    /// GGX width along the tangent, in [0, 1].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alpha_x: Option<f64>,
    /// GGX width along the bitangent, in [0, 1].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alpha_y: Option<f64>,
    /// Turns the tangent counter-clockwise about the normal, degrees, in [−360, 360].
    #[serde(default)]
    pub rotation_degrees: f64,
    /// Specular reflectance at normal incidence, linear RGB in [0, 1].
    #[serde(default = "dielectric")]
    pub f0: [f64; 3],
    /// Specular reflectance at grazing incidence, in [0, 1].
    #[serde(default = "one")]
    pub f90: f64,
    /// Albedo of the diffuse lobe, linear RGB in [0, 1]; 0 for metals.
    #[serde(default)]
    pub diffuse: [f64; 3],
}

fn dielectric() -> [f64; 3] {
    [0.04; 3]
}

fn one() -> f64 {
    1.0
}

/// A checked material, ready for shading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedMaterial {
    /// GGX widths.
    pub alpha: Alpha,
    /// Turn of the tangent, radians.
    pub rotation: f64,
    /// Specular reflectance at normal incidence.
    pub f0: DVec3,
    /// Specular reflectance at grazing incidence.
    pub f90: f64,
    /// Diffuse albedo.
    pub albedo: DVec3,
}

impl Material {
    /// `field` is the path of the material in the scene, for errors.
    ///
    /// # Errors
    /// [`SceneError`] naming the first field that is wrong.
    pub fn resolve(&self, field: &str) -> Result<ResolvedMaterial, SceneError> {
        let at = |name: &str| format!("{field}.{name}");
        let rotation = range(&at("rotation_degrees"), self.rotation_degrees, -360.0, 360.0)?;
        Ok(ResolvedMaterial {
            alpha: self.alpha(field)?,
            rotation: rotation.to_radians(),
            f0: color(&at("f0"), self.f0, 1.0)?,
            f90: range(&at("f90"), self.f90, 0.0, 1.0)?,
            albedo: color(&at("diffuse"), self.diffuse, 1.0)?,
        })
    }

    fn alpha(&self, field: &str) -> Result<Alpha, SceneError> {
        let at = |name: &str| format!("{field}.{name}");
        let unit = |name: &str, value: f64| range(&at(name), value, 0.0, 1.0);
        let refused = |e: InputError| problem(field, format!("has no width: {e}"));
        match (self.roughness, self.alpha_x, self.alpha_y) {
            (Some(roughness), None, None) => {
                let roughness = PerceptualRoughness::new(unit("roughness", roughness)?).map_err(refused)?;
                let anisotropy = unit("anisotropy", self.anisotropy.unwrap_or(0.0))?;
                Alpha::from_perceptual(roughness, anisotropy).map_err(refused)
            }
            (None, Some(x), Some(y)) => {
                if self.anisotropy.is_some() {
                    return Err(problem(
                        at("anisotropy"),
                        "goes with roughness, not with alpha_x and alpha_y",
                    ));
                }
                Alpha::new(unit("alpha_x", x)?, unit("alpha_y", y)?).map_err(refused)
            }
            _ => Err(problem(field, "needs either roughness, or alpha_x and alpha_y")),
        }
    }
}

impl ResolvedMaterial {
    /// Whether both widths are equal.
    pub fn is_isotropic(&self) -> bool {
        self.alpha.x() == self.alpha.y()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(json: &str) -> Result<ResolvedMaterial, String> {
        let material: Material = serde_json::from_str(json).map_err(|e| e.to_string())?;
        material.resolve("m").map_err(|e| e.to_string())
    }

    #[test]
    fn both_ways_of_giving_a_width() {
        let m = parse(r#"{"roughness": 0.5}"#).unwrap();
        assert_eq!((m.alpha.x(), m.alpha.y(), m.is_isotropic()), (0.25, 0.25, true));
        let m = parse(r#"{"roughness": 0.5, "anisotropy": 1, "rotation_degrees": 180}"#).unwrap();
        assert_eq!((m.alpha.x(), m.alpha.y(), m.rotation), (1.0, 0.25, std::f64::consts::PI));
        let m = parse(r#"{"alpha_x": 0.1, "alpha_y": 0.4, "f0": [1, 0.5, 0]}"#).unwrap();
        assert_eq!((m.alpha.x(), m.alpha.y(), m.f0.y), (0.1, 0.4, 0.5));
    }

    #[test]
    fn contradictions_and_nonsense_are_named() {
        for (json, message) in [
            (r"{}", "m needs either roughness, or alpha_x and alpha_y"),
            (r#"{"alpha_x": 0.5}"#, "m needs either roughness, or alpha_x and alpha_y"),
            (r#"{"roughness": 0.5, "alpha_x": 0.1}"#, "m needs either roughness, or alpha_x and alpha_y"),
            (r#"{"roughness": 1.5}"#, "m.roughness is 1.5, must be in [0, 1]"),
            (r#"{"alpha_x": 0.5, "alpha_y": -0.1}"#, "m.alpha_y is -0.1, must be in [0, 1]"),
            (
                r#"{"alpha_x": 0.5, "alpha_y": 0.1, "anisotropy": 0.5}"#,
                "m.anisotropy goes with roughness, not with alpha_x and alpha_y",
            ),
            (r#"{"roughness": 0.5, "f0": [0, 2, 0]}"#, "m.f0 has green = 2, must be in [0, 1]"),
        ] {
            assert_eq!(parse(json).unwrap_err(), message);
        }
        assert!(parse(r#"{"roughnes": 0.5}"#).unwrap_err().contains("unknown field `roughnes`"));
    }
}
