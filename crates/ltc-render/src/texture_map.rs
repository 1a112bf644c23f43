//! A picture on a flat light.

use glam::DVec3;
use ltc_core::{PrefilteredTexture, TexelGrid, TextureFrame};
use ltc_reference::Picture;
use rayon::prelude::*;

/// Points of a texel's side at which it is asked whether it belongs to the light.
const COVERAGE_SIDE: usize = 4;

/// A picture, where it lies in the world, and which part of it is the light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TextureMap {
    pub picture: Picture,
    /// (u, v) is at `frame[0] + u · frame[1] + v · frame[2]`.
    pub frame: [DVec3; 3],
    /// For each texel; all of it where there is none.
    coverage: Option<Vec<f32>>,
}

impl TextureMap {
    /// On the parallelogram with these corners.
    pub fn filling(picture: Picture, corners: &[DVec3; 4]) -> Self {
        let [origin, second, _, last] = *corners;
        Self { picture, frame: [origin, second - origin, last - origin], coverage: None }
    }

    /// On a polygon within the frame; what is wrong otherwise, in words.
    pub fn around(picture: Picture, frame: [DVec3; 3], vertices: &[DVec3]) -> Result<Self, String> {
        let [origin, u, v] = frame;
        let reach = u.length() + v.length();
        let normal = u.cross(v);
        if normal.length() <= 1e-9 * reach * reach {
            return Err("spans no plane".to_owned());
        }
        let outline: Vec<_> = vertices.iter().map(|p| place(frame, *p)).collect();
        for (i, (vertex, uv)) in vertices.iter().zip(&outline).enumerate() {
            let off = normal.dot(*vertex - origin).abs() / normal.length();
            if off > 1e-6 * reach {
                return Err(format!("is not in the light's plane: vertices[{i}] is {off} from it"));
            }
            if uv.iter().any(|x| !(-1e-6..=1.0 + 1e-6).contains(x)) {
                return Err(format!(
                    "does not reach around vertices[{i}], which has u = {}, v = {}",
                    uv[0], uv[1]
                ));
            }
        }
        let coverage = coverage(picture.width(), picture.height(), &outline);
        Ok(Self { picture, frame, coverage: Some(coverage) })
    }

    /// Whether the light is the whole picture.
    #[cfg(feature = "gpu")]
    pub fn fills(&self) -> bool {
        self.coverage.is_none()
    }

    /// Filtered for LTCs; says what is wrong with a light that covers none of it.
    pub fn prefiltered(&self) -> Result<PrefilteredTexture, ltc_core::InputError> {
        let grid = TexelGrid {
            width: self.picture.width(),
            height: self.picture.height(),
            colours: self.picture.texels(),
            coverage: self.coverage.as_deref(),
        };
        PrefilteredTexture::by_rows(grid, &|count, row| (0..count).into_par_iter().map(row).collect())
    }

    /// The frame with its points and directions moved.
    pub fn moved(&self, point: impl Fn(DVec3) -> DVec3, direction: impl Fn(DVec3) -> DVec3) -> [DVec3; 3] {
        let [origin, u, v] = self.frame;
        [point(origin), direction(u), direction(v)]
    }

    /// The colour at a point of the light; `frame` is where the texture lies.
    pub fn colour(&self, frame: [DVec3; 3], point: DVec3) -> DVec3 {
        self.picture.at(place(frame, point))
    }
}

/// As the LTC back ends name it.
pub(crate) fn texture_frame([origin, axis_u, axis_v]: [DVec3; 3]) -> TextureFrame<f64> {
    TextureFrame { origin, axis_u, axis_v }
}

/// (u, v) of a point of the plane.
fn place([origin, u, v]: [DVec3; 3], point: DVec3) -> [f64; 2] {
    let (normal, offset) = (u.cross(v), point - origin);
    let square = normal.length_squared();
    [offset.cross(v).dot(normal) / square, u.cross(offset).dot(normal) / square]
}

/// How much of each texel is inside the outline.
fn coverage(width: usize, height: usize, outline: &[[f64; 2]]) -> Vec<f32> {
    let count = (COVERAGE_SIDE * COVERAGE_SIDE) as f32;
    let step =
        |i: usize, k: usize, size: usize| (i as f64 + (k as f64 + 0.5) / COVERAGE_SIDE as f64) / size as f64;
    let texel = |k: usize| {
        let (i, j) = (k % width, k / width);
        let inside = (0..COVERAGE_SIDE * COVERAGE_SIDE).filter(|s| {
            let uv = [step(i, s % COVERAGE_SIDE, width), step(j, s / COVERAGE_SIDE, height)];
            contains(outline, uv)
        });
        inside.count() as f32 / count
    };
    (0..width * height).map(texel).collect()
}

/// By the parity of edges crossed.
fn contains(outline: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, b) in outline.iter().enumerate() {
        let a = outline[(i + outline.len() - 1) % outline.len()];
        let crosses = (a[1] > y) != (b[1] > y);
        if crosses && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        Picture::new(2, 2, vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [4.0; 3]]).unwrap()
    }

    #[test]
    fn colours_are_where_the_frame_says() {
        let frame = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 1.0, -3.0)];
        let triangle = [frame[0], frame[0] + frame[1], frame[0] + frame[2]];
        let map = TextureMap::around(picture(), frame, &triangle).unwrap();
        assert_eq!(map.colour(frame, frame[0]), DVec3::X);
        assert_eq!(map.colour(frame, frame[0] + frame[1]), DVec3::Y);
        // Half the square: the upper right texel is no light, but for what the sampling grid has on the diagonal.
        let coverage = map.coverage.unwrap();
        assert!(coverage[0] == 1.0 && coverage[3] < 0.1 && (coverage[1] - 0.5).abs() < 0.2, "{coverage:?}");
    }

    #[test]
    fn threads_filter_to_the_same_bits() {
        let texels = (0..48 * 20).map(|k| [(k % 7) as f32, (k % 48) as f32, 1.0]).collect();
        let picture = Picture::new(48, 20, texels).unwrap();
        let map = TextureMap { picture, frame: [DVec3::ZERO, DVec3::X, DVec3::Y], coverage: None };
        let grid = TexelGrid { width: 48, height: 20, colours: map.picture.texels(), coverage: None };
        assert_eq!(map.prefiltered().unwrap(), PrefilteredTexture::new(grid).unwrap());
    }

    #[test]
    fn frames_that_do_not_fit_are_named() {
        let frame = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let said = |frame, vertices: &[DVec3]| TextureMap::around(picture(), frame, vertices).unwrap_err();
        assert_eq!(said([DVec3::ZERO, DVec3::X, DVec3::X], &[]), "spans no plane");
        assert!(
            said(frame, &[DVec3::ZERO, DVec3::Z]).starts_with("is not in the light's plane: vertices[1]")
        );
        assert!(said(frame, &[DVec3::ZERO, DVec3::X * 1.1]).starts_with("does not reach around vertices[1]"));
    }
}
