//! The handlers, by what they are about.

pub(crate) mod aliases;
pub(crate) mod benchmarks;
pub(crate) mod data;
pub(crate) mod diff;
pub(crate) mod docs;
pub(crate) mod events;
pub(crate) mod health;
pub(crate) mod history;
pub(crate) mod index;
pub(crate) mod lookup;
pub(crate) mod metrics;
pub(crate) mod problems;
pub(crate) mod refits;
pub(crate) mod shaders;
pub(crate) mod tables;
pub(crate) mod upload;
