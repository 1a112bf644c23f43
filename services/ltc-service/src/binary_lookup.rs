//! Batches of lookups in numbers instead of text: for pipelines that ask a million times.
//!
//! The body of `POST …/lookup` has the media type `application/vnd.ltc.queries.f64` or `….f32`: little-endian numbers, four for each
//! query: θ, φ, α_x, α_y. The answer is `application/vnd.ltc.lookups.f64` or `….f32`: for each query magnitude, Fresnel term, and for
//! each lobe its weight and the nine numbers of M by rows. A query that is not valid refuses the whole batch, since no number
//! could say so.

use ltc_table::{Lookup, Query, TableVersion};

use crate::ApiError;

/// The media types that the body of a batch may have, in words.
pub(crate) const EXPECTED: &str =
    "application/json, application/vnd.ltc.queries.f64 or application/vnd.ltc.queries.f32";

/// How numbers are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    F32,
    F64,
}

/// Numbers of a query.
const QUERY: usize = 4;

impl Form {
    /// By the media type of a body.
    pub(crate) fn of(media_type: &str) -> Option<Self> {
        match media_type {
            "application/vnd.ltc.queries.f32" => Some(Self::F32),
            "application/vnd.ltc.queries.f64" => Some(Self::F64),
            _ => None,
        }
    }

    /// The media type of the answer.
    pub(crate) fn answers(self) -> &'static str {
        match self {
            Self::F32 => "application/vnd.ltc.lookups.f32",
            Self::F64 => "application/vnd.ltc.lookups.f64",
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn read(self, bytes: &[u8]) -> Vec<f64> {
        match self {
            Self::F32 => bytes.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
            Self::F64 => bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        }
    }

    /// `None` for a number that does not fit.
    fn write(self, value: f64, out: &mut Vec<u8>) -> Option<()> {
        match self {
            Self::F32 => {
                let value = value as f32;
                out.extend(value.to_le_bytes());
                value.is_finite()
            }
            Self::F64 => {
                out.extend(value.to_le_bytes());
                value.is_finite()
            }
        }
        .then_some(())
    }
}

/// The answers to all queries.
///
/// # Errors
/// [`ApiError::Malformed`] for a length that is no number of queries, [`ApiError::TooManyQueries`], [`ApiError::Invalid`] with the
/// first query that is not valid.
pub(crate) fn answer_all(
    version: &TableVersion,
    body: &[u8],
    form: Form,
    limit: usize,
) -> Result<Vec<u8>, ApiError> {
    let record = QUERY * form.bytes();
    if !body.len().is_multiple_of(record) {
        let reason = format!("the body has {} bytes, and a query has {record}", body.len());
        return Err(ApiError::malformed(None, reason));
    }
    let count = body.len() / record;
    if count > limit {
        return Err(ApiError::TooManyQueries { count, limit });
    }
    let numbers = form.read(body);
    let mut out = Vec::with_capacity(count * 12 * form.bytes());
    for (index, [theta, phi, alpha_x, alpha_y]) in numbers.as_chunks().0.iter().copied().enumerate() {
        let refused =
            |reason: String| ApiError::invalid(format!("query {index}"), format!("is refused: {reason}"));
        // The f32 nearest to the horizon lies behind it.
        let horizon = core::f64::consts::FRAC_PI_2;
        let theta = if form == Form::F32 && theta == f64::from(horizon as f32) { horizon } else { theta };
        let query = Query { theta, phi, alpha_x, alpha_y };
        let Lookup { lobes, magnitude, fresnel } =
            version.table().lookup(&query).map_err(|e| refused(e.to_string()))?;
        let lobes = lobes.iter().flat_map(|lobe| [lobe.weight].into_iter().chain(lobe.m));
        for value in [magnitude, fresnel].into_iter().chain(lobes) {
            form.write(value, &mut out).ok_or_else(|| refused(format!("{value:e} does not fit f32")))?;
        }
    }
    Ok(out)
}
