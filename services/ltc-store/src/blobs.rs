//! Bytes by digest.

use async_trait::async_trait;

use crate::StoreError;

/// What a blob is for; each kind has a namespace of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlobKind {
    /// A table's payload; kept for ever.
    Payload,
    /// A file made of a payload: a format, precision or crop. May go at any time to make room.
    Derived,
    /// The state of a running job; goes when the job ends.
    Checkpoint,
}

/// Bytes named by a key that determines them; written once, never changed.
///
/// Keys are `[a-z0-9:._-]{1,120}` without a leading dot; anything else is [`StoreError::NotFound`] to read and
/// [`StoreError::Conflict`] to write.
#[async_trait]
pub trait Blobs: Send + Sync {
    /// Keeps `bytes` under `key`, whole and on stable storage when it returns; a reader sees all of them or nothing. The same
    /// key again is no error and changes nothing.
    ///
    /// # Errors
    /// [`StoreError::Unwritable`], [`StoreError::Backend`].
    async fn put(&self, kind: BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError>;

    /// The bytes.
    ///
    /// # Errors
    /// [`StoreError::NotFound`], [`StoreError::Backend`].
    async fn get(&self, kind: BlobKind, key: &str) -> Result<Vec<u8>, StoreError>;

    /// Whether there is such a blob.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn contains(&self, kind: BlobKind, key: &str) -> Result<bool, StoreError>;

    /// Forgets a blob; one that is not there is no error.
    ///
    /// # Errors
    /// [`StoreError::Unwritable`], [`StoreError::Backend`].
    async fn delete(&self, kind: BlobKind, key: &str) -> Result<(), StoreError>;

    /// Keys and sizes in bytes, least recently used first where the store knows.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn list(&self, kind: BlobKind) -> Result<Vec<(String, u64)>, StoreError>;
}
