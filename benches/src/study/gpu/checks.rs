//! The published forms against `ltc_core`'s own of the same approximation, and a planted error.

use ltc_core::{Horizon, Ltc, Polygon, PublishedRational, Rational, Sides};
use ltc_shade_gpu::timing::Stage;
use ltc_shade_gpu::{Filtering, Gpu, GpuOptions, LightKind, LightShape};

use super::super::StudyError;
use super::bench::{Bench, Reads, placed};
use super::scene::{Pixel, fraction};
use super::sources::{self, Find, Integrate};
use super::tables::Published;

/// Skips, with a word, where there is no device; fails with `CI` set.
fn gpu() -> Option<Gpu> {
    match Gpu::new(GpuOptions { filtering: Filtering::Exact, ..GpuOptions::default() }) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            eprintln!("skipped, because no GPU adapter can run this: {error}");
            None
        }
    }
}

/// Largest error and root mean square of a form's first light against `truth`.
fn errors(
    gpu: &Gpu,
    kind: LightKind,
    sunk: bool,
    wgsl: &str,
    further: &[ltc_shade_gpu::timing::Resource],
    truth: impl Fn(&LightShape, &Pixel) -> Result<f64, StudyError>,
) -> Result<[f64; 2], StudyError> {
    let (lights, points) = placed(kind, 2, sunk);
    let mut bench = Bench::new(gpu, [160, 90], Some(4000))?;
    let judge = |pixel: &Pixel| {
        let [first, second] = [truth(&lights[0], pixel)?, truth(&lights[1], pixel)?];
        Ok([None, Some(first), Some(second), Some(second)])
    };
    let reads = Reads { points: &points, further, ..Reads::default() };
    let (_, errors) = bench.add("check", gpu, Stage::Compute, wgsl, reads, &[2], Some((&judge, 1.0)))?;
    Ok(errors.unwrap())
}

/// The corners as the pixel sees them, and its lobe.
fn seen(light: &LightShape, pixel: &Pixel) -> Result<(Vec<glam::DVec3>, Ltc<f64>), StudyError> {
    let LightShape::Quad { corners, .. } = light else { panic!("no quad") };
    let corners = corners.iter().map(|c| c.as_dvec3() - pixel.position.as_dvec3()).collect();
    Ok((corners, Ltc::new(pixel.matrix())?))
}

#[test]
fn the_published_quad_clips_in_cosine_space_alone_and_leaks() -> Result<(), StudyError> {
    let Some(gpu) = gpu() else { return Ok(()) };
    let wgsl = sources::lights(Find::PublishedFormula, Integrate::PublishedQuad);
    for sunk in [false, true] {
        let own = |light: &LightShape, pixel: &Pixel| {
            let (corners, ltc) = seen(light, pixel)?;
            let quad = Polygon::new(&corners, Sides::Two)?;
            Ok(quad.integrate_with::<PublishedRational>(&ltc, Horizon::COSINE))
        };
        let [max, rms] = errors(&gpu, LightKind::Quad, sunk, &wgsl, &[], own)?;
        println!("published quad against its own form: {max:.1e}, {rms:.1e}");
        assert!(max < 1e-5, "{max}");
        let exact =
            |light: &LightShape, pixel: &Pixel| fraction(light, pixel, pixel.matrix(), Horizon::COSINE);
        let [max, _] = errors(&gpu, LightKind::Quad, sunk, &wgsl, &[], exact)?;
        assert!(max < 3e-5, "the rational edge costs {max}");
    }
    let both = |light: &LightShape, pixel: &Pixel| fraction(light, pixel, pixel.matrix(), Horizon::BOTH);
    let [max, _] = errors(&gpu, LightKind::Quad, true, &wgsl, &[], both)?;
    assert!((0.01..0.5).contains(&max), "what is below the surface leaks: {max}");
    Ok(())
}

#[test]
fn the_proxy_is_as_near_as_a_sphere_is() -> Result<(), StudyError> {
    let Some(gpu) = gpu() else { return Ok(()) };
    let tables = ltc_tables::shipped()?;
    let [_, sphere, filter] = Published::of(&tables)?.isotropic_textures(&gpu)?;
    let wgsl = sources::lights(Find::PublishedFormula, Integrate::PublishedProxy);
    let own = |light: &LightShape, pixel: &Pixel| {
        let (corners, ltc) = seen(light, pixel)?;
        Ok(Polygon::new(&corners, Sides::One)?.integrate_proxy::<Rational>(&ltc, false))
    };
    let further = [sphere, filter];
    let [max, rms] = errors(&gpu, LightKind::Quad, false, &wgsl, &further, own)?;
    println!("published proxy against ltc_core's: {max:.1e}, {rms:.1e}");
    // The fit there is 2e-3 off, the table of 64 by 64 here a little less.
    assert!(max < 5e-3, "{max}");
    let exact = |light: &LightShape, pixel: &Pixel| fraction(light, pixel, pixel.matrix(), Horizon::COSINE);
    let [max, rms] = errors(&gpu, LightKind::Quad, false, &wgsl, &further, exact)?;
    assert!((1e-4..0.02).contains(&max) && rms < 2e-3, "{max}, {rms}");
    Ok(())
}

#[test]
fn the_published_line_with_its_errata_is_the_integral() -> Result<(), StudyError> {
    let Some(gpu) = gpu() else { return Ok(()) };
    let wgsl = sources::lights(Find::PublishedFormula, Integrate::PublishedLine);
    let exact = |light: &LightShape, pixel: &Pixel| fraction(light, pixel, pixel.matrix(), Horizon::COSINE);
    let [max, rms] = errors(&gpu, LightKind::Line, false, &wgsl, &[], exact)?;
    println!("published line: {max:.1e}, {rms:.1e}");
    assert!(max < 1e-5, "{max}");
    // As printed, with 1 * 1 for l * l, it is not.
    let printed = wgsl.replace("l * l", "1.0 * 1.0");
    let [max, _] = errors(&gpu, LightKind::Line, false, &printed, &[], exact)?;
    assert!(max > 1e-3, "the erratum is seen: {max}");
    Ok(())
}

#[test]
fn a_form_that_is_wrong_is_not_timed() -> Result<(), StudyError> {
    let Some(gpu) = gpu() else { return Ok(()) };
    let (lights, points) = placed(LightKind::Quad, 1, false);
    let truth = |pixel: &Pixel| {
        let exact = fraction(&lights[0], pixel, pixel.matrix(), Horizon::BOTH)?;
        Ok([None, Some(exact), None, None])
    };
    let reads = Reads { points: &points, ..Reads::default() };
    let sound = sources::lights(Find::Formula, Integrate::Shipped(LightKind::Quad, sources::BOTH_HORIZONS));
    // A wrong coefficient of the arc.
    let planted = sound.replace("1.5707963 * square", "1.60 * square");
    assert_ne!(planted, sound);
    for (wgsl, good) in [(&sound, true), (&planted, false)] {
        let mut bench = Bench::new(&gpu, [64, 36], Some(500))?;
        let added = bench.add("quad", &gpu, Stage::Compute, wgsl, reads, &[1], Some((&truth, 1e-3)));
        assert_eq!(added.is_ok(), good, "{added:?}");
    }
    Ok(())
}
