//! Every form that is timed on the device. A new one is a line in one of these functions; its name is for ever.

use glam::DMat3;
use ltc_core::{Alpha, Matrix as _};
use ltc_shade_gpu::timing::{Resource, Stage};
use ltc_shade_gpu::{BakedSlices, Filtering, Gpu, LightKind, LightShape, TableTextures, Tables, Texels};
use ltc_table::{Catalogue, Query, Table};

use super::super::StudyError;
use super::YARDSTICK;
use super::bench::{Bench, Measure, Reads, lit, placed};
use super::scene::{self, Materials, Pixel, reflectance};
use super::sources::{self, BOTH_HORIZONS, Find, Integrate};
use super::tables::Published;

/// What may be off in f32 before it is not worth timing; conditions of the scene's lobes go to a few hundred.
const EXACT: f64 = 1e-3;
/// Half floats, and texture units whose weights have eight bits.
const ROUNDED: f64 = 0.1;
/// What leaks from below the surface's horizon, or is not clipped: shown, not hidden.
const LEAKS: f64 = 0.6;

/// What a table says about a query: M and the reflectance.
type LobeOf<'a> = &'a dyn Fn(&Query) -> Result<(DMat3, f64), StudyError>;

/// How much of it all.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Whether every form is timed, or those alone that the ratios are of.
    pub all: bool,
    /// Lights of which the price of one is the slope.
    pub few_many: [u32; 2],
    /// Numbers of lights under one lookup.
    pub counts: &'static [u32],
}

/// Tables on the device, held in one way.
struct Held {
    gpu: Gpu,
    isotropic: TableTextures,
    anisotropic: TableTextures,
    baked: BakedSlices,
    filtering: Filtering,
    name: &'static str,
    bound: f64,
}

impl Held {
    fn tables(&self) -> Tables<'_> {
        let (isotropic, anisotropic) = (Some(&self.isotropic), Some(&self.anisotropic));
        Tables { isotropic, anisotropic, ..Tables::default() }
    }
}

/// All forms of one picture.
pub struct Forms<'a> {
    pub bench: Bench<'a>,
    extent: Extent,
    isotropic: &'a Table,
    anisotropic: &'a Table,
    published: Published,
    ways: Vec<Held>,
    /// The program that only reads and writes pixels, in each stage.
    empty: [usize; 2],
    step: &'a dyn Fn(&str),
}

/// Of the blocks' materials.
fn block_widths() -> Result<Vec<Alpha>, StudyError> {
    let alpha = |[x, y]: [f32; 2]| Alpha::new(f64::from(x), f64::from(y));
    Ok(scene::block_materials().into_iter().map(alpha).collect::<Result<_, _>>()?)
}

fn plain_lookup(table: &Table, query: &Query) -> Result<(DMat3, f64), StudyError> {
    let found = table.lookup(query)?;
    Ok((DMat3::from_row_array(found.lobes[0].m), reflectance(found.magnitude, found.fresnel)))
}

impl<'a> Forms<'a> {
    /// Compiles and checks all of them.
    ///
    /// # Errors
    /// Those of tables and device, and [`StudyError::Wrong`].
    pub fn new(
        bench: Bench<'a>,
        extent: Extent,
        catalogue: &'a Catalogue,
        step: &'a dyn Fn(&str),
    ) -> Result<Self, StudyError> {
        let isotropic = catalogue.find("ggx-isotropic")?.table();
        let anisotropic = catalogue.find("ggx-anisotropic")?.table();
        let published = Published::of(catalogue)?;
        let mut ways = Vec::new();
        for (filtering, texels, name, bound) in [
            (Filtering::Exact, Texels::F32, "texture_f32", EXACT),
            (Filtering::Exact, Texels::F16, "texture_f16", ROUNDED),
            (Filtering::Buffer, Texels::F32, "buffer_f32", EXACT),
            (Filtering::Hardware, Texels::F16, "filtered_f16", ROUNDED),
            (Filtering::Hardware, Texels::F32, "filtered_f32", ROUNDED),
        ] {
            // A device that cannot filter 32 bits goes without that form.
            let Ok(gpu) = bench.gpu.with_tables(filtering, texels) else { continue };
            let tables = [isotropic, anisotropic].map(|table| TableTextures::upload(&gpu, table));
            let [on_2d, on_4d] = tables;
            let baked = BakedSlices::bake(&gpu, anisotropic, &block_widths()?)?;
            ways.push(Held { isotropic: on_2d?, anisotropic: on_4d?, baked, gpu, filtering, name, bound });
        }
        let mut forms = Self { bench, extent, isotropic, anisotropic, published, ways, empty: [0; 2], step };
        forms.frame()?;
        forms.lookups()?;
        forms.integrals()?;
        forms.shading()?;
        if extent.all {
            forms.what_limits()?;
            forms.fragments()?;
        }
        Ok(forms)
    }

    fn frame(&mut self) -> Result<(), StudyError> {
        let gpu = self.bench.gpu;
        for (k, stage) in Stage::ALL.into_iter().enumerate() {
            if stage == Stage::Compute {
                let (places, _) = self.bench.add(
                    YARDSTICK,
                    gpu,
                    stage,
                    sources::YARDSTICK,
                    Reads::default(),
                    &[0],
                    None,
                )?;
                self.bench.form(YARDSTICK, Measure::Frame(places[0]), None);
            } else if !self.extent.all {
                break;
            }
            let name = format!("{}/empty", stage.name());
            let (places, _) =
                self.bench.add(&name, gpu, stage, sources::EMPTY, Reads::default(), &[0], None)?;
            self.empty[k] = places[0];
            self.bench.form(name, Measure::Frame(places[0]), None);
        }
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "each is a different thing, and all are needed")]
    fn lookup(
        &mut self,
        name: &str,
        gpu: &Gpu,
        stage: Stage,
        find: Find,
        reads: Reads<'_>,
        truth: Option<LobeOf<'_>>,
        bound: f64,
    ) -> Result<(), StudyError> {
        let name = format!("{}/lookup/{name}", stage.name());
        (self.step)(&name);
        let judge = |pixel: &Pixel| {
            let Some(truth) = truth else { return Ok([None; 4]) };
            let (m, reflected) = truth(&pixel.query())?;
            let [a, b, c] = pixel.cosines(m);
            Ok([Some(a), Some(b), Some(c), Some(reflected)])
        };
        let judged = truth.is_some().then_some((&judge as super::bench::Truth<'_>, bound));
        let (places, errors) =
            self.bench.add(&name, gpu, stage, &sources::lookup(find), reads, &[0], judged)?;
        let empty = self.empty[usize::from(stage == Stage::Fragment)];
        self.bench.form(name, Measure::Net(places[0], empty), errors);
        Ok(())
    }

    fn lookups(&mut self) -> Result<(), StudyError> {
        let (flat, full) = (self.isotropic, self.anisotropic);
        let isotropic = move |query: &Query| plain_lookup(flat, query);
        let anisotropic = move |query: &Query| plain_lookup(full, query);
        let ways = std::mem::take(&mut self.ways);
        for way in &ways {
            if !self.extent.all && way.name == "texture_f16" {
                continue;
            }
            let on = |materials| Reads {
                tables: Some(way.tables()),
                materials: Some(materials),
                ..Reads::default()
            };
            let (name, gpu, bound) = (way.name, &way.gpu, way.bound);
            let (two, four) = (Find::Isotropic(way.filtering), Find::Anisotropic(way.filtering));
            let reads = on(Materials::Isotropic);
            self.lookup(
                &format!("isotropic/{name}"),
                gpu,
                Stage::Compute,
                two,
                reads,
                Some(&isotropic),
                bound,
            )?;
            let reads = on(Materials::Anisotropic);
            self.lookup(
                &format!("anisotropic/{name}"),
                gpu,
                Stage::Compute,
                four,
                reads,
                Some(&anisotropic),
                bound,
            )?;
            let slices = Tables { baked: Some(&way.baked), ..Tables::default() };
            let reads = Reads { tables: Some(slices), ..on(Materials::Blocks) };
            let (name_baked, find) = (format!("anisotropic_baked/{name}"), Find::Baked(way.filtering));
            self.lookup(&name_baked, gpu, Stage::Compute, find, reads, Some(&anisotropic), bound)?;
            if way.name == "texture_f32" && self.extent.all {
                let reads = on(Materials::Isotropic);
                let name = format!("isotropic_through_anisotropic/{name}");
                self.lookup(&name, gpu, Stage::Compute, four, reads, Some(&anisotropic), bound)?;
            }
        }
        self.ways = ways;
        for (texels, name) in [(Texels::F16, "refined_f16"), (Texels::F32, "refined_f32")] {
            // A device that cannot filter 32 bits goes without that form.
            let Ok(gpu) = self.bench.gpu.with_tables(Filtering::Refined, texels) else { continue };
            let refined = TableTextures::upload(&gpu, full)?;
            let reads = Reads {
                tables: Some(Tables { anisotropic: Some(&refined), ..Tables::default() }),
                materials: Some(Materials::Anisotropic),
                ..Reads::default()
            };
            let (name, find) = (format!("anisotropic/{name}"), Find::Anisotropic(Filtering::Refined));
            self.lookup(&name, &gpu, Stage::Compute, find, reads, Some(&anisotropic), ROUNDED)?;
        }
        let drop_in = self.published.drop_in.clone();
        let uniform = self.published.anisotropic.clone();
        let gpu = self.bench.gpu;
        let textures = self.published.isotropic_textures(gpu)?;
        let reads = Reads { materials: Some(Materials::Isotropic), further: &textures, ..Reads::default() };
        let truth = |query: &Query| {
            let found = drop_in.lookup(query)?;
            Ok((DMat3::from_row_array(found.lobes[0].m), reflectance(found.magnitude, found.fresnel)))
        };
        self.lookup(
            "isotropic/published_2016",
            gpu,
            Stage::Compute,
            Find::PublishedIsotropic,
            reads,
            Some(&truth),
            ROUNDED,
        )?;
        let textures = self.published.anisotropic_textures(gpu)?;
        let reads = Reads { materials: Some(Materials::Anisotropic), further: &textures, ..Reads::default() };
        let truth = |query: &Query| plain_lookup(&uniform, query);
        self.lookup(
            "anisotropic/published_2022",
            gpu,
            Stage::Compute,
            Find::PublishedAnisotropic,
            reads,
            Some(&truth),
            ROUNDED,
        )
    }

    /// The price of one light of a form: the slope over the number of lights.
    #[expect(clippy::too_many_arguments, reason = "each is a different thing, and all are needed")]
    fn light(
        &mut self,
        name: &str,
        stage: Stage,
        find: Find,
        integrate: Integrate,
        (lights, points): (Vec<LightShape>, Vec<[f32; 4]>),
        further: &[Resource],
        bound: f64,
    ) -> Result<(), StudyError> {
        let name = format!("{}/integral/{name}", stage.name());
        (self.step)(&name);
        let gpu = self.bench.gpu;
        let few_many = self.extent.few_many;
        let taken = &lights[..few_many[1] as usize];
        let judge = |pixel: &Pixel| lit(taken, pixel, (pixel.matrix(), 1.0));
        let reads = Reads { points: &points, further, ..Reads::default() };
        let wgsl = sources::lights(find, integrate);
        let (places, errors) =
            self.bench.add(&name, gpu, stage, &wgsl, reads, &few_many, Some((&judge, bound)))?;
        let [few, many] = [places[0], places[1]];
        let lights = f64::from(few_many[1] - few_many[0]);
        self.bench.form(name, Measure::Slope { few, many, lights }, errors);
        Ok(())
    }

    fn integrals(&mut self) -> Result<(), StudyError> {
        let most = self.extent.few_many[1];
        let on = |kind| placed(kind, most, false);
        let shipped = |kind| Integrate::Shipped(kind, BOTH_HORIZONS);
        let (ours, compute) = (Find::Formula, Stage::Compute);
        let [quad, line] = [LightKind::Quad, LightKind::Line];
        self.light("quad/exact", compute, ours, shipped(quad), on(quad), &[], EXACT)?;
        self.light("line/exact", compute, ours, shipped(line), on(line), &[], EXACT)?;
        let published = Find::PublishedFormula;
        self.light(
            "quad/published_2016",
            compute,
            published,
            Integrate::PublishedQuad,
            on(quad),
            &[],
            LEAKS,
        )?;
        self.light(
            "line/published_2017",
            compute,
            published,
            Integrate::PublishedLine,
            on(line),
            &[],
            LEAKS,
        )?;
        let lean = |kind| Integrate::Shipped(kind, &["surface_horizon", "cosine_horizon", "lean_lights"]);
        self.light("quad/lean", compute, ours, lean(quad), on(quad), &[], EXACT)?;
        self.light("line/lean", compute, ours, lean(line), on(line), &[], EXACT)?;
        let alone = Integrate::Shipped(quad, &["cosine_horizon"]);
        self.light("quad/cosine_horizon_alone", compute, ours, alone, on(quad), &[], LEAKS)?;
        let [_, sphere, filter] = self.published.isotropic_textures(self.bench.gpu)?;
        let sphere = [sphere, filter];
        self.light(
            "quad/published_proxy",
            compute,
            published,
            Integrate::PublishedProxy,
            on(quad),
            &sphere,
            LEAKS,
        )?;
        if !self.extent.all {
            return Ok(());
        }
        for kind in LightKind::ALL.into_iter().filter(|kind| ![quad, line].contains(kind)) {
            let name = format!("{}/exact", kind.name().replace('-', "_"));
            self.light(&name, compute, ours, shipped(kind), on(kind), &[], EXACT)?;
        }
        let rational = Integrate::Shipped(quad, &["surface_horizon", "cosine_horizon", "rational_edges"]);
        self.light("quad/rational_edges", compute, ours, rational, on(quad), &[], EXACT)?;
        let none = Integrate::Shipped(quad, &[]);
        self.light("quad/no_horizon", compute, ours, none, on(quad), &[], LEAKS)?;
        let sunk = placed(quad, most, true);
        let name = "quad/published_2016_half_below_the_surface";
        self.light(name, compute, published, Integrate::PublishedQuad, sunk.clone(), &[], LEAKS)?;
        self.light("quad/half_below_the_surface", compute, ours, shipped(quad), sunk, &[], EXACT)?;
        let name = "quad/lean_half_below_the_surface";
        self.light(name, compute, ours, lean(quad), placed(quad, most, true), &[], EXACT)?;
        let records = records(&on(quad).0);
        let bytes: Vec<u8> = records.iter().flat_map(|word| word.to_le_bytes()).collect();
        let gpu = self.bench.gpu;
        let further = [Resource::storage(gpu, &bytes)?, Resource::storage(gpu, &[0; 16])?];
        self.light("quad/all_kinds_present", compute, ours, Integrate::AllKinds, on(quad), &further, EXACT)
    }

    /// One lookup and quads under it.
    fn shading(&mut self) -> Result<(), StudyError> {
        let counts = self.extent.counts;
        let most = counts.iter().copied().max().unwrap_or(1);
        let (lights, points) = placed(LightKind::Quad, most, false);
        let quad = Integrate::Shipped(LightKind::Quad, BOTH_HORIZONS);
        let (flat, full) = (self.isotropic, self.anisotropic);
        let isotropic = move |query: &Query| plain_lookup(flat, query);
        let anisotropic = move |query: &Query| plain_lookup(full, query);
        let ways = std::mem::take(&mut self.ways);
        for (kind, materials, truth) in [
            ("isotropic", Materials::Isotropic, &isotropic as LobeOf<'_>),
            ("anisotropic", Materials::Anisotropic, &anisotropic),
        ] {
            let Some(way) = ways.first() else { break };
            let find = match materials {
                Materials::Isotropic => Find::Isotropic(way.filtering),
                _ => Find::Anisotropic(way.filtering),
            };
            let reads = Reads {
                tables: Some(way.tables()),
                materials: Some(materials),
                points: &points,
                further: &[],
            };
            let counts = if materials == Materials::Isotropic { counts } else { &[1] };
            // Those of the last number of lights, which is the one that is judged.
            let taken = &lights[..counts[counts.len() - 1] as usize];
            let judge = |pixel: &Pixel| lit(taken, pixel, truth(&pixel.query())?);
            self.shade(kind, &way.gpu, find, quad, reads, counts, Some(&judge))?;
        }
        self.ways = ways;
        let gpu = self.bench.gpu;
        let textures = self.published.isotropic_textures(gpu)?;
        let reads = Reads {
            materials: Some(Materials::Isotropic),
            points: &points,
            further: &textures,
            ..Reads::default()
        };
        let (find, quad) = (Find::PublishedIsotropic, Integrate::PublishedQuad);
        self.shade("published_2016", gpu, find, quad, reads, &[1], None)?;
        let textures = self.published.anisotropic_textures(gpu)?;
        let reads = Reads {
            materials: Some(Materials::Anisotropic),
            points: &points,
            further: &textures,
            ..Reads::default()
        };
        self.shade("published_2022", gpu, Find::PublishedAnisotropic, quad, reads, &[1], None)
    }

    #[expect(clippy::too_many_arguments, reason = "each is a different thing, and all are needed")]
    fn shade(
        &mut self,
        kind: &str,
        gpu: &Gpu,
        find: Find,
        integrate: Integrate,
        reads: Reads<'_>,
        counts: &[u32],
        truth: Option<super::bench::Truth<'_>>,
    ) -> Result<(), StudyError> {
        let name = format!("compute/shade/{kind}");
        (self.step)(&name);
        let wgsl = sources::lights(find, integrate);
        let judged = truth.map(|truth| (truth, EXACT));
        let (places, errors) = self.bench.add(&name, gpu, Stage::Compute, &wgsl, reads, counts, judged)?;
        for (place, count) in places.iter().zip(counts) {
            self.bench.form(format!("{name}/{count:02}_lights"), Measure::Frame(*place), errors);
        }
        Ok(())
    }

    /// One thing at a time: neighbours that share nothing, and lookups without fetches.
    fn what_limits(&mut self) -> Result<(), StudyError> {
        let ways = std::mem::take(&mut self.ways);
        let full = self.anisotropic;
        let anisotropic = move |query: &Query| plain_lookup(full, query);
        if let Some(way) = ways.first() {
            let reads = Reads {
                tables: Some(way.tables()),
                materials: Some(Materials::Scattered),
                ..Reads::default()
            };
            let find = Find::Anisotropic(way.filtering);
            let name = "anisotropic_scattered/texture_f32";
            self.lookup(name, &way.gpu, Stage::Compute, find, reads, Some(&anisotropic), way.bound)?;
        }
        self.ways = ways;
        let gpu = self.bench.gpu;
        for (name, find, table, materials) in [
            ("isotropic/arithmetic_alone", Find::IsotropicArithmetic, self.isotropic, Materials::Isotropic),
            (
                "anisotropic/arithmetic_alone",
                Find::AnisotropicArithmetic,
                self.anisotropic,
                Materials::Anisotropic,
            ),
        ] {
            let further = [Resource::uniform(gpu, &TableTextures::axes_bytes(table)?)?];
            let reads = Reads { materials: Some(materials), further: &further, ..Reads::default() };
            self.lookup(name, gpu, Stage::Compute, find, reads, None, 0.0)?;
        }
        Ok(())
    }

    /// The other stage.
    fn fragments(&mut self) -> Result<(), StudyError> {
        let stage = Stage::Fragment;
        let (flat, full) = (self.isotropic, self.anisotropic);
        let isotropic = move |query: &Query| plain_lookup(flat, query);
        let anisotropic = move |query: &Query| plain_lookup(full, query);
        let ways = std::mem::take(&mut self.ways);
        for way in ways.iter().filter(|way| ["texture_f32", "filtered_f16"].contains(&way.name)) {
            let on = |materials| Reads {
                tables: Some(way.tables()),
                materials: Some(materials),
                ..Reads::default()
            };
            let (two, four) = (Find::Isotropic(way.filtering), Find::Anisotropic(way.filtering));
            let name = format!("isotropic/{}", way.name);
            self.lookup(&name, &way.gpu, stage, two, on(Materials::Isotropic), Some(&isotropic), way.bound)?;
            let name = format!("anisotropic/{}", way.name);
            self.lookup(
                &name,
                &way.gpu,
                stage,
                four,
                on(Materials::Anisotropic),
                Some(&anisotropic),
                way.bound,
            )?;
        }
        self.ways = ways;
        let most = self.extent.few_many[1];
        for kind in [LightKind::Quad, LightKind::Line] {
            let name = format!("{}/exact", kind.name());
            let way = Integrate::Shipped(kind, BOTH_HORIZONS);
            self.light(&name, stage, Find::Formula, way, placed(kind, most, false), &[], EXACT)?;
        }
        let quads = placed(LightKind::Quad, most, false);
        let find = Find::PublishedFormula;
        self.light("quad/published_2016", stage, find, Integrate::PublishedQuad, quads, &[], LEAKS)
    }
}

/// Quads as `LightRecord` has them: four corners, radiance, and the kind.
fn records(lights: &[LightShape]) -> Vec<u32> {
    let one = |light: &LightShape| {
        let LightShape::Quad { corners, .. } = light else { return Vec::new() };
        let mut words: Vec<u32> =
            corners.iter().flat_map(|c| [c.x, c.y, c.z, 0.0]).map(f32::to_bits).collect();
        words.extend([1.0_f32, 1.0, 1.0].map(f32::to_bits));
        words.push(LightKind::Quad as u32);
        words
    };
    lights.iter().flat_map(one).collect()
}
