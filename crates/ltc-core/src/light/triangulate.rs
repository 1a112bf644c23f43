//! Cutting simple polygons into triangles.

use glam::DVec2;

/// The triangles of a simple polygon that winds counter-clockwise, as indices of its vertices, by clipping ears. Vertices on
/// straight or doubled edges are left out where they span nothing.
///
/// `None` where edges cross each other. Costs O(n³) at worst.
pub(super) fn triangulate(points: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    if crosses_itself(points) {
        return None;
    }
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len().saturating_sub(2));
    while ring.len() > 2 {
        let corner = |i: usize| {
            let n = ring.len();
            [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]]
        };
        let area = |i: usize| doubled_area(corner(i).map(|v| points[v]));
        // What spans nothing goes first: a spike would hide ears.
        if let Some(i) = (0..ring.len()).find(|&i| area(i) == 0.0) {
            ring.remove(i);
            continue;
        }
        let ear = (0..ring.len()).find(|&i| area(i) > 0.0 && is_empty(corner(i), &ring, points))?;
        triangles.push(corner(ear));
        ring.remove(ear);
    }
    Some(triangles)
}

/// Twice the signed area.
pub(super) fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether `p` lies in a counter-clockwise triangle or on its border.
pub(super) fn contains([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    doubled_area([a, b, p]) >= 0.0 && doubled_area([b, c, p]) >= 0.0 && doubled_area([c, a, p]) >= 0.0
}

/// Whether no vertex of the ring lies in the triangle, but those at its own corners.
fn is_empty(triangle: [usize; 3], ring: &[usize], points: &[DVec2]) -> bool {
    let corners = triangle.map(|i| points[i]);
    let others = ring.iter().map(|&i| points[i]).filter(|p| !corners.contains(p));
    !others.into_iter().any(|p| contains(corners, p))
}

/// Whether two edges cross at an inner point of both.
fn crosses_itself(points: &[DVec2]) -> bool {
    let edge = |i: usize| (points[i], points[(i + 1) % points.len()]);
    (0..points.len()).any(|i| (i + 2..points.len()).any(|j| edges_cross(edge(i), edge(j))))
}

fn edges_cross((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let opposite = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    opposite(doubled_area([a, b, c]), doubled_area([a, b, d]))
        && opposite(doubled_area([c, d, a]), doubled_area([c, d, b]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::SplitMix64;

    fn check(points: &[[f64; 2]]) -> usize {
        let points: Vec<DVec2> = points.iter().map(|&[x, y]| DVec2::new(x, y)).collect();
        let triangles = triangulate(&points).expect("the polygon is simple");
        let whole: f64 = (2..points.len()).map(|i| doubled_area([points[0], points[i - 1], points[i]])).sum();
        let areas: Vec<f64> = triangles.iter().map(|t| doubled_area(t.map(|i| points[i]))).collect();
        assert!(areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12);
        // No point in two triangles.
        let mut random = SplitMix64::new(5);
        for _ in 0..500 {
            let p = DVec2::new(random.range(-3.0, 3.0), random.range(-3.0, 3.0));
            let inside = triangles.iter().filter(|t| contains(t.map(|i| points[i]), p)).count();
            assert!(inside <= 1, "{p} is in {inside} triangles");
        }
        triangles.len()
    }

    #[test]
    fn notches_combs_and_spirals() {
        assert_eq!(check(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]), 4);
        assert_eq!(check(&[[-2.0, -2.0], [2.0, -2.0], [0.0, -1.5], [0.0, 2.0]]), 2);
        let comb = [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [1.5, -0.9], [1.0, 1.0], [0.5, -0.9], [0.0, 1.0]];
        assert_eq!(check(&comb), 5);
        // A band that winds one and a half times around.
        let arm = |r: f64| (0..24).map(move |i| (r + 0.05 * f64::from(i), 0.4 * f64::from(i)));
        let outer = arm(1.0).map(|(r, phi)| [r * phi.cos(), r * phi.sin()]);
        let inner = arm(0.8).rev().map(|(r, phi)| [r * phi.cos(), r * phi.sin()]);
        assert_eq!(check(&outer.chain(inner).collect::<Vec<_>>()), 46);
    }

    #[test]
    fn straight_doubled_and_touching_vertices_are_no_trouble() {
        assert_eq!(
            check(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]]),
            2
        );
        // A square with a slit to a square hole: the slit is run through both ways.
        let holed = [
            [-2.0, -2.0],
            [2.0, -2.0],
            [2.0, 2.0],
            [-2.0, 2.0],
            [-2.0, -2.0],
            [-1.0, -1.0],
            [-1.0, 1.0],
            [1.0, 1.0],
            [1.0, -1.0],
            [-1.0, -1.0],
        ];
        check(&holed);
        // Two triangles that touch in a point.
        check(&[[-1.0, -1.0], [0.0, 0.0], [1.0, -1.0], [1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]]);
    }

    #[test]
    fn crossing_edges_are_refused() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.5]].map(|[x, y]| DVec2::new(x, y));
        assert_eq!(triangulate(&bow), None);
        let star: Vec<DVec2> =
            (0..5).map(|i| DVec2::from_angle(core::f64::consts::TAU * 0.4 * f64::from(i))).collect();
        assert_eq!(triangulate(&star), None, "a pentagram winds twice around its middle");
    }
}
