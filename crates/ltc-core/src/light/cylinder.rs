//! Cylindrical lights: the fraction of a lobe that sees the cylinder's true silhouette, in closed form.

mod sample;
mod view;

use core::f64::consts::TAU;

use super::boundary::{BoundarySum, clip_to_surface};
use super::spaces::Spaces;
use super::surround::everywhere;
use super::wide::widened;
use super::{Horizon, Light};
use crate::{InputError, Ltc, Real, Vector as _, check_range};
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
/// - **Accuracy** (`tests/round`): f64 within 1e-9 of cubature (measured 4e-13) over roughness from 1e-4, grazing to 89.99°, scales
///   from 1e-6 to 1e6, lengths to 1e5 radii, from
///   1e-7 of the radius outside; f32 within 2e-5 of f64 of the same input, 1e-4 with its rounding where the
///   light is up to 1e3 times nearer or farther than its size. Both times cond M / 100 above 100.
///   In f32, too, it is evaluated in f64.
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

impl<R: Real> Cylinder<R> {
    fn view(&self) -> View {
        View::of(self.ends.map(widened::<R>), self.radius.to_f64())
    }
}

/// In f64 for both precisions: from near the mantle, and for long cylinders, differences of coordinates decide.
impl<R: Real> Light<R> for Cylinder<R> {
    fn integrate_within(&self, ltc: &Ltc<R>, horizon: Horizon) -> R {
        let lobe = Lobe { spaces: Spaces::wide(ltc), horizon };
        match self.view() {
            View::Nothing => R::ZERO,
            View::Inside(_) if self.caps => everywhere(ltc, horizon),
            View::InLine(end, _) if self.caps => R::of(end.disk().fraction(&lobe.spaces, horizon)),
            View::Inside(_) | View::InLine(..) => R::ZERO,
            View::Beside(view) => {
                let ends = view.heights.map(|end| lobe.end_segment(&view, end, self.caps));
                R::of((lobe.rectangle(&view) + ends[0] + ends[1]).clamped(0.0, 1.0))
            }
        }
    }
}

/// What is integrated.
struct Lobe {
    spaces: Spaces<f64>,
    horizon: Horizon,
}

impl Lobe {
    /// What the end circle at this height along the axis adds to the rectangle between the generators.
    fn end_segment(&self, view: &Beside, (height, faces): (f64, bool), caps: bool) -> f64 {
        let part = view.end(height).disk().on_side(view.end_plane(height, faces && caps));
        let fraction = part.signed_fraction(&self.spaces, self.horizon);
        if faces && !caps { -fraction } else { fraction }
    }

    /// What the rectangle between the two generators that are seen edge-on adds.
    fn rectangle(&self, view: &Beside) -> f64 {
        let corners = view.rectangle();
        let mut sum = BoundarySum::<f64>::new(self.spaces.cosine_from_target, self.horizon);
        if self.horizon.surface {
            clip_to_surface::<f64>(&corners, |v| sum.push(v));
        } else {
            corners.iter().for_each(|v| sum.push(*v));
        }
        // With the nadir inside the sum lacks one turn; a rectangle covers half of the cosine at most.
        let turns = sum.finish() / TAU;
        if self.horizon.cosine && turns < -0.25 { turns + 1.0 } else { turns }
    }
}
