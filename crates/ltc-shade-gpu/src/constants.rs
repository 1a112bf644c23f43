//! Numbers that tables, hosts and shaders share, written as WGSL from the Rust that defines them.

use ltc_core::ALPHA_MIN;
use ltc_table::{ClosedForm, Mapping};

use crate::LightKind;

/// A light that emits to both sides.
pub(crate) const TWO_SIDED: u32 = 1 << 8;
/// A cylinder with caps.
pub(crate) const CAPS: u32 = 1 << 9;
/// A flat light with a texture.
pub(crate) const TEXTURED: u32 = 1 << 10;

/// Where a surface point's lobe is looked up: in the anisotropic table,
pub(crate) const ANISOTROPIC_TABLE: u32 = 0;
/// in the isotropic one,
pub(crate) const ISOTROPIC_TABLE: u32 = 1;
/// or, from here on, in a baked slice.
pub(crate) const FIRST_SLICE: u32 = 2;

/// What stands for a mapping in a shader; the WGSL constants are generated from it.
pub(crate) fn mapping_code(mapping: Mapping) -> u32 {
    match mapping {
        Mapping::Linear => 0,
        Mapping::Sqrt => 1,
        Mapping::SqrtOneMinusCos => 2,
        Mapping::HalfTangent => 3,
        Mapping::GrazingHalfTangent => 4,
    }
}

/// The module `constants`.
pub(crate) fn constants() -> String {
    let mut text = String::from("// Numbers that tables and shaders share; generated. No bindings.\n\n");
    let mut line = |name: &str, ty: &str, value: String| {
        text.push_str(&format!("const {name}: {ty} = {value};\n"));
    };
    line("LTC_ALPHA_MIN", "f32", format!("{ALPHA_MIN:?}"));
    for (name, mapping) in [
        ("LTC_LINEAR", Mapping::Linear),
        ("LTC_SQRT", Mapping::Sqrt),
        ("LTC_SQRT_ONE_MINUS_COS", Mapping::SqrtOneMinusCos),
        ("LTC_HALF_TANGENT", Mapping::HalfTangent),
        ("LTC_GRAZING_HALF_TANGENT", Mapping::GrazingHalfTangent),
    ] {
        line(name, "u32", format!("{}u", mapping_code(mapping)));
    }
    let vector = |numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
        format!("vec{}f({})", numbers.len(), numbers.join(", "))
    };
    line("LTC_FORM_M1", "vec2f", vector(&ClosedForm::M1));
    line("LTC_FORM_M2", "vec2f", vector(&ClosedForm::M2));
    line("LTC_FORM_LEAST_M", "f32", format!("{:?}", ClosedForm::LEAST_M));
    line("LTC_FORM_MAGNITUDE", "vec3f", vector(&ClosedForm::MAGNITUDE));
    line("LTC_FORM_FRESNEL", "vec4f", vector(&ClosedForm::FRESNEL));
    text
}

/// The module `light_constants`: how a storage buffer says what a light is.
pub(crate) fn light_constants() -> String {
    let mut text = String::from("// How a storage buffer says what a light is; generated. No bindings.\n\n");
    for kind in LightKind::ALL {
        let name = kind.name().replace('-', "_").to_uppercase();
        text.push_str(&format!("const LIGHT_{name}: u32 = {}u;\n", kind as u32));
    }
    text.push_str(&format!("const LIGHT_TWO_SIDED: u32 = {TWO_SIDED}u;\nconst LIGHT_CAPS: u32 = {CAPS}u;\n"));
    text.push_str(&format!("const LIGHT_TEXTURED: u32 = {TEXTURED}u;\n"));
    text
}

/// The module `table_constants`: how a surface point says where its lobe is looked up.
pub(crate) fn table_constants() -> String {
    format!(
        "// Where a surface point's lobe is looked up; generated. No bindings.\n\n\
         const TABLE_ANISOTROPIC: u32 = {ANISOTROPIC_TABLE}u;\nconst TABLE_ISOTROPIC: u32 = {ISOTROPIC_TABLE}u;\n\
         const TABLE_FIRST_SLICE: u32 = {FIRST_SLICE}u;\n"
    )
}
