//! The tolerances of the cross-crate tests, all absolute, in fractions of a lobe.

/// Between any two of GPU, CPU `f32` and CPU `f64` on the same inputs: what the workspace promises. A fortieth of one step
/// of an 8-bit picture of a light of radiance 1.
pub const BACK_ENDS: f64 = 1e-4;

/// Any kind of light on any back end against CPU `f64` on the same inputs, for lobes of condition number up to 100, and in
/// proportion to it beyond: what the workspace promises.
pub const LIGHTS: f64 = 2e-4;

/// GPU against CPU `f64` from the material on, down to α = 0 and up to θ = 90°. Directions in `f32` are 6·10⁻⁸ apart, and a
/// lobe of the narrowest width in the tables, 10⁻³, is 10⁻⁴ wide or less seen at grazing angles: the edge of a light that cuts
/// it moves by a few times 6·10⁻⁸ / 10⁻⁴ of the lobe.
pub const NARROW: f64 = 2e-3;

/// The closed form in `f64` against cubature of the same density: what the workspace promises. The cubature is asked for
/// 10⁻⁸, the closed form loses some 10⁻¹⁶ times the lobe's condition number, which is below 10⁶ in the shipped tables.
pub const REFERENCE: f64 = 1e-6;

/// A configuration whose answer is known on paper, in `f32` under a lobe of condition number near 1: four edges, each a few
/// roundings of numbers up to π.
pub const EXACT: f64 = 2e-6;

/// TV from samples against TV by cubature: R2 points miss an integrand with a kink by some N^(−3/4), which is
/// 2·10⁻⁴ for 65,536, times the height of the ratio's tail.
pub const TV: f64 = 2e-3;
