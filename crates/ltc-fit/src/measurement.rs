//! Everything that a manifest says of a table's errors, as numbered evaluations that can be done in parts.

use ltc_table::{CellStats, Errors, Floors, Kind, Query, Table};

use crate::{
    Brdf, DiskPoints, DiskRule, FitError, Lattice, Lobe, Node, Reader, draw, grid_errors,
    grid_errors::Centres,
    measure,
    measure::{MEASURE_SHIFT, MeasureSettings},
    pieces::Item,
    run::Measured,
};

/// A measurement of a table: first the total variation at the entries, then at the queries of the standard draw, then magnitude
/// and Fresnel at its queries up to grazing, at the entries, and all of them at the centres of cells.
pub(crate) struct Measurement<'a> {
    brdf: &'a dyn Brdf,
    table: &'a Table,
    reader: Reader<'a>,
    floors: &'a Floors,
    settings: MeasureSettings,
    nodes: Vec<Node>,
    queries: Vec<Query>,
    grazing: Vec<Query>,
    points: DiskPoints,
    rule: DiskRule,
    grid_rule: DiskRule,
}

impl<'a> Measurement<'a> {
    pub(crate) fn new(
        brdf: &'a dyn Brdf,
        table: &'a Table,
        floors: &'a Floors,
        settings: MeasureSettings,
    ) -> Result<Self, FitError> {
        let MeasureSettings { queries, seed, .. } = settings;
        let isotropic = table.kind() == Kind::Isotropic;
        Ok(Self {
            brdf,
            table,
            reader: settings.layout.reader(table)?,
            floors,
            settings,
            nodes: Lattice::new(table.axes(), floors).nodes,
            queries: draw::standard(queries, seed, isotropic),
            grazing: draw::up_to(draw::ALBEDO_THETA_MAX_DEGREES, queries, seed, isotropic),
            points: DiskPoints::new(settings.samples, MEASURE_SHIFT),
            rule: DiskRule::of_about(measure::ALBEDO_NODES),
            grid_rule: DiskRule::of_about(grid_errors::ALBEDO_NODES),
        })
    }

    /// Evaluations in each part.
    fn parts(&self) -> [usize; 5] {
        let (nodes, queries) = (self.nodes.len(), self.queries.len());
        [nodes, queries, queries, nodes, grid_errors::cells(self.table.axes())]
    }

    /// Evaluations in all.
    pub(crate) fn len(&self) -> usize {
        self.parts().iter().sum()
    }

    /// One evaluation.
    pub(crate) fn item(&self, lobe: &mut Lobe, index: usize) -> Result<Item, FitError> {
        let (mut part, mut i) = (0, index);
        for size in self.parts() {
            if i < size {
                break;
            }
            (part, i) = (part + 1, i - size);
        }
        let Self { brdf, table, reader, points, .. } = self;
        Ok(match part {
            0 => [measure::node_tv(*brdf, &self.nodes[i], table.m()[i], points, lobe)?, 0.0, 0.0],
            1 => [measure::one_tv(*brdf, reader, &self.queries[i], points, lobe)?, 0.0, 0.0],
            2 => {
                let [magnitude, fresnel] =
                    measure::albedo_error(*brdf, reader, &self.grazing[i], &self.rule, lobe)?;
                [magnitude, fresnel, 0.0]
            }
            3 => grid_errors::node_miss(*brdf, table, i, &self.nodes[i], &self.grid_rule, lobe)?.into(),
            _ => {
                let (axes, floors, rule) = (table.axes(), self.floors, &self.grid_rule);
                Centres { brdf: *brdf, reader, axes, floors, points, rule }.miss(i, lobe)?.into()
            }
        })
    }

    /// What all of them say.
    pub(crate) fn finish(&self, items: &[Item]) -> Measured {
        let mut rest = items;
        let [cells, draw, grazing, nodes, centres] = self.parts().map(|size| {
            let (part, after) = rest.split_at(size.min(rest.len()));
            rest = after;
            part
        });
        let first = |part: &[Item]| part.iter().map(|item| item[0]).collect::<Vec<f64>>();
        let stats = measure::cell_stats(self.table, first(cells));
        let albedo: Vec<[f64; 2]> = grazing.iter().map(|item| [item[0], item[1]]).collect();
        let isotropic = self.table.kind() == Kind::Isotropic;
        let draw = measure::draw_errors(&self.queries, &first(draw), self.settings, isotropic);
        let misses = |part: &[Item]| part.iter().map(|item| (*item).into()).collect::<Vec<_>>();
        let grid = grid_errors::summary(self.table, &misses(nodes), &misses(centres));
        let errors = Errors { grid: Some(grid), ..measure::summary(draw, &stats, &albedo) };
        let CellStats { tv, leak, condition } = stats;
        Measured { tv, leak, condition, errors }
    }
}
