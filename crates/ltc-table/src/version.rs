//! One version of a table: manifest and payload, checked against each other.

use std::borrow::Cow;
use std::path::Path;

use crate::{
    ChannelInfo, Channels, ClosedForm, Manifest, Precision, Table, TableError, digest::digest, files, npz,
};

/// The payload's file name.
pub const PAYLOAD_FILE: &str = "table.npz";
/// The manifest's file name.
pub const MANIFEST_FILE: &str = "manifest.json";

/// An immutable version of a table.
#[derive(Clone, Debug)]
pub struct TableVersion {
    manifest: Manifest,
    payload: Cow<'static, [u8]>,
    table: Table,
}

impl TableVersion {
    /// Joins a manifest and a payload.
    ///
    /// # Errors
    /// [`TableError::DigestMismatch`], or whatever else is wrong with either.
    pub fn new(manifest: Manifest, payload: impl Into<Cow<'static, [u8]>>) -> Result<Self, TableError> {
        let payload = payload.into();
        check_name(&manifest.name)?;
        let found = digest(&payload);
        if found != manifest.digest {
            return Err(TableError::DigestMismatch { expected: manifest.digest, found });
        }
        if manifest.lobes != 1 {
            let what = format!("lobes: {} in the manifest, 1 in the payload", manifest.lobes);
            return Err(TableError::Disagreement { what });
        }
        let table = npz::read(&payload, &manifest.axes)?;
        check_closed_form(&manifest, &table)?;
        Ok(Self { manifest, payload, table })
    }

    /// As [`TableVersion::new`], from the manifest's JSON.
    ///
    /// # Errors
    /// As [`TableVersion::new`], and [`TableError::Manifest`].
    pub fn from_json(manifest: &[u8], payload: impl Into<Cow<'static, [u8]>>) -> Result<Self, TableError> {
        Self::new(serde_json::from_slice(manifest)?, payload)
    }

    /// The canonical payload of a table: every channel as `f64` NPZ.
    ///
    /// # Errors
    /// None for a valid table; those of [`npz::write`].
    pub fn payload_of(table: &Table) -> Result<Vec<u8>, TableError> {
        npz::write(table, Precision::F64, Channels::ALL)
    }

    /// Reads `manifest.json` and `table.npz` from a folder.
    ///
    /// # Errors
    /// [`TableError::Io`] and those of [`TableVersion::new`].
    pub fn read_folder(folder: &Path) -> Result<Self, TableError> {
        let read = |name: &str| {
            let path = folder.join(name);
            std::fs::read(&path).map_err(|e| TableError::io(&path, e))
        };
        Self::from_json(&read(MANIFEST_FILE)?, read(PAYLOAD_FILE)?)
    }

    /// Writes `table.npz`, then `manifest.json`, each atomically: a folder with a manifest is complete.
    ///
    /// # Errors
    /// [`TableError::Io`].
    pub fn write_folder(&self, folder: &Path) -> Result<(), TableError> {
        std::fs::create_dir_all(folder).map_err(|e| TableError::io(folder, e))?;
        files::write_atomically(&folder.join(PAYLOAD_FILE), &self.payload)?;
        files::write_atomically(&folder.join(MANIFEST_FILE), self.manifest_json()?.as_bytes())
    }

    /// The same table as another number.
    #[must_use]
    pub fn numbered(mut self, number: u32) -> Self {
        self.manifest.version = number;
        self
    }

    /// What the version says about itself.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The manifest as indented JSON with a newline at the end.
    ///
    /// # Errors
    /// [`TableError::Manifest`], which no valid manifest gives.
    pub fn manifest_json(&self) -> Result<String, TableError> {
        Ok(serde_json::to_string_pretty(&self.manifest)? + "\n")
    }

    /// The bytes that the digest is of: an NPZ archive.
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// The table.
    pub fn table(&self) -> &Table {
        &self.table
    }
}

/// Who reads only the manifest must interpolate as who reads only the payload does.
fn check_closed_form(manifest: &Manifest, table: &Table) -> Result<(), TableError> {
    let name = |form: Option<ClosedForm>| form.map_or("none", ClosedForm::name);
    let held = |channel: &&ChannelInfo| ["magnitude", "fresnel"].contains(&&channel.name[..]);
    match manifest.channels.iter().filter(held).find(|c| c.closed_form != table.closed_form()) {
        None => Ok(()),
        Some(ChannelInfo { name: channel, closed_form, .. }) => {
            let (stated, found) = (name(*closed_form), name(table.closed_form()));
            let what =
                format!("the closed form of {channel}: {stated} in the manifest, {found} in the payload");
            Err(TableError::Disagreement { what })
        }
    }
}

/// # Errors
/// [`TableError::BadName`] unless `name` is 1 to 64 of a–z, 0–9 and `-`, a letter first: safe in paths and URLs.
pub fn check_name(name: &str) -> Result<(), TableError> {
    let plain = name.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-'));
    if plain && name.len() <= 64 && name.starts_with(|c: char| c.is_ascii_lowercase()) {
        Ok(())
    } else {
        Err(TableError::BadName { name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{anisotropic, version};

    #[test]
    fn a_folder_comes_back_and_damage_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let original = version("test", 3, anisotropic());
        original.write_folder(folder.path()).unwrap();
        let back = TableVersion::read_folder(folder.path()).unwrap();
        assert_eq!(back.manifest(), original.manifest());
        assert_eq!(back.table(), original.table());

        let path = folder.path().join(PAYLOAD_FILE);
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let error = TableVersion::read_folder(folder.path()).unwrap_err();
        assert!(matches!(error, TableError::DigestMismatch { .. }), "{error}");
    }

    #[test]
    fn manifest_and_payload_name_the_same_closed_form() {
        let table = anisotropic().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        for (held, table) in [(None, anisotropic()), (Some(ClosedForm::GgxSmith), table)] {
            let version = version("test", 1, table);
            for stated in [None, Some(ClosedForm::GgxSmith)] {
                let channel = |name: &str| ChannelInfo {
                    name: name.into(),
                    shape: Vec::new(),
                    meaning: String::new(),
                    closed_form: if name == "m" { None } else { stated },
                };
                let channels = ["m", "magnitude", "fresnel"].map(channel).into();
                let manifest = Manifest { channels, ..version.manifest().clone() };
                let json = serde_json::to_string(&manifest).unwrap();
                assert_eq!(json.contains("\"closed_form\":\"ggx-smith\""), stated.is_some());
                let joined = TableVersion::from_json(json.as_bytes(), version.payload().to_vec());
                assert_eq!(joined.is_ok(), held == stated);
                assert!(joined.map_or(true, |back| back.table() == version.table()));
            }
        }
    }

    #[test]
    fn names_that_could_leave_the_folder_are_refused() {
        for bad in ["", "..", "a/b", "A", "1a", "a b", "a\n", &"a".repeat(65)] {
            assert!(check_name(bad).is_err(), "{bad:?}");
        }
        assert!(check_name("ggx-anisotropic-2").is_ok());
    }
}
