//! WGSL of what is timed, composed of the shipped modules, or of the published forms beside them, and the scene.

use ltc_shade_gpu::modules::compose;
use ltc_shade_gpu::{Filtering, LightKind};

const SCENE: &str = include_str!("wgsl/scene.wgsl");
const LOBE: &str = include_str!("wgsl/lobe.wgsl");
const PUBLISHED_LOBE: &str = include_str!("wgsl/published_lobe.wgsl");
const PUBLISHED_EDGE: &str = include_str!("wgsl/published_edge.wgsl");
/// What every form does beside its work.
pub const EMPTY: &str = concat!(include_str!("wgsl/scene.wgsl"), include_str!("wgsl/pixel_empty.wgsl"));
/// What takes as long as the device is slow.
pub const YARDSTICK: &str = concat!(include_str!("wgsl/scene.wgsl"), include_str!("wgsl/yardstick.wgsl"));

/// Both horizons: what the crate's own programs clip by.
pub const BOTH_HORIZONS: &[&str] = &["surface_horizon", "cosine_horizon"];

/// Where a pixel's lobe comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Find {
    /// The scene's formula: no table.
    Formula,
    /// A table for isotropic materials.
    Isotropic(Filtering),
    /// A table for anisotropic ones.
    Anisotropic(Filtering),
    /// A slice of a table for anisotropic ones, of the pixel's block.
    Baked(Filtering),
    /// The same arithmetic as `Filtering::Buffer` on texels that are computed: what is left without fetches.
    IsotropicArithmetic,
    /// Likewise.
    AnisotropicArithmetic,
    /// The scene's formula, as published shaders have a lobe.
    PublishedFormula,
    /// Two 2D fetches.
    PublishedIsotropic,
    /// Six 3D fetches and an inversion.
    PublishedAnisotropic,
}

/// Texels out of arithmetic: a lobe for every entry.
const COMPUTED_TEXELS: &str = "
fn timed_texel(entry: u32, group: u32) -> vec4f {
    let x = 0.3 + 0.001 * f32(entry & 63u);
    return select(vec4f(1.0, x, x, 0.0), select(vec4f(x, 0.0, 0.1, 0.0), vec4f(x, 0.0, -0.1, 0.0), group == 1u), group < 2u);
}
fn ltc_isotropic_texel(entry: u32, group: u32) -> vec4f { return timed_texel(entry, group); }
fn ltc_anisotropic_texel(entry: u32, group: u32) -> vec4f {
    return timed_texel(entry, group) + select(vec4f(0.0), vec4f(0.0, 0.0, 0.0, 1.0), group == 2u);
}
@group(1) @binding(3) var<uniform> timed_axes: LtcAxes;
";

/// The block that a point of the floor is in.
const SLICE: &str = "
fn timed_slice(position: vec3f) -> u32 {
    let place = vec2f(position.x * 9.0 / 16.0 + 1.0, 1.0 - position.y) * vec2f(4.0, 4.5);
    let block = min(vec2u(place), vec2u(7u, 8u));
    return block.x + 8u * block.y;
}
";

impl Find {
    fn is_published(self) -> bool {
        matches!(self, Self::PublishedFormula | Self::PublishedIsotropic | Self::PublishedAnisotropic)
    }

    /// The modules that it stands on.
    fn modules(self) -> &'static [&'static str] {
        match self {
            Self::Isotropic(filtering) | Self::Anisotropic(filtering) => match filtering {
                Filtering::Exact => &["tables_exact", "lobe"],
                Filtering::Hardware | Filtering::Refined => &["tables_hardware", "lobe"],
                Filtering::Buffer => &["tables_buffer", "lobe"],
            },
            Self::Baked(filtering) => match filtering {
                Filtering::Exact => &["baked_exact", "lobe"],
                Filtering::Hardware | Filtering::Refined => &["baked_hardware", "lobe"],
                Filtering::Buffer => &["baked_buffer", "lobe"],
            },
            Self::Formula => &["lobe"],
            Self::IsotropicArithmetic => &["fetch_function_isotropic", "lobe"],
            Self::AnisotropicArithmetic => &["fetch_function_anisotropic", "lobe"],
            _ => &[],
        }
    }

    /// What they are composed with.
    fn symbols(self) -> &'static [&'static str] {
        if self == Self::Anisotropic(Filtering::Refined) { &["refined"] } else { &[] }
    }

    fn text(self) -> String {
        let ours = |found: &str| {
            format!(
                "{LOBE}\nfn timed_find(p: TimedPixel) -> TimedFound {{\n    let found = {found};\n    return TimedFound(ltc_lobe(found.m), timed_reflectance(found.magnitude, found.fresnel));\n}}\n"
            )
        };
        let published = |text: &str| format!("{PUBLISHED_LOBE}\n{text}");
        match self {
            Self::Formula => format!(
                "{LOBE}\nfn timed_find(p: TimedPixel) -> TimedFound {{ return TimedFound(ltc_lobe(timed_matrix(p)), 1.0); }}\n"
            ),
            Self::Isotropic(_) => ours("lookup_isotropic(p.wo, p.alpha_x)"),
            Self::Anisotropic(_) => ours("lookup_anisotropic(p.wo, p.alpha_x, p.alpha_y)"),
            Self::Baked(_) => {
                format!(
                    "{SLICE}{}",
                    ours("lookup_baked(p.wo, p.alpha_x, p.alpha_y, timed_slice(p.position))")
                )
            }
            Self::IsotropicArithmetic => {
                format!("{COMPUTED_TEXELS}{}", ours("ltc_lookup_isotropic(timed_axes, p.wo, p.alpha_x)"))
            }
            Self::AnisotropicArithmetic => format!(
                "{COMPUTED_TEXELS}{}",
                ours("ltc_lookup_anisotropic(timed_axes, p.wo, p.alpha_x, p.alpha_y)")
            ),
            Self::PublishedFormula => published(include_str!("wgsl/published_formula.wgsl")),
            Self::PublishedIsotropic => published(include_str!("wgsl/published_isotropic.wgsl")),
            Self::PublishedAnisotropic => published(include_str!("wgsl/published_anisotropic.wgsl")),
        }
    }
}

/// How a light is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrate {
    /// The shipped function, composed with these symbols.
    Shipped(LightKind, &'static [&'static str]),
    /// The shipped function behind a switch over all kinds, every feature present.
    AllKinds,
    /// 2016: clipped by cases, rational edges.
    PublishedQuad,
    /// The sphere instead of a clip.
    PublishedProxy,
    /// 2017.
    PublishedLine,
}

/// `timed_fraction` for each kind; what is subtracted brings points to the pixel.
fn fraction(kind: LightKind) -> (&'static str, &'static str) {
    match kind {
        LightKind::Quad => (
            "quad",
            "return ltc_quad(lobe, timed_points[4u * light].xyz - position, timed_points[4u * light + 1u].xyz - position,
        timed_points[4u * light + 2u].xyz - position, timed_points[4u * light + 3u].xyz - position);",
        ),
        LightKind::Polygon => (
            "polygon",
            "var polygon = ltc_polygon(lobe, timed_points[6u * light].xyz - position);
    for (var i = 1u; i < 6u; i++) {
        ltc_polygon_push(&polygon, lobe, timed_points[6u * light + i].xyz - position);
    }
    return ltc_polygon_fraction(&polygon, lobe);",
        ),
        LightKind::Line => ("line", "return ltc_line(lobe, a.xyz - position, b.xyz - position, a.w);"),
        LightKind::LineWithCaps => {
            ("line_caps", "return ltc_line_with_caps(lobe, a.xyz - position, b.xyz - position, a.w);")
        }
        LightKind::Strip => {
            ("strip", "return ltc_strip(lobe, a.xyz - position, b.xyz - position, a.w, c.xyz);")
        }
        LightKind::Cylinder => {
            ("cylinder", "return ltc_cylinder(lobe, a.xyz - position, b.xyz - position, a.w, true);")
        }
        LightKind::Disk => ("disk", "return ltc_disk(lobe, a.xyz - position, b.xyz, a.w);"),
        LightKind::Ellipse => ("ellipse", "return ltc_ellipse(lobe, a.xyz - position, b.xyz, c.xyz);"),
        LightKind::Sphere => ("sphere", "return ltc_sphere(lobe, a.xyz - position, a.w);"),
    }
}

/// Points of the buffer that a light of this kind takes.
fn stride(kind: LightKind) -> u32 {
    match kind {
        LightKind::Polygon => 6,
        LightKind::Quad => 4,
        LightKind::Strip | LightKind::Ellipse => 3,
        LightKind::Line | LightKind::LineWithCaps | LightKind::Cylinder | LightKind::Disk => 2,
        LightKind::Sphere => 1,
    }
}

const ALL_KINDS: &str = "
@group(1) @binding(3) var<storage, read> timed_records: array<LightRecord>;
@group(1) @binding(4) var<storage, read> light_vertices: array<vec4f>;

fn timed_fraction(lobe: LtcLobe, position: vec3f, light: u32) -> f32 {
    let frame = LtcFrame(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0));
    return light_fraction(lobe, light_in_frame(timed_records[light], frame, position), frame, position);
}
";

impl Integrate {
    fn modules(self) -> Vec<&'static str> {
        match self {
            Self::Shipped(kind, _) => vec![fraction(kind).0],
            Self::AllKinds => vec!["lights"],
            _ => Vec::new(),
        }
    }

    fn symbols(self) -> &'static [&'static str] {
        match self {
            Self::Shipped(_, symbols) => symbols,
            Self::AllKinds => &["surface_horizon", "cosine_horizon", "two_sided"],
            _ => &[],
        }
    }

    fn text(self) -> String {
        match self {
            Self::Shipped(kind, _) => {
                let n = stride(kind);
                let loads: String = ["a", "b", "c"]
                    .iter()
                    .enumerate()
                    .take(if n <= 3 { n as usize } else { 0 })
                    .map(|(i, name)| format!("    let {name} = timed_points[{n}u * light + {i}u];\n"))
                    .collect();
                format!(
                    "fn timed_fraction(lobe: LtcLobe, position: vec3f, light: u32) -> f32 {{\n{loads}    {}\n}}\n",
                    fraction(kind).1
                )
            }
            Self::AllKinds => ALL_KINDS.to_owned(),
            Self::PublishedQuad => format!("{PUBLISHED_EDGE}\n{}", include_str!("wgsl/published_quad.wgsl")),
            Self::PublishedProxy => {
                format!("{PUBLISHED_EDGE}\n{}", include_str!("wgsl/published_proxy.wgsl"))
            }
            Self::PublishedLine => include_str!("wgsl/published_line.wgsl").to_owned(),
        }
    }
}

/// A lookup alone, and the inverse that lights need.
pub fn lookup(find: Find) -> String {
    let modules = compose(find.modules(), find.symbols());
    format!("{modules}\n{SCENE}\n{}\n{}", find.text(), include_str!("wgsl/pixel_lookup.wgsl"))
}

/// A lobe and lights under it.
pub fn lights(find: Find, integrate: Integrate) -> String {
    debug_assert!(find.is_published() || !matches!(integrate, Integrate::PublishedQuad), "{find:?}");
    let mut roots = find.modules().to_vec();
    roots.extend(integrate.modules());
    let modules = compose(&roots, &[find.symbols(), integrate.symbols()].concat());
    format!(
        "{modules}\n{SCENE}\n{}\n{}\n{}",
        find.text(),
        integrate.text(),
        include_str!("wgsl/pixel_lights.wgsl")
    )
}
