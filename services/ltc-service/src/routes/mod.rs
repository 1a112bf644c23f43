//! The handlers, by what they are about.

pub(crate) mod data;
pub(crate) mod health;
pub(crate) mod index;
pub(crate) mod lookup;
pub(crate) mod tables;
