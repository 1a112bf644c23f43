//! Lists the tables in this folder, `NAME/VERSION/{manifest.json, table.npz}`, for embedding.

use std::fmt::Write;
use std::path::{Path, PathBuf};

fn main() {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed={}", root.display());
    let mut list = String::from("&[\n");
    for folder in subfolders(&root).iter().flat_map(|table| subfolders(table)) {
        let (manifest, payload) = (folder.join("manifest.json"), folder.join("table.npz"));
        if manifest.is_file() {
            writeln!(list, "(include_bytes!({manifest:?}), include_bytes!({payload:?})),").expect("a string");
        }
    }
    list.push(']');
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it"));
    std::fs::write(out.join("embedded.rs"), list).expect("OUT_DIR is writable");
}

fn subfolders(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    // A fit that was interrupted leaves hidden folders.
    let seen = entries.filter(|e| !e.file_name().to_string_lossy().starts_with('.'));
    let mut folders: Vec<_> = seen.map(|e| e.path()).filter(|p| p.is_dir()).collect();
    folders.sort();
    folders
}
