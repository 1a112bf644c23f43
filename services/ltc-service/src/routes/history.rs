//! The page of benchmark history.

use axum::extract::{RawQuery, State};
use axum::http::header;
use axum::response::Response;
use ltc_store::BenchmarkFilter;

use super::benchmarks::check_time;
use crate::history::{Choice, History, page};
use crate::params::Params;
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::{ApiError, AppState};

/// Runs that are looked at, unless asked for more or fewer.
const RUNS: u32 = 60;
/// At most.
pub(crate) const MOST_RUNS: u32 = 200;
/// As the other pages, but with a form that leads back here.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'self'";
const KNOWN: [&str; 7] = ["name", "machine", "measure", "since", "limit", "worse", "page"];

/// `GET /benchmarks?name=&machine=&measure=&since=&limit=&worse=&page=`
pub(crate) async fn charts(
    State(state): State<AppState>,
    RawQuery(query): RawQuery,
    request: Preconditions,
) -> Result<Response, ApiError> {
    // A form sends every field, empty ones too.
    let mut params = Params::parse(query.as_deref())?;
    let choice = Choice {
        limit: params.count("limit", RUNS, MOST_RUNS)?,
        page: params.count("page", 1, u32::MAX)? as usize,
        name: params.words("name").unwrap_or_default(),
        machine: params.words("machine").unwrap_or_default(),
        measure: params.words("measure").unwrap_or_default(),
        since: params.take("since").unwrap_or_default(),
        worse: match params.take("worse").as_deref() {
            None | Some("false") => false,
            Some("true") => true,
            Some(other) => {
                return Err(ApiError::invalid("worse", format!("must be true or false, not {other:?}")));
            }
        },
    };
    params.finish(&KNOWN)?;
    if !choice.since.is_empty() {
        check_time("since", &choice.since)?;
    }
    let given = |text: &String| (!text.is_empty()).then(|| text.clone());
    let (name, since) = (given(&choice.name), given(&choice.since));
    let filter = BenchmarkFilter { name, since, limit: choice.limit, ..BenchmarkFilter::default() };
    let found = state.stores().metadata.benchmarks(&filter).await?;
    // Megabytes of runs are read and compared: not on the threads that answer.
    let page = state.compute().run(move || page(History::of(found), &choice)).await?;
    Representation::new(Tagged::new(page.into_bytes()), "text/html; charset=utf-8", Caching::Checked)
        .with(header::CONTENT_SECURITY_POLICY, POLICY)
        .respond(&request)
}
