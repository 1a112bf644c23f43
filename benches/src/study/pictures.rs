//! Whole pictures: by LTCs, by sampling, and what separates them from the truth.

use std::ops::ControlFlow;

use ltc_render::{Backend, ErrorFigures, Image, RenderOptions, RenderTables, Renderer, Scene, ToneMap};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

use super::timer::{self, Task};
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
    /// How often each picture is timed at most, and for how many seconds; once at least.
    rounds: usize,
    seconds: f64,
}

impl Effort {
    fn of(plan: &Plan) -> Self {
        if plan.quick {
            Self { scale: 1, truth: 1024, curve: &[1, 4, 16, 64], rounds: 5, seconds: 0.03 }
        } else {
            Self {
                scale: 2,
                truth: 16_384,
                curve: &[1, 2, 4, 8, 16, 32, 64, 128, 256, 341],
                rounds: 9,
                seconds: 0.5,
            }
        }
    }
}

/// Errors of all pictures of all scenes.
///
/// # Errors
/// Those of rendering on the processor.
pub fn errors(
    tables: &RenderTables<'_>,
    plan: &Plan,
    mut step: impl FnMut(&str),
) -> Result<Vec<Record>, StudyError> {
    let (effort, renderers) = (Effort::of(plan), Renderers::new(tables)?);
    let mut records = Vec::new();
    for studio in studios(&renderers, &effort) {
        let studio = studio?;
        step(studio.name);
        records.extend(studio.errors()?);
    }
    Ok(records)
}

/// Times of the same.
///
/// # Errors
/// Those of rendering on the processor.
pub fn times(tables: &RenderTables<'_>, plan: &Plan) -> Result<Vec<Record>, StudyError> {
    let (effort, renderers) = (Effort::of(plan), Renderers::new(tables)?);
    let mut yardstick = Yardstick::new();
    let mut records = Vec::new();
    for studio in studios(&renderers, &effort) {
        records.extend(studio?.times(&mut yardstick)?);
    }
    // A step now and then is held up by other threads: the median of all is what frames are divided by.
    let step = Interval::of(yardstick.times);
    let beside = |(record, on_processor): (Record, bool)| {
        // What a device of its own takes has nothing to do with the processor's clock.
        let step = step.filter(|_| on_processor);
        let relative = record.time.zip(step).map(|(time, step)| time.over(step.median));
        record.relative(relative)
    };
    let mut records: Vec<Record> = records.into_iter().map(beside).collect();
    records.extend(step.map(|step| Record::new("yardstick/threads", "step").timed(step)));
    Ok(records)
}

/// What makes the pictures.
struct Renderers<'a> {
    cpu: Renderer<'a>,
    reference: Renderer<'a>,
    /// Where there is a device.
    gpu: Option<Renderer<'a>>,
}

impl<'a> Renderers<'a> {
    fn new(tables: &RenderTables<'a>) -> Result<Self, StudyError> {
        Ok(Self {
            cpu: Renderer::new(tables, Backend::Cpu)?,
            reference: Renderer::new(tables, Backend::Reference)?,
            gpu: Renderer::new(tables, Backend::Gpu).ok(),
        })
    }
}

/// A way to make a picture.
struct Way<'a> {
    name: String,
    renderer: &'a Renderer<'a>,
    samples: u32,
    /// Whether it is the graphics device's.
    on_device: bool,
}

struct Studio<'a> {
    name: &'a str,
    scene: Scene,
    renderers: &'a Renderers<'a>,
    effort: &'a Effort,
}

fn studios<'a>(
    renderers: &'a Renderers<'a>,
    effort: &'a Effort,
) -> impl Iterator<Item = Result<Studio<'a>, StudyError>> {
    SCENES.into_iter().map(move |(name, text)| {
        let mut scene: Scene = serde_json::from_str(text)?;
        scene.camera.width *= effort.scale;
        scene.camera.height *= effort.scale;
        Ok(Studio { name, scene, renderers, effort })
    })
}

fn options(samples: u32, seed: u64) -> RenderOptions<'static> {
    RenderOptions { samples_per_pixel: 1, reference_samples: samples, seed, progress: None }
}

impl<'a> Studio<'a> {
    /// Samples of the truth.
    fn truth(&self) -> u32 {
        (self.effort.truth / u32::try_from(self.scene.lights.len()).unwrap_or(u32::MAX).max(1)).max(1)
    }

    fn ways(&self) -> Vec<Way<'a>> {
        let Renderers { cpu, reference, gpu } = self.renderers;
        let way =
            |name: &str, renderer, on_device| Way { name: name.to_owned(), renderer, samples: 1, on_device };
        let mut ways = vec![way("ltc_cpu", cpu, false)];
        ways.extend(gpu.as_ref().map(|gpu| way("ltc_gpu", gpu, true)));
        ways.extend(self.effort.curve.iter().filter(|n| 8 * **n <= self.truth()).map(|samples| Way {
            samples: *samples,
            ..way(&format!("sampling_{:04}", samples * TECHNIQUES), reference, false)
        }));
        ways
    }

    fn id(&self, way: &Way<'_>) -> String {
        format!("image/{}/{}", self.name, way.name)
    }

    fn errors(&self) -> Result<Vec<Record>, StudyError> {
        // The truth has a seed of its own: sampling must not be judged by its own samples.
        let truth = self.renderers.reference.render(&self.scene, &options(self.truth(), 2))?;
        let one = |way: Way<'_>| {
            let found = way.renderer.render(&self.scene, &options(way.samples, 1))?;
            let errors = ErrorFigures::of(&found.image, &truth.image, &truth.on_surface);
            let record = Record::new(self.id(&way), "frame")
                .error("rmse", errors.rmse)
                .error("relative_rmse", errors.relative_rmse.unwrap_or(0.0))
                .error("flip", perceived(&truth.image, &found.image));
            Ok(record)
        };
        self.ways().into_iter().map(one).collect()
    }

    /// With each, whether it is as fast as the processor.
    fn times(&self, yardstick: &mut Yardstick) -> Result<Vec<(Record, bool)>, StudyError> {
        let mut records = Vec::new();
        for way in self.ways() {
            let (mut times, mut spent) = (Vec::new(), 0.0);
            let mut is_warm = false;
            way.renderer.frames(&self.scene, &options(way.samples, 1), |frame| {
                yardstick.measure();
                // The first frame warms up, and a device's programs are compiled for it; a long one of the processor counts.
                if is_warm || (!way.on_device && frame.shading_seconds > self.effort.seconds) {
                    spent += frame.shading_seconds;
                    times.push(frame.shading_seconds * 1e9);
                }
                is_warm = true;
                if times.is_empty() || (times.len() < self.effort.rounds && spent < self.effort.seconds) {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            })?;
            let id = self.id(&way);
            let time = Interval::of(times).ok_or_else(|| StudyError::Untimed(id.clone()))?;
            records.push((Record::new(id, "frame").timed(time), way.renderer.is_on_processor()));
        }
        Ok(records)
    }
}

/// How slow all threads are.
struct Yardstick {
    task: Task<'static>,
    times: Vec<f64>,
}

impl Yardstick {
    fn new() -> Self {
        let mut task = timer::yardstick_of_all_threads();
        // Warms up.
        task.nanoseconds(1);
        Self { task, times: Vec::new() }
    }

    fn measure(&mut self) {
        self.times.push(self.task.nanoseconds(1));
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
