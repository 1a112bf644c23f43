//! The languages that shaders are written in.

use std::fmt;
use std::str::FromStr;

use crate::UnknownName;
use crate::request::by_name;

/// A shading language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Language {
    /// WebGPU's.
    Wgsl,
    /// GLSL 4.50, for Vulkan and desktop OpenGL.
    Glsl,
    /// GLSL ES 3.00, for WebGL 2 and OpenGL ES 3.
    GlslEs,
    /// HLSL, shader model 5.1 and later.
    Hlsl,
    /// Metal's, version 2.0 and later.
    Msl,
    /// SPIR-V 1.3, for Vulkan 1.1 and later.
    Spirv,
}

impl Language {
    /// Every language there is.
    pub const ALL: [Self; 6] = [Self::Wgsl, Self::Glsl, Self::GlslEs, Self::Hlsl, Self::Msl, Self::Spirv];

    /// The name in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }

    /// What files of it end with, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl | Self::GlslEs => "glsl",
            Self::Hlsl => "hlsl",
            Self::Msl => "metal",
            Self::Spirv => "spv",
        }
    }

    /// Name and version, for people.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Wgsl => "WGSL",
            Self::Glsl => "GLSL 4.50",
            Self::GlslEs => "GLSL ES 3.00",
            Self::Hlsl => "HLSL, shader model 5.1",
            Self::Msl => "Metal Shading Language 2.0",
            Self::Spirv => "SPIR-V 1.3",
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Language {
    type Err = UnknownName;
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("language", &Self::ALL, name)
    }
}
