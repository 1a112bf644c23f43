//! Smooth tables that look like fitted ones and are made by a formula.

use glam::{DMat3, DVec3};
use ltc_table::{Axis, CellStats, Mapping, Quantity, Table};

/// The smallest width in the formula: keeps the matrices' condition number below some 300.
const NARROWEST: f64 = 5e-3;

/// A lobe around the mirror direction, as wide as α and αλ, pulled to the normal as α grows.
fn lobe(theta: f64, phi: f64, alpha: f64, lambda: f64) -> DMat3 {
    let tilt = theta * (1.0 - 0.6 * alpha);
    let (x, y) = (alpha.max(NARROWEST), (alpha * lambda).max(NARROWEST));
    // The tilt is a rotation about the horizontal axis across the view, the widths are along tangent and bitangent.
    let across = DVec3::new(phi.sin(), -phi.cos(), 0.0);
    let stretch = DMat3::from_diagonal(DVec3::new(x * (1.0 + 0.3 * theta.sin()), y, 1.0));
    DMat3::from_axis_angle(across, tilt) * stretch
}

/// A table over any axes; `query` turns the nodes of an entry into (θ, φ, α, λ).
pub fn table(axes: Vec<Axis>, query: impl Fn(&[(Quantity, f64)]) -> [f64; 4]) -> Table {
    let entries: usize = axes.iter().map(|a| a.len).product();
    let blank = vec![1.0; entries];
    let nodes =
        Table::new(axes.clone(), vec![DMat3::IDENTITY; entries], blank.clone(), blank, CellStats::default())
            .unwrap();
    let queries: Vec<_> = (0..entries).map(|i| query(&nodes.nodes_of(i))).collect();
    let m = queries.iter().map(|[t, p, a, l]| lobe(*t, *p, *a, *l)).collect();
    let magnitude = queries.iter().map(|[t, _, a, l]| 1.0 - 0.4 * a * (1.0 + 0.2 * l) * (1.0 - t * 0.1));
    let fresnel = queries.iter().map(|[t, p, a, _]| 0.02 + 0.3 * t * (1.0 - 0.5 * a) + 0.01 * p);
    Table::new(axes, m, magnitude.collect(), fresnel.collect(), CellStats::default()).unwrap()
}

/// 16 × 12 nodes with the mappings of the published isotropic table.
pub fn isotropic() -> Table {
    let axes = vec![
        Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, 16),
        Axis::full(Quantity::Alpha, Mapping::Sqrt, 12),
    ];
    table(axes, |nodes| [nodes[0].1, 0.0, nodes[1].1, 1.0])
}

/// 6 × 5 × 7 × 8 nodes, all lengths different; `theta` and `alpha` as given.
pub fn anisotropic(theta: Mapping, alpha: Mapping) -> Table {
    let axes = vec![
        Axis::full(Quantity::Theta, theta, 6),
        Axis::full(Quantity::Phi, Mapping::Linear, 5),
        Axis::full(Quantity::Alpha, alpha, 7),
        Axis::full(Quantity::Lambda, Mapping::Linear, 8),
    ];
    table(axes, |nodes| [nodes[0].1, nodes[1].1, nodes[2].1, nodes[3].1])
}
