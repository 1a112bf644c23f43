//! One polygon under one lobe, in the numbers that every back end can read.

use glam::{DMat3, DVec3, Mat3, Vec3};
use ltc_core::{InputError, Light as _, Ltc, Matrix, Polygon, Sides};

/// A light seen from the shading point, and the lobe it lights. Rounded to `f32` once, here: back ends differ by their
/// arithmetic alone, not by their inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// `M` (`target_from_cosine`), row-major.
    pub m: [f32; 9],
    /// In the shading frame, counter-clockwise seen from the emitting side.
    pub vertices: Vec<[f32; 3]>,
    /// Which sides emit.
    pub sides: Sides,
}

impl Job {
    /// Rounds a lobe and a light.
    pub fn new(m: DMat3, vertices: &[DVec3], sides: Sides) -> Self {
        Self {
            m: m.to_row_array().map(|x| x as f32),
            vertices: vertices.iter().map(|v| v.as_vec3().to_array()).collect(),
            sides,
        }
    }

    /// The same light under another lobe.
    pub fn under(&self, m: DMat3) -> Self {
        Self { m: m.to_row_array().map(|x| x as f32), ..self.clone() }
    }

    /// The same lobe under another light.
    pub fn lit_by(&self, vertices: &[DVec3]) -> Self {
        Self { vertices: vertices.iter().map(|v| v.as_vec3().to_array()).collect(), ..self.clone() }
    }

    /// `M` in double precision.
    pub fn m_f64(&self) -> DMat3 {
        DMat3::from_row_array(self.m.map(f64::from))
    }

    /// The vertices in double precision.
    pub fn vertices_f64(&self) -> Vec<DVec3> {
        self.vertices.iter().map(|v| Vec3::from_array(*v).as_dvec3()).collect()
    }

    /// What `ltc_core` makes of it in double precision.
    ///
    /// # Errors
    /// [`InputError`] for what `ltc_core` refuses.
    pub fn in_f64(&self) -> Result<f64, InputError> {
        let ltc = Ltc::<f64>::new(self.m_f64())?;
        Ok(Polygon::<f64>::new(&self.vertices_f64(), self.sides)?.integrate(&ltc))
    }

    /// What `ltc_core` makes of it in single precision.
    ///
    /// # Errors
    /// [`InputError`] for what `ltc_core` refuses.
    pub fn in_f32(&self) -> Result<f64, InputError> {
        let ltc = Ltc::<f32>::new(Mat3::from_row_array(self.m))?;
        let vertices: Vec<Vec3> = self.vertices.iter().map(|v| Vec3::from_array(*v)).collect();
        Ok(f64::from(Polygon::<f32>::new(&vertices, self.sides)?.integrate(&ltc)))
    }
}
