//! The ways to integrate a polygon that the workspace has.

use std::sync::LazyLock;

use ltc_shade_gpu::{GpuError, GpuOptions, PolygonJob, Polygons};

use crate::Job;

/// One way to integrate polygons under lobes.
pub trait BackEnd {
    /// Its name in messages.
    fn name(&self) -> &'static str;

    /// The fraction of each job's lobe that sees its light.
    ///
    /// # Errors
    /// The words of the first refusal; nothing is computed then.
    fn fractions(&self, jobs: &[Job]) -> Result<Vec<f64>, String>;

    /// One job's fraction.
    ///
    /// # Errors
    /// As [`BackEnd::fractions`].
    fn fraction(&self, job: &Job) -> Result<f64, String> {
        Ok(self.fractions(std::slice::from_ref(job))?[0])
    }
}

/// `ltc_core` in double precision: the truth of the closed form.
#[derive(Clone, Copy, Debug)]
pub struct CpuF64;

/// `ltc_core` in single precision.
#[derive(Clone, Copy, Debug)]
pub struct CpuF32;

/// `ltc_shade_gpu` on the best device there is.
#[derive(Debug)]
pub struct Gpu {
    device: &'static Device,
    path: Path,
}

/// One device for all tests of a process: compiling its pipeline takes longer than most of them.
#[derive(Debug)]
struct Device {
    gpu: ltc_shade_gpu::Gpu,
    polygons: Polygons,
}

static DEVICE: LazyLock<Option<Device>> = LazyLock::new(Device::open);

/// Which of the shader's two paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// The one for any number of vertices.
    Polygons,
    /// The one for quads, which shading uses; jobs that are no quads take the other.
    Quads,
}

impl BackEnd for CpuF64 {
    fn name(&self) -> &'static str {
        "CPU f64"
    }

    fn fractions(&self, jobs: &[Job]) -> Result<Vec<f64>, String> {
        jobs.iter().map(|job| job.in_f64().map_err(|e| e.to_string())).collect()
    }
}

impl BackEnd for CpuF32 {
    fn name(&self) -> &'static str {
        "CPU f32"
    }

    fn fractions(&self, jobs: &[Job]) -> Result<Vec<f64>, String> {
        jobs.iter().map(|job| job.in_f32().map_err(|e| e.to_string())).collect()
    }
}

impl Device {
    fn open() -> Option<Self> {
        let gpu = match ltc_shade_gpu::Gpu::new(GpuOptions::default()) {
            Ok(gpu) => gpu,
            Err(error @ GpuError::NoAdapter { .. }) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                println!("skipped, because no GPU adapter can run this: {error}");
                return None;
            }
            Err(error) => panic!("{error}"),
        };
        println!("on {}", gpu.info());
        match Polygons::new(&gpu) {
            Ok(polygons) => Some(Self { gpu, polygons }),
            Err(error) => panic!("{error}"),
        }
    }
}

impl Gpu {
    /// The device, or `None` where there is none and that was said.
    ///
    /// # Panics
    /// When there is no device and `CI` is set, where everything must run; and for any other fault of a device.
    pub fn open(path: Path) -> Option<Self> {
        DEVICE.as_ref().map(|device| Self { device, path })
    }

    /// The device.
    pub fn device(&self) -> &ltc_shade_gpu::Gpu {
        &self.device.gpu
    }

    fn run(&self, jobs: &[&Job], path: Path) -> Result<Vec<f64>, String> {
        let jobs: Vec<_> = jobs
            .iter()
            .map(|job| PolygonJob { m: job.m, vertices: &job.vertices, sides: job.sides })
            .collect();
        let results = match path {
            Path::Polygons => self.device.polygons.integrate(&self.device.gpu, &jobs),
            Path::Quads => self.device.polygons.integrate_quads(&self.device.gpu, &jobs),
        };
        Ok(results.map_err(|e| e.to_string())?.into_iter().map(f64::from).collect())
    }
}

impl BackEnd for Gpu {
    fn name(&self) -> &'static str {
        match self.path {
            Path::Polygons => "GPU, polygons",
            Path::Quads => "GPU, quads",
        }
    }

    fn fractions(&self, jobs: &[Job]) -> Result<Vec<f64>, String> {
        let (quads, others): (Vec<usize>, Vec<usize>) =
            (0..jobs.len()).partition(|i| self.path == Path::Quads && jobs[*i].vertices.len() == 4);
        let mut results = vec![f64::NAN; jobs.len()];
        for (indices, path) in [(quads, Path::Quads), (others, Path::Polygons)] {
            let chosen: Vec<&Job> = indices.iter().map(|i| &jobs[*i]).collect();
            for (i, value) in indices.into_iter().zip(self.run(&chosen, path)?) {
                results[i] = value;
            }
        }
        Ok(results)
    }
}
