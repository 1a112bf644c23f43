//! What stands at the top of an export: what was asked, with what, and how to use it.

use ltc_core::ALPHA_MIN;
use ltc_table::{Mapping, Quantity, ktx2};

use super::Language;
use crate::constants::{CAPS, TWO_SIDED, mapping_code};
use crate::{Feature, LightKind, ShaderRequest};

/// The header's lines, without comment marks. `code` is what the signatures are read from.
pub fn lines(request: &ShaderRequest, language: Language, code: &str) -> Vec<String> {
    let mut lines = asked(request, language);
    lines.push(String::new());
    lines.extend(conventions());
    if request.looks_up() {
        lines.push(String::new());
        lines.extend(tables(request));
    }
    if request.has(Feature::Textured) {
        lines.push(String::new());
        lines.extend(textures());
    }
    lines.push(String::new());
    if language == Language::Spirv {
        lines.extend(kernels(request));
    } else {
        lines.push("Functions to call:".to_owned());
        lines.extend(
            functions(request).iter().filter_map(|name| signature(code, name)).map(|s| format!("  {s}")),
        );
        lines.push(String::new());
        lines.extend(usage(request, language));
    }
    lines
}

fn asked(request: &ShaderRequest, language: Language) -> Vec<String> {
    let join = |names: Vec<&str>| names.join(",");
    let lights = join(request.lights.iter().map(|l| l.name()).collect());
    let features = join(request.features.iter().map(|f| f.name()).collect());
    let mut lines = vec![
        "Area lights by linearly transformed cosines, in closed form.".to_owned(),
        format!("{}, written by ltc {} as", language.title(), env!("CARGO_PKG_VERSION")),
        format!("  ltc shader --lang {language} --lights '{lights}' --features '{features}'"),
    ];
    for (feature, without) in [
        (Feature::SurfaceHorizon, "light from below the surface leaks into tilted lobes"),
        (Feature::CosineHorizon, "what lies below the horizon of cosine space counts negatively"),
    ] {
        if !request.lights.is_empty() && !request.has(feature) {
            lines.push(format!("Without {feature}: {without}."));
        }
    }
    lines
}

fn conventions() -> Vec<String> {
    [
        "Shading frame: x = tangent (carries alpha_x), y = bitangent (alpha_y), z = normal, right-handed. Lights are given in",
        "it, relative to the shading point; flat ones counter-clockwise seen from the side that emits. `wo` is a unit vector",
        "towards the eye. M (target_from_cosine) takes the clamped cosine to the lobe. A light's function gives the fraction of",
        "the lobe that sees it, in [0, 1]; 0 for a degenerate one. Inputs are finite: NaN and infinity are the caller's to",
        "refuse. alpha is the GGX width, the square of perceptual roughness; widths below the smallest are raised to it:",
    ]
    .into_iter()
    .map(str::to_owned)
    .chain([format!("alpha >= {ALPHA_MIN:?}.")])
    .collect()
}

fn tables(request: &ShaderRequest) -> Vec<String> {
    let mut lines = vec![format!(
        "Tables (`ltc export NAME --format ktx2 --precision f32`): {} groups of RGBA32F texels, m00 m01 m02 m10 |",
        ktx2::GROUPS
    )];
    lines.push("m11 m12 m20 m21 | m22 magnitude fresnel 0, with M row-major. A last number of 1 says that the two before it are what".to_owned());
    lines.push("a closed form leaves of them; the lookup adds it (`ltc_table::ClosedForm`).".to_owned());
    let [theta, phi, alpha, lambda] =
        [Quantity::Theta, Quantity::Phi, Quantity::Alpha, Quantity::Lambda].map(Quantity::name);
    if request.has(Feature::Isotropic) {
        lines.push(format!(
            "  isotropic: 2D array, x = {alpha} node, y = {theta} node, layer = group; LtcAxes has {theta} and {alpha}."
        ));
    }
    if request.has(Feature::Anisotropic) && request.is_refined() {
        lines.push(format!("  anisotropic: 3D, x = {alpha} node, y = {phi} node,"));
        lines.push(format!(
            "    z = {theta} node + len({theta}) * ({lambda} step + steps * group), with linear interpolation to a whole"
        ));
        lines.push(format!("    number of steps a cell of {lambda}; LtcAxes as for the table itself."));
    } else if request.has(Feature::Anisotropic) {
        lines.push(format!("  anisotropic: 3D, x = {lambda} node, y = {alpha} node,"));
        lines.push(format!("    z = {phi} node + len({phi}) * ({theta} node + len({theta}) * group)."));
    }
    if request.has(Feature::Baked) {
        lines.push(format!(
            "  baked (`ltc_shade_gpu::BakedSlices`): 2D array, x = {phi} node, y = {theta} node,"
        ));
        lines.push(format!("    layer = slice + slices * group; LtcAxes has {theta} and {phi}. A slice is for one alpha_x, alpha_y."));
    }
    lines.push(
        "LtcAxis of an axis of the manifest with `len` nodes over [from, to], u its mapping:".to_owned(),
    );
    lines
        .push("  low = u(from), scale = (len - 1) / (u(to) - u(from)), last = len - 1, mapping =".to_owned());
    for (mapping, formula) in [
        (Mapping::Linear, "u(x) = x"),
        (Mapping::Sqrt, "u(x) = sqrt(x)"),
        (Mapping::SqrtOneMinusCos, "u(x) = sqrt(1 - cos x)"),
        (Mapping::HalfTangent, "u(x) = tan(x / 2)"),
        (Mapping::GrazingHalfTangent, "u(x) = t / (2 - t), t = tan(x / 2)"),
    ] {
        lines.push(format!("  {} for {}: {formula}", mapping_code(mapping), mapping.name()));
    }
    lines.push(
        "Four u32 or f32 each, an axis takes 16 bytes, LtcAxes 64 in the order theta, phi, alpha, lambda."
            .to_owned(),
    );
    lines
}

fn textures() -> Vec<String> {
    [
        "Textures (`ltc_shade_gpu::TextureAtlas`): all of them, filtered, in one 2D texture of RGBA32F, fetched without a sampler.",
        "Row k is the head of texture k: texel 0 has the number of levels and the second level's sigma; texels 1 + 2l and 2 + 2l",
        "have of level l (x and y of its first texel, texels in a row - 1, rows - 1) and (u and v of its first texel, texels a unit",
        "of u, of v). (u, v) lies at origin + u axis_u + v axis_v, given as lights are; a light that the texture fills has its origin",
        "at the first corner, axis_u towards the second, axis_v towards the last. From behind it is mirrored.",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// The functions that a caller calls, in the order of use.
fn functions(request: &ShaderRequest) -> Vec<&'static str> {
    let mut names = Vec::new();
    for (feature, functions) in [
        (Feature::Material, &["ltc_metallic_roughness", "ltc_anisotropy", "ltc_anisotropy_tangent"][..]),
        (Feature::Frame, &["ltc_frame", "ltc_shading_from_world"]),
        (Feature::Isotropic, &["ltc_lookup_isotropic"]),
        (Feature::Anisotropic, &["ltc_lookup_anisotropic"]),
        (Feature::Baked, &["ltc_lookup_baked"]),
        (Feature::Fresnel, &["ltc_reflectance"]),
        (Feature::Textured, &["ltc_texture_fetch", "ltc_texture_colour", "ltc_texture_gaussian"]),
    ] {
        if request.has(feature) {
            names.extend(functions);
        }
    }
    if !request.lights.is_empty() || request.has(Feature::Textured) {
        names.extend(["ltc_lobe", "ltc_cosine"]);
    }
    for light in &request.lights {
        names.extend(match light {
            LightKind::Quad => &["ltc_quad"][..],
            LightKind::Polygon => &["ltc_polygon", "ltc_polygon_push", "ltc_polygon_fraction"],
            LightKind::Line => &["ltc_line"],
            LightKind::LineWithCaps => &["ltc_line_with_caps"],
            LightKind::Strip => &["ltc_strip"],
            LightKind::Cylinder => &["ltc_cylinder"],
            LightKind::Disk => &["ltc_disk"],
            LightKind::Ellipse => &["ltc_ellipse"],
            LightKind::Sphere => &["ltc_sphere"],
        });
    }
    names
}

/// The function's head as the code has it, on one line.
fn signature(code: &str, name: &str) -> Option<String> {
    let call = format!("{name}(");
    let line = code.lines().find(|line| {
        let at_margin = line.starts_with(|c: char| c.is_ascii_alphabetic());
        let word = line.find(&call).is_some_and(|at| line[..at].ends_with(' '));
        at_margin && word && !line.trim_end().ends_with(';')
    })?;
    let start = line.as_ptr() as usize - code.as_ptr() as usize;
    let head = code[start..].split('{').next()?;
    let one_line = head.split_whitespace().collect::<Vec<_>>().join(" ");
    Some(one_line.replace("( ", "(").replace(" )", ")").replace(",)", ")"))
}

fn usage(request: &ShaderRequest, language: Language) -> Vec<String> {
    let mut lines = vec!["Use, once for a surface point:".to_owned()];
    if let Some((table, alphas)) = [
        (Feature::Anisotropic, "alpha_x, alpha_y"),
        (Feature::Baked, "alpha_x, alpha_y, slice"),
        (Feature::Isotropic, "alpha"),
    ]
    .into_iter()
    .find(|(feature, _)| request.has(*feature))
    {
        let by_function = request.has(Feature::FunctionTables);
        let sampled = request.has(Feature::HardwareFiltering) && !by_function;
        // GLSL's textures come with their sampler.
        let separate = sampled && !matches!(language, Language::Glsl | Language::GlslEs);
        let sampler = if separate { "sampler, " } else { "" };
        let texture = if by_function { "" } else { "texture, " };
        lines.push(format!("  found = ltc_lookup_{table}({texture}{sampler}axes, wo, {alphas})"));
        lines.push("  lobe = ltc_lobe(found.m), and ltc_cosine() for diffuse light".to_owned());
        lines.push("and for each of its lights:".to_owned());
        lines.push("  radiance * (F0 * found.magnitude + (F90 - F0) * found.fresnel) * fraction".to_owned());
    } else {
        lines.push("  lobe = ltc_lobe(M), and ltc_cosine() for diffuse light".to_owned());
    }
    if request.has(Feature::Textured) {
        lines.extend(
            [
                "The fraction of a textured quad or polygon is multiplied with its colour, for each lobe:",
                "  ltc_texture_colour(textures, number, ltc_texture_fetch(lobe, origin, axis_u, axis_v))",
                "ltc_texture_gaussian, with the same parameters, takes half the fetches and is farther off.",
            ]
            .map(str::to_owned),
        );
    }
    lines.extend(
        match language {
            Language::Wgsl => &["Paste it behind your bindings; textures and samplers are parameters."][..],
            Language::Glsl => &[
                "Paste it behind `#version 450`. Textures are parameters: pass your sampler2DArray, sampler3D or",
                "sampler2D.",
            ],
            Language::GlslEs => &[
                "Paste it behind `#version 300 es`. Textures are parameters: pass your sampler2DArray, sampler3D or",
                "sampler2D, with NEAREST filters unless hardware-filtering was asked for.",
            ],
            Language::Hlsl => &[
                "Include it; textures are parameters. A mat3x3 of WGSL is a float3x3 whose rows are WGSL's columns, so",
                "that M * v is written mul(v, M): fill `found.m` that way if you bring your own M.",
            ],
            Language::Msl => &[
                "Include it, once for a .metal file; textures and samplers are parameters. Structs that are passed by",
                "reference are `thread` variables of the caller. Compile without fast math, or test that NaN stays out.",
            ],
            Language::Spirv => &[],
        }
        .iter()
        .map(ToString::to_string),
    );
    lines
}

fn kernels(request: &ShaderRequest) -> Vec<String> {
    let mut lines = vec![
        "Compute kernels of 64 invocations, one for each item of a batch. vec3 are followed by one word, unused unless said.".to_owned(),
    ];
    if !request.lights.is_empty() {
        lines.extend([
            "Lights, set 0: binding 0 uniform uvec4 (x: number of jobs); 1 storage, jobs; 2 storage, vec4 vertices of".to_owned(),
            "polygons; 3 storage, a float for each job, written. A job: 128 bytes, three columns of M as vec3, then vec4 a, b, c,".to_owned(),
            format!("d, a vec3 unused, and a word of flags: {TWO_SIDED} two-sided, {CAPS} a cylinder's caps."),
        ]);
        for light in &request.lights {
            let holds = match light {
                LightKind::Quad => "a, b, c, d corners",
                LightKind::Polygon => "a.x first vertex, a.y number of vertices, as words",
                LightKind::Line | LightKind::LineWithCaps | LightKind::Cylinder => "a, b ends, a.w radius",
                LightKind::Strip => "a, b ends, a.w width, c normal",
                LightKind::Disk => "a centre, a.w radius, b normal",
                LightKind::Ellipse => "a centre, b, c half-axes",
                LightKind::Sphere => "a centre, a.w radius",
            };
            lines.push(format!("  ltc_{}_batch: {holds}", light.name().replace('-', "_")));
        }
        let textured = [
            (LightKind::Quad, "as ltc_quad_batch, a.w number of the texture, as a float; it fills the quad"),
            (
                LightKind::Polygon,
                "as ltc_polygon_batch, b origin, c axis_u, d axis_v, b.w number of the texture",
            ),
        ];
        let asked = |light: &LightKind| request.has(Feature::Textured) && request.lights.contains(light);
        let textured: Vec<_> = textured.into_iter().filter(|(light, _)| asked(light)).collect();
        if !textured.is_empty() {
            lines.push(
                "Textured lights: binding 4 textures; 5 storage, a vec4 for each job, written in place of 3."
                    .to_owned(),
            );
        }
        lines.extend(textured.iter().map(|(light, holds)| format!("  ltc_textured_{light}_batch: {holds}")));
    }
    let kinds = [
        (Feature::Isotropic, 3, "2D array"),
        (Feature::Anisotropic, 5, "3D"),
        (Feature::Baked, 8, "2D array"),
    ];
    if request.looks_up() {
        lines.extend([
            "Lookups, set 1: binding 0 uniform uvec4 (x: number of queries); 1 storage, queries; 2 storage, three vec4 for each".to_owned(),
            "query as in a table's texels, written. A query: 32 bytes, vec3 wo, alpha_x, alpha_y, slice (as a word), two words unused.".to_owned(),
        ]);
        let by_function = request.has(Feature::FunctionTables);
        if request.has(Feature::HardwareFiltering) && !by_function {
            lines.push("Binding 7 is a linear sampler.".to_owned());
        }
        for (feature, binding, texture) in kinds.into_iter().filter(|kind| request.has(kind.0)) {
            let texture = if by_function {
                "storage, the groups one after the other".to_owned()
            } else {
                format!("texture ({texture})")
            };
            lines.push(format!(
                "  ltc_{feature}_batch: binding {binding} uniform LtcAxes, {} {texture}",
                binding + 1
            ));
        }
    }
    lines
}
