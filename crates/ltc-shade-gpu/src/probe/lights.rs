//! A few lights of every kind under a few lobes, against `f64`.

use glam::{DMat3, Vec3};
use ltc_core::{Horizon, Ltc, Matrix as _, Sides};

use super::{Finding, module};
use crate::{Gpu, GpuError, LightJob, LightKind, LightShape, Lights};

/// What the workspace promises for well-conditioned lobes.
const ALLOWED: f64 = 2e-4;

/// Lambert's, a tilted, and a narrow and thin one; row-major.
pub(super) const LOBES: [[f32; 9]; 3] = [
    [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    [0.6, 0.0, -0.7, 0.0, 0.5, 0.0, 0.3, 0.0, 0.8],
    [0.2, 0.02, -0.3, 0.01, 0.08, 0.1, 0.05, 0.0, 0.9],
];

pub fn findings(gpu: &Gpu, source: &str) -> Result<Vec<Finding>, GpuError> {
    let lights = Lights::of_module(gpu, &module(gpu, source)?)?;
    let note =
        "largest error of the fraction of a lobe that sees a light, against f64; this light is wrong if off";
    let mut findings = Vec::new();
    for kind in LightKind::ALL {
        let feature = format!("light {kind}");
        let jobs = jobs(kind);
        findings.push(match lights.integrate(gpu, &jobs) {
            Ok(found) => Finding::measured(feature, largest_error(&jobs, &found), ALLOWED, note),
            Err(GpuError::BadOutput { .. }) => Finding::failed(&feature, note),
            Err(other) => return Err(other),
        });
    }
    Ok(findings)
}

fn largest_error(jobs: &[LightJob], found: &[f32]) -> f64 {
    let error = |(job, found): (&LightJob, &f32)| {
        let lobe = Ltc::<f64>::new(DMat3::from_row_array(job.m.map(f64::from)));
        let expected = lobe.and_then(|lobe| job.light.integrate(&lobe, Horizon::BOTH));
        expected.map_or(f64::NAN, |expected| (f64::from(*found) - expected).abs())
    };
    jobs.iter().zip(found).map(error).fold(0.0, |a, b| if b <= a { a } else { b })
}

/// Above, to the side and across the horizon, under each lobe.
fn jobs(kind: LightKind) -> Vec<LightJob> {
    let centres = [Vec3::new(0.3, 0.2, 1.5), Vec3::new(-1.2, 0.4, 0.9), Vec3::new(0.9, -0.8, 0.2)];
    let lights = centres.map(|centre| light(kind, centre));
    LOBES.iter().flat_map(|m| lights.iter().map(|light| LightJob { m: *m, light: light.clone() })).collect()
}

fn light(kind: LightKind, center: Vec3) -> LightShape {
    let sides = Sides::Two;
    let (u, v) = (Vec3::new(0.5, 0.2, 0.3), Vec3::new(-0.2, 0.6, 0.1));
    let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
    let (p0, p1) = (center - u, center + u);
    match kind {
        LightKind::Quad => LightShape::Quad { corners, sides },
        LightKind::Polygon => LightShape::Polygon { vertices: corners.to_vec(), sides },
        LightKind::Line => LightShape::Line { p0, p1, radius: 0.05, caps: false },
        LightKind::LineWithCaps => LightShape::Line { p0, p1, radius: 0.05, caps: true },
        LightKind::Strip => LightShape::Strip { p0, p1, width: 0.1, normal: v, sides },
        LightKind::Cylinder => LightShape::Cylinder { p0, p1, radius: 0.3, caps: true },
        LightKind::Disk => LightShape::Disk { center, normal: center, radius: 0.5, sides },
        LightKind::Ellipse => LightShape::Ellipse { center, axis_u: u, axis_v: v, sides },
        LightKind::Sphere => LightShape::Sphere { center, radius: 0.4 },
    }
}
