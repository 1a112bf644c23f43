//! Charlie, the sheen of Estevez & Kulla 2017.

use std::f64::consts::PI;

use glam::DVec3;

use crate::lobe::{Lobe, hints_from};
use crate::points::cosine_direction;

/// The paper's values of a, b, c, d, e (its table 1): rough (r = 1), then smooth (r = 0).
const FITTED: [(f64, f64); 5] =
    [(21.5473, 25.3245), (3.82987, 3.32435), (0.19823, 0.16801), (-1.97760, -1.27393), (-4.32054, -4.85967)];

/// The cosine-weighted sheen BRDF at colour 1, with the paper's fit of Λ and no softened terminator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharlieLobe {
    /// The paper's roughness r in (0, 1].
    pub roughness: f64,
    /// Unit view direction, above the horizon.
    pub wo: DVec3,
}

impl CharlieLobe {
    /// `D = (2 + 1/r) sin^(1/r) θ / 2π` (eq. 2); `∫ D cos = 1` over the hemisphere.
    pub fn ndf(&self, wh: DVec3) -> f64 {
        if wh.z <= 0.0 {
            return 0.0;
        }
        let inverse = self.roughness.recip();
        (2.0 + inverse) * wh.x.hypot(wh.y).powf(inverse) / (2.0 * PI)
    }

    /// The paper's fit of Λ (eq. 3 and 4).
    pub fn lambda(&self, cos: f64) -> f64 {
        let weight = (1.0 - self.roughness) * (1.0 - self.roughness);
        let [a, b, c, d, e] = FITTED.map(|(rough, smooth)| weight * smooth + (1.0 - weight) * rough);
        let l = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
        // Beyond 60° the curve of log Λ is mirrored at its value there.
        let half = l(0.5);
        if cos < 0.5 { l(cos).exp() } else { (half + half - l(1.0 - cos)).exp() }
    }
}

impl Lobe for CharlieLobe {
    fn density(&self, wi: DVec3) -> f64 {
        if self.wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let Some(wh) = (self.wo + wi).try_normalize() else { return 0.0 };
        let g = 1.0 / (1.0 + self.lambda(self.wo.z) + self.lambda(wi.z.min(1.0)));
        // ρ = D G / (4 cos θo cos θi), times cos θi.
        self.ndf(wh) * g / (4.0 * self.wo.z)
    }

    fn half_spaces(&self) -> Vec<DVec3> {
        vec![DVec3::Z]
    }

    fn hints(&self) -> Vec<DVec3> {
        // Smooth cloth shines along the horizon, most of all back to the eye.
        let mut hints = hints_from(|u| Some(cosine_direction(u)));
        let low = hints_from(|u| {
            let w = cosine_direction(u);
            DVec3::new(w.x, w.y, 0.1 * w.z).try_normalize()
        });
        hints.extend(low);
        hints
    }
}
