//! The example of a BRDF of one's own keeps its promises, and what is no BRDF is refused.

use glam::DVec3;
use ltc_core::Alpha;
use ltc_fit::{Brdf, FitError, FitSpec, fit_with, publish_with, silent, verify, verify_with};

#[path = "../examples/own_brdf.rs"]
mod example;

#[test]
fn it_is_under_forty_lines_and_runs() {
    let lines = include_str!("../examples/own_brdf.rs").lines().count();
    assert!(lines < 40, "{lines}");
    example::main().expect("the example runs");
}

/// Reflects `value` everywhere.
struct Flat(f64);

impl Brdf for Flat {
    fn name(&self) -> &'static str {
        "flat"
    }

    fn eval_cos(&self, _: DVec3, wi: DVec3, _: Alpha) -> f64 {
        self.0 * wi.z
    }
}

fn small() -> FitSpec {
    let mut spec = FitSpec::preset("oren-nayar").expect("a preset");
    (spec.name, spec.brdf) = ("flat".to_owned(), "flat".to_owned());
    spec.axes.iter_mut().for_each(|axis| axis.len = 3);
    (spec.joint.steps, spec.joint.queries, spec.joint.samples) = (20, 64, 64);
    (spec.channels.samples, spec.channels.queries) = (4096, 100);
    (spec.measure.samples, spec.measure.queries) = (1024, 200);
    spec
}

#[test]
fn a_lambertian_of_ones_own_is_fitted_published_and_verified() {
    let (spec, brdf) = (small(), Flat(0.5 / std::f64::consts::PI));
    let (table, errors) = fit_with(&brdf, &spec, &silent).expect("a sound BRDF");
    assert!(errors.standard_draw.tv_mean < 0.01, "a cosine is a cosine: {errors:?}");
    for magnitude in table.magnitude() {
        assert!((magnitude - 0.5).abs() < 2e-3, "{magnitude}");
    }
    let version =
        publish_with(&brdf, &spec, &table, errors, 1, "2000-01-01T00:00:00Z".into()).expect("sound");
    let found = verify_with(&brdf, &version).expect("known");
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    // The control: another BRDF of the same name is noticed. And by its name alone nobody knows it.
    let darker = verify_with(&Flat(0.4 / std::f64::consts::PI), &version).expect("known");
    assert!(darker.faults.iter().any(|f| f.starts_with("errors.magnitude")), "{:?}", darker.faults);
    let error = verify(&version).expect_err("no such family").to_string();
    assert!(error.starts_with("brdf:") && error.contains("oren-nayar"), "{error}");
}

#[test]
fn what_is_no_brdf_is_refused_before_the_work() {
    for value in [f64::NAN, f64::INFINITY, -1.0] {
        let error = fit_with(&Flat(value), &small(), &|_| panic!("work was done")).expect_err("no BRDF");
        assert!(matches!(error, FitError::Brdf { name: "flat", what: "value", .. }), "{error}");
    }
    let other = FitSpec { brdf: "ggx".to_owned(), ..small() };
    let error = fit_with(&Flat(0.1), &other, &silent).expect_err("another name").to_string();
    assert!(error.starts_with("brdf:"), "{error}");
}
