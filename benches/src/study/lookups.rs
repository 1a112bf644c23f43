//! What a material costs to look up.

use std::hint::black_box;

use ltc_core::Ltc;
use ltc_fit::draw;
use ltc_table::{Kind, Query, Table, TableVersion};

use super::timer::Task;

/// Lookups of `count` materials of the standard draw in a table, lobes and channels; and with the inverse that shading needs
/// made of each lobe, which is what the 2022 paper does at run time.
pub fn tasks<'a>(version: &'a TableVersion, count: usize) -> [Task<'a>; 2] {
    let table = version.table();
    let queries = draw::standard(count, 5, table.kind() == Kind::Isotropic);
    let again = queries.clone();
    [
        Task::new(count, move || {
            for query in &queries {
                let _ = black_box(table.lookup(black_box(query)));
            }
        }),
        Task::new(count, move || {
            for query in &again {
                black_box(inverted(table, black_box(query)));
            }
        }),
    ]
}

fn inverted(table: &Table, query: &Query) -> Option<Ltc<f64>> {
    let lookup = table.lookup(query).ok()?;
    Ltc::new(ltc_core::Matrix::from_row_array(lookup.lobes.first()?.m)).ok()
}
