//! Lobes and matrices that the tests of the objectives share.

use glam::DMat3;
use ltc_core::{Alpha, Ltc, points::r2};

use crate::{Brdf, DiskPoints, GgxFamily, Lobe};

/// GGX of widths 0.5 and 0.2 from (0.8, 0.6).
pub fn lobe(n: usize) -> Lobe {
    ggx(0.8, 0.6, 0.5, 0.2, n)
}

/// GGX.
pub fn ggx(theta: f64, phi: f64, alpha_x: f64, alpha_y: f64, n: usize) -> Lobe {
    let mut lobe = Lobe::default();
    let alpha = Alpha::new(alpha_x, alpha_y).unwrap();
    GgxFamily.sample_lobe(crate::direction(theta, phi), alpha, &DiskPoints::new(n, [0.5, 0.5]), &mut lobe);
    lobe
}

/// Samples of a known LTC; `n` a multiple of the kernel's lanes.
pub fn lobe_of(m: DMat3, n: usize) -> Lobe {
    let ltc = Ltc::<f64>::new(m).unwrap();
    let mut lobe = Lobe::default();
    for i in 0..n {
        let w = ltc.sample(r2(i, [0.5, 0.5]));
        lobe.x.push(w.x);
        lobe.y.push(w.y);
        lobe.z.push(w.z);
        lobe.weight.push(1.0 / n as f64);
        lobe.inverse.push(1.0 / (n as f64 * ltc.density(w)));
    }
    lobe
}

/// Near [`lobe`], and not on any plane of symmetry.
pub fn matrix() -> DMat3 {
    DMat3::from_cols_array(&[0.4, 0.05, 0.1, -0.02, 0.2, 0.1, -0.6, -0.4, 0.7])
}

/// Turned about an axis that is none of the frame's.
pub fn rotated(m: DMat3, angle: f64) -> DMat3 {
    DMat3::from_axis_angle(glam::DVec3::new(0.6, -0.48, 0.64), angle) * m
}
