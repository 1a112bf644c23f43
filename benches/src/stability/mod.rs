//! Rounding errors of every light over ranges far beyond any scene, against numbers of twice the digits.
//!
//! The oracle evaluates the same formulas: what it sees is what rounding does to them. That the formulas are right is for
//! `ltc-reference` to say, in the tests of `ltc-core`.

mod case;
mod form;
mod outcome;
mod page;
mod sweep;
mod timing;

pub use case::Case;
pub use form::Form;
pub use outcome::{Bound, Outcome};
pub use page::{Page, chart};
pub use sweep::Sweep;
pub use timing::nanoseconds;
