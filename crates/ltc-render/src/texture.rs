//! Textures of lights, as scenes give them.

use std::path::Path;

use glam::DVec3;
use ltc_reference::Picture;
use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::picture_file;
use crate::texture_map::TextureMap;
use crate::validate::{color, problem, vector};

/// The largest value of a texel: products stay far within `f32`.
const BRIGHTEST: f64 = 1e9;
/// Texels along either side of a texture.
pub(crate) const MAX_SIDE: usize = 2048;
/// Texels along a checker's cell, so that its edges are sharp.
const CELL: usize = 16;
/// Cells along either side of a checker.
const MAX_CELLS: usize = 64;

/// What a flat light's radiance is multiplied with, place by place: a picture, bilinear between the middles of its texels. Exactly
/// one of `file`, `checker` and `texels` is given.
///
/// It stands upright seen from the emitting side with u to the right and v up, and is mirrored seen from behind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texture {
    /// A PNG (8 or 16 bit sRGB, opaque) or an EXR (linear), relative to the scene's file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// A board of squares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checker: Option<Checker>,
    /// Rows of linear RGB, the uppermost first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<Vec<Vec<[f64; 3]>>>,
    /// How it lies on a polygon. A rectangle is filled: u along `half_u`, v along `half_v`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
}

/// A board of squares of two colours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checker {
    /// Squares along u, 1 to 64.
    pub columns: usize,
    /// Squares along v, 1 to 64.
    pub rows: usize,
    /// Of the square at the upper left corner, and of its neighbours; linear RGB.
    #[serde(default = "white_and_black")]
    pub colors: [[f64; 3]; 2],
}

/// A parallelogram that a texture fills, in the plane of its light and around it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Its lower left corner.
    pub corner: [f64; 3],
    /// From there to the lower right one.
    pub axis_u: [f64; 3],
    /// From there to the upper left one.
    pub axis_v: [f64; 3],
}

fn white_and_black() -> [[f64; 3]; 2] {
    [[1.0; 3], [0.0; 3]]
}

impl Texture {
    /// On the rectangle with these corners. `field` is the path of the texture in the scene, for errors; `folder` what its file
    /// is relative to.
    pub(crate) fn on_rectangle(
        &self,
        corners: &[DVec3; 4],
        field: &str,
        folder: &Path,
    ) -> Result<TextureMap, SceneError> {
        if self.frame.is_some() {
            return Err(problem(format!("{field}.frame"), "is for polygons; a rectangle is filled"));
        }
        Ok(TextureMap::filling(self.picture(field, folder)?, corners))
    }

    /// On the polygon with these vertices.
    pub(crate) fn on_polygon(
        &self,
        vertices: &[DVec3],
        field: &str,
        folder: &Path,
    ) -> Result<TextureMap, SceneError> {
        let Some(Frame { corner, axis_u, axis_v }) = self.frame else {
            return Err(problem(field, "needs a frame: the parallelogram that it fills"));
        };
        let at = format!("{field}.frame");
        let part = |name: &str, v| vector(&format!("{at}.{name}"), v);
        let frame = [part("corner", corner)?, part("axis_u", axis_u)?, part("axis_v", axis_v)?];
        TextureMap::around(self.picture(field, folder)?, frame, vertices).map_err(|words| problem(at, words))
    }

    fn picture(&self, field: &str, folder: &Path) -> Result<Picture, SceneError> {
        let (width, height, texels) = match (&self.file, &self.checker, &self.texels) {
            (Some(file), None, None) => {
                let field = format!("{field}.file");
                picture_file::read(&folder.join(file))
                    .map_err(|words| problem(field, format!("is \"{file}\": {words}")))?
            }
            (None, Some(checker), None) => checker.texels(&format!("{field}.checker"))?,
            (None, None, Some(rows)) => own_texels(rows, &format!("{field}.texels"))?,
            _ => return Err(problem(field, "needs exactly one of file, checker and texels")),
        };
        Picture::new(width, height, texels).map_err(|e| problem(field, e.to_string()))
    }
}

/// Width, height, and texels from the lowest row up.
pub(crate) type Texels = (usize, usize, Vec<[f32; 3]>);

fn side(field: &str, count: usize, most: usize) -> Result<usize, SceneError> {
    let range = 1..=most;
    let must = || problem(field, format!("is {count}, must be in [1, {most}]"));
    range.contains(&count).then_some(count).ok_or_else(must)
}

fn own_texels(rows: &[Vec<[f64; 3]>], field: &str) -> Result<Texels, SceneError> {
    let height = side(&format!("number of rows of {field}"), rows.len(), MAX_SIDE)?;
    let width = side(&format!("length of {field}[0]"), rows[0].len(), MAX_SIDE)?;
    let mut texels = Vec::with_capacity(width * height);
    for (i, row) in rows.iter().enumerate().rev() {
        if row.len() != width {
            return Err(problem(
                format!("{field}[{i}]"),
                format!("has {} texels, must have {width}", row.len()),
            ));
        }
        for (j, texel) in row.iter().enumerate() {
            texels.push(color(&format!("{field}[{i}][{j}]"), *texel, BRIGHTEST)?.as_vec3().to_array());
        }
    }
    Ok((width, height, texels))
}

impl Checker {
    fn texels(&self, field: &str) -> Result<Texels, SceneError> {
        let columns = side(&format!("{field}.columns"), self.columns, MAX_CELLS)?;
        let rows = side(&format!("{field}.rows"), self.rows, MAX_CELLS)?;
        let mut colors = [[0.0; 3]; 2];
        for (i, own) in self.colors.iter().enumerate() {
            colors[i] = color(&format!("{field}.colors[{i}]"), *own, BRIGHTEST)?.as_vec3().to_array();
        }
        let (width, height) = (columns * CELL, rows * CELL);
        // Counted from the upper row, while texels go from the lowest up.
        let at = |k: usize| colors[(k % width / CELL + (rows - 1 - k / width / CELL)) % 2];
        Ok((width, height, (0..width * height).map(at).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(json: &str) -> Result<Texture, String> {
        serde_json::from_str(json).map_err(|e| e.to_string())
    }

    fn picture(json: &str) -> Result<Picture, String> {
        parse(json)?.picture("texture", Path::new("nowhere")).map_err(|e| e.to_string())
    }

    #[test]
    fn the_first_row_is_the_uppermost() {
        let own = picture(r#"{"texels": [[[1,0,0],[0,1,0]],[[0,0,1],[2,2,2]]]}"#).unwrap();
        assert_eq!(own.at([0.0, 1.0]), DVec3::X);
        assert_eq!(own.at([1.0, 1.0]), DVec3::Y);
        assert_eq!(own.at([1.0, 0.0]), DVec3::splat(2.0));
        let board = r#"{"checker": {"columns": 3, "rows": 2, "colors": [[1,0,0],[0,0,2]]}}"#;
        let board = picture(board).unwrap();
        assert_eq!((board.width(), board.height()), (48, 32));
        assert_eq!(board.at([0.1, 0.9]), DVec3::X);
        assert_eq!(board.at([0.1, 0.1]), DVec3::Z * 2.0);
        assert_eq!(board.at([0.9, 0.9]), DVec3::X);
    }

    #[test]
    fn nonsense_is_named() {
        for (json, said) in [
            ("{}", "texture needs exactly one of file, checker and texels"),
            (
                r#"{"file": "a.png", "checker": {"columns": 1, "rows": 1}}"#,
                "texture needs exactly one of file, checker and texels",
            ),
            (r#"{"texels": []}"#, "number of rows of texture.texels is 0, must be in [1, 2048]"),
            (r#"{"texels": [[]]}"#, "length of texture.texels[0] is 0, must be in [1, 2048]"),
            (r#"{"texels": [[[1,1,1]],[]]}"#, "texture.texels[1] has 0 texels, must have 1"),
            (
                r#"{"texels": [[[1,-1,1]]]}"#,
                "texture.texels[0][0] has green = -1, must be in [0, 1000000000]",
            ),
            (
                r#"{"checker": {"columns": 65, "rows": 1}}"#,
                "texture.checker.columns is 65, must be in [1, 64]",
            ),
        ] {
            assert_eq!(picture(json).unwrap_err(), said, "{json}");
        }
        assert!(parse(r#"{"image": "a.png"}"#).unwrap_err().contains("unknown field `image`"));
        let missing = picture(r#"{"file": "a.png"}"#).unwrap_err();
        assert!(missing.starts_with("texture.file is \"a.png\": "), "{missing}");
    }
}
