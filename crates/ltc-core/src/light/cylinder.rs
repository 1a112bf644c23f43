//! Cylindrical lights: the fraction of a lobe that sees the cylinder's true silhouette, in closed form.

mod sample;
mod view;

use super::boundary::{BoundarySum, clip_to_surface};
use super::surround::everywhere;
use super::{Horizon, Light};
use crate::{InputError, Ltc, Real, Vector, check_range};
use view::{Beside, View};

/// A round cylinder of any width, given relative to the shading point in the shading frame.
///
/// - **Units**: lengths in any one unit; only their ratios matter. The same radiance in all directions.
/// - **Sides**: its outside emits. With `caps` it is a closed solid, whose silhouette is filled. Without, it is a tube: the
///   mantle alone emits, and what of its inside or of an open end is seen is dark.
/// - **Formula**: exact for every lobe, unlike the line approximation. The silhouette is the rectangle between the two
///   generators that are seen edge-on, and beside it the segments of both end circles beyond the rectangle; without caps the
///   near part of an end that faces the shading point is taken away instead. Segments are elliptical cones cut by one
///   more plane: see [`crate::Ellipse`].
/// - **In line**: within the mantle's infinite continuation but beyond an end, only that end is seen: its disk with caps,
///   nothing without.
/// - **Inside** or on the surface: with caps the light is seen in every direction, as with [`crate::Sphere`]; a tube is dark
///   inside.
/// - **Valid range**: any finite ends, radius ≥ 0. Radius 0 or equal ends give exactly 0.
///
/// ```
/// use glam::DVec3;
/// use ltc_core::{Cylinder, Light as _};
///
/// // Upright, seen from the middle of its foot's height: the silhouette's form factor is below that of a wall.
/// let ends = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 1.0)];
/// let solid = Cylinder::<f64>::new(ends[0], ends[1], 0.5, true)?.irradiance();
/// let tube = Cylinder::<f64>::new(ends[0], ends[1], 0.5, false)?.irradiance();
/// // Neither cap faces the shading point.
/// assert!(solid > 0.01 && solid == tube);
/// # Ok::<(), ltc_core::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Cylinder<R: Real> {
    ends: [R::Vec3; 2],
    radius: R,
    caps: bool,
}

impl<R: Real> Cylinder<R> {
    /// The cylinder around the line from `p0` to `p1`.
    ///
    /// # Errors
    /// [`InputError::NotFinite`] for a NaN or infinite number, [`InputError::OutOfRange`] for a negative radius.
    pub fn new(p0: R::Vec3, p1: R::Vec3, radius: R, caps: bool) -> Result<Self, InputError> {
        if !(p0.is_finite() && p1.is_finite()) {
            return Err(InputError::NotFinite { name: "cylinder end" });
        }
        check_range("cylinder radius", radius.to_f64(), 0.0, f64::MAX)?;
        Ok(Self { ends: [p0, p1], radius, caps })
    }
}

impl<R: Real> Light<R> for Cylinder<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        match View::of(self.ends, self.radius) {
            View::Nothing => R::ZERO,
            View::Inside(_) if self.caps => everywhere(ltc, horizon),
            View::InLine(end) if self.caps => end.disk().fraction(ltc, horizon),
            View::Inside(_) | View::InLine(_) => R::ZERO,
            View::Beside(view) => {
                let ends = view.heights.map(|height| self.end_segment(&view, height, ltc, horizon));
                (rectangle(&view, ltc, horizon) + ends[0] + ends[1]).clamped(R::ZERO, R::ONE)
            }
        }
    }
}

impl<R: Real> Cylinder<R> {
    /// What the end circle at this height along the axis adds to the rectangle between the generators.
    fn end_segment(&self, view: &Beside<R>, (height, faces): (R, bool), ltc: &Ltc<R>, horizon: Horizon) -> R {
        let beyond = faces && self.caps;
        let part =
            view.end(height).disk().on_side(view.end_plane(height, beyond)).signed_fraction(ltc, horizon);
        if faces && !self.caps { -part } else { part }
    }
}

/// What the rectangle between the two generators that are seen edge-on adds.
fn rectangle<R: Real>(view: &Beside<R>, ltc: &Ltc<R>, horizon: Horizon) -> R {
    let corners = view.rectangle();
    let mut sum = BoundarySum::<R>::new(ltc.cosine_from_target(), horizon);
    if horizon.surface {
        clip_to_surface::<R>(&corners, |v| sum.push(v));
    } else {
        corners.iter().for_each(|v| sum.push(*v));
    }
    // With the nadir inside the sum lacks one turn; a rectangle covers half of the cosine at most.
    let turns = sum.finish() / (R::of(2.0) * R::PI);
    if horizon.cosine && turns < R::of(-0.25) { turns + R::ONE } else { turns }
}
