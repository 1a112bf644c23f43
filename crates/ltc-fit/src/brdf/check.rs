//! Whether a BRDF gives numbers.

use crate::{Brdf, DiskPoints, FitError, Lattice, Node};

/// Directions that are tried from each view.
const DIRECTIONS: usize = 32;

/// Evaluates the BRDF at a few directions from every entry's view.
///
/// # Errors
/// [`FitError::Brdf`] for a value, density, Fresnel weight or largest magnitude that is negative or NaN, for infinite ones
/// but the last, and for sampled directions that are no unit vectors.
pub(crate) fn check(brdf: &dyn Brdf, lattice: &Lattice) -> Result<(), FitError> {
    let points = DiskPoints::new(DIRECTIONS, [0.5, 0.5]);
    lattice.nodes.iter().try_for_each(|node| check_view(brdf, node, &points))
}

fn check_view(brdf: &dyn Brdf, node: &Node, points: &DiskPoints) -> Result<(), FitError> {
    let (wo, alpha) = (node.wo(), node.widths()?);
    let require = |holds: bool, what, value| {
        let (name, theta, alpha_x, alpha_y) = (brdf.name(), node.theta, alpha.x(), alpha.y());
        if holds { Ok(()) } else { Err(FitError::Brdf { name, what, value, theta, alpha_x, alpha_y }) }
    };
    require(brdf.max_magnitude() >= 0.0, "largest magnitude", brdf.max_magnitude())?;
    for u in &points.square {
        let wi = brdf.sample(wo, alpha, *u);
        let length = wi.length();
        require((length - 1.0).abs() < 1e-6, "length of a sampled direction", length)?;
        if wi.z <= 0.0 {
            continue;
        }
        for (what, value) in [
            ("value", brdf.eval_cos(wo, wi, alpha)),
            ("density", brdf.pdf(wo, wi, alpha)),
            ("Fresnel weight", brdf.fresnel_weight(wo, wi)),
        ] {
            require(value >= 0.0 && value.is_finite(), what, value)?;
        }
    }
    Ok(())
}
