//! Random lobes and lights.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Horizon, Ltc};
use ltc_reference::{AboveHorizon, Lobe, LtcLobe};

/// A seeded source of random configurations.
pub struct Draw(SplitMix64);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    pub fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0.range(low, high)
    }

    pub fn log_range(&mut self, low: f64, high: f64) -> f64 {
        self.0.range(low.ln(), high.ln()).exp()
    }

    pub fn direction(&mut self) -> DVec3 {
        let (z, phi) = (self.range(-1.0, 1.0), self.range(0.0, TAU));
        let r = (1.0 - z * z).max(0.0).sqrt();
        dvec3(r * phi.cos(), r * phi.sin(), z)
    }

    pub fn rotation(&mut self) -> DMat3 {
        let z = self.direction();
        let (x, y) = z.any_orthonormal_pair();
        let (sin, cos) = self.range(0.0, TAU).sin_cos();
        DMat3::from_cols(x * cos + y * sin, y * cos - x * sin, z)
    }

    /// A matrix of exactly this condition number, its middle singular value anywhere.
    pub fn matrix(&mut self, condition: f64) -> DMat3 {
        let middle = self.log_range(1.0 / condition, 1.0);
        let stretch = DMat3::from_diagonal(dvec3(1.0, middle, 1.0 / condition));
        self.rotation() * stretch * self.rotation()
    }

    /// A matrix as tables hold them: a lobe around a direction above the horizon, narrow by the condition number.
    pub fn lobe_matrix(&mut self, condition: f64) -> DMat3 {
        let mut z = self.direction();
        z.z = z.z.abs();
        let (x, y) = z.any_orthonormal_pair();
        let widths = dvec3(1.0 / condition, self.log_range(1.0 / condition, 1.0), 1.0);
        DMat3::from_cols(x, y, z)
            * DMat3::from_diagonal(widths)
            * DMat3::from_rotation_z(self.range(0.0, TAU))
    }

    /// The ends of a segment of a length in [0.01, 100] about 1 away, anywhere around the shading point.
    pub fn ends(&mut self) -> [DVec3; 2] {
        let centre = self.direction() * self.log_range(0.1, 10.0);
        let half = self.direction() * (0.5 * self.log_range(0.01, 100.0));
        [centre - half, centre + half]
    }

    /// The same with its middle in a direction drawn from the lobe.
    pub fn aimed_ends(&mut self, matrix: DMat3) -> [DVec3; 2] {
        let [a, b] = self.ends();
        let (centre, half) = ((a + b) * 0.5, (b - a) * 0.5);
        let aimed = self.aim(matrix) * centre.length();
        [aimed - half, aimed + half]
    }

    /// A direction drawn from the lobe.
    pub fn aim(&mut self, matrix: DMat3) -> DVec3 {
        let u = [self.unit(), self.unit()];
        ltc(matrix).sample(u)
    }

    /// A unit vector at right angles to an axis.
    pub fn across(&mut self, axis: DVec3) -> DVec3 {
        loop {
            let unit = axis.normalize_or(DVec3::Z).cross(self.direction());
            if unit.length() > 0.1 {
                return unit.normalize_or(DVec3::X);
            }
        }
    }
}

pub fn ltc(matrix: DMat3) -> Ltc<f64> {
    Ltc::new(matrix).expect("rotations and positive stretches are invertible")
}

/// The oracle's lobe for a matrix and the horizons that cut the light.
pub struct Cut {
    lobe: LtcLobe,
    horizon: Horizon,
}

impl Cut {
    pub fn new(matrix: DMat3, horizon: Horizon) -> Self {
        Self { lobe: LtcLobe::new(matrix).expect("invertible"), horizon }
    }
}

impl Lobe for Cut {
    fn density(&self, wi: DVec3) -> f64 {
        if self.horizon.surface && wi.z <= 0.0 {
            return 0.0;
        }
        // Below its own horizon the lobe goes on with the opposite sign where nothing cuts it.
        let below = self.lobe.cosine_from_target().row(2).dot(wi) < 0.0;
        if below && !self.horizon.cosine { -self.lobe.density(-wi) } else { self.lobe.density(wi) }
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        match (self.horizon.surface, self.horizon.cosine) {
            (true, true) => AboveHorizon(self.lobe).half_spaces(),
            (true, false) => vec![DVec3::Z],
            (false, true) => self.lobe.half_spaces(),
            (false, false) => Vec::new(),
        }
    }

    fn hints(&self) -> Vec<DVec3> {
        self.lobe.hints()
    }
}

pub const HORIZONS: [Horizon; 4] = [Horizon::BOTH, Horizon::SURFACE, Horizon::COSINE, Horizon::NONE];
