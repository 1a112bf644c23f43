//! The closed forms of `ltc_core`, and the samples of `ltc_fit`, against the reference's quadrature, which shares no code
//! with them.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use glam::{DMat3, DVec3};
use ltc_core::points::{SplitMix64, r2};
use ltc_core::{Alpha, Ggx, Light as _, Ltc, Matrix, Polygon, Sides};
use ltc_fit::{Brdf, DiskPoints, GgxFamily, Lobe, draw, total_variation};
use ltc_reference::{
    AboveHorizon, LtcLobe, PolygonOptions, Tolerance, directional_albedo, ggx_total_variation,
    integrate_polygon, integrate_polygon_boundary,
};
use ltc_table::Query;
use ltc_tests::{Job, lit_share, pairs, shapes, shipped, table, tolerance};

const TABLES: [&str; 2] = ["ggx-anisotropic", "ggx-isotropic"];

/// A flat light under a lobe of a shipped table. Flat to double precision, as what a polygon that is not flat means is for each
/// side to say.
struct Case {
    m: DMat3,
    vertices: Vec<DVec3>,
    sides: Sides,
}

/// The standard draw's lobes under parallelograms and, every other time, under stars of 3 to 10 corners.
fn cases(name: &str, count: usize, seed: u64) -> Vec<Case> {
    let mut rng = SplitMix64::new(seed);
    let case = |(i, (_, job)): (usize, (Query, Job))| {
        let [a, b, c, _] = job.vertices_f64()[..] else { panic!("pairs have quads") };
        let centre = (a + c) * 0.5;
        let corners = 3 + (rng.unit() * 8.0) as usize;
        let star = shapes::star(&mut rng, centre, (a - centre).length(), corners);
        let vertices = if i % 2 == 0 { vec![a, b, c, a + c - b] } else { star };
        Case { m: job.m_f64(), vertices, sides: job.sides }
    };
    pairs(&table(name), count, seed).into_iter().enumerate().map(case).collect()
}

impl Case {
    fn options(&self) -> PolygonOptions {
        let absolute = 0.01 * tolerance::REFERENCE;
        let tolerance = Tolerance { absolute, relative: 0.0, max_evaluations: 50_000_000 };
        PolygonOptions { two_sided: self.sides == Sides::Two, tolerance }
    }

    /// By `ltc_core`, under another lobe.
    fn closed_form(&self, m: DMat3) -> f64 {
        Polygon::<f64>::new(&self.vertices, self.sides).unwrap().integrate(&Ltc::new(m).unwrap())
    }

    /// By cubature of the density above the horizon.
    fn by_cubature(&self) -> f64 {
        let lobe = AboveHorizon(LtcLobe::new(self.m).unwrap());
        integrate_polygon(&lobe, &self.vertices, self.options()).unwrap().value
    }

    /// By quadrature along the boundary.
    fn by_boundary(&self, above_horizon: bool) -> f64 {
        let lobe = LtcLobe::new(self.m).unwrap();
        integrate_polygon_boundary(&lobe, above_horizon, &self.vertices, self.options()).unwrap().value
    }

    fn crosses_the_horizon(&self) -> bool {
        self.vertices.iter().any(|v| v.z < 0.0) && self.vertices.iter().any(|v| v.z > 0.0)
    }
}

#[test]
fn polygons_agree_with_cubature_of_the_density() {
    for (name, seed) in TABLES.into_iter().zip([31, 32]) {
        let (mut largest, mut leaking, mut off) = (0.0_f64, 0.0_f64, 0.0_f64);
        let (mut values, mut crossing) = (Vec::new(), 0);
        for case in cases(name, 400, seed) {
            let (value, truth) = (case.closed_form(case.m), case.by_cubature());
            largest = largest.max((value - truth).abs());
            crossing += usize::from(case.crosses_the_horizon());
            values.push(value);
            // The controls: a lobe that leaks below the horizon, and one that is off by 10⁻⁴.
            leaking = leaking.max((case.by_boundary(false) - truth).abs());
            let wrong = case.m + DMat3::from_diagonal(DVec3::X * 1e-4);
            off = off.max((case.closed_form(wrong) - truth).abs());
        }
        println!("{name}: up to {largest:.1e} from cubature, {crossing} of 400 cross the horizon");
        assert!(largest <= tolerance::REFERENCE, "{name}: {largest:e}");
        assert!(lit_share(&values) > 0.3 && crossing > 50, "{name}: {} {crossing}", lit_share(&values));
        assert!(leaking > 1e-4, "{name}: a leak would pass: {leaking:e}");
        assert!(off > 10.0 * tolerance::REFERENCE, "{name}: a wrong matrix would pass: {off:e}");
    }
}

#[test]
fn polygons_agree_with_quadrature_along_the_boundary() {
    for (name, seed) in TABLES.into_iter().zip([33, 34]) {
        let off = |case: &Case| (case.closed_form(case.m) - case.by_boundary(true)).abs();
        let largest = cases(name, 1_500, seed).iter().map(off).fold(0.0, f64::max);
        println!("{name}: up to {largest:.1e} from the boundary integral");
        assert!(largest <= tolerance::REFERENCE, "{name}: {largest:e}");
    }
}

/// Both crates' GGX of one query.
fn both(query: &Query) -> (Ggx<f64>, ltc_reference::Ggx, DVec3) {
    let core = Ggx::new(Alpha::new(query.alpha_x, query.alpha_y).unwrap());
    let reference = ltc_reference::Ggx::new(query.alpha_x, query.alpha_y).unwrap();
    (core, reference, ltc_fit::direction(query.theta, query.phi))
}

#[test]
fn ggx_is_the_same_in_both_crates() {
    let mut compared = 0;
    for query in draw::standard(500, 41, false) {
        let (core, reference, wo) = both(&query);
        // The control: a material that is off by a thousandth.
        let wrong = ltc_reference::Ggx::new(query.alpha_x * 1.001, query.alpha_y).unwrap();
        let mut seen = false;
        for i in 0..40 {
            let wi = core.sample(wo, r2(i, [0.5, 0.5]));
            if wi.z <= 1e-9 {
                continue;
            }
            let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (a.abs() + b.abs());
            let wh = (wo + wi).normalize_or(DVec3::Z);
            assert!(same(core.d(wh), reference.ndf(wh)), "{query:?} {wh}");
            assert!(same(core.g2(wo, wi), reference.g2(wo, wi)), "{query:?} {wi}");
            assert!(same(core.eval_cos(wo, wi), reference.eval_cos(wo, wi)), "{query:?} {wi}");
            assert!(same(core.pdf(wo, wi), reference.pdf(wo, wi)), "{query:?} {wi}");
            let weights = (core.fresnel_weight(wo, wi), reference.fresnel_weight(wo, wi));
            assert!((weights.0 - weights.1).abs() < 1e-12, "{query:?} {wi}");
            seen |= !same(core.eval_cos(wo, wi), wrong.eval_cos(wo, wi));
            compared += 1;
        }
        assert!(seen, "a wrong width would pass: {query:?}");
    }
    assert!(compared > 15_000, "{compared}");
}

#[test]
fn samples_average_to_the_albedo() {
    let (mut largest, mut control) = (0.0_f64, 0.0_f64);
    for query in draw::standard(40, 42, false) {
        let (core, reference, wo) = both(&query);
        let n = 1 << 15;
        let (mut magnitude, mut fresnel) = (0.0, 0.0);
        for i in 0..n {
            let wi = core.sample(wo, r2(i, [0.5, 0.5]));
            let weight = core.sample_weight(wo, wi);
            magnitude += weight / n as f64;
            fresnel += weight * core.fresnel_weight(wo, wi) / n as f64;
        }
        let albedo = directional_albedo(&reference, wo, Tolerance::absolute(1e-6)).unwrap();
        largest = largest.max((magnitude - albedo.magnitude.value).abs());
        largest = largest.max((fresnel - albedo.fresnel.value).abs());
        control = control.max((1.0 - albedo.magnitude.value).abs());
    }
    println!("albedo: samples are up to {largest:.1e} off");
    assert!(largest < 5e-4, "{largest}");
    assert!(control > 0.1, "magnitudes that are all 1 would hide a missing weight: {control}");
}

#[test]
fn magnitude_and_fresnel_of_the_tables_are_as_good_as_their_manifests_say() {
    /// Half a percent of the reflected energy.
    const MEAN: f64 = 5e-3;
    /// The manifest's errors are against 4,096 samples.
    const SAMPLED: f64 = 5e-4;
    for name in TABLES {
        let catalogue = shipped();
        let version = catalogue.find(name).unwrap();
        let errors = &version.manifest().errors;
        // The first of the queries that the manifest's maxima are over.
        let queries = draw::standard(100, errors.standard_draw.seed, name == "ggx-isotropic");
        let (mut mean, mut control, mut previous) = (0.0, 0.0, 0.0);
        for query in &queries {
            let (_, reference, wo) = both(query);
            let albedo = directional_albedo(&reference, wo, Tolerance::absolute(1e-6)).unwrap();
            let lookup = version.table().lookup(query).unwrap();
            let magnitude = (lookup.magnitude - albedo.magnitude.value).abs();
            let fresnel = (lookup.fresnel - albedo.fresnel.value).abs();
            assert!(magnitude <= errors.magnitude_max + SAMPLED, "{name} {query:?}: {magnitude}");
            assert!(fresnel <= errors.fresnel_max + SAMPLED, "{name} {query:?}: {fresnel}");
            mean += magnitude.max(fresnel) / 100.0;
            // The control: the answer to the query before.
            control += (previous - albedo.magnitude.value).abs() / 100.0;
            previous = lookup.magnitude;
        }
        println!("{name}: magnitude or Fresnel are {mean:.1e} off in the mean");
        assert!(mean < MEAN && control > 2.0 * MEAN, "{name}: {mean} {control}");
    }
}

#[test]
fn total_variation_from_samples_is_that_by_cubature() {
    let points = DiskPoints::new(1 << 16, [0.5, 0.5]);
    let mut lobe = Lobe::default();
    let (mut largest, mut control) = (0.0_f64, 0.0_f64);
    let table = table("ggx-anisotropic");
    for query in draw::standard(30, 43, false) {
        let (_, reference, wo) = both(&query);
        let m = DMat3::from_row_array(table.lookup(&query).unwrap().lobes[0].m);
        let by_cubature = |m| {
            let lobe = LtcLobe::new(m).unwrap();
            ggx_total_variation(&reference, wo, &lobe, Tolerance::absolute(2e-4)).unwrap().value
        };
        GgxFamily.sample_lobe(wo, query.validate().unwrap(), &points, &mut lobe);
        let by_samples = total_variation(&lobe, m);
        largest = largest.max((by_samples - by_cubature(m)).abs());
        // The control: a lobe that is 5 % wider.
        let wider = m * DMat3::from_diagonal(DVec3::new(1.05, 1.05, 1.0));
        control = control.max((by_samples - by_cubature(wider)).abs());
    }
    println!("TV: samples are up to {largest:.1e} off");
    assert!(largest < tolerance::TV, "{largest}");
    assert!(control > 2.0 * tolerance::TV, "a wrong lobe would pass: {control}");
}
