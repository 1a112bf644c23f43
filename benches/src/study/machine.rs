//! Which machine this is.

use ltc_records::Machine;

/// This machine.
pub(super) fn here() -> Machine {
    Machine {
        cpu: processor().unwrap_or_else(|| "unknown processor".to_owned()),
        threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        build: build(),
        load: load(),
        gpu: None,
        gpu_clock: None,
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

fn build() -> String {
    let mode = if cfg!(debug_assertions) { "unoptimised" } else { "optimised" };
    let features = [
        (cfg!(target_feature = "avx512f"), "AVX-512"),
        (cfg!(target_feature = "avx2"), "AVX2"),
        (cfg!(target_feature = "fma"), "FMA"),
    ];
    let named: Vec<&str> = features.iter().filter(|(on, _)| *on).map(|(_, name)| *name).collect();
    if named.is_empty() {
        format!("{mode}, baseline instructions; batches choose theirs at run time")
    } else {
        format!("{mode}, {}", named.join(", "))
    }
}
