//! The WGSL sources: modules of pure functions, entry points with bindings, and programs made of them.
//!
//! A program is the concatenation of an entry point and all modules it needs, each once, needed ones first. Module names
//! are file names in `src/shaders/`. Functions and types of the pure modules begin with `ltc_` and `Ltc`.

use crate::Filtering;
use crate::constants::{constants, light_constants};

/// One WGSL file.
#[derive(Clone, Copy, Debug)]
pub struct Module {
    /// Its file name without `.wgsl`.
    pub name: &'static str,
    /// Its text.
    pub source: &'static str,
    /// The modules whose functions it calls.
    pub needs: &'static [&'static str],
    /// Whether it has neither bindings nor entry points.
    pub pure: bool,
}

macro_rules! module {
    ($pure:literal, $name:literal, [$($needs:literal),*]) => {
        Module {
            name: $name,
            source: include_str!(concat!("shaders/", $name, ".wgsl")),
            needs: &[$($needs),*],
            pure: $pure,
        }
    };
}

/// All modules that are files. Beside them there are `constants` and `light_constants`, generated from Rust, and `edge`,
/// which stands for `edge_exact` or `edge_rational`.
pub const MODULES: &[Module] = &[
    module!(true, "math", []),
    module!(true, "precise", []),
    module!(true, "frame", ["math"]),
    module!(true, "lobe", ["math", "precise"]),
    module!(true, "edge_exact", ["math"]),
    module!(true, "edge_rational", ["math"]),
    module!(true, "boundary", ["math", "precise", "lobe", "edge"]),
    module!(true, "facing", ["math", "precise"]),
    module!(true, "polygon", ["boundary", "facing"]),
    module!(true, "quad", ["boundary", "facing"]),
    module!(true, "segment", ["math", "precise", "lobe"]),
    module!(true, "line", ["segment"]),
    module!(true, "line_caps", ["line"]),
    module!(true, "strip", ["segment", "facing"]),
    module!(true, "cone", ["math", "precise"]),
    module!(true, "cone_arc", ["math"]),
    module!(true, "cone_region", ["math", "cone_arc"]),
    module!(true, "cone_light", ["math", "lobe", "cone", "cone_region"]),
    module!(true, "ellipse", ["facing", "cone_light"]),
    module!(true, "disk", ["frame", "facing", "cone_light"]),
    module!(true, "sphere", ["precise", "frame", "cone_light"]),
    module!(true, "cylinder", ["precise", "frame", "boundary", "cone_light"]),
    module!(true, "textured", ["math", "precise", "lobe"]),
    module!(true, "fresnel", []),
    module!(true, "material", ["constants"]),
    module!(true, "table", ["math", "constants"]),
    module!(true, "isotropic", ["table"]),
    module!(true, "anisotropic", ["table"]),
    module!(true, "fetch_exact_isotropic", ["isotropic"]),
    module!(true, "fetch_exact_anisotropic", ["anisotropic"]),
    module!(true, "fetch_hardware_isotropic", ["isotropic"]),
    module!(true, "fetch_hardware_anisotropic", ["anisotropic"]),
    module!(true, "fetch_function_isotropic", ["isotropic"]),
    module!(true, "fetch_function_anisotropic", ["anisotropic"]),
    module!(false, "tables_buffer", ["fetch_function_isotropic", "fetch_function_anisotropic"]),
    module!(false, "tables_exact", ["fetch_exact_isotropic", "fetch_exact_anisotropic"]),
    module!(false, "tables_hardware", ["fetch_hardware_isotropic", "fetch_hardware_anisotropic"]),
    module!(
        false,
        "lights",
        [
            "light_constants",
            "frame",
            "quad",
            "polygon",
            "line_caps",
            "strip",
            "cylinder",
            "disk",
            "ellipse",
            "sphere"
        ]
    ),
    module!(false, "light_textures", ["lights", "textured"]),
    module!(false, "integrate_main", ["lights"]),
    module!(false, "integrate_textured_main", ["light_textures"]),
    module!(false, "lookup_main", ["table"]),
    module!(false, "shade", ["lights", "fresnel", "table"]),
    module!(false, "shade_main", ["shade"]),
    module!(false, "forward_main", ["shade"]),
];

/// What the programs of this crate are composed with.
const OWN_SYMBOLS: &[&str] = &["surface_horizon", "cosine_horizon", "two_sided"];
/// The same with textures of lights.
const TEXTURED_SYMBOLS: &[&str] = &["surface_horizon", "cosine_horizon", "two_sided", "light_textures"];

/// What can be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// Lights under lobes: entry point `main`.
    Integrate,
    /// A batch of lookups: entry point `main`.
    Lookup(Filtering),
    /// Deferred shading: entry point `main`.
    Shade(Filtering),
    /// Forward shading: entry points `vertex_main` and `fragment_main`.
    Forward(Filtering),
    /// Textured lights under lobes: entry point `main`.
    IntegrateTextured,
    /// As `Shade`, for lights with textures among others.
    ShadeTextured(Filtering),
    /// As `Forward`, for lights with textures among others.
    ForwardTextured(Filtering),
}

impl Program {
    /// Every program there is.
    pub const ALL: [Self; 17] = [
        Self::Integrate,
        Self::Lookup(Filtering::Exact),
        Self::Lookup(Filtering::Hardware),
        Self::Shade(Filtering::Exact),
        Self::Shade(Filtering::Hardware),
        Self::Forward(Filtering::Exact),
        Self::Forward(Filtering::Hardware),
        Self::Lookup(Filtering::Buffer),
        Self::Shade(Filtering::Buffer),
        Self::Forward(Filtering::Buffer),
        Self::IntegrateTextured,
        Self::ShadeTextured(Filtering::Exact),
        Self::ShadeTextured(Filtering::Hardware),
        Self::ShadeTextured(Filtering::Buffer),
        Self::ForwardTextured(Filtering::Exact),
        Self::ForwardTextured(Filtering::Hardware),
        Self::ForwardTextured(Filtering::Buffer),
    ];

    /// The modules to begin with; the rest follows from what they need.
    pub fn roots(self) -> &'static [&'static str] {
        match self {
            Self::Integrate => &["integrate_main"],
            Self::Lookup(Filtering::Buffer) => &["tables_buffer", "lookup_main"],
            Self::Shade(Filtering::Buffer) => &["tables_buffer", "shade_main"],
            Self::Forward(Filtering::Buffer) => &["tables_buffer", "forward_main"],
            Self::Lookup(Filtering::Exact) => &["tables_exact", "lookup_main"],
            Self::Lookup(Filtering::Hardware) => &["tables_hardware", "lookup_main"],
            Self::Shade(Filtering::Exact) => &["tables_exact", "shade_main"],
            Self::Shade(Filtering::Hardware) => &["tables_hardware", "shade_main"],
            Self::Forward(Filtering::Exact) => &["tables_exact", "forward_main"],
            Self::Forward(Filtering::Hardware) => &["tables_hardware", "forward_main"],
            Self::IntegrateTextured => &["integrate_textured_main"],
            Self::ShadeTextured(Filtering::Buffer) => &["tables_buffer", "light_textures", "shade_main"],
            Self::ShadeTextured(Filtering::Exact) => &["tables_exact", "light_textures", "shade_main"],
            Self::ShadeTextured(Filtering::Hardware) => &["tables_hardware", "light_textures", "shade_main"],
            Self::ForwardTextured(Filtering::Buffer) => &["tables_buffer", "light_textures", "forward_main"],
            Self::ForwardTextured(Filtering::Exact) => &["tables_exact", "light_textures", "forward_main"],
            Self::ForwardTextured(Filtering::Hardware) => {
                &["tables_hardware", "light_textures", "forward_main"]
            }
        }
    }

    /// The whole WGSL text.
    pub fn source(self) -> String {
        let textured =
            matches!(self, Self::IntegrateTextured | Self::ShadeTextured(_) | Self::ForwardTextured(_));
        compose(self.roots(), if textured { TEXTURED_SYMBOLS } else { OWN_SYMBOLS })
    }
}

/// The text of the modules called `roots` and of all they need, each once, needed ones first. Names that are no
/// module's are left out. Of `//#if WORD` … `//#else` … `//#endif` (or `//#ifnot WORD`) in a module, that part stays which
/// `symbols` asks for; `rational_edges` also chooses the form of `edge`.
pub fn compose(roots: &[&str], symbols: &[&str]) -> String {
    let mut chosen = Vec::new();
    for root in roots {
        gather(root, symbols, &mut chosen);
    }
    let texts: Vec<String> = chosen.iter().map(|name| text(name, symbols)).collect();
    texts.join("\n")
}

/// What `name` stands for.
fn resolve<'a>(name: &'a str, symbols: &[&str]) -> &'a str {
    match name {
        "edge" if symbols.contains(&"rational_edges") => "edge_rational",
        "edge" => "edge_exact",
        other => other,
    }
}

fn gather<'a>(name: &'a str, symbols: &[&str], chosen: &mut Vec<&'a str>) {
    let name = resolve(name, symbols);
    if chosen.contains(&name) {
        return;
    }
    let module = MODULES.iter().find(|m| m.name == name);
    if module.is_none() && !GENERATED.contains(&name) {
        return;
    }
    for needed in module.map_or(&[][..], |m| m.needs) {
        gather(needed, symbols, chosen);
    }
    chosen.push(name);
}

const GENERATED: [&str; 2] = ["constants", "light_constants"];

fn text(name: &str, symbols: &[&str]) -> String {
    match name {
        "constants" => constants(),
        "light_constants" => light_constants(),
        _ => MODULES.iter().find(|m| m.name == name).map_or_else(String::new, |m| select(m.source, symbols)),
    }
}

/// The lines that remain of a module's text.
fn select(source: &str, symbols: &[&str]) -> String {
    // For each `//#if` that is open, whether its lines stay.
    let mut open: Vec<bool> = Vec::new();
    let mut kept = String::new();
    for line in source.lines() {
        let has = |word: &str| symbols.contains(&word.trim());
        if let Some(word) = line.trim().strip_prefix("//#ifnot ") {
            open.push(!has(word));
        } else if let Some(word) = line.trim().strip_prefix("//#if ") {
            open.push(has(word));
        } else if line.trim() == "//#else" {
            if let Some(last) = open.last_mut() {
                *last = !*last;
            }
        } else if line.trim() == "//#endif" {
            open.pop();
        } else if open.iter().all(|stays| *stays) {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}

#[cfg(test)]
#[cfg(feature = "export")]
mod tests {
    use super::*;
    use crate::{LightKind, ShaderRequest};

    fn validate(source: &str) -> Result<naga::Module, String> {
        let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::empty(),
        );
        validator.validate(&module).map_err(|e| e.emit_to_string(source))?;
        Ok(module)
    }

    #[test]
    fn every_program_is_valid_and_has_its_entry_points() {
        for program in Program::ALL {
            let module = validate(&program.source()).unwrap_or_else(|e| panic!("{program:?}: {e}"));
            let names: Vec<_> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
            let forward = matches!(program, Program::Forward(_) | Program::ForwardTextured(_));
            let expected = if forward { vec!["vertex_main", "fragment_main"] } else { vec!["main"] };
            assert_eq!(names, expected, "{program:?}");
        }
    }

    /// What a host brings where a table comes out of a function.
    const HOST: &str = "
        fn ltc_isotropic_texel(entry: u32, group: u32) -> vec4f { return vec4f(f32(entry), f32(group), 0.0, 0.0); }
        fn ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f { return vec4f(f32(entry), f32(group), 0.0, 0.0); }";

    fn assert_pure(source: &str, what: &str) {
        let ir = validate(&format!("{source}{HOST}")).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert!(ir.entry_points.is_empty() && ir.global_variables.is_empty(), "{what}");
        for (_, function) in ir.functions.iter() {
            assert!(function.name.as_ref().is_some_and(|n| n.starts_with("ltc_")), "{function:?}");
        }
    }

    #[test]
    fn pure_modules_stand_on_what_they_say_they_need_and_bind_nothing() {
        for module in MODULES.iter().filter(|m| m.pure) {
            for symbols in [OWN_SYMBOLS, &[]] {
                assert_pure(&compose(&[module.name], symbols), module.name);
            }
        }
    }

    #[test]
    fn every_permutation_is_valid_and_holds_what_was_asked_for_alone() {
        let all = ShaderRequest::permutations();
        assert!(all.len() > 160);
        for request in all {
            let source = request.wgsl();
            assert_pure(&source, &format!("{request:?}"));
            assert!(!source.contains("//#"), "{request:?}");
            for light in LightKind::ALL {
                let name = format!("fn ltc_{}(", light.name().replace('-', "_"));
                // Caps are added to the line.
                let by_need = light == LightKind::Line && request.lights.contains(&LightKind::LineWithCaps);
                let asked = request.lights.contains(&light) || by_need;
                assert_eq!(source.contains(&name), asked, "{light}: {request:?}");
            }
        }
    }

    #[test]
    fn conditions_nest_and_turn_round() {
        let source = "a\n//#if x\nb\n//#if y\nc\n//#else\nd\n//#endif\n//#else\ne\n//#endif\n//#ifnot y\nf\n//#endif\n";
        assert_eq!(select(source, &[]), "a\ne\nf\n");
        assert_eq!(select(source, &["x"]), "a\nb\nd\nf\n");
        assert_eq!(select(source, &["x", "y"]), "a\nb\nc\n");
        assert_eq!(select(source, &["y"]), "a\ne\n");
    }

    #[test]
    fn a_missing_module_is_noticed() {
        // The control of the tests above: without boundary.wgsl, polygon.wgsl does not validate.
        let alone = MODULES.iter().find(|m| m.name == "polygon").unwrap();
        assert!(validate(alone.source).is_err());
    }

    #[test]
    fn no_array_of_vertices_is_indexed() {
        // A function-local array would be indexed dynamically and spilled to memory by most drivers.
        for program in Program::ALL {
            let ir = validate(&program.source()).unwrap();
            let is_array = |ty| matches!(ir.types[ty].inner, naga::TypeInner::Array { .. });
            let all = ir.functions.iter().map(|f| f.1).chain(ir.entry_points.iter().map(|e| &e.function));
            for function in all {
                assert!(!function.local_variables.iter().any(|v| is_array(v.1.ty)), "{:?}", function.name);
            }
        }
    }
}
