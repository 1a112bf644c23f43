//! Functions of numbers.

use super::{Finding, module};
use crate::compute::{Batch, Kernel};
use crate::{Gpu, GpuError};

/// Points around the circle, and as many pairs whose products cancel.
const CASES: usize = 1024;

pub fn findings(gpu: &Gpu, source: &str) -> Result<Vec<Finding>, GpuError> {
    let module = module(gpu, source)?;
    let cases = cases();
    let Some(answers) = run(gpu, &module, "arithmetic", &cases)? else {
        return Ok(vec![Finding::failed("arithmetic", "no finite answer came back")]);
    };
    let mut largest = [0.0_f64; 4];
    for (case, answer) in cases.iter().zip(answers.as_chunks::<4>().0) {
        for ((largest, (expected, unit)), found) in largest.iter_mut().zip(expected(*case)).zip(answer) {
            *largest = largest.max((f64::from(*found) - expected).abs() / unit);
        }
    }
    Ok(vec![
        Finding::measured(
            "arc tangent",
            largest[0],
            5e-7,
            "error of ltc_atan2 in radians; lights are wrong if off",
        ),
        Finding::measured(
            "built-in atan2",
            largest[1],
            2e-3,
            "its error in radians; WGSL allows 4096 units in the last place, and no function here uses it",
        ),
        Finding::measured(
            "root and quotient",
            largest[2],
            2e-6,
            "relative error of sqrt(z) / w; lights lose digits if off",
        ),
        Finding::measured(
            "cancelling products",
            largest[3],
            // A plain product of this kind is off by up to 6e-8. Where a driver keeps sums in their order it is 2e-11.
            3e-8,
            "error of the cross product of nearly parallel unit vectors; thin and distant lights lose digits if off",
        ),
        not_a_number(gpu, &module)?,
    ])
}

/// x, y of the circle, and z, w next to them.
fn cases() -> Vec<[f32; 4]> {
    let angles = (0..CASES).map(|i| std::f64::consts::TAU * (i as f64 + 0.37) / CASES as f64 - 3.1);
    angles
        .map(|angle| {
            let (y, x) = angle.sin_cos();
            let near = angle + 3e-4;
            [x as f32, y as f32, near.cos() as f32, near.sin() as f32]
        })
        .map(|[x, y, z, w]| [x, y, z, if w == 0.0 { 1e-3 } else { w }])
        .collect()
}

/// Answers, and the units of their errors.
fn expected(case: [f32; 4]) -> [(f64, f64); 4] {
    let [x, y, z, w] = case.map(f64::from);
    let quotient = z.abs().sqrt() / w;
    let angle = y.atan2(x);
    [(angle, 1.0), (angle, 1.0), (quotient, quotient.abs().max(1e-6)), (x * w - y * z, 1.0)]
}

fn not_a_number(gpu: &Gpu, module: &wgpu::ShaderModule) -> Result<Finding, GpuError> {
    let cases = [0x7FC0_0000_u32, 0xFFC0_0001].map(|bits| [f32::from_bits(bits), 0.0, 0.0, 0.0]);
    let note = "comparisons with NaN that come out wrong, of four; guards may be optimised away if off";
    let Some(answers) = run(gpu, module, "not_a_number", &cases)? else {
        return Ok(Finding::failed("NaN", note));
    };
    let wrong = answers.as_chunks::<4>().0.iter().map(|a| 4.0 - f64::from(a[0])).fold(0.0, f64::max);
    Ok(Finding::measured("NaN", wrong, 0.0, note))
}

/// `None` where an answer is not finite.
fn run(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    cases: &[[f32; 4]],
) -> Result<Option<Vec<f32>>, GpuError> {
    let nothing = gpu.checked(|| {
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("ltc probe"), entries: &[] };
        Ok(gpu.device().create_bind_group_layout(&descriptor))
    })?;
    let bound = gpu.checked(|| {
        let descriptor =
            wgpu::BindGroupDescriptor { label: Some("ltc probe"), layout: &nothing, entries: &[] };
        Ok(gpu.device().create_bind_group(&descriptor))
    })?;
    answers(gpu, &Kernel::new(gpu, module, entry_point, Some(&nothing), 1)?, &bound, cases)
}

/// Four numbers for each case; `None` where one is not finite.
pub(super) fn answers(
    gpu: &Gpu,
    kernel: &Kernel,
    bound: &wgpu::BindGroup,
    cases: &[[f32; 4]],
) -> Result<Option<Vec<f32>>, GpuError> {
    let batch = Batch {
        item: "probe",
        first: 0,
        items: cases.len(),
        counts: [cases.len() as u32, 0, 0, 0],
        inputs: &[bytemuck::cast_slice(cases)],
        floats_each: 4,
        tables: Some(bound),
    };
    match kernel.run(gpu, &batch) {
        Ok(numbers) => Ok(Some(numbers)),
        Err(GpuError::BadOutput { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}
