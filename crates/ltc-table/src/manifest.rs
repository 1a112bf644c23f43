//! What a table version says about itself.

use serde::{Deserialize, Serialize};

use crate::{Axis, ClosedForm};

/// The manifest of one table version; `manifest.json` beside the payload.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// The table's name.
    pub name: String,
    /// Counts up from 1.
    pub version: u32,
    /// `sha256:<hex>` of the payload (`table.npz`), which holds every number of the table.
    pub digest: String,
    /// Bytes of the payload.
    pub payload_bytes: u64,
    /// The axes, slowest first; arrays are in C order.
    pub axes: Vec<Axis>,
    /// The channels and their meaning.
    pub channels: Vec<ChannelInfo>,
    /// LTCs in the mixture.
    pub lobes: u32,
    /// How matrices are scaled and aligned.
    pub normalisation: String,
    /// Frame, direction of `m`, sign of its determinant.
    pub handedness: String,
    /// Smallest values that entries were fitted at; smaller queries use them.
    pub floors: Floors,
    /// What was fitted.
    pub brdf: BrdfInfo,
    /// How it was fitted; every setting that the digest depends on.
    pub fit: serde_json::Value,
    /// How good it is.
    pub errors: Errors,
    /// When, RFC 3339, UTC.
    pub created: String,
    /// By which program and version.
    pub tool: String,
    /// SPDX expression.
    pub licence: String,
}

/// One channel of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelInfo {
    /// The array's name in the NPZ payload.
    pub name: String,
    /// Shape of one entry.
    pub shape: Vec<usize>,
    /// What it means.
    pub meaning: String,
    /// The formula whose values at the entries are to be taken off before interpolation and whose value at the query is to be
    /// added to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed_form: Option<ClosedForm>,
}

/// Smallest values that the fit evaluated the BRDF at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Floors {
    /// Smallest α_x, α_y.
    pub alpha: f64,
    /// Smallest λ.
    pub lambda: f64,
    /// Largest θ, radians.
    pub theta_max: f64,
}

/// The BRDF that a table approximates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BrdfInfo {
    /// Its name.
    pub name: String,
    /// Its parameters and variants.
    pub parameters: serde_json::Value,
}

/// Error statistics of a table, recomputed by `ltc verify`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Total variation over random off-grid queries.
    pub standard_draw: DrawErrors,
    /// Largest share of an entry's lobe below the horizon.
    pub leak_max: f64,
    /// Its mean over entries.
    pub leak_mean: f64,
    /// Largest condition number of an entry's matrix.
    pub condition_max: f64,
    /// Mean total variation of the entries at their own nodes.
    pub cell_tv_mean: f64,
    /// Its maximum.
    pub cell_tv_max: f64,
    /// Mean error of the interpolated magnitude over the draw with θ up to 89°.
    pub magnitude_mean: f64,
    /// Its maximum.
    pub magnitude_max: f64,
    /// Mean error of the interpolated Fresnel term over the same.
    pub fresnel_mean: f64,
    /// Its maximum.
    pub fresnel_max: f64,
    /// Errors over the whole grid; tables fitted before there were any have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<GridErrors>,
}

/// Errors at every entry and at the centre of every cell between entries, up to the ends of the axes: the standard draw
/// does not go there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridErrors {
    /// Mean of |magnitude − its integral| over the entries.
    pub node_magnitude_mean: f64,
    /// Mean of magnitude − its integral over the entries.
    pub node_magnitude_bias: f64,
    /// Largest |magnitude − its integral| of an entry.
    pub node_magnitude_max: f64,
    /// Mean of |Fresnel term − its integral| over the entries.
    pub node_fresnel_mean: f64,
    /// Mean of Fresnel term − its integral over the entries.
    pub node_fresnel_bias: f64,
    /// Largest |Fresnel term − its integral| of an entry.
    pub node_fresnel_max: f64,
    /// Mean total variation of lookups at the centres of cells.
    pub centre_tv_mean: f64,
    /// Its maximum.
    pub centre_tv_max: f64,
    /// Mean error of the interpolated magnitude at the centres of cells.
    pub centre_magnitude_mean: f64,
    /// Its maximum.
    pub centre_magnitude_max: f64,
    /// Mean error of the interpolated Fresnel term at the centres of cells.
    pub centre_fresnel_mean: f64,
    /// Its maximum.
    pub centre_fresnel_max: f64,
    /// Mean of `|M₁ − M₂| / (|M₁| + |M₂|)` (Frobenius) over entries beside each other: how smoothly matrices lie, with the
    /// scale and turn that lobes do not show.
    pub step_mean: f64,
    /// Its maximum.
    pub step_max: f64,
}

/// Total variation over the standard draw (see `ltc_fit::draw`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrawErrors {
    /// Which draw: `"isotropic"` (λ = 1) or `"anisotropic"`.
    pub draw: String,
    /// Mean over all queries.
    pub tv_mean: f64,
    /// Median.
    pub tv_median: f64,
    /// 95th percentile.
    pub tv_p95: f64,
    /// Maximum.
    pub tv_max: f64,
    /// Mean over queries with α < 0.14.
    pub tv_mean_alpha_below_0_14: f64,
    /// Mean over queries with α ≥ 0.14.
    pub tv_mean_alpha_from_0_14: f64,
    /// How many queries.
    pub queries: u32,
    /// Samples of the BRDF's lobe at each query.
    pub samples: u32,
    /// Seed of the queries.
    pub seed: u64,
}
