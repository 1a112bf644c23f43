//! Rows and columns of disks with captions.

use glam::DVec3;

use crate::canvas::Canvas;
use crate::colour::{INK, diverging, sequential};
use crate::disk::{Chart, SIZE};

const LEFT: usize = 144;
const TOP: usize = 30;
const GAP: usize = 8;
const CAPTION: usize = 20;
const KEY: usize = 46;

/// Columns from here on are set off from the others.
pub struct Sheet {
    pub canvas: Canvas,
    set_off: usize,
    rows: usize,
}

impl Sheet {
    /// An empty sheet with a title over each column; columns from `set_off` on stand apart.
    pub fn new(titles: &[&str], set_off: usize, rows: usize) -> Self {
        let width = LEFT + titles.len() * (SIZE + GAP) + 2 * GAP;
        let canvas = Canvas::new(width, TOP + rows * (SIZE + CAPTION) + KEY);
        let mut sheet = Self { canvas, set_off, rows };
        for (column, title) in titles.iter().enumerate() {
            let (x, _) = sheet.corner(0, column);
            sheet.canvas.write_centred(title, x + SIZE / 2, 8, 2, INK);
        }
        sheet
    }

    fn corner(&self, row: usize, column: usize) -> (usize, usize) {
        let apart = if column >= self.set_off { 2 * GAP } else { 0 };
        (LEFT + column * (SIZE + GAP) + apart, TOP + row * (SIZE + CAPTION))
    }

    /// What stands left of a row.
    pub fn label(&mut self, row: usize, lines: &[String]) {
        let (_, y) = self.corner(row, 0);
        let top = y + SIZE / 2 - 10 * lines.len();
        for (i, line) in lines.iter().enumerate() {
            self.canvas.write(line, 6, top + 20 * i, 2, INK);
        }
    }

    /// A density, in units of `peak`, and what is said of it.
    pub fn density(
        &mut self,
        (row, column): (usize, usize),
        chart: &Chart,
        peak: f64,
        density: impl Fn(DVec3) -> f64,
        caption: &str,
    ) {
        let corner = self.corner(row, column);
        chart.draw(&mut self.canvas, corner, |w| (density(w) / peak).sqrt(), sequential);
        self.canvas.write_centred(caption, corner.0 + SIZE / 2, corner.1 + SIZE + 4, 1, INK);
    }

    /// A difference of densities, in units of `peak`.
    pub fn difference(
        &mut self,
        (row, column): (usize, usize),
        chart: &Chart,
        peak: f64,
        difference: impl Fn(DVec3) -> f64,
    ) {
        let corner = self.corner(row, column);
        let value = |w| {
            let d = difference(w) / peak;
            d.signum() * d.abs().sqrt()
        };
        chart.draw(&mut self.canvas, corner, value, diverging);
    }

    /// The keys of both colour scales, at the bottom.
    pub fn keys(&mut self, differences: bool) {
        let y = TOP + self.rows * (SIZE + CAPTION) + 8;
        let ticks = [0.0, 0.01, 0.1, 0.25, 0.5, 1.0_f64];
        let (x, _) = self.corner(0, 0);
        self.bar(x, y, 280, sequential);
        for tick in ticks {
            self.canvas.write_centred(&tick.to_string(), x + (tick.sqrt() * 280.0) as usize, y + 17, 1, INK);
        }
        self.canvas.write("DENSITY / PEAK OF GGX", x + 300, y + 3, 1, INK);
        if differences {
            let (x, _) = self.corner(0, self.set_off);
            self.bar(x, y, 280, |t| diverging(2.0 * t - 1.0));
            for tick in [-1.0, -0.25, -0.05, 0.0, 0.05, 0.25, 1.0_f64] {
                let place =
                    140.0 * (1.0 + tick.signum() * tick.abs().sqrt() * if tick == 0.0 { 0.0 } else { 1.0 });
                self.canvas.write_centred(&tick.to_string(), x + place as usize, y + 17, 1, INK);
            }
            self.canvas.write("(LTC - GGX) / PEAK OF GGX", x + 300, y + 3, 1, INK);
        }
    }

    fn bar(&mut self, x: usize, y: usize, width: usize, colour: impl Fn(f64) -> crate::colour::Rgb) {
        for i in 0..width {
            self.canvas.fill(x + i, y, 1, 13, colour((i as f64 + 0.5) / width as f64));
        }
    }
}
