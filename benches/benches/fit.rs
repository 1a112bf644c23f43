//! What fitting costs: lobe-sample evaluations a second against what the core could do at most, and one entry by each
//! objective.
//!
//! An evaluation is one sample of a lobe compared with one LTC: its share of the LTC's density, its part of the objective,
//! and, with the gradient, of the nine derivatives by `M`. The roofline is the rate of multiplications and additions of `f64` that this very
//! program reaches in a loop that does nothing else; floating-point operations of an evaluation are counted from its source.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DMat3, DVec3};
use ltc_core::{Alpha, Ltc, points::SplitMix64};
use ltc_fit::{
    Brdf as _, DiskPoints, GgxFamily, Lobe, Objective, Pattern, direction, median_start, refine_by,
    total_variation, total_variation_gradient,
};

const SAMPLES: usize = 512;
const MATRICES: usize = 64;

/// Operations for each sample of `objective::kernel::sum`: Mω (15), its square (5), a reciprocal (1), the share (4), the excess, its positive
/// part and the sum (4).
const FLOPS_OF_VALUE: f64 = 29.0;
/// The same of `sum_with_gradient`: besides, the derivative by the share (1), its two factors (4), what is covered (2), the row (4),
/// and the outer product (18).
const FLOPS_OF_GRADIENT: f64 = 58.0;

/// `f64` that one instruction holds, as this program was compiled.
const LANES: f64 = if cfg!(target_feature = "avx512f") {
    8.0
} else if cfg!(target_feature = "avx") {
    4.0
} else {
    2.0
};

/// A lobe and LTCs around its best one, as a fit meets them.
struct Scene {
    lobe: Lobe,
    wo: DVec3,
    near: Vec<DMat3>,
}

impl Scene {
    fn new() -> Self {
        let (wo, alpha) = (direction(0.9, 0.6), Alpha::new(0.4, 0.15).expect("valid widths"));
        let mut lobe = Lobe::default();
        GgxFamily.sample_lobe(wo, alpha, &DiskPoints::new(SAMPLES, [0.5, 0.5]), &mut lobe);
        let start = median_start(&lobe, wo, Pattern::General);
        let mut rng = SplitMix64::new(7);
        let mut shaken = || DMat3::from_cols_array(&core::array::from_fn(|_| rng.range(-0.2, 0.2)));
        let near = (0..MATRICES).map(|_| start * (DMat3::IDENTITY + shaken())).collect();
        Self { lobe, wo, near }
    }

    /// The largest error of the values and of the gradients (one random direction each) against the definition, with the density
    /// of `ltc_core`.
    fn errors(&self) -> (f64, f64) {
        let mut rng = SplitMix64::new(8);
        let (mut of_value, mut of_gradient) = (0.0_f64, 0.0_f64);
        for m in &self.near {
            let (value, gradient) = total_variation_gradient(&self.lobe, *m);
            of_value = of_value.max((value - self.defined(*m)).abs());
            of_value = of_value.max((total_variation(&self.lobe, *m) - value).abs());
            let way = DMat3::from_cols_array(&core::array::from_fn(|_| rng.range(-1.0, 1.0)));
            let slope: f64 =
                gradient.to_cols_array().iter().zip(way.to_cols_array()).map(|(g, d)| g * d).sum();
            let h = 1e-7;
            let quotient = (self.defined(*m + way * h) - self.defined(*m - way * h)) / (2.0 * h);
            of_gradient = of_gradient.max((slope - quotient).abs());
        }
        (of_value, of_gradient)
    }

    /// `E_p[max(0, 1 − q/p)]`.
    fn defined(&self, m: DMat3) -> f64 {
        let ltc = Ltc::<f64>::new(m).expect("a regular matrix");
        let excess = |i| self.lobe.weight[i] - self.lobe.inverse[i] * ltc.density(self.lobe.direction(i));
        (0..self.lobe.len()).map(|i| f64::max(0.0, excess(i))).sum()
    }
}

/// The shortest of many runs, each of about a millisecond: other work on the machine only makes runs longer.
fn seconds_at_best(mut run: impl FnMut()) -> f64 {
    let once = |run: &mut dyn FnMut(), times: u32| {
        let start = Instant::now();
        (0..times).for_each(|_| run());
        start.elapsed() / times
    };
    let first = once(&mut run, 3).max(Duration::from_nanos(100));
    let times = (Duration::from_millis(1).as_nanos() / first.as_nanos()).clamp(1, 100_000) as u32;
    (0..200).map(|_| once(&mut run, times)).min().unwrap_or(first).as_secs_f64()
}

/// Multiplications and additions a second, in independent chains enough to hide how long each takes.
fn peak() -> f64 {
    const CHAINS: usize = 24;
    const LENGTH: usize = 4096;
    let (a, b) = (black_box(0.999_999), black_box(1e-6));
    let seconds = seconds_at_best(|| {
        let mut x: [f64; CHAINS] = black_box([1.0; CHAINS]);
        for _ in 0..LENGTH {
            for x in &mut x {
                *x = *x * a + b;
            }
        }
        assert!(black_box(x).iter().all(|x| (0.9..1.1).contains(x)));
    });
    (2 * CHAINS * LENGTH) as f64 / seconds
}

fn print_roofline(scene: &Scene) {
    let peak = peak();
    let scalar = peak / LANES;
    println!(
        "peak of one core: {:.1} GFLOP/s, {:.1} scalar (vectors of {LANES})",
        peak * 1e-9,
        scalar * 1e-9
    );
    let mut sum = 0.0;
    let of_value = seconds_at_best(|| {
        sum += scene.near.iter().map(|m| total_variation(black_box(&scene.lobe), *m)).sum::<f64>();
    });
    let of_gradient = seconds_at_best(|| {
        sum += scene
            .near
            .iter()
            .map(|m| total_variation_gradient(black_box(&scene.lobe), *m).1.x_axis.x)
            .sum::<f64>();
    });
    black_box(sum);
    for (name, seconds, flops) in
        [("value", of_value, FLOPS_OF_VALUE), ("value and gradient", of_gradient, FLOPS_OF_GRADIENT)]
    {
        let rate = (SAMPLES * MATRICES) as f64 / seconds;
        println!(
            "total variation, {name}: {:.0} million evaluations a second, {:.2} GFLOP/s: {:.0} % of the scalar roofline \
             ({:.0} million a second), {:.0} % of the vectors'",
            rate * 1e-6,
            rate * flops * 1e-9,
            100.0 * rate * flops / scalar,
            scalar / flops * 1e-6,
            100.0 * rate * flops / peak,
        );
    }
}

fn benches(c: &mut Criterion) {
    let scene = Scene::new();
    let (of_value, of_gradient) = scene.errors();
    assert!(of_value < 1e-12 && of_gradient < 1e-5, "{of_value} {of_gradient}: not worth timing");
    println!(
        "total variation: largest error {of_value:.1e}, of the gradient {of_gradient:.1e} (difference quotients)"
    );
    print_roofline(&scene);

    let mut group = c.benchmark_group("fit/evaluation");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let mut next = (0..MATRICES).cycle();
    let mut step = move || next.next().unwrap_or(0);
    group.bench_function("total_variation/value", |b| {
        b.iter(|| total_variation(black_box(&scene.lobe), black_box(scene.near[step()])));
    });
    for objective in Objective::ALL {
        let goal = objective.towards(&scene.lobe);
        group.bench_function(format!("{}/gradient", objective.name()), |b| {
            b.iter(|| goal.value_and_gradient(black_box(scene.near[step()])));
        });
    }
    group.finish();

    let mut group = c.benchmark_group("fit/entry");
    group.sample_size(10);
    for objective in Objective::ALL {
        let fit = || {
            let start = median_start(black_box(&scene.lobe), scene.wo, Pattern::General);
            refine_by(&objective.towards(&scene.lobe), start, Pattern::General, 100)
        };
        let found = fit();
        assert!(found.tv < 0.2, "{}: {found:?}", objective.name());
        println!(
            "{}: TV {:.4} after {} evaluations of the lobe",
            objective.name(),
            found.tv,
            found.evaluations
        );
        group.bench_function(objective.name(), |b| b.iter(fit));
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
