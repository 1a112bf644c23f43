//! Whole pictures: by LTCs, by sampling, and what separates them from the truth.

use ltc_render::{
    Backend, ErrorFigures, Image, RenderOptions, RenderTables, Rendered, Scene, ToneMap, render,
};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

use super::{Interval, Plan, Record, StudyError};

/// The scenes: their names and files.
const SCENES: [(&str, &str); 5] = [
    ("sphere-grid", include_str!("../../scenes/sphere-grid.json")),
    ("grazing-floor", include_str!("../../scenes/grazing-floor.json")),
    ("many-lights", include_str!("../../scenes/many-lights.json")),
    ("thin-lights", include_str!("../../scenes/thin-lights.json")),
    ("textured-light", include_str!("../../scenes/textured-light.json")),
];

/// The sampling of the reference takes so many samples at a time: one for each of its techniques.
const TECHNIQUES: u32 = 3;

/// How long and how finely to measure.
struct Effort {
    /// Pixels in a row and in a column are multiplied by this.
    scale: u32,
    /// Samples of the truth, for each technique, summed over the lights of the scene.
    truth: u32,
    /// Samples of the curve of sampling, for each technique; those that come near the truth's are left out.
    curve: &'static [u32],
    /// How often each picture is timed at most, and for how many seconds; twice at least.
    rounds: usize,
    seconds: f64,
}

impl Effort {
    fn of(plan: &Plan) -> Self {
        if plan.quick {
            Self { scale: 1, truth: 1024, curve: &[1, 4, 16, 64], rounds: 9, seconds: 0.4 }
        } else {
            Self {
                scale: 2,
                truth: 16_384,
                curve: &[1, 2, 4, 8, 16, 32, 64, 128, 256, 341],
                rounds: 25,
                seconds: 5.0,
            }
        }
    }
}

/// All pictures of all scenes. Says the device of the GPU, if there is one, or why there is none.
///
/// # Errors
/// Those of rendering on the CPU.
pub fn measure(
    tables: &RenderTables<'_>,
    plan: &Plan,
    mut step: impl FnMut(&str),
) -> Result<(Vec<Record>, Result<String, String>), StudyError> {
    let effort = Effort::of(plan);
    let mut records = Vec::new();
    let mut device = Err("no scene".to_owned());
    for (name, text) in SCENES {
        step(name);
        let mut scene: Scene = serde_json::from_str(text)?;
        scene.camera.width *= effort.scale;
        scene.camera.height *= effort.scale;
        let studio = Studio { name, scene, tables, effort: &effort };
        device = studio.measure(&mut records)?;
    }
    Ok((records, device))
}

struct Studio<'a> {
    name: &'a str,
    scene: Scene,
    tables: &'a RenderTables<'a>,
    effort: &'a Effort,
}

impl Studio<'_> {
    fn render(&self, backend: Backend, samples: u32, seed: u64) -> Result<Rendered, StudyError> {
        let options =
            RenderOptions { samples_per_pixel: 1, reference_samples: samples, seed, progress: None };
        Ok(render(&self.scene, self.tables, backend, &options)?)
    }

    fn measure(&self, records: &mut Vec<Record>) -> Result<Result<String, String>, StudyError> {
        // The truth has a seed of its own: sampling must not be judged by its own samples.
        let samples = self.effort.truth / u32::try_from(self.scene.lights.len()).unwrap_or(u32::MAX).max(1);
        let truth = self.render(Backend::Reference, samples.max(1), 2)?;
        records.push(self.record("ltc_cpu", &truth, || self.render(Backend::Cpu, 1, 1))?);
        let gpu = self.render(Backend::Gpu, 1, 1);
        let device = match gpu {
            Ok(picture) => {
                records.push(self.record("ltc_gpu", &truth, || self.render(Backend::Gpu, 1, 1))?);
                Ok(picture.device)
            }
            Err(reason) => Err(reason.to_string()),
        };
        for samples in self.effort.curve.iter().filter(|n| 8 * **n <= samples) {
            let way = format!("sampling_{:04}", samples * TECHNIQUES);
            records.push(self.record(&way, &truth, || self.render(Backend::Reference, *samples, 1))?);
        }
        Ok(device)
    }

    fn record(
        &self,
        way: &str,
        truth: &Rendered,
        mut picture: impl FnMut() -> Result<Rendered, StudyError>,
    ) -> Result<Record, StudyError> {
        let id = format!("image/{}/{way}", self.name);
        let mut times = Vec::new();
        // The first one warms up; it is counted where one alone takes long.
        let mut last = picture()?;
        let mut spent = last.shading_seconds;
        if spent > self.effort.seconds {
            times.push(spent * 1e9);
        }
        while times.len() < 2 || (times.len() < self.effort.rounds && spent < self.effort.seconds) {
            last = picture()?;
            spent += last.shading_seconds;
            times.push(last.shading_seconds * 1e9);
        }
        let time = Interval::of(times).ok_or_else(|| StudyError::Untimed(id.clone()))?;
        let errors = ErrorFigures::of(&last.image, &truth.image, &truth.on_surface);
        Ok(Record::new(id, "frame")
            .timed(time)
            .error("rmse", errors.rmse)
            .error("relative_rmse", errors.relative_rmse.unwrap_or(0.0))
            .error("flip", perceived(&truth.image, &last.image)))
    }
}

/// Mean ꟻLIP (Andersson et al. 2020) of the tone-mapped pictures, 0 to 1, on a screen of 67 pixels a degree.
fn perceived(reference: &Image, test: &Image) -> f64 {
    let picture = |image: &Image| {
        let bytes = image.tone_mapped(ToneMap::default()).concat();
        FlipImageRgb8::with_data(image.width(), image.height(), &bytes)
    };
    let map = flip(picture(reference), picture(test), DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&map).mean())
}
