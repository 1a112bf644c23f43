//! One level of a prefiltered texture.

/// A colour, linear.
pub(super) type Colour = [f32; 3];

/// Texels at `u = low + i · spacing` (and so for v), i from 0: a function of (u, v) that is bilinear between them and
/// constant beyond.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    /// Standard deviation of the Gaussian, in units of the texture's sides; 0 for the texture itself.
    pub sigma: f64,
    pub size: [usize; 2],
    pub low: [f64; 2],
    pub spacing: [f64; 2],
    pub texels: Vec<Colour>,
}

/// One level of a [`PrefilteredTexture`](super::PrefilteredTexture): texel (i, j) is at `(u, v) = low + (i, j) · spacing`. Its
/// value is bilinear between texels and constant beyond them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureLevel<'a> {
    /// Standard deviation of the Gaussian, in units of the texture's sides; 0 for the texture itself.
    pub sigma: f64,
    /// Texels in a row, and rows.
    pub size: [usize; 2],
    /// Coordinates of the first texel.
    pub low: [f64; 2],
    /// From one texel to the next.
    pub spacing: [f64; 2],
    /// Row by row, linear colours.
    pub texels: &'a [[f32; 3]],
}

impl Level {
    pub fn view(&self) -> TextureLevel<'_> {
        let Self { sigma, size, low, spacing, texels } = self;
        TextureLevel { sigma: *sigma, size: *size, low: *low, spacing: *spacing, texels }
    }

    /// The value at (u, v); NaN is taken as 0.
    pub fn fetch(&self, uv: [f64; 2]) -> Colour {
        let [(i0, i1, s), (j0, j1, t)] = [0, 1].map(|axis| self.locate(axis, uv[axis]));
        let texel = |i: usize, j: usize| self.texels[j * self.size[0] + i];
        let below = mix(texel(i0, j0), texel(i1, j0), s);
        let above = mix(texel(i0, j1), texel(i1, j1), s);
        mix(below, above, t)
    }

    /// The neighbours along an axis, and how far the coordinate is from the first to the second.
    fn locate(&self, axis: usize, coordinate: f64) -> (usize, usize, f32) {
        let last = self.size[axis] - 1;
        let x = ((coordinate - self.low[axis]) / self.spacing[axis]).max(0.0).min(last as f64);
        let i = (x as usize).min(last);
        (i, (i + 1).min(last), (x - i as f64) as f32)
    }

    /// Coordinates of the texels along an axis.
    pub fn nodes(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        (0..self.size[axis]).map(move |i| self.low[axis] + i as f64 * self.spacing[axis])
    }
}

/// `a + (b − a) t`, exact at both ends.
pub(super) fn mix(a: Colour, b: Colour, t: f32) -> Colour {
    core::array::from_fn(|c| a[c] * (1.0 - t) + b[c] * t)
}
