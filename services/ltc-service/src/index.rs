//! What there is, in memory: reads ask here and never wait for the store's metadata.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use ltc_store::{Alias, LATEST, StoreError, StoredVersion, VersionState};
use ltc_table::{Manifest, TableError};

use crate::{ApiError, Stores};

/// All tables at one moment. It is replaced as a whole, never changed.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Index {
    tables: BTreeMap<String, Entry>,
    aliases: Vec<Alias>,
}

/// A table that has a published version.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Entry {
    versions: BTreeMap<u32, Arc<Manifest>>,
    aliases: BTreeMap<String, Alias>,
}

/// What a path names.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub manifest: Arc<Manifest>,
    /// Whether it was named by what cannot change: digest or number, not an alias.
    pub pinned: bool,
}

/// How many names an error lists at most.
const LISTED: usize = 20;

impl Index {
    /// Reads what the store has now. Manifests that `old` has are taken from there: they never change, and reading hundreds of
    /// them every other second would be felt.
    pub(crate) async fn read(stores: &Stores, old: &Self) -> Result<Self, StoreError> {
        let (versions, aliases) = (stores.metadata.versions().await?, stores.metadata.aliases().await?);
        Ok(Self::new(versions, aliases, old))
    }

    fn new(versions: Vec<StoredVersion>, aliases: Vec<Alias>, old: &Self) -> Self {
        let mut tables: BTreeMap<String, Entry> = BTreeMap::new();
        for version in versions.into_iter().filter(|v| v.state == VersionState::Published) {
            let (table, number) = (version.table, version.number);
            let known = old.tables.get(&table).and_then(|entry| entry.versions.get(&number));
            if let Some(known) = known.filter(|manifest| manifest.digest == version.digest) {
                tables.entry(table).or_default().versions.insert(number, Arc::clone(known));
                continue;
            }
            match serde_json::from_value::<Manifest>(version.manifest) {
                Ok(manifest) => {
                    tables.entry(table).or_default().versions.insert(number, Arc::new(manifest));
                }
                // A newer program may have written it; what this one understands is served all the same.
                Err(error) => tracing::error!(table, number, %error, "a manifest cannot be read"),
            }
        }
        for alias in &aliases {
            if let Some(entry) = tables.get_mut(&alias.table)
                && entry.versions.contains_key(&alias.number)
            {
                entry.aliases.insert(alias.name.clone(), alias.clone());
            }
        }
        Self { tables, aliases }
    }

    /// Names in alphabetical order.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.tables.keys().map(String::as_str)
    }

    /// A table.
    pub(crate) fn table(&self, name: &str) -> Result<&Entry, ApiError> {
        self.tables.get(name).ok_or_else(|| {
            let known = listed(self.names().map(str::to_owned), "");
            TableError::NoSuchTable { name: name.to_owned(), known }.into()
        })
    }

    /// A version by number, digest or alias.
    pub(crate) fn version(&self, name: &str, version: &str) -> Result<Found, ApiError> {
        let entry = self.table(name)?;
        let found = |manifest: &Arc<Manifest>, pinned| Found { manifest: Arc::clone(manifest), pinned };
        let pinned = if version.starts_with("sha256:") {
            entry.versions.values().find(|m| m.digest == version)
        } else {
            // As it is written, and no other way: "01" and "+1" name nothing.
            let number = version.parse().ok().filter(|n: &u32| n.to_string() == version);
            number.and_then(|n| entry.versions.get(&n))
        };
        if let Some(manifest) = pinned {
            return Ok(found(manifest, true));
        }
        let aliased = entry.aliased(version);
        aliased.map(|manifest| found(manifest, false)).ok_or_else(|| {
            let numbers = entry.versions.keys().rev().map(u32::to_string);
            let aliases = entry.aliases.keys().filter(|name| *name != LATEST).cloned();
            let known = listed(numbers.chain(aliases), LATEST);
            TableError::NoSuchVersion { name: name.to_owned(), version: version.to_owned(), known }.into()
        })
    }

    /// `NAME@VERSION` of any table.
    pub(crate) fn find(&self, text: &str) -> Result<Found, ApiError> {
        let (name, version) = text.split_once('@').unwrap_or((text, LATEST));
        self.version(name, version)
    }
}

impl Entry {
    /// Manifests, oldest first.
    pub(crate) fn versions(&self) -> impl DoubleEndedIterator<Item = &Arc<Manifest>> {
        self.versions.values()
    }

    /// Numbers, oldest first.
    pub(crate) fn numbers(&self) -> Vec<u32> {
        self.versions.keys().copied().collect()
    }

    /// The newest version, or the one that `latest` was moved to.
    pub(crate) fn latest(&self) -> Option<&Arc<Manifest>> {
        self.aliased(LATEST)
    }

    /// All aliases in alphabetical order, `latest` among them, whether or not somebody has set it.
    pub(crate) fn aliases(&self, table: &str) -> Vec<Alias> {
        let names: BTreeSet<&str> = self.aliases.keys().map(String::as_str).chain([LATEST]).collect();
        names.into_iter().filter_map(|name| self.alias(table, name)).collect()
    }

    /// An alias; `latest` that nobody has set has the revision 0.
    pub(crate) fn alias(&self, table: &str, name: &str) -> Option<Alias> {
        let unset = || {
            let number = self.number(name)?;
            Some(Alias { table: table.to_owned(), name: name.to_owned(), number, revision: 0 })
        };
        self.aliases.get(name).cloned().or_else(unset)
    }

    fn aliased(&self, alias: &str) -> Option<&Arc<Manifest>> {
        self.versions.get(&self.number(alias)?)
    }

    /// Which version an alias points at.
    fn number(&self, alias: &str) -> Option<u32> {
        match self.aliases.get(alias) {
            Some(alias) => Some(alias.number),
            None if alias == LATEST => self.versions.keys().next_back().copied(),
            None => None,
        }
    }
}

fn listed(names: impl Iterator<Item = String>, last: &str) -> String {
    let mut names: Vec<String> = names.take(LISTED + 1).collect();
    if names.len() > LISTED {
        names[LISTED] = "…".to_owned();
    }
    if !last.is_empty() {
        names.push(last.to_owned());
    }
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
