//! A preset for each material beside GGX.

use ltc_table::{Axis, Mapping, Quantity};

use crate::{
    Beckmann, Brdf, CharlieSheen, DisneyDiffuse, FitSpec, OrenNayar, channels::ChannelSettings,
    joint::JointSettings, measure::MeasureSettings,
};

/// Smallest α of the sheen's table. Below it the lobe is all but dark up to 80° and brighter than the light beyond 88°.
const CHARLIE_ALPHA_MIN: f64 = 4e-3;

/// The preset of that name, if it is one of these. What they do not say is as in the GGX presets.
///
/// Sizes were chosen by measuring (`docs/materials.md`): total variation is that of the best LTC from 8² on; magnitude asks for
/// more.
pub(crate) fn preset(name: &str) -> Option<FitSpec> {
    if name == "beckmann-anisotropic" {
        let base = FitSpec::preset("ggx-anisotropic").ok()?;
        return Some(FitSpec { name: name.to_owned(), brdf: Beckmann.name().to_owned(), ..base });
    }
    let (brdf, len, alpha_min): (&dyn Brdf, usize, f64) = match name {
        "beckmann-isotropic" => (&Beckmann, 32, 0.0),
        "disney-diffuse" => (&DisneyDiffuse, 16, 0.0),
        "oren-nayar" => (&OrenNayar, 16, 0.0),
        "charlie-sheen" => (&CharlieSheen, 32, CHARLIE_ALPHA_MIN),
        _ => return None,
    };
    let mut spec = FitSpec::preset("ggx-isotropic").ok()?;
    // Even in θ: what is hard about these materials happens towards grazing.
    let theta = Axis::full(Quantity::Theta, Mapping::Linear, len);
    let mut alpha = Axis::full(Quantity::Alpha, Mapping::Sqrt, len);
    alpha.domain[0] = alpha_min;
    spec.floors.alpha = spec.floors.alpha.max(alpha_min);
    spec.joint = JointSettings { steps: 100, queries: 1024, ..spec.joint };
    // Magnitudes to 1e-4 take some ten thousand samples.
    spec.channels = ChannelSettings { samples: 16_384, queries: 4_000, ..spec.channels };
    spec.measure = MeasureSettings { queries: 2_000, samples: 8_192, ..spec.measure };
    Some(FitSpec { name: name.to_owned(), brdf: brdf.name().to_owned(), axes: vec![theta, alpha], ..spec })
}
