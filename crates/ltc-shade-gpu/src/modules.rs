//! The WGSL sources: modules of pure functions, entry points with bindings, and programs made of them.
//!
//! A program is the concatenation of an entry point and all modules it needs, each once, needed ones first. Module names
//! are file names in `src/shaders/`. Functions and types of the pure modules begin with `ltc_` and `Ltc`.

use crate::Filtering;

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

/// All modules.
pub const MODULES: &[Module] = &[
    module!(true, "math", []),
    module!(true, "frame", ["math"]),
    module!(true, "inverse", []),
    module!(true, "boundary", ["math", "inverse"]),
    module!(true, "polygon", ["math", "inverse", "boundary"]),
    module!(true, "fresnel", []),
    module!(true, "table", ["math"]),
    module!(true, "isotropic", ["math", "table"]),
    module!(true, "anisotropic", ["math", "table"]),
    module!(true, "fetch_exact", ["table", "isotropic", "anisotropic"]),
    module!(true, "fetch_hardware", ["table", "isotropic", "anisotropic"]),
    module!(false, "tables_exact", ["fetch_exact"]),
    module!(false, "tables_hardware", ["fetch_hardware"]),
    module!(false, "integrate_main", ["polygon"]),
    module!(false, "lookup_main", ["table"]),
    module!(false, "shade_main", ["frame", "polygon", "fresnel", "table"]),
];

/// What can be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// Polygons under lobes: entry points `quads` and `polygons`.
    Integrate,
    /// A batch of lookups: entry point `main`.
    Lookup(Filtering),
    /// Deferred shading: entry point `main`.
    Shade(Filtering),
}

impl Program {
    /// Every program there is.
    pub const ALL: [Self; 5] = [
        Self::Integrate,
        Self::Lookup(Filtering::Exact),
        Self::Lookup(Filtering::Hardware),
        Self::Shade(Filtering::Exact),
        Self::Shade(Filtering::Hardware),
    ];

    /// The modules to begin with; the rest follows from what they need.
    pub fn roots(self) -> &'static [&'static str] {
        match self {
            Self::Integrate => &["integrate_main"],
            Self::Lookup(Filtering::Exact) => &["tables_exact", "lookup_main"],
            Self::Lookup(Filtering::Hardware) => &["tables_hardware", "lookup_main"],
            Self::Shade(Filtering::Exact) => &["tables_exact", "shade_main"],
            Self::Shade(Filtering::Hardware) => &["tables_hardware", "shade_main"],
        }
    }

    /// The whole WGSL text.
    pub fn source(self) -> String {
        compose(self.roots())
    }
}

/// The text of the modules called `roots` and of all they need, each once, needed ones first. Names that are no
/// module's are left out.
pub fn compose(roots: &[&str]) -> String {
    let mut chosen: Vec<&Module> = Vec::new();
    for root in roots {
        gather(root, &mut chosen);
    }
    chosen.iter().map(|m| m.source).collect::<Vec<_>>().join("\n")
}

fn gather(name: &str, chosen: &mut Vec<&'static Module>) {
    if chosen.iter().any(|m| m.name == name) {
        return;
    }
    let Some(module) = MODULES.iter().find(|m| m.name == name) else { return };
    for needed in module.needs {
        gather(needed, chosen);
    }
    chosen.push(module);
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga;

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
            let expected =
                if program == Program::Integrate { vec!["quads", "polygons"] } else { vec!["main"] };
            assert_eq!(names, expected, "{program:?}");
        }
    }

    #[test]
    fn pure_modules_stand_on_what_they_say_they_need_and_bind_nothing() {
        for module in MODULES.iter().filter(|m| m.pure) {
            let ir = validate(&compose(&[module.name])).unwrap_or_else(|e| panic!("{}: {e}", module.name));
            assert!(ir.entry_points.is_empty() && ir.global_variables.is_empty(), "{}", module.name);
            for (_, function) in ir.functions.iter() {
                assert!(function.name.as_ref().is_some_and(|n| n.starts_with("ltc_")), "{function:?}");
            }
        }
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
