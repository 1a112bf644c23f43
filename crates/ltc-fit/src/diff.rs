//! What changed from one table to another.

use std::collections::BTreeMap;

use glam::DMat3;
use ltc_core::{Ltc, Matrix, points::r2};
use ltc_table::{Quantity, Table, TableError, TableVersion};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value;

use crate::{
    FitError, draw,
    measure::{maximum, mean},
};

/// The difference of two tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableDiff {
    /// Whether the payloads are the same, byte for byte.
    pub same_payload: bool,
    /// Entry by entry; `None` where the axes differ.
    pub entries: Option<EntryDiffs>,
    /// Between what lookups say over random queries of the standard draw (the isotropic one where a table is).
    pub lookups: Change,
    /// Numbers and words of the manifests that differ: by their path, the first table's and the second's.
    pub manifest: BTreeMap<String, [Value; 2]>,
}

/// Differences of entries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryDiffs {
    /// Over all entries.
    pub all: Change,
    /// Mean of `|M₁ − c M₂ R_z(ψ)| / |M₁|` (Frobenius), with the c and ψ that make it least: scale and turn of an entry
    /// change no lobe.
    pub m_mean: f64,
    /// Its maximum.
    pub m_max: f64,
    /// The entry whose lobe changed most.
    pub worst: usize,
    /// What that entry stands for.
    pub worst_node: BTreeMap<&'static str, f64>,
    /// Total variation between the lobes of each entry, in table order.
    pub tv: Vec<f64>,
}

/// Sizes of differences.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Change {
    /// How many were compared.
    pub compared: usize,
    /// Mean total variation between the two lobes.
    pub tv_mean: f64,
    /// Its maximum.
    pub tv_max: f64,
    /// Mean difference of the magnitudes.
    pub magnitude_mean: f64,
    /// Its maximum.
    pub magnitude_max: f64,
    /// Mean difference of the Fresnel terms.
    pub fresnel_mean: f64,
    /// Its maximum.
    pub fresnel_max: f64,
}

/// Queries of the standard draw.
const QUERIES: usize = 2000;
/// Seed of the queries.
const SEED: u64 = 41;
/// Samples of a lobe: total variations are right to about 1e-3.
const SAMPLES: usize = 1024;

/// Compares two tables.
///
/// # Errors
/// None for valid tables.
pub fn diff(first: &TableVersion, second: &TableVersion) -> Result<TableDiff, FitError> {
    let tables = [first.table(), second.table()];
    let entries = (tables[0].axes() == tables[1].axes()).then(|| entries(tables[0], tables[1]));
    let mut manifest = BTreeMap::new();
    let value = |version: &TableVersion| serde_json::to_value(version.manifest()).map_err(TableError::from);
    differences("", &value(first)?, &value(second)?, &mut manifest);
    Ok(TableDiff {
        same_payload: first.payload() == second.payload(),
        entries,
        lookups: lookups(tables[0], tables[1])?,
        manifest,
    })
}

/// Two lobes, magnitudes and Fresnel terms against each other.
struct Pair {
    tv: f64,
    magnitude: f64,
    fresnel: f64,
}

impl Change {
    fn of(pairs: &[Pair]) -> Self {
        let sizes = |of: fn(&Pair) -> f64| {
            let sizes: Vec<f64> = pairs.iter().map(of).collect();
            (mean(&sizes), maximum(&sizes))
        };
        let (tv_mean, tv_max) = sizes(|p| p.tv);
        let (magnitude_mean, magnitude_max) = sizes(|p| p.magnitude);
        let (fresnel_mean, fresnel_max) = sizes(|p| p.fresnel);
        Self {
            compared: pairs.len(),
            tv_mean,
            tv_max,
            magnitude_mean,
            magnitude_max,
            fresnel_mean,
            fresnel_max,
        }
    }
}

fn entries(first: &Table, second: &Table) -> EntryDiffs {
    let pair = |i: usize| Pair {
        tv: between(first.m()[i], second.m()[i]),
        magnitude: (first.magnitude()[i] - second.magnitude()[i]).abs(),
        fresnel: (first.fresnel()[i] - second.fresnel()[i]).abs(),
    };
    let pairs: Vec<Pair> = (0..first.m().len()).into_par_iter().map(pair).collect();
    let changes: Vec<f64> = first.m().iter().zip(second.m()).map(|(a, b)| matrix_change(*a, *b)).collect();
    let tv: Vec<f64> = pairs.iter().map(|pair| pair.tv).collect();
    let worst = (0..tv.len()).fold(0, |worst, i| if tv[i] > tv[worst] { i } else { worst });
    let name = |(quantity, value): (Quantity, f64)| (quantity.name(), value);
    EntryDiffs {
        all: Change::of(&pairs),
        m_mean: mean(&changes),
        m_max: maximum(&changes),
        worst,
        worst_node: first.nodes_of(worst).into_iter().map(name).collect(),
        tv,
    }
}

fn lookups(first: &Table, second: &Table) -> Result<Change, FitError> {
    let isotropic = first.axes().len() == 2 || second.axes().len() == 2;
    let queries = draw::standard(QUERIES, SEED, isotropic);
    let pair = |query| {
        let (a, b) = (first.lookup(query)?, second.lookup(query)?);
        let [ma, mb] = [&a, &b].map(|lookup| DMat3::from_row_array(lookup.lobes[0].m));
        Ok(Pair {
            tv: between(ma, mb),
            magnitude: (a.magnitude - b.magnitude).abs(),
            fresnel: (a.fresnel - b.fresnel).abs(),
        })
    };
    let pairs: Result<Vec<Pair>, FitError> = queries.par_iter().map(pair).collect();
    Ok(Change::of(&pairs?))
}

/// `TV(q₁, q₂) = E max(0, 1 − q₂/q₁)` over samples of `q₁`; 1 for a matrix that is no LTC's, 0 for equal ones.
fn between(first: DMat3, second: DMat3) -> f64 {
    let (Ok(p), Ok(q)) = (Ltc::<f64>::new(first), Ltc::<f64>::new(second)) else { return 1.0 };
    let excess = |i: usize| {
        let w = p.sample(r2(i, [0.5, 0.5]));
        let density = p.density(w);
        if density > 0.0 { (1.0 - q.density(w) / density).max(0.0) } else { 0.0 }
    };
    (0..SAMPLES).map(excess).sum::<f64>() / SAMPLES as f64
}

/// `min over c, ψ of |A − c B R_z(ψ)| / |A|`. With `C = Bᵀ A`, `⟨A, B R_z⟩ = cos ψ (C₀₀ + C₁₁) + sin ψ (C₁₀ − C₀₁) + C₂₂`
/// is largest at the angle of its two coefficients, and c is that over `|B|²`.
fn matrix_change(a: DMat3, b: DMat3) -> f64 {
    let square = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>();
    let c = b.transpose() * a;
    let (cos, sin) = (c.x_axis.x + c.y_axis.y, c.x_axis.y - c.y_axis.x);
    let turned = b * DMat3::from_rotation_z(sin.atan2(cos));
    let scale = (cos.hypot(sin) + c.z_axis.z) / square(b);
    (square(a - turned * scale) / square(a)).sqrt()
}

/// Leaves of two JSON values that differ.
fn differences(path: &str, first: &Value, second: &Value, found: &mut BTreeMap<String, [Value; 2]>) {
    if let (Some(a), Some(b)) = (first.as_object(), second.as_object()) {
        let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        for key in keys {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let of = |object: &serde_json::Map<String, Value>| object.get(key).cloned().unwrap_or_default();
            differences(&path, &of(a), &of(b), found);
        }
    } else if first != second {
        found.insert(path.to_owned(), [first.clone(), second.clone()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix() -> DMat3 {
        DMat3::from_cols_array(&[0.4, 0.05, 0.1, -0.02, 0.2, 0.1, -0.6, -0.4, 0.7])
    }

    #[test]
    fn scale_and_turn_are_no_change() {
        let same = matrix() * DMat3::from_rotation_z(2.1) * 3.0;
        assert!(matrix_change(matrix(), same) < 1e-12 && between(matrix(), same) < 1e-12);
        let other = matrix() * DMat3::from_rotation_x(0.3);
        assert!(matrix_change(matrix(), other) > 0.1 && between(matrix(), other) > 0.05);
    }

    #[test]
    fn the_least_change_is_least() {
        let b = DMat3::from_cols_array(&[0.1, 0.35, 0.0, -0.3, 0.1, 0.1, -0.5, -0.4, 0.8]);
        let least = matrix_change(matrix(), b);
        let size = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        for i in 0..200 {
            for scale in [0.8, 0.9, 1.0, 1.1] {
                let turned = b * DMat3::from_rotation_z(f64::from(i) * 0.0315) * scale;
                assert!(size(matrix() - turned) / size(matrix()) >= least - 1e-12);
            }
        }
    }

    #[test]
    fn total_variation_of_known_lobes() {
        // A clamped cosine and its mirror image below share nothing; with itself it shares all.
        let flipped = DMat3::from_rotation_x(core::f64::consts::PI);
        assert!((between(DMat3::IDENTITY, flipped) - 1.0).abs() < 1e-9);
        assert_eq!(between(matrix(), matrix()), 0.0);
        assert!((between(matrix(), DMat3::IDENTITY) - between(DMat3::IDENTITY, matrix())).abs() < 5e-3);
    }
}
