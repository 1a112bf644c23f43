//! Shaders in other languages: what outside compilers say of them, whether they are current, and what they compute.

#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod browser;
mod equality;
mod golden;
#[path = "../../../../examples/hosts/wgsl/main.rs"]
mod host_wgsl;
mod support;
mod textured;
mod triples;
mod validators;
mod vulkan;
