//! What one material and one rectangular light cost on the CPU. Each bench checks its answers against `f64` and prints the
//! largest error beside its time.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ltc_core::{Light as _, Ltc, Matrix, Polygon, Real, Sides, Vector, points::SplitMix64};
use ltc_fit::draw;
use ltc_table::{Query, Table};

const COUNT: usize = 1024;

/// Corners of a square of random size and turn, 2 away around the mirror direction of `query`.
fn quad<R: Real>(query: &Query, rng: &mut SplitMix64) -> [R::Vec3; 4] {
    let mirror = ltc_fit::direction(query.theta, query.phi + std::f64::consts::PI);
    let side = mirror.any_orthonormal_vector();
    let up = mirror.cross(side);
    let half = rng.range(0.1, 1.6);
    let (a, b) = (rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| {
        let p = mirror * 2.0 + side * (half * x + a) + up * (half * y + b);
        R::Vec3::new(R::of(p.x), R::of(p.y), R::of(p.z))
    })
}

fn integrate<R: Real>(table: &Table, queries: &[Query]) -> (Vec<Ltc<R>>, Vec<[R::Vec3; 4]>) {
    let mut rng = SplitMix64::new(11);
    let lobe = |query: &Query| {
        let m = table.lookup(query).ok()?.lobes.first()?.m;
        Ltc::new(R::Mat3::from_row_array(m.map(R::of))).ok()
    };
    let lobes = queries.iter().map(|q| lobe(q).expect("a shipped table answers")).collect();
    (lobes, queries.iter().map(|q| quad::<R>(q, &mut rng)).collect())
}

fn value<R: Real>(ltc: &Ltc<R>, quad: &[R::Vec3; 4]) -> R {
    Polygon::new(quad, Sides::Two).map_or(R::ZERO, |p| p.integrate(ltc))
}

fn benches(c: &mut Criterion) {
    let tables = ltc_tables::shipped().expect("shipped tables are sound");
    let table = tables.find("ggx-anisotropic").expect("it is shipped").table();
    let queries = draw::standard(COUNT, 5, false);

    let mut next = (0..COUNT).cycle();
    let mut step = move || next.next().unwrap_or(0);
    c.bench_function("lookup/anisotropic/f64", |b| {
        b.iter(|| table.lookup(black_box(&queries[step()])));
    });

    let (exact_lobes, exact_quads) = integrate::<f64>(table, &queries);
    let (lobes, quads) = integrate::<f32>(table, &queries);
    let error = (0..COUNT)
        .map(|i| (f64::from(value(&lobes[i], &quads[i])) - value(&exact_lobes[i], &exact_quads[i])).abs())
        .fold(0.0, f64::max);
    assert!(error < 1e-3, "f32 is off by {error}: not worth timing");
    println!("quad/f32: largest error {error:.1e} against f64 (inputs rounded, too)");

    let mut group = c.benchmark_group("quad/exact");
    let mut next = (0..COUNT).cycle();
    let mut step = move || next.next().unwrap_or(0);
    group.bench_function(BenchmarkId::from_parameter("f64"), |b| {
        b.iter(|| {
            let i = step();
            value(black_box(&exact_lobes[i]), black_box(&exact_quads[i]))
        });
    });
    let mut next = (0..COUNT).cycle();
    let mut step = move || next.next().unwrap_or(0);
    group.bench_function(BenchmarkId::from_parameter("f32"), |b| {
        b.iter(|| {
            let i = step();
            value(black_box(&lobes[i]), black_box(&quads[i]))
        });
    });
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
