//! The part of a lobe that lies within a cone over an ellipse: what disk, ellipse, sphere and cylinder have in common.

use super::Horizon;
use super::cone::Cone;
use super::cone_region::{ConeRegion, MAX_PLANES};
use super::facing::Seen;
use super::spaces::Spaces;
use crate::{Matrix, Real, Vector};

/// The cone over the ellipse `centre + u cos t + v sin t` of the shading frame, perhaps cut by a plane.
///
/// `u × v` points away from the shading point; which side emits is not its business.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConeLight<R: Real> {
    centre: R::Vec3,
    u: R::Vec3,
    v: R::Vec3,
    /// Only what has a positive product with this is meant.
    kept: Option<R::Vec3>,
}

/// Where an ellipse lies with respect to a plane through the shading point.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Above,
    Below,
    Across,
}

/// From the heights of the centre and of the ends of two conjugate half-axes.
#[inline]
fn place<R: Real>(centre: R, u: R, v: R) -> Place {
    // Nearer to touching than this only rounding tells.
    let reach = (u.squared() + v.squared()) * (R::ONE - R::of(8.0) * R::EPSILON);
    if centre.squared() < reach {
        Place::Across
    } else if centre > R::ZERO {
        Place::Above
    } else {
        Place::Below
    }
}

/// An ellipse in both spaces, in units that keep powers of its coordinates in range: centre and half-axes.
struct InSpaces<R: Real> {
    target: [R::Vec3; 3],
    cosine: [R::Vec3; 3],
}

impl<R: Real> InSpaces<R> {
    /// `None` for what is zero or not finite.
    #[inline]
    fn of(target: [R::Vec3; 3], spaces: &Spaces<R>) -> Option<Self> {
        let cosine = target.map(|p| spaces.cosine_from_target.apply(p));
        let squared = cosine.iter().fold(R::ZERO, |sum, p| sum + p.dot(*p));
        // No entry of M is above 1, so that the target's coordinates are no larger than three times these.
        let usual = squared > R::of(1e-8) && squared < R::of(1e8);
        if usual { Some(Self { target, cosine }) } else { Self::rescaled(target, spaces) }
    }

    #[cold]
    #[inline(never)]
    fn rescaled(target: [R::Vec3; 3], spaces: &Spaces<R>) -> Option<Self> {
        let target = unit_sized::<R>(target)?;
        let cosine = unit_sized::<R>(target.map(|p| spaces.cosine_from_target.apply(p)))?;
        Some(Self { target, cosine })
    }
}

/// Scales the largest coordinate to 1.
fn unit_sized<R: Real>(vectors: [R::Vec3; 3]) -> Option<[R::Vec3; 3]> {
    let largest = vectors[0].max_abs().max(vectors[1].max_abs()).max(vectors[2].max_abs());
    let shrink = R::ONE / largest;
    (largest > R::ZERO && largest.is_finite() && shrink.is_finite()).then(|| vectors.map(|v| v * shrink))
}

impl<R: Real> ConeLight<R> {
    /// The whole cone; `u × v` points away from the shading point.
    #[inline]
    pub fn new(centre: R::Vec3, u: R::Vec3, v: R::Vec3) -> Self {
        Self { centre, u, v, kept: None }
    }

    /// The cone over a light whose front is where `u × v` points to.
    #[inline]
    pub fn seen(side: Seen, centre: R::Vec3, u: R::Vec3, v: R::Vec3) -> Self {
        match side {
            Seen::Front => Self::new(centre, v, u),
            Seen::Back => Self::new(centre, u, v),
        }
    }

    /// Its part on the side of `normal` of a plane through the shading point.
    pub fn on_side(self, normal: R::Vec3) -> Self {
        Self { kept: Some(normal), ..self }
    }

    /// The fraction of `ltc` in it, between the horizons asked for.
    #[inline]
    pub fn fraction(&self, spaces: &Spaces<R>, horizon: Horizon) -> R {
        self.signed_fraction(spaces, horizon).clamped(R::ZERO, R::ONE)
    }

    /// The same before it is clamped: a part of a sum. Negative without the cosine's horizon, or by rounding.
    #[inline]
    pub fn signed_fraction(&self, spaces: &Spaces<R>, horizon: Horizon) -> R {
        self.seen_fraction(spaces, horizon).unwrap_or(R::ZERO)
    }

    #[inline]
    fn seen_fraction(&self, spaces: &Spaces<R>, horizon: Horizon) -> Option<R> {
        let InSpaces { target, cosine } = InSpaces::of([self.centre, self.u, self.v], spaces)?;
        let place_in = |[c, u, v]: [R::Vec3; 3], cut: bool| {
            if cut { place(c.z(), u.z(), v.z()) } else { Place::Above }
        };
        let (surface, [c, u, v]) = (place_in(target, horizon.surface), cosine);
        let cosine = place_in(cosine, horizon.cosine);
        if surface == Place::Below || cosine == Place::Below {
            return None;
        }
        let cone = Cone::new(c, u, v)?;
        if surface == Place::Above && cosine == Place::Above && self.kept.is_none() {
            return Some(cone.uncut(up::<R>()));
        }
        self.cut(&cone, spaces, [surface == Place::Across, cosine == Place::Across])
    }

    #[inline(never)]
    fn cut(&self, cone: &Cone<R>, spaces: &Spaces<R>, [surface, cosine]: [bool; 2]) -> Option<R> {
        let axes = cone.axes()?;
        let to_axes =
            |n: R::Vec3| R::Vec3::new(n.dot(axes.axes[0]), n.dot(axes.axes[1]), n.dot(axes.axes[2]));
        let up = to_axes(up::<R>());
        // A plane's normal goes to cosine space by Mᵀ.
        let back = spaces.target_from_cosine.transposed();
        let mut normals = [up; MAX_PLANES];
        let mut count = usize::from(cosine);
        let ground = back.apply(self::up::<R>());
        // The two horizons of an upright lobe are one.
        let same = cosine && ground.x() == R::ZERO && ground.y() == R::ZERO;
        if surface && !same {
            normals[count] = to_axes(ground.try_unit()?);
            count += 1;
        }
        if let Some(kept) = self.kept {
            normals[count] = to_axes(back.apply(kept).try_unit()?);
            count += 1;
        }
        let region = ConeRegion::new(axes.widths, &normals[..count]);
        Some(region.integral(up).unwrap_or_else(|| cone.uncut(self::up::<R>())))
    }
}

#[inline]
fn up<R: Real>() -> R::Vec3 {
    R::Vec3::new(R::ZERO, R::ZERO, R::ONE)
}
