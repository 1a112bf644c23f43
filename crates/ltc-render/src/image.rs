//! Pictures, and their files.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{Vec2, WritableImage};
use ltc_table::files::write_atomically;

use crate::{RenderError, ToneMap};

/// A picture in linear radiance (RGB), row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB, tone-mapped.
    Png,
    /// OpenEXR, 32-bit linear radiance as it is.
    Exr,
}

impl Format {
    /// By the extension of the file name.
    ///
    /// # Errors
    /// [`RenderError::UnknownFormat`] for any but `.png` and `.exr`. Ask before rendering.
    pub fn of(path: &Path) -> Result<Self, RenderError> {
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        match extension.as_ref().and_then(|e| e.to_str()) {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(RenderError::UnknownFormat { path: path.display().to_string() }),
        }
    }
}

impl Image {
    /// Missing pixels are black, surplus ones are dropped.
    pub(crate) fn new(width: u32, height: u32, mut pixels: Vec<[f32; 3]>) -> Self {
        pixels.resize(width as usize * height as usize, [0.0; 3]);
        Self { width, height, pixels }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// 8-bit sRGB.
    pub fn tone_mapped(&self, tone: ToneMap) -> Vec<[u8; 3]> {
        self.pixels.iter().map(|p| p.map(|channel| tone.encode(channel))).collect()
    }

    /// Writes a PNG (through `tone`) or an EXR (as it is), by the extension; the file appears complete or not at all.
    ///
    /// # Errors
    /// [`RenderError::UnknownFormat`], [`RenderError::Encode`], [`RenderError::Write`].
    pub fn write(&self, path: &Path, tone: ToneMap) -> Result<(), RenderError> {
        let bytes = match Format::of(path)? {
            Format::Png => png(self.width, self.height, &self.tone_mapped(tone))?,
            Format::Exr => self.exr()?,
        };
        write_atomically(path, &bytes).map_err(RenderError::Write)
    }

    fn exr(&self) -> Result<Vec<u8>, RenderError> {
        let width = self.width as usize;
        let pixel = |at: Vec2<usize>| {
            let [r, g, b] = self.pixels[at.1 * width + at.0];
            (r, g, b)
        };
        let channels = exr::prelude::SpecificChannels::rgb(pixel);
        let image = exr::prelude::Image::from_channels((width, self.height as usize), channels);
        let mut bytes = Vec::new();
        image
            .write()
            .to_buffered(Cursor::new(&mut bytes))
            .map_err(|e| RenderError::Encode { format: "EXR", reason: e.to_string() })?;
        Ok(bytes)
    }
}

/// A PNG of 8-bit sRGB pixels.
pub(crate) fn png(width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<Vec<u8>, RenderError> {
    let encode = || {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(pixels.as_flattened())?;
        writer.finish()?;
        Ok(bytes)
    };
    encode().map_err(|e: png::EncodingError| RenderError::Encode { format: "PNG", reason: e.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient() -> Image {
        Image::new(3, 2, (0..6).map(|i| [i as f32 * 0.1, 0.5, 3.0]).collect())
    }

    #[test]
    fn the_extension_decides() {
        assert_eq!(Format::of("a/b.PNG".as_ref()).unwrap(), Format::Png);
        assert_eq!(Format::of("b.exr".as_ref()).unwrap(), Format::Exr);
        for bad in ["b.jpg", "png", ""] {
            assert!(matches!(Format::of(bad.as_ref()), Err(RenderError::UnknownFormat { .. })), "{bad}");
        }
    }

    #[test]
    fn an_exr_holds_the_radiance_itself() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        gradient().write(&path, ToneMap { exposure: 3.0 }).unwrap();
        let read = exr::prelude::read_first_rgba_layer_from_file(
            &path,
            |size, _| vec![vec![[0.0_f32; 3]; size.0]; size.1],
            |rows, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.1][at.0] = [r, g, b],
        )
        .unwrap();
        assert_eq!(read.layer_data.channel_data.pixels.concat(), gradient().pixels);
    }

    #[test]
    fn a_png_holds_the_tone_mapped_picture() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let tone = ToneMap { exposure: -1.0 };
        gradient().write(&path, tone).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        assert_eq!(bytes, gradient().tone_mapped(tone).as_flattened());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
    }

    #[test]
    fn an_unwritable_place_is_an_error() {
        let error = gradient().write("no/such/folder/a.png".as_ref(), ToneMap::default()).unwrap_err();
        assert!(error.to_string().contains("no/such/folder/a.png"), "{error}");
    }
}
