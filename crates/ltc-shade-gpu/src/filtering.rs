//! How tables are interpolated.

/// How a table is interpolated between its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filtering {
    /// By the shader, in full `f32`: agrees with the CPU to rounding, on every device.
    #[default]
    Exact,
    /// By the texture unit, which rounds weights to about 8 bits on hardware. Fewer fetches: 3 instead of 12 for the
    /// isotropic table, 6 instead of 48 for the anisotropic. Needs `FLOAT32_FILTERABLE` for 32-bit texels.
    Hardware,
    /// By the texture unit, the anisotropic table with more nodes along λ = α_min / α_max, of which the nearest is taken: 3 fetches
    /// for either table. Lobes of anisotropic materials are those of a λ that is off by half a step at most: the fraction that sees
    /// a random quad by 3·10⁻⁴ (RMS) and 7·10⁻³ at most, over an 8⁴ table. That is seen as steps only where λ changes from
    /// point to point. Such a table takes 1.0 MiB with 16-bit texels.
    Refined,
    /// By the shader, in full `f32`, out of a storage buffer: for devices without float textures.
    Buffer,
}

impl Filtering {
    /// Whether the texture unit interpolates.
    pub fn is_by_texture_unit(self) -> bool {
        matches!(self, Self::Hardware | Self::Refined)
    }
}
