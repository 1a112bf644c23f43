//! Textured quads and polygons under a few lobes, against `f64`.

use glam::{DMat3, DVec3, Vec3};
use ltc_core::{
    Horizon, InputError, Ltc, Matrix as _, PrefilteredTexture, Sides, TexelGrid, TexturedPolygon,
};

use super::lights::LOBES;
use super::{Finding, module};
use crate::{Gpu, GpuError, LightShape, LightTexture, LightTextures, TexturedJob, TexturedLights};

/// What the workspace promises, times a texel of 1.
const ALLOWED: f64 = 2e-4;

pub fn finding(gpu: &Gpu, source: &str) -> Result<Finding, GpuError> {
    let note = "largest error of the colour that a lobe sees of a textured light, against f64; its textures are wrong if off";
    let texture = texture().map_err(GpuError::input("light", 0))?;
    let textures = LightTextures::upload(gpu, std::slice::from_ref(&texture))?;
    let lights = TexturedLights::of_module(gpu, &module(gpu, source)?, textures)?;
    let jobs = jobs();
    let found = match lights.integrate(gpu, &jobs) {
        Ok(found) => found,
        Err(GpuError::BadOutput { .. }) => return Ok(Finding::failed("textured light", note)),
        Err(other) => return Err(other),
    };
    let error = |(job, found): (&TexturedJob, &[f32; 3])| {
        expected(job, &texture).map_or(f64::NAN, |expected| {
            (0..3).map(|c| (f64::from(found[c]) - expected[c]).abs()).fold(0.0, f64::max)
        })
    };
    // Unlike `max`, this keeps a NaN.
    let largest = jobs.iter().zip(&found).map(error).fold(0.0, |a, b| if b <= a { a } else { b });
    Ok(Finding::measured("textured light", largest, ALLOWED, note))
}

/// Eight columns of stripes, darker from row to row.
fn texture() -> Result<PrefilteredTexture, InputError> {
    let colours: Vec<[f32; 3]> =
        (0..32).map(|k| [(k % 2) as f32, (k % 8) as f32 / 7.0, 1.0 - (k / 8) as f32 / 3.0]).collect();
    PrefilteredTexture::new(TexelGrid { width: 8, height: 4, colours: &colours, coverage: None })
}

fn jobs() -> Vec<TexturedJob> {
    let centres = [Vec3::new(0.3, 0.2, 1.5), Vec3::new(-1.2, 0.4, 0.9), Vec3::new(0.9, -0.8, 0.2)];
    let (u, v) = (Vec3::new(0.5, 0.2, 0.3), Vec3::new(-0.2, 0.6, 0.1));
    let lights = centres.iter().flat_map(|c| {
        let corners = [*c - u - v, *c + u - v, *c + u + v, *c - u + v];
        let texture = LightTexture::filling(0, &corners);
        let polygon = LightShape::Polygon { vertices: corners[..3].to_vec(), sides: Sides::Two };
        [(LightShape::Quad { corners, sides: Sides::Two }, texture), (polygon, texture)]
    });
    let under = |(light, texture): (LightShape, LightTexture)| {
        LOBES.map(|m| TexturedJob { m, light: light.clone(), texture })
    };
    lights.flat_map(under).collect()
}

fn expected(job: &TexturedJob, texture: &PrefilteredTexture) -> Option<[f64; 3]> {
    let corners: Vec<DVec3> = match &job.light {
        LightShape::Quad { corners, .. } => corners.iter().map(|p| p.as_dvec3()).collect(),
        LightShape::Polygon { vertices, .. } => vertices.iter().map(|p| p.as_dvec3()).collect(),
        _ => return None,
    };
    let frame = &job.texture.frame;
    let [origin, axis_u, axis_v] = [frame.origin, frame.axis_u, frame.axis_v].map(Vec3::as_dvec3);
    let frame = ltc_core::TextureFrame { origin, axis_u, axis_v };
    let light = TexturedPolygon::<f64>::new(&corners, Sides::Two, frame, texture).ok()?;
    let lobe = Ltc::<f64>::new(DMat3::from_row_array(job.m.map(f64::from))).ok()?;
    Some(light.integrate_colour(&lobe, Horizon::BOTH))
}
