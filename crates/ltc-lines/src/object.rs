//! The object of one line.

use serde::de::DeserializeOwned;

/// The object of one line. Arrays, which serde would take for an object's fields in order, are refused.
///
/// # Errors
/// What is wrong with the line, in one line.
pub fn object<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    if !line.trim_start().starts_with('{') {
        // For what is no JSON at all, the parser's words; for other JSON, ours.
        serde_json::from_str::<serde_json::Value>(line).map_err(reason)?;
        return Err("must be a JSON object".to_owned());
    }
    serde_json::from_str(line).map_err(reason)
}

/// An error's words in one line. They may quote the input, whose names and keys may hold any character.
pub(crate) fn reason(error: impl std::fmt::Display) -> String {
    let escape = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    error.to_string().chars().map(escape).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_one_line() {
        assert_eq!(reason("unknown field `a\nb\u{7}`"), "unknown field `a\\nb\\u{7}`");
        let refused = object::<u8>("{\"a\\nb\": 1}").map_err(|reason| reason.contains('\n'));
        assert_eq!(refused, Err(false));
    }
}
