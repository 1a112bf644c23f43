//! The suite of [`Jobs`].

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use serde_json::json;

use super::kind;
use crate::{Event, EventKind, Job, JobState, Jobs, MAX_BARREN, NewJob, Outcome, ShardReport};

/// Makes a fresh, empty store.
type Make<'a> = &'a dyn Fn() -> Arc<dyn Jobs>;

/// A lease that does not end within a test.
const LONG: Duration = Duration::from_secs(600);

/// What every [`Jobs`] does.
///
/// # Panics
/// At the first thing that is not so.
pub async fn jobs(make: Make<'_>) {
    a_life(&*make()).await;
    order(&*make()).await;
    idempotency(make()).await;
    done_from_the_start(&*make()).await;
    the_queue_is_bounded(&*make()).await;
    cancellation(&*make()).await;
    leases_end_and_stale_claims_are_fenced(&*make()).await;
    a_worker_takes_up_its_own(&*make()).await;
    a_job_that_kills_is_given_up(&*make()).await;
    each_job_is_claimed_once(make()).await;
    events_resume(&*make()).await;
    odd_numbers(&*make()).await;
}

fn new(name: &str) -> NewJob {
    NewJob {
        table: name.to_owned(),
        spec: json!({ "name": name, "steps": 3 }),
        spec_digest: format!("sha256:{name}"),
        priority: 0,
        alias: None,
        idempotency: None,
    }
}

async fn add(store: &dyn Jobs, job: NewJob) -> Job {
    store.enqueue(job, 100).await.unwrap().0
}

fn at(progress: f64) -> ShardReport {
    ShardReport { progress, ..ShardReport::default() }
}

async fn a_life(store: &dyn Jobs) {
    assert_eq!(store.claim("w", LONG).await.unwrap(), None);
    let watch = store.watch();
    let request = NewJob { alias: Some(("stable".to_owned(), true)), priority: -3, ..new("a") };
    let job = add(store, request.clone()).await;
    assert!(watch.has_changed().unwrap(), "who waits is told");
    assert_eq!((job.state, &job.request, job.progress), (JobState::Queued, &request, 0.0));
    assert!(job.id.len() == 32 && job.id.bytes().all(|b| b.is_ascii_hexdigit()), "{}", job.id);
    assert_eq!(store.job(&job.id).await.unwrap(), job);
    assert_eq!(store.depth().await.unwrap(), (1, 0));
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    assert_eq!((claim.job.state, claim.attempt), (JobState::Running, 1));
    assert_eq!(store.depth().await.unwrap(), (0, 1));
    assert_eq!(store.claim("other", LONG).await.unwrap(), None);
    let shard =
        ShardReport { progress: 0.5, seconds_left: Some(2.0), tv: Some(0.1), log: Some("half".to_owned()) };
    let job = store.report(&claim, LONG, shard).await.unwrap();
    assert_eq!((job.progress, job.seconds_left, job.tv), (0.5, Some(2.0), Some(0.1)));
    let outcome = Outcome::Succeeded { version: 4, note: "done".to_owned() };
    let job = store.finish(&claim, outcome.clone()).await.unwrap();
    assert_eq!((job.state, job.version, job.progress), (JobState::Succeeded, Some(4), 1.0));
    assert_eq!((job.seconds_left, job.tv), (None, Some(0.1)));
    assert_eq!(store.depth().await.unwrap(), (0, 0));
    assert_eq!(kind(store.finish(&claim, outcome).await), "conflict", "once");
    assert_eq!(kind(store.report(&claim, LONG, at(0.6)).await), "conflict");
    assert_eq!(store.job(&job.id).await.unwrap(), job);
    let failing = add(store, new("b")).await;
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    let job = store.finish(&claim, Outcome::Failed { error: "why".to_owned() }).await.unwrap();
    assert_eq!((job.state, job.error.as_deref()), (JobState::Failed, Some("why")));
    let ids: Vec<_> = store.jobs(9).await.unwrap().into_iter().map(|j| j.id).collect();
    assert_eq!(ids[0], failing.id, "newest first");
    assert!(ids[0] > ids[1], "ids rise");
    assert_eq!(store.jobs(1).await.unwrap().len(), 1);
    assert_eq!(kind(store.job("no-such-job").await), "not found");
    assert_eq!(kind(store.events("no-such-job", 0).await), "not found");
}

async fn order(store: &dyn Jobs) {
    for (name, priority) in [("a", 0), ("b", 5), ("c", 0), ("d", 5), ("e", -1)] {
        add(store, NewJob { priority, ..new(name) }).await;
    }
    let mut names = Vec::new();
    while let Some(claim) = store.claim(&format!("w{}", names.len()), LONG).await.unwrap() {
        names.push(claim.job.request.table);
    }
    assert_eq!(names, ["b", "d", "a", "c", "e"]);
}

async fn idempotency(store: Arc<dyn Jobs>) {
    let keyed =
        |owner: &str, key: &str| NewJob { idempotency: Some((owner.to_owned(), key.to_owned())), ..new("a") };
    let (job, is_new) = store.enqueue(keyed("me", "1"), 2).await.unwrap();
    assert!(is_new);
    let (again, is_new) = store.enqueue(keyed("me", "1"), 0).await.unwrap();
    assert_eq!((&again.id, is_new), (&job.id, false), "even with a full queue");
    let other = NewJob { spec: json!({ "name": "b" }), ..keyed("me", "1") };
    assert_eq!(kind(store.enqueue(other, 9).await), "conflict");
    assert_ne!(store.enqueue(keyed("you", "1"), 9).await.unwrap().0.id, job.id, "keys are their owner's");
    assert_ne!(add(&*store, new("a")).await.id, add(&*store, new("a")).await.id, "no key, no match");
    store.cancel(&job.id).await.unwrap();
    let (again, is_new) = store.enqueue(keyed("me", "1"), 9).await.unwrap();
    assert_eq!((again.state, is_new), (JobState::Cancelled, false), "whatever became of it");
    let tasks: Vec<_> = (0..16)
        .map(|_| {
            let (store, job) = (Arc::clone(&store), keyed("me", "2"));
            tokio::spawn(async move { store.enqueue(job, 99).await.unwrap() })
        })
        .collect();
    let (mut ids, mut made) = (BTreeSet::new(), 0);
    for task in tasks {
        let (job, is_new) = task.await.unwrap();
        ids.insert(job.id);
        made += u32::from(is_new);
    }
    assert_eq!((ids.len(), made), (1, 1));
}

async fn done_from_the_start(store: &dyn Jobs) {
    let keyed = NewJob { idempotency: Some(("me".to_owned(), "1".to_owned())), ..new("a") };
    let (job, is_new) = store.enqueue_done(keyed.clone(), 3, "there already").await.unwrap();
    assert_eq!((job.state, job.version, job.progress, is_new), (JobState::Succeeded, Some(3), 1.0, true));
    assert_eq!(store.claim("w", LONG).await.unwrap(), None);
    assert_eq!(store.depth().await.unwrap(), (0, 0));
    assert_eq!(store.enqueue_done(keyed.clone(), 4, "").await.unwrap(), (job.clone(), false));
    assert_eq!(store.enqueue(keyed.clone(), 9).await.unwrap(), (job.clone(), false));
    let other = NewJob { priority: 1, ..keyed };
    assert_eq!(kind(store.enqueue_done(other, 3, "").await), "conflict");
    let events = store.events(&job.id, 0).await.unwrap();
    assert_eq!(events.last().unwrap().data["state"], "succeeded");
    assert!(events.iter().any(|event| event.data["line"] == "there already"));
}

async fn the_queue_is_bounded(store: &dyn Jobs) {
    for name in ["a", "b"] {
        store.enqueue(new(name), 2).await.unwrap();
    }
    assert_eq!(kind(store.enqueue(new("c"), 2).await), "full");
    store.claim("w", LONG).await.unwrap().unwrap();
    store.enqueue(new("c"), 2).await.unwrap();
    assert_eq!(store.depth().await.unwrap(), (2, 1));
}

async fn cancellation(store: &dyn Jobs) {
    let waiting = add(store, new("a")).await;
    assert_eq!(store.cancel(&waiting.id).await.unwrap().state, JobState::Cancelled);
    assert_eq!(store.cancel(&waiting.id).await.unwrap().state, JobState::Cancelled, "again is no error");
    assert_eq!(store.claim("w", LONG).await.unwrap(), None);
    let running = add(store, new("b")).await;
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    let job = store.cancel(&running.id).await.unwrap();
    assert_eq!((job.state, job.cancel_requested), (JobState::Running, true));
    assert!(store.report(&claim, LONG, at(0.5)).await.unwrap().cancel_requested, "the worker is told");
    assert_eq!(store.finish(&claim, Outcome::Cancelled).await.unwrap().state, JobState::Cancelled);
    assert_eq!(kind(store.cancel("no-such-job").await), "not found");
    // One that is released by a stopping worker before it saw the wish does not come back.
    let released = add(store, new("c")).await;
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    store.cancel(&released.id).await.unwrap();
    assert_eq!(store.finish(&claim, Outcome::Released).await.unwrap().state, JobState::Cancelled);
    let done = add(store, new("d")).await;
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    store.finish(&claim, Outcome::Failed { error: String::new() }).await.unwrap();
    assert_eq!(kind(store.cancel(&done.id).await), "conflict");
}

async fn leases_end_and_stale_claims_are_fenced(store: &dyn Jobs) {
    let short = Duration::from_millis(40);
    add(store, new("a")).await;
    let first = store.claim("one", short).await.unwrap().unwrap();
    assert_eq!(store.claim("two", LONG).await.unwrap(), None);
    store.report(&first, short, at(0.1)).await.unwrap();
    tokio::time::sleep(2 * short).await;
    let second = store.claim("two", LONG).await.unwrap().unwrap();
    assert_eq!((second.attempt, second.job.progress), (2, 0.1));
    assert_eq!(kind(store.report(&first, LONG, at(0.9)).await), "conflict");
    assert_eq!(kind(store.finish(&first, Outcome::Cancelled).await), "conflict");
    assert_eq!(store.job(&second.job.id).await.unwrap().progress, 0.1);
    assert_eq!(store.finish(&second, Outcome::Released).await.unwrap().state, JobState::Queued);
    assert_eq!(kind(store.report(&second, LONG, at(0.9)).await), "conflict");
    let third = store.claim("one", LONG).await.unwrap().unwrap();
    assert_eq!(third.attempt, 3);
    let outcome = Outcome::Succeeded { version: 1, note: String::new() };
    store.finish(&third, outcome).await.unwrap();
}

async fn a_worker_takes_up_its_own(store: &dyn Jobs) {
    add(store, NewJob { priority: -9, ..new("a") }).await;
    let lost = store.claim("w", LONG).await.unwrap().unwrap();
    add(store, NewJob { priority: 9, ..new("b") }).await;
    let found = store.claim("w", LONG).await.unwrap().unwrap();
    assert_eq!((found.job.id, found.attempt), (lost.job.id.clone(), 2), "before anything new");
    assert_eq!(kind(store.report(&lost, LONG, at(0.1)).await), "conflict");
}

async fn a_job_that_kills_is_given_up(store: &dyn Jobs) {
    let job = add(store, new("a")).await;
    for _ in 0..MAX_BARREN - 1 {
        store.claim("w", LONG).await.unwrap().unwrap();
    }
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    store.report(&claim, LONG, at(0.1)).await.unwrap();
    store.finish(&claim, Outcome::Released).await.unwrap();
    for _ in 0..MAX_BARREN {
        // Progress made it start counting anew; what was reached before is no progress.
        let claim = store.claim("w", LONG).await.unwrap().unwrap();
        store.report(&claim, LONG, at(0.1)).await.unwrap();
    }
    assert_eq!(store.claim("w", LONG).await.unwrap(), None);
    let job = store.job(&job.id).await.unwrap();
    assert_eq!(job.state, JobState::Failed);
    assert!(job.error.unwrap().contains("without progress"));
}

async fn each_job_is_claimed_once(store: Arc<dyn Jobs>) {
    for i in 0..20 {
        add(&*store, new(&format!("t{i}"))).await;
    }
    let tasks: Vec<_> = (0..30)
        .map(|i| {
            let store = Arc::clone(&store);
            tokio::spawn(async move { store.claim(&format!("w{i}"), LONG).await.unwrap() })
        })
        .collect();
    let mut ids = Vec::new();
    for task in tasks {
        ids.extend(task.await.unwrap().map(|claim| claim.job.id));
    }
    ids.sort_unstable();
    let all = ids.len();
    ids.dedup();
    assert_eq!((all, ids.len()), (20, 20));
}

async fn events_resume(store: &dyn Jobs) {
    let (job, other) = (add(store, new("a")).await, add(store, new("b")).await);
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    let shard = ShardReport { log: Some("line".to_owned()), tv: Some(0.25), ..at(0.5) };
    store.report(&claim, LONG, shard).await.unwrap();
    let outcome = Outcome::Succeeded { version: 7, note: "kept".to_owned() };
    store.finish(&claim, outcome).await.unwrap();
    let events = store.events(&job.id, 0).await.unwrap();
    use EventKind::{Log, Progress, State};
    let kinds: Vec<_> = events.iter().map(|e| e.kind).collect();
    assert_eq!(kinds, [State, State, Progress, Log, Log, State]);
    assert!(events.is_sorted_by(|a, b| a.id < b.id), "{events:?}");
    let data = |event: &Event, field: &str| event.data[field].clone();
    assert_eq!(data(&events[0], "state"), "queued");
    assert_eq!((data(&events[2], "progress"), data(&events[2], "tv")), (json!(0.5), json!(0.25)));
    assert_eq!((data(&events[3], "line"), data(&events[4], "line")), (json!("line"), json!("kept")));
    assert_eq!((data(&events[5], "state"), data(&events[5], "version")), (json!("succeeded"), json!(7)));
    let middle = events[2].id;
    assert_eq!(store.events(&job.id, middle).await.unwrap(), events[3..]);
    assert!(store.events(&job.id, u64::MAX).await.unwrap().is_empty());
    assert_eq!(store.events(&other.id, 0).await.unwrap().len(), 1, "each job has its own");
}

async fn odd_numbers(store: &dyn Jobs) {
    add(store, new("a")).await;
    let claim = store.claim("w", LONG).await.unwrap().unwrap();
    for (given, kept) in [(0.5, 0.5), (7.0, 1.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0), (-1.0, 0.0)] {
        assert_eq!(store.report(&claim, LONG, at(given)).await.unwrap().progress, kept, "{given}");
    }
}
