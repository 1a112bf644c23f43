//! Runs of `ltc bench` over time: which are of one machine, how each compares with the one before it, and a page of charts.

mod chart;
mod page;
mod tracks;

pub(crate) use page::{Choice, page};
pub(crate) use tracks::History;
