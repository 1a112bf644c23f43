//! Diffuse lobes beyond Lambert's, written in angles as the papers have them.

use std::f64::consts::PI;

use glam::DVec3;

use crate::lobe::Lobe;

/// The diffuse term of Burley 2012 ("Physically-Based Shading at Disney", §5.3) at base colour 1, times `cos θi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisneyDiffuseLobe {
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Unit view direction, above the horizon.
    pub wo: DVec3,
}

impl Lobe for DisneyDiffuseLobe {
    fn density(&self, wi: DVec3) -> f64 {
        if self.wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        // θd is half of the angle between both directions.
        let theta_d = 0.5 * self.wo.dot(wi).clamp(-1.0, 1.0).acos();
        let fd90 = 0.5 + 2.0 * self.roughness * theta_d.cos().powi(2);
        let schlick = |cos: f64| 1.0 * (1.0 - (1.0 - cos).powi(5)) + fd90 * (1.0 - cos).powi(5);
        schlick(wi.z) * schlick(self.wo.z) * wi.z / PI
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }
}

/// The qualitative model of Oren & Nayar 1994 (eq. 30) at facet albedo 1, times `cos θi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayarLobe {
    /// Standard deviation of the facets' tilt, radians.
    pub sigma: f64,
    /// Unit view direction, above the horizon.
    pub wo: DVec3,
}

impl Lobe for OrenNayarLobe {
    fn density(&self, wi: DVec3) -> f64 {
        if self.wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let s2 = self.sigma * self.sigma;
        let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
        let (theta_i, theta_r) = (wi.z.min(1.0).acos(), self.wo.z.min(1.0).acos());
        let cos_turn = (wi.y.atan2(wi.x) - self.wo.y.atan2(self.wo.x)).cos();
        let (alpha, beta) = (theta_i.max(theta_r), theta_i.min(theta_r));
        (a + b * cos_turn.max(0.0) * alpha.sin() * beta.tan()) * theta_i.cos() / PI
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }

    fn kinks(&self) -> Vec<DVec3> {
        // cos(φi − φr) = 0.
        let across = DVec3::new(self.wo.x, self.wo.y, 0.0).try_normalize();
        across.into_iter().chain([DVec3::Z]).collect()
    }
}
