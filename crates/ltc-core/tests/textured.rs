//! Textured polygons against cubature of every texel.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use glam::{DMat3, DVec3};
use ltc_core::{
    Horizon, Light, Ltc, Polygon, PrefilteredTexture, Sides, TexelGrid, TextureFrame, TexturedPolygon,
    points::SplitMix64,
};
use ltc_reference::{LtcLobe, PolygonOptions, Tolerance, integrate_polygon_boundary};

const SIDE: usize = 8;
const FINER: usize = 8;

struct Image {
    colours: Vec<[f32; 3]>,
}

impl Image {
    fn of(colour: impl Fn(usize, usize) -> [f32; 3]) -> Self {
        Self { colours: (0..SIDE * SIDE).map(|k| colour(k % SIDE, k / SIDE)).collect() }
    }

    /// Red rises with u, green with v, blue with both.
    fn gradient() -> Self {
        let x = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        Self::of(|i, j| [x(i), x(j), 0.5 * (x(i) + x(j))])
    }

    /// Squares of a quarter of the side; the second channel is the first's negative.
    fn checkerboard() -> Self {
        Self::of(|i, j| {
            let on = ((i / 2 + j / 2) % 2) as f32;
            [on, 1.0 - on, 0.5]
        })
    }

    fn prefiltered(&self) -> PrefilteredTexture {
        let grid = TexelGrid { width: SIDE, height: SIDE, colours: &self.colours, coverage: None };
        PrefilteredTexture::new(grid).unwrap()
    }

    /// Each texel as `FINER`² of its colour: its edges are as sharp as those of the truth.
    fn sharp(&self) -> PrefilteredTexture {
        let side = FINER * SIDE;
        let texel = |k: usize| self.colours[k / side / FINER * SIDE + k % side / FINER];
        let colours: Vec<_> = (0..side * side).map(texel).collect();
        let grid = TexelGrid { width: side, height: side, colours: &colours, coverage: None };
        PrefilteredTexture::new(grid).unwrap()
    }
}

struct Scene {
    m: DMat3,
    quad: [DVec3; 4],
}

/// Lobes of widths from 0.03 to 1 in directions up to 60° from the normal, and parallelograms of half-width 0.2 to 1.5 at
/// distance 2 near them.
fn scenes(count: usize) -> Vec<Scene> {
    let mut rng = SplitMix64::new(11);
    let mut r = move |low: f64, high: f64| rng.range(low, high);
    (0..count)
        .map(|_| {
            let width = 0.03 * (1.0_f64 / 0.03).powf(r(0.0, 1.0));
            let turn = DMat3::from_rotation_z(r(0.0, 6.3)) * DMat3::from_rotation_x(r(0.0, 1.05));
            let shear = DMat3::from_cols(
                DVec3::new(width, 0.0, 0.2 * r(-1.0, 1.0)),
                DVec3::new(0.0, width * r(0.5, 1.0), 0.0),
                DVec3::new(0.2 * r(-1.0, 1.0), 0.0, 1.0),
            );
            let m = turn * shear;
            let half = r(0.2, 1.5);
            let centre = (m.z_axis + DVec3::new(r(-0.3, 0.3), r(-0.3, 0.3), r(-0.1, 0.3))) * 2.0;
            let face = DMat3::from_rotation_y(r(-0.8, 0.8)) * DMat3::from_rotation_x(r(-0.8, 0.8)) * turn;
            let (u, v) = (face.x_axis * half, (face.y_axis + face.x_axis * r(-0.3, 0.3)) * half);
            Scene { m, quad: [centre - u - v, centre + u - v, centre + u + v, centre - u + v] }
        })
        .collect()
}

/// The light a texel at a time, each of one colour.
fn truth(scene: &Scene, image: &Image) -> [f64; 3] {
    let [o, a, _, b] = scene.quad;
    let (u, v) = ((a - o) / SIDE as f64, (b - o) / SIDE as f64);
    let lobe = LtcLobe::new(scene.m).unwrap();
    let options = PolygonOptions { two_sided: true, tolerance: Tolerance::absolute(1e-7) };
    let mut sum = [0.0; 3];
    for j in 0..SIDE {
        for i in 0..SIDE {
            let p = o + u * i as f64 + v * j as f64;
            let seen =
                integrate_polygon_boundary(&lobe, true, &[p, p + u, p + u + v, p + v], options).unwrap();
            let colour = image.colours[j * SIDE + i];
            (0..3).for_each(|c| sum[c] += seen.value * f64::from(colour[c]));
        }
    }
    sum
}

/// Roots of the mean square errors over scenes and channels, as fractions of the brightest texel: of the light's own filter, and
/// of the paper's one Gaussian. `bend` may spoil the scene that is fetched.
fn errors(image: &Image, bend: impl Fn([DVec3; 4]) -> TextureFrame<f64>) -> [f64; 2] {
    let texture = image.sharp();
    let scenes = scenes(150);
    let mut squares = [0.0; 2];
    for scene in &scenes {
        let ltc = Ltc::<f64>::new(scene.m).unwrap();
        let light = TexturedPolygon::new(&scene.quad, Sides::Two, bend(scene.quad), &texture).unwrap();
        let seen = light.integrate_colour(&ltc, Horizon::BOTH);
        let fetch = light.texture_fetch(&ltc);
        let share = light.integrate_within(&ltc, Horizon::BOTH);
        let one = texture.fetch(fetch.uv, fetch.sigma).map(|c| share * f64::from(c));
        let exact = truth(scene, image);
        for (square, seen) in squares.iter_mut().zip([seen, one]) {
            *square += (0..3).map(|c| (seen[c] - exact[c]).powi(2)).sum::<f64>();
        }
    }
    squares.map(|square| (square / (3 * scenes.len()) as f64).sqrt())
}

fn error(image: &Image, bend: impl Fn([DVec3; 4]) -> TextureFrame<f64>) -> f64 {
    errors(image, bend)[0]
}

fn frame([o, a, _, b]: [DVec3; 4]) -> TextureFrame<f64> {
    TextureFrame { origin: o, axis_u: a - o, axis_v: b - o }
}

/// The texture upside down.
fn mirrored([o, a, _, b]: [DVec3; 4]) -> TextureFrame<f64> {
    TextureFrame { origin: b, axis_u: a - o, axis_v: o - b }
}

#[test]
fn colours_are_as_near_to_cubature_as_the_documents_say() {
    for (image, stated) in [(Image::gradient(), [0.013, 0.0145]), (Image::checkerboard(), [0.016, 0.026])] {
        let found = errors(&image, frame);
        println!("{found:?}");
        for (found, stated) in found.into_iter().zip(stated) {
            assert!(found < stated && found > 0.8 * stated, "{found}, stated {stated}");
        }
    }
}

/// The oracle sees a texture that lies the wrong way round.
#[test]
fn a_mirrored_texture_is_caught() {
    assert!(error(&Image::gradient(), mirrored) > 3.0 * error(&Image::gradient(), frame));
}

#[test]
fn one_colour_is_exact() {
    let texture = Image::of(|_, _| [0.25, 3.0, 0.0]).prefiltered();
    for scene in scenes(100) {
        let ltc = Ltc::<f64>::new(scene.m).unwrap();
        let share = Polygon::new(&scene.quad, Sides::Two).unwrap().integrate(&ltc);
        let light = TexturedPolygon::filled(&scene.quad, Sides::Two, &texture).unwrap();
        let seen = light.integrate_colour(&ltc, Horizon::BOTH);
        for (seen, colour) in seen.into_iter().zip([0.25, 3.0, 0.0]) {
            assert!((seen - share * colour).abs() < 1e-6 * share, "{seen} {share} {colour}");
        }
    }
}

/// A sharp lobe sees the one texel that it points at.
#[test]
fn a_sharp_lobe_sees_its_texel() {
    let image = Image::of(|i, j| [(i + SIDE * j) as f32, 0.0, 0.0]);
    let texture = image.prefiltered();
    let quad = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    for j in 0..SIDE {
        for i in 0..SIDE {
            let at = DVec3::new(0.25 * i as f64 - 0.875, 0.25 * j as f64 - 0.875, 1.0);
            let m = DMat3::from_cols(DVec3::X * 1e-3, DVec3::Y * 1e-3, at);
            let light = TexturedPolygon::filled(&quad, Sides::Two, &texture).unwrap();
            let [seen, ..] = light.integrate_colour(&Ltc::<f64>::new(m).unwrap(), Horizon::BOTH);
            assert!((seen - (i + SIDE * j) as f64).abs() < 0.1, "({i}, {j}): {seen}");
        }
    }
}

/// Part of the square is no light: the rest alone gives the colour.
#[test]
fn what_is_not_covered_lends_no_colour() {
    let colours = Image::of(|i, _| if i < SIDE / 2 { [1.0; 3] } else { [1000.0; 3] }).colours;
    let coverage: Vec<f32> = (0..SIDE * SIDE).map(|k| if k % SIDE < SIDE / 2 { 1.0 } else { 0.0 }).collect();
    let grid = TexelGrid { width: SIDE, height: SIDE, colours: &colours, coverage: Some(&coverage) };
    let texture = PrefilteredTexture::new(grid).unwrap();
    for sigma in [0.0, 0.01, 0.1, 1.0, 100.0] {
        for u in [-5.0, 0.0, 0.3, 0.7, 1.0, 9.0] {
            let [seen, ..] = texture.fetch([u, 0.4], sigma);
            assert!((seen - 1.0).abs() < 1e-5, "u {u}, σ {sigma}: {seen}");
        }
    }
}

/// The filtered texture is what the formula says, `∫ G L / ∫ G` over the square, at the widths of its levels.
#[test]
fn levels_are_gaussians_normalised_inside_the_square() {
    let image = Image::gradient();
    let texture = image.prefiltered();
    let n = 400;
    for sigma in [0.125, 0.25, 1.0] {
        for [u, v] in [[0.5, 0.5], [0.0, 0.25], [0.9, 0.05], [-0.2, 0.5], [1.1, 1.2]] {
            let mut sum = [0.0; 2];
            for k in 0..n * n {
                let [x, y] = [(k % n) as f64 + 0.5, (k / n) as f64 + 0.5].map(|x| x / n as f64);
                let g = (-((x - u).powi(2) + (y - v).powi(2)) / (2.0 * sigma * sigma)).exp();
                let texel = (x * SIDE as f64) as usize + SIDE * ((y * SIDE as f64) as usize);
                sum[0] += g * f64::from(image.colours[texel][0]);
                sum[1] += g;
            }
            let exact = sum[0] / sum[1];
            let seen = f64::from(texture.fetch([u, v], sigma)[0]);
            assert!((seen - exact).abs() < 0.012, "({u}, {v}), σ {sigma}: {seen} {exact}");
        }
    }
}

#[test]
fn fetches_are_continuous_and_defined_everywhere() {
    let texture = Image::checkerboard().prefiltered();
    for uv in [[f64::NAN, 0.5], [f64::INFINITY, -1e300], [0.5, 1e9], [-1e9, -1e9]] {
        for sigma in [0.0, 1.0, f64::INFINITY, f64::NAN, -1.0] {
            let colour = texture.fetch(uv, sigma);
            assert!(colour.iter().all(|c| (0.0..=1.0).contains(c)), "{uv:?} {sigma}: {colour:?}");
        }
    }
    // Across levels and across the square's edge no step is larger than its share.
    let steps = 20_000;
    let mut last = texture.fetch([-2.0, 0.3], 0.02)[0];
    for k in 1..=steps {
        let t = f64::from(k) / f64::from(steps);
        let next = texture.fetch([-2.0 + 5.0 * t, 0.3], 0.02 * 400.0_f64.powf(t))[0];
        assert!((next - last).abs() < 4e-3, "{t}: {last} {next}");
        last = next;
    }
}

#[test]
fn degenerate_lights_and_images_have_an_answer() {
    let texture = Image::gradient().prefiltered();
    let p = DVec3::new(0.2, 0.1, 1.0);
    assert!(TexturedPolygon::<f64>::filled(&[p; 4], Sides::Two, &texture).is_err());
    let far = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    for scale in [1e-30_f64, 1e-6, 1e6, 1e30] {
        let quad = far.map(|(x, y)| (DVec3::new(x, y, 1.0) * scale).as_vec3());
        let light = TexturedPolygon::<f32>::filled(&quad, Sides::Two, &texture).unwrap();
        let seen = light.integrate_colour(&Ltc::cosine(), Horizon::BOTH);
        assert!((seen[0] - 0.5 * light.irradiance()).abs() < 0.02, "{scale}: {seen:?}");
    }
    let grid = |colours, coverage| TexelGrid { width: 2, height: 1, colours, coverage };
    let good = [[1.0; 3]; 2];
    assert!(PrefilteredTexture::new(grid(&good, None)).is_ok());
    assert!(PrefilteredTexture::new(grid(&good[..1], None)).is_err());
    assert!(PrefilteredTexture::new(grid(&[[f32::NAN; 3]; 2], None)).is_err());
    assert!(PrefilteredTexture::new(grid(&[[-1.0; 3]; 2], None)).is_err());
    assert!(PrefilteredTexture::new(grid(&good, Some(&[0.0, 0.0]))).is_err());
    assert!(PrefilteredTexture::new(grid(&good, Some(&[0.0, 2.0]))).is_err());
    assert!(
        PrefilteredTexture::new(TexelGrid { width: 0, height: 1, colours: &[], coverage: None }).is_err()
    );
}
