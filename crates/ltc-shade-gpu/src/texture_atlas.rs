//! Prefiltered textures of lights as the shaders read them: all in one texture.

use ltc_core::{PrefilteredTexture, TextureLevel};

/// The levels of any number of [`PrefilteredTexture`]s in one texture of four 32-bit floats a texel, with where they are: all that
/// `ltc_texture_colour` needs. It is fetched texel by texel, without a sampler.
///
/// Row k is the head of texture k. Its texel 0 has the number of levels and the second level's σ. Texels 1 + 2 l and 2 + 2 l have,
/// of level l,
///
/// | | x | y | z | w |
/// |---|---|---|---|---|
/// | 1 + 2 l | column of its first texel | row of it | texels in a row − 1 | rows − 1 |
/// | 2 + 2 l | u of its first texel | v of it | texels a unit of u | texels a unit of v |
///
/// The levels are below the heads, colours in x, y, z.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureAtlas {
    width: usize,
    height: usize,
    texels: Vec<[f32; 4]>,
}

/// Which texture, which of its levels, and the size.
struct Piece {
    texture: usize,
    level: usize,
    size: [usize; 2],
    /// Set by [`pack`].
    at: [usize; 2],
}

impl TextureAtlas {
    /// These, numbered in their order.
    pub fn of(textures: &[PrefilteredTexture]) -> Self {
        let levels: Vec<Vec<TextureLevel<'_>>> = textures.iter().map(|t| t.levels().collect()).collect();
        let mut pieces = Vec::new();
        for (texture, levels) in levels.iter().enumerate() {
            let piece =
                |(level, l): (usize, &TextureLevel<'_>)| Piece { texture, level, size: l.size, at: [0; 2] };
            pieces.extend(levels.iter().enumerate().map(piece));
        }
        let heads = levels.iter().map(|levels| 1 + 2 * levels.len()).max().unwrap_or(1);
        let (width, height) = pack(&mut pieces, heads, textures.len());
        let mut texels = vec![[0.0; 4]; width * height];
        for (texture, levels) in levels.iter().enumerate() {
            let sigma = levels.get(1).map_or(1.0, |level| level.sigma);
            texels[texture * width] = [levels.len() as f32, sigma as f32, 0.0, 0.0];
        }
        for Piece { texture, level, size: [across, down], at: [x, y] } in pieces {
            let TextureLevel { low, spacing, texels: colours, .. } = levels[texture][level];
            let head = texture * width + 1 + 2 * level;
            texels[head] = [x, y, across - 1, down - 1].map(|n| n as f32);
            texels[head + 1] = [low[0], low[1], 1.0 / spacing[0], 1.0 / spacing[1]].map(|n| n as f32);
            for (row, colours) in colours.chunks_exact(across).enumerate() {
                let start = (y + row) * width + x;
                for (texel, [r, g, b]) in texels[start..start + across].iter_mut().zip(colours) {
                    *texel = [*r, *g, *b, 0.0];
                }
            }
        }
        Self { width, height, texels }
    }

    /// Texels in a row.
    pub fn width(&self) -> u32 {
        self.width as u32
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height as u32
    }

    /// The texels, row by row from the heads on.
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }
}

/// Puts the pieces on shelves, the highest first, below the rows of the heads; gives the width and height of everything.
fn pack(pieces: &mut [Piece], heads: usize, rows: usize) -> (usize, usize) {
    let area: usize = pieces.iter().map(|p| p.size[0] * p.size[1]).sum();
    let widest = pieces.iter().map(|p| p.size[0]).max().unwrap_or(1);
    let width = widest.max(heads).max(area.isqrt());
    let mut order: Vec<&mut Piece> = pieces.iter_mut().collect();
    order.sort_by_key(|p| core::cmp::Reverse(p.size[1]));
    let ([mut x, mut y], mut shelf) = ([0, rows], 0);
    for piece in order {
        if x + piece.size[0] > width {
            (x, y, shelf) = (0, y + shelf, 0);
        }
        piece.at = [x, y];
        x += piece.size[0];
        shelf = shelf.max(piece.size[1]);
    }
    // A texture has at least one row.
    (width, (y + shelf).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_core::TexelGrid;

    fn texture(width: usize, height: usize, first: f32) -> PrefilteredTexture {
        let colours: Vec<[f32; 3]> = (0..width * height).map(|i| [first + i as f32, 1.0, 2.0]).collect();
        PrefilteredTexture::new(TexelGrid { width, height, colours: &colours, coverage: None }).unwrap()
    }

    #[test]
    fn every_level_is_where_its_head_says() {
        let textures = [texture(1, 1, 5.0), texture(37, 4, 100.0), texture(8, 64, 7.0)];
        let atlas = TextureAtlas::of(&textures);
        let mut taken = vec![0; atlas.width * atlas.height];
        for (k, texture) in textures.iter().enumerate() {
            let head = &atlas.texels[k * atlas.width..][..atlas.width];
            assert_eq!(head[0][0] as usize, texture.level_count());
            for (l, level) in texture.levels().enumerate() {
                let [x, y, last_x, last_y] = head[1 + 2 * l].map(|n| n as usize);
                assert_eq!([last_x + 1, last_y + 1], level.size);
                for (i, colour) in level.texels.iter().enumerate() {
                    let at = (y + i / level.size[0]) * atlas.width + x + i % level.size[0];
                    assert_eq!(atlas.texels[at][..3], *colour);
                    taken[at] += 1;
                }
                if l > 0 {
                    let sigma = f64::from(head[0][1]) * 2.0_f64.powi(l as i32 - 1);
                    assert_eq!(sigma, level.sigma, "σ doubles from level to level");
                }
            }
        }
        assert!(taken.iter().all(|n| *n <= 1), "levels overlap");
        assert!(taken[..3 * atlas.width].iter().all(|n| *n == 0), "the heads are free");
        let used = taken.iter().sum::<usize>() as f64 / taken.len() as f64;
        assert!(used > 0.6, "{used} of the texels are of use");
    }

    #[test]
    fn nothing_is_a_texture_too() {
        let atlas = TextureAtlas::of(&[]);
        assert_eq!((atlas.width(), atlas.height()), (1, 1));
    }
}
