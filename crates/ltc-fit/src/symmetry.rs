//! What the symmetries of the BRDF say about single entries of a table (KT et al. 2022, §6.2, eq. 16).

use core::f64::consts::FRAC_PI_2;

use glam::DMat3;
use ltc_core::{Alpha, InputError};
use ltc_table::{Axis, Floors, Quantity};

/// The configuration that an entry of a table stands for, floors applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Polar angle of the view.
    pub theta: f64,
    /// Azimuth of the view; 0 in an isotropic table.
    pub phi: f64,
    /// The larger width.
    pub alpha: f64,
    /// Smaller width over larger; 1 in an isotropic table.
    pub lambda: f64,
}

impl Node {
    /// The widths.
    ///
    /// # Errors
    /// None for nodes of valid axes.
    pub fn widths(&self) -> Result<Alpha, InputError> {
        Alpha::new(self.alpha, self.alpha * self.lambda)
    }

    /// The value of one of its quantities.
    pub fn value(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Theta => self.theta,
            Quantity::Phi => self.phi,
            Quantity::Alpha => self.alpha,
            Quantity::Lambda => self.lambda,
        }
    }

    /// The view direction.
    pub fn wo(&self) -> glam::DVec3 {
        crate::direction(self.theta, self.phi)
    }
}

/// Which entries of `M` a mirror or rotation symmetry of the lobe forces to be zero or equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// None.
    General,
    /// φ = 0: the lobe mirrors in y.
    MirrorY,
    /// φ = π/2: the lobe mirrors in x.
    MirrorX,
    /// θ = 0: it mirrors in both.
    Diagonal,
    /// θ = 0 and λ = 1: it is round.
    Round,
}

impl Pattern {
    /// The nearest matrix of the pattern.
    pub fn project(self, m: DMat3) -> DMat3 {
        let mut rows = m.transpose().to_cols_array();
        let zero: &[usize] = match self {
            Self::General => &[],
            Self::MirrorY => &[1, 3, 5, 7],
            Self::MirrorX => &[1, 2, 3, 6],
            Self::Diagonal | Self::Round => &[1, 2, 3, 5, 6, 7],
        };
        for i in zero {
            rows[*i] = 0.0;
        }
        if self == Self::Round {
            let mean = 0.5 * (rows[0] + rows[4]);
            (rows[0], rows[4]) = (mean, mean);
        }
        DMat3::from_cols_array(&rows).transpose()
    }
}

/// How an entry follows from another: `M = R_z(turn) M_owner R_z(−turn)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// The entry that is fitted; an entry that follows from none owns itself.
    pub owner: usize,
    /// Rotation about the normal, radians.
    pub turn: f64,
    /// The pattern of the owner.
    pub pattern: Pattern,
}

impl Tie {
    /// The entry's matrix from its owner's.
    pub fn follow(&self, owner: DMat3) -> DMat3 {
        if self.turn == 0.0 {
            return owner;
        }
        let r = DMat3::from_rotation_z(self.turn);
        r * owner * r.transpose()
    }

    /// The transpose of [`Tie::follow`] as a linear map: an entry's gradient, as its owner feels it.
    pub fn pull_back(&self, gradient: DMat3) -> DMat3 {
        if self.turn == 0.0 {
            return gradient;
        }
        let r = DMat3::from_rotation_z(self.turn);
        r.transpose() * gradient * r
    }
}

/// The entries of a table as the fit sees them.
#[derive(Clone, Debug)]
pub struct Lattice {
    /// Configuration of each entry.
    pub nodes: Vec<Node>,
    /// How each entry follows from its owner.
    pub ties: Vec<Tie>,
}

impl Lattice {
    /// The entries of a table with these axes (validated: θ, α or θ, φ, α, λ).
    pub fn new(axes: &[Axis], floors: &Floors) -> Self {
        let count: usize = axes.iter().map(|a| a.len).product();
        let mut lattice = Self { nodes: Vec::with_capacity(count), ties: Vec::with_capacity(count) };
        for index in 0..count {
            let raw = raw_node(axes, index);
            lattice.ties.push(tie(axes, index, &raw));
            lattice.nodes.push(Node {
                theta: raw.theta.min(floors.theta_max),
                phi: raw.phi,
                alpha: raw.alpha.max(floors.alpha),
                lambda: raw.lambda.max(floors.lambda),
            });
        }
        lattice
    }

    /// Entries that own themselves, in table order.
    pub fn owners(&self) -> Vec<usize> {
        (0..self.ties.len()).filter(|i| self.ties[*i].owner == *i).collect()
    }

    /// Completes a table of which only the owners are known.
    pub fn follow(&self, m: &mut [DMat3]) {
        for (i, tie) in self.ties.iter().enumerate() {
            m[i] = tie.follow(m[tie.owner]);
        }
    }
}

fn raw_node(axes: &[Axis], index: usize) -> Node {
    let mut node = Node { theta: 0.0, phi: 0.0, alpha: 1.0, lambda: 1.0 };
    let mut rest = index;
    for axis in axes.iter().rev() {
        let value = axis.node(rest % axis.len);
        rest /= axis.len;
        match axis.quantity {
            Quantity::Theta => node.theta = value,
            Quantity::Phi => node.phi = value,
            Quantity::Alpha => node.alpha = value,
            Quantity::Lambda => node.lambda = value,
        }
    }
    node
}

fn tie(axes: &[Axis], index: usize, node: &Node) -> Tie {
    let round = node.lambda == 1.0;
    let upright = node.theta == 0.0;
    let pattern = match (upright, round) {
        (true, true) => Pattern::Round,
        (true, false) => Pattern::Diagonal,
        (false, true) => Pattern::MirrorY,
        (false, false) if node.phi == 0.0 => Pattern::MirrorY,
        (false, false) if node.phi == FRAC_PI_2 => Pattern::MirrorX,
        (false, false) => Pattern::General,
    };
    // Seen from above, or with equal widths, all φ share one lobe: that of φ = 0.
    if upright || round {
        let turn = if upright { 0.0 } else { node.phi };
        return Tie { owner: index_at_phi_zero(axes, index), turn, pattern };
    }
    Tie { owner: index, turn: 0.0, pattern }
}

fn index_at_phi_zero(axes: &[Axis], index: usize) -> usize {
    let Some(position) = axes.iter().position(|a| a.quantity == Quantity::Phi) else { return index };
    let stride: usize = axes[position + 1..].iter().map(|a| a.len).product();
    index - index / stride % axes[position].len * stride
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_table::Mapping;

    fn lattice() -> (Vec<Axis>, Lattice) {
        let axes = vec![
            Axis::full(Quantity::Theta, Mapping::Linear, 3),
            Axis::full(Quantity::Phi, Mapping::Linear, 4),
            Axis::full(Quantity::Alpha, Mapping::Linear, 3),
            Axis::full(Quantity::Lambda, Mapping::Linear, 3),
        ];
        let floors = Floors { alpha: 1e-3, lambda: 0.02, theta_max: 1.55 };
        let lattice = Lattice::new(&axes, &floors);
        (axes, lattice)
    }

    #[test]
    fn ties_follow_the_symmetries() {
        let (_, lattice) = lattice();
        for (i, (node, tie)) in lattice.nodes.iter().zip(&lattice.ties).enumerate() {
            let owner = &lattice.nodes[tie.owner];
            assert_eq!(lattice.ties[tie.owner].owner, tie.owner, "owners own themselves");
            assert_eq!((owner.theta, owner.alpha, owner.lambda), (node.theta, node.alpha, node.lambda));
            if tie.owner != i {
                assert_eq!(owner.phi, 0.0);
            }
            // The view of the owner, turned, is the view of the entry (or upright).
            let turned = DMat3::from_rotation_z(tie.turn) * owner.wo();
            assert!((turned - node.wo()).length() < 1e-12);
        }
        assert_eq!(
            lattice.owners().len(),
            108 - 3 * 3 * 3 - 2 * 3 * 3,
            "θ = 0, and λ = 1 elsewhere, once each"
        );
    }

    #[test]
    fn patterns_are_those_of_equation_16() {
        let m = DMat3::from_cols_array(&[1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0]);
        let rows = |p: Pattern| p.project(m).transpose().to_cols_array();
        assert_eq!(rows(Pattern::MirrorY), [1.0, 0.0, 3.0, 0.0, 5.0, 0.0, 7.0, 0.0, 9.0]);
        assert_eq!(rows(Pattern::MirrorX), [1.0, 0.0, 0.0, 0.0, 5.0, 6.0, 0.0, 8.0, 9.0]);
        assert_eq!(rows(Pattern::Diagonal), [1.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 9.0]);
        assert_eq!(rows(Pattern::Round), [3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 9.0]);
    }

    #[test]
    fn pulling_back_is_the_transpose_of_following() {
        let tie = Tie { owner: 0, turn: 0.7, pattern: Pattern::MirrorY };
        let a = DMat3::from_cols_array(&[1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0]);
        let b = DMat3::from_cols_array(&[0.3, -4.0, 2.0, 1.0, 0.5, 8.0, -3.0, 6.0, 1.0]);
        let dot = |x: DMat3, y: DMat3| -> f64 {
            x.to_cols_array().iter().zip(y.to_cols_array()).map(|(p, q)| p * q).sum()
        };
        assert!((dot(tie.follow(a), b) - dot(a, tie.pull_back(b))).abs() < 1e-12);
    }
}
