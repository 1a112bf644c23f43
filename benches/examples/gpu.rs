//! What the graphics device at hand does: `cargo run --release -p ltc-benches --example gpu [--quick]` prints every figure and ratio.
//! `ltc bench` measures the same, and keeps it.

use ltc_benches::study::{Interval, Plan, Step, run, session};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    let (plan, tables) = (Plan { quick, device_only: true, ..Plan::default() }, ltc_tables::shipped()?);
    // All in one process: `ltc bench` has one for each session.
    let again = || session(&plan, &tables);
    let run = run(&plan, &tables, &again, &|step: Step<'_>| eprintln!("{}", step.stage))?;
    let device = run.machine.gpu.unwrap_or_default();
    println!("{device}; {}", run.machine.gpu_clock.unwrap_or_default());
    let within = |i: Interval, unit: f64| {
        format!("{:.4} ({:.4} to {:.4})", i.median * unit, i.low * unit, i.high * unit)
    };
    for record in run.records {
        if let Some(time) = record.time {
            let errors: Vec<_> = record.errors.iter().map(|(kind, x)| format!("{kind} {x:.1e}")).collect();
            println!("{}: {} ms a {}; {}", record.id, within(time, 1e-6), record.per, errors.join(", "));
        }
        if let Some(ratio) = record.ratio {
            let asked = record.asked.map(|x| format!(", asked {x}")).unwrap_or_default();
            println!("{}: {}{asked}", record.id, within(ratio, 1.0));
        }
    }
    Ok(())
}
