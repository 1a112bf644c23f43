//! `GET /metrics`: Prometheus text.

use std::fmt::Write;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use ltc_store::{BlobKind, Job, JobState};

use crate::AppState;
use crate::metrics::head;
use crate::router::patterns;

/// How many of the newest refits are looked at.
const NEWEST: u32 = 200;

/// What the store does not tell is left out, so that a scrape shows what there is to see all the same.
pub(crate) async fn text(State(state): State<AppState>) -> Response {
    let mut out = String::with_capacity(16 << 10);
    state.metrics().write(&mut out, &patterns());
    write_refits(&state, &mut out).await;
    write_sizes(&state, &mut out).await;
    let gauge = |out: &mut String, name: &str, help: &str, value: f64| {
        head(out, name, "gauge", help);
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(out, "{name} {value}");
    };
    let free = state.requests().available_permits();
    let busy = state.limits().concurrent_requests.saturating_sub(free);
    gauge(
        &mut out,
        "ltc_http_requests_in_flight",
        "Requests under way, without those from the cache.",
        busy as f64,
    );
    gauge(&mut out, "ltc_tables", "Tables that are served.", state.index().names().count() as f64);
    gauge(&mut out, "ltc_uptime_seconds", "Time since the start.", state.uptime().as_secs_f64());
    head(&mut out, "ltc_build_info", "gauge", "The program's version.");
    let _ = writeln!(out, "ltc_build_info{{version=\"{}\"}} 1", env!("CARGO_PKG_VERSION"));
    let headers = [
        (header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    (headers, out).into_response()
}

async fn write_refits(state: &AppState, out: &mut String) {
    if let Ok(now) = state.refits().metrics().await {
        head(out, "ltc_refits", "gauge", "Refits that wait and that run.");
        let (queued, running) = (now.queued, now.running);
        let _ = writeln!(
            out,
            "ltc_refits{{state=\"queued\"}} {queued}\nltc_refits{{state=\"running\"}} {running}"
        );
        head(out, "ltc_refits_ended_total", "counter", "Refits that ended in this process.");
        for (how, count) in [
            ("succeeded", now.succeeded_total),
            ("failed", now.failed_total),
            ("cancelled", now.cancelled_total),
        ] {
            let _ = writeln!(out, "ltc_refits_ended_total{{state=\"{how}\"}} {count}");
        }
        head(out, "ltc_fit_lobes_total", "counter", "Lobes that fits in this process have evaluated.");
        let _ = writeln!(out, "ltc_fit_lobes_total {}", now.lobes_total);
        head(out, "ltc_fit_lobes_per_second", "gauge", "The same a second, at present.");
        let _ = writeln!(out, "ltc_fit_lobes_per_second {}", now.lobes_per_second);
    }
    let Ok(newest) = state.stores().jobs.jobs(NEWEST).await else { return };
    let running: Vec<&Job> = newest.iter().filter(|job| job.state == JobState::Running).collect();
    type Figure = (&'static str, &'static str, fn(&Job) -> Option<f64>);
    let figures: [Figure; 3] = [
        ("ltc_refit_progress_ratio", "Done of a running refit, 0 to 1.", |job| Some(job.progress)),
        ("ltc_refit_seconds_left", "Time that a running refit will still take.", |job| job.seconds_left),
        ("ltc_refit_tv_mean", "Mean total variation of a running refit at present.", |job| job.tv),
    ];
    for (name, help, of) in figures {
        head(out, name, "gauge", help);
        for job in &running {
            if let Some(value) = of(job) {
                let (table, id) = (&job.request.table, &job.id);
                let _ = writeln!(out, "{name}{{table=\"{table}\",id=\"{id}\"}} {value}");
            }
        }
    }
}

async fn write_sizes(state: &AppState, out: &mut String) {
    head(out, "ltc_store_bytes", "gauge", "Bytes of blobs in the store.");
    for (name, kind) in
        [("payload", BlobKind::Payload), ("derived", BlobKind::Derived), ("checkpoint", BlobKind::Checkpoint)]
    {
        if let Ok(blobs) = state.stores().blobs.list(kind).await {
            let bytes: u64 = blobs.iter().map(|(_, bytes)| bytes).sum();
            let _ = writeln!(out, "ltc_store_bytes{{kind=\"{name}\"}} {bytes}");
        }
    }
    head(out, "ltc_memory_cache_bytes", "gauge", "Bytes of caches in memory.");
    let (answers, tables) = (state.answers().bytes(), state.table_bytes());
    let derived = state.derived().bytes();
    for (name, bytes) in [("answers", answers), ("tables", tables), ("derived", derived)] {
        let _ = writeln!(out, "ltc_memory_cache_bytes{{cache=\"{name}\"}} {bytes}");
    }
}
