//! Specifications as TOML files.
//!
//! A file has the fields of [`FitSpec`]; with `preset = "NAME"` it has those that differ from the preset. An axis without
//! a `domain` spans the whole range of its quantity.

use serde::Deserialize as _;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use crate::{FitError, FitSpec};

/// What is wrong with a specification file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpecFileError {
    /// The line, from 1; `None` for what is not in the file, such as a missing field or a value of the preset.
    pub line: Option<usize>,
    /// The field, as a path with dots; empty where the file is no TOML.
    pub field: String,
    /// What is wrong with it.
    pub reason: String,
}

impl core::fmt::Display for SpecFileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        f.write_str(&self.reason)
    }
}

impl core::error::Error for SpecFileError {}

/// Reads and validates a specification.
///
/// # Errors
/// [`SpecFileError`], naming the line, the field and what is wrong with it.
pub fn from_toml(text: &str) -> Result<FitSpec, SpecFileError> {
    let document = Document::parse(text)?;
    let mut given: Table = toml::from_str(text).map_err(|e| document.syntax(&e))?;
    let mut whole = match given.remove("preset") {
        None => Table::new(),
        Some(Value::String(name)) => document.preset(&name)?,
        Some(_) => return Err(document.wrong("preset", "must be the name of a preset".to_owned())),
    };
    overlay(&mut whole, given);
    complete_axes(&mut whole);
    let spec: FitSpec = serde_path_to_error::deserialize(Value::Table(whole)).map_err(|error| {
        let field = error.path().to_string();
        let field = if field == "." { String::new() } else { field };
        document.wrong(&field, plain(error.inner()))
    })?;
    spec.validate().map_err(|error| match error {
        FitError::Spec { field, reason } => document.wrong(field, reason),
        other => document.wrong("", other.to_string()),
    })?;
    Ok(spec)
}

/// The specification as TOML with a comment for every field; [`from_toml`] gives it back.
///
/// # Errors
/// [`FitError::Spec`] for a number that TOML cannot hold: a seed of 2⁶³ or more.
pub fn to_toml(spec: &FitSpec) -> Result<String, FitError> {
    let text = toml::to_string(spec)
        .map_err(|e| FitError::Spec { field: "specification", reason: e.to_string() })?;
    let mut out = String::from(
        "# What to fit and how. The same file gives the same table, to the last bit, on any number of threads.\n\
         # A file may also have `preset = \"NAME\"` as its first line, and then only what differs from the preset.\n",
    );
    let mut section = String::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[') {
            let again = section == name;
            section = name.to_owned();
            // Axes come one after the other: what they are is said once.
            if !again {
                comment(&mut out, &section_name(name));
            }
        } else if let Some((key, _)) = line.split_once(" = ") {
            let section = section_name(&section);
            let path = if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") };
            if section != "axes" {
                comment(&mut out, &path);
            }
        }
        out.push_str(line);
        out.push('\n');
    }
    Ok(out)
}

/// `joint]` and `[axes]]`, what is left of a header, as the path that they stand for.
fn section_name(header: &str) -> String {
    header.trim_matches(['[', ']']).to_owned()
}

fn comment(out: &mut String, path: &str) {
    for line in COMMENTS.iter().filter(|(of, _)| *of == path).flat_map(|(_, text)| text.lines()) {
        out.push_str("# ");
        out.push_str(line);
        out.push('\n');
    }
}

/// What each field and section means, for [`to_toml`].
const COMMENTS: &[(&str, &str)] = &[
    ("name", "Name of the table: a-z, 0-9 and -."),
    ("brdf", "Name of the BRDF."),
    ("objective", "What is minimised: total_variation, sliced_wasserstein, l3 or kl."),
    (
        "axes",
        "The axes, slowest first: theta, alpha (isotropic) or theta, phi, alpha, lambda.\n\
         mapping: nodes are even in x (linear), in the root of x (sqrt), in the root of 1 - cos x (sqrt_one_minus_cos)\n\
         in t = tan(x/2) (half_tangent) or in t/(2 - t) (grazing_half_tangent).\n\
         domain: first and last node, angles in radians; left out, it is the whole range. len: number of nodes.",
    ),
    ("floors", "Smallest values that the BRDF is evaluated at."),
    ("floors.alpha", "Smallest width."),
    ("floors.lambda", "Smallest ratio of the widths."),
    ("floors.theta_max", "Largest polar angle, radians."),
    ("entries", "First, each entry by itself."),
    ("entries.samples", "Samples of each lobe."),
    ("entries.iterations", "Most iterations of each entry."),
    (
        "entries.optimiser",
        "quasi_newton (left out, it is this), nelder_mead, or, for isotropic tables, nelder_mead_x_shear,\n\
         nelder_mead_xy_shear, nelder_mead_z_shear, nelder_mead_four.",
    ),
    ("entries.continuation", "Whether each entry is fitted again from where its neighbours ended."),
    ("joint", "Then all entries together, over random queries between them."),
    ("joint.steps", "Steps; 0 leaves the entries as they were fitted alone."),
    ("joint.queries", "Random queries in each step."),
    ("joint.samples", "Samples of the lobe at each query."),
    ("joint.learning_rate", "Length of the first steps, relative to each lobe's width."),
    ("joint.seed", "Seed of the queries."),
    (
        "joint.layout",
        "What is interpolated: matrix (left out, it is this), or drop_in, the inverse as engines ship it.",
    ),
    ("channels", "Then magnitude and Fresnel."),
    ("channels.samples", "Nodes of each integral's quadrature."),
    ("channels.queries", "Random queries between the entries; 0 keeps the entries' own values."),
    ("channels.seed", "Seed of the queries."),
    (
        "channels.power",
        "Power of the error that is minimised: 2 (left out, it is this) for the least mean, up to 8 for a smaller largest.",
    ),
    (
        "channels.closed_form",
        "Formula that entries are taken off before interpolation, and that is added after it: ggx-smith, for the BRDF ggx and\n\
         anisotropic axes; left out, there is none. With it as many queries again are drawn even over the axes.",
    ),
    ("measure", "Last, how good the table is."),
    ("measure.queries", "Random queries of the standard draw."),
    ("measure.samples", "Samples of the lobe at each query and at each entry."),
    ("measure.layout", "As in joint."),
    ("measure.seed", "Seed of the queries; no seed of the fit may be the same."),
];

/// Serde's words without what the field's path says already.
fn plain(error: &toml::de::Error) -> String {
    let message = error.message().trim();
    message.strip_suffix(" in `document`").unwrap_or(message).replace('\n', " ")
}

/// The file with the place of everything in it.
struct Document<'a> {
    text: &'a str,
    table: Spanned<DeTable<'a>>,
}

impl<'a> Document<'a> {
    fn parse(text: &'a str) -> Result<Self, SpecFileError> {
        match DeTable::parse(text) {
            Ok(table) => Ok(Self { text, table }),
            Err(error) => Err(syntax(text, &error)),
        }
    }

    fn syntax(&self, error: &toml::de::Error) -> SpecFileError {
        syntax(self.text, error)
    }

    fn wrong(&self, field: &str, reason: String) -> SpecFileError {
        SpecFileError { line: self.line(field), field: field.to_owned(), reason }
    }

    fn preset(&self, name: &str) -> Result<Table, SpecFileError> {
        let preset = FitSpec::preset(name).map_err(|e| self.wrong("preset", e.to_string()))?;
        Table::try_from(preset).map_err(|e| self.wrong("preset", e.to_string()))
    }

    /// The line of the deepest part of a path (`joint.seed`, `axes[2].len`) that is in the file.
    fn line(&self, path: &str) -> Option<usize> {
        let mut place = None;
        let mut value: Option<&DeValue<'_>> = None;
        for step in path.split(['.', '[']).map(|step| step.trim_end_matches(']')) {
            let next = match value {
                None => entry(self.table.get_ref(), step),
                Some(DeValue::Table(table)) => entry(table, step),
                Some(DeValue::Array(array)) => {
                    let item = step.parse().ok().and_then(|i: usize| array.get(i));
                    item.map(|item| (item.span().start, item.get_ref()))
                }
                Some(_) => None,
            };
            let Some((start, found)) = next else { break };
            (place, value) = (Some(start), Some(found));
        }
        place.map(|start| line_of(self.text, start))
    }
}

/// Where a key of a table begins, and its value.
fn entry<'t, 'a>(table: &'t DeTable<'a>, key: &str) -> Option<(usize, &'t DeValue<'a>)> {
    table.iter().find(|(k, _)| k.get_ref() == key).map(|(k, v)| (k.span().start, v.get_ref()))
}

fn syntax(text: &str, error: &toml::de::Error) -> SpecFileError {
    let line = error.span().map(|span| line_of(text, span.start));
    SpecFileError { line, field: String::new(), reason: error.message().trim().replace('\n', ", ") }
}

fn line_of(text: &str, start: usize) -> usize {
    1 + text.bytes().take(start).filter(|b| *b == b'\n').count()
}

/// Puts what is given over what is there: tables field by field, everything else as a whole.
fn overlay(whole: &mut Table, given: Table) {
    for (key, value) in given {
        match (whole.get_mut(&key), value) {
            (Some(Value::Table(inner)), Value::Table(given)) => overlay(inner, given),
            (_, value) => {
                whole.insert(key, value);
            }
        }
    }
}

/// Gives each axis without a domain the whole range of its quantity.
fn complete_axes(whole: &mut Table) {
    let Some(Value::Array(axes)) = whole.get_mut("axes") else { return };
    for axis in axes.iter_mut().filter_map(Value::as_table_mut) {
        // An unknown quantity is told when the axis is read.
        let quantity = axis.get("quantity").cloned().map(ltc_table::Quantity::deserialize);
        if let Some(Ok(quantity)) = quantity
            && !axis.contains_key("domain")
        {
            let full = ltc_table::Axis::full(quantity, ltc_table::Mapping::Linear, 2);
            axis.insert("domain".to_owned(), Value::from(full.domain.to_vec()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_come_back_and_every_field_is_explained() {
        for name in FitSpec::PRESETS {
            let spec = FitSpec::preset(name).unwrap();
            let text = to_toml(&spec).unwrap();
            assert_eq!(from_toml(&text).unwrap(), spec, "{text}");
            let mut commented = false;
            for line in text.lines() {
                let in_axis =
                    ["quantity", "mapping", "domain", "len"].iter().any(|key| line.starts_with(key));
                let axis_again = line == "[[axes]]";
                assert!(
                    commented || in_axis || axis_again || line.is_empty() || line.starts_with('#'),
                    "{line:?} has no comment in COMMENTS"
                );
                commented = line.starts_with('#');
            }
        }
    }

    #[test]
    fn a_file_may_say_only_what_differs() {
        let text = "preset = 'ggx-isotropic'\nname = 'small'\njoint.steps = 7\n\n[[axes]]\nquantity = 'theta'\n\
                    mapping = 'linear'\nlen = 4\n[[axes]]\nquantity = 'alpha'\nmapping = 'sqrt'\ndomain = [0, 1]\nlen = 5\n";
        let spec = from_toml(text).unwrap();
        let preset = FitSpec::preset("ggx-isotropic").unwrap();
        assert_eq!((spec.name.as_str(), spec.joint.steps, spec.joint.seed), ("small", 7, preset.joint.seed));
        assert_eq!(spec.axes[0].domain, [0.0, core::f64::consts::FRAC_PI_2]);
        assert_eq!((spec.axes[1].domain, spec.axes[1].len), ([0.0, 1.0], 5));
        assert_eq!(spec.channels, preset.channels);
    }

    /// What is said of a file that begins with a preset, in line 1.
    fn refusal(rest: &str) -> String {
        from_toml(&format!("preset = 'ggx-anisotropic'\n{rest}")).unwrap_err().to_string()
    }

    #[test]
    fn nonsense_names_its_line_and_field() {
        for (rest, expected) in [
            ("speed = 3", "line 2: speed: unknown field `speed`"),
            ("\n[joint]\nseed = 1\nsampels = 3", "line 5: joint.sampels: unknown field `sampels`"),
            ("[joint]\nsamples = 'many'", "line 3: joint.samples: invalid type: string \"many\""),
            ("joint.samples = -3", "line 2: joint.samples: invalid value: integer `-3`"),
            ("joint.samples = 1.5", "line 2: joint.samples: invalid type: floating point"),
            ("joint.samples = 1", "line 2: joint.samples: is 1, must be in [32, 1048576]"),
            ("joint = 4", "line 2: joint: invalid type: integer `4`"),
            ("floors.alpha = nan", "line 2: floors.alpha: is NaN, must be in"),
            ("joint.learning_rate = inf", "line 2: joint.learning_rate: is inf, must be in (0, 0.1]"),
            ("measure.seed = 3", "line 2: measure.seed: must differ from"),
            ("objective = 'beauty'", "line 2: objective: \"beauty\" is not known; there are"),
            ("objective = 'l3'", "line 2: objective: l3 is not refined jointly"),
            (
                "entries.optimiser = 'luck'",
                "line 2: entries.optimiser: unknown variant `luck`, expected one of",
            ),
            (
                "entries.optimiser = 'nelder_mead_four'",
                "line 2: entries.optimiser: nelder_mead_four fits isotropic",
            ),
            ("brdf = 'phong'", "line 2: brdf: \"phong\" is not known; there"),
            ("name = '../x'", "line 2: name: \"../x\" is not a table name"),
            ("name = 'a'\nname = 'b'", "line 3: duplicate key"),
            ("joint.seed = 99999999999999999999", "line 2:"),
            ("name = ", "line 2: "),
            ("axes = []", "line 2: axes: must be theta, alpha or theta, phi, alpha, lambda in this order"),
            ("axes = 3", "line 2: axes: invalid type: integer `3`"),
        ] {
            let said = refusal(rest);
            assert!(said.starts_with(expected), "{rest:?}: {said:?}");
            assert!(!said.contains('\n'), "{said:?}");
        }
        // A value of the preset that a change elsewhere makes wrong is in no line.
        assert!(
            refusal("joint.seed = 77").starts_with("measure.seed: must differ"),
            "{}",
            refusal("joint.seed = 77")
        );
        let said = from_toml("preset = 'phong'").unwrap_err().to_string();
        assert!(said.starts_with("line 1: preset: no preset named \"phong\""), "{said}");
        assert_eq!(
            from_toml("preset = 1").unwrap_err().to_string(),
            "line 1: preset: must be the name of a preset"
        );
        assert!(from_toml("name = 'a'").unwrap_err().to_string().contains("missing field"), "no preset");
    }

    #[test]
    fn an_axis_that_makes_no_sense_names_its_line() {
        let axis = |quantity: &str, rest: &str| {
            format!("[[axes]]\nquantity = '{quantity}'\nmapping = 'linear'\n{rest}\n")
        };
        let good = axis("theta", "len = 4");
        for (second, expected) in [
            (axis("alpha", "len = 1"), "line 6: axes[1]: axis alpha must have 2 to 4096 nodes"),
            (
                axis("alpha", "len = 4\ndomain = [0.5, 0.1]"),
                "line 6: axes[1]: axis alpha must have a finite, increasing",
            ),
            (
                axis("alpha", "len = 4\ndomain = [0, nan]"),
                "line 6: axes[1]: axis alpha must have a finite, increasing",
            ),
            (axis("alpha", "len = 4\ndomain = [0, 2]"), "line 6: axes[1]: axis alpha must lie within"),
            (axis("alpha", "len = 4\ndomain = [0]"), "line 10: axes[1].domain: invalid length 1"),
            (axis("alpha", "len = 4\nstep = 1"), "line 10: axes[1].step: unknown field `step`"),
            (axis("beta", "len = 4"), "line 7: axes[1].quantity: unknown variant `beta`"),
            (axis("theta", "len = 4"), "line 2: axes: must be theta, alpha or"),
            (axis("alpha", ""), "line 6: axes[1]: missing field `len`"),
        ] {
            let said = refusal(&format!("{good}{second}"));
            assert!(said.starts_with(expected), "{second:?}: {said:?}");
        }
    }
}
