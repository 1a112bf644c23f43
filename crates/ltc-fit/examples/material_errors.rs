//! The tables of `docs/materials.md`: error against size of each material's preset, and what one LTC can do at best.
//! `cargo run --release -p ltc-fit --example material_errors`

use glam::DMat3;
use ltc_core::Matrix;
use ltc_fit::{
    DiskPoints, FitError, FitSpec, Lobe, Pattern, direction, draw, fit, fit_entry, silent, total_variation,
};
use ltc_table::{Query, Table, TableVersion};

/// Queries at which the best LTC is sought.
const QUERIES: usize = 500;

fn main() -> Result<(), FitError> {
    println!("| preset | size | bytes | mean TV | p95 | max | α<0.14 | α≥0.14 | magnitude mean, max |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut last = Vec::new();
    for preset in ["beckmann-isotropic", "disney-diffuse", "oren-nayar", "charlie-sheen"] {
        let shipped = FitSpec::preset(preset)?;
        let len = shipped.axes[0].len;
        for len in [len / 4, len / 2, len] {
            let mut spec = shipped.clone();
            spec.axes.iter_mut().for_each(|axis| axis.len = len);
            let (table, e) = fit(&spec, &silent)?;
            let (draw, bytes) = (&e.standard_draw, TableVersion::payload_of(&table)?.len());
            println!(
                "| `{preset}` | {len}² | {bytes} | {:.4} | {:.4} | {:.4} | {:.4} | {:.4} | {:.1e}, {:.1e} |",
                draw.tv_mean,
                draw.tv_p95,
                draw.tv_max,
                draw.tv_mean_alpha_below_0_14,
                draw.tv_mean_alpha_from_0_14,
                e.magnitude_mean,
                e.magnitude_max
            );
            if len == shipped.axes[0].len {
                last.push((spec, table));
            }
        }
    }
    println!(
        "\n| preset | best LTC | table | table, weighted by energy | plain cosine |\n|---|---|---|---|---|"
    );
    last.iter().try_for_each(|(spec, table)| against_the_best(spec, table))
}

/// Mean total variation over the same queries, from samples that no fit saw.
fn against_the_best(spec: &FitSpec, table: &Table) -> Result<(), FitError> {
    let brdf = spec.brdf()?;
    let (fitted, unseen) = (DiskPoints::new(4096, [0.5, 0.5]), DiskPoints::new(4096, [0.37, 0.71]));
    let (mut lobe, mut sums, mut energy) = (Lobe::default(), [0.0; 4], 0.0);
    for query in draw::standard(QUERIES, spec.measure.seed, true) {
        let query = Query { phi: 0.0, ..query };
        let (wo, alpha) = (direction(query.theta, 0.0), query.validate()?);
        brdf.sample_lobe(wo, alpha, &fitted, &mut lobe);
        let best = fit_entry(&lobe, wo, Pattern::MirrorY, 300).m;
        brdf.sample_lobe(wo, alpha, &unseen, &mut lobe);
        let ours = DMat3::from_row_array(table.lookup(&query)?.lobes[0].m);
        let [best, ours, cosine] = [best, ours, DMat3::IDENTITY].map(|m| total_variation(&lobe, m));
        energy += lobe.magnitude;
        for (sum, tv) in sums.iter_mut().zip([best, ours, ours * lobe.magnitude, cosine]) {
            *sum += tv;
        }
    }
    let [best, ours, weighted, cosine] = sums;
    let n = QUERIES as f64;
    println!(
        "| `{}` | {:.4} | {:.4} | {:.4} | {:.4} |",
        spec.name,
        best / n,
        ours / n,
        weighted / energy,
        cosine / n
    );
    Ok(())
}
