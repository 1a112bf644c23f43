//! What the camera sees: surface points with their materials, shared by all back ends.

use std::ops::Range;

use glam::{DVec2, DVec3};
use ltc_core::ShadingFrame;
use ltc_reference::SplitMix64;
use rayon::prelude::*;

use crate::camera::Ray;
use crate::object::Hit;
use crate::scene::World;
use crate::{ResolvedMaterial, Scene, SceneError};

/// A visible surface point, in `f64`, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: DVec3,
    /// Unit normal on the viewer's side: `normal · wo ≥ 0`.
    pub normal: DVec3,
    /// Unit tangent, perpendicular to the normal; carries `alpha_x`. The material's rotation is in it.
    pub tangent: DVec3,
    /// Unit vector to the eye.
    pub wo: DVec3,
    /// The material.
    pub material: ResolvedMaterial,
    /// The number of the sample in the picture, row by row from the top: the seed of whatever is random here.
    pub sample: u64,
}

/// What a sample of a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Seen {
    /// A light or the background: its radiance.
    Radiance(DVec3),
    /// The surface point of this number.
    Surface(usize),
}

/// Some rows of a picture, before shading.
#[derive(Clone, Debug)]
pub struct GBuffer {
    points: Vec<SurfacePoint>,
    seen: Vec<Seen>,
    samples_per_pixel: usize,
}

/// A shaded pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pixel {
    pub radiance: [f32; 3],
    /// Whether any of its samples sees a surface.
    pub on_surface: bool,
}

impl GBuffer {
    /// The visible points of these rows of the scene's picture. One sample a pixel goes through its middle; `side²` go
    /// through jittered places of a `side × side` grid.
    ///
    /// # Errors
    /// [`SceneError`] for an invalid scene.
    pub fn of(scene: &Scene, rows: Range<u32>, side: u32) -> Result<Self, SceneError> {
        Ok(Self::cast(&scene.world()?, rows, side))
    }

    pub(crate) fn cast(world: &World, rows: Range<u32>, side: u32) -> Self {
        let width = u64::from(world.view.width());
        let samples_per_pixel = u64::from(side) * u64::from(side);
        let each_row = width * samples_per_pixel;
        let found: Vec<_> = (u64::from(rows.start) * each_row..u64::from(rows.end) * each_row)
            .into_par_iter()
            .map(|sample| {
                let pixel = sample / samples_per_pixel;
                let corner = DVec2::new((pixel % width) as f64, (pixel / width) as f64);
                look(world, &world.view.ray(corner + within_pixel(sample, side)), sample)
            })
            .collect();
        let mut points = Vec::new();
        let seen = found
            .into_iter()
            .map(|result| match result {
                Ok(point) => {
                    points.push(point);
                    Seen::Surface(points.len() - 1)
                }
                Err(radiance) => Seen::Radiance(radiance),
            })
            .collect();
        Self { points, seen, samples_per_pixel: samples_per_pixel as usize }
    }

    /// The visible surface points.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// The pixels, once each point has its radiance: the mean of each pixel's samples.
    pub(crate) fn resolve(&self, radiance: &[DVec3]) -> Vec<Pixel> {
        self.seen
            .chunks(self.samples_per_pixel)
            .map(|samples| {
                let value = |seen: &Seen| match *seen {
                    Seen::Radiance(value) => value,
                    Seen::Surface(point) => radiance[point],
                };
                let mean = samples.iter().map(value).sum::<DVec3>() / samples.len() as f64;
                let on_surface = samples.iter().any(|s| matches!(s, Seen::Surface(_)));
                Pixel { radiance: mean.as_vec3().to_array(), on_surface }
            })
            .collect()
    }
}

/// Where in its pixel a sample lies, in [0, 1)².
fn within_pixel(sample: u64, side: u32) -> DVec2 {
    if side == 1 {
        return DVec2::splat(0.5);
    }
    let cell = sample % (u64::from(side) * u64::from(side));
    let corner = DVec2::new((cell % u64::from(side)) as f64, (cell / u64::from(side)) as f64);
    (corner + DVec2::from_array(SplitMix64::new(sample).next_2d())) / f64::from(side)
}

/// The surface point that a ray meets first, or the radiance of what it sees instead.
fn look(world: &World, ray: &Ray, sample: u64) -> Result<SurfacePoint, DVec3> {
    let mut nearest = None;
    for (shape, material) in world.shapes.iter().zip(&world.materials) {
        if let Some(hit) = shape.hit(ray)
            && nearest.is_none_or(|(best, _): (Hit, _)| hit.distance < best.distance)
        {
            nearest = Some((hit, material));
        }
    }
    let mut limit = nearest.map_or(f64::INFINITY, |(hit, _)| hit.distance);
    let mut emitted = None;
    for light in &world.lights {
        if let Some(distance) = light.hit(ray)
            && distance < limit
        {
            limit = distance;
            emitted = Some(light.radiance_at(ray.origin + ray.direction * distance));
        }
    }
    match (emitted, nearest) {
        (Some(radiance), _) => Err(radiance),
        (None, None) => Err(world.background),
        (None, Some((hit, material))) => surface_point(ray, &hit, material, sample).ok_or(world.background),
    }
}

/// `None` if the hit has no normal, which no shape of a valid scene produces.
fn surface_point(ray: &Ray, hit: &Hit, material: &ResolvedMaterial, sample: u64) -> Option<SurfacePoint> {
    let wo = -ray.direction;
    let normal = if hit.normal.dot(wo) < 0.0 { -hit.normal } else { hit.normal };
    let frame = ShadingFrame::<f64>::new(normal, hit.tangent).ok()?;
    let (sin, cos) = material.rotation.sin_cos();
    Some(SurfacePoint {
        position: ray.origin + ray.direction * hit.distance,
        normal: frame.normal(),
        tangent: frame.tangent() * cos + frame.bitangent() * sin,
        wo,
        material: *material,
        sample,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        serde_json::from_str(
            r#"{
            "camera": {"position": [0, 1, 5], "look_at": [0, 1, 0], "fov_y_degrees": 60, "width": 48, "height": 36},
            "background": [0.1, 0.2, 0.3],
            "objects": [
                {"type": "plane", "point": [0, 0, 0], "material": {"roughness": 0.3, "rotation_degrees": 90}},
                {"type": "sphere", "center": [0, 1, 0], "radius": 1, "material": {"roughness": 0.5}}
            ],
            "lights": [{"type": "rectangle", "center": [0, 1, 3], "half_u": [0.2, 0, 0], "half_v": [0, 0.2, 0],
                "intensity": 4}]
        }"#,
        )
        .unwrap()
    }

    #[test]
    fn points_are_on_their_surfaces_and_face_the_viewer() {
        let buffer = GBuffer::of(&scene(), 0..36, 2).unwrap();
        assert!(buffer.points().len() > 2000);
        let (mut on_plane, mut on_sphere) = (0, 0);
        for p in buffer.points() {
            assert!(p.normal.dot(p.wo) >= 0.0);
            assert!(p.tangent.dot(p.normal).abs() < 1e-12 && (p.tangent.length() - 1.0).abs() < 1e-12);
            if p.position.y.abs() < 1e-9 {
                on_plane += 1;
                // x turned by 90° about y.
                assert!((p.tangent - DVec3::NEG_Z).length() < 1e-12, "{}", p.tangent);
            } else {
                on_sphere += 1;
                assert!(((p.position - DVec3::Y).length() - 1.0).abs() < 1e-9);
            }
        }
        assert!(on_plane > 100 && on_sphere > 100);
    }

    #[test]
    fn the_light_and_the_background_are_seen() {
        let buffer = GBuffer::of(&scene(), 0..36, 1).unwrap();
        let black = vec![DVec3::ZERO; buffer.points().len()];
        let pixels = buffer.resolve(&black);
        assert_eq!(pixels[0], Pixel { radiance: [0.1, 0.2, 0.3], on_surface: false });
        let lit = pixels.iter().filter(|p| p.radiance == [4.0; 3]).count();
        assert!(lit > 4, "{lit}");
        let surface = pixels.iter().filter(|p| p.on_surface).count();
        assert_eq!(surface, buffer.points().len());
    }

    #[test]
    fn rows_are_the_same_alone_as_in_the_whole() {
        let whole = GBuffer::of(&scene(), 0..36, 3).unwrap();
        let (top, rest) =
            (GBuffer::of(&scene(), 0..20, 3).unwrap(), GBuffer::of(&scene(), 20..36, 3).unwrap());
        let both: Vec<_> = top.points().iter().chain(rest.points()).copied().collect();
        assert_eq!(whole.points(), both);
    }
}
