//! Asking for fits.

use serde::{Deserialize, Serialize};

use crate::client::read;
use crate::{Client, ClientError};

/// What to fit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RefitRequest {
    /// A preset by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// The fields of a specification: all, or those that differ from the preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spec: Option<serde_json::Value>,
    /// Higher first, -100 to 100.
    pub priority: i32,
    /// The alias to move to the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alias: Option<String>,
    /// Whether it moves even to a result that is worse.
    pub even_if_worse: bool,
}

/// A refit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Refit {
    /// Its id.
    pub id: String,
    /// `queued`, `running`, `succeeded`, `failed`, `cancelled`.
    pub state: String,
    /// Done, 0 to 1.
    pub progress: f64,
    /// Name of the table.
    pub table: String,
    /// The version it led to.
    pub version: Option<u32>,
    /// Why it failed.
    pub error: Option<String>,
}

impl Client {
    /// Asks for a refit. The same `key` with the same request is the same refit, however often it is sent.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn refit(&self, request: &RefitRequest, key: Option<&str>) -> Result<Refit, ClientError> {
        let headers: Vec<_> = key.map(|key| ("idempotency-key", key)).into_iter().collect();
        let (url, body) = self.post("/v1/refits", &headers, request)?;
        read(&url, &body)
    }

    /// A refit as it is now.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn refit_state(&self, id: &str) -> Result<Refit, ClientError> {
        if id.is_empty() || !id.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(ClientError::BadName(id.to_owned()));
        }
        let (url, body) = self.get(&format!("/v1/refits/{id}"))?;
        read(&url, &body)
    }
}
