//! A picture beside its ground truth.

use std::path::Path;

use glam::Vec3;
use ltc_table::files::write_atomically;
use serde::Serialize;

use crate::image::png;
use crate::{
    Backend, Format, Image, RenderError, RenderOptions, RenderTables, Rendered, Scene, ToneMap, render,
};

/// What the difference is multiplied with before it is shown.
pub const AMPLIFICATION: f32 = 10.0;

/// Differences of linear radiance over the channels of all pixels that show a surface. The others, which show a light or
/// the background, are the same by construction and would only dilute the figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorFigures {
    /// Pixels that were compared.
    pub pixels: usize,
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean magnitude.
    pub mean_abs: f64,
    /// Largest magnitude.
    pub max_abs: f64,
    /// `rmse` over the root mean square of the reference; `None` where that is 0.
    pub relative_rmse: Option<f64>,
}

/// A picture, its ground truth, and how they differ.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// By the back end in question.
    pub test: Rendered,
    /// By the reference.
    pub reference: Rendered,
    /// Their difference.
    pub errors: ErrorFigures,
    /// What differences are multiplied with in the picture.
    pub amplification: f32,
}

/// Renders the scene by `backend` and by [`Backend::Reference`]. Progress is that of the reference, which takes nearly all
/// of the time.
///
/// # Errors
/// As [`render`].
pub fn compare(
    scene: &Scene,
    tables: &RenderTables<'_>,
    backend: Backend,
    options: &RenderOptions<'_>,
) -> Result<Comparison, RenderError> {
    let silent = RenderOptions { progress: None, ..*options };
    let test = render(scene, tables, backend, &silent)?;
    let reference = render(scene, tables, Backend::Reference, options)?;
    Ok(Comparison::of(test, reference))
}

impl ErrorFigures {
    /// Over the pixels where `mask` is true.
    pub fn of(test: &Image, reference: &Image, mask: &[bool]) -> Self {
        let mut figures = Self::default();
        let (mut squares, mut truth) = (0.0, 0.0);
        for ((a, b), compared) in test.pixels().iter().zip(reference.pixels()).zip(mask) {
            if !compared {
                continue;
            }
            figures.pixels += 1;
            for (a, b) in a.iter().zip(b) {
                let difference = (f64::from(*a) - f64::from(*b)).abs();
                squares += difference * difference;
                truth += f64::from(*b) * f64::from(*b);
                figures.mean_abs += difference;
                figures.max_abs = figures.max_abs.max(difference);
            }
        }
        let channels = (3 * figures.pixels).max(1) as f64;
        figures.mean_abs /= channels;
        figures.rmse = (squares / channels).sqrt();
        figures.relative_rmse = (truth > 0.0).then(|| (squares / truth).sqrt());
        figures
    }
}

impl Comparison {
    /// Of two pictures of one scene.
    pub fn of(test: Rendered, reference: Rendered) -> Self {
        let errors = ErrorFigures::of(&test.image, &reference.image, &reference.on_surface);
        Self { test, reference, errors, amplification: AMPLIFICATION }
    }

    /// Writes both pictures and their difference side by side: picture · reference · difference.
    ///
    /// In a PNG the difference is in false colour: black where both agree, towards yellow where the picture is brighter
    /// than its reference, towards cyan where it is darker; full colour at a difference of luminance of
    /// 1 / `amplification` (after exposure). In an EXR it is the magnitude of the difference times `amplification`.
    ///
    /// # Errors
    /// As [`Image::write`].
    pub fn write(&self, path: &Path, tone: ToneMap) -> Result<(), RenderError> {
        let (width, height) = (self.test.image.width(), self.test.image.height());
        match Format::of(path)? {
            Format::Exr => {
                let (test, reference) = (self.test.image.pixels(), self.reference.image.pixels());
                let panels = beside(width, [test, reference, &self.difference()]);
                Image::new(3 * width, height, panels).write(path, tone)
            }
            Format::Png => {
                let (test, reference) =
                    (self.test.image.tone_mapped(tone), self.reference.image.tone_mapped(tone));
                let panels = beside(width, [&test, &reference, &self.false_color(tone)]);
                write_atomically(path, &png(3 * width, height, &panels)?).map_err(RenderError::Write)
            }
        }
    }

    fn pairs(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        let pairs = self.test.image.pixels().iter().zip(self.reference.image.pixels());
        pairs.map(|(a, b)| (Vec3::from_array(*a), Vec3::from_array(*b)))
    }

    fn difference(&self) -> Vec<[f32; 3]> {
        self.pairs().map(|(a, b)| ((a - b).abs() * self.amplification).to_array()).collect()
    }

    fn false_color(&self, tone: ToneMap) -> Vec<[u8; 3]> {
        // Rec. 709.
        let luminance = Vec3::new(0.2126, 0.7152, 0.0722);
        let scale = self.amplification * tone.scale() as f32;
        self.pairs().map(|(a, b)| diverging((a - b).dot(luminance) * scale)).collect()
    }
}

/// −1: cyan, 0: black, 1: yellow; the hue sets in before the second channel does, so that the sign is seen at once.
fn diverging(value: f32) -> [u8; 3] {
    let strength = value.abs().min(1.0);
    let code = |x: f32| (x * 255.0).round() as u8;
    let (first, second) = (code(strength.sqrt()), code(strength));
    if value > 0.0 { [first, second, 0] } else { [0, second, first] }
}

/// Rows of the panels after each other.
fn beside<T: Copy>(width: u32, panels: [&[T]; 3]) -> Vec<T> {
    let rows = panels.map(|panel| panel.chunks(width as usize));
    let [a, b, c] = rows;
    a.zip(b).zip(c).flat_map(|((a, b), c)| [a, b, c].concat()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_a_known_difference() {
        let reference = Image::new(2, 1, vec![[1.0; 3], [5.0; 3]]);
        let test = Image::new(2, 1, vec![[1.0, 1.5, 1.0], [9.0; 3]]);
        let first = ErrorFigures::of(&test, &reference, &[true, false]);
        assert_eq!((first.pixels, first.max_abs), (1, 0.5));
        assert!((first.rmse - (0.25_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((first.mean_abs - 0.5 / 3.0).abs() < 1e-12);
        assert!((first.relative_rmse.unwrap() - (0.25_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(ErrorFigures::of(&test, &reference, &[false; 2]), ErrorFigures::default());
    }

    #[test]
    fn panels_stand_beside_each_other() {
        assert_eq!(
            beside(2, [&[1, 2, 3, 4], &[5, 6, 7, 8], &[9, 10, 11, 12]]),
            [1, 2, 5, 6, 9, 10, 3, 4, 7, 8, 11, 12]
        );
    }

    #[test]
    fn the_sign_of_a_difference_has_a_color() {
        assert_eq!(diverging(0.0), [0, 0, 0]);
        assert_eq!(diverging(2.0), [255, 255, 0]);
        assert_eq!(diverging(-2.0), [0, 255, 255]);
        assert!(diverging(0.04)[0] > 40);
    }
}
