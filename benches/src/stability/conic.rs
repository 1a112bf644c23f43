//! Pieces of boundaries: segments and arcs of ellipses, as polynomial curves that have the same directions.

use crate::double_double::{DoubleDouble as D, Vec3};

/// The curve `a + b s + c s²` for s from `range[0]` to `range[1]`. Only its directions matter, so that an arc of an ellipse is
/// one: `c cos t + …` times `1 + tan²(t/2)` is a polynomial of degree two in `tan(t/2)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conic {
    pub coefficients: [Vec3; 3],
    pub range: [D; 2],
}

/// Cosine and sine of an angle.
pub(super) type Turn = [D; 2];

impl Conic {
    pub fn segment(from: Vec3, to: Vec3) -> Self {
        let zero = Vec3([D::ZERO; 3]);
        Self { coefficients: [from, to - from, zero], range: [D::ZERO, D::ONE] }
    }

    /// The arcs `centre + u cos t + v sin t` for t from `from` up to `to`, less than half a turn on.
    pub fn arc(centre: Vec3, [u, v]: [Vec3; 2], from: Turn, to: Turn) -> Vec<Self> {
        let [[c0, s0], [c1, s1]] = [from, to];
        let (cosine, sine) = (c0 * c1 + s0 * s1, c0 * s1 - s0 * c1);
        let axes = [u * c0 + v * s0, v * c0 - u * s0];
        let [x, y] = axes;
        // Halved until no piece exceeds a quarter turn.
        if cosine < D::ZERO {
            let half: D = 0.5.into();
            let middle = [((D::ONE + cosine) * half).sqrt(), ((D::ONE - cosine) * half).sqrt()];
            let start = [D::ONE, D::ZERO];
            let mut arcs = Self::arc(centre, axes, start, middle);
            arcs.extend(Self::arc(centre, axes, middle, [cosine, sine]));
            return arcs;
        }
        let coefficients = [centre + x, y * 2.0.into(), centre - x];
        vec![Self { coefficients, range: [D::ZERO, sine / (D::ONE + cosine)] }]
    }

    /// The whole ellipse.
    pub fn ellipse(centre: Vec3, axes: [Vec3; 2]) -> Vec<Self> {
        let (o, l) = (D::ZERO, D::ONE);
        let turns = [[l, o], [o, l], [-l, o], [o, -l], [l, o]];
        turns.windows(2).flat_map(|turn| Self::arc(centre, axes, turn[0], turn[1])).collect()
    }

    pub fn at(&self, s: D) -> Vec3 {
        let [a, b, c] = self.coefficients;
        a + (b + c * s) * s
    }

    /// Its image.
    pub fn mapped(&self, map: impl Fn(Vec3) -> Vec3) -> Self {
        Self { coefficients: self.coefficients.map(map), ..*self }
    }

    /// The parts between the places where z = 0, in order.
    pub fn cut_at_horizon(&self) -> Vec<Self> {
        let [a, b, c] = self.coefficients.map(|v| v.0[2]);
        let mut cuts = vec![self.range[0]];
        let mut roots = roots(a, b, c);
        roots.sort_by(|x, y| x.to_f64().total_cmp(&y.to_f64()));
        cuts.extend(roots.into_iter().filter(|s| *s > self.range[0] && *s < self.range[1]));
        cuts.push(self.range[1]);
        cuts.windows(2).map(|range| Self { range: [range[0], range[1]], ..*self }).collect()
    }

    /// Whether a part that no horizon cuts is above it.
    pub fn is_above(&self) -> bool {
        let middle = (self.range[0] + self.range[1]) * 0.5.into();
        self.at(middle).0[2] > D::ZERO
    }
}

/// Real roots of `a + b s + c s²`, without cancellation.
fn roots(a: D, b: D, c: D) -> Vec<D> {
    let discriminant = b * b - a * c * 4.0.into();
    if discriminant < D::ZERO {
        return Vec::new();
    }
    let root = discriminant.sqrt();
    let half: D = 0.5.into();
    let q = -(if b < D::ZERO { b - root } else { b + root }) * half;
    let mut found = Vec::new();
    if q != D::ZERO {
        found.push(a / q);
    }
    if c != D::ZERO {
        found.push(q / c);
    }
    found
}
