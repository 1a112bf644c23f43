//! A picture to draw on.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use crate::colour::{Rgb, WHITE};
use crate::text;

pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Canvas {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: WHITE.repeat(width * height) }
    }

    /// Colours a pixel; one outside is left out.
    pub fn set(&mut self, x: usize, y: usize, colour: Rgb) {
        if x < self.width && y < self.height {
            let i = 3 * (y * self.width + x);
            self.pixels[i..i + 3].copy_from_slice(&colour);
        }
    }

    pub fn fill(&mut self, x: usize, y: usize, width: usize, height: usize, colour: Rgb) {
        for row in y..y + height {
            for column in x..x + width {
                self.set(column, row, colour);
            }
        }
    }

    /// Writes `text` with its left upper corner at (x, y), each dot `size` pixels wide.
    pub fn write(&mut self, text: &str, x: usize, y: usize, size: usize, colour: Rgb) {
        for (i, letter) in text.chars().enumerate() {
            for (row, bits) in text::rows(letter).into_iter().enumerate() {
                for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                    let left = x + (i * text::ADVANCE + column) * size;
                    self.fill(left, y + row * size, size, size, colour);
                }
            }
        }
    }

    /// The same, centred at x.
    pub fn write_centred(&mut self, text: &str, x: usize, y: usize, size: usize, colour: Rgb) {
        let width = (text.chars().count() * text::ADVANCE).saturating_sub(1) * size;
        self.write(text, x.saturating_sub(width / 2), y, size, colour);
    }

    /// Writes it as a PNG file.
    pub fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, u32::try_from(self.width)?, u32::try_from(self.height)?);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        println!("wrote {}", path.display());
        Ok(())
    }
}
