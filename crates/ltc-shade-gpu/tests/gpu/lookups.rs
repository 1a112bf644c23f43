//! Table lookups: GPU against `ltc_table`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use ltc_core::Alpha;
use ltc_shade_gpu::{
    BakedLookups, BakedQuery, BakedSlices, Filtering, Gpu, GpuError, LookupResult, Lookups, TableTextures,
};
use ltc_table::{Axis, ClosedForm, Mapping, Quantity, Query, Table};

use crate::support::{gpu, random};
use crate::tables;

/// Between an interpolation in f32 and one in f64, absolute; entries are up to 1.
const TOLERANCE: f64 = 1e-5;
/// Where the texture unit rounds weights to 8 bits: 1/512 of what changes from node to node, at most about 1, on each of
/// four axes.
const HARDWARE_TOLERANCE: f64 = 4.0 / 512.0;

fn anisotropic_queries(count: usize) -> Vec<Query> {
    let mut rng = random(11);
    let mut queries: Vec<_> = (0..count)
        .map(|_| Query {
            theta: rng() * FRAC_PI_2,
            phi: (rng() - 0.5) * 4.0 * TAU,
            alpha_x: rng(),
            alpha_y: rng(),
        })
        .collect();
    // Narrow lobes, views along the normal (also exactly) and along the surface.
    for (theta, alpha) in [(0.0, 0.5), (1e-9, 0.2), (1e-4, 0.01), (FRAC_PI_2, 0.3), (FRAC_PI_2 - 1e-6, 0.0)] {
        for step in 0..16 {
            let phi = 0.1 + f64::from(step) * 0.8;
            queries.push(Query { theta, phi, alpha_x: alpha, alpha_y: 1.0 - alpha });
            queries.push(Query { theta, phi, alpha_x: 1.0 - alpha, alpha_y: alpha });
        }
    }
    queries
}

fn isotropic_queries(count: usize) -> Vec<Query> {
    anisotropic_queries(count).into_iter().map(|q| Query { alpha_y: q.alpha_x, ..q }).collect()
}

fn on_gpu(gpu: &Gpu, table: &Table, queries: &[Query]) -> Vec<LookupResult> {
    let textures = TableTextures::upload(gpu, table).unwrap();
    Lookups::new(gpu).unwrap().lookup(gpu, &textures, queries).unwrap()
}

/// The largest difference of any number between GPU and CPU.
fn largest_error(table: &Table, queries: &[Query], results: &[LookupResult]) -> f64 {
    assert_eq!(queries.len(), results.len());
    let mut largest = 0.0_f64;
    for (query, result) in queries.iter().zip(results) {
        let expected = table.lookup(query).unwrap();
        let numbers = expected.lobes[0].m.iter().zip(result.m);
        let channels =
            [(&expected.magnitude, result.magnitude), (&expected.fresnel, result.fresnel)].into_iter();
        for (a, b) in numbers.chain(channels) {
            largest = largest.max((a - f64::from(b)).abs());
        }
    }
    largest
}

/// A table over a part of the domain: axes that do not begin at 0.
fn cropped() -> Table {
    let axes = vec![
        Axis { domain: [0.2, 1.2], ..Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, 4) },
        Axis { domain: [0.3, 1.1], ..Axis::full(Quantity::Phi, Mapping::Linear, 3) },
        Axis { domain: [0.1, 0.6], ..Axis::full(Quantity::Alpha, Mapping::Sqrt, 5) },
        Axis { domain: [0.25, 0.75], ..Axis::full(Quantity::Lambda, Mapping::Linear, 2) },
    ];
    tables::table(axes, |nodes| [nodes[0].1, nodes[1].1, nodes[2].1, nodes[3].1])
}

fn with_closed_form(table: Table) -> Table {
    table.with_closed_form(Some(ClosedForm::GgxSmith)).unwrap()
}

fn all_tables() -> Vec<(&'static str, Table)> {
    vec![
        ("linear", tables::anisotropic(Mapping::Linear, Mapping::Linear)),
        ("sqrt", tables::anisotropic(Mapping::SqrtOneMinusCos, Mapping::Sqrt)),
        ("half tangent", tables::anisotropic(Mapping::HalfTangent, Mapping::Sqrt)),
        ("grazing half tangent", tables::anisotropic(Mapping::GrazingHalfTangent, Mapping::Sqrt)),
        ("cropped", cropped()),
        ("closed form", with_closed_form(tables::anisotropic(Mapping::HalfTangent, Mapping::Sqrt))),
    ]
}

#[test]
fn exact_filtering_is_the_cpu_lookup() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let queries = anisotropic_queries(10_000);
    for (name, table) in all_tables() {
        let error = largest_error(&table, &queries, &on_gpu(&gpu, &table, &queries));
        println!("anisotropic, {name}: largest error {error:.2e}");
        assert!(error <= TOLERANCE, "{name}: {error}");
    }
    let (table, queries) = (tables::isotropic(), isotropic_queries(10_000));
    let error = largest_error(&table, &queries, &on_gpu(&gpu, &table, &queries));
    println!("isotropic: largest error {error:.2e}");
    assert!(error <= TOLERANCE, "{error}");
}

#[test]
fn hardware_filtering_is_as_near_as_its_weights_allow() {
    let Some(gpu) = gpu(Filtering::Hardware) else { return };
    let queries = anisotropic_queries(10_000);
    for (name, table) in all_tables() {
        let error = largest_error(&table, &queries, &on_gpu(&gpu, &table, &queries));
        println!("anisotropic, {name}, by hardware: largest error {error:.2e}");
        assert!(error <= HARDWARE_TOLERANCE, "{name}: {error}");
    }
    let (table, queries) = (tables::isotropic(), isotropic_queries(10_000));
    let error = largest_error(&table, &queries, &on_gpu(&gpu, &table, &queries));
    println!("isotropic, by hardware: largest error {error:.2e}");
    assert!(error <= HARDWARE_TOLERANCE, "{error}");
}

/// The query whose λ is the nearest node of `nodes` evenly spaced ones along its axis; φ as it is for the table's quadrant.
fn with_nearest_lambda(table: &Table, nodes: usize, query: &Query) -> Query {
    let [.., axis] = table.axes() else { panic!("no axes") };
    let [low, high] = axis.domain.map(|x| axis.mapping.coordinate(x));
    let (larger, smaller) = (query.alpha_x.max(query.alpha_y), query.alpha_x.min(query.alpha_y));
    let cells = (nodes - 1) as f64;
    let place = (axis.mapping.coordinate(smaller / larger) - low) / (high - low) * cells;
    let nearest = larger * axis.mapping.value(low + place.round().clamp(0.0, cells) / cells * (high - low));
    if query.alpha_x < query.alpha_y {
        Query { alpha_x: nearest, ..*query }
    } else {
        Query { alpha_y: nearest, ..*query }
    }
}

#[test]
fn a_refined_table_is_the_table_at_the_nearest_lambda() {
    let Some(gpu) = gpu(Filtering::Refined) else { return };
    // Widths so small that the table's own clamp of α decides are left to the other tests: λ is of what is clamped.
    let wide = |q: &Query| q.alpha_x.min(q.alpha_y) > 0.01;
    let queries: Vec<Query> = anisotropic_queries(10_000).into_iter().filter(wide).collect();
    for (name, table) in all_tables() {
        let cells = table.shape()[3] - 1;
        let results = on_gpu(&gpu, &table, &queries);
        let nearest: Vec<Query> =
            queries.iter().map(|q| with_nearest_lambda(&table, 16 * cells + 1, q)).collect();
        // Half way between two nodes, rounding decides which it is.
        let off = queries.iter().zip(&nearest).zip(&results).filter(|((query, nearest), result)| {
            let at = |q: &Query| largest_error(&table, &[*q], std::slice::from_ref(result));
            at(nearest) > HARDWARE_TOLERANCE && at(query) > HARDWARE_TOLERANCE
        });
        let off = off.count();
        println!("anisotropic, {name}, refined: {off} of {} off", queries.len());
        assert!(off <= queries.len() / 1000, "{name}: {off}");
        // The control: it is not the table at λ itself, where that changes along λ.
        assert!(largest_error(&table, &queries, &results) > 1e-3, "{name}");
    }
    let (table, queries) = (tables::isotropic(), isotropic_queries(1000));
    assert!(largest_error(&table, &queries, &on_gpu(&gpu, &table, &queries)) <= HARDWARE_TOLERANCE);
}

#[test]
fn a_table_of_another_layout_is_refused() {
    let Some(refined) = gpu(Filtering::Refined) else { return };
    let table = tables::anisotropic(Mapping::Linear, Mapping::Linear);
    let query = Query { theta: 0.3, phi: 0.1, alpha_x: 0.5, alpha_y: 0.2 };
    let other = refined.with_tables(Filtering::Hardware, refined.texels()).unwrap();
    for (of, by) in [(&refined, &other), (&other, &refined)] {
        let textures = TableTextures::upload(of, &table).unwrap();
        let error = Lookups::new(by).unwrap().lookup(by, &textures, &[query]).unwrap_err();
        assert!(matches!(error, GpuError::OtherFiltering), "{error}");
    }
}

#[test]
fn a_wrong_fold_is_seen() {
    // The control: without the folds of phi and alpha the results would be those of other queries.
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let table = tables::anisotropic(Mapping::Linear, Mapping::Linear);
    let query = Query { theta: 0.9, phi: 0.4, alpha_x: 0.5, alpha_y: 0.2 };
    let mistakes = [
        Query { phi: -0.4, ..query },
        Query { phi: PI - 0.4, ..query },
        Query { phi: PI + 0.4, ..query },
        Query { alpha_x: 0.2, alpha_y: 0.5, ..query },
    ];
    let results = on_gpu(&gpu, &table, &[query; 4]);
    for (mistake, result) in mistakes.iter().zip(results) {
        assert!(largest_error(&table, &[*mistake], &[result]) > 1e3 * TOLERANCE, "{mistake:?}");
    }
}

#[test]
fn a_closed_form_that_is_left_out_is_seen() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let queries = anisotropic_queries(1000);
    let plain = tables::anisotropic(Mapping::Linear, Mapping::Sqrt);
    let results = on_gpu(&gpu, &plain, &queries);
    assert!(largest_error(&with_closed_form(plain), &queries, &results) > 1e3 * TOLERANCE);
}

#[test]
fn invalid_queries_are_refused_by_index() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let lookups = Lookups::new(&gpu).unwrap();
    let good = Query { theta: 0.3, phi: 0.1, alpha_x: 0.5, alpha_y: 0.5 };
    let flat = TableTextures::upload(&gpu, &tables::isotropic()).unwrap();
    for bad in [
        Query { theta: f64::NAN, ..good },
        Query { theta: 2.0, ..good },
        Query { phi: f64::INFINITY, ..good },
        Query { alpha_x: 1.5, ..good },
    ] {
        let error = lookups.lookup(&gpu, &flat, &[good, bad]).unwrap_err();
        assert!(matches!(error, GpuError::Input { item: "query", index: 1, .. }), "{error}");
    }
    let stretched = Query { alpha_y: 0.4, ..good };
    let error = lookups.lookup(&gpu, &flat, &[stretched]).unwrap_err();
    assert!(matches!(error, GpuError::NotIsotropic { index: 0, .. }), "{error}");
    assert!(lookups.lookup(&gpu, &flat, &[]).unwrap().is_empty());
}

/// Widths of slices, also equal ones, thin ones and those whose larger one lies along y.
fn widths() -> Vec<Alpha> {
    [(0.5, 0.5), (0.8, 0.1), (0.1, 0.8), (0.33, 0.3), (0.02, 0.6), (1.0, 1.0), (0.0, 0.7)]
        .map(|(x, y): (f32, f32)| Alpha::new(f64::from(x), f64::from(y)).unwrap())
        .to_vec()
}

/// Views of the lookup tests, each with one of the slices, and the same as queries of the table.
fn baked_queries(count: usize) -> (Vec<BakedQuery>, Vec<Query>) {
    let widths = widths();
    let pair = |(k, query): (usize, Query)| {
        let slice = k % widths.len();
        let (alpha_x, alpha_y) = (widths[slice].x(), widths[slice].y());
        let baked = BakedQuery { slice: slice as u32, theta: query.theta, phi: query.phi };
        (baked, Query { alpha_x, alpha_y, ..query })
    };
    anisotropic_queries(count).into_iter().enumerate().map(pair).unzip()
}

#[test]
fn slices_are_the_table() {
    for (filtering, tolerance) in [
        (Filtering::Exact, TOLERANCE),
        (Filtering::Buffer, TOLERANCE),
        (Filtering::Hardware, HARDWARE_TOLERANCE),
    ] {
        let Some(gpu) = gpu(filtering) else { continue };
        let lookups = BakedLookups::new(&gpu).unwrap();
        let (baked, queries) = baked_queries(10_000);
        for (name, table) in all_tables() {
            let slices = BakedSlices::bake(&gpu, &table, &widths()).unwrap();
            let found = lookups.lookup(&gpu, &slices, &baked).unwrap();
            let error = largest_error(&table, &queries, &found);
            println!("baked, {filtering:?}, {name}: largest error {error:.2e}");
            assert!(error <= tolerance, "{filtering:?}, {name}: {error}");
            // The control: a slice is not its neighbour.
            let turned: Vec<_> =
                baked.iter().map(|q| BakedQuery { slice: (q.slice + 1) % 7, ..*q }).collect();
            let found = lookups.lookup(&gpu, &slices, &turned).unwrap();
            assert!(largest_error(&table, &queries, &found) > 10.0 * tolerance, "{name}");
        }
    }
}

#[test]
fn slices_that_are_not_there_are_refused() {
    let Some(gpu) = gpu(Filtering::Exact) else { return };
    let error = BakedSlices::bake(&gpu, &tables::isotropic(), &widths()).unwrap_err();
    assert!(matches!(error, GpuError::NotAnisotropic), "{error}");
    let table = tables::anisotropic(Mapping::Linear, Mapping::Linear);
    let too_many = vec![widths()[0]; BakedSlices::most(&gpu) + 1];
    let error = BakedSlices::bake(&gpu, &table, &too_many).unwrap_err();
    assert!(matches!(error, GpuError::TableTooLarge { what: "depth", .. }), "{error}");
    let lookups = BakedLookups::new(&gpu).unwrap();
    let none = BakedSlices::bake(&gpu, &table, &[]).unwrap();
    assert!(none.is_empty() && lookups.lookup(&gpu, &none, &[]).unwrap().is_empty());
    let some = BakedSlices::bake(&gpu, &table, &widths()).unwrap();
    assert_eq!(some.len(), widths().len());
    let good = BakedQuery { slice: 6, theta: 0.3, phi: 0.1 };
    for (slices, query) in
        [(&none, BakedQuery { slice: 0, ..good }), (&some, BakedQuery { slice: 7, ..good })]
    {
        let error = lookups.lookup(&gpu, slices, &[query]).unwrap_err();
        assert!(matches!(error, GpuError::WrongSlice { item: "query", index: 0, .. }), "{error}");
    }
    let error = lookups.lookup(&gpu, &some, &[good, BakedQuery { theta: f64::NAN, ..good }]).unwrap_err();
    assert!(matches!(error, GpuError::Input { item: "query", index: 1, .. }), "{error}");
}
