//! The same specification gives the same table, whatever the number of threads.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use ltc_fit::{FitSpec, fit, publish, silent};
use ltc_table::{Axis, Mapping, Quantity};

/// A table of a few entries, every stage of the fit included.
fn small() -> FitSpec {
    let mut spec = FitSpec::preset("ggx-anisotropic").unwrap();
    spec.name = "small".to_owned();
    let lengths = [(Quantity::Theta, 4), (Quantity::Phi, 3), (Quantity::Alpha, 3), (Quantity::Lambda, 3)];
    spec.axes = lengths.map(|(quantity, len)| Axis::full(quantity, Mapping::Linear, len)).to_vec();
    (spec.entries.samples, spec.entries.iterations) = (128, 20);
    (spec.joint.steps, spec.joint.queries, spec.joint.samples) = (20, 256, 64);
    (spec.channels.samples, spec.channels.queries) = (256, 500);
    (spec.measure.samples, spec.measure.queries) = (256, 200);
    spec
}

/// Digest and manifest of a fit on this many threads.
fn fitted(spec: &FitSpec, threads: usize) -> (String, String) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (table, errors) = pool.install(|| fit(spec, &silent)).unwrap();
    let version = publish(spec, &table, errors, 1, "2026-01-01T00:00:00Z".to_owned()).unwrap();
    (version.manifest().digest.clone(), version.manifest_json().unwrap())
}

#[test]
fn the_digest_does_not_depend_on_the_threads() {
    let spec = small();
    let alone = fitted(&spec, 1);
    for threads in [2, 4] {
        assert_eq!(fitted(&spec, threads), alone, "{threads} threads");
    }
}

#[test]
fn the_digest_depends_on_every_seed() {
    // The control: queries drawn otherwise give another table.
    let digest = |change: fn(&mut FitSpec)| {
        let mut spec = small();
        change(&mut spec);
        fitted(&spec, 2).0
    };
    let first = digest(|_| ());
    assert_ne!(digest(|spec| spec.joint.seed += 1), first);
    assert_ne!(digest(|spec| spec.channels.seed += 1), first);
    // That of the measurement changes what is known of the table, not the table.
    let measured = |seed| {
        let mut spec = small();
        spec.measure.seed = seed;
        fitted(&spec, 2)
    };
    let (a, b) = (measured(100), measured(101));
    assert_eq!((&a.0, &b.0), (&first, &first));
    assert_ne!(a.1, b.1);
}
