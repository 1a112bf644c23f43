//! The page at `/`: what is here, for whoever comes by with a browser.

use std::fmt::Write;

use axum::extract::State;
use axum::http::header;
use axum::response::Response;

use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::{ApiError, AppState};

const PAGE: &str = include_str!("index.html");
pub(super) const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

/// `GET /`
pub(crate) async fn page(
    State(state): State<AppState>,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let page = PAGE.replace("{{tables}}", &rows(&state)?).replace("{{version}}", env!("CARGO_PKG_VERSION"));
    Representation::new(Tagged::new(page.into_bytes()), "text/html; charset=utf-8", Caching::Short)
        .with(header::CONTENT_SECURITY_POLICY, POLICY)
        .respond(&request)
}

/// One row for each version of each table.
fn rows(state: &AppState) -> Result<String, ApiError> {
    let mut rows = String::new();
    let index = state.index();
    for name in index.names() {
        for manifest in index.table(name)?.versions() {
            let [name, brdf, digest] = [name, &manifest.brdf.name, &manifest.digest].map(escaped);
            let at = format!("v1/tables/{name}/versions/{}", manifest.version);
            // Writing to a string cannot fail.
            let _ = writeln!(
                rows,
                "<tr><td><a href=\"v1/tables/{name}\">{name}</a></td><td><a href=\"{at}\">{}</a></td><td>{brdf}</td>\
                 <td>{:.4}</td><td><a href=\"{at}/data\">npz</a> <a href=\"{at}/data?format=ktx2\">ktx2</a> \
                 <a href=\"{at}/data?format=json\">json</a> <a href=\"{at}/fresnel\">fresnel</a></td>\
                 <td><code>{digest}</code></td></tr>",
                manifest.version, manifest.errors.standard_draw.tv_mean,
            );
        }
    }
    if rows.is_empty() {
        rows.push_str("<tr><td colspan=\"6\">There is no table yet.</td></tr>");
    }
    Ok(rows)
}

pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escaped("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
    }
}
