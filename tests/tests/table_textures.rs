//! What each way to keep and interpolate tables on the device costs in light: fractions of random lights, looked up and
//! integrated there, against CPU f64. `docs/gpu.md` has the figures.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use ltc_fit::draw;
use ltc_shade_gpu::{
    Filtering, Gpu, GpuError, GpuOptions, LightJob, LightKind, Lights, Lookups, TableTextures, Texels,
};
use ltc_table::{Axis, Query, Table};
use ltc_tests::{LightBackEnd, LightsF64, light_jobs, table};

const COUNT: usize = 20_000;

/// For each way and table the largest error of a fraction that is allowed, and the largest root mean square. Exact
/// interpolation is held to what the workspace promises between any two back ends; half floats to half as much again as was
/// measured; texture units to what weights of 8 bits cost (below), though llvmpipe's have more.
const BOUNDS: [(Filtering, Texels, [[f64; 2]; 2]); 7] = [
    (Filtering::Buffer, Texels::F32, [[1e-4, 1e-6], [1e-4, 1e-6]]),
    (Filtering::Exact, Texels::F32, [[1e-4, 1e-6], [1e-4, 1e-6]]),
    (Filtering::Hardware, Texels::F32, [[1.2e-3, 3e-5], [4e-2, 3.5e-4]]),
    (Filtering::Exact, Texels::F16, [[1.8e-3, 6e-5], [3.6e-3, 6.5e-5]]),
    (Filtering::Hardware, Texels::F16, [[3e-3, 9e-5], [4e-2, 4e-4]]),
    (Filtering::Refined, Texels::F32, [[1.2e-3, 3e-5], [4e-2, 6e-4]]),
    (Filtering::Refined, Texels::F16, [[3e-3, 9e-5], [4e-2, 6e-4]]),
];

/// Largest and root mean square error of the fractions of these lights, with their lobes looked up on the device.
fn errors(gpu: &Gpu, table: &Table, queries: &[Query], jobs: &[LightJob]) -> Result<[f64; 2], GpuError> {
    let textures = TableTextures::upload(gpu, table)?;
    let found = Lookups::new(gpu)?.lookup(gpu, &textures, queries)?;
    let by_device: Vec<LightJob> = jobs
        .iter()
        .zip(found)
        .map(|(job, found)| LightJob { m: found.m, light: job.light.clone() })
        .collect();
    let values = Lights::new(gpu)?.integrate(gpu, &by_device)?;
    let truth = LightsF64.fractions(jobs).unwrap();
    let (mut largest, mut squares) = (0.0_f64, 0.0);
    for (value, truth) in values.iter().zip(truth) {
        let error = (f64::from(*value) - truth).abs();
        (largest, squares) = (largest.max(error), squares + error * error);
    }
    Ok([largest, (squares / jobs.len() as f64).sqrt()])
}

/// What becomes of a coordinate whose weight has 8 bits between nodes.
fn with_8_bits(axis: &Axis, value: f64) -> f64 {
    let [low, high] = axis.domain.map(|x| axis.mapping.coordinate(x));
    let cells = (axis.len - 1) as f64;
    let position = ((axis.mapping.coordinate(value) - low) / (high - low) * cells).clamp(0.0, cells);
    let u = low + (position * 256.0).round() / 256.0 / cells * (high - low);
    axis.mapping.value(u)
}

/// The query as texture units with 8-bit weights see it: all axes of the isotropic table; those of the anisotropic but θ, which
/// the shader blends by itself.
fn seen_with_8_bits(table: &Table, query: &Query) -> Query {
    let alpha = |axis: &Axis| with_8_bits(axis, query.alpha_x);
    match table.axes() {
        [theta, a] => {
            let alpha = alpha(a);
            Query { theta: with_8_bits(theta, query.theta), alpha_x: alpha, alpha_y: alpha, ..*query }
        }
        [_, phi, a, lambda] => {
            let (sin, cos) = query.phi.sin_cos();
            let folded = with_8_bits(phi, sin.abs().atan2(cos.abs()));
            let phi = (folded.sin().copysign(sin)).atan2(folded.cos().copysign(cos));
            let alpha_x = alpha(a);
            let alpha_y = alpha_x * with_8_bits(lambda, query.alpha_y / query.alpha_x);
            Query { theta: query.theta, phi, alpha_x, alpha_y }
        }
        other => panic!("{} axes", other.len()),
    }
}

/// Texture units of hardware round weights to 8 bits; llvmpipe's do not, so that this is by the CPU in f64.
#[test]
fn weights_of_8_bits_cost_as_much_as_stated() {
    for (name, isotropic, bound) in [("ggx-isotropic", true, 1.2e-3), ("ggx-anisotropic", false, 4e-2)] {
        let table = table(name);
        let queries = draw::standard(COUNT, 71, isotropic);
        let jobs = light_jobs(LightKind::Quad, &table, &queries, 72);
        let (truth, mut largest, mut squares) = (LightsF64.fractions(&jobs).unwrap(), 0.0_f64, 0.0);
        for ((query, job), truth) in queries.iter().zip(&jobs).zip(truth) {
            let m = table.lookup(&seen_with_8_bits(&table, query)).unwrap().lobes[0].m.map(|x| x as f32);
            let job = LightJob { m, light: job.light.clone() };
            let error = (LightsF64.fractions(&[job]).unwrap()[0] - truth).abs();
            (largest, squares) = (largest.max(error), squares + error * error);
        }
        let rms = (squares / COUNT as f64).sqrt();
        println!("{name}, 8-bit weights: max {largest:.1e}, rms {rms:.1e}");
        assert!(largest <= bound && largest > 0.1 * bound, "{name}: {largest}");
    }
}

#[test]
fn each_way_to_keep_tables_has_its_stated_error() {
    for (filtering, texels, bounds) in BOUNDS {
        let options = GpuOptions { filtering, texels, ..GpuOptions::default() };
        let gpu = match Gpu::new(options) {
            Ok(gpu) => gpu,
            Err(error @ (GpuError::NoAdapter { .. } | GpuError::NotFilterable { .. })) => {
                println!("{filtering:?} {texels:?} skipped, because {error}");
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        for ((name, isotropic), bound) in
            [("ggx-isotropic", true), ("ggx-anisotropic", false)].into_iter().zip(bounds)
        {
            let table = table(name);
            let queries = draw::standard(COUNT, 71, isotropic);
            let jobs = light_jobs(LightKind::Quad, &table, &queries, 72);
            let found = errors(&gpu, &table, &queries, &jobs);
            match found {
                Ok(found) => {
                    println!("{name}, {filtering:?}, {texels:?}: max {:.1e}, rms {:.1e}", found[0], found[1]);
                    assert!(
                        found[0] <= bound[0] && found[1] <= bound[1],
                        "{name} {filtering:?} {texels:?}: {found:?}"
                    );
                }
                Err(error) => panic!("{name} {filtering:?} {texels:?}: {error}"),
            }
        }
    }
}
