//! Scenes.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::camera::View;
use crate::emitter::Emitter;
use crate::object::Shape;
use crate::validate::color;
use crate::{Camera, Light, Object, RenderError, ResolvedMaterial, SceneError};

/// A scene: what is in it, what lights it, and from where it is seen. World space is right-handed, y is up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// From where it is seen.
    pub camera: Camera,
    /// Radiance where nothing is, linear RGB. It lights nothing.
    #[serde(default)]
    pub background: [f64; 3],
    /// What is in it.
    pub objects: Vec<Object>,
    /// What lights it; visible to the camera.
    pub lights: Vec<Light>,
    /// What the names of textures' files are relative to: the folder of the scene's own file, set by [`Scene::load`].
    #[serde(skip)]
    pub folder: PathBuf,
}

/// A checked scene, ready for rendering.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub view: View,
    pub background: DVec3,
    pub shapes: Vec<Shape>,
    /// One for each shape.
    pub materials: Vec<ResolvedMaterial>,
    pub lights: Vec<Emitter>,
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// [`RenderError::Read`], [`RenderError::Json`] with line and column, [`RenderError::Scene`] naming the field.
    pub fn load(path: &Path) -> Result<Self, RenderError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|source| RenderError::Read { path: name.clone(), source })?;
        let mut scene: Self =
            serde_json::from_str(&text).map_err(|source| RenderError::Json { path: name, source })?;
        scene.folder = path.parent().map(Path::to_owned).unwrap_or_default();
        scene.validate()?;
        Ok(scene)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`SceneError`] naming the first field that is wrong, for example `objects[2].radius is -1, must be above 0`.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.world().map(|_| ())
    }

    pub(crate) fn world(&self) -> Result<World, SceneError> {
        let view = self.camera.view()?;
        let background = color("background", self.background, 1e9)?;
        let mut world = World { view, background, shapes: vec![], materials: vec![], lights: vec![] };
        for (i, object) in self.objects.iter().enumerate() {
            let field = format!("objects[{i}]");
            world.shapes.push(object.shape(&field)?);
            world.materials.push(object.material().resolve(&format!("{field}.material"))?);
        }
        for (i, light) in self.lights.iter().enumerate() {
            world.lights.push(light.resolve(&format!("lights[{i}]"), &self.folder)?);
        }
        Ok(world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"{
        "camera": {"position": [0, 1, 5], "look_at": [0, 1, 0], "fov_y_degrees": 40, "width": 64, "height": 36},
        "objects": [
            {"type": "plane", "point": [0, 0, 0], "material": {"roughness": 0.3}},
            {"type": "sphere", "center": [0, 1, 0], "radius": 1, "material": {"alpha_x": 0.3, "alpha_y": 0.1}}
        ],
        "lights": [{"type": "rectangle", "center": [0, 3, 0], "half_u": [1, 0, 0], "half_v": [0, 0, 1], "intensity": 4}]
    }"#;

    fn message(json: &str) -> String {
        match serde_json::from_str::<Scene>(json) {
            Err(e) => e.to_string(),
            Ok(scene) => scene.validate().unwrap_err().to_string(),
        }
    }

    #[test]
    fn a_scene_survives_a_round_trip() {
        let scene: Scene = serde_json::from_str(SCENE).unwrap();
        scene.validate().unwrap();
        assert_eq!(scene.camera.up, [0.0, 1.0, 0.0]);
        let again: Scene = serde_json::from_str(&serde_json::to_string(&scene).unwrap()).unwrap();
        assert_eq!(scene, again);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_index() {
        assert_eq!(
            message(&SCENE.replace("\"radius\": 1,", "\"radius\": -1,")),
            "objects[1].radius is -1, must be above 0"
        );
        assert_eq!(
            message(&SCENE.replace("\"roughness\": 0.3", "\"roughness\": 3")),
            "objects[0].material.roughness is 3, must be in [0, 1]"
        );
        assert!(
            message(&SCENE.replace("\"half_u\": [1", "\"half_u\": [1e300"))
                .starts_with("lights[0].half_u has x = ")
        );
        assert!(message(&SCENE.replace("\"sphere\"", "\"cube\"")).contains("unknown variant `cube`"));
        assert!(message(&SCENE.replace("\"radius\"", "\"radios\"")).contains("unknown field `radios`"));
        assert!(message(&SCENE.replace("\"lights\"", "\"light\"")).contains("unknown field `light`"));
        let mut scene: Scene = serde_json::from_str(SCENE).unwrap();
        scene.background[1] = f64::NAN;
        assert_eq!(
            scene.validate().unwrap_err().to_string(),
            "background has green = NaN, must be in [0, 1000000000]"
        );
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = Scene::load("no/such/scene.json".as_ref()).unwrap_err();
        assert!(error.to_string().starts_with("no/such/scene.json: "), "{error}");
    }
}
