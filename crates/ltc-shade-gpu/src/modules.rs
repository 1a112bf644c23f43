//! The WGSL sources: modules of pure functions, entry points with bindings, and programs made of them.
//!
//! A program is the concatenation of an entry point and all modules it needs, each once, needed ones first. Module names
//! are file names in `src/shaders/`. Functions and types of the pure modules begin with `ltc_` and `Ltc`.

use crate::Filtering;
use crate::constants::{constants, light_constants, table_constants};

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

/// All modules that are files. Beside them there are `constants`, `light_constants` and `table_constants`, generated from Rust, and names
/// of which a program chooses what they stand for: `edge` for `edge_exact` or `edge_rational`, `quad` for `quad_careful` or `quad_lean`,
/// `fetch_filtered_anisotropic` for `fetch_hardware_anisotropic` or `fetch_refined_anisotropic`.
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
    module!(true, "quad_arcs", ["math", "lobe"]),
    module!(true, "quad_careful", ["boundary", "facing", "quad_arcs"]),
    module!(true, "quad_lean", ["math", "lobe", "quad_arcs"]),
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
    module!(true, "closed_form", ["constants", "table"]),
    module!(true, "fold", ["math", "table"]),
    module!(true, "anisotropic", ["table", "fold", "closed_form"]),
    module!(true, "baked", ["table", "fold", "closed_form"]),
    module!(true, "fetch_exact_layer", []),
    module!(true, "fetch_exact_isotropic", ["isotropic", "fetch_exact_layer"]),
    module!(true, "fetch_exact_entry", ["table"]),
    module!(true, "fetch_exact_anisotropic", ["anisotropic", "fetch_exact_entry"]),
    module!(true, "fetch_exact_baked", ["baked", "fetch_exact_layer"]),
    module!(true, "fetch_hardware_isotropic", ["isotropic"]),
    module!(true, "fetch_hardware_groups", ["table"]),
    module!(true, "fetch_hardware_anisotropic", ["anisotropic", "fetch_hardware_groups"]),
    module!(true, "fetch_hardware_baked", ["baked"]),
    module!(true, "fetch_refined_anisotropic", ["anisotropic", "fetch_exact_entry", "fetch_hardware_groups"]),
    module!(true, "fetch_function_isotropic", ["isotropic"]),
    module!(true, "fetch_function_anisotropic", ["anisotropic"]),
    module!(true, "fetch_function_baked", ["baked"]),
    module!(false, "tables_buffer", ["fetch_function_isotropic", "fetch_function_anisotropic"]),
    module!(false, "tables_exact", ["fetch_exact_isotropic", "fetch_exact_anisotropic"]),
    module!(false, "tables_hardware", ["fetch_hardware_isotropic", "fetch_filtered_anisotropic"]),
    module!(false, "baked_buffer", ["fetch_function_baked", "tables_buffer"]),
    module!(false, "baked_exact", ["fetch_exact_baked", "tables_exact"]),
    module!(false, "baked_hardware", ["fetch_hardware_baked", "tables_hardware"]),
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
    module!(false, "table_choice", ["table", "table_constants"]),
    module!(false, "lookup_main", ["table_choice"]),
    module!(false, "shade", ["lights", "fresnel", "table_choice"]),
    module!(false, "shade_main", ["shade"]),
    module!(false, "forward_main", ["shade"]),
];

/// What the programs of this crate are composed with.
const OWN_SYMBOLS: &[&str] = &["surface_horizon", "cosine_horizon", "two_sided"];

/// What a program has beside the two tables and lights of one colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Lights with textures among the lights.
    pub textured: bool,
    /// Baked slices to look into.
    pub baked: bool,
}

/// What can be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// Lights under lobes: entry point `main`.
    Integrate,
    /// Textured lights under lobes: entry point `main`.
    IntegrateTextured,
    /// A batch of lookups: entry point `main`.
    Lookup(Filtering, Extras),
    /// Deferred shading: entry point `main`.
    Shade(Filtering, Extras),
    /// Forward shading: entry points `vertex_main` and `fragment_main`.
    Forward(Filtering, Extras),
}

impl Program {
    /// Every program there is.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::Integrate, Self::IntegrateTextured];
        for filtering in [Filtering::Exact, Filtering::Hardware, Filtering::Refined, Filtering::Buffer] {
            for baked in [false, true] {
                all.push(Self::Lookup(filtering, Extras { textured: false, baked }));
                for textured in [false, true] {
                    let extras = Extras { textured, baked };
                    all.extend([Self::Shade(filtering, extras), Self::Forward(filtering, extras)]);
                }
            }
        }
        all
    }

    /// The modules to begin with; the rest follows from what they need.
    pub fn roots(self) -> Vec<&'static str> {
        let (main, filtering, extras) = match self {
            Self::Integrate => return vec!["integrate_main"],
            Self::IntegrateTextured => return vec!["integrate_textured_main"],
            Self::Lookup(filtering, extras) => ("lookup_main", filtering, extras),
            Self::Shade(filtering, extras) => ("shade_main", filtering, extras),
            Self::Forward(filtering, extras) => ("forward_main", filtering, extras),
        };
        let (tables, baked) = match filtering {
            Filtering::Exact => ("tables_exact", "baked_exact"),
            Filtering::Hardware | Filtering::Refined => ("tables_hardware", "baked_hardware"),
            Filtering::Buffer => ("tables_buffer", "baked_buffer"),
        };
        let mut roots = vec![if extras.baked { baked } else { tables }];
        roots.extend(extras.textured.then_some("light_textures"));
        roots.push(main);
        roots
    }

    /// The whole WGSL text.
    pub fn source(self) -> String {
        let (filtering, extras) = match self {
            Self::Lookup(filtering, extras)
            | Self::Shade(filtering, extras)
            | Self::Forward(filtering, extras) => (filtering, extras),
            Self::IntegrateTextured => (Filtering::Exact, Extras { textured: true, baked: false }),
            Self::Integrate => (Filtering::Exact, Extras::default()),
        };
        let mut symbols = OWN_SYMBOLS.to_vec();
        symbols.extend((filtering == Filtering::Refined).then_some("refined"));
        symbols.extend(extras.textured.then_some("light_textures"));
        symbols.extend(extras.baked.then_some("baked"));
        compose(&self.roots(), &symbols)
    }
}

/// The text of the modules called `roots` and of all they need, each once, needed ones first. Names that are no
/// module's are left out. Of `//#if WORD` … `//#else` … `//#endif` (or `//#ifnot WORD`) in a module, that part stays which
/// `symbols` asks for; `rational_edges`, `lean_lights` and `refined` choose what `edge`, `quad` and
/// `fetch_filtered_anisotropic` stand for.
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
        "fetch_filtered_anisotropic" if symbols.contains(&"refined") => "fetch_refined_anisotropic",
        "fetch_filtered_anisotropic" => "fetch_hardware_anisotropic",
        "quad" if symbols.contains(&"lean_lights") => "quad_lean",
        "quad" => "quad_careful",
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

const GENERATED: [&str; 3] = ["constants", "light_constants", "table_constants"];

fn text(name: &str, symbols: &[&str]) -> String {
    match name {
        "constants" => constants(),
        "light_constants" => light_constants(),
        "table_constants" => table_constants(),
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
        for program in Program::all() {
            let module = validate(&program.source()).unwrap_or_else(|e| panic!("{program:?}: {e}"));
            let names: Vec<_> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
            let forward = matches!(program, Program::Forward(..));
            let expected = if forward { vec!["vertex_main", "fragment_main"] } else { vec!["main"] };
            assert_eq!(names, expected, "{program:?}");
        }
    }

    /// What a host brings where a table comes out of a function.
    const HOST: &str = "
        fn ltc_isotropic_texel(entry: u32, group: u32) -> vec4f { return vec4f(f32(entry), f32(group), 0.0, 0.0); }
        fn ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f { return vec4f(f32(entry), f32(group), 0.0, 0.0); }
        fn ltc_baked_texel(entry: u32, group: u32) -> vec4f { return vec4f(f32(entry), f32(group), 0.0, 0.0); }";

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
        for program in Program::all() {
            let ir = validate(&program.source()).unwrap();
            let is_array = |ty| matches!(ir.types[ty].inner, naga::TypeInner::Array { .. });
            let all = ir.functions.iter().map(|f| f.1).chain(ir.entry_points.iter().map(|e| &e.function));
            for function in all {
                assert!(!function.local_variables.iter().any(|v| is_array(v.1.ty)), "{:?}", function.name);
            }
        }
    }
}
