//! Pictures from files: PNG and EXR.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::Format;
use crate::texture::{MAX_SIDE, Texels};

/// The largest value of a texel.
const BRIGHTEST: f32 = 1e9;

/// Linear colours, the lowest row first; the reason in words where there are none.
pub(crate) fn read(path: &Path) -> Result<Texels, String> {
    let format = Format::of(path).map_err(|_| "unknown picture format, the name must end in .png or .exr")?;
    let (width, height, mut rows) = match format {
        Format::Png => png(path)?,
        Format::Exr => exr(path)?,
    };
    for (k, texel) in rows.iter().enumerate() {
        if let Some(value) = texel.iter().find(|x| !(0.0..=BRIGHTEST).contains(*x)) {
            let (x, y) = (k % width, k / width);
            return Err(format!("has {value} at column {x}, row {y}, must be in [0, {BRIGHTEST}]"));
        }
    }
    rows = rows.chunks_exact(width).rev().flatten().copied().collect();
    Ok((width, height, rows))
}

fn check_size(width: usize, height: usize) -> Result<(), String> {
    let range = 1..=MAX_SIDE;
    if range.contains(&width) && range.contains(&height) {
        return Ok(());
    }
    Err(format!("is {width} × {height} texels, neither side may be larger than {MAX_SIDE}"))
}

fn png(path: &Path) -> Result<Texels, String> {
    let words = |e: png::DecodingError| e.to_string();
    let file = File::open(path).map_err(|e| e.to_string())?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    // Palettes, fewer bits than eight, and transparent colours become plain channels.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(words)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(width, height)?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("is too large")?];
    let info = reader.next_frame(&mut bytes).map_err(words)?;
    let deep = info.bit_depth == png::BitDepth::Sixteen;
    let value = |k: usize| {
        if deep {
            f64::from(u16::from_be_bytes([bytes[2 * k], bytes[2 * k + 1]])) / 65_535.0
        } else {
            f64::from(bytes[k]) / 255.0
        }
    };
    let channels = info.color_type.samples();
    let (grey, alpha) = match info.color_type {
        png::ColorType::Grayscale => (true, false),
        png::ColorType::GrayscaleAlpha => (true, true),
        png::ColorType::Rgb => (false, false),
        png::ColorType::Rgba => (false, true),
        png::ColorType::Indexed => return Err("has a palette that could not be read".to_owned()),
    };
    let mut texels = Vec::with_capacity(width * height);
    for k in 0..width * height {
        let first = k * channels;
        if alpha && value(first + channels - 1) < 1.0 {
            let (x, y) = (k % width, k / width);
            return Err(format!("is transparent at column {x}, row {y}, which a light cannot be"));
        }
        let channel = |c: usize| linear(value(first + if grey { 0 } else { c })) as f32;
        texels.push([channel(0), channel(1), channel(2)]);
    }
    Ok((width, height, texels))
}

/// The inverse of the sRGB transfer function (IEC 61966-2-1).
fn linear(code: f64) -> f64 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

fn exr(path: &Path) -> Result<Texels, String> {
    // The size is asked first, so that no header of a huge picture makes room for it.
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
    let size = meta.headers.first().map(|header| header.layer_size).ok_or("has no layer")?;
    check_size(size.0, size.1)?;
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![vec![[0.0_f32; 3]; size.0]; size.1],
        |rows: &mut Vec<Vec<[f32; 3]>>, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.1][at.0] = [r, g, b],
    )
    .map_err(|e| e.to_string())?;
    let layer = image.layer_data;
    check_size(layer.size.0, layer.size.1)?;
    Ok((layer.size.0, layer.size.1, layer.channel_data.pixels.concat()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, ToneMap};

    fn write_png(path: &Path, size: [u32; 2], color: png::ColorType, depth: png::BitDepth, bytes: &[u8]) {
        let mut encoder = png::Encoder::new(File::create(path).unwrap(), size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
    }

    #[test]
    fn a_png_is_decoded_from_srgb_and_begins_at_the_bottom() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let bytes = [255, 0, 0, 188, 188, 188];
        write_png(&path, [1, 2], png::ColorType::Rgb, png::BitDepth::Eight, &bytes);
        let (width, height, texels) = read(&path).unwrap();
        assert_eq!((width, height), (1, 2));
        // 188 is the code of the linear 0.5 as nearly as 8 bits have it.
        assert!((texels[0][1] - 0.5).abs() < 0.005, "{texels:?}");
        assert_eq!(texels[1], [1.0, 0.0, 0.0]);

        write_png(&path, [2, 1], png::ColorType::Grayscale, png::BitDepth::Sixteen, &[0xFF, 0xFF, 0, 0]);
        assert_eq!(read(&path).unwrap().2, [[1.0; 3], [0.0; 3]]);
        write_png(&path, [2, 1], png::ColorType::Rgba, png::BitDepth::Eight, &[255; 8]);
        assert_eq!(read(&path).unwrap().2, [[1.0; 3]; 2]);
    }

    #[test]
    fn an_exr_is_taken_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let image = Image::new(2, 2, vec![[1.0; 3], [2.0; 3], [0.25, 3e5, 0.0], [4.0; 3]]);
        image.write(&path, ToneMap::default()).unwrap();
        let (.., texels) = read(&path).unwrap();
        assert_eq!(texels, [[0.25, 3e5, 0.0], [4.0; 3], [1.0; 3], [2.0; 3]]);
    }

    #[test]
    fn what_cannot_be_a_light_is_refused_in_words() {
        let folder = tempfile::tempdir().unwrap();
        let said = |name: &str| read(&folder.path().join(name)).unwrap_err();
        assert!(said("missing.png").contains("No such file"), "{}", said("missing.png"));
        assert!(said("a.jpg").contains("must end in .png or .exr"));
        std::fs::write(folder.path().join("text.png"), "text").unwrap();
        assert!(!said("text.png").is_empty());
        std::fs::write(folder.path().join("text.exr"), "text").unwrap();
        assert!(!said("text.exr").is_empty());
        for bad in [f32::NAN, f32::INFINITY, -0.5, 2e9] {
            let image = Image::new(2, 1, vec![[1.0; 3], [0.0, bad, 0.0]]);
            image.write(&folder.path().join("bad.exr"), ToneMap::default()).unwrap();
            let said = said("bad.exr");
            assert!(said.ends_with("at column 1, row 0, must be in [0, 1000000000]"), "{said}");
        }
        let large = Image::new(2049, 1, vec![]);
        large.write(&folder.path().join("large.exr"), ToneMap::default()).unwrap();
        assert_eq!(said("large.exr"), "is 2049 × 1 texels, neither side may be larger than 2048");
        large.write(&folder.path().join("large.png"), ToneMap::default()).unwrap();
        assert_eq!(said("large.png"), "is 2049 × 1 texels, neither side may be larger than 2048");
        let path = folder.path().join("glass.png");
        write_png(&path, [1, 1], png::ColorType::Rgba, png::BitDepth::Eight, &[255, 0, 0, 128]);
        assert_eq!(said("glass.png"), "is transparent at column 0, row 0, which a light cannot be");
    }
}
