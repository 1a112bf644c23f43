//! Four layers of settings become one.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::Settings;

/// Where settings come from besides the defaults.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    /// A TOML file.
    pub file: Option<PathBuf>,
    /// Variables of the environment, those of other programs too.
    pub environment: Vec<(String, String)>,
    /// Names and values from flags.
    pub flags: Vec<(String, String)>,
}

/// Why there are no settings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Unreadable {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// The file is no TOML.
    #[error("{}: {reason}", path.display())]
    NotToml {
        /// Which file.
        path: PathBuf,
        /// Where and why.
        reason: String,
    },
    /// There is no such setting.
    #[error("{place}: there is no setting \"{name}\"; ltc serve --check lists them all")]
    Unknown {
        /// Where it stands.
        place: String,
        /// What it is called there.
        name: String,
    },
    /// A setting has another type.
    #[error("{place}: {name} must be {expected}, not {found}")]
    Type {
        /// Where it stands.
        place: String,
        /// Which setting.
        name: String,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A value makes no sense.
    #[error("{name} {reason}")]
    Invalid {
        /// Which setting.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// Variables that begin so belong to a section of settings, and are errors where there is no such setting.
const SECTIONS: [&str; 2] = ["LTC_LIMITS_", "LTC_REFITS_"];

impl Layers {
    /// Flags over environment over file over defaults.
    ///
    /// # Errors
    /// [`SettingsError`], naming the place and the setting.
    pub fn resolve(&self) -> Result<Settings, SettingsError> {
        let mut all = Table::try_from(Settings::default())
            .map_err(|e| SettingsError::Invalid { name: "settings".to_owned(), reason: e.to_string() })?;
        if let Some(path) = &self.file {
            let place = path.display().to_string();
            overlay(&mut all, read(path)?, &place, "")?;
            understood(&all, &place)?;
        }
        let names = leaves(&all, "");
        for (variable, text) in &self.environment {
            let place = || format!("the environment variable {variable}");
            match names.iter().find(|name| variable_of(name) == *variable) {
                Some(name) => {
                    set(&mut all, name, text, &place())?;
                    understood(&all, &format!("{}: {name}", place()))?;
                }
                None if is_misspelt(variable, &names) => {
                    return Err(SettingsError::Unknown { place: place(), name: variable.clone() });
                }
                None => {}
            }
        }
        for (name, text) in &self.flags {
            let place = format!("the flag for {name}");
            set(&mut all, name, text, &place)?;
            understood(&all, &place)?;
        }
        let settings = understood(&all, "settings")?;
        settings.validate()?;
        Ok(settings)
    }
}

/// The settings so far. What can still be wrong when they have the right types is a word of a choice or a negative number; the
/// message names what there may be.
fn understood(all: &Table, place: &str) -> Result<Settings, SettingsError> {
    Value::Table(all.clone()).try_into().map_err(|e: toml::de::Error| SettingsError::Invalid {
        name: place.to_owned(),
        reason: format!("cannot be used: {}", e.message()),
    })
}

/// Whether a variable that is no setting was meant to be one: it begins as a section of them does, or nearly has the name of one.
/// Others may be anybody's: Kubernetes makes `LTC_PORT` for a service of the name ltc.
fn is_misspelt(variable: &str, names: &[String]) -> bool {
    let near = |name: &String| {
        let right = variable_of(name);
        let most = ((right.len() - PREFIX.len()) / 4).clamp(1, 3);
        strsim::osa_distance(&right, variable) <= most
    };
    SECTIONS.iter().any(|section| variable.starts_with(section))
        || (variable.starts_with(PREFIX) && names.iter().any(near))
}

const PREFIX: &str = "LTC_";

/// `limits.body_bytes` is `LTC_LIMITS_BODY_BYTES`.
fn variable_of(name: &str) -> String {
    format!("LTC_{}", name.replace('.', "_").to_ascii_uppercase())
}

fn read(path: &Path) -> Result<Table, SettingsError> {
    let text = std::fs::read_to_string(path)
        .map_err(|cause| SettingsError::Unreadable { path: path.to_owned(), cause })?;
    toml::from_str(&text).map_err(|e: toml::de::Error| {
        let line = e.span().map_or(0, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        SettingsError::NotToml { path: path.to_owned(), reason: format!("line {line}: {}", e.message()) }
    })
}

/// Names of all settings.
fn leaves(table: &Table, prefix: &str) -> Vec<String> {
    let mut names = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(inner) => names.extend(leaves(inner, &format!("{prefix}{key}."))),
            _ => names.push(format!("{prefix}{key}")),
        }
    }
    names
}

/// Puts the values of a file over those that are there.
fn overlay(all: &mut Table, given: Table, place: &str, prefix: &str) -> Result<(), SettingsError> {
    for (key, value) in given {
        let name = format!("{prefix}{key}");
        match (all.get_mut(&key), value) {
            (Some(Value::Table(inner)), Value::Table(given)) => {
                overlay(inner, given, place, &format!("{name}."))?;
            }
            (Some(known), value) => *known = of_type(known, value, &name, place)?,
            (None, _) => return Err(SettingsError::Unknown { place: place.to_owned(), name }),
        }
    }
    Ok(())
}

/// A value of the type that the setting has; whole numbers stand for fractions too.
fn of_type(known: &Value, value: Value, name: &str, place: &str) -> Result<Value, SettingsError> {
    match (known, value) {
        (Value::Float(_), Value::Integer(n)) => Ok(Value::Float(n as f64)),
        (known, value) if known.same_type(&value) => Ok(value),
        (known, value) => Err(SettingsError::Type {
            place: place.to_owned(),
            name: name.to_owned(),
            expected: in_words(known),
            found: value.to_string(),
        }),
    }
}

fn in_words(value: &Value) -> &'static str {
    match value {
        Value::String(_) => "a text",
        Value::Integer(_) => "a whole number",
        Value::Float(_) => "a number",
        Value::Boolean(_) => "true or false",
        Value::Table(_) => "a section",
        _ => "something else",
    }
}

/// Sets one value from text.
fn set(all: &mut Table, name: &str, text: &str, place: &str) -> Result<(), SettingsError> {
    let unknown = || SettingsError::Unknown { place: place.to_owned(), name: name.to_owned() };
    let (section, key) = name.rsplit_once('.').map_or((None, name), |(section, key)| (Some(section), key));
    let table = match section {
        None => all,
        Some(section) => all.get_mut(section).and_then(Value::as_table_mut).ok_or_else(unknown)?,
    };
    let known = table.get_mut(key).ok_or_else(unknown)?;
    let value = match known {
        Value::String(_) => Some(Value::String(text.to_owned())),
        Value::Integer(_) => text.parse().ok().map(Value::Integer),
        Value::Float(_) => text.parse().ok().map(Value::Float),
        Value::Boolean(_) => text.parse().ok().map(Value::Boolean),
        _ => None,
    };
    *known = value.ok_or_else(|| SettingsError::Type {
        place: place.to_owned(),
        name: name.to_owned(),
        expected: in_words(known),
        found: format!("{text:?}"),
    })?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(of: &[(&str, &str)]) -> Vec<(String, String)> {
        of.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
    }

    fn layers(
        file: Option<&str>,
        environment: &[(&str, &str)],
        flags: &[(&str, &str)],
    ) -> (Layers, tempfile::TempDir) {
        let folder = tempfile::tempdir().unwrap();
        let file = file.map(|text| {
            let path = folder.path().join("ltc.toml");
            std::fs::write(&path, text).unwrap();
            path
        });
        (Layers { file, environment: pairs(environment), flags: pairs(flags) }, folder)
    }

    fn resolve(
        file: Option<&str>,
        environment: &[(&str, &str)],
        flags: &[(&str, &str)],
    ) -> Result<Settings, String> {
        let (layers, _folder) = layers(file, environment, flags);
        layers.resolve().map_err(|e| e.to_string())
    }

    #[test]
    fn flags_beat_the_environment_which_beats_the_file_which_beats_the_defaults() {
        let file = "listen = \"127.0.0.1:1\"\nlog = \"warn\"\ndrain_seconds = 3\n[limits]\nbody_bytes = 10";
        let environment = [("LTC_LISTEN", "127.0.0.1:2"), ("LTC_LIMITS_BODY_BYTES", "20"), ("HOME", "/")];
        let flags = [("listen", "127.0.0.1:3")];
        let all = resolve(Some(file), &environment, &flags).unwrap();
        assert_eq!(all.listen, "127.0.0.1:3");
        assert_eq!(all.limits.body_bytes, 20);
        assert_eq!((all.log.as_str(), all.drain_seconds), ("warn", 3.0));
        assert_eq!(all.limits.batch_queries, Limits::default().batch_queries);
        assert_eq!(resolve(None, &[], &[]).unwrap(), Settings::default());
    }

    #[test]
    fn variables_of_others_are_left_alone() {
        let others = [
            "LTC_TOKEN",
            "LTC_TABLES",
            "LTC_CONFIG",
            "LTC_PORT",
            "LTC_SERVICE_HOST",
            "LTC_URL",
            "LTC_DIR",
            "XTC_READ",
        ];
        let environment = others.map(|name| (name, "x"));
        assert_eq!(resolve(None, &environment, &[]).unwrap(), Settings::default());
    }

    #[test]
    fn what_is_printed_is_a_file_that_gives_the_same() {
        let all = resolve(None, &[("LTC_READ", "token")], &[("refits.threads", "3")]).unwrap();
        assert_eq!(resolve(Some(&all.to_toml().unwrap()), &[], &[]).unwrap(), all);
    }

    #[test]
    fn the_documents_name_every_setting() {
        let page = include_str!("../../../../docs/operations.md");
        for name in leaves(&Table::try_from(Settings::default()).unwrap(), "") {
            assert!(page.contains(&format!("| `{name}` |")), "docs/operations.md lacks {name}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (file, environment, flags, needles) in [
            (Some("lisen = 1"), &[][..], &[][..], &["ltc.toml", "lisen"][..]),
            (Some("[limits]\nbody = 1"), &[], &[], &["ltc.toml", "limits.body"]),
            (Some("listen = 1"), &[], &[], &["listen must be a text"]),
            (Some("a\nb ="), &[], &[], &["ltc.toml", "line "]),
            (None, &[("LTC_LIMITS_BODY", "1")], &[], &["LTC_LIMITS_BODY"]),
            (None, &[("LTC_LIMITS_BODY_BYTES", "-1x")], &[], &["LTC_LIMITS_BODY_BYTES", "a whole number"]),
            (None, &[], &[("limits.body", "1")], &["limits.body"]),
            (None, &[], &[("nothing.at.all", "1")], &["nothing.at.all"]),
            (None, &[], &[("limits", "1")], &["limits must be a section"]),
            (None, &[], &[("listen", "nowhere")], &["listen", "nowhere"]),
            (None, &[], &[("read", "maybe")], &["read", "maybe"]),
            (None, &[("LTC_READ", "maybe")], &[], &["LTC_READ", "maybe", "token"]),
            (Some("read = \"maybe\""), &[], &[], &["ltc.toml", "maybe"]),
            (None, &[("LTC_REDA", "token")], &[], &["LTC_REDA"]),
            (None, &[("LTC_LISTN", "x")], &[], &["LTC_LISTN"]),
            (None, &[("LTC_LIMIT_BODY_BYTES", "1")], &[], &["LTC_LIMIT_BODY_BYTES"]),
            (None, &[("LTC_LOGFORMAT", "json")], &[], &["LTC_LOGFORMAT"]),
            (None, &[], &[("limits.body_bytes", "0")], &["limits.body_bytes must be more than 0"]),
            (None, &[], &[("limits.body_bytes", "-5")], &["-5"]),
            (None, &[], &[("drain_seconds", "NaN")], &["drain_seconds"]),
            (None, &[], &[("limits.request_seconds", "1e300")], &["limits.request_seconds"]),
        ] {
            let error = resolve(file, environment, flags).unwrap_err();
            for needle in needles {
                assert!(error.contains(needle), "{needle}: {error}");
            }
            assert!(!error.contains('\n'), "{error}");
        }
    }

    use crate::Limits;
}
