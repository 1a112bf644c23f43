//! naga's back ends, and what has to be done to their output so that it can be pasted.

use std::collections::BTreeMap;

use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::ModuleInfo;
use naga::{Module, ShaderStage};

use super::Language;
use super::names::readable;

/// The entry point that GLSL's back end needs, in WGSL. It is taken out again.
pub const STUB: &str = "\n@fragment\nfn ltc_stub() {}\n";

/// Functions in a language that is text.
pub fn text(language: Language, module: &Module, info: &ModuleInfo) -> Result<String, String> {
    let raw = match language {
        Language::Glsl => glsl_text(module, info, glsl::Version::Desktop(450))?,
        Language::GlslEs => glsl_text(module, info, glsl::Version::new_gles(300))?,
        Language::Hlsl => hlsl_text(module, info)?,
        Language::Msl => msl_text(module, info)?,
        Language::Wgsl | Language::Spirv => return Err("it is no text of naga's".to_owned()),
    };
    Ok(readable(&declared(&raw), module))
}

/// The text with the host's functions declared instead of defined.
fn declared(raw: &str) -> String {
    let mut text = raw.to_owned();
    for name in super::HOST_FUNCTIONS {
        let heads = ["vec4", "float4", "metal::float4"].map(|ty| format!("\n{ty} {name}("));
        let Some(start) = heads.iter().find_map(|head| text.find(head.as_str())) else { continue };
        let body = text[start..].find('{').map(|at| start + at);
        let end = text[start..].find("\n}").map(|at| start + at + 2);
        if let (Some(body), Some(end)) = (body, end) {
            let head = text[..body].trim_end().len();
            text.replace_range(head..end, ";");
        }
    }
    text
}

/// GLSL's back end writes programs alone: `module` holds [`STUB`], whose `main` is cut off.
fn glsl_text(module: &Module, info: &ModuleInfo, version: glsl::Version) -> Result<String, String> {
    let options =
        glsl::Options { version, writer_flags: glsl::WriterFlags::empty(), ..glsl::Options::default() };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: "ltc_stub".to_owned(),
        multiview: None,
    };
    let mut raw = String::new();
    let policies = BoundsCheckPolicies::default();
    glsl::Writer::new(&mut raw, module, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|e| e.to_string())?;
    let library = raw.split("void main() {").next().unwrap_or_default();
    // The version has to be a file's first line, which is not this text's.
    let kept = library.lines().filter(|line| !line.starts_with("#version"));
    let mut text: String = kept.flat_map(|line| [line, "\n"]).collect();
    if version.is_es() {
        let used = |sampler: &&str| text.contains(&format!("{sampler} "));
        let samplers = ["sampler2D", "sampler2DArray", "sampler3D"].into_iter().filter(used);
        let precisions: String = samplers.map(|s| format!("precision highp {s};\n")).collect();
        text = text.replacen("precision highp int;\n", &format!("precision highp int;\n{precisions}"), 1);
    }
    Ok(text)
}

fn hlsl_text(module: &Module, info: &ModuleInfo) -> Result<String, String> {
    let options = hlsl::Options {
        zero_initialize_workgroup_memory: false,
        restrict_indexing: false,
        force_loop_bounding: false,
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions { entry_point: None };
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(|e| e.to_string())?;
    Ok(text)
}

fn msl_text(module: &Module, info: &ModuleInfo) -> Result<String, String> {
    let options = msl::Options {
        lang_version: (2, 0),
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        ..msl::Options::default()
    };
    let (text, _) = msl::write_string(module, info, &options, &msl::PipelineOptions::default())
        .map_err(|e| e.to_string())?;
    Ok(text)
}

/// The text with the comments that stand above functions and structures in the WGSL.
pub fn with_comments(text: &str, wgsl: &str) -> String {
    let comments = comments(wgsl);
    let mut result = String::new();
    for line in text.split_inclusive('\n') {
        if let Some(above) = defined(line).and_then(|name| comments.get(name)) {
            result.push_str(above);
        }
        result.push_str(line);
    }
    result
}

/// Comments by the name of what they stand above.
fn comments(wgsl: &str) -> BTreeMap<&str, String> {
    let mut found = BTreeMap::new();
    let mut above = String::new();
    for line in wgsl.lines() {
        if line.starts_with("//") {
            above.push_str(line);
            above.push('\n');
            continue;
        }
        let head = ["fn ", "struct "].iter().find_map(|word| line.strip_prefix(word));
        if let Some(name) = head.and_then(|rest| rest.split(['(', ' ']).next())
            && !above.is_empty()
        {
            found.insert(name, std::mem::take(&mut above));
        }
        above.clear();
    }
    found
}

/// The name of the structure or function that begins on this line of GLSL, HLSL or MSL.
fn defined(line: &str) -> Option<&str> {
    let line = line.trim_end();
    if let Some(rest) = line.strip_prefix("struct ") {
        return rest.strip_suffix(" {");
    }
    let head = line.split_once('(')?.0;
    let starts = line.starts_with(|c: char| c.is_ascii_alphabetic()) && !line.ends_with(';');
    head.rsplit_once(' ').map(|pair| pair.1).filter(|_| starts)
}

/// All entry points of a module, for Vulkan 1.1.
pub fn spirv(module: &Module, info: &ModuleInfo) -> Result<Vec<u32>, String> {
    let options = spv::Options {
        lang_version: (1, 3),
        // Names of functions, for whoever reads it.
        flags: spv::WriterFlags::DEBUG,
        // Groups and bindings as the WGSL has them.
        fake_missing_bindings: true,
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    spv::write_vec(module, info, &options, None).map_err(|e| e.to_string())
}
