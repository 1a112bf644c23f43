//! A store in memory, for tests: nothing outlives the process.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use async_trait::async_trait;
use tokio::sync::watch;

use crate::metadata::{check_published, check_revision};
use crate::{
    Alias, Benchmark, BenchmarkFilter, BlobKind, Blobs, Metadata, NewVersion, StoreError, StoredVersion,
    Token, VersionState, clock, key,
};

mod jobs;

/// A store in memory: written without SQLite and files, so that the suites of [`crate::conformance`] hold two
/// implementations against each other.
#[derive(Clone)]
pub struct MemoryStore {
    state: Arc<Mutex<State>>,
    changes: watch::Sender<u64>,
}

#[derive(Default)]
struct State {
    /// By table and number.
    versions: BTreeMap<(String, u32), StoredVersion>,
    /// By table and name; and whether only seeding has moved it.
    aliases: BTreeMap<(String, String), (Alias, bool)>,
    tokens: Vec<Token>,
    benchmarks: Vec<(i64, Benchmark)>,
    blobs: HashMap<BlobKind, BTreeMap<String, Vec<u8>>>,
    jobs: Vec<jobs::Kept>,
}

impl Default for MemoryStore {
    fn default() -> Self {
        Self { state: Arc::default(), changes: watch::channel(0).0 }
    }
}

impl MemoryStore {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn keep(&mut self, new: NewVersion, wanted: Option<u32>) -> (StoredVersion, bool) {
        let of_table = |(table, _): &&(String, u32)| *table == new.table;
        let same = self.versions.values().find(|v| v.table == new.table && v.digest == new.digest);
        if let Some(there) = same {
            return (there.clone(), false);
        }
        let next = 1 + self.versions.keys().filter(of_table).map(|(_, number)| *number).max().unwrap_or(0);
        let free = |number: &u32| !self.versions.contains_key(&(new.table.clone(), *number));
        let number = wanted.filter(free).unwrap_or(next);
        let NewVersion { table, digest, mut manifest, state, spec_digest, reason } = new;
        if manifest.is_object() {
            manifest["version"] = number.into();
        }
        let kept = StoredVersion { table, number, digest, manifest, state, spec_digest, reason };
        self.versions.insert((kept.table.clone(), number), kept.clone());
        (kept, true)
    }

    fn point(
        &mut self,
        table: &str,
        name: &str,
        number: u32,
        expected: Option<u64>,
        seeded: bool,
    ) -> Result<Alias, StoreError> {
        let version =
            self.versions.get(&(table.to_owned(), number)).ok_or_else(|| no_version(table, number))?;
        check_published(version)?;
        let place = (table.to_owned(), name.to_owned());
        let there = self.aliases.get(&place).map_or(0, |(alias, _)| alias.revision);
        check_revision(name, there, expected)?;
        let alias = Alias { table: table.to_owned(), name: name.to_owned(), number, revision: there + 1 };
        self.aliases.insert(place, (alias.clone(), seeded));
        Ok(alias)
    }
}

fn no_version(table: &str, number: u32) -> StoreError {
    StoreError::NotFound { what: "version", name: format!("{table}@{number}") }
}

#[async_trait]
impl Metadata for MemoryStore {
    async fn add_version(
        &self,
        version: NewVersion,
        alias: Option<(&str, Option<u64>)>,
    ) -> Result<(StoredVersion, bool), StoreError> {
        let mut state = self.state();
        let (kept, new) = state.keep(version, None);
        let Some((name, expected)) = alias else { return Ok((kept, new)) };
        let there = state.aliases.get(&(kept.table.clone(), name.to_owned()));
        if expected.is_some() || there.is_none_or(|(alias, _)| alias.number != kept.number) {
            let moved = state.point(&kept.table, name, kept.number, expected, false);
            if let (Err(error), true) = (moved, new) {
                state.versions.remove(&(kept.table, kept.number));
                return Err(error);
            }
        }
        Ok((kept, new))
    }

    async fn seed(&self, version: NewVersion, aliases: &[&str]) -> Result<(StoredVersion, bool), StoreError> {
        let mut state = self.state();
        let wanted = version.manifest["version"].as_u64().and_then(|n| u32::try_from(n).ok());
        let (kept, new) = state.keep(version, wanted.filter(|n| *n > 0));
        for name in aliases {
            let there = state.aliases.get(&(kept.table.clone(), (*name).to_owned()));
            let free = there.is_none_or(|(alias, seeded)| *seeded && alias.number < kept.number);
            if free && kept.state == VersionState::Published {
                state.point(&kept.table, name, kept.number, None, true)?;
            }
        }
        Ok((kept, new))
    }

    async fn versions(&self) -> Result<Vec<StoredVersion>, StoreError> {
        Ok(self.state().versions.values().cloned().collect())
    }

    async fn version(&self, table: &str, number: u32) -> Result<StoredVersion, StoreError> {
        let found = self.state().versions.get(&(table.to_owned(), number)).cloned();
        found.ok_or_else(|| no_version(table, number))
    }

    async fn version_of_spec(&self, spec_digest: &str) -> Result<Option<StoredVersion>, StoreError> {
        let state = self.state();
        let of_spec = |v: &&StoredVersion| v.spec_digest.as_deref() == Some(spec_digest);
        let published = |v: &&StoredVersion| v.state == VersionState::Published;
        Ok(state.versions.values().filter(of_spec).filter(published).max_by_key(|v| v.number).cloned())
    }

    async fn aliases(&self) -> Result<Vec<Alias>, StoreError> {
        Ok(self.state().aliases.values().map(|(alias, _)| alias.clone()).collect())
    }

    async fn move_alias(
        &self,
        table: &str,
        alias: &str,
        number: u32,
        expected: Option<u64>,
    ) -> Result<Alias, StoreError> {
        self.state().point(table, alias, number, expected, false)
    }

    async fn add_token(&self, token: Token) -> Result<(), StoreError> {
        let mut state = self.state();
        if state.tokens.iter().any(|t| t.id == token.id) {
            return Err(StoreError::Conflict { reason: format!("there is a token {} already", token.id) });
        }
        state.tokens.push(token);
        Ok(())
    }

    async fn tokens(&self) -> Result<Vec<Token>, StoreError> {
        let mut tokens = self.state().tokens.clone();
        tokens.sort_by(|a, b| (&a.created, &a.id).cmp(&(&b.created, &b.id)));
        Ok(tokens)
    }

    async fn revoke_token(&self, id: &str) -> Result<(), StoreError> {
        let mut state = self.state();
        let before = state.tokens.len();
        state.tokens.retain(|token| token.id != id);
        if state.tokens.len() == before {
            return Err(StoreError::NotFound { what: "token", name: id.to_owned() });
        }
        Ok(())
    }

    async fn add_benchmark(&self, name: &str, at: &str, run: serde_json::Value) -> Result<u64, StoreError> {
        let micros = clock::parse(at)?;
        let mut state = self.state();
        let id = 1 + state.benchmarks.len() as u64;
        let benchmark = Benchmark { id, name: name.to_owned(), at: at.to_owned(), run };
        state.benchmarks.push((micros, benchmark));
        Ok(id)
    }

    async fn benchmarks(&self, filter: &BenchmarkFilter) -> Result<Vec<Benchmark>, StoreError> {
        let since = filter.since.as_deref().map(clock::parse).transpose()?.unwrap_or(i64::MIN);
        let mut found = self.state().benchmarks.clone();
        found.retain(|(at, b)| *at >= since && filter.name.as_ref().is_none_or(|name| *name == b.name));
        found.sort_by_key(|(at, b)| (*at, b.id));
        let mut bytes = 0;
        let fits = |(place, (_, benchmark)): &(usize, &(i64, Benchmark))| {
            bytes += benchmark.run.to_string().len();
            bytes <= filter.bytes || *place == 0
        };
        let count = found.iter().rev().take(filter.limit as usize).enumerate().take_while(fits).count();
        let first = found.len() - count;
        Ok(found.split_off(first).into_iter().map(|(_, b)| b).collect())
    }

    async fn ping(&self) -> Result<(), StoreError> {
        Ok(())
    }
}

#[async_trait]
impl Blobs for MemoryStore {
    async fn put(&self, kind: BlobKind, key: &str, bytes: &[u8]) -> Result<(), StoreError> {
        key::check_to_write(kind, key, bytes)?;
        let mut state = self.state();
        state.blobs.entry(kind).or_default().entry(key.to_owned()).or_insert_with(|| bytes.to_vec());
        Ok(())
    }

    async fn get(&self, kind: BlobKind, key: &str) -> Result<Vec<u8>, StoreError> {
        let found = self.state().blobs.get(&kind).and_then(|blobs| blobs.get(key)).cloned();
        found.ok_or_else(|| key::not_found(key))
    }

    async fn contains(&self, kind: BlobKind, key: &str) -> Result<bool, StoreError> {
        Ok(self.state().blobs.get(&kind).is_some_and(|blobs| blobs.contains_key(key)))
    }

    async fn delete(&self, kind: BlobKind, key: &str) -> Result<(), StoreError> {
        self.state().blobs.entry(kind).or_default().remove(key);
        Ok(())
    }

    async fn list(&self, kind: BlobKind) -> Result<Vec<(String, u64)>, StoreError> {
        let state = self.state();
        let sizes = state.blobs.get(&kind).into_iter().flatten();
        Ok(sizes.map(|(key, bytes)| (key.clone(), bytes.len() as u64)).collect())
    }
}
