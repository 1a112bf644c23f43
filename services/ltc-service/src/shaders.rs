//! Shader source, from whoever brings it: the service itself knows no shading language, and needs no GPU stack to serve.

/// Writes shaders on request.
pub trait ShaderSource: Send + Sync {
    /// Names of the languages.
    fn languages(&self) -> Vec<&'static str>;

    /// A shader in one of [`ShaderSource::languages`] with these lights and features, names between commas; `None` for those
    /// that are usual. The same question has the same answer as long as the program runs.
    ///
    /// # Errors
    /// [`ShaderRefusal`] for names that are not known, and for what cannot be written in that language.
    fn shader(
        &self,
        language: &str,
        lights: &str,
        features: Option<&str>,
    ) -> Result<ShaderFile, ShaderRefusal>;
}

/// A shader as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderFile {
    /// Its content.
    pub bytes: Vec<u8>,
    /// What its name ends with, without the dot.
    pub extension: &'static str,
    /// Whether it is text, in UTF-8.
    pub is_text: bool,
}

/// Why there is no such shader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderRefusal {
    /// Which parameter is to blame: `lights` or `features`.
    pub field: &'static str,
    /// What is wrong with it.
    pub reason: String,
}
