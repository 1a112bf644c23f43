//! Where a study ran.

use serde::{Deserialize, Serialize};

/// A machine, as far as times depend on it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's own name for itself.
    pub cpu: String,
    /// Threads that may run at once.
    pub threads: usize,
    /// Operating system and architecture.
    pub system: String,
    /// What the program was compiled for and how.
    pub build: String,
    /// Runnable processes a minute before the run, where the system tells: above 1, somebody else was at work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<f64>,
    /// The graphics device that frames were shaded on, where there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gpu: Option<String>,
    /// What told the times of records that begin with `gpu/`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gpu_clock: Option<String>,
}

impl Machine {
    /// A name for files: processor and graphics device in lower case, without versions of drivers.
    pub fn slug(&self) -> String {
        let gpu = self.gpu.as_deref().map_or("no-gpu", |gpu| gpu.split(" (").next().unwrap_or(gpu));
        let name = format!("{} {gpu}", self.cpu.split('@').next().unwrap_or(&self.cpu)).to_lowercase();
        let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("-")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slug_is_a_plain_file_name() {
        let machine = |cpu: &str, gpu: Option<&str>| {
            Machine { cpu: cpu.into(), gpu: gpu.map(str::to_owned), ..Machine::default() }.slug()
        };
        let found = machine("Intel(R) Xeon(R) @ 2.10GHz", Some("llvmpipe (LLVM 15) (software, vulkan, x)"));
        assert_eq!(found, "intel-r-xeon-r-llvmpipe");
        assert_eq!(machine("../x y", None), "x-y-no-gpu");
    }
}
