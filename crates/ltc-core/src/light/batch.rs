//! Many quads at once, in vectors of `f32`.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

use super::angle::Lanes;
use super::convex::{Limits, Lobe, View, integrate, reach};
use super::lane::{Lane as _, Triple, times};
use super::simd::Wide;
use super::{Horizon, Light as _, Quad, Sides};
use crate::{InputError, Ltc};

/// Arrays are filled up to a multiple of this: the widest vector there is.
const PADDING: usize = 16;

/// Where vectors of `f32` keep their digits; coordinates are scaled to a largest one in [1, 2).
const LIMITS: Limits = Limits { plane: 1e-6, width: 1e-8, range: [0.5, 4.0], nearest: 0.03, sine: 0.06 };
/// Largest entry of `M⁻¹`, where that of `M` is 1.
const STEEPEST: f32 = 1e5;

/// `N` numbers of each of many things, each number in an array of its own.
#[derive(Clone, Debug)]
struct Columns<const N: usize> {
    columns: [Vec<f32>; N],
    len: usize,
}

impl<const N: usize> Columns<N> {
    fn new() -> Self {
        Self { columns: [const { Vec::new() }; N], len: 0 }
    }

    fn push(&mut self, numbers: [f32; N]) {
        for (column, number) in self.columns.iter_mut().zip(numbers) {
            if self.len == column.len() {
                column.resize(self.len + PADDING, 0.0);
            }
            column[self.len] = number;
        }
        self.len += 1;
    }

    fn get(&self, i: usize) -> [f32; N] {
        core::array::from_fn(|k| self.columns[k][i])
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, k: usize, start: usize) -> Wide<S, S::f32s> {
        Wide::of(S::f32s::from_slice(simd, &self.columns[k][start..start + S::f32s::LEN]))
    }

    #[inline(always)]
    fn triple<S: Simd>(&self, simd: S, k: usize, start: usize) -> Triple<Wide<S, S::f32s>> {
        [self.load(simd, k, start), self.load(simd, k + 1, start), self.load(simd, k + 2, start)]
    }
}

/// LTCs for a [`QuadBatch`], one per quad.
///
/// See [`QuadBatch`] for an example.
#[derive(Clone, Debug)]
pub struct LtcBatch {
    /// Columns of `M⁻¹`, and 0 for an LTC that is too narrow for vectors of `f32`.
    inverses: Columns<9>,
    ltcs: Vec<Ltc<f32>>,
}

impl LtcBatch {
    /// None yet.
    pub fn new() -> Self {
        Self { inverses: Columns::new(), ltcs: Vec::new() }
    }

    /// Appends one.
    pub fn push(&mut self, ltc: Ltc<f32>) {
        self.inverses.push(inverse(&ltc).unwrap_or([0.0; 9]));
        self.ltcs.push(ltc);
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ltcs.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ltcs.is_empty()
    }
}

impl Default for LtcBatch {
    fn default() -> Self {
        Self::new()
    }
}

impl Extend<Ltc<f32>> for LtcBatch {
    fn extend<T: IntoIterator<Item = Ltc<f32>>>(&mut self, ltcs: T) {
        ltcs.into_iter().for_each(|ltc| self.push(ltc));
    }
}

/// Columns of `M⁻¹`, unless it is too steep.
fn inverse(ltc: &Ltc<f32>) -> Option<[f32; 9]> {
    let columns = ltc.cosine_from_target().to_cols_array();
    columns.iter().all(|x| x.abs() <= STEEPEST).then_some(columns)
}

/// Many quads, each in the shading frame of its own shading point, integrated several at a time.
///
/// For bakers and software renderers: many lights over the LTC of one shading point ([`QuadBatch::integrate`]), or one
/// light seen from many points, each with its LTC ([`QuadBatch::integrate_each`]).
///
/// Computed in vectors of `f32`, with the instructions that the processor is found to have (AVX-512, AVX2 with FMA, SSE2,
/// NEON, WebAssembly's; single numbers elsewhere). Within 2e-5, times cond(M)/100 where that is above 1, of the `f64`
/// value of the same light. Lights for which `f32` is too short (within 1e-3 of their plane, not convex, narrower than
/// 1e-4 of their distance, with an edge of more than 176° or a corner 30 times nearer than another, a lobe narrower than
/// 1e-5) take the way of [`Quad`] one by one.
///
/// ```
/// use glam::Vec3;
/// use ltc_core::{Horizon, Light, Ltc, Quad, QuadBatch, Sides};
///
/// let quad = |x: f32| {
///     let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
///     Quad::<f32>::new(corners.map(|(u, v)| Vec3::new(x + u, v, 2.0)), Sides::One)
/// };
/// let mut lights = QuadBatch::new();
/// for i in 0..100 {
///     lights.push(quad(i as f32 * 0.1)?);
/// }
/// let mut fractions = [0.0; 100];
/// lights.integrate(&Ltc::cosine(), Horizon::BOTH, &mut fractions)?;
/// assert!((fractions[30] - quad(3.0)?.irradiance()).abs() < 2e-5);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuadBatch {
    vertices: Columns<12>,
    sides: Vec<Sides>,
}

impl QuadBatch {
    /// None yet.
    pub fn new() -> Self {
        Self { vertices: Columns::new(), sides: Vec::new() }
    }

    /// Appends one.
    pub fn push(&mut self, quad: Quad<f32>) {
        let [a, b, c, d] = *quad.vertices();
        self.vertices.push([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z]);
        self.sides.push(quad.sides());
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.sides.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty()
    }

    /// The quad at `index`.
    pub fn get(&self, index: usize) -> Option<Quad<f32>> {
        let sides = *self.sides.get(index)?;
        let v = self.vertices.get(index);
        let corner = |i: usize| glam::Vec3::new(v[i], v[i + 1], v[i + 2]);
        Quad::new([corner(0), corner(3), corner(6), corner(9)], sides).ok()
    }

    /// The fraction of `ltc` that sees each quad, into `out`.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] unless `out` has a place for each quad and no more.
    pub fn integrate(&self, ltc: &Ltc<f32>, horizon: Horizon, out: &mut [f32]) -> Result<(), InputError> {
        self.run(Level::new(), Lobes::One(ltc), horizon, out)
    }

    /// The fraction of each of `ltcs` that sees the quad of the same index, into `out`.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] unless there are as many `ltcs` as quads, and `out` has a place for each.
    pub fn integrate_each(
        &self,
        ltcs: &LtcBatch,
        horizon: Horizon,
        out: &mut [f32],
    ) -> Result<(), InputError> {
        self.check_length("number of LTCs", ltcs.len())?;
        self.run(Level::new(), Lobes::Each(ltcs), horizon, out)
    }

    fn run(&self, level: Level, lobes: Lobes, horizon: Horizon, out: &mut [f32]) -> Result<(), InputError> {
        self.check_length("length of out", out.len())?;
        // Without the cut, or with one narrow lobe, nothing suits vectors.
        let inverse = if let Lobes::One(ltc) = lobes { inverse(ltc) } else { Some([0.0; 9]) };
        let Some(inverse) = inverse.filter(|_| horizon.cosine) else {
            (0..out.len()).for_each(|i| out[i] = self.single(i, lobes, horizon));
            return Ok(());
        };
        dispatch!(level, simd => self.sweep(simd, lobes, &inverse, horizon, out));
        Ok(())
    }

    fn check_length(&self, name: &'static str, length: usize) -> Result<(), InputError> {
        let (value, expected) = (length as f64, self.len() as f64);
        if length == self.len() {
            Ok(())
        } else {
            Err(InputError::OutOfRange { name, value, min: expected, max: expected })
        }
    }

    /// Quad `i` alone.
    #[cold]
    fn single(&self, i: usize, lobes: Lobes, horizon: Horizon) -> f32 {
        let ltc = match lobes {
            Lobes::One(ltc) => ltc,
            Lobes::Each(ltcs) => &ltcs.ltcs[i],
        };
        self.get(i).map_or(0.0, |quad| quad.integrate_within(ltc, horizon))
    }

    #[inline(always)]
    fn sweep<S: Simd>(&self, simd: S, lobes: Lobes, inverse: &[f32; 9], horizon: Horizon, out: &mut [f32]) {
        let mut lobe = Lobe::new([splat(simd, inverse, 0), splat(simd, inverse, 3), splat(simd, inverse, 6)]);
        let mut start = 0;
        while start < out.len() {
            if let Lobes::Each(ltcs) = lobes {
                let from = &ltcs.inverses;
                lobe = Lobe::new([
                    from.triple(simd, 0, start),
                    from.triple(simd, 3, start),
                    from.triple(simd, 6, start),
                ]);
            }
            let vertices = self.scaled(simd, start);
            let view = View::new(&vertices, &LIMITS);
            let (fraction, hard) = integrate::<_, Lanes>(&vertices, &view, &lobe, horizon.surface, &LIMITS);
            // A lobe that is missing is hard, too.
            let missing =
                lobe.columns[2][2].abs().max(lobe.columns[2][0].abs()).max(lobe.columns[2][1].abs());
            let hard = hard | missing.less(missing.lit(1e-30));
            let zero = fraction.lit(0.0);
            let front = zero.less(view.facing).to_bitmask();
            let hard = hard.to_bitmask();
            let end = out.len().min(start + S::f32s::LEN);
            for (lane, i) in (start..end).enumerate() {
                out[i] = if (hard >> lane) & 1 == 1 {
                    self.single(i, lobes, horizon)
                } else if (front >> lane) & 1 == 1 || self.sides[i] == Sides::Two {
                    fraction.0[lane]
                } else {
                    0.0
                };
            }
            start += S::f32s::LEN;
        }
    }

    /// The quads from `start`, each scaled by a power of two to a largest coordinate in [1, 2).
    #[inline(always)]
    fn scaled<S: Simd>(&self, simd: S, start: usize) -> [Triple<Wide<S, S::f32s>>; 4] {
        let v = &self.vertices;
        let [p, q, r, s] = [
            v.triple(simd, 0, start),
            v.triple(simd, 3, start),
            v.triple(simd, 6, start),
            v.triple(simd, 9, start),
        ];
        let farthest = reach(p).max(reach(q)).max(reach(r).max(reach(s)));
        // Exponents alone: 2^127 / 2^e.
        let exponent = farthest.0.to_bits() & 0x7f80_0000;
        let scale = Wide::of(S::f32s::from_bits(
            <S::f32s as SimdFloat<S>>::Bits::splat(simd, 0x7f00_0000) - exponent,
        ));
        [times(p, scale), times(q, scale), times(r, scale), times(s, scale)]
    }
}

impl Default for QuadBatch {
    fn default() -> Self {
        Self::new()
    }
}

impl Extend<Quad<f32>> for QuadBatch {
    fn extend<T: IntoIterator<Item = Quad<f32>>>(&mut self, quads: T) {
        quads.into_iter().for_each(|quad| self.push(quad));
    }
}

/// One LTC for all quads, or one for each.
#[derive(Clone, Copy)]
enum Lobes<'a> {
    One(&'a Ltc<f32>),
    Each(&'a LtcBatch),
}

#[inline(always)]
fn splat<S: Simd>(simd: S, numbers: &[f32; 9], k: usize) -> Triple<Wide<S, S::f32s>> {
    [
        Wide::of(S::f32s::splat(simd, numbers[k])),
        Wide::of(S::f32s::splat(simd, numbers[k + 1])),
        Wide::of(S::f32s::splat(simd, numbers[k + 2])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::random;
    use glam::{Mat3, Vec3};

    fn levels() -> Vec<Level> {
        let best = Level::new();
        let mut levels = vec![best, Level::baseline()];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            levels.extend(best.as_avx2().map(Simd::level));
            levels.extend(best.as_sse4_2().map(Simd::level));
        }
        levels
    }

    /// Every level of instructions that this machine has, one number at a time included where nothing else is.
    #[test]
    fn all_levels_agree() {
        let mut rng = random(31);
        let mut r = || (rng() * 2.0 - 1.0) as f32;
        let (mut quads, mut ltcs) = (QuadBatch::new(), LtcBatch::new());
        while quads.len() < 3001 {
            let Ok(ltc) = Ltc::new(Mat3::from_cols_array(&[0.0; 9].map(|_: f32| r()))) else { continue };
            let (c, u, v) =
                (Vec3::new(r(), r(), r()) * 2.0, Vec3::new(r(), r(), r()), Vec3::new(r(), r(), r()));
            let Ok(quad) = Quad::new([c - u - v, c + u - v, c + u + v, c - u + v], Sides::Two) else {
                continue;
            };
            quads.push(quad);
            ltcs.push(ltc);
        }
        let run = |level| {
            let mut out = vec![f32::NAN; quads.len()];
            quads.run(level, Lobes::Each(&ltcs), Horizon::BOTH, &mut out).map(|()| out)
        };
        let singles: Vec<f32> =
            (0..quads.len()).map(|i| quads.single(i, Lobes::Each(&ltcs), Horizon::BOTH)).collect();
        for level in levels() {
            let out = run(level).unwrap();
            for (i, (a, b)) in out.iter().zip(&singles).enumerate() {
                let inverse = ltcs.inverses.get(i).into_iter().fold(0.0_f32, |m, x| m.max(x.abs()));
                let tolerance = 2e-5 * (inverse / 33.0).max(1.0);
                assert!((a - b).abs() < tolerance, "{level:?}: {i}: {a} {b}");
            }
        }
    }
}
