//! Pictures of lobes: GGX, the best LTC by each objective, and their differences, at the configurations of the papers' figures.
//!
//! ```sh
//! cargo run --release -p ltc-fit --example lobes -- -o docs/images
//! ```
//! writes `lobes-*.png` there and prints the tables of `docs/fit-objectives.md`.

use std::error::Error;
use std::path::PathBuf;

mod canvas;
mod cases;
mod colour;
mod descent;
mod disk;
mod fits;
mod projections;
mod sheet;
mod text;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = match arguments.as_slice() {
        [flag, folder] if flag == "-o" || flag == "--output" => PathBuf::from(folder),
        _ => return Err("usage: lobes -o FOLDER".into()),
    };
    std::fs::create_dir_all(&folder)?;
    fits::figure("Figure 5 of the 2016 paper", &cases::FIGURE_5, &folder.join("lobes-figure-5.png"))?;
    fits::figure("Figure 13 of the 2022 paper", &cases::FIGURE_13, &folder.join("lobes-figure-13.png"))?;
    descent::figure(&folder.join("lobes-figure-4.png"))?;
    projections::figure(&folder.join("lobes-projections.png"))
}
