//! Checked lights, ready for shading.

use glam::DVec3;
use ltc_core::{AnyLight, InputError, Ltc, Sides};
use ltc_reference::{
    CylinderEmitter, Direct, EllipseEmitter, Emitter as Sampled, Ggx, LightHit, PolygonEmitter, RectLight,
    ReferenceError, SphereEmitter, direct_light, direct_light_coloured,
};

use crate::camera::Ray;
use crate::texture_map::TextureMap;

/// A light in world space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Emitter {
    pub light: AnyLight,
    pub radiance: DVec3,
    /// What multiplies the radiance of a polygon.
    pub texture: Option<TextureMap>,
}

/// The same light as the reference samples it.
enum Reference {
    /// Without extent.
    Nothing,
    Parallelogram(RectLight),
    Polygon(PolygonEmitter),
    Ellipse(EllipseEmitter),
    Sphere(SphereEmitter),
    Cylinder(CylinderEmitter),
}

impl Emitter {
    /// Says what is wrong with a light without extent.
    pub fn new(light: AnyLight, radiance: DVec3, texture: Option<TextureMap>) -> Result<Self, String> {
        // What the constructors refuse, in their words.
        let words = |e: InputError| e.to_string();
        let fraction = light.integrate::<f64>(&Ltc::cosine(), ltc_core::Horizon::NONE);
        fraction.map_err(words)?;
        let emitter = Self { light, radiance, texture };
        match emitter.reference(|p| p, |v| v) {
            Ok(Reference::Nothing) => Err("has no area".to_owned()),
            Ok(_) => Ok(emitter),
            Err(error) => Err(error.to_string()),
        }
    }

    /// The light with its points and directions moved.
    pub fn moved(&self, point: impl Fn(DVec3) -> DVec3, direction: impl Fn(DVec3) -> DVec3) -> AnyLight {
        let p = |v: &[f64; 3]| point(DVec3::from_array(*v)).to_array();
        let d = |v: &[f64; 3]| direction(DVec3::from_array(*v)).to_array();
        let mut light = self.light.clone();
        match &mut light {
            AnyLight::Polygon { vertices, .. } => vertices.iter_mut().for_each(|v| *v = p(v)),
            AnyLight::Line { p0, p1, .. } | AnyLight::Cylinder { p0, p1, .. } => {
                (*p0, *p1) = (p(p0), p(p1));
            }
            AnyLight::Strip { p0, p1, normal, .. } => (*p0, *p1, *normal) = (p(p0), p(p1), d(normal)),
            AnyLight::Disk { center, normal, .. } => (*center, *normal) = (p(center), d(normal)),
            AnyLight::Ellipse { center, axis_u, axis_v, .. } => {
                (*center, *axis_u, *axis_v) = (p(center), d(axis_u), d(axis_v));
            }
            AnyLight::Sphere { center, .. } => *center = p(center),
        }
        light
    }

    fn reference(
        &self,
        point: impl Fn(DVec3) -> DVec3,
        direction: impl Fn(DVec3) -> DVec3,
    ) -> Result<Reference, ReferenceError> {
        let v = DVec3::from_array;
        let polygon = |vertices: &[DVec3], sides: Sides| {
            if let &[a, b, c, d] = vertices
                && let Ok(light) = RectLight::new([a, b, c, d], sides == Sides::Two)
            {
                return Ok(if light.area() > 0.0 {
                    Reference::Parallelogram(light)
                } else {
                    Reference::Nothing
                });
            }
            let polygon = PolygonEmitter::new(vertices, sides == Sides::Two)?;
            Ok(polygon.map_or(Reference::Nothing, Reference::Polygon))
        };
        match self.moved(point, direction) {
            AnyLight::Polygon { vertices, sides } => {
                polygon(&vertices.iter().map(|p| v(*p)).collect::<Vec<_>>(), sides)
            }
            AnyLight::Strip { p0, p1, width, normal, sides } => {
                let (p0, p1, normal) = (v(p0), v(p1), v(normal));
                // Counter-clockwise about the normal.
                let across = normal.cross(p1 - p0).normalize_or_zero() * (0.5 * width);
                polygon(&[p0 - across, p1 - across, p1 + across, p0 + across], sides)
            }
            AnyLight::Line { p0, p1, radius } => cylinder(v(p0), v(p1), radius, false),
            AnyLight::Cylinder { p0, p1, radius, caps } => cylinder(v(p0), v(p1), radius, caps),
            AnyLight::Disk { center, normal, radius, sides } => {
                let (x, y) = v(normal).normalize_or(DVec3::Z).any_orthonormal_pair();
                let disk = EllipseEmitter::new(v(center), x * radius, y * radius, sides == Sides::Two)?;
                Ok(Reference::Ellipse(disk))
            }
            AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
                let (u, v_axis) = (v(axis_u), v(axis_v));
                if u.cross(v_axis).length() <= 1e-12 * (u.length_squared() + v_axis.length_squared()) {
                    return Ok(Reference::Nothing);
                }
                Ok(Reference::Ellipse(EllipseEmitter::new(v(center), u, v_axis, sides == Sides::Two)?))
            }
            AnyLight::Sphere { center, radius } => {
                Ok(Reference::Sphere(SphereEmitter::new(v(center), radius)?))
            }
        }
    }

    /// Distance along the ray to the light's emitting side, if it is met.
    pub fn hit(&self, ray: &Ray) -> Option<f64> {
        let light = self.reference(|p| p - ray.origin, |v| v).ok()?;
        light.hit(ray.direction)
    }

    /// The radiance that a point of the light emits.
    pub fn radiance_at(&self, point: DVec3) -> DVec3 {
        self.radiance * self.texture.as_ref().map_or(DVec3::ONE, |map| map.colour(map.frame, point))
    }

    /// What the reference makes of the light, seen by `point` and `direction`: one result a channel.
    pub fn direct(
        &self,
        point: impl Fn(DVec3) -> DVec3,
        direction: impl Fn(DVec3) -> DVec3,
        wo: DVec3,
        ggx: &Ggx,
        samples: u32,
        seed: u64,
    ) -> Result<[Direct; 3], ReferenceError> {
        let map = self.texture.as_ref().map(|map| (map, map.moved(&point, &direction)));
        let light = self.reference(point, direction)?;
        if let Some((map, frame)) = map {
            let colour = |hit: &LightHit| map.colour(frame, hit.wi * hit.distance);
            return Ok(match light {
                Reference::Parallelogram(light) => {
                    direct_light_coloured(wo, ggx, &light, samples, seed, colour)
                }
                Reference::Polygon(light) => direct_light_coloured(wo, ggx, &light, samples, seed, colour),
                // No other light has a texture.
                _ => [Direct::default(); 3],
            });
        }
        let direct = match light {
            Reference::Nothing => Direct::default(),
            Reference::Parallelogram(light) => direct_light(wo, ggx, &light, samples, seed),
            Reference::Polygon(light) => direct_light(wo, ggx, &light, samples, seed),
            Reference::Ellipse(light) => direct_light(wo, ggx, &light, samples, seed),
            Reference::Sphere(light) => direct_light(wo, ggx, &light, samples, seed),
            Reference::Cylinder(light) => direct_light(wo, ggx, &light, samples, seed),
        };
        Ok([direct; 3])
    }
}

fn cylinder(p0: DVec3, p1: DVec3, radius: f64, caps: bool) -> Result<Reference, ReferenceError> {
    let cylinder = CylinderEmitter::new(p0, p1, radius, caps)?;
    Ok(cylinder.map_or(Reference::Nothing, Reference::Cylinder))
}

impl Reference {
    fn hit(&self, direction: DVec3) -> Option<f64> {
        let hit = match self {
            Self::Nothing => None,
            Self::Parallelogram(light) => light.hit(direction),
            Self::Polygon(light) => light.hit(direction),
            Self::Ellipse(light) => light.hit(direction),
            Self::Sphere(light) => light.hit(direction),
            Self::Cylinder(light) => light.hit(direction),
        };
        hit.map(|hit| hit.distance)
    }
}
