//! What one light over one lobe costs on the CPU, form by form, with its error.
//!
//! 1,024 materials of the standard draw, each with a light 2 away around its mirror direction, half-widths 0.1 to 1.6:
//! seeded, the same for all forms. Before a form is timed, its values are held against the oracle in `f64` on the very same
//! (rounded) inputs; the errors are printed. A new form is one line in [`benches`].

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DMat3, DVec3};
use ltc_benches::stability::{Case, oracle};
use ltc_core::points::SplitMix64;
use ltc_core::{
    AnyLight, Cubic, Cylinder, Disk, EdgeForm, Ellipse, Exact, Horizon, Light, Line, Ltc, LtcBatch,
    Matrix as _, Polygon, PublishedRational, Quad, QuadBatch, Rational, Real, Sides, Sphere, Strip,
    Vector as _,
};
use ltc_fit::draw;
use ltc_reference::{LtcLobe, PolygonOptions, Tolerance, integrate_polygon_boundary};

const COUNT: usize = 1024;

/// Where a light stands in the shading frame: its centre, and half its extent along two axes at right angles.
#[derive(Clone, Copy)]
struct Placed {
    centre: DVec3,
    u: DVec3,
    v: DVec3,
}

/// Materials and lights. Numbers are such as `f32` holds exactly.
struct Scene {
    lobes: Vec<DMat3>,
    lights: Vec<Placed>,
}

impl Scene {
    fn new() -> Self {
        let tables = ltc_tables::shipped().expect("shipped tables are sound");
        let table = tables.find("ggx-anisotropic").expect("it is shipped").table();
        let mut rng = SplitMix64::new(11);
        let (mut lobes, mut lights) = (Vec::new(), Vec::new());
        for query in draw::standard(COUNT, 5, false) {
            let lookup = table.lookup(&query).expect("a shipped table answers");
            let m = DMat3::from_row_array(lookup.lobes.first().expect("it has a lobe").m);
            lobes.push(m.as_mat3().as_dmat3());
            let mirror = ltc_fit::direction(query.theta, query.phi + std::f64::consts::PI);
            let side = mirror.any_orthonormal_vector();
            let up = mirror.cross(side);
            let (half, a, b) = (rng.range(0.1, 1.6), rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
            lights.push(Placed { centre: mirror * 2.0 + side * a + up * b, u: side * half, v: up * half });
        }
        Self { lobes, lights }
    }

    fn ltcs<R: Real>(&self) -> Vec<Ltc<R>> {
        let narrow = |m: &DMat3| R::Mat3::from_row_array(m.transpose().to_cols_array().map(R::of));
        self.lobes.iter().map(|m| Ltc::new(narrow(m)).expect("a shipped lobe is regular")).collect()
    }

    /// The light seen by each material: what a form is given, in precision `R`.
    fn inputs<I>(&self, light: impl Fn(&Placed) -> I) -> Vec<I> {
        self.lights.iter().map(light).collect()
    }

    /// The oracle's values for polygons.
    fn polygon_truth(&self, corners: usize) -> Vec<f64> {
        let options = PolygonOptions {
            two_sided: true,
            tolerance: Tolerance { absolute: 1e-10, relative: 0.0, max_evaluations: 1_000_000 },
        };
        let one = |(m, light): (&DMat3, &Placed)| {
            let lobe = LtcLobe::new(*m).expect("a shipped lobe is regular");
            integrate_polygon_boundary(&lobe, true, &ngon::<f64>(light, corners), options)
                .expect("the oracle converges")
                .value
        };
        self.lobes.iter().zip(&self.lights).map(one).collect()
    }
}

/// A polygon of `n` corners on the superellipse of the light, rounded to `f32`; for 4, the rectangle.
fn ngon<R: Real>(light: &Placed, n: usize) -> Vec<R::Vec3> {
    let corner = |i: usize| {
        let (sin, cos) = ((i as f64 + 0.5) * std::f64::consts::TAU / n as f64).sin_cos();
        let stretch = if n == 4 { std::f64::consts::SQRT_2 } else { 1.0 };
        let p = (light.centre + (light.u * cos + light.v * sin) * stretch).as_vec3().as_dvec3();
        R::Vec3::new(R::of(p.x), R::of(p.y), R::of(p.z))
    };
    (0..n).map(corner).collect()
}

fn corners<R: Real>(light: &Placed) -> [R::Vec3; 4] {
    let four = ngon::<R>(light, 4);
    [four[0], four[1], four[2], four[3]]
}

/// Holds `values` against `truth` and says how far they are off.
fn check(name: &str, values: impl Iterator<Item = f64>, truth: &[f64], bound: f64) {
    let (mut max, mut squares) = (0.0_f64, 0.0);
    for (value, exact) in values.zip(truth) {
        max = max.max((value - exact).abs());
        squares += (value - exact).powi(2);
    }
    let rms = (squares / truth.len() as f64).sqrt();
    println!("integrate/{name}: error {max:.1e} at most, {rms:.1e} RMS");
    assert!(max <= bound, "{name} is off by {max:e}: not worth timing");
}

/// Checks and times one form, light after light.
fn form<R: Real, I>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    (ltcs, inputs, truth): (&[Ltc<R>], &[I], &[f64]),
    bound: f64,
    value: impl Fn(&I, &Ltc<R>) -> R,
) {
    check(name, inputs.iter().zip(ltcs).map(|(i, ltc)| value(i, ltc).to_f64()), truth, bound);
    let mut next = (0..inputs.len()).cycle();
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter(|| {
            let i = next.next().unwrap_or(0);
            value(black_box(&inputs[i]), black_box(&ltcs[i]))
        });
    });
}

/// Checks and times a batch of all lights at once; the time is that of one light.
fn batch(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    truth: &[f64],
    bound: f64,
    integrate: impl Fn(&mut [f32]),
) {
    let mut out = vec![0.0; truth.len()];
    integrate(&mut out);
    check(name, out.iter().map(|x| f64::from(*x)), truth, bound);
    group.throughput(Throughput::Elements(truth.len() as u64));
    group.bench_function(name, |b| b.iter(|| integrate(black_box(&mut out))));
}

fn polygon<R: Real>(vertices: &[R::Vec3], ltc: &Ltc<R>) -> R {
    Polygon::new(vertices, Sides::Two).map_or(R::ZERO, |p| p.integrate(ltc))
}

fn quad<R: Real>(vertices: &[R::Vec3; 4], ltc: &Ltc<R>) -> R {
    Quad::new(*vertices, Sides::Two).map_or(R::ZERO, |q| q.integrate(ltc))
}

fn by<F: EdgeForm>(vertices: &[glam::Vec3; 4], ltc: &Ltc<f32>) -> f32 {
    Quad::new(*vertices, Sides::Two).map_or(0.0, |q| q.integrate_with::<F>(ltc, Horizon::BOTH))
}

fn proxy(vertices: &[glam::Vec3; 4], ltc: &Ltc<f32>) -> f32 {
    Quad::new(*vertices, Sides::Two).map_or(0.0, |q| q.integrate_proxy::<Rational>(ltc, true))
}

fn leaky(vertices: &[glam::Vec3; 4], ltc: &Ltc<f32>) -> f32 {
    Quad::new(*vertices, Sides::Two).map_or(0.0, |q| q.integrate_within(ltc, Horizon::COSINE))
}

/// A vector whose numbers `f32` holds.
fn vector<R: Real>(p: [f64; 3]) -> R::Vec3 {
    let [x, y, z] = p.map(|x| R::of(f64::from(x as f32)));
    R::Vec3::new(x, y, z)
}

/// Half-widths of thin lights, and radii of tubes.
const THIN: f64 = 0.03125;
const WIDE: f64 = 0.25;

/// One light of each shape in the place of a rectangle: line, strip, cylinder, disk, ellipse, sphere.
fn shapes(l: &Placed) -> [AnyLight; 6] {
    let (p0, p1) = ((l.centre - l.u).to_array(), (l.centre + l.u).to_array());
    let (center, normal, sides) = (l.centre.to_array(), (-l.centre).to_array(), Sides::Two);
    let (axis_u, axis_v, radius) = (l.u.to_array(), (l.v * 0.5).to_array(), l.u.length());
    [
        AnyLight::Line { p0, p1, radius: THIN },
        AnyLight::Strip { p0, p1, width: 2.0 * THIN, normal, sides },
        AnyLight::Cylinder { p0, p1, radius: WIDE, caps: true },
        AnyLight::Disk { center, normal, radius, sides },
        AnyLight::Ellipse { center, axis_u, axis_v, sides },
        AnyLight::Sphere { center, radius },
    ]
}

/// The light ready made in a precision.
fn ready<R: Real>(light: &AnyLight) -> Box<dyn Light<R>> {
    const SOUND: &str = "lights of the scene are sound";
    let (v, r) = (|p: &[f64; 3]| vector::<R>(*p), |x: &f64| R::of(f64::from(*x as f32)));
    match light {
        AnyLight::Line { p0, p1, radius } => Box::new(Line::new(v(p0), v(p1), r(radius)).expect(SOUND)),
        AnyLight::Strip { p0, p1, width, normal, sides } => {
            Box::new(Strip::new(v(p0), v(p1), r(width), v(normal), *sides).expect(SOUND))
        }
        AnyLight::Cylinder { p0, p1, radius, caps } => {
            Box::new(Cylinder::new(v(p0), v(p1), r(radius), *caps).expect(SOUND))
        }
        AnyLight::Disk { center, normal, radius, sides } => {
            Box::new(Disk::new(v(center), v(normal), r(radius), *sides).expect(SOUND))
        }
        AnyLight::Ellipse { center, axis_u, axis_v, sides } => {
            Box::new(Ellipse::new(v(center), v(axis_u), v(axis_v), *sides).expect(SOUND))
        }
        AnyLight::Sphere { center, radius } => Box::new(Sphere::new(v(center), r(radius)).expect(SOUND)),
        AnyLight::Polygon { .. } => unreachable!("polygons have benches of their own"),
    }
}

fn other_shapes(group: &mut BenchmarkGroup<'_, WallTime>, scene: &Scene, l64: &[Ltc<f64>], l32: &[Ltc<f32>]) {
    let lights: Vec<[AnyLight; 6]> = scene.lights.iter().map(shapes).collect();
    for k in 0..6 {
        let name = lights[0][k].name();
        let cases = scene.lobes.iter().zip(&lights).map(|(m, l)| Case::new(*m, l[k].clone(), false));
        let truth: Vec<f64> = cases.map(|case| oracle(&case)).collect();
        let double: Vec<_> = lights.iter().map(|l| ready::<f64>(&l[k])).collect();
        let single: Vec<_> = lights.iter().map(|l| ready::<f32>(&l[k])).collect();
        form(group, &format!("{name}/f64"), (l64, &double, &truth), 1e-8, |light, ltc| light.integrate(ltc));
        form(group, &format!("{name}/f32"), (l32, &single, &truth), 1e-3, |light, ltc| light.integrate(ltc));
    }
}

fn benches(c: &mut Criterion) {
    let scene = Scene::new();
    let (l64, l32) = (scene.ltcs::<f64>(), scene.ltcs::<f32>());
    let group = &mut c.benchmark_group("integrate");

    let truth = &scene.polygon_truth(4)[..];
    let (q64, q32) = (&scene.inputs(corners::<f64>)[..], &scene.inputs(corners::<f32>)[..]);
    form(group, "quad/exact/f64", (&l64, q64, truth), 1e-9, quad::<f64>);
    form(group, "quad/exact/f32", (&l32, q32, truth), 1e-4, quad::<f32>);
    // Each horizon is a choice: this one leaves out the surface's, and leaks.
    form(group, "quad/cosine_horizon_alone/f32", (&l32, q32, truth), 0.5, leaky);
    form(group, "quad/edges_exact/f32", (&l32, q32, truth), 1e-3, by::<Exact>);
    form(group, "quad/edges_rational/f32", (&l32, q32, truth), 1e-3, by::<Rational>);
    form(group, "quad/edges_published/f32", (&l32, q32, truth), 1e-3, by::<PublishedRational>);
    form(group, "quad/edges_cubic/f32", (&l32, q32, truth), 2e-3, by::<Cubic>);
    form(group, "quad/proxy/f32", (&l32, q32, truth), 0.05, proxy);

    let (mut quads, mut ltcs) = (QuadBatch::new(), LtcBatch::new());
    quads.extend(q32.iter().filter_map(|q| Quad::new(*q, Sides::Two).ok()));
    ltcs.extend(l32.iter().copied());
    batch(group, "quad/batched_each/f32", truth, 1e-4, |out| {
        quads.integrate_each(black_box(&ltcs), Horizon::BOTH, out).expect("as many as there are");
    });
    let one: Vec<f64> = q64.iter().map(|q| quad(q, &l64[0])).collect();
    batch(group, "quad/batched_one_lobe/f32", &one, 1e-4, |out| {
        quads.integrate(black_box(&l32[0]), Horizon::BOTH, out).expect("as many as there are");
    });

    for n in [3, 4, 8, 16, 32, 64] {
        let truth = &scene.polygon_truth(n)[..];
        let (p64, p32) = (scene.inputs(|l| ngon::<f64>(l, n)), scene.inputs(|l| ngon::<f32>(l, n)));
        form(group, &format!("polygon/{n}/f64"), (&l64, &p64, truth), 1e-9, |p, ltc| polygon(p, ltc));
        form(group, &format!("polygon/{n}/f32"), (&l32, &p32, truth), 1e-4, |p, ltc| polygon(p, ltc));
    }
    other_shapes(group, &scene, &l64, &l32);
}

criterion_group!(all, benches);
criterion_main!(all);
