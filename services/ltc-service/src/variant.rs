//! The forms a table can be fetched in.

use ltc_table::{Channels, Part, Precision, Quantity, TableError, TableVersion, ktx2, npz};

use crate::params::{Params, number};
use crate::{ApiError, json_table};

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// NumPy arrays in a zip archive.
    Npz,
    /// A texture for a GPU; see [`ltc_table::ktx2`].
    Ktx2,
    /// The arrays of the NPZ as nested lists, with name, version, digest and axes.
    Json,
}

impl Format {
    fn from_name(name: &str) -> Option<Self> {
        match name {
            "npz" => Some(Self::Npz),
            "ktx2" => Some(Self::Ktx2),
            "json" => Some(Self::Json),
            _ => None,
        }
    }

    fn extension(self) -> &'static str {
        match self {
            Self::Npz => "npz",
            Self::Ktx2 => "ktx2",
            Self::Json => "json",
        }
    }

    pub(crate) fn content_type(self) -> &'static str {
        match self {
            Self::Npz => "application/zip",
            Self::Ktx2 => "image/ktx2",
            Self::Json => "application/json",
        }
    }

    /// GPUs do not filter doubles; the others give what was fitted.
    fn default_precision(self) -> Precision {
        match self {
            Self::Npz | Self::Json => Precision::F64,
            Self::Ktx2 => Precision::F32,
        }
    }
}

/// Axes that a request can crop. Not φ: every lookup folds it into the whole axis.
const CROPPED: [Quantity; 3] = [Quantity::Theta, Quantity::Alpha, Quantity::Lambda];

/// One form of a table: the parameters of `data`.
///
/// | parameter | values | default |
/// |---|---|---|
/// | `format` | `npz`, `ktx2`, `json` | `npz` |
/// | `precision` | `f16`, `f32`, `f64`; `ktx2` has no `f64` | `f64`; `ktx2`: `f32` |
/// | `channels` | some of `m,magnitude,fresnel,cells`; `ktx2` holds the first three, always | all |
/// | `theta`, `alpha`, `lambda` | `LOW..HIGH`: the nodes around that range alone | the whole axis |
///
/// The default of all is the payload itself, byte for byte what the digest is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// The file format.
    pub format: Format,
    /// Of the matrices, magnitude and Fresnel terms; axis nodes and cell statistics keep `f64`.
    pub precision: Precision,
    /// What is in it.
    pub channels: Channels,
    /// Ranges of axes to keep.
    pub part: Part,
}

/// Names the bytes of a variant of a version.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct VariantKey {
    table: (String, u32, String),
    format: Format,
    precision: Precision,
    channels: Channels,
    crop: Vec<(Quantity, [u64; 2])>,
}

impl Variant {
    /// From the parameters of `data`.
    pub(crate) fn of_data(mut params: Params) -> Result<Self, ApiError> {
        let format = format(&mut params)?;
        let channels = match params.take("channels") {
            None if format == Format::Ktx2 => Channels::SHADING,
            None => Channels::ALL,
            Some(names) => channels(&names, format)?,
        };
        let precision = precision(&mut params, format)?;
        let mut crop = Vec::new();
        for quantity in CROPPED {
            if let Some(text) = params.take(quantity.name()) {
                crop.push((quantity, range(quantity.name(), &text)?));
            }
        }
        params.finish(&["format", "precision", "channels", "theta", "alpha", "lambda"])?;
        Ok(Self { format, precision, channels, part: Part(crop) })
    }

    /// From the parameters of `fresnel`.
    pub(crate) fn of_fresnel(mut params: Params) -> Result<Self, ApiError> {
        let format = format(&mut params)?;
        if format == Format::Ktx2 {
            let reason = "ktx2 always holds the matrices too: fetch it from data, or take npz or json here";
            return Err(ApiError::invalid("format", reason));
        }
        let precision = precision(&mut params, format)?;
        params.finish(&["format", "precision"])?;
        Ok(Self { format, precision, channels: Channels::FRESNEL, part: Part::default() })
    }

    /// Whether this is the payload itself.
    pub(crate) fn is_payload(&self) -> bool {
        self.format == Format::Npz
            && self.precision == Precision::F64
            && self.channels == Channels::ALL
            && self.part.is_whole()
    }

    pub(crate) fn key(&self, version: &TableVersion) -> VariantKey {
        let manifest = version.manifest();
        VariantKey {
            table: (manifest.name.clone(), manifest.version, manifest.digest.clone()),
            format: self.format,
            precision: self.precision,
            channels: self.channels,
            crop: self.part.0.iter().map(|(q, range)| (*q, range.map(f64::to_bits))).collect(),
        }
    }

    /// A file name that says what is inside: `ggx-isotropic-1.npz`, `ggx-isotropic-1-f16-part.ktx2`.
    pub(crate) fn file_name(&self, version: &TableVersion) -> String {
        let manifest = version.manifest();
        let mut name = format!("{}-{}", manifest.name, manifest.version);
        if self.precision != Precision::F64 {
            name = format!("{name}-{}", self.precision.name());
        }
        let whole = if self.format == Format::Ktx2 { Channels::SHADING } else { Channels::ALL };
        if self.channels == Channels::FRESNEL {
            name += "-fresnel";
        } else if self.channels != whole {
            name += "-channels";
        }
        if !self.part.is_whole() {
            name += "-part";
        }
        format!("{name}.{}", self.format.extension())
    }

    /// The bytes.
    ///
    /// # Errors
    /// A crop that the table does not have, a precision that cannot hold it.
    pub(crate) fn encode(&self, version: &TableVersion) -> Result<Vec<u8>, ApiError> {
        let table = self.part.of(version.table())?;
        let written = match self.format {
            Format::Npz => npz::write(&table, self.precision, self.channels),
            Format::Ktx2 => ktx2::write(&table, self.precision, &self.part.manifest(version, &table)?),
            Format::Json => json_table::write(version, &table, self.precision, self.channels),
        };
        written.map_err(|source| match source {
            TableError::PrecisionLoss { .. } | TableError::BadEntry { .. } => ApiError::Unwritable { source },
            other => other.into(),
        })
    }
}

fn format(params: &mut Params) -> Result<Format, ApiError> {
    let Some(name) = params.take("format") else { return Ok(Format::Npz) };
    Format::from_name(&name)
        .ok_or_else(|| ApiError::invalid("format", format!("must be npz, ktx2 or json, not {name:?}")))
}

fn precision(params: &mut Params, format: Format) -> Result<Precision, ApiError> {
    let Some(name) = params.take("precision") else { return Ok(format.default_precision()) };
    let precision = Precision::from_name(&name)
        .ok_or_else(|| ApiError::invalid("precision", format!("must be f16, f32 or f64, not {name:?}")))?;
    if format == Format::Ktx2 && precision == Precision::F64 {
        return Err(ApiError::invalid("precision", "must be f16 or f32 for ktx2: no GPU filters f64"));
    }
    Ok(precision)
}

fn channels(names: &str, format: Format) -> Result<Channels, ApiError> {
    let chosen = Channels::from_names(names).ok_or_else(|| {
        let reason = format!("must be some of m,magnitude,fresnel,cells, not {names:?}");
        ApiError::invalid("channels", reason)
    })?;
    if format == Format::Ktx2 && chosen != Channels::SHADING {
        return Err(ApiError::invalid("channels", "must be m,magnitude,fresnel for ktx2"));
    }
    Ok(chosen)
}

/// `LOW..HIGH`, both finite. Whether the axis has it, the table says.
fn range(field: &str, text: &str) -> Result<[f64; 2], ApiError> {
    let form = || ApiError::malformed(Some(field), format!("{field} must be LOW..HIGH, not {text:?}"));
    let (low, high) = text.split_once("..").ok_or_else(form)?;
    let ends = [number(field, low)?, number(field, high)?];
    if ends.iter().all(|end| end.is_finite()) {
        Ok(ends)
    } else {
        Err(ApiError::invalid(field, "must have two finite ends"))
    }
}
