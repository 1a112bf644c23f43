//! How long a program takes for a grid of pixels on the device, told by the device's own clock where it has one.
//!
//! A [`PixelProgram`] is WGSL with a function `pixel` that gives four numbers for a pixel; it runs in a compute or in the
//! fragment stage, whichever is asked for, and writes every pixel of a [`PixelGrid`]. [`in_turns`] times several of them: each
//! once before any is timed again, so that what slows the device down for a while falls on all of them. What a program writes
//! can be read ([`PixelProgram::pixels`]), and should be held against an oracle before its time is believed.
//!
//! Times are between timestamps of the device at the beginning of the first pass and at the end of the last. Where the device
//! has none, or where they do not agree with the wall clock, that is taken, around submitting and waiting. A software driver is
//! timed by what it takes of the processor, so that other work on the machine does not count. [`Clock`] says which it was.

mod clock;
mod grid;
mod program;
mod resource;
mod turns;

pub use clock::Clock;
pub use grid::PixelGrid;
pub use program::{PixelProgram, PixelSource, Stage};
pub use resource::Resource;
pub use turns::{Turns, in_turns};
