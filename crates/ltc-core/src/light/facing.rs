//! On which side of a flat light the shading point is.

use glam::DVec3;

use super::Sides;
use super::wide::{shrink, widened};
use crate::Real;

/// Which side of a flat light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// The one that its normal points to.
    Front,
    /// The other one, of a light that emits there, too.
    Back,
}

/// How a flat light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Facing {
    pub side: Seen,
    /// So nearly edge-on that the input's precision would not do for what follows.
    pub is_grazing: bool,
}

/// From which side the origin sees a light through `point` that faces along `u × v`, if at all.
///
/// Never from its own plane: where the rounding of f64 decides the side, of this or of whatever computed the light, it is
/// edge-on.
#[inline]
pub(super) fn side_of_span<R: Real>(point: R::Vec3, u: R::Vec3, v: R::Vec3, sides: Sides) -> Option<Facing> {
    decide(
        [point, u, v].map(widened::<R>),
        |[p, u, v]| {
            let (a, b) = (u.abs(), v.abs());
            let terms = DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
            Product { behind: u.cross(v).dot(p), squared: terms.length_squared() * p.length_squared() }
        },
        |product| product.facing::<R>(sides),
    )
}

/// The same for a light that faces along `normal`.
#[inline]
pub(super) fn side_of_normal<R: Real>(point: R::Vec3, normal: R::Vec3, sides: Sides) -> Option<Facing> {
    decide(
        [point, normal].map(widened::<R>),
        |[p, n]| Product { behind: n.dot(p), squared: n.length_squared() * p.length_squared() },
        |product| product.facing::<R>(sides),
    )
}

/// A product that is positive behind the light.
struct Product {
    behind: f64,
    /// The square of what it could be at most.
    squared: f64,
}

/// Takes the product of vectors; again over a common power of two where squares over- or underflow.
#[inline]
fn decide<const N: usize>(
    vectors: [DVec3; N],
    product: impl Fn([DVec3; N]) -> Product,
    facing: impl Fn(Product) -> Option<Facing>,
) -> Option<Facing> {
    let plain = product(vectors);
    if plain.squared > 1e-250 && plain.squared < 1e250 {
        return facing(plain);
    }
    let largest = vectors.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    let factor = shrink(largest)?;
    facing(product(vectors.map(|v| v * factor)))
}

impl Product {
    #[inline]
    fn facing<R: Real>(self, sides: Sides) -> Option<Facing> {
        let within = |epsilons: f64| self.behind.powi(2) <= epsilons * epsilons * self.squared;
        if within(8.0 * f64::EPSILON) {
            return None;
        }
        let side = match (self.behind < 0.0, sides) {
            (true, _) => Seen::Front,
            (false, Sides::Two) => Seen::Back,
            (false, Sides::One) => return None,
        };
        let is_narrow = R::EPSILON.to_f64() > f64::EPSILON;
        Some(Facing { side, is_grazing: is_narrow && within(GRAZING * R::EPSILON.to_f64()) })
    }
}

/// Axes rounded to the input's precision turn the light by an ε; that is to be a small part of how far it is from edge-on.
const GRAZING: f64 = 4096.0;
