//! Colours of equal steps to the eye, mixed in Oklab.

use std::f64::consts::PI;

/// 8-bit sRGB.
pub type Rgb = [u8; 3];

pub const WHITE: Rgb = [255; 3];
pub const INK: Rgb = [40, 40, 46];
pub const FAINT: Rgb = [168, 168, 176];
pub const ORANGE: Rgb = [200, 82, 24];
pub const BLUE: Rgb = [38, 92, 190];

/// From black through violet, red and orange to pale yellow: lightness grows evenly with `t` in [0, 1].
pub fn sequential(t: f64) -> Rgb {
    let t = t.clamp(0.0, 1.0);
    let hue = (285.0 + 180.0 * t).to_radians();
    in_gamut(0.08 + 0.89 * t, 0.19 * (PI * t.powf(0.8)).sin().max(0.0).powf(0.7), hue)
}

/// White at 0, blue to −1 and orange to 1, equally dark on both sides.
pub fn diverging(t: f64) -> Rgb {
    let t = t.clamp(-1.0, 1.0);
    let hue = if t < 0.0 { 262.0_f64 } else { 45.0 };
    let size = t.abs();
    in_gamut(0.985 - 0.53 * size, 0.19 * size.powf(0.8), hue.to_radians())
}

/// The colour of that lightness and hue with the chroma, or the largest that sRGB has.
fn in_gamut(lightness: f64, chroma: f64, hue: f64) -> Rgb {
    let mut chroma = chroma;
    loop {
        let linear = linear_from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin());
        if chroma < 1e-3 || linear.iter().all(|x| (-1e-3..=1.001).contains(x)) {
            return linear.map(|x| (255.0 * encoded(x.clamp(0.0, 1.0))).round() as u8);
        }
        chroma *= 0.97;
    }
}

/// Oklab to linear sRGB (Ottosson 2020).
fn linear_from_oklab(l: f64, a: f64, b: f64) -> [f64; 3] {
    let cubed = |x: f64| x * x * x;
    let long = cubed(l + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let medium = cubed(l - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let short = cubed(l - 0.089_484_177_5 * a - 1.291_485_548 * b);
    [
        4.076_741_662_1 * long - 3.307_711_591_3 * medium + 0.230_969_929_2 * short,
        -1.268_438_004_6 * long + 2.609_757_401_1 * medium - 0.341_319_396_5 * short,
        -0.004_196_086_3 * long - 0.703_418_614_7 * medium + 1.707_614_701 * short,
    ]
}

fn encoded(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}
