//! Sheets of the best LTC by each objective.

use std::error::Error;
use std::path::Path;

use glam::{DMat3, DVec3};
use ltc_core::Ltc;
use ltc_fit::objective::{SlicedWasserstein, cube_of_lobe, kl, l3};
use ltc_fit::{Lobe, Objective, Pattern, measure, median_start, refine_by, total_variation};

use crate::cases::Case;
use crate::sheet::Sheet;

/// The fits' objectives and their columns' titles.
const COLUMNS: [(Objective, &str); 4] = [
    (Objective::TotalVariation, "TV"),
    (Objective::SlicedWasserstein, "SLICED W"),
    (Objective::L3, "L3"),
    (Objective::Kl, "KL"),
];

/// What each objective says of an LTC, over samples that no fit has seen.
pub struct Scores {
    tv: f64,
    wasserstein: f64,
    l3: f64,
    kl: f64,
}

impl Scores {
    pub fn of(unseen: &Lobe, m: DMat3) -> Self {
        Self {
            tv: total_variation(unseen, m),
            wasserstein: SlicedWasserstein::with_resolution(unseen, 256, 4096).value(m),
            l3: l3(unseen, m) / cube_of_lobe(unseen),
            kl: kl(unseen, m),
        }
    }

    fn row(&self) -> String {
        format!("{:.4} | {:.4} | {:.1e} | {:.3}", self.tv, self.wasserstein, self.l3, self.kl)
    }
}

/// The density of `M`'s LTC.
pub fn density(m: DMat3) -> Result<impl Fn(DVec3) -> f64, ltc_core::InputError> {
    let ltc = Ltc::<f64>::new(m)?;
    Ok(move |w| ltc.density(w))
}

/// Fits every case by every objective, draws the sheet and prints its table.
pub fn figure(title: &str, cases: &[Case], path: &Path) -> Result<(), Box<dyn Error>> {
    let titles: Vec<String> = ["GGX".to_owned()]
        .into_iter()
        .chain(COLUMNS.map(|(_, name)| name.to_owned()))
        .chain(COLUMNS.map(|(_, name)| format!("{} - GGX", name.trim_start_matches("SLICED "))))
        .collect();
    let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
    let mut sheet = Sheet::new(&titles, 1 + COLUMNS.len(), cases.len());
    println!(
        "\n{title}\n\n| lobe | fitted by | TV | W | L³ / ∫p³ | KL | leak |\n|---|---|---|---|---|---|---|"
    );
    for (row, case) in cases.iter().enumerate() {
        draw_case(&mut sheet, row, case)?;
    }
    sheet.keys(true);
    sheet.canvas.save(path)
}

fn draw_case(sheet: &mut Sheet, row: usize, case: &Case) -> Result<(), Box<dyn Error>> {
    let lobe = case.lobe(4096, [0.5, 0.5])?;
    let unseen = case.lobe(1 << 15, [0.1, 0.7])?;
    let ggx = case.density(unseen.magnitude)?;
    let start = median_start(&lobe, case.wo(), Pattern::General);
    let chart = case.chart(start);
    let peak = chart.directions().map(&ggx).fold(0.0, f64::max);
    sheet.label(row, &case.lines());
    sheet.density((row, 0), &chart, peak, &ggx, "");
    for (column, (objective, _)) in COLUMNS.into_iter().enumerate() {
        let fit = refine_by(&objective.towards(&lobe), start, Pattern::General, 300);
        let (scores, ltc) = (Scores::of(&unseen, fit.m), density(fit.m)?);
        let leak = 100.0 * measure::leak(fit.m);
        println!("| {} | {} | {} | {leak:.1} % |", case.name(), objective.name(), scores.row());
        sheet.density((row, 1 + column), &chart, peak, &ltc, &format!("TV {:.3}", scores.tv));
        sheet.difference((row, 1 + COLUMNS.len() + column), &chart, peak, |w| ltc(w) - ggx(w));
    }
    Ok(())
}
