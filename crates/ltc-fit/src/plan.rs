//! What a specification comes to before any work is done.

use ltc_table::digest::digest;

use crate::{
    Brdf, FitError, FitSpec, Lattice, Objective,
    entries::{EntryStage, PIECE},
    pieces,
    progress::{CHANNELS, ENTRIES, JOINT, MEASUREMENT},
};

/// A valid specification with its BRDF and its lattice of entries.
pub struct Plan<'a> {
    spec: FitSpec,
    brdf: &'a dyn Brdf,
    lattice: Lattice,
    owners: Vec<usize>,
}

impl<'a> Plan<'a> {
    /// Checks the specification and lays out its entries.
    ///
    /// # Errors
    /// [`FitError::Spec`], naming the field and what is wrong with it.
    pub fn new(spec: FitSpec) -> Result<Self, FitError> {
        let brdf = spec.brdf()?;
        Self::with_brdf(brdf, spec)
    }

    /// The same for a BRDF that [`FitSpec::brdf`] does not know, one's own for example; `spec.brdf` must have its name.
    ///
    /// # Errors
    /// As [`Plan::new`], and [`FitError::Brdf`] for a BRDF that gives negative values or NaN.
    pub fn with_brdf(brdf: &'a dyn Brdf, spec: FitSpec) -> Result<Self, FitError> {
        spec.validate_with(brdf)?;
        let lattice = Lattice::new(&spec.axes, &spec.floors);
        crate::brdf::check(brdf, &lattice)?;
        let owners = lattice.owners();
        Ok(Self { spec, brdf, lattice, owners })
    }

    /// The specification.
    pub fn spec(&self) -> &FitSpec {
        &self.spec
    }

    /// The BRDF.
    pub fn brdf(&self) -> &'a dyn Brdf {
        self.brdf
    }

    /// The entries.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The entries that own themselves, in table order.
    pub fn owners(&self) -> &[usize] {
        &self.owners
    }

    /// The first stage.
    ///
    /// # Errors
    /// None for a valid specification, which this one is.
    pub fn entry_stage(&self) -> Result<EntryStage<'_>, FitError> {
        let (objective, settings) = (self.spec.objective()?, self.spec.entries);
        let (axes, lattice, owners) = (&self.spec.axes, &self.lattice, &self.owners);
        Ok(EntryStage { brdf: self.brdf, axes, lattice, owners, objective, settings })
    }

    /// What names the specification: the SHA-256 of its JSON, as `sha256:<hex>`.
    pub fn digest(&self) -> String {
        digest(&serde_json::to_vec(&self.spec).unwrap_or_default())
    }
}

/// What a fit is expected to take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Entries of the table.
    pub entries: u64,
    /// Memory at the peak, bytes.
    pub memory: u64,
    /// Seconds of one core: of each stage, by its name.
    pub seconds: [(&'static str, f64); 4],
}

/// What a fit may take. A service chooses smaller ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Memory, bytes.
    pub memory: u64,
    /// Seconds of one core.
    pub seconds: f64,
}

impl Default for Limits {
    /// 4 GiB, and 24 hours of one core.
    fn default() -> Self {
        Self { memory: 4 << 30, seconds: 86_400.0 }
    }
}

impl Cost {
    /// The cost of a specification, from the number of samples that each stage takes. Nothing is allocated, so that any
    /// size can be asked for. Times are those of one 2020s core, right within a factor of about three.
    pub fn of(spec: &FitSpec) -> Self {
        /// Seconds for each sample of a lobe that is drawn, that is compared with an LTC, and compared with derivatives.
        const DRAW: f64 = 15e-9;
        const COMPARE: f64 = 2e-9;
        const DERIVE: f64 = 5e-9;
        /// Seconds of a comparison by sliced Wasserstein, whose number of samples is its own.
        const SLICED: f64 = 8e-4;
        /// Fits of an entry when it is also fitted from where its neighbours ended.
        const CONTINUED: f64 = 9.0;
        /// Seconds of a joint step besides its samples.
        const STEP: f64 = 6e-3;
        /// Comparisons that the fit of an entry takes on average.
        const COMPARISONS: f64 = 110.0;
        /// Bytes for each entry (matrices, starts, moments, their copies and the checkpoint's text), for each query of a
        /// step, and for each row of the channels' equations.
        const PER_ENTRY: u64 = 2500;
        const PER_QUERY: u64 = 800;
        const PER_ROW: u64 = 400;
        let entries = spec.axes.iter().fold(1_u64, |n, axis| n.saturating_mul(axis.len as u64));
        let (joint, channels, measure) = (&spec.joint, &spec.channels, &spec.measure);
        let product = |a: usize, b: usize| a as f64 * b as f64;
        let alone = entries as f64 * spec.entries.samples as f64;
        let comparisons = COMPARISONS.min(3.0 * spec.entries.iterations as f64);
        let sliced = spec.objective == Objective::SlicedWasserstein.name();
        let alone_again = if spec.entries.continuation { CONTINUED } else { 1.0 };
        let derive = if sliced { entries as f64 * SLICED } else { alone * DERIVE };
        let nodes_and_queries =
            |samples: usize, queries: usize| entries as f64 * samples as f64 + product(samples, queries);
        Self {
            entries,
            memory: entries
                .saturating_mul(PER_ENTRY)
                .saturating_add((joint.queries as u64).saturating_mul(PER_QUERY))
                .saturating_add((channels.all_queries() as u64).saturating_mul(PER_ROW)),
            seconds: [
                (ENTRIES, alone_again * (alone * DRAW + comparisons * derive)),
                (
                    JOINT,
                    joint.steps as f64 * (STEP + product(joint.queries, joint.samples) * (DRAW + DERIVE)),
                ),
                (CHANNELS, nodes_and_queries(channels.samples, channels.all_queries()) * DRAW),
                (
                    MEASUREMENT,
                    nodes_and_queries(measure.samples, measure.queries) * (3.0 * DRAW + 2.0 * COMPARE),
                ),
            ],
        }
    }

    /// All stages together, seconds of one core.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().map(|(_, seconds)| seconds).sum()
    }

    /// The longest piece of work that a [`crate::FitRun`] does at once: its stage, and seconds of one core. What a kill loses
    /// at most.
    pub fn longest_piece(&self, spec: &FitSpec) -> (&'static str, f64) {
        let [entries, joint, channels, measurement] = self.seconds;
        let share = |piece: usize, of: u64| (piece as f64 / of.max(1) as f64).min(1.0);
        let alone = if spec.entries.is_chained() { 1.0 } else { share(PIECE, self.entries) };
        let evaluated = |samples: usize, queries: usize| {
            share(pieces::length(samples), self.entries.saturating_add(queries as u64))
        };
        let of_channels = evaluated(spec.channels.samples, spec.channels.all_queries());
        let of_measurement = evaluated(spec.measure.samples, spec.measure.queries);
        let pieces = [
            (ENTRIES, entries.1 * alone),
            (JOINT, joint.1 / spec.joint.steps.max(1) as f64),
            (CHANNELS, channels.1 * of_channels),
            (MEASUREMENT, measurement.1 * of_measurement),
        ];
        pieces
            .into_iter()
            .fold((ENTRIES, 0.0), |longest, piece| if piece.1 > longest.1 { piece } else { longest })
    }

    /// # Errors
    /// [`FitError::TooLarge`], with the estimate, when the cost is above one of the limits.
    pub fn check(&self, limits: &Limits) -> Result<(), FitError> {
        let (entries, memory, seconds) = (self.entries, self.memory, self.total_seconds());
        if memory <= limits.memory && seconds <= limits.seconds {
            return Ok(());
        }
        Err(FitError::TooLarge { entries, memory, seconds, limits: *limits })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_grow_with_what_is_asked_for_and_are_refused_above_a_limit() {
        let spec = FitSpec::preset("ggx-anisotropic").unwrap();
        let cost = Cost::of(&spec);
        assert_eq!(cost.entries, 4096);
        cost.check(&Limits::default()).unwrap();
        let tight = Limits { seconds: 0.5 * cost.total_seconds(), ..Limits::default() };
        let refusal = cost.check(&tight).unwrap_err().to_string();
        assert!(refusal.contains(&format!("{} entries would take about", cost.entries)), "{refusal}");
        let mut larger = spec.clone();
        larger.axes.iter_mut().for_each(|axis| axis.len = 4096);
        let larger = Cost::of(&larger);
        assert!(larger.memory > 1 << 50 && larger.total_seconds() > 1e9, "{larger:?}");
        assert!(matches!(larger.check(&Limits::default()), Err(FitError::TooLarge { .. })));
        let mut longer = spec;
        longer.joint.steps *= 10;
        assert!(Cost::of(&longer).total_seconds() > 5.0 * cost.seconds[1].1);
    }

    #[test]
    fn the_longest_piece_is_found() {
        let mut spec = FitSpec::preset("ggx-anisotropic").unwrap();
        let longest = |spec: &FitSpec| Cost::of(spec).longest_piece(spec);
        assert!(longest(&spec).1 < 0.5, "{:?}", longest(&spec));
        // More of what is evaluated one by one makes more pieces, not longer ones.
        (spec.measure.samples, spec.channels.queries) = (1 << 18, 1 << 20);
        assert!(longest(&spec).1 < 0.5, "{:?}", longest(&spec));
        spec.joint.queries = 1 << 20;
        spec.joint.samples = 1 << 14;
        assert_eq!(longest(&spec).0, JOINT);
        assert!(longest(&spec).1 > 100.0, "{:?}", longest(&spec));
        let mut chained = FitSpec::preset("ggx-anisotropic").unwrap();
        let whole = Cost::of(&chained).seconds[0].1;
        chained.entries.continuation = true;
        assert!(longest(&chained).0 == ENTRIES && longest(&chained).1 > whole, "all entries in one piece");
    }

    #[test]
    fn a_plan_is_named_by_all_of_its_specification() {
        let spec = FitSpec::preset("ggx-isotropic").unwrap();
        let mut other = spec.clone();
        other.measure.seed += 1;
        let [a, b, again] = [spec.clone(), other, spec].map(|spec| Plan::new(spec).unwrap().digest());
        assert_eq!(a, again);
        assert_ne!(a, b);
    }
}
