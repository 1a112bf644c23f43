//! Textured lights: CPU f32 and every GPU driver that can run here against CPU f64, by one body, and hazards of which
//! the answer is known.

use core::f64::consts::FRAC_PI_2;

use glam::Vec3;
use ltc_core::Sides;
use ltc_fit::draw;
use ltc_shade_gpu::{LightKind, LightShape, LightTexture, TexturedJob};
use ltc_tests::{
    TexturedBackEnd, TexturedOnCpu, condition, table, textured_back_ends, textured_jobs, textured_matrix,
    textures, tolerance, wide,
};

/// Triples of material, view and light for each kind of light.
const TRIPLES: usize = 100_000;

/// Half of the triples over the standard draw of the anisotropic table, half over wider domains of both tables.
fn triples(kind: LightKind, count: usize) -> Vec<TexturedJob> {
    let (anisotropic, isotropic) = (table("ggx-anisotropic"), table("ggx-isotropic"));
    let seed = 300 + kind as u64;
    let standard = draw::standard(TRIPLES / 2, seed, false);
    let mut jobs = textured_jobs(kind, &anisotropic, &standard, seed, count);
    let narrow = wide(TRIPLES / 4, 0.0, FRAC_PI_2, seed);
    jobs.extend(textured_jobs(kind, &anisotropic, &narrow, seed + 50, count));
    let narrow = wide(TRIPLES / 4, 1.0, FRAC_PI_2, seed);
    jobs.extend(textured_jobs(kind, &isotropic, &narrow, seed + 60, count));
    jobs
}

#[test]
fn random_triples_agree_on_all_back_ends() {
    let textures = textures();
    let brightest: Vec<_> = textures.iter().map(|t| t.brightest().map(f64::from)).collect();
    let back_ends = textured_back_ends();
    let truth = TexturedOnCpu::<f64>::new(&textures);
    let mut failures = Vec::new();
    for kind in [LightKind::Quad, LightKind::Polygon] {
        let jobs = triples(kind, textures.len());
        let truth = truth.colours(&jobs).unwrap();
        let lit = truth.iter().filter(|c| c[1] > 1e-3).count() as f64 / jobs.len() as f64;
        assert!(lit > 0.05, "{kind}: only {lit} of the triples are lit");
        for back_end in &back_ends {
            let values = back_end.colours(&jobs).unwrap();
            let (mut worst, mut at, mut absolute) = (0.0, 0, 0.0_f64);
            for (i, job) in jobs.iter().enumerate() {
                let allowed = tolerance::LIGHTS * (condition(textured_matrix(job)) / 100.0).max(1.0);
                for c in 0..3 {
                    let (value, most) = (values[i][c], brightest[job.texture.number][c]);
                    assert!(value >= 0.0 && value <= most * (1.0 + 1e-6), "{value} of {most}: {job:?}");
                    let off = (value - truth[i][c]).abs() / most.max(f64::MIN_POSITIVE);
                    absolute = absolute.max(off);
                    if off / allowed > worst {
                        (worst, at) = (off / allowed, i);
                    }
                }
            }
            println!(
                "{kind}, {}: up to {absolute:.1e} of the brightest texel, {worst:.2} of what is allowed; {:.0} % lit",
                back_end.name(),
                100.0 * lit
            );
            if worst > 1.0 {
                failures.push(format!(
                    "{kind}, {}: {:?} for {:?}, {worst} of what is allowed: {:?}",
                    back_end.name(),
                    values[at],
                    truth[at],
                    jobs[at]
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The control: another texture, and the same texture the other way round, are other lights.
#[test]
fn another_texture_is_seen() {
    let count = textures().len();
    let jobs: Vec<_> = triples(LightKind::Quad, count).into_iter().take(4_000).collect();
    let truth = TexturedOnCpu::<f64>::new(&textures()).colours(&jobs).unwrap();
    let off = |jobs: &[TexturedJob], back_end: &dyn TexturedBackEnd| {
        let found = back_end.colours(jobs).unwrap();
        let pairs = found.iter().zip(&truth);
        pairs.filter(|(a, b)| (0..3).any(|c| (a[c] - b[c]).abs() > 0.01 * (1.0 + b[c]))).count()
    };
    for back_end in textured_back_ends() {
        assert_eq!(off(&jobs, &*back_end), 0);
        let mut other = jobs.clone();
        other.iter_mut().for_each(|job| job.texture.number = (job.texture.number + 1) % count);
        assert!(off(&other, &*back_end) > 400, "{}", back_end.name());
        let mut turned = jobs.clone();
        for job in &mut turned {
            let frame = &mut job.texture.frame;
            (frame.origin, frame.axis_u) = (frame.origin + frame.axis_u, -frame.axis_u);
        }
        assert!(off(&turned, &*back_end) > 200, "{}", back_end.name());
    }
}

const COSINE: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// Tilted and thin: it would see what is below the surface.
const TILTED: [f32; 9] = [0.2, 0.0, 0.9, 0.0, 0.05, 0.0, -0.15, 0.0, 0.1];

fn quad(corners: [[f32; 3]; 4], number: usize) -> TexturedJob {
    let corners = corners.map(Vec3::from_array);
    TexturedJob {
        m: COSINE,
        light: LightShape::Quad { corners, sides: Sides::Two },
        texture: LightTexture::filling(number, &corners),
    }
}

/// A square of half-width `half` around `centre`, facing along y.
fn upright(centre: [f32; 3], half: f32, number: usize) -> TexturedJob {
    let [x, y, z] = centre;
    let at = |u: f32, v: f32| [x + half * u, y, z + half * v];
    quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], number)
}

/// Which textures are what.
const CHECKER: usize = 4;
const SUN: usize = 5;
const ONE_TEXEL: usize = 6;
const BLACK: usize = 7;

#[test]
fn hazards_have_their_answers() {
    let on_every_back_end = |jobs: &[TexturedJob], expected: &dyn Fn(usize, [f64; 3])| {
        let mut back_ends = textured_back_ends();
        back_ends.push(Box::new(TexturedOnCpu::<f64>::new(&textures())));
        for back_end in back_ends {
            println!("{}", back_end.name());
            let found = back_end.colours(jobs).unwrap();
            for (i, colour) in found.into_iter().enumerate() {
                assert!(colour.iter().all(|c| c.is_finite() && *c >= 0.0), "{i}: {colour:?}");
                expected(i, colour);
            }
        }
    };
    // Below the horizon, touching it from below, in the plane of the shading point, on its corner, and black: exactly nothing.
    let mut dark = vec![
        upright([0.5, 1.0, -1.5], 1.0, SUN),
        upright([0.0, 1.0, -1.0], 1.0, SUN),
        upright([0.0, 0.0, 1.5], 1.0, SUN),
        upright([0.0, 0.0, 0.0], 1.0, SUN),
        upright([1.0, 0.0, 1.0], 1.0, SUN),
        upright([0.0, 1.0, 1.0], 1.0, BLACK),
    ];
    let tilted: Vec<_> = dark.iter().map(|job| TexturedJob { m: TILTED, ..job.clone() }).collect();
    dark.extend(tilted);
    on_every_back_end(&dark, &|i, colour| assert_eq!(colour, [0.0; 3], "{i}"));
    // The control: raised a little, all but the black one shine.
    let raised: Vec<_> = [[0.5, 1.0, -0.9], [0.0, 1.0, -0.9], [0.0, 1e-3, 1.5], [0.5, 1e-3, 0.0]]
        .map(|centre| upright(centre, 1.0, SUN))
        .to_vec();
    on_every_back_end(&raised, &|i, colour| assert!(colour[0] > 0.0, "{i}"));

    // One texel is one colour, however the light is cut: the ratio of channels is the texel's.
    let one: Vec<_> = (0..36)
        .map(|i| {
            upright([0.1 * i as f32 - 2.0, 0.02 + 0.05 * i as f32, 0.9 - 0.05 * i as f32], 1.0, ONE_TEXEL)
        })
        .collect();
    on_every_back_end(&one, &|i, [r, g, b]| {
        assert!(g > 0.0 && (r / g - 0.5).abs() < 1e-6 && (b / g - 2.0).abs() < 1e-6, "{i}: {r} {g} {b}");
    });

    // From a millionth to a million times as large, with the distance: the same.
    let near = |scale: f32| upright([0.3 * scale, scale, 0.7 * scale], scale, CHECKER);
    let all: Vec<_> = [1.0, 1e-6, 1e-3, 1e3, 1e6].map(near).to_vec();
    let truth = TexturedOnCpu::<f64>::new(&textures()).colours(&all[..1]).unwrap()[0];
    on_every_back_end(&all, &|i, colour| {
        assert!((0..3).all(|c| (colour[c] - truth[c]).abs() < 1e-5), "{i}: {colour:?} {truth:?}");
    });

    // As far as 1e6 times its size: the mean of the texture, which the widest filter is to 7 %.
    let far = [upright([0.0, 1e6, 1e6], 1.0, CHECKER), upright([0.0, 1.0, 1.0], 1.0, CHECKER)];
    let white = far.clone().map(|mut job| {
        job.texture.number = ONE_TEXEL;
        job
    });
    let share = TexturedOnCpu::<f64>::new(&textures()).colours(&white).unwrap();
    on_every_back_end(&far[..1], &|_, colour| {
        assert!((colour[1] / share[0][1] - 0.5).abs() < 0.05, "{colour:?} {share:?}");
    });

    // No area: exactly nothing, where it can be a light at all.
    let thin = [[-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
    for back_end in textured_back_ends() {
        let error = back_end.colours(&[quad(thin, SUN)]).unwrap_err();
        assert!(error.contains("texture frame"), "{error}");
    }
    let mut flat = quad(thin, SUN);
    flat.texture.frame = upright([0.0, 1.0, 1.0], 1.0, SUN).texture.frame;
    on_every_back_end(&[flat], &|_, colour| assert_eq!(colour, [0.0; 3]));
}

/// A texture is part of its plane: seen from behind it is mirrored.
#[test]
fn from_behind_a_texture_is_mirrored() {
    // A needle towards (x, y, 1).
    let needle = |x: f32, y: f32| [0.01, 0.0, x, 0.0, 0.01, y, 0.0, 0.0, 1.0];
    // The light at y = 1 or at y = −1, the same but for that: its front faces −y.
    let job = |x: f32, y: f32| {
        let at = |u: f32, v: f32| [u, y, 1.0 + v];
        let square = quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], 0);
        TexturedJob { m: needle(x, y), ..square }
    };
    for back_end in textured_back_ends() {
        let found = back_end.colours(&[job(0.3, 1.0), job(0.3, -1.0), job(-0.3, -1.0)]).unwrap();
        let off = |i: usize| (0..3).map(|c| (found[0][c] - found[i][c]).abs()).fold(0.0, f64::max);
        assert!(off(1) < 1e-4, "the same point of it from either side: {found:?}");
        assert!(off(2) > 0.05, "the control: the point across its middle: {found:?}");
    }
}
