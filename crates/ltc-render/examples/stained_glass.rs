//! Writes `examples/scenes/textures/stained-glass.png`: cells around jittered seeds, each of a colour of its own, in lead.
//!
//! `cargo run -p ltc-render --example stained_glass -- examples/scenes/textures/stained-glass.png`

use std::fs::File;
use std::io::BufWriter;

use ltc_reference::SplitMix64;

const SIZE: [usize; 2] = [160, 120];
/// Cells along either side.
const CELLS: [usize; 2] = [8, 6];
/// Half the width of the lead, in texels.
const LEAD: f64 = 1.3;

/// A seed's place, in texels, and its colour as sRGB codes.
struct Pane {
    at: [f64; 2],
    colour: [u8; 3],
}

fn panes() -> Vec<Pane> {
    let mut rng = SplitMix64::new(16);
    let palette =
        [[214, 38, 30], [245, 176, 26], [28, 92, 190], [24, 140, 84], [120, 40, 150], [240, 232, 200]];
    let pane = |k: usize| {
        let [u, v] = rng.next_2d();
        let at = [(k % CELLS[0], CELLS[0], SIZE[0], u), (k / CELLS[0], CELLS[1], SIZE[1], v)]
            .map(|(i, cells, size, jitter)| (i as f64 + 0.15 + 0.7 * jitter) * (size as f64 / cells as f64));
        let [pick, _] = rng.next_2d();
        Pane { at, colour: palette[(pick * palette.len() as f64) as usize % palette.len()] }
    };
    (0..CELLS[0] * CELLS[1]).map(pane).collect()
}

/// The colour of the nearest pane, or lead where two are equally near or the picture ends.
fn colour(panes: &[Pane], at: [f64; 2]) -> [u8; 3] {
    let square = |pane: &Pane| (pane.at[0] - at[0]).powi(2) + (pane.at[1] - at[1]).powi(2);
    let mut by_distance: Vec<&Pane> = panes.iter().collect();
    by_distance.sort_by(|a, b| square(a).total_cmp(&square(b)));
    let [first, second] = [by_distance[0], by_distance[1]];
    let apart = (first.at[0] - second.at[0]).hypot(first.at[1] - second.at[1]);
    let to_border = (square(second) - square(first)) / (2.0 * apart);
    let to_edge = (0..2).map(|axis| at[axis].min(SIZE[axis] as f64 - at[axis])).fold(f64::INFINITY, f64::min);
    if to_border.min(to_edge) < LEAD { [8, 8, 10] } else { first.colour }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name the file to write")?;
    let panes = panes();
    let mut bytes = Vec::with_capacity(3 * SIZE[0] * SIZE[1]);
    for k in 0..SIZE[0] * SIZE[1] {
        bytes.extend(colour(&panes, [(k % SIZE[0]) as f64 + 0.5, (k / SIZE[0]) as f64 + 0.5]));
    }
    let file = BufWriter::new(File::create(path)?);
    let mut encoder = png::Encoder::new(file, SIZE[0] as u32, SIZE[1] as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
