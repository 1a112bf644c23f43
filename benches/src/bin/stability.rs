//! Writes the page and the plot of rounding errors: `cargo run --release -p ltc-benches --bin stability -- docs`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use ltc_benches::stability::{Form, Page, chart, nanoseconds};

/// Random cases of each shape at each value.
const COUNT: usize = 1500;

const COMMAND: &str = "cargo run --release -p ltc-benches --bin stability -- docs";

fn main() -> ExitCode {
    match std::env::args_os().nth(1).map(PathBuf::from) {
        Some(folder) => match write(&folder) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::FAILURE
            }
        },
        None => {
            eprintln!("error: give the folder to write to, as in {COMMAND}");
            ExitCode::FAILURE
        }
    }
}

fn write(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let mut times = Vec::new();
    for form in Form::ALL {
        times.push([nanoseconds::<f32>(form)?, nanoseconds::<f64>(form)?]);
    }
    let page = Page::measure(COUNT, times);
    std::fs::create_dir_all(folder.join("images"))?;
    std::fs::write(folder.join("images/stability.svg"), chart(&page))?;
    std::fs::write(folder.join("stability.md"), page.markdown(COMMAND, &machine()))?;
    for fault in page.faults() {
        println!("{fault}");
    }
    Ok(())
}

/// The processor's name where the system tells it.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| format!("one core of {name}"))
}
