//! The object of one line.

use serde::de::DeserializeOwned;

/// The object of one line. Arrays, which serde would take for an object's fields in order, are refused.
///
/// # Errors
/// What is wrong with the line, in one line.
pub fn object<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    if !line.trim_start().starts_with('{') {
        // For what is no JSON at all, the parser's words; for other JSON, ours.
        serde_json::from_str::<serde_json::Value>(line).map_err(|e| e.to_string())?;
        return Err("must be a JSON object".to_owned());
    }
    serde_json::from_str(line).map_err(|e| e.to_string())
}
