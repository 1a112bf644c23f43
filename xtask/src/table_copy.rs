//! A table, fetched from the service into a folder that `ltc --tables` reads.

use std::fs::{self, File};
use std::io::Write as _;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use crate::http;

/// What was fetched.
#[derive(Debug)]
pub struct TableCopy {
    /// Where it lies: `…/NAME/VERSION`, with `manifest.json` and `table.npz`.
    pub folder: PathBuf,
    /// `sha256:` and the hexadecimal digits, as the manifest says and the payload has.
    pub digest: String,
    /// Of the payload, in bytes.
    pub len: usize,
}

impl TableCopy {
    /// Fetches the latest version of the table `name` into `tables`. A payload whose digest is not the manifest's is
    /// an error, and nothing is written.
    pub fn fetch(server: SocketAddr, name: &str, tables: &Path) -> Result<Self> {
        let latest = format!("/v1/tables/{name}/versions/latest");
        let manifest_text = http::get_ok(server, &latest)?;
        let payload = http::get_ok(server, &format!("{latest}/data?format=npz"))?;
        let manifest: Value = serde_json::from_slice(&manifest_text).context("the manifest is no JSON")?;
        let version =
            manifest["version"].as_u64().context("the manifest has no whole number as its 'version'")?;
        let promised = manifest["digest"].as_str().context("the manifest has no 'digest'")?;
        let digest = digest(&payload);
        if promised != digest {
            bail!(
                "the payload of {name} version {version} has digest {digest}, its manifest says {promised}"
            );
        }
        let folder = tables.join(name).join(version.to_string());
        fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        write_whole(&folder.join("table.npz"), &payload)?;
        write_whole(&folder.join("manifest.json"), &manifest_text)?;
        Ok(Self { folder, digest, len: payload.len() })
    }
}

fn digest(bytes: &[u8]) -> String {
    let hex: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("sha256:{hex}")
}

/// Writes beside the file, syncs, renames: a reader sees the old file or the whole new one.
fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let beside = path.with_extension("tmp");
    let write = || -> std::io::Result<()> {
        let mut file = File::create(&beside)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&beside, path)
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::tests::{ok, serve};

    /// SHA-256 of "abc", from FIPS 180-4.
    const ABC: &str = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

    fn service(payload: &'static [u8]) -> SocketAddr {
        serve(move |path| match path {
            "/v1/tables/t/versions/latest" => ok(format!(r#"{{"version":3,"digest":"{ABC}"}}"#).as_bytes()),
            "/v1/tables/t/versions/latest/data?format=npz" => ok(payload),
            _ => b"HTTP/1.1 404 Not Found\r\n\r\n".to_vec(),
        })
    }

    #[test]
    fn lays_a_table_where_it_belongs() {
        let tables = tempfile::tempdir().expect("a folder");
        let copy = TableCopy::fetch(service(b"abc"), "t", tables.path()).expect("fetched");
        assert_eq!((copy.digest.as_str(), copy.len), (ABC, 3));
        assert_eq!(copy.folder, tables.path().join("t/3"));
        assert_eq!(fs::read(copy.folder.join("table.npz")).expect("there"), b"abc");
        assert_eq!(fs::read_dir(&copy.folder).expect("there").count(), 2, "no file but the two");
    }

    #[test]
    fn a_wrong_payload_is_caught_and_nothing_is_written() {
        let tables = tempfile::tempdir().expect("a folder");
        let cause = TableCopy::fetch(service(b"abd"), "t", tables.path()).expect_err("not what was promised");
        assert!(cause.to_string().contains(ABC), "{cause}");
        TableCopy::fetch(service(b"abc"), "u", tables.path()).expect_err("no such table");
        assert_eq!(fs::read_dir(tables.path()).expect("there").count(), 0);
    }
}
