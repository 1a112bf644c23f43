//! Lights that surround the shading point.

use super::Horizon;
use crate::{Ltc, Matrix, Real, Vector};

/// The fraction of a lobe above the horizons asked for: that of a light in every direction.
///
/// The surface's horizon is a plane through the origin of cosine space, too. With γ the angle between its normal there and
/// z, the cosine between both planes integrates to (1 + cos γ)/2 of the whole.
pub(super) fn everywhere<R: Real>(ltc: &Ltc<R>, horizon: Horizon) -> R {
    let ground = ltc.target_from_cosine().transposed().apply(R::Vec3::new(R::ZERO, R::ZERO, R::ONE));
    let cosine = ground.try_unit().map_or(R::ZERO, Vector::z);
    let fraction = match (horizon.surface, horizon.cosine) {
        (true, true) => R::of(0.5) * (R::ONE + cosine),
        (true, false) => cosine,
        (false, true) => R::ONE,
        (false, false) => R::ZERO,
    };
    fraction.clamped(R::ZERO, R::ONE)
}
