//! Random lobes and lights, and the oracle's value for each light.

use core::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, dvec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Cylinder, Disk, Ellipse, Horizon, Light, Ltc, Sides, Sphere};
use ltc_reference::{
    CylinderShape, Lobe, LtcLobe, PolygonOptions, ReferenceError, Tolerance, integrate_cylinder,
    integrate_ellipse, integrate_sphere_light,
};

/// All four settings of the horizons.
pub const HORIZONS: [Horizon; 4] = [Horizon::BOTH, Horizon::COSINE, Horizon::SURFACE, Horizon::NONE];

/// Random numbers with the shapes that the tests need.
pub struct Random(SplitMix64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    pub fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0.range(low, high)
    }

    /// Uniform in the logarithm.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.unit()).exp()
    }

    pub fn direction(&mut self) -> DVec3 {
        let (z, phi) = (self.range(-1.0, 1.0), self.range(0.0, TAU));
        let r = (1.0 - z * z).sqrt();
        dvec3(r * phi.cos(), r * phi.sin(), z)
    }

    /// Columns are right-handed and orthonormal.
    pub fn rotation(&mut self) -> DMat3 {
        let z = self.direction();
        let (x, y) = z.any_orthonormal_pair();
        DMat3::from_cols(x, y, z) * DMat3::from_rotation_z(self.range(0.0, TAU))
    }

    /// A lobe of any orientation, its condition number up to `condition`.
    pub fn matrix(&mut self, condition: f64) -> DMat3 {
        let low = 1.0 / condition;
        let stretch = dvec3(self.decades(low, 1.0), self.decades(low, 1.0), self.decades(low, 1.0));
        self.rotation() * DMat3::from_diagonal(stretch) * self.rotation()
    }

    /// A lobe like GGX's: widths from `alpha_min`, towards any direction up to 89.99° from the normal.
    pub fn ggx_like(&mut self, alpha_min: f64) -> DMat3 {
        let grazing = 89.99_f64.to_radians();
        let theta = if self.unit() < 0.3 { grazing } else { self.range(0.0, grazing) };
        let widths = dvec3(self.decades(alpha_min, 1.0), self.decades(alpha_min, 1.0), 1.0);
        DMat3::from_rotation_z(self.range(0.0, TAU))
            * DMat3::from_rotation_y(theta)
            * DMat3::from_diagonal(widths)
            * DMat3::from_rotation_z(self.range(0.0, TAU))
    }
}

/// Condition number (of the Frobenius norm).
pub fn condition(m: DMat3) -> f64 {
    let norm = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    norm(m) * norm(m.inverse())
}

/// A light in f64, from which the one in f32 is made.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Disk { centre: DVec3, normal: DVec3, radius: f64 },
    Ellipse { centre: DVec3, u: DVec3, v: DVec3 },
    Sphere { centre: DVec3, radius: f64 },
    Cylinder { ends: [DVec3; 2], radius: f64, caps: bool },
}

impl Shape {
    /// The integral in f64.
    pub fn exact(&self, m: DMat3, horizon: Horizon) -> f64 {
        let ltc = Ltc::<f64>::new(m).unwrap();
        match *self {
            Self::Disk { centre, normal, radius } => {
                Disk::<f64>::new(centre, normal, radius, Sides::Two).unwrap().integrate_within(&ltc, horizon)
            }
            Self::Ellipse { centre, u, v } => {
                Ellipse::<f64>::new(centre, u, v, Sides::Two).unwrap().integrate_within(&ltc, horizon)
            }
            Self::Sphere { centre, radius } => {
                Sphere::<f64>::new(centre, radius).unwrap().integrate_within(&ltc, horizon)
            }
            Self::Cylinder { ends, radius, caps } => {
                Cylinder::<f64>::new(ends[0], ends[1], radius, caps).unwrap().integrate_within(&ltc, horizon)
            }
        }
    }

    /// The integral in f32, of everything rounded to f32.
    pub fn single(&self, m: DMat3, horizon: Horizon) -> f64 {
        let ltc = Ltc::<f32>::new(m.as_mat3()).unwrap();
        f64::from(match *self {
            Self::Disk { centre, normal, radius } => {
                Disk::<f32>::new(centre.as_vec3(), normal.as_vec3(), radius as f32, Sides::Two)
                    .unwrap()
                    .integrate_within(&ltc, horizon)
            }
            Self::Ellipse { centre, u, v } => {
                Ellipse::<f32>::new(centre.as_vec3(), u.as_vec3(), v.as_vec3(), Sides::Two)
                    .unwrap()
                    .integrate_within(&ltc, horizon)
            }
            Self::Sphere { centre, radius } => {
                Sphere::<f32>::new(centre.as_vec3(), radius as f32).unwrap().integrate_within(&ltc, horizon)
            }
            Self::Cylinder { ends, radius, caps } => {
                Cylinder::<f32>::new(ends[0].as_vec3(), ends[1].as_vec3(), radius as f32, caps)
                    .unwrap()
                    .integrate_within(&ltc, horizon)
            }
        })
    }

    /// The light with its numbers rounded to f32: what a comparison of f32 and f64 leaves out is what rounding the input does.
    pub fn rounded(&self) -> Self {
        let r = |v: DVec3| v.as_vec3().as_dvec3();
        let f = |x: f64| f64::from(x as f32);
        match *self {
            Self::Disk { centre, normal, radius } => {
                Self::Disk { centre: r(centre), normal: r(normal), radius: f(radius) }
            }
            Self::Ellipse { centre, u, v } => Self::Ellipse { centre: r(centre), u: r(u), v: r(v) },
            Self::Sphere { centre, radius } => Self::Sphere { centre: r(centre), radius: f(radius) },
            Self::Cylinder { ends, radius, caps } => {
                Self::Cylinder { ends: ends.map(r), radius: f(radius), caps }
            }
        }
    }

    /// The oracle's value, clamped as the library's are; `None` where it does not converge.
    pub fn reference(&self, lobe: &impl Lobe, tolerance: f64) -> Option<f64> {
        let tolerance = Tolerance { max_evaluations: 2_000_000, ..Tolerance::absolute(tolerance) };
        let flat = PolygonOptions { two_sided: true, tolerance };
        let estimate = match *self {
            Self::Disk { centre, normal, radius } => {
                let (u, v) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
                integrate_ellipse(lobe, centre, u * radius, v * radius, flat)
            }
            Self::Ellipse { centre, u, v } => integrate_ellipse(lobe, centre, u, v, flat),
            Self::Sphere { centre, radius } => integrate_sphere_light(lobe, centre, radius, tolerance),
            Self::Cylinder { ends, radius, caps } => {
                integrate_cylinder(lobe, CylinderShape { ends, radius, caps }, tolerance)
            }
        };
        match estimate {
            Ok(estimate) => Some(estimate.value.clamp(0.0, 1.0)),
            Err(ReferenceError::NotConverged { .. }) => None,
            Err(error) => panic!("{self:?}: {error}"),
        }
    }
}

/// The oracle's lobe: an LTC cut by the horizons asked for, its cosine signed without the cosine's one.
pub struct OracleLobe {
    cosine_from_target: DMat3,
    inverse_determinant: f64,
    half_spaces: Vec<DVec3>,
    hints: Vec<DVec3>,
}

impl OracleLobe {
    pub fn new(m: DMat3, horizon: Horizon) -> Self {
        let lobe = LtcLobe::new(m).unwrap();
        let cosine_from_target = lobe.cosine_from_target();
        let mut half_spaces = Vec::new();
        if horizon.surface {
            half_spaces.push(DVec3::Z);
        }
        if horizon.cosine {
            half_spaces.push(cosine_from_target.row(2));
        }
        let inverse_determinant = cosine_from_target.determinant();
        Self { cosine_from_target, inverse_determinant, half_spaces, hints: lobe.hints() }
    }
}

impl Lobe for OracleLobe {
    fn density(&self, wi: DVec3) -> f64 {
        if self.half_spaces.iter().any(|n| n.dot(wi) < 0.0) {
            return 0.0;
        }
        let w = self.cosine_from_target * wi;
        w.z / PI * self.inverse_determinant / w.length_squared().powi(2)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        self.half_spaces.clone()
    }

    fn hints(&self) -> Vec<DVec3> {
        self.hints.clone()
    }
}

/// A random light of this kind (0 to 3) seen by the lobe of `m`, `distance` from the shading point, of size 1.
pub fn shape(random: &mut Random, kind: usize, m: DMat3, distance: f64) -> Shape {
    let sample = Ltc::<f64>::new(m).unwrap().sample([random.unit(), random.unit()]);
    // Towards the lobe more often than anywhere.
    let towards = if random.unit() < 0.7 { sample + 0.3 * random.direction() } else { random.direction() };
    let centre = towards.normalize_or(DVec3::Z) * distance;
    match kind {
        0 => Shape::Disk { centre, normal: random.direction(), radius: 1.0 },
        1 => {
            let aspect = random.decades(1e-3, 1.0);
            Shape::Ellipse { centre, u: random.direction(), v: random.direction() * aspect }
        }
        2 => Shape::Sphere { centre, radius: 1.0 },
        _ => {
            let along = random.direction() * random.decades(0.1, 100.0);
            let start = centre - along * random.range(-0.5, 1.5);
            Shape::Cylinder { ends: [start, start + along], radius: 1.0, caps: random.unit() < 0.5 }
        }
    }
}
