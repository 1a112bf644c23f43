// A batch of textured quads, each under a lobe of its own: GLSL 4.50 for Vulkan.
//
//   ltc shader --lang glsl --lights quad --features textured,surface-horizon,cosine-horizon,two-sided -o ltc.glsl
//   glslangValidator -V textured.comp -o textured.spv && spirv-val --target-env vulkan1.0 textured.spv
#version 450
#extension GL_GOOGLE_include_directive : require
// The textures are fetched and never filtered: in Vulkan they do without a sampler. Without these two lines they are a
// `uniform sampler2D`.
#extension GL_EXT_samplerless_texture_functions : require
#define sampler2D texture2D
#include "ltc.glsl"

layout(local_size_x = 64) in;
layout(std140, set = 0, binding = 0) uniform Count { uvec4 count; };
// Eight for each light: the columns of M (target_from_cosine), the corners, the texture's number in the first one's w, and in
// the last word flags.
layout(std430, set = 0, binding = 1) readonly buffer Jobs { vec4 jobs[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Results { vec4 results[]; };
// All textures, RGBA32F.
layout(set = 0, binding = 3) uniform texture2D textures;

vec3 colour(uint first) {
    LtcLobe lobe = ltc_lobe(mat3(jobs[first].xyz, jobs[first + 1u].xyz, jobs[first + 2u].xyz));
    vec4 a = jobs[first + 3u];
    vec3 b = jobs[first + 4u].xyz;
    vec3 c = jobs[first + 5u].xyz;
    vec3 d = jobs[first + 6u].xyz;
    bool two_sided = (floatBitsToUint(jobs[first + 7u].w) & 256u) != 0u;
    float fraction = ltc_quad(lobe, a.xyz, b, c, d, two_sided);
    LtcTextureFetch place = ltc_texture_fetch(lobe, a.xyz, b - a.xyz, d - a.xyz);
    return fraction * ltc_texture_colour(textures, uint(a.w), place);
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < count.x) {
        results[i] = vec4(colour(8u * i), 0.0);
    }
}
