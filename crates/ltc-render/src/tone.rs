//! From radiance to what a screen shows.

/// Exposure and a filmic curve.
///
/// Each channel of the radiance is multiplied by `2^exposure`, bent by the filmic curve
/// `(x (2.51 x + 0.03)) / (x (2.43 x + 0.59) + 0.14)` (K. Narkowicz 2015, "ACES Filmic Tone Mapping Curve"), clamped to
/// [0, 1] and encoded with the sRGB transfer function (IEC 61966-2-1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMap {
    /// In stops: each doubles the brightness.
    pub exposure: f64,
}

impl ToneMap {
    /// What linear radiance is multiplied with.
    pub fn scale(self) -> f64 {
        self.exposure.exp2()
    }

    /// The 8-bit sRGB code of a linear channel. NaN gives 0.
    pub fn encode(self, radiance: f32) -> u8 {
        let x = (f64::from(radiance) * self.scale()).clamp(0.0, 1e6);
        let bent = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
        (srgb(bent.clamp(0.0, 1.0)) * 255.0).round() as u8
    }
}

/// The sRGB transfer function, from [0, 1] to [0, 1].
fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_rises_from_black_to_white() {
        let tone = ToneMap::default();
        let codes: Vec<_> = (0..200).map(|i| tone.encode(1e-3 * 1.06_f32.powi(i))).collect();
        assert!(codes.is_sorted());
        assert_eq!((tone.encode(0.0), tone.encode(-1.0), tone.encode(f32::NAN)), (0, 0, 0));
        assert_eq!((tone.encode(1e3), tone.encode(f32::INFINITY)), (255, 255));
    }

    #[test]
    fn a_stop_is_a_factor_of_two() {
        assert_eq!(ToneMap { exposure: 1.0 }.encode(0.2), ToneMap::default().encode(0.4));
        assert_eq!(ToneMap { exposure: -2.0 }.encode(0.8), ToneMap::default().encode(0.2));
    }
}
