//! Programs over a grid of pixels: what they write, and how long they take.

use std::time::Duration;

use ltc_shade_gpu::Filtering;
use ltc_shade_gpu::timing::{PixelGrid, PixelProgram, PixelSource, Resource, Stage, Turns, in_turns};

use crate::support::gpu;

/// A chain of as many steps as the uniform says, which no compiler shortens, beside the pixel's coordinates.
const CHAIN: &str = "
@group(1) @binding(0) var<uniform> steps: vec4u;
fn pixel(at: vec2u, index: u32) -> vec4f {
    var x = f32(index % 64u);
    for (var i = 0u; i < steps.x; i++) {
        x = fract(x * 1.618034 + 0.1);
    }
    return vec4f(vec2f(at), f32(index), x);
}";

#[test]
fn every_pixel_is_written_once_in_both_stages() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    // Neither a multiple of a workgroup nor rows that a copy likes.
    let grid = PixelGrid::new(&gpu, 37, 21).unwrap();
    let steps = [Resource::uniform(&gpu, &[3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap()];
    let mut all = Vec::new();
    for stage in Stage::ALL {
        let source = PixelSource { wgsl: CHAIN, stage, tables: None, resources: &steps };
        let pixels = PixelProgram::new(&gpu, &grid, &source).unwrap().pixels(&gpu, &grid).unwrap();
        assert_eq!(pixels.len(), grid.count());
        for (i, [x, y, index, _]) in pixels.iter().enumerate() {
            let (x, y) = (*x as usize, *y as usize);
            assert_eq!((y * 37 + x, *index as usize), (i, i), "{stage:?}");
        }
        all.push(pixels);
    }
    assert_eq!(all[0], all[1], "the stages compute the same");
}

#[test]
fn what_is_not_finite_is_an_error() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let grid = PixelGrid::new(&gpu, 16, 8).unwrap();
    let wgsl = "fn pixel(at: vec2u, index: u32) -> vec4f {
        return vec4f(1.0, 1.0, 1.0, f32(at.x) / f32(min(at.y, 5u) % 5u)); }";
    for stage in Stage::ALL {
        let source = PixelSource { wgsl, stage, tables: None, resources: &[] };
        let error = PixelProgram::new(&gpu, &grid, &source).unwrap().pixels(&gpu, &grid).unwrap_err();
        assert!(error.to_string().starts_with("pixel 0 came back"), "{error}");
    }
    let broken = PixelSource { wgsl: "fn pixel(", stage: Stage::Compute, tables: None, resources: &[] };
    assert!(PixelProgram::new(&gpu, &grid, &broken).is_err(), "an error, not a panic");
}

#[test]
fn twice_the_work_takes_twice_the_time() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let grid = PixelGrid::new(&gpu, 256, 128).unwrap();
    let steps =
        |n: u32| Resource::uniform(&gpu, &[n.to_le_bytes(), [0; 4], [0; 4], [0; 4]].concat()).unwrap();
    for stage in Stage::ALL {
        let source = PixelSource { wgsl: CHAIN, stage, tables: None, resources: &[steps(2000)] };
        let one = PixelProgram::new(&gpu, &grid, &source).unwrap();
        let two = one.with(&gpu, &[steps(4000)]).unwrap();
        let turns = Turns { shortest: 1e6, warm_up: Duration::ZERO, least: 9, most: 9 };
        let (clock, mut samples) = in_turns(&gpu, &grid, &[&one, &two], turns, |_| false).unwrap();
        eprintln!("{stage:?}: {clock}");
        let medians = samples.iter_mut().map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        let medians: Vec<f64> = medians.collect();
        let ratio = medians[1] / medians[0];
        // Turns fall on both alike, but not evenly on a busy machine.
        assert!((1.6..2.5).contains(&ratio), "{stage:?}: {medians:?}");
    }
}
