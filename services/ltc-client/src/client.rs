//! Asking the service.

use std::io::Read;
use std::path::Path;
use std::time::Duration;

use ltc_table::digest::{digest, is_digest};
use ltc_table::{Lookup, Manifest, Query, TableVersion};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use ureq::config::ConfigBuilder;
use ureq::http::Response;
use ureq::typestate::AgentScope;
use ureq::{Agent, Body};

use crate::{Cache, ClientError};

/// Larger answers are refused: no table is so large.
const LARGEST: u64 = 1 << 30;
/// How long an answer may take. An upload or a difference is worked out before it is answered.
const PATIENCE: Duration = Duration::from_secs(300);

/// A service, and what has been fetched from it.
#[derive(Clone, Debug)]
pub struct Client {
    agent: Agent,
    url: String,
    token: Option<Token>,
    cache: Option<Cache>,
}

/// A secret: not for logs.
#[derive(Clone)]
struct Token(String);

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token(…)")
    }
}

/// A table in the list of all.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TableSummary {
    /// Its name.
    pub name: String,
    /// Number of the version that `latest` stands for.
    pub latest: u32,
    /// Numbers of all versions.
    pub versions: Vec<u32>,
    /// Digest of the latest.
    pub digest: String,
}

/// Which form of a table to fetch; see the service's documents. Empty ones are left to the service.
#[derive(Clone, Copy, Debug, Default)]
pub struct Data<'a> {
    /// `npz`, `ktx2`, `json`, `dropin-dds-1`, …
    pub format: &'a str,
    /// `f16`, `f32`, `f64`.
    pub precision: &'a str,
    /// Some of `m,magnitude,fresnel,cells`.
    pub channels: &'a str,
    /// Ranges of axes to keep: name, low and high.
    pub crop: &'a [(&'a str, [f64; 2])],
}

#[derive(Deserialize)]
struct Tables {
    tables: Vec<TableSummary>,
}

#[derive(Serialize)]
struct Benchmark<'a, T> {
    name: &'a str,
    at: &'a str,
    run: &'a T,
}

#[derive(Deserialize)]
struct Kept {
    id: u64,
}

#[derive(Deserialize)]
struct Problem {
    #[serde(default)]
    r#type: String,
    #[serde(default)]
    detail: String,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Answer {
    Lookup(Lookup),
    Refused { error: String },
}

impl Client {
    /// A client of the service at a URL, such as `http://127.0.0.1:8787`.
    pub fn new(url: &str) -> Self {
        let agent = Agent::new_with_config(config().build());
        Self { agent, url: url.trim_end_matches('/').to_owned(), token: None, cache: None }
    }

    /// Believes only services whose certificates one of these authorities has signed (PEM, one or more), as a company's own does.
    /// Without this it is the authorities that Mozilla lists.
    ///
    /// # Errors
    /// [`ClientError::NoAuthority`] where there is no certificate among them, or one that cannot be read.
    #[cfg(feature = "tls")]
    pub fn with_authorities(mut self, pem: &[u8]) -> Result<Self, ClientError> {
        use ureq::tls::{PemItem, RootCerts, TlsConfig, parse_pem};

        let mut authorities = Vec::new();
        for item in parse_pem(pem) {
            match item.map_err(|cause| ClientError::NoAuthority { reason: cause.to_string() })? {
                PemItem::Certificate(certificate) => authorities.push(certificate),
                _ => {
                    let reason = "there is something else than certificates among them".to_owned();
                    return Err(ClientError::NoAuthority { reason });
                }
            }
        }
        if authorities.is_empty() {
            return Err(ClientError::NoAuthority { reason: "there is no certificate".to_owned() });
        }
        let tls = TlsConfig::builder().root_certs(RootCerts::new_with_certs(&authorities)).build();
        self.agent = Agent::new_with_config(config().tls_config(tls).build());
        Ok(self)
    }

    /// With a token, `ltc_…`.
    #[must_use]
    pub fn with_token(mut self, token: &str) -> Self {
        self.token = Some(Token(format!("Bearer {token}")));
        self
    }

    /// With a folder that keeps the tables that were fetched.
    #[must_use]
    pub fn with_cache(mut self, folder: &Path) -> Self {
        self.cache = Some(Cache::new(folder));
        self
    }

    /// All tables.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn tables(&self) -> Result<Vec<TableSummary>, ClientError> {
        let (url, body) = self.get("/v1/tables")?;
        Ok(read::<Tables>(&url, &body)?.tables)
    }

    /// The manifest of a version: number, digest or alias.
    ///
    /// # Errors
    /// [`ClientError::NotGenuine`] where it is the manifest of something else, and others.
    pub fn manifest(&self, name: &str, version: &str) -> Result<Manifest, ClientError> {
        let (url, body) = self.get(&path(name, version, "")?)?;
        let manifest: Manifest = read(&url, &body)?;
        if manifest.name != name || (is_digest(version) && manifest.digest != version) {
            let (found, digest) = (&manifest.name, &manifest.digest);
            return Err(ClientError::NotGenuine {
                url,
                reason: format!("this is the manifest of {found}, {digest}"),
            });
        }
        Ok(manifest)
    }

    /// A table, from the cache or the service, its payload held to the digest. By digest the cache alone is enough: no network
    /// is needed.
    ///
    /// # Errors
    /// [`ClientError::NotGenuine`] for a payload of another digest, and others.
    pub fn table(&self, name: &str, version: &str) -> Result<TableVersion, ClientError> {
        if is_digest(version)
            && let Some(cache) = &self.cache
            && let Some(known) = cache.table(version)?.filter(|known| known.manifest().name == name)
        {
            return Ok(known);
        }
        let manifest = self.manifest(name, version)?;
        if let Some(cache) = &self.cache
            && let Some(payload) = cache.payload(&manifest.digest)?
        {
            return Ok(TableVersion::new(manifest, payload)?);
        }
        let (url, payload) = self.get(&path(name, &manifest.digest, "/data")?)?;
        let found = digest(&payload);
        if found != manifest.digest {
            let reason = format!("the payload's digest is {found}, not {}", manifest.digest);
            return Err(ClientError::NotGenuine { url, reason });
        }
        let version = TableVersion::new(manifest, payload)?;
        if let Some(cache) = &self.cache {
            cache.keep(&version)?;
        }
        Ok(version)
    }

    /// A table in some form, as it is for an engine.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn data(&self, name: &str, version: &str, data: &Data<'_>) -> Result<Vec<u8>, ClientError> {
        let words = [("format", data.format), ("precision", data.precision), ("channels", data.channels)];
        let words = words.into_iter().filter(|(_, value)| !value.is_empty());
        let words = words.map(|(name, value)| (name, value.to_owned()));
        let crop = data.crop.iter().map(|(axis, [low, high])| (*axis, format!("{low}..{high}")));
        let query: Vec<String> =
            words.chain(crop).map(|(name, value)| format!("{}={}", escaped(name), escaped(&value))).collect();
        Ok(self.get(&path(name, version, &format!("/data?{}", query.join("&")))?)?.1)
    }

    /// What a table says of queries: for each its answer, or why there is none.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn lookup(
        &self,
        name: &str,
        version: &str,
        queries: &[Query],
    ) -> Result<Vec<Result<Lookup, String>>, ClientError> {
        let (url, body) = self.post(&path(name, version, "/lookup")?, &[], &queries)?;
        let answers: Vec<Answer> = read(&url, &body)?;
        if answers.len() != queries.len() {
            let reason = format!("{} answers to {} queries", answers.len(), queries.len());
            return Err(ClientError::NotGenuine { url, reason });
        }
        Ok(answers
            .into_iter()
            .map(|answer| match answer {
                Answer::Lookup(lookup) => Ok(lookup),
                Answer::Refused { error } => Err(error),
            })
            .collect())
    }

    /// Posts a benchmark run to a series; gives the id under which it is kept. `at` is when it ran, RFC 3339 in UTC. Needs a token
    /// with the scope `benchmark`.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn add_benchmark(&self, series: &str, at: &str, run: &impl Serialize) -> Result<u64, ClientError> {
        let body = Benchmark { name: series, at, run };
        let (url, body) = self.post("/v1/benchmarks", &[], &body)?;
        Ok(read::<Kept>(&url, &body)?.id)
    }

    /// URL and body of a GET.
    pub(crate) fn get(&self, path: &str) -> Result<(String, Vec<u8>), ClientError> {
        let url = format!("{}{path}", self.url);
        let mut request = self.agent.get(&url);
        if let Some(Token(token)) = &self.token {
            request = request.header("authorization", token);
        }
        taken(url, request.call())
    }

    /// URL and body of a POST in JSON.
    pub(crate) fn post(
        &self,
        path: &str,
        headers: &[(&str, &str)],
        body: &impl Serialize,
    ) -> Result<(String, Vec<u8>), ClientError> {
        let url = format!("{}{path}", self.url);
        let mut request = self.agent.post(&url);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        if let Some(Token(token)) = &self.token {
            request = request.header("authorization", token);
        }
        taken(url, request.send_json(body))
    }
}

/// How requests are made.
fn config() -> ConfigBuilder<AgentScope> {
    Agent::config_builder().http_status_as_error(false).timeout_global(Some(PATIENCE))
}

/// Reads JSON.
pub(crate) fn read<T: DeserializeOwned>(url: &str, body: &[u8]) -> Result<T, ClientError> {
    serde_json::from_slice(body).map_err(|cause| ClientError::Unreadable { url: url.to_owned(), cause })
}

/// The body of an answer of 2xx.
fn taken(url: String, answer: Result<Response<Body>, ureq::Error>) -> Result<(String, Vec<u8>), ClientError> {
    let network = |cause: ureq::Error| ClientError::Network { url: url.clone(), cause: Box::new(cause) };
    let (parts, body) = answer.map_err(network)?.into_parts();
    let mut bytes = Vec::new();
    let read = body.into_with_config().limit(LARGEST).reader().read_to_end(&mut bytes);
    read.map_err(|cause| network(cause.into()))?;
    if parts.status.is_success() {
        return Ok((url, bytes));
    }
    let problem: Option<Problem> = serde_json::from_slice(&bytes).ok();
    let (kind, detail) = problem.map_or_else(Default::default, |problem| (problem.r#type, problem.detail));
    Err(ClientError::Refused { url, status: parts.status.as_u16(), kind, detail })
}

/// The path of something of a version; nothing in it can lead elsewhere.
fn path(name: &str, version: &str, rest: &str) -> Result<String, ClientError> {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-:".contains(&b);
    for part in [name, version] {
        if part.is_empty() || !part.bytes().all(plain) {
            return Err(ClientError::BadName(part.to_owned()));
        }
    }
    Ok(format!("/v1/tables/{name}/versions/{version}{rest}"))
}

/// Percent-encoded.
fn escaped(text: &str) -> String {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || b"-._,".contains(b);
    text.bytes().map(|b| if plain(&b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}
