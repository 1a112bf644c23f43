//! Mixtures of linearly transformed cosines.

use super::{ClosedForm, Distribution};
use crate::{Horizon, InputError, Light, Ltc, Real, check_range};

/// A weighted sum of [`Ltc`]s, `D = Σ wᵢ Dᵢ` with wᵢ ≥ 0 and `Σ wᵢ = 1`. It keeps every closed form.
///
/// ```
/// use glam::{DMat3, DVec3};
/// use ltc_core::{Ltc, LtcMixture, Polygon, Sides};
///
/// let narrow = Ltc::<f64>::new(DMat3::from_diagonal(DVec3::new(0.1, 0.1, 1.0)))?;
/// let mixture = LtcMixture::new([(0.75, narrow), (0.25, Ltc::cosine())])?;
/// let light = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 2.0));
/// let light = Polygon::new(&light, Sides::One)?;
/// let parts = 0.75 * narrow.integrate_polygon(&light, Default::default())
///     + 0.25 * Ltc::cosine().integrate_polygon(&light, Default::default());
/// assert!((mixture.integrate(&light) - parts).abs() < 1e-15);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LtcMixture<R: Real> {
    lobes: Vec<(R, Ltc<R>)>,
}

impl<R: Real> LtcMixture<R> {
    /// How far from 1 the sum of the weights may be: half-float weights of a few lobes pass, a forgotten lobe does not.
    pub const WEIGHT_TOLERANCE: f64 = 1e-3;

    /// The mixture of these weights and lobes. Weights are divided by their sum.
    ///
    /// # Errors
    /// [`InputError::Empty`] without lobes, [`InputError::NotFinite`] or [`InputError::OutOfRange`] for a weight that is
    /// NaN, infinite or negative, [`InputError::OutOfRange`] for weights whose sum is not 1 to within
    /// [`LtcMixture::WEIGHT_TOLERANCE`].
    pub fn new(lobes: impl IntoIterator<Item = (R, Ltc<R>)>) -> Result<Self, InputError> {
        let mut lobes: Vec<_> = lobes.into_iter().collect();
        if lobes.is_empty() {
            return Err(InputError::Empty { name: "mixture" });
        }
        let (tolerance, mut sum) = (Self::WEIGHT_TOLERANCE, 0.0);
        for (weight, _) in &lobes {
            sum += check_range("weight", weight.to_f64(), 0.0, 1.0 + tolerance)?;
        }
        check_range("sum of weights", sum, 1.0 - tolerance, 1.0 + tolerance)?;
        for (weight, _) in &mut lobes {
            *weight = R::of(weight.to_f64() / sum);
        }
        Ok(Self { lobes })
    }

    /// Weights and lobes.
    pub fn lobes(&self) -> &[(R, Ltc<R>)] {
        &self.lobes
    }

    /// Density at the unit direction `w`, in 1/sr.
    pub fn density(&self, w: R::Vec3) -> R {
        self.lobes.iter().fold(R::ZERO, |sum, (weight, lobe)| sum + *weight * lobe.density(w))
    }

    /// A direction of density [`LtcMixture::density`], from `u` ∈ [0, 1)².
    ///
    /// `u[0]` chooses the lobe and what is left of it, stretched to [0, 1), draws from it: points that are stratified
    /// stay so within each lobe.
    pub fn sample(&self, u: [R; 2]) -> R::Vec3 {
        let last = R::ONE - R::of(0.5) * R::EPSILON;
        let mut left = u[0];
        let mut chosen = (Ltc::cosine(), R::ZERO);
        for (weight, lobe) in self.lobes.iter().filter(|(weight, _)| *weight > R::ZERO) {
            chosen = (*lobe, (left / *weight).clamped(R::ZERO, last));
            if left < *weight {
                break;
            }
            left = left - *weight;
        }
        let (lobe, rescaled) = chosen;
        lobe.sample([rescaled, u[1]])
    }

    /// The fraction of the mixture that sees `light`, cut by both horizons; in [0, 1].
    pub fn integrate(&self, light: &(impl Light<R> + ?Sized)) -> R {
        self.integrate_within(light, Horizon::BOTH)
    }

    /// The fraction of the mixture that sees `light`, cut by the horizons asked for; in [0, 1].
    pub fn integrate_within(&self, light: &(impl Light<R> + ?Sized), horizon: Horizon) -> R {
        let parts = self.lobes.iter().map(|(weight, lobe)| *weight * light.integrate_within(lobe, horizon));
        parts.fold(R::ZERO, |sum, part| sum + part).clamped(R::ZERO, R::ONE)
    }
}

/// The mixture of one lobe.
impl<R: Real> From<Ltc<R>> for LtcMixture<R> {
    fn from(lobe: Ltc<R>) -> Self {
        Self { lobes: vec![(R::ONE, lobe)] }
    }
}

impl<R: Real> Distribution<R> for LtcMixture<R> {
    fn density(&self, w: R::Vec3) -> R {
        self.density(w)
    }

    fn sample(&self, u: [R; 2]) -> R::Vec3 {
        self.sample(u)
    }
}

impl<R: Real> ClosedForm<R> for LtcMixture<R> {
    fn integrate_within(&self, light: &dyn Light<R>, horizon: Horizon) -> R {
        self.integrate_within(light, horizon)
    }
}

impl<R: Real> ClosedForm<R> for Ltc<R> {
    fn integrate_within(&self, light: &dyn Light<R>, horizon: Horizon) -> R {
        light.integrate_within(self, horizon)
    }
}
