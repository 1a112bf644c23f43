//! Numbers as colours.

use super::canvas::Colour;

/// Nine colours of viridis (van der Walt & Smith 2015), evenly spaced: even to the eye, in grey, and to the colour-blind.
const VIRIDIS: [Colour; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Grey, which is not on the scale.
const NO_NUMBER: Colour = [128, 128, 128];

/// Colours for numbers from 0 to a round number.
#[derive(Clone, Copy, Debug)]
pub struct ColourScale {
    step: f64,
    steps: u32,
}

impl ColourScale {
    /// A scale that reaches at least `max`, in at most ten round steps; to 1 where `max` is no number above 0.
    pub fn to(max: f64) -> Self {
        let max = if max > 0.0 && max.is_finite() { max } else { 1.0 };
        let tenth = 10.0_f64.powf((max / 10.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|round| round * tenth).into_iter().find(|s| s * 10.0 >= max);
        let step = step.unwrap_or(max);
        Self { step, steps: (max / step).ceil().max(1.0) as u32 }
    }

    /// The largest number.
    pub fn end(&self) -> f64 {
        self.step * f64::from(self.steps)
    }

    /// The round numbers from 0 to the end.
    pub fn ticks(&self) -> impl Iterator<Item = f64> {
        (0..=self.steps).map(|i| f64::from(i) * self.step)
    }

    /// The colour of a number; those outside the scale have the colours of its ends, NaN is grey.
    pub fn colour(&self, value: f64) -> Colour {
        if value.is_nan() {
            return NO_NUMBER;
        }
        let place = (value / self.end()).clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
        let below = (place as usize).min(VIRIDIS.len() - 2);
        let within = place - below as f64;
        let mix = |a: u8, b: u8| (f64::from(a) + within * (f64::from(b) - f64::from(a))).round() as u8;
        core::array::from_fn(|c| mix(VIRIDIS[below][c], VIRIDIS[below + 1][c]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_and_reach_far_enough() {
        for (max, end, count) in
            [(0.483, 0.5, 11), (0.21, 0.25, 6), (0.1, 0.1, 11), (3.0, 3.0, 7), (1.0, 1.0, 11)]
        {
            let scale = ColourScale::to(max);
            assert!((scale.end() - end).abs() < 1e-9, "{max}: {scale:?}");
            assert_eq!(scale.ticks().count(), count, "{max}");
        }
        for nonsense in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(ColourScale::to(nonsense).end(), 1.0);
        }
    }

    #[test]
    fn colours_run_from_end_to_end() {
        let scale = ColourScale::to(0.5);
        assert_eq!((scale.colour(0.0), scale.colour(0.5)), (VIRIDIS[0], VIRIDIS[8]));
        assert_eq!((scale.colour(-3.0), scale.colour(7.0)), (VIRIDIS[0], VIRIDIS[8]));
        assert_eq!(scale.colour(0.25), VIRIDIS[4]);
        assert_eq!(scale.colour(f64::NAN), NO_NUMBER);
    }
}
