//! What a run of `ltc bench` says, and what changed from one run to another.
//!
//! A [`Run`] is a list of [`Record`]s: a thing with its time, its size and its errors. [`compare`] says what became slower or more
//! wrong: by the same rule for `ltc bench compare` and for the service's page of their history.

mod compare;
mod machine;
mod number;
mod pool;
mod record;

pub use compare::{Change, Comparison, Thresholds, Verdict, compare, measures};
pub use machine::Machine;
pub use number::short;
pub use pool::pooled;
pub use record::{Interval, Record, Run, SCHEMA, YARDSTICK};
