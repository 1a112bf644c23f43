//! The two spaces of a lobe.

use glam::DMat3;

use super::wide::widened;
use crate::{Ltc, Matrix, Real};

/// M and M⁻¹ of a lobe, in a precision that may be another than the lobe's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spaces<R: Real> {
    pub target_from_cosine: R::Mat3,
    pub cosine_from_target: R::Mat3,
}

impl<R: Real> Spaces<R> {
    #[inline]
    pub fn of(ltc: &Ltc<R>) -> Self {
        Self { target_from_cosine: ltc.target_from_cosine(), cosine_from_target: ltc.cosine_from_target() }
    }
}

impl Spaces<f64> {
    /// In f64, of a lobe in any precision.
    pub fn wide<R: Real>(ltc: &Ltc<R>) -> Self {
        let widen = |m: R::Mat3| {
            let [x, y, z] = m.columns().map(widened::<R>);
            DMat3::from_cols(x, y, z)
        };
        Self {
            target_from_cosine: widen(ltc.target_from_cosine()),
            cosine_from_target: widen(ltc.cosine_from_target()),
        }
    }
}
