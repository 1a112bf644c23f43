//! Any text as a line of `ltc integrate` and `ltc lookup`: an answer or an error of one line.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use ltc_lines::{Integration, lookup};
use ltc_table::Catalogue;

static TABLES: LazyLock<Catalogue> = LazyLock::new(|| ltc_tables::shipped().expect("the shipped tables are sound"));

fuzz_target!(|text: &str| {
    if let Ok(table) = TABLES.find("ggx-anisotropic") {
        if let Err(error) = lookup(table.table(), text) {
            assert!(!error.contains('\n'), "{error}");
        }
    }
    let answers = Integration::parse(&TABLES, text).map(|job| [job.on_cpu::<f32>(), job.on_cpu::<f64>()]);
    match answers {
        Ok(answers) => {
            for answer in answers.into_iter().flatten() {
                assert!((0.0..=1.0).contains(&answer.value), "{answer:?}");
            }
        }
        Err(error) => assert!(!error.contains('\n'), "{error}"),
    }
});
