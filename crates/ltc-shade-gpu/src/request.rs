//! What an engine asks of a shader, and the text with just that in it.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use crate::modules::compose;

/// A kind of light that the shaders know. The numbers are those of storage buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LightKind {
    /// `ltc_quad`
    Quad,
    /// `ltc_polygon`, `ltc_polygon_push`, `ltc_polygon_fraction`
    Polygon,
    /// `ltc_line`: a thin cylinder without caps
    Line,
    /// `ltc_line_with_caps`
    LineWithCaps,
    /// `ltc_strip`
    Strip,
    /// `ltc_cylinder`: of any width, with caps or without
    Cylinder,
    /// `ltc_disk`
    Disk,
    /// `ltc_ellipse`
    Ellipse,
    /// `ltc_sphere`
    Sphere,
}

impl LightKind {
    /// Every kind there is.
    pub const ALL: [Self; 9] = [
        Self::Quad,
        Self::Polygon,
        Self::Line,
        Self::LineWithCaps,
        Self::Strip,
        Self::Cylinder,
        Self::Disk,
        Self::Ellipse,
        Self::Sphere,
    ];

    /// The name in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quad => "quad",
            Self::Polygon => "polygon",
            Self::Line => "line",
            Self::LineWithCaps => "line-with-caps",
            Self::Strip => "strip",
            Self::Cylinder => "cylinder",
            Self::Disk => "disk",
            Self::Ellipse => "ellipse",
            Self::Sphere => "sphere",
        }
    }

    /// The module that holds it.
    fn module(self) -> &'static str {
        match self {
            Self::LineWithCaps => "line_caps",
            other => other.name(),
        }
    }
}

/// A choice beyond the lights themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// Lookup in a table for isotropic materials.
    Isotropic,
    /// Lookup in a table for anisotropic materials.
    Anisotropic,
    /// Lookup in slices of a table for anisotropic materials, each baked for one pair of widths: a quarter of the fetches, for
    /// materials whose widths do not change from point to point.
    Baked,
    /// Lookups by the texture unit, in fewer fetches and to its precision; without, by the shader in full. Of no effect with
    /// [`Feature::FunctionTables`].
    HardwareFiltering,
    /// With [`Feature::HardwareFiltering`]: the anisotropic table has more nodes along λ, of which the nearest is taken, and the
    /// texture unit interpolates all else: half the fetches, lobes off by half a step of λ at most ([`crate::Filtering::Refined`]).
    Refined,
    /// Lookups call `ltc_isotropic_texel`, `ltc_anisotropic_texel` or `ltc_baked_texel`, which the host defines: over a storage buffer or
    /// whatever else holds a table where there are no float textures.
    FunctionTables,
    /// Lights are cut by the surface's horizon. Without, those below it leak into tilted lobes.
    SurfaceHorizon,
    /// Lights are cut by the horizon of cosine space. Without, what lies below it counts negatively.
    CosineHorizon,
    /// Flat lights take a parameter that says whether their back emits, too.
    TwoSided,
    /// Angles of edges by a rational function instead of an arc tangent.
    RationalEdges,
    /// Quads, lines and strips in straight code alone, without branches for what is rare: cut by the same horizons and as exact in
    /// absolute terms, quads for convex ones. Tiny quads and lines seen along themselves keep fewer digits, and a shading point in a
    /// quad's plane is given what one of its sides sees, or nothing.
    LeanLights,
    /// The colour of textured quads and polygons, out of one texture that holds all of theirs ([`crate::TextureAtlas`]).
    Textured,
    /// Schlick's Fresnel term from F0 and F90 and a table's two channels.
    Fresnel,
    /// glTF's metallic-roughness parameters, anisotropy included.
    Material,
    /// The shading frame from normal and tangent.
    Frame,
}

impl Feature {
    /// Every feature there is.
    pub const ALL: [Self; 15] = [
        Self::Isotropic,
        Self::Anisotropic,
        Self::Baked,
        Self::HardwareFiltering,
        Self::Refined,
        Self::FunctionTables,
        Self::SurfaceHorizon,
        Self::CosineHorizon,
        Self::TwoSided,
        Self::RationalEdges,
        Self::LeanLights,
        Self::Textured,
        Self::Fresnel,
        Self::Material,
        Self::Frame,
    ];

    /// Those that look into a table.
    pub const LOOKUPS: [Self; 3] = [Self::Isotropic, Self::Anisotropic, Self::Baked];

    /// The name in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Anisotropic => "anisotropic",
            Self::Baked => "baked",
            Self::HardwareFiltering => "hardware-filtering",
            Self::Refined => "refined",
            Self::FunctionTables => "function-tables",
            Self::SurfaceHorizon => "surface-horizon",
            Self::CosineHorizon => "cosine-horizon",
            Self::TwoSided => "two-sided",
            Self::RationalEdges => "rational-edges",
            Self::LeanLights => "lean-lights",
            Self::Textured => "textured",
            Self::Fresnel => "fresnel",
            Self::Material => "material",
            Self::Frame => "frame",
        }
    }
}

impl Feature {
    /// What it brings, in a few words.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Isotropic => "lookup in a table for isotropic materials",
            Self::Anisotropic => "lookup in a table for anisotropic materials",
            Self::Baked => "lookup in slices of an anisotropic table, each baked for one pair of widths",
            Self::HardwareFiltering => "lookups by the texture unit, faster and to its precision",
            Self::Refined => {
                "with hardware-filtering, an anisotropic table of finer lambda: half the fetches"
            }
            Self::FunctionTables => "lookups call a function of yours for each texel, over any memory",
            Self::SurfaceHorizon => "cuts lights at the surface's horizon: nothing leaks from below",
            Self::CosineHorizon => "cuts lights at the horizon of cosine space",
            Self::TwoSided => "flat lights take a parameter that says whether their back emits",
            Self::RationalEdges => "angles of edges by a rational function instead of an arc tangent",
            Self::LeanLights => {
                "convex quads by one short loop: as exact in absolute terms, fewer digits of tiny ones"
            }
            Self::Textured => "the colour of textured quads and polygons, from one texture for all",
            Self::Fresnel => "reflectance from F0, F90 and a table's two channels",
            Self::Material => "glTF's metallic-roughness parameters, with anisotropy",
            Self::Frame => "the shading frame from normal and tangent",
        }
    }
}

impl fmt::Display for LightKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no light or feature has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {what} is called \"{name}\"; there are {known}")]
pub struct UnknownName {
    /// `light` or `feature`.
    pub what: &'static str,
    /// What was asked for.
    pub name: String,
    /// What there is, with commas.
    pub known: String,
}

pub(crate) fn by_name<T: Copy + fmt::Display>(
    what: &'static str,
    all: &[T],
    name: &str,
) -> Result<T, UnknownName> {
    all.iter().find(|item| item.to_string() == name).copied().ok_or_else(|| UnknownName {
        what,
        name: name.to_owned(),
        known: all.iter().map(T::to_string).collect::<Vec<_>>().join(", "),
    })
}

impl FromStr for LightKind {
    type Err = UnknownName;
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("light", &Self::ALL, name)
    }
}

impl FromStr for Feature {
    type Err = UnknownName;
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("feature", &Self::ALL, name)
    }
}

/// What an engine wants of the shading functions.
///
/// ```
/// use ltc_shade_gpu::{Feature, LightKind, ShaderRequest};
/// let request = ShaderRequest::new([LightKind::Quad], [Feature::Isotropic, Feature::SurfaceHorizon]);
/// let wgsl = request.wgsl();
/// assert!(wgsl.contains("fn ltc_quad(") && wgsl.contains("fn ltc_isotropic_decode("));
/// assert!(!wgsl.contains("fn ltc_disk(") && !wgsl.contains("anisotropic_decode"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderRequest {
    /// The lights.
    pub lights: BTreeSet<LightKind>,
    /// The features.
    pub features: BTreeSet<Feature>,
}

impl ShaderRequest {
    /// A request for these.
    pub fn new(
        lights: impl IntoIterator<Item = LightKind>,
        features: impl IntoIterator<Item = Feature>,
    ) -> Self {
        Self { lights: lights.into_iter().collect(), features: features.into_iter().collect() }
    }

    pub(crate) fn has(&self, feature: Feature) -> bool {
        self.features.contains(&feature)
    }

    /// Whether it looks into a table of finer λ.
    #[cfg(feature = "export")]
    pub(crate) fn is_refined(&self) -> bool {
        self.has(Feature::Refined)
            && self.has(Feature::HardwareFiltering)
            && !self.has(Feature::FunctionTables)
    }

    /// Whether it looks into a table.
    #[cfg(feature = "export")]
    pub(crate) fn looks_up(&self) -> bool {
        Feature::LOOKUPS.into_iter().any(|feature| self.has(feature))
    }

    /// Whether it brings no function at all.
    pub fn is_empty(&self) -> bool {
        self.roots().is_empty()
    }

    /// The modules to begin with.
    pub(crate) fn roots(&self) -> Vec<&'static str> {
        let mut roots = Vec::new();
        let way = match (self.has(Feature::FunctionTables), self.has(Feature::HardwareFiltering)) {
            (true, _) => 2,
            (false, true) => 1,
            (false, false) => 0,
        };
        for (feature, fetches) in [
            (
                Feature::Isotropic,
                ["fetch_exact_isotropic", "fetch_hardware_isotropic", "fetch_function_isotropic"],
            ),
            (
                Feature::Anisotropic,
                ["fetch_exact_anisotropic", "fetch_filtered_anisotropic", "fetch_function_anisotropic"],
            ),
            (Feature::Baked, ["fetch_exact_baked", "fetch_hardware_baked", "fetch_function_baked"]),
        ] {
            if self.has(feature) {
                roots.push(fetches[way]);
            }
        }
        for (feature, module) in [
            (Feature::Textured, "textured"),
            (Feature::Fresnel, "fresnel"),
            (Feature::Material, "material"),
            (Feature::Frame, "frame"),
        ] {
            if self.has(feature) {
                roots.push(module);
            }
        }
        roots.extend(self.lights.iter().map(|light| light.module()));
        roots
    }

    /// The words that `//#if` lines of the modules ask for.
    pub(crate) fn symbols(&self) -> Vec<&'static str> {
        [
            (Feature::SurfaceHorizon, "surface_horizon"),
            (Feature::CosineHorizon, "cosine_horizon"),
            (Feature::TwoSided, "two_sided"),
            (Feature::RationalEdges, "rational_edges"),
            (Feature::LeanLights, "lean_lights"),
            (Feature::Refined, "refined"),
        ]
        .into_iter()
        .filter_map(|(feature, symbol)| self.has(feature).then_some(symbol))
        .collect()
    }

    /// WGSL: pure functions and types, without bindings and entry points, and nothing that was not asked for.
    pub fn wgsl(&self) -> String {
        compose(&self.roots(), &self.symbols())
    }

    /// Every combination that matters: each light alone and all together, under every choice that its code depends on; each
    /// lookup and each further feature.
    pub fn permutations() -> Vec<Self> {
        let mut list = Vec::new();
        let switches =
            [Feature::SurfaceHorizon, Feature::CosineHorizon, Feature::TwoSided, Feature::RationalEdges];
        let mut lights: Vec<Vec<LightKind>> = LightKind::ALL.iter().map(|light| vec![*light]).collect();
        lights.push(LightKind::ALL.to_vec());
        for lights in lights {
            for choice in 0..1 << switches.len() {
                let chosen = (0..switches.len()).filter(|i| choice & (1 << i) != 0).map(|i| switches[i]);
                list.push(Self::new(lights.iter().copied(), chosen));
            }
        }
        for choice in 0..1 << switches.len() {
            let chosen = (0..switches.len()).filter(|i| choice & (1 << i) != 0).map(|i| switches[i]);
            let lights = [LightKind::Quad, LightKind::LineWithCaps, LightKind::Strip];
            list.push(Self::new(lights, chosen.chain([Feature::LeanLights])));
        }
        for tables in
            [&[Feature::Isotropic][..], &[Feature::Anisotropic], &[Feature::Baked], &Feature::LOOKUPS]
        {
            list.push(Self::new([], tables.iter().copied()));
            for way in [Feature::HardwareFiltering, Feature::FunctionTables] {
                list.push(Self::new([], tables.iter().copied().chain([way])));
            }
        }
        let refined = [Feature::Anisotropic, Feature::HardwareFiltering, Feature::Refined];
        list.push(Self::new([], refined));
        list.extend(
            [Feature::Textured, Feature::Fresnel, Feature::Material, Feature::Frame]
                .map(|feature| Self::new([], [feature])),
        );
        list.push(Self::new(
            [LightKind::Quad, LightKind::Polygon],
            [Feature::Textured, Feature::SurfaceHorizon, Feature::CosineHorizon],
        ));
        list.push(Self::new(LightKind::ALL, Feature::ALL));
        list
    }
}
