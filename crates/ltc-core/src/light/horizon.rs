//! The two horizons that a light is cut by.

/// Which horizons cut a light before it is integrated.
///
/// The lobe of a real surface ends at two planes: the surface's own horizon, z = 0 in the shading frame, and the horizon of
/// the clamped cosine, z = 0 in cosine space. Published shaders cut by the second alone, so that a light below the
/// ground shines through it.
///
/// # What leaks
/// Without the surface's horizon at most the mass of the lobe below it: `½ (1 − m₂₂ / ‖(m₂₀, m₂₁, m₂₂)‖)` for M. That is up
/// to 0.23 (0.012 in the mean) over the entries of the shipped `ggx-anisotropic`, 0.02 (0.003) over those of
/// `ggx-isotropic`, and up to 0.38 for published tables.
///
/// # What it costs
/// A quad that neither horizon cuts pays two comparisons for them. One that the surface's cuts pays a fifth arc, one that
/// the cosine's cuts an angle along it: `cargo bench -p ltc-benches integrate/quad` times both ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Horizon {
    /// Cut by z = 0 of the shading frame.
    pub surface: bool,
    /// Cut by z = 0 of cosine space. Without it the signed cosine is integrated, and what lies below counts negatively;
    /// the result is still clamped to [0, 1].
    pub cosine: bool,
}

impl Horizon {
    /// Both: nothing leaks.
    pub const BOTH: Self = Self { surface: true, cosine: true };
    /// The surface's alone.
    pub const SURFACE: Self = Self { surface: true, cosine: false };
    /// That of cosine space alone, as the papers have it.
    pub const COSINE: Self = Self { surface: false, cosine: true };
    /// Neither: for lights known to be above both.
    pub const NONE: Self = Self { surface: false, cosine: false };
}

impl Default for Horizon {
    fn default() -> Self {
        Self::BOTH
    }
}
