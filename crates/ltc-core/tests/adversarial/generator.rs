//! Lobes and lights made of numbers that hurt.

use ltc_core::{AnyLight, Sides};

/// Turns a stream of random words, or the bytes of a fuzzer, into numbers and lights.
pub struct Generator<'a> {
    word: &'a mut dyn FnMut() -> u64,
    /// The number before, to be met again.
    last: f64,
    /// Size of the ordinary numbers.
    scale: f64,
}

/// A lobe's matrix, row-major, and a light.
#[derive(Debug)]
pub struct Input {
    pub m: [f64; 9],
    pub light: AnyLight,
    /// Whether the light has no measure, so that the answer is exactly 0.
    pub is_nothing: bool,
}

impl<'a> Generator<'a> {
    pub fn new(word: &'a mut dyn FnMut() -> u64) -> Self {
        Self { word, last: 1.0, scale: 1.0 }
    }

    fn below(&mut self, n: u64) -> u64 {
        (self.word)() % n
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        ((self.word)() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn power_of_ten(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(low + (high - low) * self.unit())
    }

    /// Ordinary four times in seven; else zero, one, tiny, huge, the number before, or its negative.
    fn number(&mut self) -> f64 {
        let ordinary = self.scale * (2.0 * self.unit() - 1.0);
        let number = match self.below(28) {
            0 | 1 => 0.0,
            2 => self.scale,
            3 => -self.scale,
            4 => self.last,
            5 => -self.last,
            6 => 1e-7 * ordinary,
            7 => ordinary * self.power_of_ten(-12.0, 12.0),
            8 => 1e-40 * ordinary,
            9 => 1e30 * ordinary,
            10 => self.last * (1.0 + f64::EPSILON),
            11 => self.last * (1.0 + f64::from(f32::EPSILON)),
            _ => ordinary,
        };
        // Beyond f32 there is nothing to learn about f32.
        self.last = number.clamp(-1e37, 1e37);
        self.last
    }

    fn point(&mut self) -> [f64; 3] {
        [self.number(), self.number(), self.number()]
    }

    /// A matrix: that of a narrow, tilted lobe most often, or anything.
    fn matrix(&mut self) -> [f64; 9] {
        self.scale = 1.0;
        if self.below(4) == 0 {
            let mut m = [0.0; 9];
            m.fill_with(|| self.number());
            return m;
        }
        let lowest = if self.below(8) == 0 { -8.0 } else { -3.0 };
        let (a, b) = (self.power_of_ten(lowest, 0.0), self.power_of_ten(lowest, 0.0));
        let (theta, phi) = (1.6 * self.unit(), 6.3 * self.unit());
        let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
        let shear = if self.below(2) == 0 { 0.0 } else { 2.0 * self.unit() - 1.0 };
        [cp * ct * a, -sp * b + shear * a, cp * st, sp * ct * a, cp * b, sp * st, -st * a, 0.0, ct]
    }

    /// Anything at all.
    pub fn input(&mut self) -> Input {
        let m = self.matrix();
        self.scale = if self.below(2) == 0 { 1.0 } else { self.power_of_ten(-6.0, 6.0) };
        let sides = if self.below(2) == 0 { Sides::One } else { Sides::Two };
        let light = self.light(sides);
        Input { m, light, is_nothing: false }
    }

    fn light(&mut self, sides: Sides) -> AnyLight {
        let radius = |g: &mut Self| g.number().abs();
        match self.below(7) {
            0 => {
                let count = 3 + self.below(6) as usize;
                let mut vertices: Vec<_> = (0..count).map(|_| self.point()).collect();
                if self.below(2) == 0 {
                    flatten(&mut vertices);
                }
                AnyLight::Polygon { vertices, sides }
            }
            1 => AnyLight::Line { p0: self.point(), p1: self.point(), radius: radius(self) },
            2 => AnyLight::Strip {
                p0: self.point(),
                p1: self.point(),
                width: radius(self),
                normal: self.point(),
                sides,
            },
            3 => AnyLight::Cylinder {
                p0: self.point(),
                p1: self.point(),
                radius: radius(self),
                caps: sides == Sides::Two,
            },
            4 => AnyLight::Disk { center: self.point(), normal: self.point(), radius: radius(self), sides },
            5 => {
                AnyLight::Ellipse { center: self.point(), axis_u: self.point(), axis_v: self.point(), sides }
            }
            _ => AnyLight::Sphere { center: self.point(), radius: radius(self) },
        }
    }

    /// A light without measure.
    pub fn nothing(&mut self) -> Input {
        let m = self.matrix();
        self.scale = self.power_of_ten(-6.0, 6.0);
        let sides = Sides::Two;
        // Numbers of f32: rounding each on its own would give parallel axes an area.
        let [p, q] = [self.point(), self.point()].map(|p| p.map(|x| f64::from(x as f32)));
        let n = [0.0, 0.6, 0.8];
        let light = match self.below(8) {
            0 => AnyLight::Polygon { vertices: vec![p; 4], sides },
            1 => AnyLight::Polygon { vertices: vec![p, q, p, q], sides },
            2 => AnyLight::Line { p0: p, p1: q, radius: 0.0 },
            3 => AnyLight::Line { p0: p, p1: p, radius: 1.0 },
            4 => AnyLight::Strip { p0: p, p1: q, width: 0.0, normal: n, sides },
            5 => AnyLight::Disk { center: p, normal: n, radius: 0.0, sides },
            6 => AnyLight::Ellipse { center: p, axis_u: q, axis_v: q.map(|x| 2.0 * x), sides },
            _ => AnyLight::Sphere { center: p, radius: 0.0 },
        };
        Input { m, light, is_nothing: true }
    }
}

/// Moves the fourth and later vertices into the plane of the first three.
fn flatten(vertices: &mut [[f64; 3]]) {
    let [a, b, c] = [vertices[0], vertices[1], vertices[2]];
    for (i, v) in vertices.iter_mut().enumerate().skip(3) {
        let (s, t) = (0.37 * i as f64 - 1.0, 1.3 - 0.21 * i as f64);
        *v = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
    }
}
