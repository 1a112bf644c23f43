// A batch of lights of any kind, each under a lobe of its own: GLSL 4.50 for Vulkan.
//
//   ltc shader --lang glsl --lights quad,polygon,line,line-with-caps,strip,cylinder,disk,ellipse,sphere \
//       --features surface-horizon,cosine-horizon,two-sided -o ltc.glsl
//   glslangValidator -V batch.comp -o batch.spv && spirv-val --target-env vulkan1.0 batch.spv
#version 450
#extension GL_GOOGLE_include_directive : require
#include "ltc.glsl"

layout(local_size_x = 64) in;
layout(std140, set = 0, binding = 0) uniform Count { uvec4 count; };
// Eight for each light: the columns of M (target_from_cosine), a, b, c, d, and in the last word flags and the kind.
layout(std430, set = 0, binding = 1) readonly buffer Jobs { vec4 jobs[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Results { float results[]; };

float fraction(uint first) {
    LtcLobe lobe = ltc_lobe(mat3(jobs[first].xyz, jobs[first + 1u].xyz, jobs[first + 2u].xyz));
    vec4 a = jobs[first + 3u];
    vec3 b = jobs[first + 4u].xyz;
    vec3 c = jobs[first + 5u].xyz;
    vec3 d = jobs[first + 6u].xyz;
    uint bits = floatBitsToUint(jobs[first + 7u].w);
    bool two_sided = (bits & 256u) != 0u;
    switch (bits & 255u) {
        case 0u: return ltc_quad(lobe, a.xyz, b, c, d, two_sided);
        case 1u: {
            LtcPolygon polygon = ltc_polygon(lobe, a.xyz);
            ltc_polygon_push(polygon, lobe, b);
            ltc_polygon_push(polygon, lobe, c);
            ltc_polygon_push(polygon, lobe, d);
            return ltc_polygon_fraction(polygon, lobe, two_sided);
        }
        case 2u: return ltc_line(lobe, a.xyz, b, a.w);
        case 3u: return ltc_line_with_caps(lobe, a.xyz, b, a.w);
        case 4u: return ltc_strip(lobe, a.xyz, b, a.w, c, two_sided);
        case 5u: return ltc_cylinder(lobe, a.xyz, b, a.w, (bits & 512u) != 0u);
        case 6u: return ltc_disk(lobe, a.xyz, b, a.w, two_sided);
        case 7u: return ltc_ellipse(lobe, a.xyz, b, c, two_sided);
        case 8u: return ltc_sphere(lobe, a.xyz, a.w);
    }
    return 0.0;
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < count.x) {
        results[i] = fraction(8u * i);
    }
}
