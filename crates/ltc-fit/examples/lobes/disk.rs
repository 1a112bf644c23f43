//! Functions of direction as disks: Lambert's azimuthal projection, in which equal areas are equal solid angles.

use glam::DVec3;

use crate::canvas::Canvas;
use crate::colour::{FAINT, Rgb, WHITE};

/// Pixels across a disk.
pub const SIZE: usize = 144;
/// Samples across a pixel.
const FINE: usize = 3;

/// What part of the sphere a disk shows.
#[derive(Clone, Copy)]
pub struct Chart {
    centre: DVec3,
    right: DVec3,
    up: DVec3,
    /// Sine of half the angle from the centre to the rim.
    rim: f64,
}

impl Chart {
    /// The upper hemisphere from above: x to the right, y up.
    pub fn hemisphere() -> Self {
        Self::around(DVec3::Z, 90.0)
    }

    /// The cap of that many degrees around a direction, turned to have the horizon level below it.
    pub fn around(centre: DVec3, degrees: f64) -> Self {
        let up = if centre.z > 0.999 { DVec3::Y } else { DVec3::Z - centre * centre.z };
        let up = up.try_normalize().unwrap_or(DVec3::Y);
        Self { centre, right: up.cross(centre), up, rim: (0.5 * degrees.to_radians()).sin() }
    }

    /// The direction at (u, v), both in [−1, 1]; none beyond the rim.
    fn direction(&self, u: f64, v: f64) -> Option<DVec3> {
        let r = u.hypot(v);
        if r > 1.0 {
            return None;
        }
        let half_sine = r * self.rim;
        let cos = 1.0 - 2.0 * half_sine * half_sine;
        let sine_over_r = 2.0 * self.rim * (1.0 - half_sine * half_sine).sqrt();
        Some(self.centre * cos + (self.right * u + self.up * v) * sine_over_r)
    }

    /// The direction at the middle of each pixel, those outside left out.
    pub fn directions(&self) -> impl Iterator<Item = DVec3> {
        let at = |i: usize| 2.0 * (i as f64 + 0.5) / SIZE as f64 - 1.0;
        let chart = *self;
        (0..SIZE * SIZE).filter_map(move |i| chart.direction(at(i % SIZE), at(i / SIZE)))
    }

    /// Draws `value`, coloured by `colour`, with the left upper corner of its square at (x, y). Below the horizon it is dimmed
    /// by a pattern of lines.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        (x, y): (usize, usize),
        value: impl Fn(DVec3) -> f64,
        colour: impl Fn(f64) -> Rgb,
    ) {
        let at = |i: usize| 2.0 * (i as f64 + 0.5) / (SIZE * FINE) as f64 - 1.0;
        for row in 0..SIZE {
            for column in 0..SIZE {
                let mut sum = [0.0; 3];
                for k in 0..FINE * FINE {
                    let (u, v) = (at(column * FINE + k % FINE), -at(row * FINE + k / FINE));
                    let sample = self.direction(u, v).map_or(WHITE, |w| {
                        let below = w.z < 0.0 && (row + column) % 4 == 0;
                        if below { FAINT } else { colour(value(w)) }
                    });
                    sum.iter_mut().zip(sample).for_each(|(s, c)| *s += f64::from(c));
                }
                let mean = sum.map(|s| (s / (FINE * FINE) as f64).round() as u8);
                canvas.set(x + column, y + row, mean);
            }
        }
    }
}
