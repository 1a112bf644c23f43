//! The suite of [`Metadata`].

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::json;

use super::kind;
use crate::{BenchmarkFilter, Metadata, NewVersion, Scope, Secret, StoreError, VersionState};

/// Makes a fresh, empty store.
type Make<'a> = &'a dyn Fn() -> Arc<dyn Metadata>;

/// What every [`Metadata`] does.
///
/// # Panics
/// At the first thing that is not so.
pub async fn metadata(make: Make<'_>) {
    versions_are_numbered(&*make()).await;
    quarantine(&*make()).await;
    aliases_compare_and_swap(&*make()).await;
    one_move_wins_each_revision(make()).await;
    versions_added_at_once_get_numbers(make()).await;
    seeds(&*make()).await;
    tokens(&*make()).await;
    benchmarks(&*make()).await;
    make().ping().await.unwrap();
}

fn new(table: &str, digest: &str) -> NewVersion {
    NewVersion {
        table: table.to_owned(),
        digest: digest.to_owned(),
        manifest: json!({ "name": table, "version": 77, "tv": 0.1, "text": "ü \"quoted\"" }),
        state: VersionState::Published,
        spec_digest: Some(format!("spec-{digest}")),
        reason: None,
    }
}

async fn versions_are_numbered(store: &dyn Metadata) {
    assert!(store.versions().await.unwrap().is_empty());
    for (digest, number) in [("x", 1), ("y", 2), ("z", 3)] {
        let (kept, is_new) = store.add_version(new("a", digest), None).await.unwrap();
        assert_eq!((kept.number, is_new), (number, true));
        assert_eq!(kept.manifest["version"], number, "the number given out");
        assert_eq!(kept.manifest["text"], "ü \"quoted\"");
    }
    let again = NewVersion { manifest: json!({}), spec_digest: None, ..new("a", "y") };
    let (kept, is_new) = store.add_version(again, None).await.unwrap();
    assert_eq!((kept.number, is_new, kept.spec_digest.as_deref()), (2, false, Some("spec-y")));
    assert_eq!(
        store.add_version(new("b", "y"), None).await.unwrap().0.number,
        1,
        "each table has its own numbers"
    );
    let all = store.versions().await.unwrap();
    let names: Vec<_> = all.iter().map(|v| (v.table.as_str(), v.number)).collect();
    assert_eq!(names, [("a", 1), ("a", 2), ("a", 3), ("b", 1)]);
    assert_eq!(store.version("a", 2).await.unwrap(), all[1]);
    assert_eq!(kind(store.version("a", 4).await), "not found");
    assert_eq!(store.version_of_spec("spec-z").await.unwrap().map(|v| v.number), Some(3));
    assert_eq!(store.version_of_spec("spec").await.unwrap(), None);
}

async fn quarantine(store: &dyn Metadata) {
    let bad = |digest| NewVersion {
        state: VersionState::Quarantined,
        reason: Some("det 0".to_owned()),
        ..new("a", digest)
    };
    assert_eq!(kind(store.add_version(bad("x"), Some(("latest", None))).await), "conflict");
    assert!(store.versions().await.unwrap().is_empty(), "a change that fails leaves nothing");
    let (kept, _) = store.add_version(bad("x"), None).await.unwrap();
    assert_eq!((kept.state, kept.reason.as_deref()), (VersionState::Quarantined, Some("det 0")));
    assert_eq!(kind(store.move_alias("a", "latest", 1, None).await), "conflict");
    assert_eq!(store.version_of_spec("spec-x").await.unwrap(), None);
    assert!(store.aliases().await.unwrap().is_empty());
}

async fn aliases_compare_and_swap(store: &dyn Metadata) {
    for digest in ["x", "y", "z"] {
        store.add_version(new("a", digest), None).await.unwrap();
    }
    assert_eq!(kind(store.move_alias("a", "mine", 9, None).await), "not found");
    assert_eq!(kind(store.move_alias("b", "mine", 1, None).await), "not found");
    assert_eq!(kind(store.move_alias("a", "mine", 1, Some(1)).await), "conflict");
    let alias = store.move_alias("a", "mine", 1, Some(0)).await.unwrap();
    assert_eq!((alias.number, alias.revision), (1, 1));
    let conflict = store.move_alias("a", "mine", 2, Some(0)).await.unwrap_err();
    assert!(conflict.to_string().contains("revision 1"), "{conflict}");
    assert_eq!(store.move_alias("a", "mine", 2, Some(1)).await.unwrap().revision, 2);
    assert_eq!(store.move_alias("a", "mine", 3, None).await.unwrap().revision, 3);
    assert_eq!(store.move_alias("a", "mine", 3, None).await.unwrap().revision, 4, "each move counts");
    // With a version, in one transaction.
    assert_eq!(kind(store.add_version(new("a", "w"), Some(("mine", Some(1)))).await), "conflict");
    assert_eq!(kind(store.version("a", 4).await), "not found");
    store.add_version(new("a", "w"), Some(("mine", Some(4)))).await.unwrap();
    store.add_version(new("a", "w"), Some(("mine", None))).await.unwrap();
    let aliases = store.aliases().await.unwrap();
    assert_eq!(aliases.len(), 1);
    assert_eq!((aliases[0].number, aliases[0].revision), (4, 5), "the same again moves nothing");
}

async fn one_move_wins_each_revision(store: Arc<dyn Metadata>) {
    const TASKS: u32 = 8;
    const REVISIONS: u64 = 10;
    for i in 0..TASKS {
        store.add_version(new("a", &i.to_string()), None).await.unwrap();
    }
    let tasks = (1..=TASKS).map(|number| {
        let store = Arc::clone(&store);
        tokio::spawn(async move {
            let mut won = Vec::new();
            for revision in 0..REVISIONS {
                match store.move_alias("a", "mine", number, Some(revision)).await {
                    Ok(alias) => won.push(alias.revision),
                    Err(StoreError::Conflict { .. }) => {}
                    Err(other) => panic!("{other}"),
                }
            }
            won
        })
    });
    let mut won = Vec::new();
    for task in tasks.collect::<Vec<_>>() {
        won.extend(task.await.unwrap());
    }
    won.sort_unstable();
    let last = store.aliases().await.unwrap()[0].revision;
    assert_eq!(won, (1..=last).collect::<Vec<_>>(), "each revision has one winner, and none was skipped");
}

async fn versions_added_at_once_get_numbers(store: Arc<dyn Metadata>) {
    let tasks: Vec<_> = (0..16)
        .map(|i| {
            let store = Arc::clone(&store);
            tokio::spawn(
                async move { store.add_version(new("a", &(i / 2).to_string()), None).await.unwrap() },
            )
        })
        .collect();
    let mut added = Vec::new();
    for task in tasks {
        let (version, is_new) = task.await.unwrap();
        added.extend(is_new.then_some(version.number));
    }
    added.sort_unstable();
    assert_eq!(added, (1..=8).collect::<Vec<_>>(), "each digest once");
}

async fn seeds(store: &dyn Metadata) {
    let shipped = |number: u32| {
        let digest = format!("shipped-{number}");
        NewVersion { manifest: json!({ "version": number }), ..new("a", &digest) }
    };
    let points = async |name: &str| {
        let aliases = store.aliases().await.unwrap();
        aliases.into_iter().find(|a| a.name == name).map(|a| (a.number, a.revision))
    };
    let both = ["latest", "stable"];
    let (kept, is_new) = store.seed(shipped(2), &both).await.unwrap();
    assert_eq!((kept.number, is_new), (2, true), "its own number");
    assert_eq!(store.seed(shipped(1), &both).await.unwrap().0.number, 1);
    assert_eq!(points("latest").await, Some((2, 1)), "not back to an older one");
    assert!(!store.seed(shipped(2), &both).await.unwrap().1);
    assert_eq!(points("latest").await, Some((2, 1)), "the same again changes nothing");
    // Somebody's own version and their hold on one alias.
    assert_eq!(store.add_version(new("a", "own"), None).await.unwrap().0.number, 3);
    store.move_alias("a", "stable", 1, None).await.unwrap();
    let (kept, _) = store.seed(shipped(3), &both).await.unwrap();
    assert_eq!(kept.number, 4, "3 is taken");
    assert_eq!(kept.manifest["version"], 4);
    assert_eq!(points("latest").await, Some((4, 2)), "follows what is shipped");
    assert_eq!(points("stable").await, Some((1, 2)), "stays where it was put");
}

async fn tokens(store: &dyn Metadata) {
    let scopes = BTreeSet::from([Scope::Refit, Scope::Benchmark]);
    let (token, secret) = Secret::generate("CI's \"own\"", scopes, None).unwrap();
    store.add_token(token.clone()).await.unwrap();
    assert_eq!(kind(store.add_token(token.clone()).await), "conflict");
    assert_eq!(store.tokens().await.unwrap(), std::slice::from_ref(&token));
    assert!(secret.opens(&store.tokens().await.unwrap()[0]));
    store.revoke_token(&token.id).await.unwrap();
    assert_eq!(kind(store.revoke_token(&token.id).await), "not found");
    assert!(store.tokens().await.unwrap().is_empty());
}

async fn benchmarks(store: &dyn Metadata) {
    let run = json!({ "value": 1.5, "unit": "ms" });
    for (name, at) in [
        ("a", "2026-01-02T00:00:00Z"),
        ("b", "2026-01-03T00:00:00Z"),
        ("a", "2026-01-01T00:00:00.5Z"),
        ("a", "2026-01-01T00:00:00Z"),
    ] {
        store.add_benchmark(name, at, run.clone()).await.unwrap();
    }
    assert_eq!(kind(store.add_benchmark("a", "yesterday", run.clone()).await), "conflict");
    let ids = async |name: Option<&str>, since: Option<&str>, limit| {
        let (name, since) = (name.map(str::to_owned), since.map(str::to_owned));
        let filter = BenchmarkFilter { name, since, limit, ..BenchmarkFilter::default() };
        store.benchmarks(&filter).await.unwrap().iter().map(|b| b.id).collect::<Vec<_>>()
    };
    assert_eq!(ids(None, None, 9).await, [4, 3, 1, 2], "oldest first");
    assert_eq!(ids(None, None, 2).await, [1, 2], "the newest");
    assert_eq!(ids(Some("a"), None, 9).await, [4, 3, 1]);
    assert_eq!(ids(Some("a"), Some("2026-01-01T00:00:00.500Z"), 9).await, [3, 1]);
    assert_eq!(ids(Some("c"), None, 9).await, [0; 0]);
    let first =
        &store.benchmarks(&BenchmarkFilter { limit: 1, ..BenchmarkFilter::default() }).await.unwrap()[0];
    assert_eq!((first.name.as_str(), first.at.as_str(), &first.run), ("b", "2026-01-03T00:00:00Z", &run));
    let each = run.to_string().len();
    for (bytes, count) in [(4 * each, 4), (4 * each - 1, 3), (each, 1), (0, 1)] {
        let filter = BenchmarkFilter { bytes, ..BenchmarkFilter::default() };
        let found = store.benchmarks(&filter).await.unwrap();
        assert_eq!(found.len(), count, "{bytes} bytes");
        assert_eq!(found.last().map(|b| b.id), Some(2), "the newest");
    }
}
