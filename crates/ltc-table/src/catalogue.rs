//! Named tables and their versions.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::{MANIFEST_FILE, TableError, TableVersion, digest::is_digest};

/// Tables by name, each with its versions.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    tables: BTreeMap<String, BTreeMap<u32, Arc<TableVersion>>>,
}

impl Catalogue {
    /// Adds a version, or replaces the one of the same name and number.
    pub fn insert(&mut self, version: TableVersion) {
        let manifest = version.manifest();
        self.tables.entry(manifest.name.clone()).or_default().insert(manifest.version, Arc::new(version));
    }

    /// Adds every version of another catalogue, replacing those of the same name and number.
    pub fn extend(&mut self, other: &Self) {
        for (name, versions) in &other.tables {
            let known = self.tables.entry(name.clone()).or_default();
            known.extend(versions.iter().map(|(n, v)| (*n, Arc::clone(v))));
        }
    }

    /// Reads `NAME/VERSION/{manifest.json, table.npz}` below a folder. Folders without a manifest and hidden ones, whose
    /// names begin with a dot, are passed over.
    ///
    /// # Errors
    /// [`TableError::Io`] when the folder cannot be read; whatever is wrong with a version that is there.
    pub fn read_folder(folder: &Path) -> Result<Self, TableError> {
        let mut catalogue = Self::default();
        for table in subfolders(folder)? {
            for version in subfolders(&table)? {
                if version.join(MANIFEST_FILE).is_file() {
                    catalogue.insert(TableVersion::read_folder(&version)?);
                }
            }
        }
        Ok(catalogue)
    }

    /// Names in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.tables.keys().map(String::as_str)
    }

    /// Versions of a table, oldest first.
    ///
    /// # Errors
    /// [`TableError::NoSuchTable`].
    pub fn versions(
        &self,
        name: &str,
    ) -> Result<impl DoubleEndedIterator<Item = &Arc<TableVersion>>, TableError> {
        self.tables
            .get(name)
            .map(BTreeMap::values)
            .ok_or_else(|| TableError::NoSuchTable { name: name.to_owned(), known: self.known_names() })
    }

    /// A version by number, digest, or the alias `latest`.
    ///
    /// # Errors
    /// [`TableError::NoSuchTable`], [`TableError::NoSuchVersion`].
    pub fn version(&self, name: &str, version: &str) -> Result<&Arc<TableVersion>, TableError> {
        let mut versions = self.versions(name)?;
        let found = if version == "latest" {
            versions.next_back()
        } else if is_digest(version) {
            versions.find(|v| v.manifest().digest == version)
        } else {
            // As it is written, and no other way: "01" and "+1" name nothing.
            versions.find(|v| v.manifest().version.to_string() == version)
        };
        found.ok_or_else(|| TableError::NoSuchVersion {
            name: name.to_owned(),
            version: version.to_owned(),
            known: self.known_versions(name),
        })
    }

    /// `NAME`, `NAME@VERSION`, or a digest alone.
    ///
    /// # Errors
    /// As [`Catalogue::version`].
    pub fn find(&self, table: &str) -> Result<&Arc<TableVersion>, TableError> {
        if is_digest(table) {
            let by_digest =
                self.tables.values().flat_map(BTreeMap::values).find(|v| v.manifest().digest == table);
            return by_digest.ok_or_else(|| TableError::NoSuchTable {
                name: table.to_owned(),
                known: self.known_names(),
            });
        }
        let (name, version) = table.split_once('@').unwrap_or((table, "latest"));
        self.version(name, version)
    }

    fn known_names(&self) -> String {
        if self.tables.is_empty() { "none".to_owned() } else { self.names().collect::<Vec<_>>().join(", ") }
    }

    fn known_versions(&self, name: &str) -> String {
        let numbers = self.tables.get(name).into_iter().flat_map(BTreeMap::keys).map(u32::to_string);
        numbers.chain(["latest".to_owned()]).collect::<Vec<_>>().join(", ")
    }
}

fn subfolders(folder: &Path) -> Result<Vec<std::path::PathBuf>, TableError> {
    let io = |e| TableError::io(folder, e);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{anisotropic, isotropic, version};

    fn catalogue() -> Catalogue {
        let mut catalogue = Catalogue::default();
        catalogue.insert(version("a", 2, anisotropic()));
        catalogue.insert(version("a", 10, isotropic()));
        catalogue.insert(version("b", 1, isotropic()));
        catalogue
    }

    #[test]
    fn versions_are_found_by_number_digest_and_alias() {
        let catalogue = catalogue();
        let number = |v: &str| catalogue.version("a", v).unwrap().manifest().version;
        assert_eq!(number("2"), 2);
        assert_eq!(number("latest"), 10, "10 comes after 2");
        let digest = catalogue.version("a", "2").unwrap().manifest().digest.clone();
        assert_eq!(number(&digest), 2);
        assert_eq!(catalogue.find("a@2").unwrap().manifest().version, 2);
        assert_eq!(catalogue.find(&digest).unwrap().manifest().name, "a");
    }

    #[test]
    fn what_is_not_there_is_named_with_what_is() {
        let catalogue = catalogue();
        let error = catalogue.find("c").unwrap_err();
        assert_eq!(error.to_string(), "no table named \"c\"; there are: a, b");
        let error = catalogue.find("a@3").unwrap_err();
        assert_eq!(error.to_string(), "table \"a\" has no version \"3\"; there are: 2, 10, latest");
        for odd in ["02", "+2", " 2", ""] {
            assert!(catalogue.version("a", odd).is_err(), "{odd:?}");
        }
        let error = Catalogue::default().find("a").unwrap_err();
        assert_eq!(error.to_string(), "no table named \"a\"; there are: none");
    }

    #[test]
    fn folders_are_read_and_half_written_ones_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        for n in [1, 2] {
            version("a", n, isotropic()).write_folder(&folder.path().join(format!("a/{n}"))).unwrap();
        }
        std::fs::remove_file(folder.path().join("a/2").join(MANIFEST_FILE)).unwrap();
        // What a kill left in the middle of publishing.
        version("a", 3, isotropic()).write_folder(&folder.path().join("a/.3.tmp")).unwrap();
        let catalogue = Catalogue::read_folder(folder.path()).unwrap();
        assert_eq!(catalogue.versions("a").unwrap().count(), 1);
        assert!(Catalogue::read_folder(&folder.path().join("none")).is_err());
    }
}
