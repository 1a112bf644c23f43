//! What is known about tables: versions, aliases, tokens, benchmarks.

use std::collections::BTreeSet;

use async_trait::async_trait;
use serde::{Deserialize, Serialize};

use crate::StoreError;

/// Whether a version may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VersionState {
    /// Listed and served.
    Published,
    /// Kept for inspection, not listed, not served: an upload that failed its checks.
    Quarantined,
}

/// A version to keep. Its number is given out by the store unless the manifest fixes it.
#[derive(Clone, Debug, PartialEq)]
pub struct NewVersion {
    /// The table's name.
    pub table: String,
    /// `sha256:<hex>` of the payload, which is in the blobs before this is written.
    pub digest: String,
    /// The manifest, JSON, its `version` replaced by the number given out.
    pub manifest: serde_json::Value,
    /// Whether it may be used.
    pub state: VersionState,
    /// Digest of the fit specification it was made from, where it was fitted here.
    pub spec_digest: Option<String>,
    /// Why it is quarantined.
    pub reason: Option<String>,
}

/// A version that is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredVersion {
    /// The table's name.
    pub table: String,
    /// Its number, from 1.
    pub number: u32,
    /// `sha256:<hex>` of the payload.
    pub digest: String,
    /// The manifest, JSON, with this number in it.
    pub manifest: serde_json::Value,
    /// Whether it may be used.
    pub state: VersionState,
    /// Digest of the fit specification, where it was fitted here.
    pub spec_digest: Option<String>,
    /// Why it is quarantined.
    pub reason: Option<String>,
}

/// A name that moves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alias {
    /// The table's name.
    pub table: String,
    /// The alias: `stable`, `latest`, or anybody's own.
    pub name: String,
    /// The version's number that it stands for.
    pub number: u32,
    /// Grows by 1 with every move; what compare-and-swap compares.
    pub revision: u64,
}

/// What a token may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// Read, where reading is bound to tokens.
    Read,
    /// Ask for refits and cancel them.
    Refit,
    /// Upload tables and move aliases.
    Publish,
    /// Post benchmark runs.
    Benchmark,
}

/// SHA-256 of a token's secret: secrets are 256 random bits, so that no slow hash is needed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct TokenHash(pub [u8; 32]);

impl std::fmt::Debug for TokenHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TokenHash(…)")
    }
}

/// A token as it is kept: no secret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Its public name, by which it is listed and revoked; the first part of what the client sends.
    pub id: String,
    /// Whose it is, in words.
    pub label: String,
    /// Hash of the secret part.
    pub hash: TokenHash,
    /// What it may do.
    pub scopes: BTreeSet<Scope>,
    /// When it was made, RFC 3339.
    pub created: String,
    /// When it ends, RFC 3339; never where there is none.
    pub expires: Option<String>,
}

/// One benchmark run.
#[derive(Clone, Debug, PartialEq)]
pub struct Benchmark {
    /// Given out by the store, growing.
    pub id: u64,
    /// Name of the series.
    pub name: String,
    /// When it ran, RFC 3339 in UTC.
    pub at: String,
    /// What was measured, JSON.
    pub run: serde_json::Value,
}

/// Which benchmark runs to list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BenchmarkFilter {
    /// Of this series alone.
    pub name: Option<String>,
    /// Run at or after this time, RFC 3339 in UTC.
    pub since: Option<String>,
    /// At most so many, the newest.
    pub limit: u32,
    /// No more than fit into so many bytes of JSON, but always the newest: runs are as large as whoever posts them makes them.
    pub bytes: usize,
}

impl Default for BenchmarkFilter {
    /// Everything, as far as it fits into 16 MiB.
    fn default() -> Self {
        Self { name: None, since: None, limit: u32::MAX, bytes: 16 << 20 }
    }
}

/// Versions, aliases, tokens and benchmarks. Every method is one transaction; what it acknowledged survives a kill.
#[async_trait]
pub trait Metadata: Send + Sync {
    /// Keeps a version and gives it its number. A version of the same table and digest is returned as it is, whatever its
    /// manifest: the second of the pair says whether it is new. `alias` (with the revision that it must have, or `None` for any)
    /// moves to it in the same transaction; one of any revision that points there already stays as it is.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] where the alias is not at the revision given, or the version is quarantined: nothing is kept.
    async fn add_version(
        &self,
        version: NewVersion,
        alias: Option<(&str, Option<u64>)>,
    ) -> Result<(StoredVersion, bool), StoreError>;

    /// Keeps a version that comes with the program, under the number of its manifest where that is free. It points each of
    /// these aliases at the version unless somebody moved the alias by other means or it points at a later one. The same
    /// again changes nothing; the second of the pair says whether the version is new.
    ///
    /// # Errors
    /// [`StoreError::Unwritable`], [`StoreError::Backend`].
    async fn seed(&self, version: NewVersion, aliases: &[&str]) -> Result<(StoredVersion, bool), StoreError>;

    /// All versions of all tables, by name and number.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn versions(&self) -> Result<Vec<StoredVersion>, StoreError>;

    /// The version made from a specification, if there is one that is published.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn version_of_spec(&self, spec_digest: &str) -> Result<Option<StoredVersion>, StoreError>;

    /// All aliases.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn aliases(&self) -> Result<Vec<Alias>, StoreError>;

    /// A version.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    async fn version(&self, table: &str, number: u32) -> Result<StoredVersion, StoreError>;

    /// Points an alias at a published version: `expected` is the revision it must have now (0: there is none yet), or
    /// `None` for any.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] at another revision, naming it; [`StoreError::NotFound`] without such a version.
    async fn move_alias(
        &self,
        table: &str,
        alias: &str,
        number: u32,
        expected: Option<u64>,
    ) -> Result<Alias, StoreError>;

    /// Keeps a token.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] for an id that is taken.
    async fn add_token(&self, token: Token) -> Result<(), StoreError>;

    /// All tokens.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn tokens(&self) -> Result<Vec<Token>, StoreError>;

    /// Ends a token.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    async fn revoke_token(&self, id: &str) -> Result<(), StoreError>;

    /// Keeps a benchmark run; gives its id.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] where `at` is no RFC 3339 time in UTC; [`StoreError::Backend`].
    async fn add_benchmark(&self, name: &str, at: &str, run: serde_json::Value) -> Result<u64, StoreError>;

    /// Benchmark runs, oldest first.
    ///
    /// # Errors
    /// [`StoreError::Backend`].
    async fn benchmarks(&self, filter: &BenchmarkFilter) -> Result<Vec<Benchmark>, StoreError>;

    /// Whether the store answers, for readiness.
    ///
    /// # Errors
    /// Why it does not.
    async fn ping(&self) -> Result<(), StoreError>;
}

/// # Errors
/// [`StoreError::Conflict`] for a version that no alias may point at.
pub(crate) fn check_published(version: &StoredVersion) -> Result<(), StoreError> {
    match version.state {
        VersionState::Published => Ok(()),
        VersionState::Quarantined => Err(StoreError::Conflict {
            reason: format!("version {} of {} is quarantined", version.number, version.table),
        }),
    }
}

/// # Errors
/// [`StoreError::Conflict`] where an alias is not at the revision that it has to be at.
pub(crate) fn check_revision(alias: &str, found: u64, expected: Option<u64>) -> Result<(), StoreError> {
    match expected {
        Some(expected) if expected != found => Err(StoreError::Conflict {
            reason: format!("the alias \"{alias}\" is at revision {found}, not {expected}"),
        }),
        _ => Ok(()),
    }
}
