//! Textures of area lights, filtered in advance (2016 paper, §5.3).

mod filter;
mod level;
mod prefiltered;

pub use filter::{TextureRow, TextureRows};
pub use level::TextureLevel;
pub use prefiltered::{PrefilteredTexture, TexelGrid};
