//! Versions, aliases, tokens and benchmarks in SQLite.

use async_trait::async_trait;
use rusqlite::{Connection, OptionalExtension, params};

use super::EmbeddedStore;
use super::database::failed;
use super::rows::{self, Json, Name};
use crate::{
    Alias, Benchmark, BenchmarkFilter, Metadata, NewVersion, StoreError, StoredVersion, Token, VersionState,
    clock,
};

#[async_trait]
impl Metadata for EmbeddedStore {
    async fn add_version(
        &self,
        version: NewVersion,
        alias: Option<(&str, Option<u64>)>,
    ) -> Result<(StoredVersion, bool), StoreError> {
        let alias = alias.map(|(name, expected)| (name.to_owned(), expected));
        self.database
            .write(move |db| {
                let (version, new) = keep(db, version, None)?;
                if let Some((name, expected)) = alias {
                    let there = find_alias(db, &version.table, &name)?;
                    let points = there.is_some_and(|(there, _)| there.number == version.number);
                    if expected.is_some() || !points {
                        point(db, &version.table, &name, version.number, expected, false)?;
                    }
                }
                Ok((version, new))
            })
            .await
    }

    async fn seed(&self, version: NewVersion, aliases: &[&str]) -> Result<(StoredVersion, bool), StoreError> {
        let aliases: Vec<String> = aliases.iter().map(|&name| name.to_owned()).collect();
        self.database
            .write(move |db| {
                let wanted = version.manifest["version"].as_u64().and_then(|n| u32::try_from(n).ok());
                let (version, new) = keep(db, version, wanted.filter(|n| *n > 0))?;
                for name in &aliases {
                    let free = match find_alias(db, &version.table, name)? {
                        None => true,
                        Some((there, seeded)) => seeded && there.number < version.number,
                    };
                    if free && version.state == VersionState::Published {
                        point(db, &version.table, name, version.number, None, true)?;
                    }
                }
                Ok((version, new))
            })
            .await
    }

    async fn versions(&self) -> Result<Vec<StoredVersion>, StoreError> {
        let sql = format!("SELECT {} FROM versions ORDER BY name, number", rows::VERSION);
        self.database.read(move |db| all(db, &sql, [], rows::version)).await
    }

    async fn version(&self, table: &str, number: u32) -> Result<StoredVersion, StoreError> {
        let table = table.to_owned();
        self.database
            .read(move |db| find_version(db, &table, number)?.ok_or_else(|| no_version(&table, number)))
            .await
    }

    async fn version_of_spec(&self, spec_digest: &str) -> Result<Option<StoredVersion>, StoreError> {
        let sql = format!(
            "SELECT {} FROM versions WHERE spec_digest = ? AND state = 'published' ORDER BY number DESC LIMIT 1",
            rows::VERSION
        );
        let spec = spec_digest.to_owned();
        self.database
            .read(move |db| db.query_row(&sql, [spec], rows::version).optional().map_err(failed))
            .await
    }

    async fn aliases(&self) -> Result<Vec<Alias>, StoreError> {
        let sql = format!("SELECT {} FROM aliases ORDER BY name, alias", rows::ALIAS);
        self.database.read(move |db| all(db, &sql, [], rows::alias)).await
    }

    async fn move_alias(
        &self,
        table: &str,
        alias: &str,
        number: u32,
        expected: Option<u64>,
    ) -> Result<Alias, StoreError> {
        let (table, alias) = (table.to_owned(), alias.to_owned());
        self.database.write(move |db| point(db, &table, &alias, number, expected, false)).await
    }

    async fn add_token(&self, token: Token) -> Result<(), StoreError> {
        self.database
            .write(move |db| {
                let Token { id, label, hash, scopes, created, expires } = token;
                let sql = "INSERT INTO tokens VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING";
                let added = db.execute(sql, params![id, label, hash.0, Json(scopes), created, expires]);
                if added.map_err(failed)? == 0 {
                    return Err(StoreError::Conflict { reason: format!("there is a token {id} already") });
                }
                Ok(())
            })
            .await
    }

    async fn tokens(&self) -> Result<Vec<Token>, StoreError> {
        let sql = format!("SELECT {} FROM tokens ORDER BY created, id", rows::TOKEN);
        self.database.read(move |db| all(db, &sql, [], rows::token)).await
    }

    async fn revoke_token(&self, id: &str) -> Result<(), StoreError> {
        let id = id.to_owned();
        self.database
            .write(move |db| {
                let gone = db.execute("DELETE FROM tokens WHERE id = ?", [&id]).map_err(failed)?;
                if gone == 0 { Err(StoreError::NotFound { what: "token", name: id }) } else { Ok(()) }
            })
            .await
    }

    async fn add_benchmark(&self, name: &str, at: &str, run: serde_json::Value) -> Result<u64, StoreError> {
        let (name, at, micros) = (name.to_owned(), at.to_owned(), clock::parse(at)?);
        self.database
            .write(move |db| {
                let sql = "INSERT INTO benchmarks (name, at, at_micros, run) VALUES (?, ?, ?, ?)";
                db.execute(sql, params![name, at, micros, Json(run)]).map_err(failed)?;
                Ok(db.last_insert_rowid().unsigned_abs())
            })
            .await
    }

    async fn benchmarks(&self, filter: &BenchmarkFilter) -> Result<Vec<Benchmark>, StoreError> {
        let since = filter.since.as_deref().map(clock::parse).transpose()?;
        let (name, limit, most) = (filter.name.clone(), filter.limit, filter.bytes);
        let sql = format!(
            "SELECT {} FROM benchmarks WHERE (?1 IS NULL OR name = ?1) AND at_micros >= ?2 \
             ORDER BY at_micros DESC, id DESC LIMIT ?3",
            rows::BENCHMARK
        );
        let since = since.unwrap_or(i64::MIN);
        self.database
            .read(move |db| {
                let mut statement = db.prepare_cached(&sql).map_err(failed)?;
                let mut rows = statement.query(params![name, since, limit]).map_err(failed)?;
                let (mut found, mut bytes) = (Vec::new(), 0);
                while let Some(row) = rows.next().map_err(failed)? {
                    bytes += rows::benchmark_bytes(row).map_err(failed)?;
                    if bytes > most && !found.is_empty() {
                        break;
                    }
                    found.push(rows::benchmark(row).map_err(failed)?);
                }
                found.reverse();
                Ok(found)
            })
            .await
    }

    async fn ping(&self) -> Result<(), StoreError> {
        let database = self.database.clone();
        self.database
            .read(move |db| {
                // SQLite goes on with a file that was deleted; nobody would find again what it writes there.
                if !database.is_in_place() {
                    let reason = "the database's file is gone, or another one is in its place";
                    return Err(StoreError::Backend(reason.to_owned()));
                }
                db.query_row("SELECT count(*) FROM tokens", [], |_| Ok(())).map_err(failed)
            })
            .await
    }
}

/// All rows of a query.
pub(super) fn all<T>(
    db: &Connection,
    sql: &str,
    params: impl rusqlite::Params,
    row: impl FnMut(&rusqlite::Row<'_>) -> rusqlite::Result<T>,
) -> Result<Vec<T>, StoreError> {
    let mut statement = db.prepare_cached(sql).map_err(failed)?;
    statement.query_map(params, row).and_then(Iterator::collect).map_err(failed)
}

/// Keeps a version, under `wanted` where that is free, or finds the one of its digest.
fn keep(
    db: &Connection,
    version: NewVersion,
    wanted: Option<u32>,
) -> Result<(StoredVersion, bool), StoreError> {
    let NewVersion { table, digest, mut manifest, state, spec_digest, reason } = version;
    let sql = format!("SELECT {} FROM versions WHERE name = ? AND digest = ?", rows::VERSION);
    if let Some(there) = db.query_row(&sql, [&table, &digest], rows::version).optional().map_err(failed)? {
        return Ok((there, false));
    }
    let last = "SELECT coalesce(max(number), 0) FROM versions WHERE name = ?";
    let next = 1 + db.query_row(last, [&table], |row| row.get::<_, u32>(0)).map_err(failed)?;
    let number = match wanted {
        Some(wanted) if find_version(db, &table, wanted)?.is_none() => wanted,
        _ => next,
    };
    if let Some(fields) = manifest.as_object_mut() {
        fields.insert("version".to_owned(), number.into());
    }
    let kept = StoredVersion { table, number, digest, manifest, state, spec_digest, reason };
    db.execute(
        "INSERT INTO versions VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        params![
            kept.table,
            kept.number,
            kept.digest,
            Json(&kept.manifest),
            Name(kept.state),
            kept.spec_digest,
            kept.reason,
            clock::now()
        ],
    )
    .map_err(failed)?;
    Ok((kept, true))
}

fn find_version(db: &Connection, table: &str, number: u32) -> Result<Option<StoredVersion>, StoreError> {
    let sql = format!("SELECT {} FROM versions WHERE name = ? AND number = ?", rows::VERSION);
    db.query_row(&sql, params![table, number], rows::version).optional().map_err(failed)
}

fn no_version(table: &str, number: u32) -> StoreError {
    StoreError::NotFound { what: "version", name: format!("{table}@{number}") }
}

/// An alias, and whether only [`Metadata::seed`] has moved it so far.
fn find_alias(db: &Connection, table: &str, name: &str) -> Result<Option<(Alias, bool)>, StoreError> {
    let sql = format!("SELECT {}, seeded FROM aliases WHERE name = ? AND alias = ?", rows::ALIAS);
    let row = db.query_row(&sql, [table, name], |row| Ok((rows::alias(row)?, row.get(4)?)));
    row.optional().map_err(failed)
}

/// Moves an alias.
fn point(
    db: &Connection,
    table: &str,
    name: &str,
    number: u32,
    expected: Option<u64>,
    seeded: bool,
) -> Result<Alias, StoreError> {
    let version = find_version(db, table, number)?.ok_or_else(|| no_version(table, number))?;
    crate::metadata::check_published(&version)?;
    let there = find_alias(db, table, name)?.map_or(0, |(alias, _)| alias.revision);
    crate::metadata::check_revision(name, there, expected)?;
    let revision = there + 1;
    db.execute(
        "INSERT INTO aliases VALUES (?1, ?2, ?3, ?4, ?5) \
         ON CONFLICT DO UPDATE SET number = ?3, revision = ?4, seeded = ?5",
        params![table, name, number, revision.cast_signed(), seeded],
    )
    .map_err(failed)?;
    Ok(Alias { table: table.to_owned(), name: name.to_owned(), number, revision })
}
