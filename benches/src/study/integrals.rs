//! One light over one lobe, form by form: what is timed, and its oracle.
//!
//! Materials of the standard draw, each with a light 2 away around its mirror direction, half-widths 0.1 to 1.6: seeded, the
//! same for all forms. A new form is one line in [`forms`].

use std::hint::black_box;
use std::rc::Rc;

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;
use ltc_core::{
    AnyLight, Cubic, EdgeForm, Exact, Horizon, Light, Ltc, LtcBatch, Matrix as _, Polygon, PublishedRational,
    Quad, QuadBatch, Rational, Real, Sides,
};
use ltc_fit::draw;
use ltc_reference::{LtcLobe, PolygonOptions, Tolerance, integrate_polygon_boundary};
use ltc_table::Table;

use super::StudyError;
use crate::ready::{matrix, ready, vector};
use crate::stability::{Case, oracle};

/// Half-widths of thin lights, and radii of tubes.
const THIN: f64 = 0.03125;
const WIDE: f64 = 0.25;

/// Where a light stands in the shading frame: its centre, and half its extent along two axes at right angles.
#[derive(Clone, Copy)]
struct Placed {
    centre: DVec3,
    u: DVec3,
    v: DVec3,
}

/// Materials and lights. Numbers are such as `f32` holds exactly.
pub struct Lights {
    lobes: Vec<DMat3>,
    placed: Vec<Placed>,
    /// Whether the oracle is asked; what is timed alone need not wait for it.
    judged: bool,
}

/// A way to integrate, with its inputs.
pub struct Form {
    /// `shape/way/precision`.
    pub name: String,
    /// What its error must not exceed to be worth timing.
    pub bound: f64,
    /// The oracle's values; none where it was not asked.
    pub truth: Option<Rc<[f64]>>,
    count: usize,
    pass: Box<dyn Pass>,
}

/// All inputs once.
trait Pass {
    fn run(&mut self);
    fn values(&mut self) -> Vec<f64>;
}

impl Form {
    /// Integrates every light once, and keeps nothing.
    pub fn run(&mut self) {
        self.pass.run();
    }

    /// How many lights that is.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Largest error and its root mean square against the oracle.
    ///
    /// # Errors
    /// [`StudyError::Wrong`] for a form that is worse than its bound, [`StudyError::Oracle`] where the oracle was not asked.
    pub fn errors(&mut self) -> Result<(f64, f64), StudyError> {
        let (mut max, mut squares) = (0.0_f64, 0.0);
        let truth = self.truth.as_ref().ok_or_else(|| StudyError::oracle("it was not asked"))?;
        for (value, exact) in self.pass.values().iter().zip(truth.iter()) {
            // NaN is the largest error of all.
            let error = (value - exact).abs();
            max = if error.is_nan() { f64::INFINITY } else { max.max(error) };
            squares += error.powi(2);
        }
        if max > self.bound {
            return Err(StudyError::Wrong { what: self.name.clone(), error: max, bound: self.bound });
        }
        Ok((max, (squares / self.count().max(1) as f64).sqrt()))
    }
}

struct Scalar<R: Real, I, F> {
    ltcs: Rc<[Ltc<R>]>,
    inputs: Vec<I>,
    value: F,
}

impl<R: Real, I, F: Fn(&I, &Ltc<R>) -> R> Pass for Scalar<R, I, F> {
    fn run(&mut self) {
        for (input, ltc) in self.inputs.iter().zip(self.ltcs.iter()) {
            black_box((self.value)(black_box(input), black_box(ltc)));
        }
    }

    fn values(&mut self) -> Vec<f64> {
        self.inputs.iter().zip(self.ltcs.iter()).map(|(i, ltc)| (self.value)(i, ltc).to_f64()).collect()
    }
}

struct Batch<F> {
    out: Vec<f32>,
    integrate: F,
}

impl<F: Fn(&mut [f32])> Pass for Batch<F> {
    fn run(&mut self) {
        (self.integrate)(black_box(&mut self.out));
        black_box(&self.out);
    }

    fn values(&mut self) -> Vec<f64> {
        (self.integrate)(&mut self.out);
        self.out.iter().map(|x| f64::from(*x)).collect()
    }
}

impl Lights {
    /// `count` of them, over the lobes of an anisotropic table.
    ///
    /// # Errors
    /// Those of a lookup.
    pub fn new(table: &Table, count: usize) -> Result<Self, StudyError> {
        let mut rng = SplitMix64::new(11);
        let (mut lobes, mut placed) = (Vec::new(), Vec::new());
        for query in draw::standard(count, 5, false) {
            let lookup = table.lookup(&query)?;
            let m = DMat3::from_row_array(lookup.lobes[0].m);
            lobes.push(m.as_mat3().as_dmat3());
            let mirror = ltc_fit::direction(query.theta, query.phi + std::f64::consts::PI);
            let side = mirror.any_orthonormal_vector();
            let up = mirror.cross(side);
            let (half, a, b) = (rng.range(0.1, 1.6), rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
            placed.push(Placed { centre: mirror * 2.0 + side * a + up * b, u: side * half, v: up * half });
        }
        Ok(Self { lobes, placed, judged: true })
    }

    /// The same, for forms that are timed and not judged.
    #[must_use]
    pub fn unjudged(self) -> Self {
        Self { judged: false, ..self }
    }

    fn ltcs<R: Real>(&self) -> Result<Rc<[Ltc<R>]>, StudyError> {
        let ltcs: Result<Vec<_>, _> = self.lobes.iter().map(|m| Ltc::new(matrix::<R>(m))).collect();
        Ok(ltcs?.into())
    }

    /// The oracle's values for polygons.
    fn polygon_truth(&self, corners: usize) -> Result<Option<Rc<[f64]>>, StudyError> {
        if !self.judged {
            return Ok(None);
        }
        let options = PolygonOptions {
            two_sided: true,
            tolerance: Tolerance { absolute: 1e-10, relative: 0.0, max_evaluations: 1_000_000 },
        };
        let one = |(m, light): (&DMat3, &Placed)| {
            let lobe = LtcLobe::new(*m).map_err(StudyError::oracle)?;
            let found = integrate_polygon_boundary(&lobe, true, &ngon::<f64>(light, corners), options);
            Ok(found.map_err(StudyError::oracle)?.value)
        };
        let values: Result<Vec<f64>, StudyError> = self.lobes.iter().zip(&self.placed).map(one).collect();
        Ok(Some(values?.into()))
    }
}

/// A polygon of `n` corners on the superellipse of the light, rounded to `f32`; for 4, the rectangle.
fn ngon<R: Real>(light: &Placed, n: usize) -> Vec<R::Vec3> {
    let corner = |i: usize| {
        let (sin, cos) = ((i as f64 + 0.5) * std::f64::consts::TAU / n as f64).sin_cos();
        let stretch = if n == 4 { std::f64::consts::SQRT_2 } else { 1.0 };
        vector::<R>(&(light.centre + (light.u * cos + light.v * sin) * stretch).to_array())
    };
    (0..n).map(corner).collect()
}

fn corners<R: Real>(light: &Placed) -> [R::Vec3; 4] {
    let four = ngon::<R>(light, 4);
    [four[0], four[1], four[2], four[3]]
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

/// One light of each other shape in the place of a rectangle.
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

/// Forms of one set of lights, as they are listed.
struct List<'a> {
    lights: &'a Lights,
    l64: Rc<[Ltc<f64>]>,
    l32: Rc<[Ltc<f32>]>,
    forms: Vec<Form>,
}

impl List<'_> {
    fn push(&mut self, name: &str, truth: &Option<Rc<[f64]>>, bound: f64, pass: Box<dyn Pass>) {
        let (name, count) = (name.to_owned(), self.lights.placed.len());
        self.forms.push(Form { name, bound, truth: truth.clone(), count, pass });
    }

    fn double<I: 'static>(
        &mut self,
        name: &str,
        truth: &Option<Rc<[f64]>>,
        inputs: Vec<I>,
        value: impl Fn(&I, &Ltc<f64>) -> f64 + 'static,
    ) {
        let pass = Scalar { ltcs: Rc::clone(&self.l64), inputs, value };
        self.push(&format!("{name}/f64"), truth, 1e-8, Box::new(pass));
    }

    fn single<I: 'static>(
        &mut self,
        name: &str,
        truth: &Option<Rc<[f64]>>,
        bound: f64,
        inputs: Vec<I>,
        value: impl Fn(&I, &Ltc<f32>) -> f32 + 'static,
    ) {
        let pass = Scalar { ltcs: Rc::clone(&self.l32), inputs, value };
        self.push(&format!("{name}/f32"), truth, bound, Box::new(pass));
    }

    fn quads(&mut self) -> Result<(), StudyError> {
        let truth = self.lights.polygon_truth(4)?;
        let q64: Vec<_> = self.lights.placed.iter().map(corners::<f64>).collect();
        let q32: Vec<_> = self.lights.placed.iter().map(corners::<f32>).collect();
        let one: Vec<f64> = q64.iter().map(|q| quad(q, &self.l64[0])).collect();
        self.double("quad/exact", &truth, q64, quad::<f64>);
        self.single("quad/exact", &truth, 1e-4, q32.clone(), quad::<f32>);
        // Each horizon is a choice: this one leaves out the surface's, and leaks.
        self.single("quad/cosine_horizon_alone", &truth, 0.5, q32.clone(), leaky);
        self.single("quad/edges_exact", &truth, 1e-3, q32.clone(), by::<Exact>);
        self.single("quad/edges_rational", &truth, 1e-3, q32.clone(), by::<Rational>);
        self.single("quad/edges_published", &truth, 1e-3, q32.clone(), by::<PublishedRational>);
        self.single("quad/edges_cubic", &truth, 2e-3, q32.clone(), by::<Cubic>);
        self.single("quad/proxy", &truth, 0.05, q32.clone(), proxy);
        self.batches(&q32, &truth, one)
    }

    fn batches(
        &mut self,
        q32: &[[glam::Vec3; 4]],
        truth: &Option<Rc<[f64]>>,
        one: Vec<f64>,
    ) -> Result<(), StudyError> {
        let mut quads = QuadBatch::new();
        for corners in q32 {
            quads.extend([Quad::new(*corners, Sides::Two)?]);
        }
        let mut ltcs = LtcBatch::new();
        ltcs.extend(self.l32.iter().copied());
        let (others, first, out) = (quads.clone(), self.l32[0], vec![0.0; q32.len()]);
        let each = move |out: &mut [f32]| {
            // Lengths are the same by construction; a failure leaves zeros, which the check against the oracle catches.
            let _ = quads.integrate_each(black_box(&ltcs), Horizon::BOTH, out);
        };
        let single = move |out: &mut [f32]| {
            let _ = others.integrate(black_box(&first), Horizon::BOTH, out);
        };
        let pass = Batch { out: out.clone(), integrate: each };
        self.push("quad/batched_each/f32", truth, 1e-4, Box::new(pass));
        let pass = Batch { out, integrate: single };
        self.push("quad/batched_one_lobe/f32", &self.lights.judged.then(|| one.into()), 1e-4, Box::new(pass));
        Ok(())
    }

    fn polygons(&mut self, n: usize) -> Result<(), StudyError> {
        let truth = self.lights.polygon_truth(n)?;
        let p64 = self.lights.placed.iter().map(|l| ngon::<f64>(l, n)).collect();
        let p32 = self.lights.placed.iter().map(|l| ngon::<f32>(l, n)).collect();
        let name = format!("polygon/{n}_edges");
        self.double(&name, &truth, p64, |p: &Vec<DVec3>, ltc| polygon(p, ltc));
        self.single(&name, &truth, 1e-4, p32, |p: &Vec<glam::Vec3>, ltc| polygon(p, ltc));
        Ok(())
    }

    fn others(&mut self) -> Result<(), StudyError> {
        let lights: Vec<[AnyLight; 6]> = self.lights.placed.iter().map(shapes).collect();
        let Some(first) = lights.first() else { return Ok(()) };
        for k in 0..first.len() {
            let name = format!("{}/exact", first[k].name());
            let cases = self.lights.lobes.iter().zip(&lights);
            let judge = || cases.map(|(m, l)| oracle(&Case::new(*m, l[k].clone(), false))).collect();
            let truth = self.lights.judged.then(judge);
            let double: Result<Vec<_>, _> = lights.iter().map(|l| ready::<f64>(&l[k], &[])).collect();
            let single: Result<Vec<_>, _> = lights.iter().map(|l| ready::<f32>(&l[k], &[])).collect();
            self.double(&name, &truth, double?, |light, ltc| light.integrate(ltc));
            self.single(&name, &truth, 1e-3, single?, |light, ltc| light.integrate(ltc));
        }
        Ok(())
    }
}

/// Every form over the same lights, quads first. `polygons` are the numbers of edges.
///
/// # Errors
/// Those of the lights and of the oracle.
pub fn forms(lights: &Lights, polygons: &[usize]) -> Result<Vec<Form>, StudyError> {
    let mut list = List { lights, l64: lights.ltcs()?, l32: lights.ltcs()?, forms: Vec::new() };
    list.quads()?;
    for n in polygons {
        list.polygons(*n)?;
    }
    list.others()?;
    Ok(list.forms)
}
