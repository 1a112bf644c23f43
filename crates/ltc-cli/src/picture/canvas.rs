//! A picture to draw on.

use core::convert::Infallible;

use anyhow::Result;
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, iso_8859_7};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::{Dimensions, DrawTarget, Drawable, Pixel, Point, RgbColor, Size};
use embedded_graphics::primitives::Rectangle;
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};

/// An RGB colour.
pub type Colour = [u8; 3];

/// Ink for text and ticks.
pub const INK: Colour = [32, 32, 32];
/// Paper.
pub const PAPER: Colour = [255, 255, 255];

/// Where a text stands against its point.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// It begins there.
    Left,
    /// It is centred there.
    Centre,
    /// It ends there.
    Right,
}

/// A picture of 8-bit RGB pixels, row by row from the top.
pub struct Canvas {
    width: u32,
    height: u32,
    pixels: Vec<Colour>,
}

impl Canvas {
    /// A sheet of paper.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![PAPER; width as usize * height as usize] }
    }

    /// Fills a rectangle; what lies outside the picture is left out.
    pub fn fill(&mut self, [x, y]: [i32; 2], [width, height]: [i32; 2], colour: Colour) {
        for row in y.max(0)..(y + height).min(self.height as i32) {
            for column in x.max(0)..(x + width).min(self.width as i32) {
                self.pixels[row as usize * self.width as usize + column as usize] = colour;
            }
        }
    }

    /// A line of text, its height centred at `y`. Latin and Greek letters.
    pub fn text(&mut self, [x, y]: [i32; 2], anchor: Anchor, text: &str) {
        self.write([x, y], anchor, text, &iso_8859_7::FONT_8X13);
    }

    /// The same, larger.
    pub fn heading(&mut self, [x, y]: [i32; 2], anchor: Anchor, text: &str) {
        self.write([x, y], anchor, text, &iso_8859_7::FONT_9X18_BOLD);
    }

    fn write(&mut self, [x, y]: [i32; 2], anchor: Anchor, text: &str, font: &MonoFont<'_>) {
        let alignment = match anchor {
            Anchor::Left => Alignment::Left,
            Anchor::Centre => Alignment::Center,
            Anchor::Right => Alignment::Right,
        };
        let ink = MonoTextStyle::new(font, Rgb888::new(INK[0], INK[1], INK[2]));
        let style = TextStyleBuilder::new().alignment(alignment).baseline(Baseline::Middle).build();
        let Ok(_) = Text::with_text_style(text, Point::new(x, y), ink, style).draw(self);
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(bytes)
    }

    /// The colour of a pixel.
    #[cfg(test)]
    pub fn at(&self, x: u32, y: u32) -> Colour {
        self.pixels[(y * self.width + x) as usize]
    }
}

impl Dimensions for Canvas {
    fn bounding_box(&self) -> Rectangle {
        Rectangle::new(Point::zero(), Size::new(self.width, self.height))
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, colour) in pixels {
            self.fill([x, y], [1, 1], [colour.r(), colour.g(), colour.b()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut canvas = Canvas::new(4, 3);
        canvas.fill([-2, 1], [4, 9], [1, 2, 3]);
        assert_eq!((canvas.at(1, 2), canvas.at(2, 2), canvas.at(1, 0)), ([1, 2, 3], PAPER, PAPER));
        canvas.text([0, 0], Anchor::Right, "far outside");
        canvas.text([3000, -50], Anchor::Left, "farther");
    }

    #[test]
    fn greek_letters_have_glyphs_of_their_own() {
        let picture = |text| {
            let mut canvas = Canvas::new(20, 20);
            canvas.text([10, 10], Anchor::Centre, text);
            canvas.pixels
        };
        for (letter, other) in [("θ", "φ"), ("α", "λ"), ("°", "?"), ("θ", "?")] {
            assert_ne!(picture(letter), picture(other), "{letter}");
            assert!(picture(letter).contains(&INK), "{letter}");
        }
    }

    #[test]
    fn the_file_holds_the_pixels() {
        let mut canvas = Canvas::new(5, 2);
        canvas.fill([3, 1], [1, 1], [9, 8, 7]);
        let bytes = canvas.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (5, 2));
        assert_eq!(pixels, canvas.pixels.as_flattened());
    }
}
