//! Programs, checked against the oracle as they are added, and what is read off their times.

use glam::DMat3;
use ltc_core::Horizon;
use ltc_shade_gpu::timing::{PixelGrid, PixelProgram, PixelSource, Resource, Stage};
use ltc_shade_gpu::{Gpu, LightKind, LightShape, Tables};

use super::super::StudyError;
use super::scene::{self, Materials, Pixel};

/// What the time of a record is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Of a whole frame.
    Frame(usize),
    /// Of a frame less that of another, which does the same but for what is measured.
    Net(usize, usize),
    /// Of a frame with many lights less that with few, for each light more.
    Slope {
        /// The program with few.
        few: usize,
        /// With many.
        many: usize,
        /// How many more that are.
        lights: f64,
    },
}

/// A named figure.
#[derive(Clone, Debug)]
pub struct Form {
    /// `stage/group/…`.
    pub name: String,
    /// What it takes the time of.
    pub measure: Measure,
    /// Largest error and its root mean square against the oracle, where it has one.
    pub errors: Option<[f64; 2]>,
}

/// What a program writes, for some of the pixels, by the oracle: `None` for a number that is not judged.
pub type Truth<'a> = &'a dyn Fn(&Pixel) -> Result<[Option<f64>; 4], StudyError>;

/// A picture's programs.
pub struct Bench<'a> {
    pub gpu: &'a Gpu,
    pub grid: PixelGrid,
    pub programs: Vec<PixelProgram>,
    pub forms: Vec<Form>,
    pixels: Vec<(Materials, Vec<Pixel>, Resource)>,
    /// Pixels that are judged; none where forms are timed alone.
    judged: Option<usize>,
}

/// What a program reads beside the scene.
#[derive(Clone, Copy, Default)]
pub struct Reads<'a> {
    pub tables: Option<Tables<'a>>,
    pub materials: Option<Materials>,
    pub points: &'a [[f32; 4]],
    pub further: &'a [Resource],
}

impl<'a> Bench<'a> {
    /// An empty one; `judged` pixels of each form are held against the oracle, if any.
    ///
    /// # Errors
    /// Those of the device.
    pub fn new(gpu: &'a Gpu, [width, height]: [u32; 2], judged: Option<usize>) -> Result<Self, StudyError> {
        let grid = PixelGrid::new(gpu, width, height)?;
        Ok(Self { gpu, grid, programs: Vec::new(), forms: Vec::new(), pixels: Vec::new(), judged })
    }

    fn pixels(&mut self, materials: Materials) -> Result<(Vec<Pixel>, Resource), StudyError> {
        if !self.pixels.iter().any(|(m, ..)| *m == materials) {
            let all = scene::pixels(self.grid.width(), self.grid.height(), materials);
            let buffer = Resource::storage(self.gpu, &scene::pixel_bytes(&all))?;
            self.pixels.push((materials, all, buffer));
        }
        let found = self.pixels.iter().find(|(m, ..)| *m == materials);
        // Pushed above, where it was not there.
        let (_, all, buffer) = found.ok_or_else(|| StudyError::Untimed("pixels".to_owned()))?;
        let judged = self.judged.map(|judged| all.iter().step_by(step(all.len(), judged)).copied().collect());
        Ok((judged.unwrap_or_default(), buffer.clone()))
    }

    /// Compiles a program under `gpu`, which is the bench's own device with tables in its way, once for each number of lights.
    /// The last is held against `truth`.
    ///
    /// # Errors
    /// Those of the device; [`StudyError::Wrong`] for one beyond `bound`.
    #[expect(clippy::too_many_arguments, reason = "each is a different thing, and all are needed")]
    pub fn add(
        &mut self,
        name: &str,
        gpu: &Gpu,
        stage: Stage,
        wgsl: &str,
        reads: Reads<'_>,
        counts: &[u32],
        truth: Option<(Truth<'_>, f64)>,
    ) -> Result<(Vec<usize>, Option<[f64; 2]>), StudyError> {
        let materials = reads.materials.unwrap_or(Materials::Anisotropic);
        let (judged, buffer) = self.pixels(materials)?;
        let points = if reads.points.is_empty() { &[[0.0; 4]][..] } else { reads.points };
        let points = Resource::storage(gpu, &scene::point_bytes(points))?;
        let resources = |count: u32| -> Result<Vec<Resource>, StudyError> {
            let bytes: Vec<u8> = [count, 0, 0, 0].into_iter().flat_map(u32::to_le_bytes).collect();
            let uniform = Resource::uniform(gpu, &bytes)?;
            let mut all = vec![uniform, buffer.clone(), points.clone()];
            all.extend(reads.further.iter().cloned());
            Ok(all)
        };
        let mut places: Vec<usize> = Vec::new();
        for count in counts {
            let program = match places.first() {
                None => {
                    let resources = resources(*count)?;
                    let source = PixelSource { wgsl, stage, tables: reads.tables, resources: &resources };
                    PixelProgram::new(gpu, &self.grid, &source)?
                }
                Some(first) => self.programs[*first].with(gpu, &resources(*count)?)?,
            };
            places.push(self.programs.len());
            self.programs.push(program);
        }
        let errors = match (truth, places.last(), self.judged) {
            (Some((truth, bound)), Some(last), Some(count)) => {
                let pixels = self.programs[*last].pixels(gpu, &self.grid)?;
                let step = step(pixels.len(), count);
                let found: Vec<[f32; 4]> = pixels.into_iter().step_by(step).collect();
                Some(judge(name, &judged, &found, truth, bound)?)
            }
            _ => None,
        };
        Ok((places, errors))
    }

    /// Adds a figure.
    pub fn form(&mut self, name: impl Into<String>, measure: Measure, errors: Option<[f64; 2]>) {
        self.forms.push(Form { name: name.into(), measure, errors });
    }

    /// The program whose whole frame a form is of.
    pub fn measure(&self, name: &str) -> Option<Measure> {
        self.forms.iter().find(|form| form.name == name).map(|form| form.measure)
    }
}

/// Every which pixel of `all` is judged, so that about `judged` are; odd, to meet all columns.
fn step(all: usize, judged: usize) -> usize {
    (all / judged.max(1)).max(1) | 1
}

/// Largest error and root mean square of what was found.
fn judge(
    name: &str,
    pixels: &[Pixel],
    found: &[[f32; 4]],
    truth: Truth<'_>,
    bound: f64,
) -> Result<[f64; 2], StudyError> {
    let (mut max, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
    for (pixel, found) in pixels.iter().zip(found) {
        for (expected, found) in truth(pixel)?.into_iter().zip(found) {
            let Some(expected) = expected else { continue };
            let error = (f64::from(*found) - expected).abs();
            max = if error.is_nan() { f64::INFINITY } else { max.max(error) };
            squares += error * error;
            count += 1.0;
        }
    }
    if max > bound || count == 0.0 {
        return Err(StudyError::Wrong { what: format!("gpu/{name}"), error: max, bound });
    }
    Ok([max, (squares / count).sqrt()])
}

/// What `pixel_lights.wgsl` writes, by the oracle: the sum is over `lights`, under a lobe that `lobe` finds for a pixel with its
/// reflectance.
pub fn lit(
    lights: &[LightShape],
    pixel: &Pixel,
    (m, reflectance): (DMat3, f64),
) -> Result<[Option<f64>; 4], StudyError> {
    let seen: Vec<f64> = lights
        .iter()
        .map(|light| scene::fraction(light, pixel, m, Horizon::BOTH))
        .collect::<Result<_, _>>()?;
    let at = |i: usize| seen.get(i).copied();
    let sum: f64 = seen.iter().sum();
    // Of many lights the errors add up: the sum is judged where there are few.
    let sum = (lights.len() <= 2).then_some(sum * reflectance);
    Ok([sum, at(0), at(1), seen.last().copied()])
}

/// Lights of a kind and their points.
pub fn placed(kind: LightKind, count: u32, sunk: bool) -> (Vec<LightShape>, Vec<[f32; 4]>) {
    let lights = scene::lights(kind, count, sunk);
    let points = scene::light_points(&lights);
    (lights, points)
}
