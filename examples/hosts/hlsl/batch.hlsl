// A batch of lights of any kind, each under a lobe of its own: HLSL, here for Vulkan by glslang. With DXC or FXC the
// registers alone count; neither compiles this here.
//
//   ltc shader --lang hlsl --lights quad,polygon,line,line-with-caps,strip,cylinder,disk,ellipse,sphere \
//       --features surface-horizon,cosine-horizon,two-sided -o ltc.hlsl
//   glslangValidator -D -V -S comp -e main batch.hlsl -o batch.spv && spirv-val --target-env vulkan1.0 batch.spv
#include "ltc.hlsl"

[[vk::binding(0, 0)]] cbuffer Count : register(b0) { uint4 count; };
// Eight for each light: the columns of M (target_from_cosine), a, b, c, d, and in the last word flags and the kind.
[[vk::binding(1, 0)]] StructuredBuffer<float4> jobs : register(t0);
[[vk::binding(2, 0)]] RWStructuredBuffer<float> results : register(u0);

float fraction(uint first)
{
    // Columns of M as rows: what a mat3x3 of WGSL is in HLSL.
    LtcLobe lobe = ltc_lobe(float3x3(jobs[first].xyz, jobs[first + 1].xyz, jobs[first + 2].xyz));
    float4 a = jobs[first + 3];
    float3 b = jobs[first + 4].xyz;
    float3 c = jobs[first + 5].xyz;
    float3 d = jobs[first + 6].xyz;
    uint bits = asuint(jobs[first + 7].w);
    bool two_sided = (bits & 256) != 0;
    switch (bits & 255) {
        case 0: return ltc_quad(lobe, a.xyz, b, c, d, two_sided);
        case 1: {
            LtcPolygon polygon = ltc_polygon(lobe, a.xyz);
            ltc_polygon_push(polygon, lobe, b);
            ltc_polygon_push(polygon, lobe, c);
            ltc_polygon_push(polygon, lobe, d);
            return ltc_polygon_fraction(polygon, lobe, two_sided);
        }
        case 2: return ltc_line(lobe, a.xyz, b, a.w);
        case 3: return ltc_line_with_caps(lobe, a.xyz, b, a.w);
        case 4: return ltc_strip(lobe, a.xyz, b, a.w, c, two_sided);
        case 5: return ltc_cylinder(lobe, a.xyz, b, a.w, (bits & 512) != 0);
        case 6: return ltc_disk(lobe, a.xyz, b, a.w, two_sided);
        case 7: return ltc_ellipse(lobe, a.xyz, b, c, two_sided);
        case 8: return ltc_sphere(lobe, a.xyz, a.w);
    }
    return 0.0;
}

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID)
{
    if (id.x < count.x) {
        results[id.x] = fraction(8 * id.x);
    }
}
