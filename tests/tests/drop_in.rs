//! The textures that engines ship, written from the shipped table and read as an engine reads them.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use ltc_fit::{GgxFamily, Layout, Reader, draw, measure};
use ltc_table::{DropIn, Precision, Query};
use ltc_tests::shipped;

#[path = "../../crates/ltc-fit/examples/support/numpy.rs"]
mod numpy;

const SAMPLES: usize = 2048;

fn textures(precision: Precision) -> DropIn {
    let catalogue = shipped();
    let table = catalogue.find("ggx-isotropic-dropin").unwrap().table().clone();
    let [ltc_1, ltc_2] = DropIn::of(&table).unwrap().dds(precision).unwrap();
    DropIn::read_dds(&ltc_1, &ltc_2).unwrap()
}

fn mean_tv(reader: &Reader<'_>, queries: &[Query]) -> f64 {
    let tv = measure::query_tv(&GgxFamily, reader, queries, SAMPLES).unwrap();
    tv.iter().sum::<f64>() / tv.len() as f64
}

/// The 600 queries from which the errors of the textures that engines ship were first stated: 0.0599.
fn first_queries() -> Vec<Query> {
    let mut rng = numpy::DefaultRng::new(77);
    let mut column = |low, high| rng.uniform(low, high, 600);
    let (choice, even, root) = (column(0.0, 1.0), column(0.01, 1.0), column(0.1, 1.0));
    let _lambda = column(0.05, 1.0);
    let theta = column(0.0, 86.0_f64.to_radians());
    (0..600)
        .map(|i| {
            let alpha = if choice[i] < 0.5 { even[i] } else { root[i] * root[i] };
            Query { theta: theta[i], phi: 0.0, alpha_x: alpha, alpha_y: alpha }
        })
        .collect()
}

#[test]
fn the_generator_is_numpys() {
    // numpy.random.default_rng(77).random(3), NumPy 2.4
    let mut rng = numpy::DefaultRng::new(77);
    for expected in [0.785_932_31, 0.551_171_96, 0.243_888_2] {
        assert!((rng.unit() - expected).abs() < 1e-8);
    }
}

#[test]
fn an_engine_gets_nearly_the_least_error_there_is() {
    let first = first_queries();
    let draw = draw::standard(800, 2024, true);
    let least = |queries: &[Query]| {
        let tv = measure::optimum(&GgxFamily, queries, SAMPLES).unwrap();
        tv.iter().sum::<f64>() / tv.len() as f64
    };
    let (least_first, least_draw) = (least(&first), least(&draw));
    for precision in [Precision::F16, Precision::F32] {
        let reader = Reader::DropIn(Box::new(textures(precision)));
        let tv = mean_tv(&reader, &first);
        assert!(tv <= 0.036 && tv < least_first + 5e-4, "{precision:?}: {tv}, least {least_first}");
        let tv = mean_tv(&reader, &draw);
        assert!(tv < least_draw + 5e-4, "{precision:?}: {tv}, least {least_draw}");
    }
}

/// The same textures read with the two shears exchanged.
#[test]
fn a_wrong_reading_is_seen() {
    let [ltc_1, ltc_2] = {
        let catalogue = shipped();
        let table = catalogue.find("ggx-isotropic-dropin").unwrap().table().clone();
        DropIn::of(&table).unwrap().dds(Precision::F32).unwrap()
    };
    let mut wrong = ltc_1;
    for texel in wrong[128..].chunks_exact_mut(16) {
        let (left, right) = texel.split_at_mut(8);
        left[4..8].swap_with_slice(&mut right[0..4]);
    }
    let reader = Reader::DropIn(Box::new(DropIn::read_dds(&wrong, &ltc_2).unwrap()));
    assert!(mean_tv(&reader, &draw::standard(200, 5, true)) > 0.2);
}

#[test]
fn every_texel_and_every_point_between_is_a_lobe() {
    for precision in [Precision::F16, Precision::F32] {
        let textures = textures(precision);
        for i in 0..=253 {
            for j in 0..=253 {
                let (theta, alpha) =
                    (core::f64::consts::FRAC_PI_2 * f64::from(i) / 253.0, f64::from(j) / 253.0);
                let found =
                    textures.lookup(&Query { theta, phi: 0.0, alpha_x: alpha, alpha_y: alpha }).unwrap();
                assert!(found.magnitude >= found.fresnel && found.magnitude <= 1.0, "{theta} {alpha}");
            }
        }
        assert_eq!(textures.size(), 64);
    }
}

/// Magnitude and Fresnel term through the textures, θ up to 89°.
#[test]
fn its_albedos_are_right() {
    let catalogue = shipped();
    let version = catalogue.find("ggx-isotropic-dropin").unwrap();
    let settings = measure::MeasureSettings { queries: 800, samples: 4096, seed: 9, layout: Layout::DropIn };
    let errors = measure::errors(&GgxFamily, version.table(), version.table().cells(), settings).unwrap();
    // Above 88° and below α = 0.02 the magnitude turns within one step of the 64 nodes that engines have.
    assert!(errors.magnitude_mean < 2e-4 && errors.magnitude_max < 1.5e-2, "{errors:?}");
    assert!(errors.fresnel_mean < 2e-3 && errors.fresnel_max < 1e-2, "{errors:?}");
}
