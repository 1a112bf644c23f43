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
    /// By the shader, in full `f32`, out of a storage buffer: for devices without float textures.
    Buffer,
}
