//! One file for each verb.

pub mod backup;
pub mod bench;
mod bench_post;
pub mod diff;
pub mod export;
pub mod fit;
pub mod integrate;
pub mod lookup;
pub mod probe;
pub mod render;
pub mod serve;
pub mod shader;
pub mod tables;
pub mod token;
pub mod verify;
