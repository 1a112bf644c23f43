//! Structures as the shaders lay them out. Sizes are those of WGSL, checked at compile time.

use bytemuck::{Pod, Zeroable};
use ltc_core::Ltc;
use ltc_table::{Axis, Kind, Mapping, Table};

use crate::GpuError;
use crate::constants::mapping_code;

/// `LtcAxis`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AxisUniform {
    pub low: f32,
    pub scale: f32,
    pub last: f32,
    pub mapping: u32,
}

/// `LtcAxes`: the one place where a table's axes become numbers in a shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AxesUniform {
    pub theta: AxisUniform,
    pub phi: AxisUniform,
    pub alpha: AxisUniform,
    pub lambda: AxisUniform,
}

/// `IntegrateJob`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct IntegrateLayout {
    pub m0: [f32; 3],
    pub unused_0: u32,
    pub m1: [f32; 3],
    pub unused_1: u32,
    pub m2: [f32; 3],
    pub unused_2: u32,
    pub light: LightLayout,
}

impl IntegrateLayout {
    /// A lobe and what it lights.
    pub fn new(lobe: &Ltc<f32>, light: LightLayout) -> Self {
        let m = lobe.target_from_cosine();
        Self {
            m0: m.x_axis.to_array(),
            unused_0: 0,
            m1: m.y_axis.to_array(),
            unused_1: 0,
            m2: m.z_axis.to_array(),
            unused_2: 0,
            light,
        }
    }
}

/// `LookupJob`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LookupLayout {
    pub wo: [f32; 3],
    pub alpha_x: f32,
    pub alpha_y: f32,
    pub table: u32,
    pub unused: [u32; 2],
}

/// `SurfacePoint`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct SurfaceLayout {
    pub position: [f32; 3],
    pub alpha_x: f32,
    pub normal: [f32; 3],
    pub alpha_y: f32,
    pub tangent: [f32; 3],
    pub table: u32,
    pub wo: [f32; 3],
    pub f90: f32,
    pub f0: [f32; 3],
    pub unused_0: f32,
    pub albedo: [f32; 3],
    pub unused_1: f32,
}

/// `LightRecord`: what `a` to `d` hold depends on the kind.
///
/// | kind | a | a.w | b | c | d |
/// |---|---|---|---|---|---|
/// | quad | corner | | corner | corner | corner |
/// | polygon | first vertex, count (as bits) | | | | |
/// | textured quad | corner | texture | corner | corner | corner |
/// | textured polygon | first vertex, count (as bits) | | origin, b.w texture | axis u | axis v |
/// | line, with caps or not | end | radius | end | | |
/// | strip | end | width | end | normal | |
/// | cylinder | end | radius | end | | |
/// | disk | centre | radius | normal | | |
/// | ellipse | centre | | half-axis | half-axis | |
/// | sphere | centre | radius | | | |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LightLayout {
    pub a: [f32; 4],
    pub b: [f32; 4],
    pub c: [f32; 4],
    pub d: [f32; 4],
    pub radiance: [f32; 3],
    pub bits: u32,
}

/// `ForwardUniform`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ForwardLayout {
    pub clip_from_world: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub light_count: u32,
    pub f0: [f32; 3],
    pub f90: f32,
    pub albedo: [f32; 3],
    pub table: u32,
    pub alpha_x: f32,
    pub alpha_y: f32,
    pub unused: [u32; 2],
}

const _: () = {
    assert!(size_of::<ForwardLayout>() == 128);
    assert!(size_of::<AxesUniform>() == 64);
    assert!(size_of::<IntegrateLayout>() == 128);
    assert!(size_of::<LookupLayout>() == 32);
    assert!(size_of::<SurfaceLayout>() == 96);
    assert!(size_of::<LightLayout>() == 80);
};

impl AxisUniform {
    fn of(axis: &Axis) -> Self {
        let [low, high] = axis.domain.map(|value| axis.mapping.coordinate(value));
        let last = (axis.len - 1) as f64;
        Self {
            low: low as f32,
            scale: (last / (high - low)) as f32,
            last: last as f32,
            mapping: mapping_code(axis.mapping),
        }
    }
}

impl AxesUniform {
    /// A table's axes; those that it does not have are zero.
    pub fn of(table: &Table) -> Result<Self, GpuError> {
        let [theta, rest @ ..] = table.axes() else {
            return Ok(Self::zeroed());
        };
        for axis in rest {
            if !matches!(axis.mapping, Mapping::Linear | Mapping::Sqrt) {
                let (mapping, quantity) = (axis.mapping.name(), axis.quantity.name());
                return Err(GpuError::UnsupportedAxis { mapping, quantity });
            }
        }
        let mut axes = Self { theta: AxisUniform::of(theta), ..Self::zeroed() };
        match (table.kind(), rest) {
            (Kind::Anisotropic, [phi, alpha, lambda]) => {
                axes.phi = AxisUniform::of(phi);
                axes.alpha = AxisUniform::of(alpha);
                axes.lambda = AxisUniform::of(lambda);
            }
            _ => axes.alpha = AxisUniform::of(&rest[0]),
        }
        Ok(axes)
    }
}
