//! A folder of tables that grows by whole versions.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{MANIFEST_FILE, Manifest, TableError, TableVersion, files};

/// What became of a version that was to be added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Added {
    /// It is now `NAME/NUMBER`.
    New {
        /// Its number.
        number: u32,
        /// Where it lies.
        folder: PathBuf,
    },
    /// The folder had this very payload already.
    Known {
        /// As this number.
        number: u32,
    },
}

/// Adds a table to a folder as `NAME/NUMBER`, with the first number above all that are taken; the number in its manifest
/// is replaced by it. A payload that is there already is not added again.
///
/// The version is written beside its place and renamed into it, so that a reader sees all of it or nothing, a kill leaves
/// no part of it, and of several that are added at once each gets a number of its own.
///
/// # Errors
/// [`TableError::Io`], naming the file.
pub fn add_version(folder: &Path, version: &TableVersion) -> Result<Added, TableError> {
    let shelf = folder.join(&version.manifest().name);
    let io = |path: &Path| {
        let path = path.to_owned();
        move |e| TableError::io(&path, e)
    };
    fs::create_dir_all(&shelf).map_err(io(&shelf))?;
    loop {
        let taken = numbers(&shelf)?;
        if let Some(number) = taken.iter().copied().find(|n| holds(&shelf, *n, &version.manifest().digest)) {
            return Ok(Added::Known { number });
        }
        let number = taken.last().map_or(1, |n| n + 1);
        let place = shelf.join(number.to_string());
        let beside = files::unused_name(&place).unwrap_or_else(|| place.with_extension("tmp"));
        let moved = version
            .clone()
            .numbered(number)
            .write_folder(&beside)
            .and_then(|()| fs::rename(&beside, &place).map_err(io(&place)));
        match moved {
            Ok(()) => {
                files::sync_folder(&place).map_err(io(&place))?;
                return Ok(Added::New { number, folder: place });
            }
            Err(error) => {
                // Best effort: the error that matters is the one being returned.
                let _ = fs::remove_dir_all(&beside);
                // Somebody took the number in the meantime: the next one, then.
                if !place.exists() {
                    return Err(error);
                }
            }
        }
    }
}

/// The numbers taken, in rising order: whatever lies under a number's name takes it.
fn numbers(shelf: &Path) -> Result<Vec<u32>, TableError> {
    let io = |e| TableError::io(shelf, e);
    let mut numbers = Vec::new();
    for entry in fs::read_dir(shelf).map_err(io)? {
        let name = entry.map_err(io)?.file_name();
        numbers.extend(name.to_str().and_then(|name| name.parse::<u32>().ok()));
    }
    numbers.sort_unstable();
    Ok(numbers)
}

/// Whether that version has this digest, and is whole.
fn holds(shelf: &Path, number: u32, digest: &str) -> bool {
    let folder = shelf.join(number.to_string());
    let manifest = fs::read(folder.join(MANIFEST_FILE)).ok();
    let manifest: Option<Manifest> = manifest.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    // Reading all of it checks the digest against the payload.
    manifest.is_some_and(|m| m.digest == digest) && TableVersion::read_folder(&folder).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Catalogue, PAYLOAD_FILE,
        testing::{anisotropic, isotropic, version},
    };

    #[test]
    fn numbers_count_up_and_nothing_is_added_twice() {
        let folder = tempfile::tempdir().unwrap();
        let add = |table| add_version(folder.path(), &version("a", 77, table)).unwrap();
        let place = |n: u32| Added::New { number: n, folder: folder.path().join(format!("a/{n}")) };
        assert_eq!(add(isotropic()), place(1));
        assert_eq!(add(anisotropic()), place(2));
        assert_eq!(add(isotropic()), Added::Known { number: 1 });
        let catalogue = Catalogue::read_folder(folder.path()).unwrap();
        let numbers: Vec<u32> = catalogue.versions("a").unwrap().map(|v| v.manifest().version).collect();
        assert_eq!(numbers, [1, 2]);
        assert_eq!(fs::read_dir(folder.path().join("a")).unwrap().count(), 2, "nothing else is left");
    }

    #[test]
    fn what_lies_there_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let add = || add_version(folder.path(), &version("a", 1, isotropic())).unwrap();
        // A folder that is no version, a file of a number's name, and a version that is damaged.
        fs::create_dir_all(folder.path().join("a/3")).unwrap();
        fs::write(folder.path().join("a/3/notes"), "mine").unwrap();
        fs::write(folder.path().join("a/4"), "mine").unwrap();
        assert!(matches!(add(), Added::New { number: 5, .. }));
        fs::write(folder.path().join("a/5").join(PAYLOAD_FILE), "").unwrap();
        assert!(matches!(add(), Added::New { number: 6, .. }));
        assert_eq!(fs::read(folder.path().join("a/4")).unwrap(), b"mine");
        assert_eq!(fs::read(folder.path().join("a/3/notes")).unwrap(), b"mine");
    }

    #[test]
    fn many_at_once_each_get_a_number() {
        let folder = tempfile::tempdir().unwrap();
        let tables: Vec<_> = (0..8).map(|i| crate::testing::scaled(1.0 / f64::from(i + 1))).collect();
        std::thread::scope(|scope| {
            for table in tables.iter().chain(&tables) {
                let folder = folder.path();
                scope.spawn(move || add_version(folder, &version("a", 1, table.clone())).unwrap());
            }
        });
        let catalogue = Catalogue::read_folder(folder.path()).unwrap();
        let versions: Vec<_> = catalogue.versions("a").unwrap().collect();
        let numbers: Vec<u32> = versions.iter().map(|v| v.manifest().version).collect();
        assert_eq!(numbers, (1..=8).collect::<Vec<_>>(), "each table once");
        let mut digests: Vec<&str> = versions.iter().map(|v| v.manifest().digest.as_str()).collect();
        digests.sort_unstable();
        digests.dedup();
        assert_eq!(digests.len(), 8);
    }
}
