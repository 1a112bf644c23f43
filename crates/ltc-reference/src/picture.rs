//! Pictures on flat lights.

use glam::DVec3;

use crate::ReferenceError;

/// A picture that a flat light shows: bilinear between the middles of its texels, and the edge's colour beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
}

impl Picture {
    /// `width · height` linear colours, row by row, the first row at v = 0. Missing texels are black, surplus ones are dropped.
    ///
    /// # Errors
    /// [`ReferenceError::NonFiniteInput`].
    pub fn new(width: usize, height: usize, mut texels: Vec<[f32; 3]>) -> Result<Self, ReferenceError> {
        if !texels.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(ReferenceError::NonFiniteInput { what: "texel" });
        }
        let (width, height) = (width.max(1), height.max(1));
        texels.resize(width * height, [0.0; 3]);
        Ok(Self { width, height, texels })
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The texels, row by row, the first at v = 0.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// The colour at (u, v), where [0, 1]² is the picture.
    pub fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        let (i, s) = between(u, self.width);
        let (j, t) = between(v, self.height);
        let texel = |i: usize, j: usize| {
            let [r, g, b] = self.texels[j.min(self.height - 1) * self.width + i.min(self.width - 1)];
            DVec3::new(r.into(), g.into(), b.into())
        };
        let row = |j: usize| texel(i, j).lerp(texel(i + 1, j), s);
        row(j).lerp(row(j + 1), t)
    }
}

/// The texel before `x`, and how far `x` is on the way to the next.
fn between(x: f64, count: usize) -> (usize, f64) {
    let at = (x * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
    (at as usize, at - at.floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_met_in_their_middles_and_mixed_between() {
        let picture = Picture::new(2, 2, vec![[0.0; 3], [4.0; 3], [8.0; 3], [12.0; 3]]).unwrap();
        for (uv, expected) in [
            ([0.25, 0.25], 0.0),
            ([0.75, 0.25], 4.0),
            ([0.25, 0.75], 8.0),
            ([0.5, 0.5], 6.0),
            ([0.5, 0.25], 2.0),
            ([-3.0, 9.0], 8.0),
            ([1.0, 1.0], 12.0),
        ] {
            assert_eq!(picture.at(uv), DVec3::splat(expected), "{uv:?}");
        }
        assert!(Picture::new(1, 1, vec![[f32::NAN; 3]]).is_err());
    }
}
