//! `ltc shader`

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use ltc_shade_gpu::{Code, Exported, Feature, Language, LightKind, ShaderRequest};
use ltc_table::files;

/// Writes a drop-in shader: the functions asked for and what they need, nothing else.
///
/// Source is a library of functions without bindings and entry points, to be pasted into an engine's shader; its head says
/// how. SPIR-V comes as compute kernels; --describe says how they are bound.
///
/// Example: ltc shader --lang glsl --lights quad,line --features isotropic,fresnel,surface-horizon -o ltc.glsl
///
/// Example: ltc shader --list
#[derive(Args)]
pub struct Shader {
    /// wgsl, glsl (4.50), glsl-es (3.00), hlsl, msl or spirv.
    #[arg(long, value_name = "LANGUAGE", required_unless_present = "list")]
    lang: Option<Language>,
    /// Lights, with commas; --list names them.
    #[arg(long, value_name = "LIGHTS", value_delimiter = ',', value_parser = name::<LightKind>)]
    lights: Vec<Option<LightKind>>,
    /// Features, with commas; exactly these. --list names them.
    #[arg(
        long,
        value_name = "FEATURES",
        value_delimiter = ',',
        value_parser = name::<Feature>,
        default_value = crate::shaders::USUAL
    )]
    features: Vec<Option<Feature>>,
    /// File to write, instead of stdout.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Prints what the shader holds and how it is bound, and not the shader.
    #[arg(long, conflicts_with = "output")]
    describe: bool,
    /// Lists languages, lights and features.
    #[arg(long, exclusive = true)]
    list: bool,
    /// Prints what was written as JSON.
    #[arg(long, requires = "output")]
    json: bool,
}

impl Shader {
    pub fn run(self) -> Result<()> {
        let Some(language) = self.lang else {
            return list();
        };
        let lights = self.lights.iter().flatten().copied();
        let features = self.features.iter().flatten().copied();
        let exported = ShaderRequest::new(lights, features).export(language)?;
        if self.describe {
            outln!("{}", exported.header.join("\n"));
            return Ok(());
        }
        match &self.output {
            Some(path) => self.write(path, &exported),
            None => print(&exported),
        }
    }

    fn write(&self, path: &std::path::Path, exported: &Exported) -> Result<()> {
        let bytes = exported.bytes();
        files::write_atomically(path, &bytes)?;
        let file = path.display().to_string();
        if self.json {
            let digest = ltc_table::digest::digest(&bytes);
            let language = exported.language.name();
            outln!(
                "{}",
                serde_json::json!({ "file": file, "language": language, "bytes": bytes.len(), "digest": digest })
            );
        } else {
            outln!("{file}: {} bytes", bytes.len());
        }
        Ok(())
    }
}

fn print(exported: &Exported) -> Result<()> {
    let is_binary = matches!(exported.code, Code::Words(_));
    if is_binary && std::io::IsTerminal::is_terminal(&std::io::stdout()) {
        bail!("SPIR-V is not for terminals: give a file with -o, or --describe")
    }
    Ok(std::io::stdout().write_all(&exported.bytes())?)
}

fn list() -> Result<()> {
    outln!("languages: {}", Language::ALL.map(Language::name).join(", "));
    outln!("lights: {}", LightKind::ALL.map(LightKind::name).join(", "));
    outln!("features:");
    for feature in Feature::ALL {
        outln!("  {:<20}{}", feature.name(), feature.summary());
    }
    Ok(())
}

/// A name, or nothing for an empty list.
fn name<T: std::str::FromStr>(text: &str) -> Result<Option<T>, T::Err> {
    if text.trim().is_empty() { Ok(None) } else { text.trim().parse().map(Some) }
}
