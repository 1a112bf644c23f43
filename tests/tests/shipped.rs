//! The shipped tables: their errors, their symmetries, and what every lookup must hold.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};
use ltc_core::points::SplitMix64;
use ltc_core::{Ltc, Matrix};
use ltc_fit::grid_errors::grid_errors;
use ltc_fit::{FitSpec, GgxFamily, draw, verify};
use ltc_table::lookup::{Corner, corners};
use ltc_table::{Lookup, Query, Table, TableVersion, digest::digest};
use ltc_tests::{shipped, table, wide};

const TABLES: [&str; 3] = ["ggx-anisotropic", "ggx-isotropic", "ggx-anisotropic-closed-form"];

/// Mean TV of the published 8⁴ table (KT et al. 2022) on the standard draw.
const PUBLISHED_ANISOTROPIC: f64 = 0.0996;
/// Of the published 64² table (Heitz et al. 2016) on the isotropic draw.
const PUBLISHED_ISOTROPIC: f64 = 0.0599;

#[test]
fn errors_are_below_the_published_tables_and_as_the_manifests_say() {
    let published = [PUBLISHED_ANISOTROPIC, PUBLISHED_ISOTROPIC, PUBLISHED_ANISOTROPIC];
    for (name, published) in TABLES.into_iter().zip(published) {
        let catalogue = shipped();
        let found = verify(catalogue.find(name).unwrap()).unwrap();
        let draw = &found.errors.standard_draw;
        println!("{name}: mean TV {:.4}, p95 {:.4}, max {:.4}", draw.tv_mean, draw.tv_p95, draw.tv_max);
        assert!(found.faults.is_empty(), "{name}: {:?}", found.faults);
        assert!(draw.tv_mean < published && draw.tv_mean > 0.01, "{name}: {}", draw.tv_mean);
        assert!(draw.queries >= 1_500, "{name}: {}", draw.queries);
    }
}

/// The version with these entries instead, its digest made to fit.
fn planted(
    version: &TableVersion,
    change: impl Fn(&mut Vec<DMat3>, &mut Vec<f64>, &mut Vec<f64>),
) -> TableVersion {
    let table = version.table();
    let (mut m, mut magnitude, mut fresnel) =
        (table.m().to_vec(), table.magnitude().to_vec(), table.fresnel().to_vec());
    change(&mut m, &mut magnitude, &mut fresnel);
    let other = Table::new(table.axes().to_vec(), m, magnitude, fresnel, table.cells().clone()).unwrap();
    let other = other.with_closed_form(table.closed_form()).unwrap();
    let payload = TableVersion::payload_of(&other).unwrap();
    let mut manifest = version.manifest().clone();
    manifest.digest = digest(&payload);
    TableVersion::new(manifest, payload).unwrap()
}

#[test]
fn a_planted_entry_is_a_fault() {
    // The control of the test above. An entry amid the table, changed by a thousandth.
    let catalogue = shipped();
    let version = catalogue.find("ggx-anisotropic").unwrap();
    let middle = ((3 * 8 + 4) * 8 + 5) * 8 + 2;
    let faults = |planted: TableVersion| verify(&planted).unwrap().faults;
    assert!(faults(planted(version, |_, _, _| ())).is_empty(), "nothing planted, nothing found");
    let by_matrix = faults(planted(version, |m, _, _| m[middle].x_axis *= 1.001));
    assert!(by_matrix.iter().any(|f| f.starts_with(&format!("cell_tv, entry {middle}"))), "{by_matrix:?}");
    let by_magnitude = faults(planted(version, |_, magnitude, _| magnitude[middle] *= 1.001));
    assert!(by_magnitude.iter().any(|f| f.starts_with("errors.magnitude_mean")), "{by_magnitude:?}");
    let by_fresnel = faults(planted(version, |_, _, fresnel| fresnel[middle] += 1e-3));
    assert!(by_fresnel.iter().any(|f| f.starts_with("errors.fresnel_mean")), "{by_fresnel:?}");
}

#[test]
fn a_planted_entry_is_a_fault_even_where_the_draw_does_not_look() {
    let catalogue = shipped();
    let mut version = catalogue.find("ggx-anisotropic").unwrap().as_ref().clone();
    // As tables have it that are fitted now.
    if version.manifest().errors.grid.is_none() {
        let mut manifest = version.manifest().clone();
        let spec: FitSpec = serde_json::from_value(manifest.fit.clone()).unwrap();
        let grid = grid_errors(&GgxFamily, version.table(), &manifest.floors, spec.measure).unwrap();
        manifest.errors.grid = Some(grid);
        version = TableVersion::new(manifest, version.payload().to_vec()).unwrap();
    }
    let faults = |planted: TableVersion| verify(&planted).unwrap().faults;
    assert!(faults(version.clone()).is_empty());
    // θ = 90°, amid the other axes.
    let grazing = ((7 * 8 + 4) * 8 + 5) * 8 + 2;
    let found_by = |planted: TableVersion, figure: &str| {
        let found = faults(planted);
        assert!(found.iter().any(|fault| fault.starts_with(figure)), "{figure}: {found:?}");
    };
    // A scale changes no lobe at the entry, and those between it and its neighbours only a little.
    found_by(planted(&version, |m, _, _| m[grazing] *= 1.0001), "errors.grid.step_mean");
    found_by(planted(&version, |m, _, _| m[grazing] *= 1.01), "errors.grid.centre_tv_mean");
    found_by(planted(&version, |m, _, _| m[grazing].x_axis.z += 1e-4), "cell_condition, entry");
    found_by(planted(&version, |_, magnitude, _| magnitude[grazing] *= 1.0001), "errors.grid.node_magnitude");
    found_by(planted(&version, |_, _, fresnel| fresnel[grazing] *= 1.0001), "errors.grid.node_fresnel");
}

/// What is wrong with an answer, if anything.
fn fault(lookup: &Lookup) -> Option<&'static str> {
    let m = DMat3::from_row_array(lookup.lobes[0].m);
    if !(m.is_finite() && m.determinant() > 0.0) {
        return Some("det M");
    }
    if !(0.0..=1.0).contains(&lookup.magnitude) {
        return Some("magnitude");
    }
    if !(0.0..=1.0).contains(&lookup.fresnel) || lookup.fresnel > lookup.magnitude {
        return Some("fresnel");
    }
    None
}

/// The queries whose answers have a fault, with that fault.
fn faulty(table: &Table, queries: &[Query]) -> Vec<(Query, &'static str)> {
    let check = |query: &Query| fault(&table.lookup(query).unwrap()).map(|fault| (*query, fault));
    queries.iter().filter_map(check).collect()
}

#[test]
fn a_million_lookups_are_sound() {
    let mut found = Vec::new();
    for name in TABLES {
        let (table, isotropic) = (table(name), name == "ggx-isotropic");
        let lambda = |smallest| if isotropic { 1.0 } else { smallest };
        for (domain, queries) in [
            ("the standard draw", draw::standard(200_000, 8, isotropic)),
            ("the fitted domain", wide(150_000, lambda(0.02), 89.5_f64.to_radians(), 9)),
            ("the whole domain", wide(150_000, lambda(0.0), FRAC_PI_2, 10)),
        ] {
            let faults = faulty(&table, &queries);
            for what in ["det M", "magnitude", "fresnel"] {
                let mut of_kind = faults.iter().filter(|(_, fault)| *fault == what);
                let Some((first, _)) = of_kind.next() else { continue };
                let count = 1 + of_kind.count();
                found.push(format!(
                    "{name}, {domain}: {count} of {} have a wrong {what}: {first:?}",
                    queries.len()
                ));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn faults_of_lookups_are_noticed() {
    let good = table("ggx-anisotropic").lookup(&wide(1, 0.1, 1.0, 9)[0]).unwrap();
    assert_eq!(fault(&good), None);
    let mut flipped = good.clone();
    flipped.lobes[0].m[..3].iter_mut().for_each(|x| *x = -*x);
    assert_eq!(fault(&flipped), Some("det M"));
    assert_eq!(fault(&Lookup { magnitude: 1.01, ..good.clone() }), Some("magnitude"));
    assert_eq!(fault(&Lookup { fresnel: good.magnitude + 0.01, ..good.clone() }), Some("fresnel"));
    assert_eq!(fault(&Lookup { magnitude: f64::NAN, ..good }), Some("magnitude"));
}

#[test]
fn no_lookup_of_the_standard_draw_needs_the_nearest_entry() {
    // Where interpolation comes to det M ≤ 0 the nearest entry answers, and whoever interpolates an exported table by himself
    // has nothing of the kind. It must not come up where the table's errors are stated.
    let raw = |table: &Table, query: &Query| -> DMat3 {
        let q = query.fold().unwrap();
        let sum =
            |corners: &mut dyn Iterator<Item = Corner>| corners.map(|c| table.m()[c.index] * c.weight).sum();
        match table.axes().len() {
            2 => sum(&mut corners(table.axes(), [q.theta, q.alpha])),
            _ => sum(&mut corners(table.axes(), [q.theta, q.phi, q.alpha, q.lambda])),
        }
    };
    for name in TABLES {
        let (table, isotropic) = (table(name), name == "ggx-isotropic");
        let flat = |queries: &[Query]| queries.iter().filter(|q| raw(&table, q).determinant() <= 0.0).count();
        assert_eq!(flat(&draw::standard(200_000, 8, isotropic)), 0, "{name}");
        let beyond = wide(200_000, if isotropic { 1.0 } else { 0.02 }, 89.5_f64.to_radians(), 9);
        println!("{name}: {} of 200000 beyond the draw take the nearest entry", flat(&beyond));
    }
}

#[test]
fn entries_are_sound() {
    for name in TABLES {
        let table = table(name);
        for (i, m) in table.m().iter().enumerate() {
            assert!(m.is_finite() && m.determinant() > 0.0, "{name}, entry {i}: {m}");
            let (n, f) = (table.magnitude()[i], table.fresnel()[i]);
            // Between a closed form and lookups that are clamped, an entry may be a little more than there is.
            let most = if table.closed_form().is_some() { 1.02 } else { 1.0 };
            assert!((0.0..=most).contains(&n) && (0.0..=n).contains(&f), "{name}, entry {i}: {n} {f}");
        }
    }
}

/// The largest relative difference of two lobes' densities, the second's direction mapped by `to_second`, where either is
/// more than a thousandth of the peak.
fn difference(first: &Lookup, second: &Lookup, to_second: impl Fn(DVec3) -> DVec3) -> f64 {
    let ltc = |lookup: &Lookup| Ltc::<f64>::new(DMat3::from_row_array(lookup.lobes[0].m)).unwrap();
    let (a, b) = (ltc(first), ltc(second));
    let peak = a.density(a.median());
    let mut largest = (first.magnitude - second.magnitude).abs().max((first.fresnel - second.fresnel).abs());
    for i in 0..16 {
        let w = a.sample(ltc_core::points::r2(i, [0.5, 0.5]));
        let (p, q) = (a.density(w), b.density(to_second(w)));
        if p.max(q) > 1e-3 * peak {
            largest = largest.max((p - q).abs() / p.max(q));
        }
    }
    largest
}

/// Rounding of φ, and of a few products.
const SYMMETRIC: f64 = 1e-9;

#[test]
fn mirrored_views_and_exchanged_widths_have_mirrored_lobes() {
    let table = table("ggx-anisotropic");
    let mut control = 0.0_f64;
    for query in draw::standard(2_000, 51, false) {
        let Query { phi, alpha_x, alpha_y, .. } = query;
        let at = |query: &Query| table.lookup(query).unwrap();
        let here = at(&query);
        let to_phi = |phi| at(&Query { phi, ..query });
        let exchanged = at(&Query { phi: FRAC_PI_2 - phi, alpha_x: alpha_y, alpha_y: alpha_x, ..query });
        for (what, d) in [
            ("y mirrored", difference(&here, &to_phi(-phi), |w| DVec3::new(w.x, -w.y, w.z))),
            ("x mirrored", difference(&here, &to_phi(PI - phi), |w| DVec3::new(-w.x, w.y, w.z))),
            ("half a turn", difference(&here, &to_phi(phi + PI), |w| DVec3::new(-w.x, -w.y, w.z))),
            ("a whole turn", difference(&here, &to_phi(phi - TAU), |w| w)),
            ("exchanged", difference(&here, &exchanged, |w| DVec3::new(w.y, w.x, w.z))),
        ] {
            assert!(d < SYMMETRIC, "{what}: {d:e} at {query:?}");
        }
        control = control.max(difference(&here, &to_phi(-phi), |w| w));
    }
    assert!(control > 0.5, "a forgotten mirror would pass: {control}");
}

#[test]
fn round_lobes_turn_with_the_view() {
    let turned = |angle: f64| move |w: DVec3| DMat3::from_rotation_z(angle) * w;
    let mut rng = SplitMix64::new(52);
    let (isotropic, anisotropic) = (table("ggx-isotropic"), table("ggx-anisotropic"));
    let phi_axis = anisotropic.axes()[1].nodes();
    let mut control = 0.0_f64;
    for query in draw::standard(300, 53, true) {
        let at = |table: &Table, phi| table.lookup(&Query { phi, ..query }).unwrap();
        let phi = rng.range(0.0, TAU);
        let d = difference(&at(&isotropic, 0.0), &at(&isotropic, phi), turned(phi));
        assert!(d < SYMMETRIC, "isotropic: {d:e} at {query:?}, {phi}");
        // At λ = 1 the anisotropic table's entries are turned copies of those at φ = 0; between them they are blended.
        let node = phi_axis[(rng.unit() * phi_axis.len() as f64) as usize];
        let d = difference(&at(&anisotropic, 0.0), &at(&anisotropic, node), turned(node));
        assert!(d < SYMMETRIC, "anisotropic: {d:e} at {query:?}, {node}");
        control = control.max(difference(&at(&isotropic, 0.0), &at(&isotropic, phi), |w| w));
    }
    assert!(control > 0.5, "a forgotten turn would pass: {control}");
}

#[test]
fn nodes_on_planes_of_symmetry_have_exact_zeros() {
    let table = table("ggx-anisotropic");
    let mut general = 0;
    for (i, m) in table.m().iter().enumerate() {
        let nodes = table.nodes_of(i);
        let (theta, phi) = (nodes[0].1, nodes[1].1);
        let rows = m.to_row_array();
        let zero = |places: &[usize]| places.iter().all(|k| rows[*k] == 0.0);
        if theta == 0.0 && nodes[3].1 < 1.0 {
            assert!(zero(&[1, 2, 3, 5, 6, 7]), "entry {i}, from above: {rows:?}");
        } else if phi == 0.0 {
            assert!(zero(&[1, 3, 5, 7]), "entry {i}, the lobe mirrors in y: {rows:?}");
        } else if phi == FRAC_PI_2 && nodes[3].1 < 1.0 {
            assert!(zero(&[1, 2, 3, 6]), "entry {i}, the lobe mirrors in x: {rows:?}");
        } else if nodes[3].1 < 1.0 {
            general += usize::from(rows.iter().all(|x| *x != 0.0));
        }
    }
    assert!(general > 1_000, "elsewhere nothing is zero: {general}");
    for (i, m) in self::table("ggx-isotropic").m().iter().enumerate() {
        let rows = m.to_row_array();
        assert!([1, 3, 5, 7].iter().all(|k| rows[*k] == 0.0), "isotropic entry {i}: {rows:?}");
    }
}

#[test]
fn what_is_outside_the_domain_is_refused() {
    let good = Query { theta: 0.5, phi: 0.1, alpha_x: 0.3, alpha_y: 0.3 };
    for name in TABLES {
        let table = table(name);
        assert!(table.lookup(&good).is_ok());
        for bad in [f64::NAN, f64::INFINITY, -0.1, 1.8] {
            let message = |query: Query| table.lookup(&query).unwrap_err().to_string();
            assert!(message(Query { theta: bad, ..good }).starts_with("theta is"), "{name} {bad}");
            assert!(message(Query { alpha_x: bad, ..good }).starts_with("alpha_x is"), "{name} {bad}");
            assert!(message(Query { alpha_y: bad, ..good }).starts_with("alpha_y is"), "{name} {bad}");
            assert_eq!(table.lookup(&Query { phi: bad, ..good }).is_err(), !bad.is_finite(), "{name} {bad}");
        }
    }
    let split = Query { alpha_y: 0.2, ..good };
    let reason = table("ggx-isotropic").lookup(&split).unwrap_err().to_string();
    assert!(reason.contains("must be equal"), "{reason}");
}
