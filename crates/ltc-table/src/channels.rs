//! Which channels of a table to export.

/// A choice of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Channels {
    /// The matrices.
    pub m: bool,
    /// `∫ ρ cos` at F = 1.
    pub magnitude: bool,
    /// `∫ (1 − ωo·ωh)^5 ρ cos`.
    pub fresnel: bool,
    /// TV, leak and condition number of each entry.
    pub cells: bool,
}

impl Channels {
    /// Everything.
    pub const ALL: Self = Self { m: true, magnitude: true, fresnel: true, cells: true };
    /// What shading reads.
    pub const SHADING: Self = Self { m: true, magnitude: true, fresnel: true, cells: false };
    /// Magnitude and Fresnel alone.
    pub const FRESNEL: Self = Self { m: false, magnitude: true, fresnel: true, cells: false };

    /// From names separated by commas: `m`, `magnitude`, `fresnel`, `cells`. `None` for an unknown or an empty list.
    pub fn from_names(names: &str) -> Option<Self> {
        let mut chosen = Self { m: false, magnitude: false, fresnel: false, cells: false };
        for name in names.split(',') {
            match name.trim() {
                "m" => chosen.m = true,
                "magnitude" => chosen.magnitude = true,
                "fresnel" => chosen.fresnel = true,
                "cells" => chosen.cells = true,
                _ => return None,
            }
        }
        Some(chosen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_and_unknown_ones_refused() {
        assert_eq!(Channels::from_names("m, magnitude,fresnel"), Some(Channels::SHADING));
        assert_eq!(Channels::from_names("magnitude,fresnel"), Some(Channels::FRESNEL));
        assert_eq!(Channels::from_names(""), None);
        assert_eq!(Channels::from_names("m,colour"), None);
    }
}
