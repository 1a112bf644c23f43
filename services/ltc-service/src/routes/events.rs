//! What happens to a refit, as it happens.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use axum::response::sse::{Event as Sent, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use ltc_store::{Event, EventKind, JobState};
use serde_json::json;
use tokio::sync::{OwnedSemaphorePermit, watch};

use crate::selected::RefitId;
use crate::{ApiError, AppState};

/// How often to look where nobody says that something changed: another process may do the work.
const LOOK: Duration = Duration::from_secs(1);
/// A sign of life for whatever is between here and the client.
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// How long a client waits before it comes again.
const RETRY: Duration = Duration::from_secs(2);

/// The id of the last event that a client has seen.
pub(crate) struct LastEventId(u64);

impl FromRequestParts<AppState> for LastEventId {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &AppState) -> Result<Self, ApiError> {
        let Some(value) = parts.headers.get("last-event-id") else { return Ok(Self(0)) };
        let id = value.to_str().ok().filter(|text| text.bytes().all(|b| b.is_ascii_digit()));
        let id = id.and_then(|text| text.parse().ok());
        let reason = "Last-Event-ID must be the id of an event: digits";
        id.map(Self).ok_or_else(|| ApiError::malformed(Some("last-event-id"), reason))
    }
}

/// `GET /v1/refits/{id}/events`: from the beginning, or after `Last-Event-ID`. The stream ends when the refit has, and when the
/// service is about to stop.
pub(crate) async fn stream(
    State(state): State<AppState>,
    RefitId(id): RefitId,
    LastEventId(after): LastEventId,
) -> Result<Response, ApiError> {
    let permit = Arc::clone(state.streams()).try_acquire_owned().map_err(|_| ApiError::Overloaded)?;
    let (changes, stopping) = (state.stores().jobs.watch(), state.stopping());
    // Here, so that an unknown refit is an error and not an empty stream.
    state.stores().jobs.job(&id).await?;
    let follower = Follower {
        state,
        id,
        after,
        waiting: VecDeque::new(),
        ended: false,
        changes,
        stopping,
        _permit: permit,
    };
    let events = stream::unfold(follower, |mut follower| async move {
        let event = follower.next().await?;
        Some((Ok::<_, Infallible>(sent(&event)), follower))
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE)).into_response())
}

fn sent(event: &Event) -> Sent {
    let name = match event.kind {
        EventKind::State => "state",
        EventKind::Progress => "progress",
        EventKind::Log => "log",
    };
    let data = json!({ "at": event.at, "data": event.data });
    Sent::default().id(event.id.to_string()).event(name).retry(RETRY).data(data.to_string())
}

/// A client that follows a refit.
struct Follower {
    state: AppState,
    id: String,
    after: u64,
    waiting: VecDeque<Event>,
    ended: bool,
    changes: watch::Receiver<u64>,
    stopping: watch::Receiver<bool>,
    _permit: OwnedSemaphorePermit,
}

impl Follower {
    /// The next event; `None` at the end.
    async fn next(&mut self) -> Option<Event> {
        loop {
            if let Some(event) = self.waiting.pop_front() {
                self.after = event.id;
                return Some(event);
            }
            if self.ended || *self.stopping.borrow() {
                return None;
            }
            self.look().await;
            if self.waiting.is_empty() && !self.ended {
                self.wait().await;
            }
        }
    }

    /// Fetches what is new. The state first: whatever happened before it ended is then among the events.
    async fn look(&mut self) {
        self.changes.mark_unchanged();
        let jobs = &self.state.stores().jobs;
        let ended = jobs.job(&self.id).await.map(|job| JobState::is_final(job.state));
        match (ended, jobs.events(&self.id, self.after).await) {
            (Ok(ended), Ok(events)) => {
                self.ended = ended;
                self.waiting.extend(events);
            }
            (Err(error), _) | (_, Err(error)) => {
                // The client comes again with the last id it has seen.
                tracing::warn!(refit = self.id, %error, "events cannot be read");
                self.ended = true;
            }
        }
    }

    async fn wait(&mut self) {
        tokio::select! {
            _ = self.changes.changed() => {}
            _ = self.stopping.wait_for(|stop| *stop) => {}
            () = tokio::time::sleep(LOOK) => {}
        }
    }
}
