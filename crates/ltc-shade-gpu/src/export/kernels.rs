//! Entry points for SPIR-V: one compute kernel for each light and for each lookup, in batches.

use std::fmt::Write as _;

use super::ExportError;
use crate::modules::compose;
use crate::{Feature, LightKind, ShaderRequest};

/// What a batch of lights reads and writes.
const LIGHTS: &str = "
struct LtcLightJob {
    // Columns of target_from_cosine.
    m0: vec3f,
    unused_0: u32,
    m1: vec3f,
    unused_1: u32,
    m2: vec3f,
    unused_2: u32,
    // In the shading frame, relative to the shading point.
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
    unused_3: vec3f,
    bits: u32,
}

@group(0) @binding(0) var<uniform> job_count: vec4u;
@group(0) @binding(1) var<storage, read> jobs: array<LtcLightJob>;
@group(0) @binding(3) var<storage, read_write> results: array<f32>;
";

const VERTICES: &str = "
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;

fn ltc_polygon_of(lobe: LtcLobe, first: u32, count: u32TWO_SIDED) -> f32 {
    var polygon = ltc_polygon(lobe, vertices[first].xyz);
    for (var i = 1u; i < count; i++) {
        ltc_polygon_push(&polygon, lobe, vertices[first + i].xyz);
    }
    return ltc_polygon_fraction(&polygon, lobeARGUMENT);
}
";

/// For textured quads and polygons; see `textured.wgsl` for what is in `textures`.
const TEXTURES: &str = "
@group(0) @binding(4) var textures: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> colours: array<vec4f>;
";

const QUERIES: &str = "
struct LtcQuery {
    wo: vec3f,
    alpha_x: f32,
    alpha_y: f32,
    // Of a baked lookup.
    slice: u32,
    unused_0: u32,
    unused_1: u32,
}

@group(1) @binding(0) var<uniform> query_count: vec4u;
@group(1) @binding(1) var<storage, read> queries: array<LtcQuery>;
// Three for each query: m00 m01 m02 m10, m11 m12 m20 m21, m22 magnitude fresnel 0.
@group(1) @binding(2) var<storage, read_write> found: array<vec4f>;

fn ltc_write(index: u32, lookup: LtcLookup) {
    let m = lookup.m;
    found[3u * index] = vec4f(m[0].x, m[1].x, m[2].x, m[0].y);
    found[3u * index + 1u] = vec4f(m[1].y, m[2].y, m[0].z, m[1].z);
    found[3u * index + 2u] = vec4f(m[2].z, lookup.magnitude, lookup.fresnel, 0.0);
}
";

/// The request's functions and the kernels that call them, as WGSL.
pub fn wgsl(request: &ShaderRequest) -> Result<String, ExportError> {
    if request.lights.is_empty() && !request.looks_up() {
        return Err(ExportError::NoKernel);
    }
    let mut roots = request.roots();
    if !request.lights.is_empty() {
        roots.extend(["light_constants", "lobe"]);
    }
    let mut text = compose(&roots, &request.symbols());
    lights(request, &mut text);
    lookups(request, &mut text);
    Ok(text)
}

fn lights(request: &ShaderRequest, text: &mut String) {
    if request.lights.is_empty() {
        return;
    }
    text.push_str(LIGHTS);
    let two_sided = request.has(Feature::TwoSided);
    if request.lights.contains(&LightKind::Polygon) {
        let (parameter, argument) = if two_sided { (", two_sided: bool", ", two_sided") } else { ("", "") };
        text.push_str(&VERTICES.replace("TWO_SIDED", parameter).replace("ARGUMENT", argument));
    }
    for light in &request.lights {
        let (call, flat) = call(*light);
        let flag = if flat && two_sided { ", (job.bits & LIGHT_TWO_SIDED) != 0u" } else { "" };
        kernel(
            text,
            &light.name().replace('-', "_"),
            "job_count",
            &format!(
                "    let job = jobs[id.x];\n    let lobe = ltc_lobe(mat3x3f(job.m0, job.m1, job.m2));\n    \
                 results[id.x] = {call}{flag});\n"
            ),
        );
    }
    if request.has(Feature::Textured) {
        textured(request, text);
    }
}

/// The kernels of those lights that have textures.
fn textured(request: &ShaderRequest, text: &mut String) {
    let all = [
        (LightKind::Quad, "job.a.w", "job.a.xyz, job.b.xyz - job.a.xyz, job.d.xyz - job.a.xyz"),
        (LightKind::Polygon, "job.b.w", "job.b.xyz, job.c.xyz, job.d.xyz"),
    ];
    let asked: Vec<_> = all.into_iter().filter(|(light, ..)| request.lights.contains(light)).collect();
    if asked.is_empty() {
        return;
    }
    text.push_str(TEXTURES);
    let flag = if request.has(Feature::TwoSided) { ", (job.bits & LIGHT_TWO_SIDED) != 0u" } else { "" };
    for (light, number, frame) in asked {
        let (call, _) = call(light);
        kernel(
            text,
            &format!("textured_{light}"),
            "job_count",
            &format!(
                "    let job = jobs[id.x];\n    let lobe = ltc_lobe(mat3x3f(job.m0, job.m1, job.m2));\n    \
                 let fetch = ltc_texture_fetch(lobe, {frame});\n    \
                 let colour = ltc_texture_colour(textures, u32({number}), fetch);\n    \
                 colours[id.x] = vec4f({call}{flag}) * colour, 0.0);\n"
            ),
        );
    }
}

/// The call without its last arguments, and whether it takes `two_sided`.
fn call(light: LightKind) -> (&'static str, bool) {
    match light {
        LightKind::Quad => ("ltc_quad(lobe, job.a.xyz, job.b.xyz, job.c.xyz, job.d.xyz", true),
        LightKind::Polygon => ("ltc_polygon_of(lobe, bitcast<u32>(job.a.x), bitcast<u32>(job.a.y)", true),
        LightKind::Line => ("ltc_line(lobe, job.a.xyz, job.b.xyz, job.a.w", false),
        LightKind::LineWithCaps => ("ltc_line_with_caps(lobe, job.a.xyz, job.b.xyz, job.a.w", false),
        LightKind::Strip => ("ltc_strip(lobe, job.a.xyz, job.b.xyz, job.a.w, job.c.xyz", true),
        LightKind::Cylinder => {
            ("ltc_cylinder(lobe, job.a.xyz, job.b.xyz, job.a.w, (job.bits & LIGHT_CAPS) != 0u", false)
        }
        LightKind::Disk => ("ltc_disk(lobe, job.a.xyz, job.b.xyz, job.a.w", true),
        LightKind::Ellipse => ("ltc_ellipse(lobe, job.a.xyz, job.b.xyz, job.c.xyz", true),
        LightKind::Sphere => ("ltc_sphere(lobe, job.a.xyz, job.a.w", false),
    }
}

fn lookups(request: &ShaderRequest, text: &mut String) {
    let by_function = request.has(Feature::FunctionTables);
    let hardware = request.has(Feature::HardwareFiltering) && !by_function;
    let mut started = false;
    for (feature, texture, first_binding, alphas) in [
        (Feature::Isotropic, "texture_2d_array<f32>", 3, "query.alpha_x"),
        (Feature::Anisotropic, "texture_3d<f32>", 5, "query.alpha_x, query.alpha_y"),
        (Feature::Baked, "texture_2d_array<f32>", 8, "query.alpha_x, query.alpha_y, query.slice"),
    ] {
        if !request.has(feature) {
            continue;
        }
        if !started {
            text.push_str(QUERIES);
            if hardware {
                text.push_str("@group(1) @binding(7) var table_filter: sampler;\n");
            }
            started = true;
        }
        let second_binding = first_binding + 1;
        let table = match (by_function, hardware) {
            (true, _) => String::new(),
            (false, true) => format!("{feature}_table, table_filter, "),
            (false, false) => format!("{feature}_table, "),
        };
        // Writing to a String never fails.
        let _ = write!(text, "\n@group(1) @binding({first_binding}) var<uniform> {feature}_axes: LtcAxes;\n");
        let _ = if by_function {
            write!(
                text,
                "@group(1) @binding({second_binding}) var<storage, read> {feature}_table: array<vec4f>;\n\n\
                 fn ltc_{feature}_texel(entry: u32, group: u32) -> vec4f {{\n    \
                 return {feature}_table[group * (arrayLength(&{feature}_table) / 3u) + entry];\n}}\n"
            )
        } else {
            writeln!(text, "@group(1) @binding({second_binding}) var {feature}_table: {texture};")
        };
        kernel(
            text,
            feature.name(),
            "query_count",
            &format!(
                "    let query = queries[id.x];\n    \
                 ltc_write(id.x, ltc_lookup_{feature}({table}{feature}_axes, query.wo, {alphas}));\n"
            ),
        );
    }
}

fn kernel(text: &mut String, name: &str, count: &str, body: &str) {
    let _ = write!(
        text,
        "\n@compute @workgroup_size(64)\nfn ltc_{name}_batch(@builtin(global_invocation_id) id: vec3u) {{\n    \
         if id.x >= {count}.x {{\n        return;\n    }}\n{body}}}\n"
    );
}
