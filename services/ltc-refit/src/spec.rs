//! Specifications as clients send them.

use ltc_fit::{Cost, FitError, FitSpec, Limits, spec_file};
use ltc_table::{Manifest, digest::digest};
use serde_json::Value;

use crate::RefitError;

/// A specification that may be fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// All of it.
    pub spec: FitSpec,
    /// What names it: `sha256:<hex>`.
    pub digest: String,
    /// What its fit is expected to take.
    pub cost: Cost,
}

/// Reads a specification: the fields of [`FitSpec`], or with `"preset": "NAME"` those that differ from the preset, as in the
/// files of `ltc fit`.
///
/// # Errors
/// [`RefitError::Spec`], naming the field; [`RefitError::TooLarge`], with the estimate.
pub fn check(json: &Value, limits: &Limits) -> Result<Checked, RefitError> {
    if !json.is_object() {
        return Err(wrong("", "a specification is a JSON object"));
    }
    if let Some((field, reason)) = unfit(json, "") {
        return Err(wrong(&field, reason));
    }
    // The files' reader knows presets, short axes and what to say of each field; TOML holds all that a specification does.
    let text = toml::Value::try_from(json).map_err(|e| e.to_string());
    let text = text.and_then(|value| toml::to_string(&value).map_err(|e| e.to_string()));
    let text = text.map_err(|reason| wrong("", &reason))?;
    let spec =
        spec_file::from_toml(&text).map_err(|e| RefitError::Spec { field: e.field, reason: e.reason })?;
    let cost = Cost::of(&spec);
    cost.check(limits)?;
    let digest = digest_of(&spec).map_err(|reason| wrong("", &reason))?;
    Ok(Checked { spec, digest, cost })
}

/// What names the specification that a version was fitted by; `None` where its manifest has none.
pub fn spec_digest(manifest: &Manifest) -> Option<String> {
    digest_of(&FitSpec::of_manifest(manifest).ok()?).ok()
}

/// That of [`ltc_fit::Plan::digest`], without a plan: one of a specification that is too large must not be made.
fn digest_of(spec: &FitSpec) -> Result<String, String> {
    serde_json::to_vec(spec).map(|json| digest(&json)).map_err(|e| e.to_string())
}

fn wrong(field: &str, reason: &str) -> RefitError {
    RefitError::Spec { field: field.to_owned(), reason: reason.to_owned() }
}

/// The first thing that TOML does not have, and what is wrong with it.
fn unfit(value: &Value, path: &str) -> Option<(String, &'static str)> {
    match value {
        Value::Null => Some((path.to_owned(), "must not be null: leave it out")),
        Value::Number(number) if number.as_i64().is_none() && number.is_u64() => {
            Some((path.to_owned(), "is too large: must be below 2^63"))
        }
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(i, item)| unfit(item, &format!("{path}[{i}]")))
        }
        Value::Object(fields) => fields.iter().find_map(|(key, value)| {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            unfit(value, &path)
        }),
        _ => None,
    }
}

impl From<FitError> for RefitError {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Spec { field, reason } => wrong(field, &reason),
            FitError::TooLarge { entries, memory, seconds, .. } => {
                Self::TooLarge { entries, memory, seconds, reason: error.to_string() }
            }
            other => wrong("", &other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_fit::Plan;
    use serde_json::json;

    fn refusal(json: Value) -> String {
        check(&json, &Limits::default()).unwrap_err().to_string()
    }

    #[test]
    fn presets_and_what_differs_from_them() {
        let checked = check(&json!({ "preset": "ggx-isotropic" }), &Limits::default()).unwrap();
        let preset = FitSpec::preset("ggx-isotropic").unwrap();
        assert_eq!(checked.spec, preset);
        assert_eq!(checked.digest, Plan::new(preset.clone()).unwrap().digest());
        let other = json!({ "preset": "ggx-isotropic", "joint": { "steps": 7 }, "name": "mine" });
        let other = check(&other, &Limits::default()).unwrap();
        assert_eq!((other.spec.joint.steps, other.spec.joint.seed), (7, preset.joint.seed));
        assert_ne!(other.digest, checked.digest);
        let whole = check(&serde_json::to_value(&preset).unwrap(), &Limits::default()).unwrap();
        assert_eq!(whole, checked, "the whole of it is the same specification");
    }

    #[test]
    fn nonsense_names_its_field() {
        for (json, expected) in [
            (json!([]), "a specification is a JSON object"),
            (json!("ggx-isotropic"), "a specification is a JSON object"),
            (json!({}), "missing field"),
            (json!({ "preset": "phong" }), "preset: no preset named \"phong\""),
            (
                json!({ "preset": "ggx-isotropic", "joint": { "steps": null } }),
                "joint.steps: must not be null",
            ),
            (
                json!({ "preset": "ggx-isotropic", "joint": { "samples": 1 } }),
                "joint.samples: is 1, must be in",
            ),
            (json!({ "preset": "ggx-isotropic", "joint": { "sampels": 1 } }), "joint.sampels: unknown field"),
            (json!({ "preset": "ggx-isotropic", "name": "../x" }), "name: \"../x\" is not a table name"),
            (json!({ "preset": "ggx-isotropic", "joint": { "seed": u64::MAX } }), "joint.seed: "),
            (json!({ "preset": "ggx-isotropic", "a\n[b]\"": 3 }), "unknown field"),
        ] {
            let said = refusal(json.clone());
            assert!(said.contains(expected), "{json}: {said}");
        }
    }

    #[test]
    fn what_is_too_large_is_refused_with_the_estimate() {
        let axis = |quantity: &str| json!({ "quantity": quantity, "mapping": "linear", "len": 3000 });
        let spec = json!({ "preset": "ggx-isotropic", "axes": [axis("theta"), axis("alpha")] });
        let refused = check(&spec, &Limits::default()).unwrap_err();
        let RefitError::TooLarge { entries, memory, ref reason, .. } = refused else { panic!("{refused}") };
        assert_eq!(entries, 9_000_000);
        assert!(memory > 1 << 30 && reason.contains("entries would take about"), "{reason}");
    }
}
