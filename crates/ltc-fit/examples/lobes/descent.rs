//! Figure 4 of the 2022 paper: what becomes of a fit that starts badly.

use std::error::Error;
use std::path::Path;

use glam::{DMat3, DVec3};
use ltc_fit::{Goal, Objective, Pattern, fit_entry, total_variation};

use crate::cases::Case;
use crate::fits::density;
use crate::sheet::Sheet;

/// A lobe, a start of which the paper's figure tells the kind, and what to call it.
struct Trial {
    case: Case,
    start: DMat3,
    lines: [&'static str; 2],
}

/// Descents by each objective: title, length of a step, number of steps. Lengths are the same for all trials.
const DESCENTS: [(Objective, &str, f64, usize); 3] = [
    (Objective::L3, "L3 DESCENT", 0.1, 4000),
    (Objective::SlicedWasserstein, "W DESCENT", 0.02, 4000),
    (Objective::TotalVariation, "TV DESCENT", 0.02, 4000),
];

fn trials() -> [Trial; 3] {
    let case = |alpha: f64| Case { theta: 55.0, phi: 20.0, alpha: [alpha, alpha], cap: None };
    let away = DMat3::from_diagonal(DVec3::new(0.1, 0.1, 1.0));
    [
        Trial { case: case(0.5), start: DMat3::IDENTITY, lines: ["(A)", "SIMPLE"] },
        Trial { case: case(0.1), start: away, lines: ["(B)", "APART"] },
        Trial { case: case(0.1), start: DMat3::IDENTITY, lines: ["(C)", "SHARP"] },
    ]
}

/// Algorithm 3, lines 7 and 8, with any objective: `M ← M − ε ∂L/∂M`.
fn descend(goal: &Goal<'_>, start: DMat3, step: f64, steps: usize) -> DMat3 {
    let mut m = start;
    for _ in 0..steps {
        let next = m - goal.value_and_gradient(m).1 * step;
        if !next.is_finite() {
            break;
        }
        m = next;
    }
    m
}

/// Draws the starts and where each descent ends, and prints the table.
pub fn figure(path: &Path) -> Result<(), Box<dyn Error>> {
    let titles = ["GGX", "START", DESCENTS[0].1, DESCENTS[1].1, DESCENTS[2].1, "TV, MEDIANS"];
    let trials = trials();
    let mut sheet = Sheet::new(&titles, 5, trials.len());
    println!("\nFigure 4 of the 2022 paper: TV after\n");
    println!(
        "| | start | L3 descent | W descent | TV descent | TV by BFGS from the medians |\n|---|---|---|---|---|---|"
    );
    for (row, trial) in trials.iter().enumerate() {
        let case = &trial.case;
        let lobe = case.lobe(2048, [0.5, 0.5])?;
        let ggx = case.density(lobe.magnitude)?;
        let chart = case.chart(trial.start);
        let peak = chart.directions().map(&ggx).fold(0.0, f64::max);
        let mut ends = vec![trial.start];
        for (objective, _, step, steps) in DESCENTS {
            ends.push(descend(&objective.towards(&lobe), trial.start, step, steps));
        }
        ends.push(fit_entry(&lobe, case.wo(), Pattern::General, 300).m);
        let lines: Vec<String> =
            trial.lines.iter().map(|line| (*line).to_owned()).chain(case.lines()).collect();
        sheet.label(row, &lines);
        sheet.density((row, 0), &chart, peak, &ggx, "");
        let mut cells = Vec::new();
        for (column, m) in ends.into_iter().enumerate() {
            let tv = total_variation(&lobe, m);
            cells.push(format!("{tv:.3}"));
            // A descent may end turned over; the lobe is that of the other handedness.
            let m = ltc_fit::gauge::right_handed(m);
            match density(m) {
                Ok(ltc) => sheet.density((row, 1 + column), &chart, peak, ltc, &format!("TV {tv:.3}")),
                Err(_) => sheet.density((row, 1 + column), &chart, peak, |_| 0.0, "SINGULAR"),
            }
        }
        println!("| {} {}: {} | {} |", trial.lines[0], trial.lines[1], case.name(), cells.join(" | "));
    }
    sheet.keys(false);
    sheet.canvas.save(path)
}
