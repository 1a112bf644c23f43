//! The Gaussian that stays inside the texture.

use super::level::{Colour, Level};

/// A texture with coverage, in f64: what the levels are filtered from.
pub(super) struct Source {
    pub size: [usize; 2],
    /// Colour times coverage, and coverage.
    pub texels: Vec<[f64; 4]>,
}

impl Source {
    /// The source with pairs of texels along `axis` averaged; an odd last texel stays alone with its own weight.
    fn halved(&self, axis: usize) -> Self {
        let mut size = self.size;
        size[axis] = size[axis].div_ceil(2);
        let mut texels = vec![[0.0; 4]; size[0] * size[1]];
        for j in 0..self.size[1] {
            for i in 0..self.size[0] {
                let (a, b) = if axis == 0 { (i / 2, j) } else { (i, j / 2) };
                let target = &mut texels[b * size[0] + a];
                let value = self.texels[j * self.size[0] + i];
                (0..4).for_each(|c| target[c] += value[c]);
            }
        }
        Self { size, texels }
    }

    /// The coarsest of the halvings whose texels are no wider than a quarter of `sigma`, where the sum over them is as good
    /// as the integral. Only even sizes are halved, so that all texels stay equally wide.
    pub fn reduced(&self, sigma: f64) -> Self {
        let mut source = Self { size: self.size, texels: self.texels.clone() };
        for axis in [0, 1] {
            while source.size[axis].is_multiple_of(2) && 8.0 <= sigma * source.size[axis] as f64 {
                source = source.halved(axis);
            }
        }
        source
    }

    /// Mean colour of what is covered.
    pub fn mean(&self) -> Colour {
        let mut sum = [0.0; 4];
        for texel in &self.texels {
            (0..4).for_each(|c| sum[c] += texel[c]);
        }
        normalised(sum).unwrap_or([0.0; 3])
    }
}

/// Reach of the Gaussian's sum beyond the nearest texel, in standard deviations.
const REACH: f64 = 5.0;

/// The weights of one line of texels as seen from a node: those from `first` on.
struct Taps {
    first: usize,
    weights: Vec<f64>,
}

impl Taps {
    /// `exp(−(x² − nearest²)/2σ²)`: relative to the nearest texel, so that a node in the margin has weights at all. The factor
    /// is the same for a whole line of nodes and cancels in the division by the coverage.
    fn new(node: f64, size: usize, sigma: f64) -> Self {
        let centre = |i: usize| (i as f64 + 0.5) / size as f64;
        let nearest = ((node * size as f64) as usize).min(size - 1);
        let distance = (centre(nearest) - node).abs();
        let reach = distance + REACH * sigma;
        let first = (((node - reach) * size as f64).floor().max(0.0) as usize).min(nearest);
        let last = (((node + reach) * size as f64).ceil().max(0.0) as usize).clamp(nearest, size - 1);
        let weight = |i: usize| {
            let x = centre(i) - node;
            (-(x * x - distance * distance) / (2.0 * sigma * sigma)).exp()
        };
        Self { first, weights: (first..=last).map(weight).collect() }
    }

    fn apply(&self, texel: impl Fn(usize) -> [f64; 4]) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for (k, weight) in self.weights.iter().enumerate() {
            let value = texel(self.first + k);
            (0..4).for_each(|c| sum[c] += weight * value[c]);
        }
        sum
    }

    /// The same for all columns of `rows` at once, row by row as they lie in memory.
    fn apply_to_rows(&self, rows: &[TextureRow]) -> TextureRow {
        let mut sums = vec![[0.0; 4]; rows[self.first].len()];
        for (k, weight) in self.weights.iter().enumerate() {
            for (sum, value) in sums.iter_mut().zip(&rows[self.first + k]) {
                (0..4).for_each(|c| sum[c] += weight * value[c]);
            }
        }
        sums
    }
}

/// Colours times coverage, and coverage, of a row of texels.
pub type TextureRow = Vec<[f64; 4]>;

/// Computes rows 0 to n − 1, in whatever order and on whatever threads, and gives them in order.
pub type TextureRows<'a> = &'a dyn Fn(usize, &(dyn Fn(usize) -> TextureRow + Sync)) -> Vec<TextureRow>;

/// Fills `level` with `∫ G L c / ∫ G c` over the texture: G the Gaussian of the level's σ around the texel, L the colour, c
/// the coverage. `coarser` answers where no covered texel is in reach.
pub(super) fn fill(
    level: &mut Level,
    source: &Source,
    coarser: impl Fn([f64; 2]) -> Colour,
    rows: TextureRows<'_>,
) {
    let [across, down] =
        [0, 1].map(|axis| level.nodes(axis).map(|x| Taps::new(x, source.size[axis], level.sigma)).collect());
    let (across, down): (Vec<Taps>, Vec<Taps>) = (across, down);
    // Along u first, for every row of the source; then along v.
    let filtered = rows(source.size[1], &|j| {
        across.iter().map(|taps| taps.apply(|i| source.texels[j * source.size[0] + i])).collect()
    });
    let sums = rows(level.size[1], &|j| down[j].apply_to_rows(&filtered));
    let u: Vec<f64> = level.nodes(0).collect();
    let colours = level.nodes(1).zip(&sums).flat_map(|(v, row)| {
        let coarser = &coarser;
        row.iter().zip(&u).map(move |(sum, u)| normalised(*sum).unwrap_or_else(|| coarser([*u, v])))
    });
    level.texels = colours.collect();
}

/// Colour over coverage; `None` where nothing is covered.
fn normalised([r, g, b, coverage]: [f64; 4]) -> Option<Colour> {
    (coverage > 1e-9).then(|| [r, g, b].map(|x| (x / coverage) as f32))
}
