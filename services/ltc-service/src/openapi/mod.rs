//! The description of the service, OpenAPI 3.1: written here by hand beside the routes, and held to them by tests: the same paths
//! and methods, and answers that the schemas allow.

mod schemas;

use serde_json::{Map, Value, json};

use crate::problem_types;
use crate::routes::history::MOST_RUNS;
use crate::settings::Access;
use crate::variant::Format;

/// One operation under construction.
struct Operation(Value);

/// Statuses that any operation may have.
const ALWAYS: [u16; 4] = [400, 429, 500, 503];

fn operation(id: &str, tag: &str, summary: &str) -> Operation {
    let mut operation = Operation(json!({
        "operationId": id, "tags": [tag], "summary": summary, "parameters": [], "responses": {},
    }));
    for status in ALWAYS {
        operation = operation.problem(status);
    }
    operation
}

fn problem_response(status: u16) -> Value {
    let types = problem_types::ALL.iter().filter(|kind| kind.status.as_u16() == status);
    let slugs: Vec<String> = types.map(|kind| format!("`{}`", kind.slug)).collect();
    json!({
        "description": if slugs.is_empty() { "Refused.".to_owned() } else { slugs.join(", ") },
        "content": { "application/problem+json": { "schema": { "$ref": "#/components/schemas/Problem" } } },
    })
}

impl Operation {
    fn response(mut self, status: u16, value: Value) -> Self {
        self.0["responses"][status.to_string()] = value;
        self
    }

    fn problem(self, status: u16) -> Self {
        self.response(status, problem_response(status))
    }

    fn problems(self, statuses: &[u16]) -> Self {
        statuses.iter().fold(self, |operation, status| operation.problem(*status))
    }

    /// An answer in JSON.
    fn json(self, status: u16, description: &str, schema: &str) -> Self {
        let schema = json!({ "$ref": format!("#/components/schemas/{schema}") });
        let value =
            json!({ "description": description, "content": { "application/json": { "schema": schema } } });
        self.response(status, value)
    }

    /// An answer of bytes or text.
    fn bytes(self, status: u16, description: &str, media_types: &[&str]) -> Self {
        let content: Map<String, Value> = media_types.iter().map(|m| ((*m).to_owned(), json!({}))).collect();
        self.response(status, json!({ "description": description, "content": content }))
    }

    fn parameter(
        mut self,
        name: &str,
        place: &str,
        required: bool,
        schema: Value,
        description: &str,
    ) -> Self {
        let parameter = json!({
            "name": name, "in": place, "required": required, "schema": schema, "description": description,
        });
        if let Some(parameters) = self.0["parameters"].as_array_mut() {
            parameters.push(parameter);
        }
        self
    }

    fn query(self, name: &str, schema: Value, description: &str) -> Self {
        self.parameter(name, "query", false, schema, description)
    }

    fn header(self, name: &str, schema: Value, description: &str) -> Self {
        self.parameter(name, "header", false, schema, description)
    }

    /// A parameter of the path.
    fn path(self, name: &str, description: &str) -> Self {
        self.parameter(name, "path", true, json!({ "type": "string", "minLength": 1 }), description)
    }

    fn body(mut self, content: Value) -> Self {
        self.0["requestBody"] = json!({ "required": true, "content": content });
        self
    }

    /// Can be asked for conditionally.
    fn conditional(self) -> Self {
        self.response(304, json!({ "description": "It has not changed." })).problem(412).header(
            "If-None-Match",
            json!({ "type": "string" }),
            "ETags that the client has.",
        )
    }

    /// Can be asked for in parts.
    fn ranged(self, media_types: &[&str]) -> Self {
        self.conditional()
            .bytes(206, "The bytes asked for, of the plain form.", media_types)
            .problem(416)
            .header("Range", json!({ "type": "string" }), "One range of bytes, as bytes=0-99.")
            .header("If-Range", json!({ "type": "string" }), "The range only if this is still the ETag.")
    }

    /// Needs a token with that scope.
    fn scope(mut self, scope: &str) -> Self {
        self.0["security"] = json!([{ "token": [] }]);
        self.0["description"] = json!(format!("Needs a token with the scope `{scope}`."));
        self.problems(&[401, 403])
    }
}

/// A version's path and what goes wrong with it.
fn of_version(operation: Operation) -> Operation {
    operation
        .path("name", "The table's name.")
        .path("version", "Number, digest (`sha256:<hex>`) or alias.")
        .problem(404)
}

fn of_table(operation: Operation) -> Operation {
    operation.path("name", "The table's name.").problem(404)
}

fn range() -> Value {
    json!({ "type": "string", "examples": ["0.1..0.5"] })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn crops(operation: Operation) -> Operation {
    [
        ("theta", "the view's polar angle"),
        ("phi", "the view's azimuth"),
        ("alpha", "the larger width"),
        ("lambda", "the smaller over it"),
    ]
    .into_iter()
    .fold(operation, |operation, (name, what)| {
        operation.query(name, range(), &format!("LOW..HIGH: only the nodes around this range of {what}."))
    })
}

const DATA_TYPES: [&str; 6] = [
    "application/zip",
    "image/ktx2",
    "application/json",
    "image/vnd.ms-dds",
    "text/plain",
    "text/javascript",
];

fn format_schema() -> Value {
    let names: Vec<&str> = Format::ALL.iter().map(|(name, _)| *name).collect();
    json!({ "type": "string", "enum": names, "default": "npz" })
}

fn precision_schema() -> Value {
    json!({ "type": "string", "enum": ["f16", "f32", "f64"] })
}

fn count(default: u32, most: u32) -> Value {
    json!({ "type": "integer", "minimum": 1, "maximum": most, "default": default })
}

fn history() -> Operation {
    let text = || json!({ "type": "string" });
    operation(
        "benchmark_history",
        "benchmarks",
        "Charts of the runs of `ltc bench` that were posted, for people.",
    )
    .query("name", text(), "Of this series alone.")
    .query("machine", text(), "Of this machine alone, by the name that the page's links have.")
    .query("measure", text(), "Only measures whose name contains this.")
    .query("worse", json!({ "type": "boolean", "default": false }), "Only what became worse at some run.")
    .query("since", text(), "Run at or after this time, in UTC.")
    .query("limit", count(60, MOST_RUNS), "At most so many runs, the newest.")
    .query("page", json!({ "type": "integer", "minimum": 1, "default": 1 }), "Of the charts.")
    .bytes(200, "A page.", &["text/html"])
    .ranged(&["text/html"])
    .problems(&[401, 403, 422])
}

fn service_paths() -> Vec<(&'static str, Value)> {
    let page = |id, summary| {
        operation(id, "service", summary).bytes(200, "A page.", &["text/html"]).ranged(&["text/html"])
    };
    let state = |id, summary| operation(id, "service", summary).json(200, "Yes.", "State");
    vec![
        ("/", json!({ "get": page("index", "The tables, for people.").problems(&[401, 403]).0 })),
        ("/benchmarks", json!({ "get": history().0 })),
        ("/docs", json!({ "get": page("docs", "This description, for people.").0 })),
        (
            "/openapi.json",
            json!({ "get": operation("openapi", "service", "This description.")
            .bytes(200, "OpenAPI 3.1.", &["application/json"]).ranged(&["application/json"]).0 }),
        ),
        (
            "/problems",
            json!({ "get": operation("problems", "service", "The types of problems.")
            .json(200, "All of them.", "ProblemTypes").ranged(&["application/json"]).0 }),
        ),
        (
            "/problems/{slug}",
            json!({ "get": operation("problem", "service", "What a type of problem means.")
            .path("slug", "The end of the type's name.").problem(404)
            .json(200, "The type.", "ProblemType").ranged(&["application/json"]).0 }),
        ),
        ("/healthz", json!({ "get": state("alive", "Whether the process answers.").0 })),
        ("/readyz", json!({ "get": state("ready", "Whether it can do its work.").0 })),
        (
            "/metrics",
            json!({ "get": operation("metrics", "service", "Figures for Prometheus.")
            .bytes(200, "Prometheus text.", &["text/plain"]).0 }),
        ),
    ]
}

fn table_paths() -> Vec<(&'static str, Value)> {
    let read = |id, summary| operation(id, "tables", summary).problems(&[401, 403]);
    let listed = |operation: Operation, schema| {
        operation.json(200, "What there is.", schema).ranged(&["application/json"])
    };
    let upload = of_table(operation("upload", "tables", "Uploads a table made elsewhere. It is measured anew."))
        .scope("publish")
        .body(json!({ "multipart/form-data": {
            "schema": { "$ref": "#/components/schemas/Upload" },
            "encoding": { "manifest": { "contentType": "application/json" }, "payload": { "contentType": "application/zip" } },
        } }))
        .json(201, "Published.", "Manifest").json(200, "It was there already.", "Manifest")
        .problems(&[408, 409, 413, 415, 422]);
    let move_alias =
        of_table(operation("move_alias", "tables", "Points an alias at a version, by compare and swap."))
            .path("alias", "The alias.")
            .scope("publish")
            .header("If-Match", json!({ "type": "string" }), "The ETag of the alias as it is now.")
            .header("If-None-Match", json!({ "type": "string" }), "`*` where there is no such alias yet.")
            .body(json!({ "application/json": { "schema": { "$ref": "#/components/schemas/AliasTarget" } } }))
            .json(200, "Moved.", "Alias")
            .json(201, "Made.", "Alias")
            .problems(&[408, 409, 412, 413, 415, 422, 428]);
    vec![
        ("/v1/tables", json!({ "get": listed(read("tables", "All tables."), "Tables").0 })),
        (
            "/v1/tables/{name}",
            json!({ "get": listed(of_table(read("table", "The latest manifest and what versions there are.")), "Table").0 }),
        ),
        (
            "/v1/tables/{name}/aliases",
            json!({ "get": listed(of_table(read("aliases", "The aliases of a table.")), "Aliases").0 }),
        ),
        (
            "/v1/tables/{name}/aliases/{alias}",
            json!({
                "get": listed(of_table(read("alias", "What an alias points at.")).path("alias", "The alias."), "Alias").0,
                "put": move_alias.0,
            }),
        ),
        (
            "/v1/tables/{name}/versions",
            json!({
                "get": listed(of_table(read("versions", "The versions of a table.")), "Versions").0,
                "post": upload.0,
            }),
        ),
    ]
}

fn version_paths() -> Vec<(&'static str, Value)> {
    let read = |id, summary| of_version(operation(id, "versions", summary)).problems(&[401, 403]);
    let data = crops(read("data", "The table, or the part of it that a scene needs, in any format."))
        .query("format", format_schema(), "The file format.")
        .query("precision", precision_schema(), "Of the numbers; unless given, the most that the format has.")
        .query(
            "channels",
            json!({ "type": "string", "examples": ["m,magnitude,fresnel"] }),
            "For npz and json: some of m, magnitude, fresnel, cells.",
        )
        .bytes(200, "The file.", &DATA_TYPES)
        .ranged(&DATA_TYPES)
        .problem(422);
    let fresnel = read("fresnel", "The magnitude and Fresnel channels alone.")
        .query(
            "format",
            json!({ "type": "string", "enum": ["npz", "json"], "default": "npz" }),
            "The file format.",
        )
        .query("precision", precision_schema(), "Of the numbers.")
        .bytes(200, "The file.", &["application/zip", "application/json"])
        .ranged(&["application/zip", "application/json"])
        .problem(422);
    let one = ["theta", "alpha_x", "alpha_y"].into_iter().fold(
        read("lookup", "What the table says of one view and width.").query(
            "phi",
            number(),
            "Azimuth, radians; 0 unless given.",
        ),
        |operation, name| operation.parameter(name, "query", true, number(), "Radians, or a width above 0."),
    );
    let one = one.json(200, "The lobes.", "Lookup").ranged(&["application/json"]).problem(422);
    let numbers = json!({ "schema": { "type": "string", "format": "binary" } });
    let batch = read("lookups", "The same for many queries.")
        .body(json!({
            "application/json": { "schema": { "type": "array", "items": { "$ref": "#/components/schemas/Query" } } },
            "application/vnd.ltc.queries.f64": numbers, "application/vnd.ltc.queries.f32": numbers,
        }))
        .response(200, json!({ "description": "As many answers, in the same order.", "content": {
            "application/json": { "schema": { "type": "array", "items": { "$ref": "#/components/schemas/Answer" } } },
            "application/vnd.ltc.lookups.f64": {}, "application/vnd.ltc.lookups.f32": {},
        } }))
        .problems(&[408, 413, 415, 422]);
    let diff = read("diff", "What changed between two versions, and what it does to the error.")
        .path("other", "A version of the same table, or NAME@VERSION of any.")
        .json(200, "The differences.", "Diff")
        .ranged(&["application/json"]);
    vec![
        (
            "/v1/tables/{name}/versions/{version}",
            json!({ "get": read("manifest", "The manifest.").json(200, "As it was published.", "Manifest").ranged(&["application/json"]).0 }),
        ),
        ("/v1/tables/{name}/versions/{version}/data", json!({ "get": data.0 })),
        ("/v1/tables/{name}/versions/{version}/fresnel", json!({ "get": fresnel.0 })),
        ("/v1/tables/{name}/versions/{version}/lookup", json!({ "get": one.0, "post": batch.0 })),
        ("/v1/tables/{name}/versions/{version}/diff/{other}", json!({ "get": diff.0 })),
    ]
}

fn job_paths() -> Vec<(&'static str, Value)> {
    let read = |id, tag, summary| operation(id, tag, summary).problems(&[401, 403]);
    let of_refit = |operation: Operation| operation.path("id", "The refit's id.").problem(404);
    let ask =
        operation("ask_refit", "refits", "Asks for a fit. The same specification gives the same version.")
            .scope("refit")
            .header(
                "Idempotency-Key",
                json!({ "type": "string", "minLength": 1, "maxLength": 128 }),
                "The same key with the same request is the same refit.",
            )
            .body(
                json!({ "application/json": { "schema": { "$ref": "#/components/schemas/RefitRequest" } } }),
            )
            .json(202, "It waits its turn.", "Refit")
            .problems(&[408, 409, 413, 415, 422]);
    let cancel = of_refit(operation("cancel_refit", "refits", "Stops a refit."))
        .scope("refit")
        .json(200, "It has stopped.", "Refit")
        .json(202, "It stops at its next shard.", "Refit")
        .problem(409);
    let events = of_refit(read("refit_events", "refits", "What happens to a refit, as it happens."))
        .header(
            "Last-Event-ID",
            json!({ "type": "string", "pattern": "^[0-9]+$" }),
            "Only what came after this event.",
        )
        .bytes(200, "Server-sent events: state, progress, log.", &["text/event-stream"]);
    let add = operation("add_benchmark", "benchmarks", "Keeps a benchmark run.")
        .scope("benchmark")
        .body(json!({ "application/json": { "schema": { "$ref": "#/components/schemas/BenchmarkRun" } } }))
        .json(201, "Kept.", "BenchmarkKept")
        .problems(&[408, 409, 413, 415, 422]);
    let names = |example: &str| json!({ "type": "string", "examples": [example] });
    let files = ["text/plain", "application/octet-stream"];
    let shader = read("shader", "shaders", "Shader source with just what is asked for.")
        .path("lang", "wgsl, glsl, glsl-es, hlsl, msl or spirv.")
        .query("lights", names("quad,line"), "Which lights, with commas between.")
        .query(
            "features",
            names("isotropic,fresnel,surface-horizon"),
            "Exactly which features; both horizons unless given.",
        )
        .bytes(200, "The source, or SPIR-V.", &files)
        .ranged(&files)
        .problems(&[404, 422]);
    let runs = read("benchmarks", "benchmarks", "Benchmark runs, oldest first.")
        .query("name", json!({ "type": "string" }), "Of this series alone.")
        .query(
            "since",
            json!({ "type": "string", "format": "date-time" }),
            "Run at or after this time, in UTC.",
        )
        .query("limit", count(1000, 10_000), "At most so many, the newest.")
        .json(200, "The runs.", "Benchmarks")
        .ranged(&["application/json"])
        .problem(422);
    vec![
        (
            "/v1/refits",
            json!({
                "get": read("refits", "refits", "The newest refits, newest first.").query("limit", count(50, 500), "At most so many.")
                    .json(200, "The refits.", "Refits").ranged(&["application/json"]).problem(422).0,
                "post": ask.0,
            }),
        ),
        (
            "/v1/refits/{id}",
            json!({
                "get": of_refit(read("refit", "refits", "A refit.")).json(200, "As it is now.", "Refit").ranged(&["application/json"]).0,
                "delete": cancel.0,
            }),
        ),
        ("/v1/refits/{id}/events", json!({ "get": events.0 })),
        ("/v1/shaders/{lang}", json!({ "get": shader.0 })),
        ("/v1/benchmarks", json!({ "get": runs.0, "post": add.0 })),
    ]
}

/// The whole description. Where reading needs a token, it says so.
pub(crate) fn document(read: Access) -> Value {
    let paths = [service_paths(), table_paths(), version_paths(), job_paths()].into_iter().flatten();
    let paths: Map<String, Value> = paths.map(|(path, item)| (path.to_owned(), item)).collect();
    let mut document = json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Linearly transformed cosine tables",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "Versioned tables that let area lights shade rough and anisotropic materials in closed form. Errors are \
                            `application/problem+json`; `/problems` explains their types. `HEAD` is answered wherever `GET` is.",
            "license": { "name": "MIT OR Apache-2.0", "identifier": "MIT OR Apache-2.0" },
        },
        "paths": paths,
        "components": {
            "schemas": schemas::all(),
            "securitySchemes": { "token": { "type": "http", "scheme": "bearer", "description": "Made by `ltc token create`." } },
        },
    });
    if read == Access::Token {
        document["security"] = json!([{ "token": [] }]);
    }
    document
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn it_has_the_paths_that_are_served() {
        let document = document(Access::Open);
        let described: BTreeSet<&str> =
            document["paths"].as_object().unwrap().keys().map(String::as_str).collect();
        let served: BTreeSet<&str> = crate::router::patterns().into_iter().skip(1).collect();
        assert_eq!(described, served);
    }

    #[test]
    fn every_reference_leads_somewhere_and_every_operation_has_its_own_name() {
        let document = document(Access::Token);
        let text = document.to_string();
        let mut ids = BTreeSet::new();
        for reference in text.split("\"$ref\":\"#").skip(1) {
            let pointer = reference.split('"').next().unwrap();
            assert!(document.pointer(pointer).is_some(), "{pointer}");
        }
        for item in document["paths"].as_object().unwrap().values() {
            for operation in item.as_object().unwrap().values() {
                assert!(ids.insert(operation["operationId"].as_str().unwrap().to_owned()), "{operation}");
            }
        }
    }

    #[test]
    fn every_type_of_problem_is_described_somewhere() {
        let text = document(Access::Open).to_string();
        for kind in problem_types::ALL.iter().filter(|kind| kind.slug != "method-not-allowed") {
            assert!(text.contains(&format!("`{}`", kind.slug)), "{}", kind.slug);
        }
    }
}
