//! Gauge and symmetry of what is fitted and of what is shipped (2022 paper, §5 and 6).

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use core::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};
use ltc_core::{Alpha, Ltc, points::r2};
use ltc_fit::{
    Brdf, DiskPoints, EntryFit, GgxFamily, Lattice, Lobe, Objective, Pattern, direction,
    entries::{EntrySettings, fit_entries},
    fit_entry, gauge, silent,
};
use ltc_table::{Axis, Floors, Mapping, Quantity, Table};

fn lobe(theta: f64, phi: f64, ax: f64, ay: f64) -> (Lobe, DVec3) {
    let (mut lobe, wo) = (Lobe::default(), direction(theta, phi));
    let points = DiskPoints::new(2048, [0.5, 0.5]);
    GgxFamily.sample_lobe(wo, Alpha::new(ax, ay).unwrap(), &points, &mut lobe);
    (lobe, wo)
}

/// Fitted with no symmetry imposed.
fn free(theta: f64, phi: f64, ax: f64, ay: f64) -> EntryFit {
    let (lobe, wo) = lobe(theta, phi, ax, ay);
    fit_entry(&lobe, wo, Pattern::General, 300)
}

fn axes() -> Vec<Axis> {
    let lengths = [(Quantity::Theta, 4), (Quantity::Phi, 4), (Quantity::Alpha, 3), (Quantity::Lambda, 3)];
    lengths.map(|(quantity, len)| Axis::full(quantity, Mapping::Linear, len)).to_vec()
}

/// A small table, each entry fitted by itself.
fn fitted() -> (Lattice, Vec<DMat3>) {
    let (axes, floors) = (axes(), Floors { alpha: 1e-3, lambda: 0.03, theta_max: 1.56 });
    let lattice = Lattice::new(&axes, &floors);
    let settings = EntrySettings::new(256, 60);
    let objective = Objective::TotalVariation;
    let m = fit_entries(&GgxFamily, &axes, &lattice, objective, settings, &silent).unwrap();
    (lattice, m)
}

fn shipped(name: &str) -> Table {
    ltc_tables::shipped().unwrap().find(name).unwrap().table().clone()
}

/// Eq. 12: the mean squared distance between cosine samples and where `M` takes them.
fn misalignment(m: DMat3) -> f64 {
    const N: usize = 1000;
    let cosine = |i| Ltc::<f64>::cosine().sample(r2(i, [0.5, 0.5]));
    let moved = |w: DVec3| (m * w).try_normalize().unwrap_or(w);
    (0..N).map(cosine).map(|w| (moved(w) - w).length_squared()).sum::<f64>() / N as f64
}

/// The minimum and the maximum of eq. 12 over all turns and flips, by the paper's linear search.
fn searched(m: DMat3) -> (f64, f64) {
    let flips = [DVec3::new(1.0, 1.0, 1.0), DVec3::new(-1.0, 1.0, 1.0)];
    let candidates = flips.into_iter().flat_map(|flip| {
        (0..180).map(move |k| DMat3::from_rotation_z(PI * f64::from(k) / 90.0) * DMat3::from_diagonal(flip))
    });
    candidates
        .map(|turn| misalignment(m * turn))
        .fold((f64::INFINITY, 0.0), |(low, high), x| (low.min(x), high.max(x)))
}

#[test]
fn the_closed_form_of_alignment_minimises_equation_12() {
    // It maximises tr(M R_z), which is eq. 12 without the normalisation of M ω: close to the same turn, at a cost that is
    // nowhere more than a fiftieth of what turns can make of it.
    let cases = [(0.5, 0.7, 0.5, 0.2), (1.0, 0.3, 0.3, 0.1), (1.3, 1.0, 0.8, 0.3), (1.5, 0.8, 0.2, 0.05)];
    for (theta, phi, ax, ay) in cases {
        let m = free(theta, phi, ax, ay).m;
        assert!(gauge::aligned(m).abs_diff_eq(m, 1e-12), "fits come aligned");
        let (best, worst) = searched(m);
        let excess = (misalignment(m) - best) / (worst - best);
        assert!(excess < 0.02, "θ {theta} φ {phi} α {ax} {ay}: {excess}");
        // The control: a wrong turn is seen.
        let off = (misalignment(m * DMat3::from_rotation_z(0.7)) - best) / (worst - best);
        assert!(off > 0.04, "θ {theta} φ {phi} α {ax} {ay}: {off}");
    }
}

#[test]
fn mirrored_lobes_have_the_zeros_of_equation_16_unasked() {
    // Fitted with all seven degrees of freedom, on planes of symmetry.
    for (theta, phi, zero) in [(0.9, 0.0, [1, 3, 5, 7]), (0.9, FRAC_PI_2, [1, 2, 3, 6])] {
        for (ax, ay) in [(0.5, 0.2), (0.3, 0.1), (0.1, 0.1)] {
            let free = free(theta, phi, ax, ay);
            let rows = free.m.transpose().to_cols_array();
            let widest = rows[0].abs().max(rows[4].abs());
            for k in zero {
                assert!(rows[k].abs() < 0.05 * widest, "φ {phi} α {ax} {ay}, entry {k}: {rows:?}");
            }
            // And imposing them costs nothing.
            let pattern = if phi == 0.0 { Pattern::MirrorY } else { Pattern::MirrorX };
            let (lobe, wo) = lobe(theta, phi, ax, ay);
            let imposed = fit_entry(&lobe, wo, pattern, 300);
            assert!((imposed.tv - free.tv).abs() < 1e-3, "{} {}", imposed.tv, free.tv);
        }
    }
}

#[test]
fn fits_from_above_do_not_depend_on_phi_unasked() {
    for (ax, ay) in [(0.5, 0.2), (0.1, 0.1)] {
        let rows = [0.0, 0.8, 2.0].map(|phi| free(0.0, phi, ax, ay).m.transpose().to_cols_array());
        for other in &rows[1..] {
            for k in 0..9 {
                assert!((other[k] - rows[0][k]).abs() < 0.02 * ax, "α {ax} {ay}: {rows:?}");
            }
        }
        for k in [1, 2, 3, 5, 6, 7] {
            assert!(rows[0][k].abs() < 0.02 * ax, "α {ax} {ay}: {rows:?}");
        }
    }
}

#[test]
fn round_lobes_turn_with_the_view_unasked() {
    // M(φ) = R_z(φ) M(0) R_z(−φ) at λ = 1: alignment commutes with turning the frame.
    for (theta, alpha) in [(0.4, 0.5), (0.9, 0.2), (1.3, 0.4), (1.0, 0.05)] {
        let upright = free(theta, 0.0, alpha, alpha).m;
        for phi in [0.5, 1.1, 2.9] {
            let turn = DMat3::from_rotation_z(phi);
            let back = turn.transpose() * free(theta, phi, alpha, alpha).m * turn;
            assert!(back.abs_diff_eq(upright, 0.03 * alpha), "θ {theta} α {alpha} φ {phi}: {back} {upright}");
        }
    }
}

/// What must hold of every table: `tables` checks it, and this one can be told from it.
fn faults(axes: &[Axis], m: &[DMat3]) -> Vec<String> {
    let lattice = Lattice::new(axes, &Floors { alpha: 0.0, lambda: 0.0, theta_max: FRAC_PI_2 });
    let mut faults = Vec::new();
    for (i, (tie, matrix)) in lattice.ties.iter().zip(m).enumerate() {
        if !(matrix.is_finite() && matrix.determinant() > 0.0) {
            faults.push(format!("entry {i}: det M = {}", matrix.determinant()));
        }
        // Zeros and equalities of eq. 16, exactly.
        if tie.owner == i && tie.pattern.project(*matrix) != *matrix {
            faults.push(format!("entry {i} is not of its pattern {:?}", tie.pattern));
        }
        // Entries seen from above are equal for all φ; those of λ = 1 are turned copies.
        if !tie.follow(m[tie.owner]).abs_diff_eq(*matrix, 1e-14) {
            faults.push(format!("entry {i} does not follow entry {}", tie.owner));
        }
    }
    faults
}

#[test]
fn fitted_tables_keep_equation_16_and_det_above_0() {
    let (_, m) = fitted();
    assert_eq!(faults(&axes(), &m), [""; 0]);
}

#[test]
fn shipped_tables_keep_equation_16_and_det_above_0() {
    for name in ["ggx-isotropic", "ggx-anisotropic"] {
        let table = shipped(name);
        assert_eq!(faults(table.axes(), table.m()), [""; 0], "{name}");
    }
}

#[test]
fn planted_faults_of_tables_are_seen() {
    let (lattice, m) = fitted();
    let planted = |index: usize, change: fn(&mut DMat3)| {
        let mut m = m.clone();
        change(&mut m[index]);
        faults(&axes(), &m).join("; ")
    };
    let find = |pattern: Pattern| (0..m.len()).rev().find(|i| lattice.ties[*i].pattern == pattern).unwrap();
    let general = find(Pattern::General);
    let says = |fault: String, what: &str| assert!(fault.contains(what), "{fault}");
    says(planted(general, |m| m.y_axis = -m.y_axis), "det M");
    says(planted(general, |m| *m = DMat3::NAN), "det M");
    let owner =
        (0..m.len()).find(|i| lattice.ties[*i].owner == *i && lattice.ties[*i].pattern == Pattern::MirrorX);
    says(planted(owner.unwrap(), |m| m.x_axis.y += 1e-9), "pattern MirrorX");
    let follower = (0..m.len()).find(|i| lattice.ties[*i].owner != *i).unwrap();
    says(planted(follower, |m| m.x_axis *= 1.001), "does not follow");
}
