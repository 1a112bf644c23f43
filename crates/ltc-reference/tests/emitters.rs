//! The path tracer's lights against cubature: its estimate under Lambert and GGX is the lobe's integral.

use glam::{DVec3, dvec3};
use ltc_reference::{
    CosineLobe, CylinderEmitter, CylinderShape, EllipseEmitter, Emitter, Ggx, GgxLobe, Lobe, PolygonEmitter,
    PolygonOptions, SphereEmitter, Tolerance, direct_light, integrate_cylinder, integrate_ellipse,
    integrate_polygon, integrate_sphere_light, view_direction,
};

const TOLERANCE: Tolerance = Tolerance { absolute: 1e-6, relative: 0.0, max_evaluations: 20_000_000 };
const TWO_SIDED: PolygonOptions = PolygonOptions { two_sided: true, tolerance: TOLERANCE };

/// The estimate's error for a light, and what it estimates: Lambert's fraction and GGX's radiance.
fn errors(light: &impl Emitter, exact: impl Fn(&dyn Fn(DVec3) -> f64) -> f64) -> [(f64, f64); 2] {
    let ggx = Ggx::new(0.4, 0.2).expect("valid widths");
    let wo = view_direction(0.6, 0.3);
    let lobe = GgxLobe { ggx, wo };
    let direct = direct_light(wo, &ggx, light, 1 << 17, 3);
    let (diffuse, specular) = (exact(&|w| CosineLobe.density(w)), exact(&|w| lobe.density(w)));
    [(direct.diffuse - diffuse, diffuse), (direct.magnitude - specular, specular)]
}

#[track_caller]
fn assert_unbiased(light: &impl Emitter, exact: impl Fn(&dyn Fn(DVec3) -> f64) -> f64) {
    for (error, value) in errors(light, exact) {
        assert!(value > 1e-3, "{value}");
        assert!(error.abs() < 1e-3 * value.max(0.05), "{error:e} of {value}");
    }
}

#[test]
fn ellipses() {
    for [c, u, v] in [
        [dvec3(-0.5, 0.1, 1.0), dvec3(0.5, 0.0, 0.2), dvec3(0.2, 0.7, 0.0)],
        [dvec3(-1.0, 0.2, 0.1), dvec3(0.0, 0.6, 0.2), dvec3(0.0, 0.3, 0.8)],
    ] {
        let light = EllipseEmitter::new(c, u, v, true).expect("finite");
        let exact = |f: &dyn Fn(DVec3) -> f64| {
            integrate_ellipse(&|w| f(w), c, u, v, TWO_SIDED).expect("the oracle converges").value
        };
        assert_unbiased(&light, exact);
        // The control: a light that is larger by a hundredth.
        let larger = EllipseEmitter::new(c, u * 1.01, v, true).expect("finite");
        assert!(errors(&larger, exact).iter().all(|(error, value)| error.abs() > 2e-3 * value));
    }
    let [c, u, v] = [DVec3::Z, DVec3::X, DVec3::Y];
    assert!(!EllipseEmitter::new(c, u, v, false).expect("finite").faces_origin(), "its front is above");
    assert!(EllipseEmitter::new(c, v, u, false).expect("finite").faces_origin());
}

#[test]
fn polygons_that_are_not_convex() {
    let at = |x: f64, y: f64| dvec3(x - 1.2, y - 0.5, 1.0 + 0.3 * x);
    let ell = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(1.0, 1.0), at(1.0, 2.0), at(0.0, 2.0)];
    let light = PolygonEmitter::new(&ell, true).expect("finite").expect("it has area");
    // The oracle's polygons are convex: the L in two.
    let parts = [[ell[0], ell[1], ell[2], at(0.0, 1.0)], [at(0.0, 1.0), ell[3], ell[4], ell[5]]];
    assert_unbiased(&light, |f| {
        let part =
            |p: &[DVec3; 4]| integrate_polygon(&|w| f(w), p, TWO_SIDED).expect("the oracle converges").value;
        parts.iter().map(part).sum()
    });
    assert_eq!(PolygonEmitter::new(&[at(0.0, 0.0); 3], true), Ok(None));
}

#[test]
fn spheres_from_outside_and_inside() {
    for (centre, radius) in
        [(dvec3(-1.0, 0.3, 1.0), 0.5), (dvec3(-2.0, 0.0, 0.2), 1.0), (DVec3::X * 0.3, 1.0)]
    {
        let light = SphereEmitter::new(centre, radius).expect("finite");
        assert_unbiased(&light, |f| {
            integrate_sphere_light(&|w: DVec3| if w.z > 0.0 { f(w) } else { 0.0 }, centre, radius, TOLERANCE)
                .expect("the oracle converges")
                .value
        });
    }
}

#[test]
fn cylinders_with_and_without_caps() {
    for (p0, p1, radius) in [
        (dvec3(-1.5, -0.5, 1.0), dvec3(-0.5, 1.0, 1.2), 0.3),
        (dvec3(-0.5, 0.1, 1.0), dvec3(-2.0, 0.5, 4.0), 0.4),
        (dvec3(-0.1, 0.1, 1.0), dvec3(-0.4, 0.2, 3.0), 0.5),
    ] {
        for caps in [true, false] {
            let light = CylinderEmitter::new(p0, p1, radius, caps).expect("finite").expect("it has extent");
            if !light.faces_origin() {
                continue;
            }
            let shape = CylinderShape { ends: [p0, p1], radius, caps };
            assert_unbiased(&light, |f| {
                integrate_cylinder(&|w| f(w), shape, TOLERANCE).expect("the oracle converges").value
            });
        }
    }
}
