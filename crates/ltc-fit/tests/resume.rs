//! A fit that is interrupted, however often and whenever, ends with the table of one that is not.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

use std::cell::RefCell;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use ltc_core::points::SplitMix64;
use ltc_fit::checkpoint::{self, Checkpoints, Folder, Notice, Store};
use ltc_fit::{FitError, FitRun, FitSpec, FitState, Fitted, Plan, silent};
use ltc_table::{Axis, Mapping, Quantity, TableError, TableVersion, digest::digest};

/// A table of a few entries, every stage of the fit included, quick enough to be fitted a hundred times.
fn small() -> FitSpec {
    let mut spec = FitSpec::preset("ggx-anisotropic").unwrap();
    spec.name = "small".to_owned();
    let lengths = [(Quantity::Theta, 4), (Quantity::Phi, 3), (Quantity::Alpha, 3), (Quantity::Lambda, 3)];
    spec.axes = lengths.map(|(quantity, len)| Axis::full(quantity, Mapping::Linear, len)).to_vec();
    (spec.entries.samples, spec.entries.iterations) = (64, 10);
    (spec.joint.steps, spec.joint.queries, spec.joint.samples) = (20, 64, 32);
    (spec.channels.samples, spec.channels.queries) = (256, 100);
    (spec.measure.samples, spec.measure.queries) = (256, 100);
    spec
}

fn plan() -> Plan<'static> {
    Plan::new(small()).unwrap()
}

/// The digest of the table, and all that is known of it.
fn essence(fitted: &Fitted) -> (String, String) {
    let payload = TableVersion::payload_of(&fitted.table).unwrap();
    (digest(&payload), format!("{:?} {:?}", fitted.errors, fitted.entries))
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// The fit in one go, piece by piece.
fn uninterrupted() -> (String, String) {
    let plan = plan();
    let mut run = FitRun::new(&plan);
    while run.advance(&silent).unwrap() {}
    essence(&run.finish().unwrap())
}

/// A store in memory that loses some of what it is given, as a kill before the next write does.
#[derive(Default)]
struct Memory {
    kept: Mutex<Option<Vec<u8>>>,
    lose: Mutex<Option<SplitMix64>>,
}

impl Store for Memory {
    fn load(&self) -> Result<Option<Vec<u8>>, TableError> {
        Ok(self.kept.lock().unwrap().clone())
    }

    fn save(&self, bytes: &[u8]) -> Result<(), TableError> {
        let lost = self.lose.lock().unwrap().as_mut().is_some_and(|rng| rng.unit() < 0.5);
        if !lost {
            *self.kept.lock().unwrap() = Some(bytes.to_vec());
        }
        Ok(())
    }

    fn clear(&self) -> Result<(), TableError> {
        *self.kept.lock().unwrap() = None;
        Ok(())
    }
}

fn keep(store: &dyn Store) -> Checkpoints<'_> {
    Checkpoints { store, program: "test", every: Duration::ZERO }
}

#[test]
fn interruptions_change_nothing_on_any_number_of_threads() {
    let expected = uninterrupted();
    let mut rng = SplitMix64::new(11);
    for threads in [1, 2, 4] {
        let store = Memory::default();
        *store.lose.lock().unwrap() = Some(SplitMix64::new(threads as u64));
        let mut interruptions = 0;
        let fitted = loop {
            // Reports come for each of 70 entries, 20 steps and 5 later pieces.
            let reports_left = AtomicUsize::new((rng.unit() * 90.0) as usize);
            let observer = |_| {
                let counted =
                    reports_left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
                counted.is_ok()
            };
            let attempt = on_threads(threads, || checkpoint::fit(&plan(), &keep(&store), &observer, &|_| ()));
            match attempt {
                Ok(fitted) => break fitted,
                Err(FitError::Stopped) => interruptions += 1,
                Err(other) => panic!("{other}"),
            }
            assert!(interruptions < 500, "it gets nowhere");
        };
        assert_eq!(essence(&fitted), expected, "{threads} threads, {interruptions} interruptions");
        assert!(interruptions > 0, "nothing was tested");
    }
}

#[test]
fn a_run_goes_on_from_every_piece() {
    let expected = uninterrupted();
    let plan = plan();
    let mut run = FitRun::new(&plan);
    let mut pieces = 0;
    loop {
        // Written down and read back between any two pieces.
        let text = serde_json::to_string(&run.state()).unwrap();
        let state: FitState = serde_json::from_str(&text).unwrap();
        assert_eq!(state, run.state());
        run = FitRun::resume(&plan, state).unwrap();
        if !run.advance(&silent).unwrap() {
            break;
        }
        pieces += 1;
    }
    assert!(pieces > 20, "{pieces}");
    assert_eq!(essence(&run.finish().unwrap()), expected);
}

#[test]
fn a_run_goes_on_within_the_stages_that_evaluate_one_by_one() {
    let mut spec = small();
    // So many samples that a piece is a few dozen evaluations.
    (spec.channels.samples, spec.measure.samples) = (1 << 16, 1 << 16);
    let plan = Plan::new(spec).unwrap();
    let fit = |cut: bool| {
        let mut run = FitRun::new(&plan);
        let mut within = [0, 0];
        while run.advance(&silent).unwrap() {
            let state = run.state();
            if !state.evaluated.is_empty() {
                within[usize::from(state.channels.is_some())] += 1;
            }
            if cut {
                let text = serde_json::to_string(&state).unwrap();
                run = FitRun::resume(&plan, serde_json::from_str(&text).unwrap()).unwrap();
            }
            let mut odd = run.state();
            odd.evaluated.extend(vec![[0.0; 3]; 100_000]);
            assert!(matches!(FitRun::resume(&plan, odd), Err(FitError::State { .. })));
        }
        assert!(within[0] > 1 && within[1] > 1, "{within:?}");
        essence(&run.finish().unwrap())
    };
    assert_eq!(fit(true), fit(false));
    // The control: what was evaluated matters.
    let mut run = FitRun::new(&plan);
    while run.state().channels.is_none() || run.state().evaluated.is_empty() {
        run.advance(&silent).unwrap();
    }
    let mut state = run.state();
    state.evaluated[0][0] += 0.1;
    let mut run = FitRun::resume(&plan, state).unwrap();
    while run.advance(&silent).unwrap() {}
    assert_ne!(essence(&run.finish().unwrap()), fit(false));
}

#[test]
fn a_step_that_is_forgotten_is_seen() {
    // The control: the state matters.
    let plan = plan();
    let mut run = FitRun::new(&plan);
    while run.state().joint.is_none_or(|joint| joint.steps < 10) {
        run.advance(&silent).unwrap();
    }
    let mut state = run.state();
    state.joint.as_mut().unwrap().mean[3] = [0.0; 9];
    let mut run = FitRun::resume(&plan, state).unwrap();
    while run.advance(&silent).unwrap() {}
    assert_ne!(essence(&run.finish().unwrap()).0, uninterrupted().0);
}

#[test]
fn states_of_other_tables_are_refused() {
    let (plan, mut spec) = (plan(), small());
    let resized = |alpha| {
        spec.axes[2].len = alpha;
        Plan::new(spec.clone()).unwrap()
    };
    let [smaller, larger] = [2, 4].map(resized);
    let mut run = FitRun::new(&plan);
    while run.stage() != Some("measurement") {
        run.advance(&silent).unwrap();
        let under_way = run.state().joint.is_some() || !run.state().m.is_empty();
        for other in [&smaller, &larger].into_iter().filter(|_| under_way) {
            assert!(matches!(FitRun::resume(other, run.state()), Err(FitError::State { .. })));
        }
    }
    let good = run.state();
    type Spoil = fn(&mut FitState);
    let spoils: [Spoil; 5] = [
        |s| s.m.truncate(1),
        |s| s.entries.truncate(1),
        |s| s.entries.push(s.entries[0]),
        |s| s.channels.as_mut().unwrap().0.truncate(5),
        |s| s.m.clear(),
    ];
    for spoil in spoils {
        let mut state = good.clone();
        spoil(&mut state);
        assert!(matches!(FitRun::resume(&plan, state), Err(FitError::State { .. })));
    }
    assert!(matches!(FitRun::new(&plan).finish(), Err(FitError::State { .. })));
}

/// Stops a fit in the middle of its joint refinement and gives the checkpoint it left.
fn left_behind() -> Vec<u8> {
    let store = Memory::default();
    let stop = |p: ltc_fit::Progress| p.stage != "joint refinement" || p.done < 10;
    assert!(matches!(checkpoint::fit(&plan(), &keep(&store), &stop, &|_| ()), Err(FitError::Stopped)));
    store.load().unwrap().unwrap()
}

/// Fits from this checkpoint; what was said, and the result.
fn fit_from(bytes: Vec<u8>, program: &str) -> (Vec<Notice>, (String, String)) {
    let store = Memory { kept: Mutex::new(Some(bytes)), ..Memory::default() };
    let notices = RefCell::new(Vec::new());
    let checkpoints = Checkpoints { store: &store, program, every: Duration::ZERO };
    let fitted = checkpoint::fit(&plan(), &checkpoints, &silent, &|notice| notices.borrow_mut().push(notice));
    (notices.into_inner(), essence(&fitted.unwrap()))
}

#[test]
fn damaged_and_foreign_checkpoints_are_ignored() {
    let (expected, good) = (uninterrupted(), left_behind());
    let (notices, result) = fit_from(good.clone(), "test");
    assert_eq!(
        (notices, result),
        (vec![Notice::Resumed { stage: Some("joint refinement") }], expected.clone())
    );

    let mut damaged: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "damaged"),
        (b"\xff\xff\n{}".to_vec(), "damaged"),
        (b"something else\n".to_vec(), "another format"),
        (good[..good.len() / 2].to_vec(), "damaged"),
    ];
    for k in 1..6 {
        let mut flipped = good.clone();
        let at = k * flipped.len() / 6;
        flipped[at] ^= 1;
        damaged.push((flipped, "damaged"));
    }
    for (bytes, word) in damaged {
        let (notices, result) = fit_from(bytes, "test");
        assert!(matches!(&notices[..], [Notice::Ignored { reason }] if reason.contains(word)), "{notices:?}");
        assert_eq!(result, expected);
    }
    let (notices, result) = fit_from(good, "another build");
    assert!(
        matches!(&notices[..], [Notice::Ignored { reason }] if reason.contains("another program")),
        "{notices:?}"
    );
    assert_eq!(result, expected);
}

#[test]
fn another_specification_has_another_folder_and_is_not_mixed_up() {
    let output = tempfile::tempdir().unwrap();
    let (mine, mut spec) = (plan(), small());
    spec.joint.seed += 1;
    let other = Plan::new(spec).unwrap();
    let (own, others) = (Folder::new(output.path(), &mine), Folder::new(output.path(), &other));
    assert_ne!(own.path(), others.path());
    // Laid under the other's name nevertheless, it is ignored.
    others.save(&left_behind()).unwrap();
    let notices = RefCell::new(Vec::new());
    checkpoint::fit(&other, &keep(&others), &silent, &|notice| notices.borrow_mut().push(notice)).unwrap();
    let notices = notices.into_inner();
    assert!(
        matches!(&notices[..], [Notice::Ignored { reason }] if reason.contains("another specification")),
        "{notices:?}"
    );
}

#[test]
fn a_folder_is_made_when_needed_and_cleared_without_a_trace() {
    let output = tempfile::tempdir().unwrap();
    let (store, plan) = (Folder::new(output.path(), &plan()), plan());
    assert_eq!(store.load().unwrap(), None);
    store.clear().unwrap();
    assert_eq!(std::fs::read_dir(output.path()).unwrap().count(), 0);
    let fitted = checkpoint::fit(&plan, &keep(&store), &silent, &|notice| panic!("{notice}")).unwrap();
    assert!(store.load().unwrap().is_some(), "it stays until the table is in its place");
    // All is done: what is left is to read it.
    let resumed = RefCell::new(Vec::new());
    let again = checkpoint::fit(&plan, &keep(&store), &|_| panic!("no work is left"), &|notice| {
        resumed.borrow_mut().push(notice);
    });
    assert_eq!(resumed.into_inner(), [Notice::Resumed { stage: None }]);
    assert_eq!(essence(&again.unwrap()), essence(&fitted));
    store.clear().unwrap();
    assert_eq!(std::fs::read_dir(output.path()).unwrap().count(), 0);
}

#[test]
fn fits_of_one_specification_share_a_folder_and_do_not_meet() {
    let output = tempfile::tempdir().unwrap();
    let store = Folder::new(output.path(), &plan());
    let content = vec![7; 20_000];
    let one_after_the_other = || {
        for _ in 0..300 {
            store.save(&content).unwrap();
            assert!(store.load().unwrap().is_none_or(|found| found == content));
            store.clear().unwrap();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(one_after_the_other);
        }
    });
    assert_eq!(std::fs::read_dir(output.path()).unwrap().count(), 0);
}

#[test]
fn a_store_that_fails_does_not_stop_the_fit() {
    let output = tempfile::tempdir().unwrap();
    let store = Folder::new(output.path(), &plan());
    // A file where the folder would be.
    std::fs::write(output.path().join(".checkpoints"), "").unwrap();
    let notices = RefCell::new(Vec::new());
    let fitted =
        checkpoint::fit(&plan(), &keep(&store), &silent, &|notice| notices.borrow_mut().push(notice));
    assert_eq!(essence(&fitted.unwrap()), uninterrupted());
    assert!(notices.into_inner().iter().any(|notice| matches!(notice, Notice::NotSaved { .. })));
}
