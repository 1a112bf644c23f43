//! The lobes of the papers' figures.

use glam::{DMat3, DVec3};
use ltc_core::{Alpha, Ggx};
use ltc_fit::{Brdf as _, DiskPoints, GgxFamily, Lobe, direction};

use crate::disk::Chart;

/// A view and two widths.
#[derive(Clone, Copy)]
pub struct Case {
    /// Degrees.
    pub theta: f64,
    /// Degrees.
    pub phi: f64,
    pub alpha: [f64; 2],
    /// Degrees from the lobe's middle that its disks show; the whole hemisphere if none.
    pub cap: Option<f64>,
}

const fn case(theta: f64, phi: f64, alpha: [f64; 2], cap: Option<f64>) -> Case {
    Case { theta, phi, alpha, cap }
}

/// Figure 5 of the 2016 paper, whose captions are α and θ.
pub const FIGURE_5: [Case; 4] = [
    case(45.0, 0.0, [0.1, 0.1], Some(35.0)),
    case(75.0, 0.0, [0.1, 0.1], Some(35.0)),
    case(45.0, 0.0, [0.3, 0.3], None),
    case(75.0, 0.0, [0.3, 0.3], None),
];

/// Figure 13 of the 2022 paper, whose text gives the kinds alone: lobes near to LTCs first, lunes (high anisotropy, grazing views) last.
pub const FIGURE_13: [Case; 6] = [
    case(20.0, 45.0, [0.6, 0.4], None),
    case(45.0, 0.0, [0.5, 0.2], None),
    case(50.0, 45.0, [0.4, 0.2], None),
    case(65.0, 45.0, [0.5, 0.1], None),
    case(75.0, 60.0, [0.7, 0.1], None),
    case(82.0, 45.0, [0.5, 0.05], None),
];

impl Case {
    pub fn wo(&self) -> DVec3 {
        direction(self.theta.to_radians(), self.phi.to_radians())
    }

    fn widths(&self) -> Result<Alpha, ltc_core::InputError> {
        Alpha::new(self.alpha[0], self.alpha[1])
    }

    /// So many samples of the lobe; those of another `shift` are others.
    pub fn lobe(&self, samples: usize, shift: [f64; 2]) -> Result<Lobe, ltc_core::InputError> {
        let mut lobe = Lobe::default();
        GgxFamily.sample_lobe(self.wo(), self.widths()?, &DiskPoints::new(samples, shift), &mut lobe);
        Ok(lobe)
    }

    /// The lobe's density, given its magnitude.
    pub fn density(&self, magnitude: f64) -> Result<impl Fn(DVec3) -> f64 + use<>, ltc_core::InputError> {
        let (ggx, wo) = (Ggx::<f64>::new(self.widths()?), self.wo());
        Ok(move |w| ggx.eval_cos(wo, w) / magnitude)
    }

    /// What its disks show: the hemisphere, or a cap around the middle of a fit.
    pub fn chart(&self, fit: DMat3) -> Chart {
        match self.cap {
            Some(degrees) => Chart::around(fit.z_axis.try_normalize().unwrap_or(DVec3::Z), degrees),
            None => Chart::hemisphere(),
        }
    }

    /// Its numbers, in two or three short lines.
    pub fn lines(&self) -> Vec<String> {
        let [x, y] = self.alpha;
        let alpha = if x == y { format!("α {x}") } else { format!("α {x}, {y}") };
        let view = format!("θ {}°", self.theta);
        let turn = (x != y).then(|| format!("φ {}°", self.phi));
        [alpha, view].into_iter().chain(turn).collect()
    }

    /// The same in one line.
    pub fn name(&self) -> String {
        self.lines().join(", ")
    }
}
