//! Small synthetic tables for this crate's tests.

use glam::DMat3;

use crate::{
    Axis, BrdfInfo, CellStats, DrawErrors, Errors, Floors, Manifest, Mapping, Quantity, Table, TableVersion,
    digest::digest,
};

/// A 3 × 3 × 4 × 3 table of smooth, invertible, all different entries.
pub fn anisotropic() -> Table {
    table(vec![
        Axis::full(Quantity::Theta, Mapping::Linear, 3),
        Axis::full(Quantity::Phi, Mapping::Linear, 3),
        Axis::full(Quantity::Alpha, Mapping::Linear, 4),
        Axis::full(Quantity::Lambda, Mapping::Linear, 3),
    ])
}

/// A 4 × 5 isotropic table.
pub fn isotropic() -> Table {
    table(vec![
        Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, 4),
        Axis::full(Quantity::Alpha, Mapping::Sqrt, 5),
    ])
}

/// The isotropic table with another magnitude.
pub fn scaled(factor: f64) -> Table {
    let table = isotropic();
    let magnitude = table.magnitude().iter().map(|n| factor * n).collect();
    let (axes, m, fresnel) = (table.axes().to_vec(), table.m().to_vec(), table.fresnel().to_vec());
    Table::new(axes, m, magnitude, fresnel, CellStats::default()).unwrap()
}

fn table(axes: Vec<Axis>) -> Table {
    let n: usize = axes.iter().map(|a| a.len).product();
    let entry = |i: usize| {
        let t = i as f64 / n as f64;
        DMat3::from_cols_array(&[0.5 + t, 0.1 * t, -t, -0.1, 0.3 + t * t, 0.2, -0.5 * t, 0.1, 1.0])
    };
    let channel = |scale: f64| (0..n).map(|i| scale * (1.0 - 0.5 * i as f64 / n as f64)).collect();
    Table::new(axes, (0..n).map(entry).collect(), channel(1.0), channel(0.1), CellStats::default()).unwrap()
}

/// A version of that table with a made-up manifest.
pub fn version(name: &str, number: u32, table: Table) -> TableVersion {
    let payload = TableVersion::payload_of(&table).unwrap();
    let draw = DrawErrors {
        draw: "anisotropic".into(),
        tv_mean: 0.1,
        tv_median: 0.1,
        tv_p95: 0.2,
        tv_max: 0.3,
        tv_mean_alpha_below_0_14: 0.1,
        tv_mean_alpha_from_0_14: 0.1,
        queries: 1,
        samples: 1,
        seed: 1,
    };
    let manifest = Manifest {
        name: name.into(),
        version: number,
        digest: digest(&payload),
        payload_bytes: payload.len() as u64,
        axes: table.axes().to_vec(),
        channels: Vec::new(),
        lobes: 1,
        normalisation: String::new(),
        handedness: String::new(),
        floors: Floors { alpha: 1e-4, lambda: 0.01, theta_max: 1.5 },
        brdf: BrdfInfo { name: "made-up".into(), parameters: serde_json::json!({}) },
        fit: serde_json::json!({}),
        errors: Errors {
            standard_draw: draw,
            leak_max: 0.0,
            leak_mean: 0.0,
            condition_max: 1.0,
            cell_tv_mean: 0.0,
            cell_tv_max: 0.0,
            magnitude_mean: 0.0,
            magnitude_max: 0.0,
            fresnel_mean: 0.0,
            fresnel_max: 0.0,
            grid: None,
        },
        created: "2026-01-01T00:00:00Z".into(),
        tool: "test".into(),
        licence: "CC0-1.0".into(),
    };
    TableVersion::new(manifest, payload).unwrap()
}
