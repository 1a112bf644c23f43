//! Errors over the whole grid: at every entry, and at the centre of every cell between entries.

use glam::DMat3;
use ltc_core::Matrix;
use ltc_table::{Axis, Floors, GridErrors, Quantity, Query, Table};
use rayon::prelude::*;

use crate::{
    Brdf, DiskPoints, DiskRule, FitError, Lattice, Layout, Lobe, Node, Reader,
    measure::{MEASURE_SHIFT, MeasureSettings, maximum, mean},
    total_variation,
};

/// Nodes of the quadrature that magnitude and Fresnel are held against: right to 3e-5 in the mean, see [`DiskRule`].
pub(crate) const ALBEDO_NODES: usize = 2048;

/// What a lookup misses by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    /// Total variation; at entries, where the table's own array has it, 0.
    pub tv: f64,
    /// Magnitude − its integral.
    pub magnitude: f64,
    /// Fresnel term − its integral.
    pub fresnel: f64,
}

impl From<Miss> for [f64; 3] {
    fn from(miss: Miss) -> Self {
        [miss.tv, miss.magnitude, miss.fresnel]
    }
}

impl From<[f64; 3]> for Miss {
    fn from([tv, magnitude, fresnel]: [f64; 3]) -> Self {
        Self { tv, magnitude, fresnel }
    }
}

/// The summary of [`node_misses`] and [`centre_misses`].
///
/// # Errors
/// None for a valid table.
pub fn grid_errors(
    brdf: &dyn Brdf,
    table: &Table,
    floors: &Floors,
    settings: MeasureSettings,
) -> Result<GridErrors, FitError> {
    let nodes = node_misses(brdf, table, floors)?;
    let centres = centre_misses(brdf, table, settings.layout, floors, settings.samples)?;
    Ok(summary(table, &nodes, &centres))
}

/// The same of misses that are known.
pub(crate) fn summary(table: &Table, nodes: &[Miss], centres: &[Miss]) -> GridErrors {
    let signed = |misses: &[Miss], of: fn(&Miss) -> f64| misses.iter().map(of).collect::<Vec<f64>>();
    let absolute = |misses: &[Miss], of: fn(&Miss) -> f64| {
        let sizes: Vec<f64> = misses.iter().map(|miss| of(miss).abs()).collect();
        (mean(&sizes), maximum(&sizes))
    };
    let (node_magnitude_mean, node_magnitude_max) = absolute(nodes, |m| m.magnitude);
    let (node_fresnel_mean, node_fresnel_max) = absolute(nodes, |m| m.fresnel);
    let (centre_tv_mean, centre_tv_max) = absolute(centres, |m| m.tv);
    let (centre_magnitude_mean, centre_magnitude_max) = absolute(centres, |m| m.magnitude);
    let (centre_fresnel_mean, centre_fresnel_max) = absolute(centres, |m| m.fresnel);
    let steps = steps(table);
    GridErrors {
        node_magnitude_mean,
        node_magnitude_bias: mean(&signed(nodes, |m| m.magnitude)),
        node_magnitude_max,
        node_fresnel_mean,
        node_fresnel_bias: mean(&signed(nodes, |m| m.fresnel)),
        node_fresnel_max,
        centre_tv_mean,
        centre_tv_max,
        centre_magnitude_mean,
        centre_magnitude_max,
        centre_fresnel_mean,
        centre_fresnel_max,
        step_mean: mean(&steps),
        step_max: maximum(&steps),
    }
}

/// What every entry's magnitude and Fresnel term miss at its own node, in table order.
///
/// # Errors
/// None for a valid table.
pub fn node_misses(brdf: &dyn Brdf, table: &Table, floors: &Floors) -> Result<Vec<Miss>, FitError> {
    let rule = DiskRule::of_about(ALBEDO_NODES);
    let nodes = Lattice::new(table.axes(), floors).nodes;
    nodes
        .par_iter()
        .enumerate()
        .map_init(Lobe::default, |lobe, (index, node)| node_miss(brdf, table, index, node, &rule, lobe))
        .collect()
}

/// What the magnitude and Fresnel term of one entry miss at its node.
pub(crate) fn node_miss(
    brdf: &dyn Brdf,
    table: &Table,
    index: usize,
    node: &Node,
    rule: &DiskRule,
    lobe: &mut Lobe,
) -> Result<Miss, FitError> {
    let albedo = brdf.albedo(node.wo(), node.widths()?, rule, lobe);
    let (magnitude, fresnel) = (table.magnitude()[index], table.fresnel()[index]);
    Ok(Miss { tv: 0.0, magnitude: magnitude - albedo.0, fresnel: fresnel - albedo.1 })
}

/// Cells between the entries.
pub(crate) fn cells(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| axis.len - 1).product()
}

/// What lookups miss at the centres of the cells between entries, in C order of the cells: each axis has one less than
/// nodes, and a centre is half-way between two nodes in the axis's own mapping. As at the entries, the BRDF is evaluated
/// at the floors where the centre is below them.
///
/// # Errors
/// None for a valid table.
pub fn centre_misses(
    brdf: &dyn Brdf,
    table: &Table,
    layout: Layout,
    floors: &Floors,
    samples: usize,
) -> Result<Vec<Miss>, FitError> {
    let reader = layout.reader(table)?;
    let (points, rule) = (DiskPoints::new(samples, MEASURE_SHIFT), DiskRule::of_about(ALBEDO_NODES));
    let at = Centres { brdf, reader: &reader, axes: table.axes(), floors, points: &points, rule: &rule };
    (0..cells(table.axes()))
        .into_par_iter()
        .map_init(Lobe::default, |lobe, index| at.miss(index, lobe))
        .collect()
}

/// What the centres of cells are held against.
pub(crate) struct Centres<'a> {
    pub(crate) brdf: &'a dyn Brdf,
    pub(crate) reader: &'a Reader<'a>,
    pub(crate) axes: &'a [Axis],
    pub(crate) floors: &'a Floors,
    pub(crate) points: &'a DiskPoints,
    pub(crate) rule: &'a DiskRule,
}

impl Centres<'_> {
    /// What a lookup misses at the centre of one cell.
    pub(crate) fn miss(&self, index: usize, lobe: &mut Lobe) -> Result<Miss, FitError> {
        let Self { brdf, reader, axes, floors, points, rule } = self;
        let Node { theta, phi, alpha, lambda } = centre(axes, index);
        let found = reader.lookup(&Query { theta, phi, alpha_x: alpha, alpha_y: alpha * lambda })?;
        let node = Node {
            theta: theta.min(floors.theta_max),
            phi,
            alpha: alpha.max(floors.alpha),
            lambda: lambda.max(floors.lambda),
        };
        let (magnitude, fresnel) = brdf.albedo(node.wo(), node.widths()?, rule, lobe);
        brdf.sample_lobe(node.wo(), node.widths()?, points, lobe);
        Ok(Miss {
            tv: total_variation(lobe, DMat3::from_row_array(found.lobes[0].m)),
            magnitude: found.magnitude - magnitude,
            fresnel: found.fresnel - fresnel,
        })
    }
}

/// `|M₁ − M₂| / (|M₁| + |M₂|)` of every two entries beside each other, in table order, axis by axis.
fn steps(table: &Table) -> Vec<f64> {
    let size = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let m = table.m();
    let mut steps = Vec::new();
    let mut stride = 1;
    for axis in table.axes().iter().rev() {
        let inner = (0..m.len()).filter(|i| i / stride % axis.len + 1 < axis.len);
        steps.extend(inner.map(|i| {
            let (a, b) = (m[i], m[i + stride]);
            size(a - b) / (size(a) + size(b)).max(f64::MIN_POSITIVE)
        }));
        stride *= axis.len;
    }
    steps
}

/// The centre of a cell, floors not applied.
fn centre(axes: &[Axis], index: usize) -> Node {
    let mut node = Node { theta: 0.0, phi: 0.0, alpha: 1.0, lambda: 1.0 };
    let mut rest = index;
    for axis in axes.iter().rev() {
        let cell = rest % (axis.len - 1);
        rest /= axis.len - 1;
        let ends = [axis.node(cell), axis.node(cell + 1)].map(|x| axis.mapping.coordinate(x));
        let value = axis.mapping.value(0.5 * (ends[0] + ends[1]));
        match axis.quantity {
            Quantity::Theta => node.theta = value,
            Quantity::Phi => node.phi = value,
            Quantity::Alpha => node.alpha = value,
            Quantity::Lambda => node.lambda = value,
        }
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_table::Mapping;

    #[test]
    fn steps_are_those_between_neighbours() {
        let axes = vec![
            Axis::full(Quantity::Theta, Mapping::Linear, 3),
            Axis::full(Quantity::Alpha, Mapping::Linear, 2),
        ];
        // Entry (i, j) is (1 + i) times the identity: no step along α, 1/3 and 1/5 along θ.
        let m = (0..6).map(|k| DMat3::IDENTITY * f64::from(1 + k / 2)).collect();
        let table = Table::new(axes, m, vec![1.0; 6], vec![0.0; 6], ltc_table::CellStats::default()).unwrap();
        let found = steps(&table);
        assert_eq!(found.len(), 3 + 4);
        assert!(found[..3].iter().all(|step| *step == 0.0), "{found:?}");
        for (step, expected) in found[3..].iter().zip([1.0 / 3.0, 1.0 / 3.0, 0.2, 0.2]) {
            assert!((step - expected).abs() < 1e-15, "{found:?}");
        }
    }

    #[test]
    fn centres_lie_half_way_in_every_cell() {
        let axes = [
            Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, 4),
            Axis::full(Quantity::Phi, Mapping::Linear, 3),
            Axis::full(Quantity::Alpha, Mapping::Sqrt, 5),
            Axis { domain: [0.1, 1.0], ..Axis::full(Quantity::Lambda, Mapping::Linear, 2) },
        ];
        let mut seen = std::collections::BTreeSet::new();
        for index in 0..3 * 2 * 4 {
            let Node { theta, phi, alpha, lambda } = centre(&axes, index);
            let values = [theta, phi, alpha, lambda];
            let cells = [0, 1, 2, 3].map(|k| {
                let (cell, within) = axes[k].locate(values[k]);
                assert!((within - 0.5).abs() < 1e-12, "{index}: {values:?}");
                cell
            });
            assert_eq!(((cells[0] * 2 + cells[1]) * 4 + cells[2]) + cells[3], index);
            seen.insert(cells);
        }
        assert_eq!(seen.len(), 24);
    }
}
