//! What a lobe sees of a light, by quadrature of its boundary in numbers of 31 digits. It shares no code with `ltc-core`.
//!
//! The light is a closed curve of segments and elliptical arcs ([`super::conic`]). What is below the surface is cut away, the rest
//! goes to cosine space by M⁻¹, and Stokes' theorem makes `∫ max(0, cos θ)/π` one over the curve: `(1/2π) ∮ f`, with
//! `f = (x dy − y dx)/|p|²` above the horizon there and `(x dy − y dx)/(x² + y²)`, that of the point's shadow on the equator,
//! below. A curve around the nadir gives 1 less. Lines and strips are their defining integrals along the line (2017 chapter,
//! eq. 1.6 and 1.35).

use ltc_core::{AnyLight, Sides};

use super::Case;
use super::conic::{Conic, Turn};
use super::quadrature::{integrate, knots};
use crate::double_double::{DoubleDouble as D, Vec3};

/// Error of one panel before its last halving.
const TOLERANCE: f64 = 1e-16;

/// The fraction of the lobe that sees the light, both horizons cut. Two-sided flat lights only, as all cases are.
pub fn oracle(case: &Case) -> f64 {
    let lobe = Lobe::new(case.m);
    let v = |p: &[f64; 3]| Vec3::from_f64(*p);
    match &case.light {
        AnyLight::Line { p0, p1, radius } => {
            let line = Straight::new(v(p0), v(p1));
            line.map_or(0.0, |line| line.integral(&lobe, line.distance * D::from(2.0 * radius)))
        }
        AnyLight::Strip { p0, p1, width, normal, .. } => {
            let line = Straight::new(v(p0), v(p1));
            line.map_or(0.0, |line| line.integral(&lobe, line.height(v(normal)) * (*width).into()))
        }
        light => lobe.fraction(&outline(light)),
    }
}

/// M⁻¹, its determinant positive.
struct Lobe {
    rows: [Vec3; 3],
}

impl Lobe {
    fn new(m: [f64; 9]) -> Self {
        let row = |i: usize| Vec3::from_f64([m[3 * i], m[3 * i + 1], m[3 * i + 2]]);
        let (a, b, c) = (row(0), row(1), row(2));
        let (x, y, z) = (b.cross(c), c.cross(a), a.cross(b));
        let determinant = a.dot(x);
        // The columns of the inverse are the crosses of the rows of M.
        let inverse = |i: usize| Vec3([x.0[i], y.0[i], z.0[i]].map(|e| e / determinant));
        Self { rows: [inverse(0), inverse(1), inverse(2)] }
    }

    fn to_cosine(&self, p: Vec3) -> Vec3 {
        Vec3(self.rows.map(|row| row.dot(p)))
    }

    fn determinant(&self) -> D {
        let [a, b, c] = self.rows;
        a.dot(b.cross(c)).abs()
    }

    /// The mass inside the closed curve, which has its inside on the left.
    fn fraction(&self, outline: &[Conic]) -> f64 {
        let (mut sum, mut azimuth) = (D::ZERO, 0.0);
        for piece in above_surface(outline) {
            for part in piece.mapped(|p| self.to_cosine(p)).cut_at_horizon() {
                sum += turning(&part);
                azimuth += sweep(&part);
            }
        }
        let value = (sum / (D::PI * 2.0.into())).to_f64();
        // Next to 0 or 1 only the way around tells which; elsewhere a negative value alone does, and does not depend on steps.
        let is_around_nadir = value < -1e-6 || (value < 0.0 && azimuth < -core::f64::consts::PI);
        (if is_around_nadir { value + 1.0 } else { value }).clamp(0.0, 1.0)
    }
}

/// The curve without what is below the surface: straight from where it sinks to where it rises again.
fn above_surface(outline: &[Conic]) -> Vec<Conic> {
    let parts: Vec<Conic> = outline.iter().flat_map(Conic::cut_at_horizon).collect();
    // From a part above on: a gap is then closed by the next part above.
    let Some(first) = parts.iter().position(Conic::is_above) else { return Vec::new() };
    let on_horizon = |p: Vec3| Vec3([p.0[0], p.0[1], D::ZERO]);
    let mut kept: Vec<Conic> = Vec::new();
    let mut sank: Option<Vec3> = None;
    for part in parts[first..].iter().chain(&parts[..=first]) {
        if part.is_above() {
            if let Some(from) = sank.take() {
                kept.push(Conic::segment(from, on_horizon(part.at(part.range[0]))));
            }
            kept.push(*part);
        } else if sank.is_none() {
            sank = kept.last().map(|last| on_horizon(last.at(last.range[1])));
        }
    }
    // The first came round again.
    kept.pop();
    kept
}

/// By how much the azimuth grows along a part, in small steps.
fn sweep(part: &Conic) -> f64 {
    const STEPS: u32 = 64;
    let [from, to] = part.range;
    let at = |i: u32| part.at(from + (to - from) * (f64::from(i) / f64::from(STEPS)).into()).0;
    (0..STEPS)
        .map(|i| {
            let ([a, b, _], [x, y, _]) = (at(i), at(i + 1));
            (a * y - b * x).to_f64().atan2((a * x + b * y).to_f64())
        })
        .sum()
}

/// `∫ f` along a part that no horizon cuts, in cosine space.
fn turning(part: &Conic) -> D {
    let is_above = part.is_above();
    let numerator = |i: usize, j: usize| {
        let (a, b) = (part.coefficients[i].0, part.coefficients[j].0);
        a[0] * b[1] - a[1] * b[0]
    };
    // x y' − y x' of a + b s + c s²
    let (constant, linear, square) = (numerator(0, 1), numerator(0, 2) * 2.0.into(), numerator(1, 2));
    if [constant, linear, square].iter().all(|c| *c == D::ZERO) {
        return D::ZERO;
    }
    let single = part.coefficients.map(|c| c.0.map(D::to_f64));
    let size = |s: f64| {
        let [x, y, z] = [0, 1, 2].map(|k| single[0][k] + s * (single[1][k] + s * single[2][k]));
        x * x + y * y + if is_above { z * z } else { 0.0 }
    };
    let f = |s: D| {
        let [x, y, z] = part.at(s).0;
        let flat = x * x + y * y;
        (constant + (linear + square * s) * s) / if is_above { flat + z * z } else { flat }
    };
    integrate(f, &knots(size, part.range), TOLERANCE)
}

/// The outline of a light that is seen from outside, or the horizon for one that is everywhere.
fn outline(light: &AnyLight) -> Vec<Conic> {
    let v = |p: &[f64; 3]| Vec3::from_f64(*p);
    match light {
        AnyLight::Polygon { vertices, sides } => {
            debug_assert_eq!(*sides, Sides::Two);
            let vertices: Vec<Vec3> = vertices.iter().map(v).collect();
            let first = vertices[0];
            let area = vertices
                .windows(2)
                .fold(Vec3([D::ZERO; 3]), |sum, pair| sum + (pair[0] - first).cross(pair[1] - first));
            let next = vertices[1..].iter().chain(&vertices[..1]);
            oriented(vertices.iter().zip(next).map(|(a, b)| Conic::segment(*a, *b)).collect(), area, first)
        }
        AnyLight::Disk { center, normal, radius, .. } => disk(v(center), v(normal), (*radius).into()),
        AnyLight::Ellipse { center, axis_u, axis_v, .. } => {
            let axes = [v(axis_u), v(axis_v)];
            oriented(Conic::ellipse(v(center), axes), axes[0].cross(axes[1]), v(center))
        }
        AnyLight::Sphere { center, radius } => sphere(v(center), (*radius).into()),
        AnyLight::Cylinder { p0, p1, radius, caps } => cylinder([v(p0), v(p1)], (*radius).into(), *caps),
        AnyLight::Line { .. } | AnyLight::Strip { .. } => Vec::new(),
    }
}

/// A curve around `area` through `point`, turned so that its inside is on the left for who walks on the outside of a sphere
/// around the origin.
fn oriented(curve: Vec<Conic>, area: Vec3, point: Vec3) -> Vec<Conic> {
    let side = area.dot(point);
    if side == D::ZERO {
        Vec::new()
    } else if side > D::ZERO {
        curve
    } else {
        curve.into_iter().rev().map(|c| reversed(&c)).collect()
    }
}

/// The same curve from its end to its start: s → −s.
fn reversed(curve: &Conic) -> Conic {
    let ([a, b, c], [from, to]) = (curve.coefficients, curve.range);
    Conic { coefficients: [a, b * -D::ONE, c], range: [-to, -from] }
}

/// Two unit vectors at right angles to `normal` and to each other.
fn across(normal: Vec3) -> [Vec3; 2] {
    let size = normal.0.map(D::abs);
    let mut other = [D::ZERO; 3];
    let thin = (0..3).min_by(|i, j| size[*i].to_f64().total_cmp(&size[*j].to_f64())).unwrap_or(0);
    other[thin] = D::ONE;
    let u = unit(normal.cross(Vec3(other)));
    [u, unit(normal.cross(u))]
}

fn unit(v: Vec3) -> Vec3 {
    v * (D::ONE / v.length())
}

fn disk(centre: Vec3, normal: Vec3, radius: D) -> Vec<Conic> {
    let [u, v] = across(normal).map(|axis| axis * radius);
    oriented(Conic::ellipse(centre, [u, v]), u.cross(v), centre)
}

/// All directions above the surface.
fn everywhere() -> Vec<Conic> {
    let axis = |k: usize| Vec3([0, 1, 2].map(|i| if i == k { D::ONE } else { D::ZERO }));
    // Just above the surface, by less than a rounding error of the result.
    Conic::ellipse(axis(2) * 1e-25.into(), [axis(0), axis(1)])
}

/// The circle where tangents touch.
fn sphere(centre: Vec3, radius: D) -> Vec<Conic> {
    let squared = centre.dot(centre);
    if squared <= radius * radius {
        return everywhere();
    }
    let shrink = (squared - radius * radius) / squared;
    disk(centre * shrink, centre, radius * shrink.sqrt())
}

/// Two generators that are seen edge-on, and at each end the near arc between them; the far one where a cap is seen.
fn cylinder(ends: [Vec3; 2], radius: D, caps: bool) -> Vec<Conic> {
    let axis = unit(ends[1] - ends[0]);
    let foot = ends[0] - axis * axis.dot(ends[0]);
    let (distance, heights) = (foot.length(), ends.map(|end| end.dot(axis)));
    let seen = [heights[0] > D::ZERO, heights[1] < D::ZERO];
    if distance <= radius {
        return match seen {
            [false, false] if caps => everywhere(),
            [true, _] if caps => disk(ends[0], axis, radius),
            [_, true] if caps => disk(ends[1], axis, radius),
            _ => Vec::new(),
        };
    }
    let towards = unit(foot) * -D::ONE;
    let axes = [towards * radius, axis.cross(towards) * radius];
    let cosine = radius / distance;
    let sine = ((distance - radius) * (distance + radius)).sqrt() / distance;
    let [u, v] = axes;
    let at = |end: Vec3, [c, s]: Turn| end + u * c + v * s;
    let [right, left] = [[cosine, -sine], [cosine, sine]];
    // From the left generator to the right one; t grows from right to left through the near side.
    let arc = |end: Vec3, far: bool| -> Vec<Conic> {
        let (o, l) = (D::ZERO, D::ONE);
        if far {
            let mut arcs = Conic::arc(end, axes, left, [-l, o]);
            arcs.extend(Conic::arc(end, axes, [-l, o], right));
            arcs
        } else {
            let mut arcs = Conic::arc(end, axes, right, [l, o]);
            arcs.extend(Conic::arc(end, axes, [l, o], left));
            arcs.into_iter().rev().map(|c| reversed(&c)).collect()
        }
    };
    let mut curve = vec![Conic::segment(at(ends[0], left), at(ends[1], left))];
    curve.extend(arc(ends[1], caps && seen[1]));
    curve.push(Conic::segment(at(ends[1], right), at(ends[0], right)));
    let back = arc(ends[0], caps && seen[0]);
    curve.extend(back.into_iter().rev().map(|c| reversed(&c)));
    let (a, b, c) = (at(ends[0], left), at(ends[1], left), at(ends[1], right));
    oriented(curve, (b - a).cross(c - b), a)
}

/// A straight line as seen from the origin.
struct Straight {
    p0: Vec3,
    along: Vec3,
    axis: Vec3,
    /// Of the infinite line.
    distance: D,
}

impl Straight {
    fn new(p0: Vec3, p1: Vec3) -> Option<Self> {
        let along = p1 - p0;
        let length = along.length();
        let distance = p0.cross(along).length() / length;
        (length > D::ZERO && distance > D::ZERO).then(|| Self { p0, along, axis: unit(along), distance })
    }

    /// Distance of the origin from the plane that holds the line and is at right angles to what `normal` has across it.
    fn height(&self, normal: Vec3) -> D {
        unit(normal - self.axis * self.axis.dot(normal)).dot(self.p0).abs()
    }

    /// `min(1, (factor / π) ∫ |det M⁻¹| z' / |p'|⁴ dl)` over what is above both horizons, p' = M⁻¹ p. With the lobe's density
    /// `|det M⁻¹| z' |p|³ / (π |p'|⁴)` at `p/|p|`, that is eq. 1.6 times R with factor 2 R d, and eq. 1.35 with factor w h.
    fn integral(&self, lobe: &Lobe, factor: D) -> f64 {
        let length = self.along.length();
        let scale = factor * lobe.determinant() * length / D::PI;
        let mut sum = D::ZERO;
        for part in Conic::segment(self.p0, self.p0 + self.along).cut_at_horizon() {
            if !part.is_above() {
                continue;
            }
            for part in part.mapped(|p| lobe.to_cosine(p)).cut_at_horizon() {
                if part.is_above() {
                    sum += Self::inner(&part, scale.to_f64());
                }
            }
        }
        (sum * scale).to_f64().clamp(0.0, 1.0)
    }

    fn inner(part: &Conic, scale: f64) -> D {
        let single = part.coefficients.map(|c| c.0.map(D::to_f64));
        let size = |s: f64| [0, 1, 2].iter().map(|&k| (single[0][k] + s * single[1][k]).powi(2)).sum::<f64>();
        let f = |s: D| {
            let p = part.at(s);
            let squared = p.dot(p);
            p.0[2] / (squared * squared)
        };
        integrate(f, &knots(size, part.range), TOLERANCE / scale)
    }
}
