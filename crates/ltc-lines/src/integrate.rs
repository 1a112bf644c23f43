//! A line of `ltc integrate`.

use ltc_core::{AnyLight, Horizon, Ltc, Matrix, Real};
use ltc_table::{Catalogue, Query};
use serde::{Deserialize, Serialize};

use crate::object::reason;
use crate::{LightLine, object};

/// One line of input.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    m: Option<[f64; 9]>,
    table: Option<String>,
    theta: Option<f64>,
    phi: Option<f64>,
    alpha_x: Option<f64>,
    alpha_y: Option<f64>,
    light: LightLine,
}

/// One line of output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The fraction of the lobe that sees the light, in [0, 1].
    pub value: f64,
    /// What it was computed in: `f32` or `f64`.
    pub precision: &'static str,
}

/// A line understood: lobes with their weights, and a light.
#[derive(Clone, Debug, PartialEq)]
pub struct Integration {
    /// Weights and matrices, row-major.
    pub lobes: Vec<(f64, [f64; 9])>,
    /// The light.
    pub light: AnyLight,
}

impl Integration {
    /// From `{"m":[…],"light":…}` or `{"table":…,"theta":…,"phi":…,"alpha_x":…,"alpha_y":…,"light":…}`.
    ///
    /// # Errors
    /// What is wrong with the line.
    pub fn parse(catalogue: &Catalogue, line: &str) -> Result<Self, String> {
        let line: Line = object(line)?;
        let lobes = lobes(catalogue, &line)?;
        Ok(Self { lobes, light: line.light.into() })
    }

    /// The integral, computed in `R`.
    ///
    /// # Errors
    /// What is wrong with a matrix or the light.
    pub fn on_cpu<R: Real>(&self) -> Result<Answer, String> {
        let mut value = 0.0;
        for (weight, m) in &self.lobes {
            let ltc = Ltc::<R>::new(R::Mat3::from_row_array(m.map(R::of))).map_err(reason)?;
            let fraction = self.light.integrate(&ltc, Horizon::BOTH).map_err(reason)?;
            value += weight * fraction.to_f64();
        }
        Ok(Answer { value, precision: if size_of::<R>() == 4 { "f32" } else { "f64" } })
    }
}

fn lobes(catalogue: &Catalogue, line: &Line) -> Result<Vec<(f64, [f64; 9])>, String> {
    match (line, &line.m, &line.table) {
        (Line { theta: None, phi: None, alpha_x: None, alpha_y: None, .. }, Some(m), None) => {
            Ok(vec![(1.0, *m)])
        }
        (
            Line { theta: Some(theta), phi, alpha_x: Some(alpha_x), alpha_y: Some(alpha_y), .. },
            None,
            Some(table),
        ) => {
            let table = catalogue.find(table).map_err(reason)?.table();
            let phi = phi.unwrap_or(0.0);
            let query = Query { theta: *theta, phi, alpha_x: *alpha_x, alpha_y: *alpha_y };
            let lookup = table.lookup(&query).map_err(reason)?;
            Ok(lookup.lobes.into_iter().map(|lobe| (lobe.weight, lobe.m)).collect())
        }
        _ => {
            Err("give either \"m\", or \"table\" with \"theta\", \"phi\", \"alpha_x\" and \"alpha_y\""
                .to_owned())
        }
    }
}
