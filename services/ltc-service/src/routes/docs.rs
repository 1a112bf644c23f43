//! The description of the service, for programs and for people.

use std::fmt::Write;

use axum::extract::State;
use axum::http::header;
use axum::response::Response;
use serde_json::Value;

use super::index::{POLICY, escaped};
use crate::preconditions::Preconditions;
use crate::representation::{Caching, Representation, Tagged};
use crate::{ApiError, AppState, openapi};

/// `GET /openapi.json`
pub(crate) async fn openapi(
    State(state): State<AppState>,
    request: Preconditions,
) -> Result<Response, ApiError> {
    Representation::json(&openapi::document(state.settings().read), Caching::Short)?.kept().respond(&request)
}

const PAGE: &str = include_str!("docs.html");

/// `GET /docs`: the same as a page. It loads nothing from anywhere.
pub(crate) async fn page(
    State(state): State<AppState>,
    request: Preconditions,
) -> Result<Response, ApiError> {
    let document = openapi::document(state.settings().read);
    let page =
        PAGE.replace("{{operations}}", &operations(&document)).replace("{{schemas}}", &schemas(&document));
    Representation::new(Tagged::new(page.into_bytes()), "text/html; charset=utf-8", Caching::Short)
        .with(header::CONTENT_SECURITY_POLICY, POLICY)
        .kept()
        .respond(&request)
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

fn operations(document: &Value) -> String {
    let mut out = String::new();
    for (path, item) in document["paths"].as_object().into_iter().flatten() {
        for (method, operation) in item.as_object().into_iter().flatten() {
            // Writing to a string cannot fail, here and below.
            let _ = writeln!(
                out,
                "<details id=\"{id}\"><summary><code><b>{method}</b> {path}</code> {summary}</summary><p>{description}</p>",
                id = escaped(text(operation, "operationId")),
                method = method.to_uppercase(),
                path = escaped(path),
                summary = escaped(text(operation, "summary")),
                description = escaped(text(operation, "description")),
            );
            parameters(operation, &mut out);
            body(operation, &mut out);
            responses(operation, &mut out);
            out.push_str("</details>\n");
        }
    }
    out
}

fn parameters(operation: &Value, out: &mut String) {
    let parameters = operation["parameters"].as_array().into_iter().flatten();
    let mut rows = String::new();
    for parameter in parameters {
        let required = if parameter["required"] == true { "required" } else { "" };
        let _ = writeln!(
            rows,
            "<tr><td><code>{}</code></td><td>{} {required}</td><td><code>{}</code></td><td>{}</td></tr>",
            escaped(text(parameter, "name")),
            escaped(text(parameter, "in")),
            escaped(&parameter["schema"].to_string()),
            escaped(text(parameter, "description")),
        );
    }
    if !rows.is_empty() {
        let _ = writeln!(out, "<h3>Parameters</h3><table>{rows}</table>");
    }
}

/// Media types with their schemas, as links.
fn content(content: &Value) -> String {
    let kinds = content.as_object().into_iter().flatten().map(|(media_type, of)| {
        let schema = &of["schema"];
        let named = text(schema, "$ref").rsplit('/').next().filter(|name| !name.is_empty());
        let schema = match named {
            Some(name) => format!("<a href=\"#{0}\">{0}</a>", escaped(name)),
            None if schema.is_null() => String::new(),
            None => format!("<code>{}</code>", escaped(&schema.to_string())),
        };
        format!("<code>{}</code> {schema}", escaped(media_type))
    });
    kinds.collect::<Vec<_>>().join("<br>")
}

fn body(operation: &Value, out: &mut String) {
    if operation["requestBody"].is_object() {
        let _ = writeln!(out, "<h3>Body</h3><p>{}</p>", content(&operation["requestBody"]["content"]));
    }
}

fn responses(operation: &Value, out: &mut String) {
    out.push_str("<h3>Answers</h3><table>");
    for (status, response) in operation["responses"].as_object().into_iter().flatten() {
        let (description, content) = (escaped(text(response, "description")), content(&response["content"]));
        let _ =
            writeln!(out, "<tr><td>{}</td><td>{description}</td><td>{content}</td></tr>", escaped(status));
    }
    out.push_str("</table>");
}

fn schemas(document: &Value) -> String {
    let mut out = String::new();
    for (name, schema) in document["components"]["schemas"].as_object().into_iter().flatten() {
        let (name, schema) = (escaped(name), serde_json::to_string_pretty(schema).unwrap_or_default());
        let _ = writeln!(
            out,
            "<details id=\"{name}\"><summary><code>{name}</code></summary><pre>{}</pre></details>",
            escaped(&schema)
        );
    }
    out
}
