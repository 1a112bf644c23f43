//! Form factor of a sphere that the horizon cuts, as engines tabulate it beside isotropic LTCs.

use core::f64::consts::PI;

/// Form factor of a sphere cut at the horizon, over the form factor `sin²σ` that it has straight overhead.
///
/// `elevation` is the cosine between the normal and the direction to the sphere's centre, in [−1, 1]; `overhead` is `sin²σ`, σ the
/// sphere's angular radius, in [0, 1]. Values outside are clamped. In [0, 1]; `max(0, elevation)` for a small sphere.
///
/// By Stokes, the irradiance of a region of unit radiance is `½ ∮ n·(p × dp)` along its border. Along the sphere's outline above
/// the horizon, |t| < T, that is `T sin²σ cos ω − sin σ cos σ sin ω sin T`; along the horizon inside the sphere it is half the arc.
pub fn clipped_sphere(elevation: f64, overhead: f64) -> f64 {
    let cos_omega = elevation.clamp(-1.0, 1.0);
    let square = overhead.clamp(0.0, 1.0);
    let (sin_sigma, cos_sigma) = (square.sqrt(), (1.0 - square).sqrt());
    // Wholly above the horizon, or wholly below, or too small to tell.
    let sin_omega = (1.0 - cos_omega * cos_omega).max(0.0).sqrt();
    if cos_omega >= sin_sigma || square < 1e-12 {
        return cos_omega.max(0.0);
    }
    if cos_omega <= -sin_sigma {
        return 0.0;
    }
    // The outline meets the horizon at ±T.
    let limit = (-cos_sigma * cos_omega / (sin_sigma * sin_omega)).clamp(-1.0, 1.0).acos();
    let horizon = (cos_sigma / sin_omega).clamp(-1.0, 1.0).acos();
    let irradiance = limit * square * cos_omega - sin_sigma * cos_sigma * sin_omega * limit.sin() + horizon;
    (irradiance / (PI * square)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cap cut into small rings around its centre, each ring into small arcs.
    fn summed(elevation: f64, overhead: f64) -> f64 {
        const RINGS: u32 = 400;
        let tilt = (1.0 - elevation * elevation).sqrt();
        let deepest = (1.0 - overhead).sqrt();
        let mut sum = 0.0;
        for i in 0..RINGS {
            let c = 1.0 - (1.0 - deepest) * (f64::from(i) + 0.5) / f64::from(RINGS);
            for j in 0..RINGS {
                let t = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(RINGS);
                let z = c * elevation + (1.0 - c * c).sqrt() * tilt * t.cos();
                sum += z.max(0.0);
            }
        }
        let solid_angle = 2.0 * PI * (1.0 - deepest);
        sum * solid_angle / f64::from(RINGS * RINGS) / (PI * overhead)
    }

    #[test]
    fn it_is_the_integral_over_the_cap() {
        for elevation in [-0.9, -0.5, -0.1, 0.0, 0.2, 0.6, 0.99] {
            for overhead in [0.01, 0.1, 0.4, 0.8, 0.999] {
                let (closed, sum) = (clipped_sphere(elevation, overhead), summed(elevation, overhead));
                assert!((closed - sum).abs() < 2e-3, "{elevation} {overhead}: {closed} {sum}");
            }
        }
    }

    #[test]
    fn the_ends_are_defined() {
        assert_eq!(clipped_sphere(0.3, 0.0), 0.3);
        assert_eq!(clipped_sphere(-0.3, 0.0), 0.0);
        assert_eq!(clipped_sphere(1.0, 1.0), 1.0);
        assert_eq!(clipped_sphere(-1.0, 1.0), 0.0);
        assert!((clipped_sphere(0.0, 1.0) - 0.5).abs() < 1e-12);
        assert!(clipped_sphere(f64::NAN, 0.5).is_nan(), "a NaN is not hidden");
    }
}
