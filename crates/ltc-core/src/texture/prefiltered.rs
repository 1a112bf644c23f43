//! A texture and its Gaussian levels.

use super::filter::{Source, TextureRows, fill};
use super::level::{Level, TextureLevel, mix};
use crate::{InputError, check_range};

/// Texels of an image: row by row, the first row at v = 0; linear colours, ≥ 0.
///
/// Texel (i, j) covers `[i, i+1]/width × [j, j+1]/height` of the texture's square [0, 1]².
#[derive(Clone, Copy, Debug)]
pub struct TexelGrid<'a> {
    /// Texels in a row; at least 1.
    pub width: usize,
    /// Rows; at least 1.
    pub height: usize,
    /// Colours, `width · height` of them.
    pub colours: &'a [[f32; 3]],
    /// How much of each texel belongs to the light, in [0, 1], for lights that are not the whole square; all of it
    /// where there is none.
    pub coverage: Option<&'a [f32]>,
}

/// A texture filtered by Gaussians of growing width, each kept inside the texture and normalised there
/// (Heitz et al. 2016, §5.3).
///
/// A level of standard deviation σ (in units of the texture's sides) has texels σ/2 apart and a margin of 4σ around the
/// texture; farther out, a wider σ is taken, so that the filter always meets the texture. Widths go by factors of 2 from
/// half a texel to 4, where the level is the mean. Fetches are linear in u, v and log σ.
///
/// ```
/// use ltc_core::{PrefilteredTexture, TexelGrid};
/// let colours = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let texture =
///     PrefilteredTexture::new(TexelGrid { width: 2, height: 1, colours: &colours, coverage: None })?;
/// assert_eq!(texture.fetch([0.25, 0.5], 0.0), [1.0, 0.0, 0.0]);
/// let blurred = texture.fetch([0.5, 0.5], 10.0);
/// assert!((blurred[0] - 0.5).abs() < 1e-2 && (blurred[2] - 0.5).abs() < 1e-2);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PrefilteredTexture {
    /// By growing σ; the first is the texture itself.
    levels: Vec<Level>,
}

/// The widest Gaussian: over the unit square it is as good as constant (it varies by less than 7 %).
const WIDEST: f64 = 4.0;
/// Margin of a level, in its own σ.
const MARGIN: f64 = 4.0;
/// How far outside the texture a filter of width σ may be centred, in σ, before a wider one is taken.
const OUTSIDE: f64 = 2.0;

impl PrefilteredTexture {
    /// Filters an image.
    ///
    /// Time and memory: the levels together have some 4 times the texels of the image.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] for an empty image, one wider than 65,536, a number of texels or coverages that differs
    /// from `width · height`, a colour below 0, a coverage outside [0, 1]; [`InputError::NotFinite`] for a NaN or infinite
    /// one; [`InputError::Degenerate`] when nothing is covered.
    pub fn new(image: TexelGrid<'_>) -> Result<Self, InputError> {
        Self::by_rows(image, &|count, row| (0..count).map(row).collect())
    }

    /// As [`PrefilteredTexture::new`], by a host that has threads: `rows(n, row)` gives `row(0)` to `row(n − 1)`, with rayon for
    /// example `&|n, row| (0..n).into_par_iter().map(row).collect()`. The result is the same to the last bit.
    ///
    /// # Errors
    /// As [`PrefilteredTexture::new`].
    pub fn by_rows(image: TexelGrid<'_>, rows: TextureRows<'_>) -> Result<Self, InputError> {
        let source = checked(image)?;
        let mean = source.mean();
        let finest = 0.5 / image.width.max(image.height) as f64;
        let mut levels: Vec<Level> = Vec::new();
        let mut sigma = WIDEST;
        while sigma > finest {
            let mut level = empty_level(sigma, image);
            let coarser = levels.last();
            fill(&mut level, &source.reduced(sigma), |uv| coarser.map_or(mean, |l| l.fetch(uv)), rows);
            levels.push(level);
            sigma *= 0.5;
        }
        levels.push(own_level(image, levels.last()));
        levels.reverse();
        Ok(Self { levels })
    }

    /// The colour around (u, v), seen through a Gaussian of standard deviation `sigma` that is kept inside the texture.
    ///
    /// Defined for all numbers: far outside the square and for infinite σ it tends to the mean; NaN counts as 0.
    pub fn fetch(&self, uv: [f64; 2], sigma: f64) -> [f32; 3] {
        let outside = uv.map(|x| (-x).max(x - 1.0).max(0.0));
        let sigma = sigma.max(outside[0].max(outside[1]) / OUTSIDE).max(0.0);
        let next = self.levels.partition_point(|level| level.sigma <= sigma);
        let (Some(level), Some(finer)) = (self.levels.get(next), self.levels.get(next.wrapping_sub(1)))
        else {
            return self.levels[self.levels.len() - 1].fetch(uv);
        };
        // Towards the texture itself, whose σ is 0, linear in σ.
        let t = if finer.sigma > 0.0 { (sigma / finer.sigma).log2() } else { sigma / level.sigma };
        mix(finer.fetch(uv), level.fetch(uv), t as f32)
    }

    /// The levels by growing σ, for whoever fetches elsewhere what [`PrefilteredTexture::fetch`] does here. There are at least
    /// two, and but for the first each σ is twice that before it.
    pub fn levels(&self) -> impl ExactSizeIterator<Item = TextureLevel<'_>> {
        self.levels.iter().map(Level::view)
    }

    /// The largest value of each channel; no fetch is above it.
    pub fn brightest(&self) -> [f32; 3] {
        // Every level is made of means of the first, or of a wider level's.
        self.levels.iter().flat_map(|level| &level.texels).fold([0.0_f32; 3], |most, texel| {
            core::array::from_fn(|channel| most[channel].max(texel[channel]))
        })
    }

    /// Number of levels, the texture itself included.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }
}

/// The image as a source, after all checks.
fn checked(image: TexelGrid<'_>) -> Result<Source, InputError> {
    let TexelGrid { width, height, colours, coverage } = image;
    for (name, size) in [("texture width", width), ("texture height", height)] {
        check_range(name, size as f64, 1.0, 65_536.0)?;
    }
    let count = width * height;
    check_range("number of texels", colours.len() as f64, count as f64, count as f64)?;
    let covered = coverage.map_or(count, <[f32]>::len);
    check_range("number of coverages", covered as f64, count as f64, count as f64)?;
    let mut texels = Vec::with_capacity(count);
    for (i, colour) in colours.iter().enumerate() {
        let c = check_range("coverage", f64::from(coverage.map_or(1.0, |c| c[i])), 0.0, 1.0)?;
        let [r, g, b] = colour.map(f64::from);
        for x in [r, g, b] {
            check_range("texel", x, 0.0, f64::from(f32::MAX))?;
        }
        texels.push([r * c, g * c, b * c, c]);
    }
    if !texels.iter().any(|t| t[3] > 0.0) {
        return Err(InputError::Degenerate { name: "coverage of the texture" });
    }
    Ok(Source { size: [width, height], texels })
}

/// A level without its texels.
fn empty_level(sigma: f64, image: TexelGrid<'_>) -> Level {
    let margin = MARGIN * sigma;
    // No finer than the image itself.
    let steps = [image.width, image.height]
        .map(|size| ((1.0 + 2.0 * margin) * (2.0 / sigma).min(size as f64)).ceil());
    let size = steps.map(|s| s as usize + 1);
    let spacing = steps.map(|s| (1.0 + 2.0 * margin) / s);
    Level { sigma, size, low: [-margin; 2], spacing, texels: Vec::new() }
}

/// The image itself as a level; what is not covered has the colour around it.
fn own_level(image: TexelGrid<'_>, coarser: Option<&Level>) -> Level {
    let TexelGrid { width, height, colours, coverage } = image;
    let spacing = [1.0 / width as f64, 1.0 / height as f64];
    let mut level = Level {
        sigma: 0.0,
        size: [width, height],
        low: spacing.map(|s| 0.5 * s),
        spacing,
        texels: colours.to_vec(),
    };
    if let (Some(coverage), Some(coarser)) = (coverage, coarser) {
        let bare = level.texels.iter_mut().enumerate().filter(|(i, _)| coverage[*i] <= 0.0);
        for (i, texel) in bare {
            let centre = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            *texel = coarser.fetch([centre[0] * spacing[0], centre[1] * spacing[1]]);
        }
    }
    level
}
