//! Whether this machine has a Vulkan driver, told from its files: without compiling or linking anything.

use std::env;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// A driver that can be expected to work.
#[derive(Debug, PartialEq, Eq)]
pub enum Driver {
    /// There is a GPU, and the manifest of a driver for one.
    Hardware(PathBuf),
    /// A driver that computes on the CPU.
    Software(PathBuf),
}

impl fmt::Display for Driver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hardware(manifest) => write!(out, "a GPU with a Vulkan driver ({})", manifest.display()),
            Self::Software(manifest) => write!(out, "a software Vulkan driver ({})", manifest.display()),
        }
    }
}

/// What there is none of.
#[derive(Debug, PartialEq, Eq)]
pub enum Missing {
    /// The library that finds drivers.
    Loader,
    /// A driver for the GPU that there is, or one that needs none.
    Driver,
}

impl fmt::Display for Missing {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Loader => "the Vulkan loader (libvulkan.so.1)",
            Self::Driver => "a Vulkan driver that works here",
        })
    }
}

/// Where to look.
#[derive(Debug)]
pub struct Search {
    /// Driver manifests, as the loader would find them.
    manifests: Vec<PathBuf>,
    /// Folders of shared libraries.
    libraries: Vec<PathBuf>,
    /// Whether there is a GPU.
    gpu: bool,
}

impl Search {
    /// This machine.
    pub fn this_machine() -> Self {
        let gpu =
            files_in(Path::new("/dev/dri")).iter().any(|file| file.to_string_lossy().contains("/renderD"))
                || Path::new("/dev/nvidia0").exists();
        Self { manifests: manifests(), libraries: library_folders(), gpu }
    }

    /// The driver that the GPU parts will run on, or what is missing.
    pub fn driver(&self) -> Result<Driver, Missing> {
        if !self.has_library("libvulkan.so.1") {
            return Err(Missing::Loader);
        }
        let (software, hardware): (Vec<_>, Vec<_>) = self
            .manifests
            .iter()
            .filter(|manifest| self.is_whole(manifest))
            .partition(|manifest| is_software(manifest));
        match (hardware.first(), software.first()) {
            (Some(manifest), _) if self.gpu => Ok(Driver::Hardware(manifest.to_path_buf())),
            (_, Some(manifest)) => Ok(Driver::Software(manifest.to_path_buf())),
            _ => Err(Missing::Driver),
        }
    }

    /// Whether the library that the manifest names is there: containers often have only the manifest.
    fn is_whole(&self, manifest: &Path) -> bool {
        let Ok(text) = fs::read_to_string(manifest) else { return false };
        let content: Value = serde_json::from_str(&text).unwrap_or_default();
        match content["ICD"]["library_path"].as_str() {
            None => false,
            Some(path) if path.contains('/') => {
                manifest.parent().is_some_and(|folder| folder.join(path).exists())
            }
            Some(name) => self.has_library(name),
        }
    }

    fn has_library(&self, name: &str) -> bool {
        self.libraries.iter().any(|folder| folder.join(name).exists())
    }
}

/// Mesa's lavapipe, or SwiftShader.
fn is_software(manifest: &Path) -> bool {
    let name = manifest.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    ["lvp", "lavapipe", "swiftshader"].iter().any(|word| name.contains(word))
}

/// As the loader: the list in the environment and nothing else, or the usual folders.
fn manifests() -> Vec<PathBuf> {
    let listed = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find_map(env::var_os);
    if let Some(listed) = listed {
        return env::split_paths(&listed).collect();
    }
    let home = env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share"));
    let mut folders: Vec<PathBuf> = ["/etc", "/usr/local/share", "/usr/share"].map(PathBuf::from).into();
    folders.extend(home);
    let all = folders.iter().flat_map(|folder| files_in(&folder.join("vulkan/icd.d")));
    all.filter(|file| file.extension().is_some_and(|extension| extension == "json")).collect()
}

/// The folders that the dynamic linker looks through, near enough.
fn library_folders() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        env::var_os("LD_LIBRARY_PATH").map(|list| env::split_paths(&list).collect()).unwrap_or_default();
    folders.extend(["/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"].map(PathBuf::from));
    let by_architecture = format!("{}-linux-gnu", env::consts::ARCH);
    folders.extend(["/lib", "/usr/lib"].map(|folder| Path::new(folder).join(&by_architecture)));
    for file in files_in(Path::new("/etc/ld.so.conf.d")) {
        let lines = fs::read_to_string(file).unwrap_or_default();
        folders.extend(lines.lines().map(str::trim).filter(|line| line.starts_with('/')).map(PathBuf::from));
    }
    folders
}

/// Sorted; a folder that is not there has none.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine with the loader, and manifests of these names whose libraries are there.
    fn machine(folder: &Path, gpu: bool, names: &[&str]) -> Search {
        fs::write(folder.join("libvulkan.so.1"), "").expect("written");
        let manifest = |name: &&str| {
            fs::write(folder.join(format!("lib{name}.so")), "").expect("written");
            let path = folder.join(format!("{name}.json"));
            fs::write(&path, format!(r#"{{"ICD":{{"library_path":"lib{name}.so"}}}}"#)).expect("written");
            path
        };
        Search { manifests: names.iter().map(manifest).collect(), libraries: vec![folder.to_owned()], gpu }
    }

    #[test]
    fn takes_the_gpu_when_there_is_one_and_the_cpu_otherwise() {
        let folder = tempfile::tempdir().expect("a folder");
        let (radeon, lvp) = (folder.path().join("radeon.json"), folder.path().join("lvp.json"));
        let driver = |gpu, names: &[&str]| machine(folder.path(), gpu, names).driver();
        assert_eq!(driver(true, &["lvp", "radeon"]), Ok(Driver::Hardware(radeon)));
        assert_eq!(driver(false, &["lvp", "radeon"]), Ok(Driver::Software(lvp.clone())));
        assert_eq!(driver(true, &["lvp"]), Ok(Driver::Software(lvp)));
        assert_eq!(driver(false, &["radeon"]), Err(Missing::Driver));
        assert_eq!(driver(true, &[]), Err(Missing::Driver));
    }

    #[test]
    fn a_manifest_without_its_library_is_no_driver() {
        let folder = tempfile::tempdir().expect("a folder");
        let search = machine(folder.path(), false, &["lvp"]);
        fs::remove_file(folder.path().join("liblvp.so")).expect("removed");
        assert_eq!(search.driver(), Err(Missing::Driver));
        fs::write(folder.path().join("lvp.json"), "not JSON").expect("written");
        assert_eq!(search.driver(), Err(Missing::Driver));
        fs::remove_file(folder.path().join("libvulkan.so.1")).expect("removed");
        assert_eq!(search.driver(), Err(Missing::Loader));
    }
}
