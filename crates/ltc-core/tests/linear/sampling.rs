//! Samples of lines, thin cylinders and strips have the density that they claim, and integrate to what they should.

use glam::{DMat3, DVec3, dvec3};
use ltc_core::{Horizon, Light, Line, LineCylinder, SampleLight, Sides, Strip};
use ltc_reference::{
    CapChart, Chart, ChiSquareOptions, ChiSquareSuite, Lobe, ThinCylinder, ThinStrip, Tolerance, chi_square,
    chi_square_unit, integrate_cap, integrate_cylinder_wall, integrate_strip_area,
};

use crate::draw::{Cut, Draw, ltc};

const ENDS: [[DVec3; 2]; 4] = [
    [dvec3(-0.4, 0.3, 1.1), dvec3(0.9, 0.7, 0.6)],
    [dvec3(-3.0, 0.0, 0.2), dvec3(5.0, 0.1, 0.2)],
    [dvec3(0.6, 0.1, 0.5), dvec3(0.9, 0.3, 2.5)],
    [dvec3(-1.0, -1.0, -0.5), dvec3(1.0, 0.0, 1.0)],
];

#[test]
fn lines_are_sampled_uniformly_in_angle() {
    let mut suite = ChiSquareSuite::new(0.01);
    let options = ChiSquareOptions { bins: [128, 1], ..ChiSquareOptions::default() };
    for [p0, p1] in ENDS {
        let light = Line::<f64>::new(p0, p1, 0.1).unwrap();
        let length = (p1 - p0).length();
        // The parameter along the line, and a second coordinate that the sampler does not touch.
        let sample = |[u, v]: [f64; 2]| {
            let sample = light.sample(u)?;
            Some([(sample.wi * sample.distance - p0).dot(p1 - p0) / (length * length), v])
        };
        let density = |[t, _]: [f64; 2]| light.pdf_length(t) * length;
        suite.add(format!("{p0}"), chi_square_unit(sample, density, options).expect("a density"));
    }
    assert!(suite.rejected().is_empty(), "{:?}", suite.rejected());

    // Negative control: uniform along the line is another density.
    let [p0, p1] = ENDS[1];
    let light = Line::<f64>::new(p0, p1, 0.1).unwrap();
    let density = |[t, _]: [f64; 2]| light.pdf_length(t) * (p1 - p0).length();
    let outcome = chi_square_unit(Some, density, options).expect("a density");
    assert!(outcome.p_value < 1e-6, "{outcome:?}");
}

#[test]
fn both_densities_of_a_line_sample_agree_and_estimate_its_integral() {
    let mut draw = Draw::new(41);
    for case in 0..40 {
        let matrix = draw.lobe_matrix(5.0);
        let [p0, p1] = draw.aimed_ends(matrix);
        let light = Line::<f64>::new(p0, p1, 1e-3).unwrap();
        let lobe = Cut::new(matrix, Horizon::BOTH);
        let axis = (p1 - p0) / (p1 - p0).length();
        let n = 20_000;
        let mut mean = 0.0;
        for i in 0..n {
            let s = light.sample((f64::from(i) + 0.5) / f64::from(n)).expect("in general position");
            let per_length =
                2e-3 * lobe.density(s.wi) * s.wi.cross(axis).length() / s.distance.powi(2) / s.pdf_length;
            let per_angle = 2e-3 * lobe.density(s.wi) / (s.distance * s.pdf_angle);
            assert!((per_length - per_angle).abs() <= 1e-6 * per_angle, "{per_length} {per_angle}");
            mean += per_angle / f64::from(n);
        }
        let expected = light.integrate(&ltc(matrix));
        assert!((mean - expected).abs() < 1e-3 * expected + 1e-8, "{case}: {mean} {expected}");
    }
    assert_eq!(Line::<f64>::new(DVec3::Z, DVec3::Z * 2.0, 0.1).unwrap().sample(0.5), None);
    assert_eq!(Line::<f64>::new(DVec3::Z, DVec3::Z * 2.0, 0.1).unwrap().pdf_length(0.5), 0.0);
}

/// A chart around a strip that is up to `2 · margin` wide as seen from the shading point.
fn chart([p0, p1]: [DVec3; 2], margin: f64) -> CapChart {
    let (a, b) = (p0.normalize_or_zero(), p1.normalize_or_zero());
    CapChart::cap(a + b, 0.5 * a.angle_between(b) + margin).expect("a cap")
}

#[test]
fn strips_are_sampled_by_area() {
    let mut suite = ChiSquareSuite::new(0.01);
    let options = ChiSquareOptions { bins: [32, 64], allowed_stray: 3, ..ChiSquareOptions::default() };
    let strip = |[p0, p1]: [DVec3; 2], width: f64| {
        Strip::<f64>::new(p0, p1, width, -p0 + dvec3(0.1, 0.3, 0.0), Sides::Two).unwrap()
    };
    for ends in [ENDS[0], ENDS[2], ENDS[3]] {
        let light = strip(ends, 0.4);
        let sample = |u| SampleLight::sample(&light, u).map(|s| s.wi);
        let outcome = chi_square(sample, |w| light.pdf(w), &chart(ends, 0.6), options).expect("a density");
        assert!((outcome.mass - 1.0).abs() < 1e-3, "{outcome:?}");
        suite.add(format!("strip at {}", ends[0]), outcome);
    }
    assert!(suite.rejected().is_empty(), "{:?}", suite.rejected());

    // Negative control: the samples of a strip that is a tenth narrower.
    let (light, other) = (strip(ENDS[0], 0.4), strip(ENDS[0], 0.36));
    let sample = |u| SampleLight::sample(&other, u).map(|s| s.wi);
    let outcome = chi_square(sample, |w| light.pdf(w), &chart(ENDS[0], 0.6), options).expect("a density");
    assert!(outcome.p_value < 1e-6, "{outcome:?}");
}

/// The visible wall of a cylinder in its own coordinates: angle around the axis, length along it. Its density per solid angle,
/// which is infinite along the silhouette, is smooth in them.
struct WallChart {
    start: DVec3,
    axis: DVec3,
    length: f64,
    radius: f64,
    /// Distance of the axis.
    distance: f64,
    /// Unit vectors across: from the axis to the shading point, and at right angles.
    front: DVec3,
    side: DVec3,
}

impl WallChart {
    fn new([p0, p1]: [DVec3; 2], radius: f64) -> Self {
        let axis = (p1 - p0).normalize_or_zero();
        let foot = p0 - axis * p0.dot(axis);
        let front = -foot.normalize_or_zero();
        let (length, side) = ((p1 - p0).length(), front.cross(axis));
        Self { start: p0, axis, length, radius, distance: foot.length(), front, side }
    }

    fn half_arc(&self) -> f64 {
        (self.radius / self.distance).acos()
    }
}

impl Chart for WallChart {
    fn direction(&self, [u, v]: [f64; 2]) -> (DVec3, f64) {
        let (sin, cos) = ((2.0 * u - 1.0) * self.half_arc()).sin_cos();
        let normal = self.front * cos + self.side * sin;
        let p = self.start + self.axis * (v * self.length) + normal * self.radius;
        let w = p.normalize_or_zero();
        let area = 2.0 * self.half_arc() * self.radius * self.length;
        (w, area * (-w.dot(normal)).max(0.0) / p.length_squared())
    }

    fn place(&self, w: DVec3) -> Option<[f64; 2]> {
        let (x, y) = (w.dot(self.front), w.dot(self.side));
        // |t (x, y) − (−d, 0)| = R for the nearer of two t.
        let (a, b) = (x * x + y * y, x * self.distance);
        let root = (b * b - a * (self.distance.powi(2) - self.radius.powi(2))).max(0.0).sqrt();
        let t = (-b - root) / a;
        let phi = (t * y).atan2(t * x + self.distance);
        let along = (w * t - self.start).dot(self.axis) / self.length;
        let u = 0.5 * (phi / self.half_arc() + 1.0);
        (t > 0.0 && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&along)).then_some([u, along])
    }
}

#[test]
fn cylinders_are_sampled_by_visible_area() {
    let mut suite = ChiSquareSuite::new(0.01);
    // Where rounding ends the wall, a sample may fall off.
    let options = ChiSquareOptions { bins: [24, 24], allowed_stray: 3, ..ChiSquareOptions::default() };
    let mut partly = 0;
    for ends in ENDS {
        for caps in [false, true] {
            let light = LineCylinder::<f64>::new(ends[0], ends[1], 0.15).unwrap().with_caps(caps);
            let sample = |u| SampleLight::sample(&light, u).map(|s| s.wi);
            let chart = WallChart::new(ends, 0.15);
            let outcome = chi_square(sample, |w| light.pdf(w), &chart, options).expect("a density");
            // With a cap in sight some of the samples are on it.
            partly += usize::from(outcome.mass < 0.99);
            assert!(caps || (outcome.mass - 1.0).abs() < 1e-9, "{outcome:?}");
            suite.add(format!("cylinder at {}, caps {caps}", ends[0]), outcome);
        }
    }
    assert!(suite.rejected().is_empty(), "{:?}", suite.rejected());
    assert_eq!(partly, 1);

    // Negative control: a cylinder a tenth longer.
    let [p0, p1] = ENDS[0];
    let light = LineCylinder::<f64>::new(p0, p1 + (p1 - p0) * 0.1, 0.15).unwrap();
    let sample = |u| SampleLight::sample(&light, u).map(|s| s.wi);
    let claimed = LineCylinder::<f64>::new(p0, p1, 0.15).unwrap();
    let options = ChiSquareOptions { allowed_stray: u32::MAX, ..options };
    let outcome =
        chi_square(sample, |w| claimed.pdf(w), &WallChart::new(ENDS[0], 0.15), options).expect("a density");
    assert!(outcome.p_value < 1e-6, "{outcome:?}");
}

/// The mean of D/pdf over area samples is the integral over the true shape.
#[test]
fn samples_estimate_the_true_shapes() {
    let matrix = DMat3::from_cols(dvec3(0.8, 0.1, 0.0), dvec3(0.0, 0.6, -0.1), dvec3(0.3, 0.2, 0.9));
    let lobe = Cut::new(matrix, Horizon::BOTH);
    let tolerance = Tolerance::absolute(1e-6);
    for [p0, p1] in ENDS {
        let (radius, normal) = (0.15, dvec3(0.1, 0.3, 0.0) - p0);
        let axis = p1 - p0;
        let normal = normal - axis * (normal.dot(axis) / axis.length_squared());
        let strip = Strip::<f64>::new(p0, p1, 0.3, normal, Sides::Two).unwrap();
        let light = ThinStrip { p0, p1, width: 0.3, normal, two_sided: true };
        let exact = integrate_strip_area(&lobe, &light, tolerance).expect("converges").value;
        assert_mean(&lobe, &strip, exact);

        let open = LineCylinder::<f64>::new(p0, p1, radius).unwrap();
        let wall = integrate_cylinder_wall(&lobe, &ThinCylinder { p0, p1, radius }, tolerance)
            .expect("converges")
            .value;
        assert_mean(&lobe, &open, wall);
        let caps = [(p0, axis), (p1, -axis)]
            .map(|(p, inward)| integrate_cap(&lobe, p, inward, radius, tolerance).expect("converges").value);
        assert_mean(&lobe, &open.with_caps(true), wall + caps[0] + caps[1]);
    }
}

fn assert_mean(lobe: &impl Lobe, light: &impl SampleLight<f64>, exact: f64) {
    let mut draw = Draw::new(43);
    let n = 100_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let u = [draw.unit(), draw.unit()];
        let value = light.sample(u).map_or(0.0, |s| lobe.density(s.wi) / s.pdf);
        sum += value;
        squares += value * value;
    }
    let n = f64::from(n);
    let (mean, variance) = (sum / n, squares / n - (sum / n).powi(2));
    let sigma = (variance / n).sqrt();
    assert!((mean - exact).abs() < 5.0 * sigma + 1e-6, "{mean} {exact} {sigma}");
    assert!(exact > 20.0 * sigma, "{mean} {exact} {sigma}");
}

#[test]
fn a_cylinder_shows_nothing_from_inside_and_a_strip_nothing_edge_on() {
    let inside = LineCylinder::<f64>::new(dvec3(-1.0, 0.0, 0.1), dvec3(1.0, 0.0, 0.1), 0.2).unwrap();
    assert_eq!(SampleLight::sample(&inside.with_caps(true), [0.3, 0.7]), None);
    assert_eq!(inside.pdf(DVec3::Z), 0.0);
    let strip =
        Strip::<f64>::new(dvec3(-1.0, 0.0, 1.0), dvec3(1.0, 0.0, 1.0), 0.2, DVec3::Y, Sides::Two).unwrap();
    assert_eq!(SampleLight::sample(&strip, [0.3, 0.7]), None);
    let behind =
        Strip::<f64>::new(dvec3(-1.0, 0.0, 1.0), dvec3(1.0, 0.0, 1.0), 0.2, DVec3::Z, Sides::One).unwrap();
    assert_eq!(SampleLight::sample(&behind, [0.3, 0.7]), None);
    assert_eq!(behind.pdf(DVec3::Z), 0.0);
}
