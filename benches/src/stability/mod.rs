//! Rounding errors of every light over ranges far beyond any scene, against numbers of twice the digits.
//!
//! The oracle integrates along each light's boundary by quadrature; it shares no code with `ltc-core`, and is itself held
//! against `ltc-reference`, which integrates over surfaces.

mod case;
mod conic;
mod form;
mod oracle;
mod outcome;
mod page;
mod quadrature;
mod sweep;
mod timing;

pub use case::Case;
pub use form::Form;
pub use oracle::oracle;
pub use outcome::{Bound, Outcome};
pub use page::{Page, chart};
pub use sweep::Sweep;
pub use timing::nanoseconds;
