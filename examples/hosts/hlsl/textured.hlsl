// A batch of textured quads, each under a lobe of its own: HLSL, here for Vulkan by glslang. With DXC or FXC the registers
// alone count; neither compiles this here.
//
//   ltc shader --lang hlsl --lights quad --features textured,surface-horizon,cosine-horizon,two-sided -o ltc.hlsl
//   glslangValidator -D -V -S comp -e main textured.hlsl -o textured.spv && spirv-val --target-env vulkan1.0 textured.spv
#include "ltc.hlsl"

[[vk::binding(0, 0)]] cbuffer Count : register(b0) { uint4 count; };
// Eight for each light: the columns of M (target_from_cosine), the corners, the texture's number in the first one's w, and in
// the last word flags.
[[vk::binding(1, 0)]] StructuredBuffer<float4> jobs : register(t0);
[[vk::binding(2, 0)]] RWStructuredBuffer<float4> results : register(u0);
// All textures, R32G32B32A32_FLOAT; nothing is filtered.
[[vk::binding(3, 0)]] Texture2D<float4> textures : register(t1);

float3 colour(uint first)
{
    // Columns of M as rows: what a mat3x3 of WGSL is in HLSL.
    LtcLobe lobe = ltc_lobe(float3x3(jobs[first].xyz, jobs[first + 1].xyz, jobs[first + 2].xyz));
    float4 a = jobs[first + 3];
    float3 b = jobs[first + 4].xyz;
    float3 c = jobs[first + 5].xyz;
    float3 d = jobs[first + 6].xyz;
    bool two_sided = (asuint(jobs[first + 7].w) & 256) != 0;
    float fraction = ltc_quad(lobe, a.xyz, b, c, d, two_sided);
    LtcTextureFetch place = ltc_texture_fetch(lobe, a.xyz, b - a.xyz, d - a.xyz);
    return fraction * ltc_texture_colour(textures, uint(a.w), place);
}

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID)
{
    if (id.x < count.x) {
        results[id.x] = float4(colour(8 * id.x), 0.0);
    }
}
