//! The shading functions in other languages, from the one WGSL source, through naga.
//!
//! Text comes as a library: types and functions without bindings and entry points, to be pasted or included, under the
//! names that they have in WGSL. SPIR-V has no such form that engines could take; it comes as compute kernels
//! ([`kernels`]).

mod header;
mod kernels;
mod language;
mod names;
mod text;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

pub use language::Language;

use crate::{Feature, LightKind, ShaderRequest};

/// Why a request has no answer in a language.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// Neither a light nor a feature that brings functions was asked for.
    #[error("nothing was asked for: name a light ({lights}) or a feature that brings functions ({features})")]
    Empty {
        /// What lights there are.
        lights: String,
        /// What features there are that stand alone.
        features: String,
    },
    /// Only lights and lookups have kernels.
    #[error(
        "SPIR-V comes as kernels, and there is none for these features alone: name a light, isotropic, anisotropic or baked"
    )]
    NoKernel,
    /// The translator refused.
    #[error("cannot be written in {language}: {reason}")]
    Untranslatable {
        /// The language.
        language: Language,
        /// Its words.
        reason: String,
    },
}

/// Code in one language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Code {
    /// Source.
    Text(String),
    /// SPIR-V.
    Words(Vec<u32>),
}

/// What came of a request: the same for the same request and version, byte by byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The language.
    pub language: Language,
    /// What is in the code and how it is used, in lines without comment marks. Source has it at its top.
    pub header: Vec<String>,
    /// The code itself.
    pub code: Code,
}

impl Exported {
    /// What a file holds: UTF-8, or words in little-endian order.
    pub fn bytes(&self) -> Vec<u8> {
        match &self.code {
            Code::Text(text) => text.clone().into_bytes(),
            Code::Words(words) => words.iter().flat_map(|word| word.to_le_bytes()).collect(),
        }
    }
}

impl ShaderRequest {
    /// The functions in a language, and nothing that was not asked for.
    ///
    /// # Errors
    /// [`ExportError::Empty`], [`ExportError::NoKernel`] for SPIR-V.
    ///
    /// ```
    /// use ltc_shade_gpu::{Code, Feature, Language, LightKind, ShaderRequest};
    /// let request = ShaderRequest::new([LightKind::Quad], [Feature::SurfaceHorizon]);
    /// let exported = request.export(Language::Glsl)?;
    /// let Code::Text(glsl) = exported.code else { unreachable!() };
    /// assert!(glsl.contains("float ltc_quad(LtcLobe lobe, vec3 v0, vec3 v1, vec3 v2, vec3 v3)"));
    /// # Ok::<(), ltc_shade_gpu::ExportError>(())
    /// ```
    pub fn export(&self, language: Language) -> Result<Exported, ExportError> {
        if self.is_empty() {
            let stands_alone = |feature: &Feature| !Self::new([], [*feature]).is_empty();
            return Err(ExportError::Empty {
                lights: list(LightKind::ALL),
                features: list(Feature::ALL.into_iter().filter(stands_alone)),
            });
        }
        if language == Language::Spirv {
            let wgsl = kernels::wgsl(self)?;
            let words = translated(language, &wgsl, text::spirv)?;
            return Ok(Exported {
                language,
                header: header::lines(self, language, &wgsl),
                code: Code::Words(words),
            });
        }
        let wgsl = self.wgsl();
        let body = match language {
            Language::Wgsl => wgsl,
            _ => text::with_comments(&translated(language, &wgsl, |m, i| text::text(language, m, i))?, &wgsl),
        };
        let header = header::lines(self, language, &body);
        let mut whole = String::new();
        for line in &header {
            whole.push_str(format!("// {line}").trim_end());
            whole.push('\n');
        }
        whole.push('\n');
        whole.push_str(&body);
        Ok(Exported { language, header, code: Code::Text(whole) })
    }
}

fn translated<T>(
    language: Language,
    wgsl: &str,
    back_end: impl FnOnce(&naga::Module, &ModuleInfo) -> Result<T, String>,
) -> Result<T, ExportError> {
    let stub = if matches!(language, Language::Glsl | Language::GlslEs) { text::STUB } else { "" };
    // What the host defines is declared only, but naga knows no declarations.
    let hosts: String = HOST_FUNCTIONS
        .iter()
        .filter(|name| wgsl.contains(&format!("{name}(")) && !wgsl.contains(&format!("fn {name}(")))
        .map(|name| format!("fn {name}(entry: u32, group: u32) -> vec4f {{ return vec4f(0.0); }}\n"))
        .collect();
    let (module, info) = parse(&format!("{wgsl}\n{hosts}{stub}"))
        .map_err(|reason| ExportError::Untranslatable { language, reason })?;
    back_end(&module, &info).map_err(|reason| ExportError::Untranslatable { language, reason })
}

/// What [`Feature::FunctionTables`] leaves to the host.
const HOST_FUNCTIONS: [&str; 3] = ["ltc_isotropic_texel", "ltc_anisotropic_texel", "ltc_baked_texel"];

fn list<T: ToString>(items: impl IntoIterator<Item = T>) -> String {
    items.into_iter().map(|item| item.to_string()).collect::<Vec<_>>().join(", ")
}

fn parse(wgsl: &str) -> Result<(naga::Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| e.emit_to_string(wgsl))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).map_err(|e| e.emit_to_string(wgsl))?;
    Ok((module, info))
}
