//! Lights of every shape, as the device reads them.

use bytemuck::Zeroable;
use glam::Vec3;
use ltc_core::{
    AnyLight, Cylinder, Disk, Ellipse, Horizon, InputError, Light as _, LineCylinder, Ltc, Polygon, Quad,
    Real, Sides, Sphere, Strip, Vector as _, check_range,
};

use crate::constants::{CAPS, TEXTURED, TWO_SIDED};
use crate::layout::LightLayout;
use crate::{GpuError, LightKind, LightTexture, LightTextures};

/// The shape of a light: relative to the shading point in the shading frame for integrals, in world space for shading. The
/// fields are those of [`AnyLight`] in `f32`.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are those of the shapes of ltc_core, described there")]
pub enum LightShape {
    /// Any flat quad, by the shader's shorter path.
    Quad { corners: [Vec3; 4], sides: Sides },
    /// [`Polygon`]
    Polygon { vertices: Vec<Vec3>, sides: Sides },
    /// [`ltc_core::Line`], with caps [`LineCylinder`].
    Line { p0: Vec3, p1: Vec3, radius: f32, caps: bool },
    /// [`Strip`]
    Strip { p0: Vec3, p1: Vec3, width: f32, normal: Vec3, sides: Sides },
    /// [`Cylinder`]
    Cylinder { p0: Vec3, p1: Vec3, radius: f32, caps: bool },
    /// [`Disk`]
    Disk { center: Vec3, normal: Vec3, radius: f32, sides: Sides },
    /// [`Ellipse`]
    Ellipse { center: Vec3, axis_u: Vec3, axis_v: Vec3, sides: Sides },
    /// [`Sphere`]
    Sphere { center: Vec3, radius: f32 },
}

impl From<&AnyLight> for LightShape {
    /// Rounded to `f32`; a polygon of four vertices is a quad.
    fn from(light: &AnyLight) -> Self {
        let v = |p: &[f64; 3]| Vec3::from_array(p.map(|x| x as f32));
        match light {
            AnyLight::Polygon { vertices, sides } => match vertices.as_slice() {
                [a, b, c, d] => Self::Quad { corners: [a, b, c, d].map(v), sides: *sides },
                _ => Self::Polygon { vertices: vertices.iter().map(v).collect(), sides: *sides },
            },
            AnyLight::Line { p0, p1, radius } => {
                Self::Line { p0: v(p0), p1: v(p1), radius: *radius as f32, caps: false }
            }
            AnyLight::Strip { p0, p1, width, normal, sides } => {
                Self::Strip { p0: v(p0), p1: v(p1), width: *width as f32, normal: v(normal), sides: *sides }
            }
            AnyLight::Cylinder { p0, p1, radius, caps } => {
                Self::Cylinder { p0: v(p0), p1: v(p1), radius: *radius as f32, caps: *caps }
            }
            AnyLight::Disk { center, normal, radius, sides } => {
                Self::Disk { center: v(center), normal: v(normal), radius: *radius as f32, sides: *sides }
            }
            AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
                Self::Ellipse { center: v(center), axis_u: v(axis_u), axis_v: v(axis_v), sides: *sides }
            }
            AnyLight::Sphere { center, radius } => Self::Sphere { center: v(center), radius: *radius as f32 },
        }
    }
}

impl LightShape {
    /// Which of the shader's lights it is.
    pub fn kind(&self) -> LightKind {
        match self {
            Self::Quad { .. } => LightKind::Quad,
            Self::Polygon { .. } => LightKind::Polygon,
            Self::Line { caps: false, .. } => LightKind::Line,
            Self::Line { caps: true, .. } => LightKind::LineWithCaps,
            Self::Strip { .. } => LightKind::Strip,
            Self::Cylinder { .. } => LightKind::Cylinder,
            Self::Disk { .. } => LightKind::Disk,
            Self::Ellipse { .. } => LightKind::Ellipse,
            Self::Sphere { .. } => LightKind::Sphere,
        }
    }

    /// The same light in `f64`; `None` for a line with caps, which is no [`AnyLight`].
    pub fn to_any(&self) -> Option<AnyLight> {
        let v = |p: Vec3| p.as_dvec3().to_array();
        let r = |x: f32| f64::from(x);
        Some(match self {
            Self::Quad { corners, sides } => {
                AnyLight::Polygon { vertices: corners.map(v).to_vec(), sides: *sides }
            }
            Self::Polygon { vertices, sides } => {
                AnyLight::Polygon { vertices: vertices.iter().map(|p| v(*p)).collect(), sides: *sides }
            }
            Self::Line { caps: true, .. } => return None,
            Self::Line { p0, p1, radius, .. } => {
                AnyLight::Line { p0: v(*p0), p1: v(*p1), radius: r(*radius) }
            }
            Self::Strip { p0, p1, width, normal, sides } => AnyLight::Strip {
                p0: v(*p0),
                p1: v(*p1),
                width: r(*width),
                normal: v(*normal),
                sides: *sides,
            },
            Self::Cylinder { p0, p1, radius, caps } => {
                AnyLight::Cylinder { p0: v(*p0), p1: v(*p1), radius: r(*radius), caps: *caps }
            }
            Self::Disk { center, normal, radius, sides } => {
                AnyLight::Disk { center: v(*center), normal: v(*normal), radius: r(*radius), sides: *sides }
            }
            Self::Ellipse { center, axis_u, axis_v, sides } => AnyLight::Ellipse {
                center: v(*center),
                axis_u: v(*axis_u),
                axis_v: v(*axis_v),
                sides: *sides,
            },
            Self::Sphere { center, radius } => AnyLight::Sphere { center: v(*center), radius: r(*radius) },
        })
    }

    /// What `ltc_core` makes of it, from the same numbers: the fraction of `ltc` that sees it.
    ///
    /// # Errors
    /// Those of the shape's constructor.
    pub fn integrate<R: Real>(&self, ltc: &Ltc<R>, horizon: Horizon) -> Result<R, InputError> {
        let v = |p: &Vec3| R::Vec3::new(R::of(p.x.into()), R::of(p.y.into()), R::of(p.z.into()));
        match (self, self.to_any()) {
            (Self::Quad { corners, sides }, _) => {
                let [a, b, c, d] = corners;
                Ok(Quad::new([v(a), v(b), v(c), v(d)], *sides)?.integrate_within(ltc, horizon))
            }
            (Self::Line { p0, p1, radius, caps }, None) => {
                let line = LineCylinder::new(v(p0), v(p1), R::of(f64::from(*radius)))?;
                Ok(line.with_caps(*caps).integrate_within(ltc, horizon))
            }
            (_, Some(light)) => light.integrate(ltc, horizon),
            (_, None) => Err(InputError::Degenerate { name: "light" }),
        }
    }

    /// What the constructors of `ltc_core` refuse.
    pub(crate) fn check(&self) -> Result<(), InputError> {
        match self {
            Self::Quad { corners, sides } => Polygon::<f32>::new(corners, *sides).map(drop),
            Self::Polygon { vertices, sides } => Polygon::<f32>::new(vertices, *sides).map(drop),
            Self::Line { p0, p1, radius, .. } => LineCylinder::<f32>::new(*p0, *p1, *radius).map(drop),
            Self::Strip { p0, p1, width, normal, sides } => {
                Strip::<f32>::new(*p0, *p1, *width, *normal, *sides).map(drop)
            }
            Self::Cylinder { p0, p1, radius, caps } => {
                Cylinder::<f32>::new(*p0, *p1, *radius, *caps).map(drop)
            }
            Self::Disk { center, normal, radius, sides } => {
                Disk::<f32>::new(*center, *normal, *radius, *sides).map(drop)
            }
            Self::Ellipse { center, axis_u, axis_v, sides } => {
                Ellipse::<f32>::new(*center, *axis_u, *axis_v, *sides).map(drop)
            }
            Self::Sphere { center, radius } => Sphere::<f32>::new(*center, *radius).map(drop),
        }
    }

    fn flags(&self) -> u32 {
        match self {
            Self::Quad { sides, .. }
            | Self::Polygon { sides, .. }
            | Self::Strip { sides, .. }
            | Self::Disk { sides, .. }
            | Self::Ellipse { sides, .. } => TWO_SIDED * u32::from(*sides == Sides::Two),
            Self::Cylinder { caps, .. } => CAPS * u32::from(*caps),
            Self::Line { .. } | Self::Sphere { .. } => 0,
        }
    }

    /// The record, with a polygon's vertices appended to `vertices`.
    pub(crate) fn encode(&self, radiance: Vec3, vertices: &mut Vec<[f32; 4]>) -> LightLayout {
        let none = [0.0; 4];
        let four = |p: Vec3, w: f32| [p.x, p.y, p.z, w];
        let [a, b, c, d] = match self {
            Self::Quad { corners, .. } => corners.map(|p| four(p, 0.0)),
            Self::Polygon { vertices: own, .. } => {
                let numbers = [vertices.len() as u32, own.len() as u32].map(f32::from_bits);
                vertices.extend(own.iter().map(|p| four(*p, 0.0)));
                [[numbers[0], numbers[1], 0.0, 0.0], none, none, none]
            }
            Self::Line { p0, p1, radius, .. } | Self::Cylinder { p0, p1, radius, .. } => {
                [four(*p0, *radius), four(*p1, 0.0), none, none]
            }
            Self::Strip { p0, p1, width, normal, .. } => {
                [four(*p0, *width), four(*p1, 0.0), four(*normal, 0.0), none]
            }
            Self::Disk { center, normal, radius, .. } => {
                [four(*center, *radius), four(*normal, 0.0), none, none]
            }
            Self::Ellipse { center, axis_u, axis_v, .. } => {
                [four(*center, 0.0), four(*axis_u, 0.0), four(*axis_v, 0.0), none]
            }
            Self::Sphere { center, radius } => [four(*center, *radius), none, none, none],
        };
        let bits = self.kind() as u32 | self.flags();
        LightLayout { a, b, c, d, radiance: radiance.to_array(), bits }
    }

    /// The record of a light with a texture; `None` for shapes that have none. Quads that their texture does not fill are polygons
    /// there.
    pub(crate) fn encode_textured(
        &self,
        radiance: Vec3,
        texture: &LightTexture,
        vertices: &mut Vec<[f32; 4]>,
    ) -> Option<LightLayout> {
        // As a float and not as bits, which some hardware would flush to zero.
        let number = texture.number as f32;
        let mut record = match self {
            Self::Quad { corners, .. } if *texture == LightTexture::filling(texture.number, corners) => {
                let mut record = self.encode(radiance, vertices);
                record.a[3] = number;
                record
            }
            Self::Quad { corners, sides } => {
                let polygon = Self::Polygon { vertices: corners.to_vec(), sides: *sides };
                return polygon.encode_textured(radiance, texture, vertices);
            }
            Self::Polygon { .. } => {
                let record = self.encode(radiance, vertices);
                let four = |p: Vec3, w: f32| [p.x, p.y, p.z, w];
                let frame = &texture.frame;
                LightLayout {
                    b: four(frame.origin, number),
                    c: four(frame.axis_u, 0.0),
                    d: four(frame.axis_v, 0.0),
                    ..record
                }
            }
            _ => return None,
        };
        record.bits |= TEXTURED;
        Some(record)
    }
}

/// A light of the scene: a shape in world space that emits the same radiance in all directions of its emitting sides.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLight {
    /// Where it is and what it looks like.
    pub shape: LightShape,
    /// Emitted radiance, linear RGB, in W/(m²·sr) or nits: what is shaded comes out in the same unit. This is the
    /// intensity of the light as seen, whatever its size; its power grows with its area.
    pub radiance: Vec3,
    /// What multiplies the radiance, for quads and polygons.
    pub texture: Option<LightTexture>,
}

impl AreaLight {
    /// A light of one colour.
    pub fn new(shape: LightShape, radiance: Vec3) -> Self {
        Self { shape, radiance, texture: None }
    }

    /// `textures` are those of the pipeline, if it has any.
    pub(crate) fn encode(
        &self,
        index: usize,
        vertices: &mut Vec<[f32; 4]>,
        textures: Option<&LightTextures>,
    ) -> Result<LightLayout, GpuError> {
        self.check().map_err(GpuError::input("light", index))?;
        let Some(texture) = &self.texture else { return Ok(self.shape.encode(self.radiance, vertices)) };
        match textures {
            Some(textures) => textures.check(texture, self.radiance, index)?,
            None => {
                let texture = texture.number;
                return Err(GpuError::MissingTexture { light: index, texture, count: 0 });
            }
        }
        let kind = self.shape.kind();
        let textured = self.shape.encode_textured(self.radiance, texture, vertices);
        textured.ok_or(GpuError::NotTexturable { light: index, kind })
    }

    fn check(&self) -> Result<(), InputError> {
        self.shape.check()?;
        for channel in self.radiance.to_array() {
            // A quarter of the largest f32: the sum over lights and lobes is to stay finite.
            check_range("radiance", f64::from(channel), 0.0, f64::from(f32::MAX) / 4.0)?;
        }
        Ok(())
    }
}

/// Lights as the shaders read them.
pub(crate) struct EncodedLights {
    pub records: Vec<LightLayout>,
    /// Of all polygons.
    pub vertices: Vec<[f32; 4]>,
}

impl EncodedLights {
    /// Neither buffer is empty, as none can be: counts say what is in them.
    pub fn of(lights: &[AreaLight], textures: Option<&LightTextures>) -> Result<Self, GpuError> {
        let mut vertices = Vec::new();
        let records = lights.iter().enumerate().map(|(i, light)| light.encode(i, &mut vertices, textures));
        let mut records = records.collect::<Result<Vec<_>, _>>()?;
        if records.is_empty() {
            records.push(LightLayout::zeroed());
        }
        if vertices.is_empty() {
            vertices.push([0.0; 4]);
        }
        Ok(Self { records, vertices })
    }
}
