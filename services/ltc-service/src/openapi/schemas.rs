//! The forms of JSON that are sent and taken.

use serde_json::{Value, json};

fn object(required: &[&str], properties: Value) -> Value {
    json!({ "type": "object", "required": required, "properties": properties })
}

fn strict(required: &[&str], properties: Value) -> Value {
    json!({ "type": "object", "required": required, "properties": properties, "additionalProperties": false })
}

fn list_of(field: &str, schema: &str) -> Value {
    object(&[field], json!({ field: { "type": "array", "items": reference(schema) } }))
}

fn reference(schema: &str) -> Value {
    json!({ "$ref": format!("#/components/schemas/{schema}") })
}

fn digest() -> Value {
    json!({ "type": "string", "pattern": "^sha256:[0-9a-f]{64}$" })
}

pub(super) fn all() -> Value {
    let text = json!({ "type": "string" });
    let number = json!({ "type": "number" });
    let count = json!({ "type": "integer", "minimum": 0 });
    let numbers = json!({ "type": "array", "items": { "type": "integer", "minimum": 1 } });
    let aliases = json!({ "type": "object", "additionalProperties": { "type": "integer", "minimum": 1 } });
    let optional_number = json!({ "type": ["number", "null"] });
    let optional_text = json!({ "type": ["string", "null"] });
    let optional_count = json!({ "type": ["integer", "null"], "minimum": 1 });
    let lookup = object(
        &["lobes", "magnitude", "fresnel"],
        json!({
            "lobes": { "type": "array", "items": object(&["weight", "m"], json!({
                "weight": number,
                "m": { "type": "array", "items": number, "minItems": 9, "maxItems": 9 },
            })) },
            "magnitude": number, "fresnel": number,
        }),
    );
    let change = object(
        &["compared", "tv_mean", "tv_max"],
        json!({ "compared": count, "tv_mean": number, "tv_max": number }),
    );
    let refit = object(
        &["id", "state", "progress", "table", "version", "error", "created", "updated"],
        json!({
            "id": text, "state": { "enum": ["queued", "running", "succeeded", "failed", "cancelled"] },
            "progress": { "type": "number", "minimum": 0, "maximum": 1 }, "table": text, "version": optional_count,
            "error": optional_text, "seconds_left": optional_number, "tv": optional_number,
            "priority": { "type": "integer" }, "alias": optional_text, "even_if_worse": { "type": "boolean" },
            "cancel_requested": { "type": "boolean" }, "attempts": count, "created": text, "updated": text,
            "spec_digest": digest(), "spec": { "type": "object" },
        }),
    );
    let alias_name = json!({ "type": "string", "pattern": "^[a-z][a-z0-9-]{0,63}$" });
    let query = strict(
        &["theta", "alpha_x", "alpha_y"],
        json!({
            "theta": number, "phi": number, "alpha_x": number, "alpha_y": number,
        }),
    );
    let manifest = object(
        &[
            "name", "version", "digest", "axes", "channels", "lobes", "brdf", "fit", "errors", "created",
            "licence",
        ],
        json!({
            "name": text, "version": { "type": "integer", "minimum": 1 }, "digest": digest(), "payload_bytes": count,
            "axes": { "type": "array", "items": object(&["quantity", "mapping", "domain", "len"], json!({
                "quantity": text, "mapping": text, "domain": { "type": "array", "items": number }, "len": count,
            })) },
            "channels": { "type": "array" }, "lobes": count, "brdf": object(&["name"], json!({ "name": text })),
            "fit": {}, "errors": object(&["standard_draw"], json!({ "standard_draw": { "type": "object" } })),
            "created": text, "licence": text,
        }),
    );
    json!({
        "Problem": object(&["type", "title", "status", "detail", "instance", "request_id"], json!({
            "type": text, "title": text, "status": { "type": "integer" }, "detail": text, "instance": text, "help": text,
            "field": text, "request_id": text, "estimate": { "type": "object" },
            "faults": { "type": "array", "items": text }, "version": { "type": "integer" }, "digest": text,
        })),
        "ProblemType": object(&["type", "title", "status", "meaning"], json!({
            "type": text, "title": text, "status": { "type": "integer" }, "meaning": text,
        })),
        "ProblemTypes": list_of("problems", "ProblemType"),
        "State": object(&["status"], json!({ "status": text, "version": text, "tables": count })),
        "Tables": object(&["tables"], json!({ "tables": { "type": "array", "items": object(
            &["name", "latest", "versions", "digest"],
            json!({ "name": text, "latest": count, "versions": numbers, "aliases": aliases, "digest": digest(), "lobes": count,
                    "brdf": text, "licence": text }),
        ) } })),
        "Table": { "allOf": [reference("Manifest"), object(&["latest", "versions"], json!({
            "latest": count, "versions": numbers, "aliases": aliases,
        }))] },
        "Versions": object(&["name", "latest", "versions"], json!({ "name": text, "latest": count, "versions": {
            "type": "array", "items": object(&["version", "digest", "created"], json!({
                "version": count, "digest": digest(), "created": text, "payload_bytes": count, "tv_mean": number,
            })),
        } })),
        "Manifest": manifest,
        "Alias": object(&["table", "alias", "version", "digest", "revision"], json!({
            "table": text, "alias": text, "version": count, "digest": digest(), "revision": count,
        })),
        "Aliases": object(&["table", "aliases"], json!({ "table": text, "aliases": { "type": "array", "items": reference("Alias") } })),
        "AliasTarget": strict(&["version"], json!({ "version": {
            "description": "Number, digest or alias.",
            "oneOf": [{ "type": "integer", "minimum": 1, "maximum": u32::MAX }, { "type": "string", "minLength": 1 }],
        } })),
        "Upload": object(&["manifest", "payload"], json!({
            "manifest": { "type": "object", "description": "manifest.json as ltc writes it, or at least axes, brdf.name and licence." },
            "payload": { "type": "string", "format": "binary", "description": "NPZ, stored: numpy.savez writes it so." },
        })),
        "Query": query,
        "Lookup": lookup,
        "Answer": { "anyOf": [reference("Lookup"), object(&["error"], json!({ "error": text }))] },
        "Diff": object(&["same_payload", "entries", "lookups", "manifest"], json!({
            "same_payload": { "type": "boolean" },
            "entries": { "anyOf": [{ "type": "null" }, { "type": "object" }] },
            "lookups": change, "manifest": { "type": "object" },
        })),
        "RefitRequest": {
            "type": "object", "additionalProperties": false,
            "anyOf": [{ "required": ["preset"] }, { "required": ["spec"] }],
            "properties": {
                "preset": { "type": "string", "description": "A preset by name." },
                "spec": { "type": "object", "description": "The fields of a specification: all, or those that differ from the preset." },
                "priority": { "type": "integer", "minimum": -100, "maximum": 100, "default": 0 },
                "alias": alias_name,
                "even_if_worse": { "type": "boolean", "default": false },
            },
        },
        "Refit": refit,
        "Refits": list_of("refits", "Refit"),
        "BenchmarkRun": strict(&["name", "run"], json!({
            "name": { "type": "string", "minLength": 1, "maxLength": 128 }, "at": { "type": "string", "format": "date-time" },
            "run": { "type": "object" },
        })),
        "BenchmarkKept": object(&["id", "name", "at"], json!({ "id": count, "name": text, "at": text })),
        "Benchmarks": object(&["benchmarks"], json!({ "benchmarks": { "type": "array", "items": object(
            &["id", "name", "at", "run"], json!({ "id": count, "name": text, "at": text, "run": { "type": "object" } }),
        ) } })),
    })
}
