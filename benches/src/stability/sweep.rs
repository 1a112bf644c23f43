//! One quantity taken through its decades, the others moderate.

use glam::{DMat3, DVec3};
use ltc_core::{Vector as _, points::SplitMix64};

use super::form::Pose;
use super::{Case, Form};

/// A quantity to sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// All lengths times it.
    Scale,
    /// Width of the lobe, α.
    Roughness,
    /// The lobe's elevation above the horizon, in degrees.
    Elevation,
    /// Length to width; for disks and spheres distance to radius.
    Aspect,
    /// Distance of the shading point from the light's plane or surface, in half-lengths of the light, the point's projection
    /// lying on the light or beside it.
    Distance,
    /// Distance from the light, in half-lengths, in any direction.
    Farness,
}

impl Sweep {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Scale, Self::Roughness, Self::Elevation, Self::Aspect, Self::Distance, Self::Farness];

    /// Its name in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scale => "scale",
            Self::Roughness => "roughness α",
            Self::Elevation => "elevation of the lobe, degrees",
            Self::Aspect => "aspect",
            Self::Distance => "distance to the light's plane or surface, half-lengths",
            Self::Farness => "distance, half-lengths",
        }
    }

    /// Its values.
    pub fn values(self) -> Vec<f64> {
        let decades = |low: i32, high: i32| (low..=high).map(|e| 10f64.powi(e)).collect::<Vec<_>>();
        match self {
            Self::Scale => decades(-6, 6),
            Self::Roughness => decades(-4, 0),
            Self::Elevation => vec![0.01, 0.1, 1.0, 10.0, 90.0],
            Self::Aspect => decades(0, 5),
            Self::Distance => decades(-7, 0),
            Self::Farness => decades(0, 3),
        }
    }

    /// A random case at `value`.
    pub fn case(self, value: f64, form: Form, rng: &mut SplitMix64) -> Case {
        let at = |sweep: Self, otherwise: f64| if self == sweep { value } else { otherwise };
        let alpha = at(Self::Roughness, 10f64.powf(rng.range(-1.5, 0.0)));
        let elevation = at(Self::Elevation, rng.range(15.0, 90.0)).to_radians();
        let aspect = at(Self::Aspect, rng.range(1.0, 3.0));
        let azimuth = rng.range(0.0, core::f64::consts::TAU);
        let turn = DMat3::from_rotation_z(azimuth)
            * DMat3::from_rotation_y(core::f64::consts::FRAC_PI_2 - elevation);
        let m = turn * DMat3::from_diagonal(DVec3::new(alpha, alpha * rng.range(0.5, 1.0), 1.0));
        let pose = self.pose(value, aspect, form, turn.z_axis, rng);
        let scale = at(Self::Scale, 1.0);
        let scaled = Pose {
            centre: pose.centre * scale,
            length: pose.length * scale,
            width: pose.width * scale,
            ..pose
        };
        Case::new(m, form.light(&scaled), form == Form::Quad)
    }

    /// A light near the lobe's direction, or with its surface near the shading point.
    fn pose(self, value: f64, aspect: f64, form: Form, lobe: DVec3, rng: &mut SplitMix64) -> Pose {
        let mut r = |low: f64, high: f64| rng.range(low, high);
        let mut random = || DVec3::new(r(-1.0, 1.0), r(-1.0, 1.0), r(-1.0, 1.0));
        let normal = random().try_unit().unwrap_or(DVec3::Z);
        let along = normal.cross(random()).try_unit().unwrap_or(normal.any_orthonormal_vector());
        let side = normal.cross(along);
        let shift = random();
        let small = self == Self::Aspect && matches!(form, Form::Disk | Form::Sphere);
        let (length, width) = if small { (1.0 / aspect, 1.0 / aspect) } else { (1.0, 1.0 / aspect) };
        let mut pose = Pose { centre: DVec3::ZERO, along, normal, length, width };
        pose.centre = match self {
            Self::Distance => {
                let depth = form.thickness(&pose) + value;
                let beside = if form == Form::Sphere { 0.0 } else { 1.5 };
                normal * -depth
                    + along * (beside * shift.x * length)
                    + side * self.sideways(form, shift.y, width)
            }
            Self::Farness => (lobe + shift * 0.3) * (value + 1.0),
            _ => (lobe + shift * 0.5) * 2.5,
        };
        pose
    }

    /// How far beside a light's middle the shading point's projection lies: on round ones, nowhere.
    fn sideways(self, form: Form, shift: f64, width: f64) -> f64 {
        if form.is_solid() { 0.0 } else { 1.5 * shift * width }
    }
}
