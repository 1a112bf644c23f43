//! What may name a blob.

use crate::StoreError;

/// Whether `key` is `[a-z0-9:._-]{1,120}` without a leading dot: safe as part of a path and of a URL.
pub(crate) fn is_valid(key: &str) -> bool {
    let plain = key.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b':' | b'.' | b'_' | b'-'));
    plain && (1..=120).contains(&key.len()) && !key.starts_with('.')
}

/// That no such blob is there.
pub(crate) fn not_found(key: &str) -> StoreError {
    StoreError::NotFound { what: "blob", name: key.chars().take(120).collect() }
}

/// # Errors
/// [`StoreError::NotFound`] for a key that no blob can have.
pub(crate) fn check_to_read(key: &str) -> Result<(), StoreError> {
    if is_valid(key) { Ok(()) } else { Err(not_found(key)) }
}

/// # Errors
/// [`StoreError::Conflict`] for a key that no blob can have, and for bytes that do not have the digest that they are to be
/// named by.
pub(crate) fn check_to_write(kind: crate::BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError> {
    if !is_valid(key) {
        return Err(StoreError::Conflict { reason: format!("{key:?} cannot be the key of a blob") });
    }
    check_digest(kind, key, bytes).map_err(|found| StoreError::Conflict {
        reason: format!("a blob of digest {found} cannot be kept as {key}"),
    })
}

/// # Errors
/// The digest of `bytes`, where a payload's key is another one.
pub(crate) fn check_digest(kind: crate::BlobKind, key: &str, bytes: &[u8]) -> Result<(), String> {
    if kind != crate::BlobKind::Payload || !ltc_table::digest::is_digest(key) {
        return Ok(());
    }
    let found = ltc_table::digest::digest(bytes);
    if found == key { Ok(()) } else { Err(found) }
}
