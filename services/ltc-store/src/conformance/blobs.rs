//! The suite of [`Blobs`].

use std::sync::Arc;

use ltc_table::digest::digest;

use super::kind;
use crate::{BlobKind, Blobs};

/// Makes a fresh, empty store.
type Make<'a> = &'a dyn Fn() -> Arc<dyn Blobs>;

/// What every [`Blobs`] does.
///
/// # Panics
/// At the first thing that is not so.
pub async fn blobs(make: Make<'_>) {
    kept_and_forgotten(&*make()).await;
    kinds_are_apart(&*make()).await;
    keys_cannot_leave(&*make()).await;
    payloads_are_what_their_keys_say(&*make()).await;
    many_at_once(make()).await;
}

async fn kept_and_forgotten(store: &dyn Blobs) {
    for kind_of in [BlobKind::Payload, BlobKind::Derived, BlobKind::Checkpoint] {
        assert_eq!(kind(store.get(kind_of, "a").await), "not found");
        assert!(!store.contains(kind_of, "a").await.unwrap());
        store.put(kind_of, "a", b"one").await.unwrap();
        store.put(kind_of, "b", b"").await.unwrap();
        assert_eq!(store.get(kind_of, "a").await.unwrap(), b"one");
        assert_eq!(store.get(kind_of, "b").await.unwrap(), b"", "nothing is a blob, too");
        store.put(kind_of, "a", b"one").await.unwrap();
        let mut list = store.list(kind_of).await.unwrap();
        list.sort();
        assert_eq!(list, [("a".to_owned(), 3), ("b".to_owned(), 0)]);
        store.delete(kind_of, "a").await.unwrap();
        store.delete(kind_of, "a").await.unwrap();
        assert_eq!(kind(store.get(kind_of, "a").await), "not found");
        assert_eq!(store.list(kind_of).await.unwrap(), [("b".to_owned(), 0)]);
        store.put(kind_of, "a", b"two").await.unwrap();
        assert_eq!(store.get(kind_of, "a").await.unwrap(), b"two", "a key that was free again");
    }
}

async fn kinds_are_apart(store: &dyn Blobs) {
    store.put(BlobKind::Derived, "k", b"derived").await.unwrap();
    assert_eq!(kind(store.get(BlobKind::Payload, "k").await), "not found");
    store.put(BlobKind::Checkpoint, "k", b"checkpoint").await.unwrap();
    store.delete(BlobKind::Checkpoint, "k").await.unwrap();
    assert_eq!(store.get(BlobKind::Derived, "k").await.unwrap(), b"derived");
}

async fn keys_cannot_leave(store: &dyn Blobs) {
    let long = "a".repeat(121);
    for key in
        ["", ".", "..", "../x", "a/b", "/etc/passwd", "A", "a b", "a\0b", "a\\b", "ä", "a+b", "%2e", &long]
    {
        assert_eq!(kind(store.put(BlobKind::Checkpoint, key, b"x").await), "conflict", "{key:?}");
        assert_eq!(kind(store.get(BlobKind::Checkpoint, key).await), "not found", "{key:?}");
        assert!(!store.contains(BlobKind::Checkpoint, key).await.unwrap(), "{key:?}");
        store.delete(BlobKind::Checkpoint, key).await.unwrap();
    }
    for key in ["a", "sha256:00", "a..b", "a.-_:9", &long[..120]] {
        store.put(BlobKind::Checkpoint, key, key.as_bytes()).await.unwrap();
        assert_eq!(store.get(BlobKind::Checkpoint, key).await.unwrap(), key.as_bytes());
    }
    assert_eq!(store.list(BlobKind::Checkpoint).await.unwrap().len(), 5);
}

async fn payloads_are_what_their_keys_say(store: &dyn Blobs) {
    let key = digest(b"payload");
    assert_eq!(kind(store.put(BlobKind::Payload, &key, b"something else").await), "conflict");
    assert_eq!(kind(store.get(BlobKind::Payload, &key).await), "not found");
    store.put(BlobKind::Payload, &key, b"payload").await.unwrap();
    assert_eq!(store.get(BlobKind::Payload, &key).await.unwrap(), b"payload");
}

async fn many_at_once(store: Arc<dyn Blobs>) {
    let bytes = vec![7; 100_000];
    let mut tasks = Vec::new();
    for i in 0..32 {
        let (store, bytes) = (Arc::clone(&store), bytes.clone());
        tasks.push(tokio::spawn(async move {
            let key = format!("k{}", i % 4);
            store.put(BlobKind::Payload, &key, &bytes).await.unwrap();
            assert_eq!(store.get(BlobKind::Payload, &key).await.unwrap(), bytes);
        }));
    }
    for task in tasks {
        task.await.unwrap();
    }
    assert_eq!(store.list(BlobKind::Payload).await.unwrap().len(), 4);
}
