//! Points of the unit disk from which lobes are sampled.

use ltc_core::points::r2;

/// Low-discrepancy points of the unit disk, with what every lobe needs of them.
#[derive(Clone, Debug)]
pub struct DiskPoints {
    /// The points in the unit square that they come from.
    pub square: Vec<[f64; 2]>,
    /// `√u₀ cos 2πu₁`
    pub x: Vec<f64>,
    /// `√u₀ sin 2πu₁`
    pub y: Vec<f64>,
    /// `√(1 − x²)`
    pub half_chord: Vec<f64>,
}

impl DiskPoints {
    /// `n` points of the R2 sequence, started at `shift`.
    pub fn new(n: usize, shift: [f64; 2]) -> Self {
        let square: Vec<[f64; 2]> = (0..n).map(|i| r2(i, shift)).collect();
        let disk = |u: &[f64; 2]| {
            let (sin, cos) = (core::f64::consts::TAU * u[1]).sin_cos();
            (u[0].sqrt() * cos, u[0].sqrt() * sin)
        };
        let (x, y): (Vec<f64>, Vec<f64>) = square.iter().map(disk).unzip();
        let half_chord = x.iter().map(|x| (1.0 - x * x).max(0.0).sqrt()).collect();
        Self { square, x, y, half_chord }
    }

    /// How many points.
    pub fn len(&self) -> usize {
        self.square.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.square.is_empty()
    }
}
