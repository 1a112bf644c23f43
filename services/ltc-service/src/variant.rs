//! The forms a table can be fetched in.

use ltc_table::drop_in::Language;
use ltc_table::{Channels, DropIn, Manifest, Part, Precision, Quantity, TableError, TableVersion, ktx2, npz};

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
    /// The first of the two textures that engines ship; see [`ltc_table::drop_in`].
    DropInDds1,
    /// The second.
    DropInDds2,
    /// Both as C source.
    DropInC,
    /// Both as a JavaScript module.
    DropInJs,
}

impl Format {
    /// All of them, by the names that requests give them.
    pub const ALL: [(&'static str, Self); 7] = [
        ("npz", Self::Npz),
        ("ktx2", Self::Ktx2),
        ("json", Self::Json),
        ("dropin-dds-1", Self::DropInDds1),
        ("dropin-dds-2", Self::DropInDds2),
        ("dropin-c", Self::DropInC),
        ("dropin-js", Self::DropInJs),
    ];

    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, format)| *format)
    }

    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }

    /// The end of a file's name.
    fn ending(self) -> &'static str {
        match self {
            Self::Npz => ".npz",
            Self::Ktx2 => ".ktx2",
            Self::Json => ".json",
            Self::DropInDds1 => "-ltc_1.dds",
            Self::DropInDds2 => "-ltc_2.dds",
            Self::DropInC => ".h",
            Self::DropInJs => ".js",
        }
    }

    pub(crate) fn content_type(self) -> &'static str {
        match self {
            Self::Npz => "application/zip",
            Self::Ktx2 => "image/ktx2",
            Self::Json => "application/json",
            Self::DropInDds1 | Self::DropInDds2 => "image/vnd.ms-dds",
            Self::DropInC => "text/plain; charset=utf-8",
            Self::DropInJs => "text/javascript; charset=utf-8",
        }
    }

    /// Precisions that the format has, the default first: GPUs do not filter doubles, source text is in singles, the others
    /// give what was fitted.
    fn precisions(self) -> &'static [Precision] {
        match self {
            Self::Npz | Self::Json => &[Precision::F64, Precision::F32, Precision::F16],
            Self::Ktx2 | Self::DropInDds1 | Self::DropInDds2 => &[Precision::F32, Precision::F16],
            Self::DropInC | Self::DropInJs => &[Precision::F32],
        }
    }

    /// Whether channels can be chosen; the other formats hold what shading reads.
    fn has_channels(self) -> bool {
        matches!(self, Self::Npz | Self::Json)
    }
}

/// Axes that a request can crop.
const CROPPED: [Quantity; 4] = [Quantity::Theta, Quantity::Phi, Quantity::Alpha, Quantity::Lambda];

/// One form of a table: the parameters of `data`.
///
/// | parameter | values | default |
/// |---|---|---|
/// | `format` | `npz`, `ktx2`, `json`, `dropin-dds-1`, `dropin-dds-2`, `dropin-c`, `dropin-js` | `npz` |
/// | `precision` | `f16`, `f32`, `f64`; only `npz` and `json` have `f64`, source text has `f32` alone | `f64`; else `f32` |
/// | `channels` | some of `m,magnitude,fresnel,cells`; formats other than `npz` and `json` hold the first three, always | all |
/// | `theta`, `phi`, `alpha`, `lambda` | `LOW..HIGH`: the nodes around that range alone | the whole axis |
///
/// A lookup folds φ into [0, π/2]; a table cropped in φ answers for folded azimuths within its range, and at the range's ends
/// for others. The default of all is the payload itself, byte for byte what the digest is of.
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

impl Variant {
    /// From the parameters of `data`.
    pub(crate) fn of_data(mut params: Params) -> Result<Self, ApiError> {
        let format = format(&mut params)?;
        let channels = match params.take("channels") {
            None if format.has_channels() => Channels::ALL,
            None => Channels::SHADING,
            Some(names) => channels(&names, format)?,
        };
        let precision = precision(&mut params, format)?;
        let mut crop = Vec::new();
        for quantity in CROPPED {
            if let Some(text) = params.take(quantity.name()) {
                crop.push((quantity, range(quantity.name(), &text)?));
            }
        }
        params.finish(&["format", "precision", "channels", "theta", "phi", "alpha", "lambda"])?;
        Ok(Self { format, precision, channels, part: Part(crop) })
    }

    /// From the parameters of `fresnel`.
    pub(crate) fn of_fresnel(mut params: Params) -> Result<Self, ApiError> {
        let format = format(&mut params)?;
        if !format.has_channels() {
            let reason = "always holds the matrices too: fetch it from data, or take npz or json here";
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

    /// Everything that the bytes depend on, besides the program.
    pub(crate) fn key(&self, manifest: &Manifest) -> String {
        let Manifest { name, version, digest, .. } = manifest;
        let Self { format, precision, channels, part } = self;
        let crop: Vec<_> = part.0.iter().map(|(q, range)| (q.name(), range.map(f64::to_bits))).collect();
        let (format, precision) = (format.name(), precision.name());
        format!("data {name}@{version} {digest} {format} {precision} {channels:?} {crop:?}")
    }

    /// A file name that says what is inside: `ggx-isotropic-1.npz`, `ggx-isotropic-1-f16-part.ktx2`.
    pub(crate) fn file_name(&self, manifest: &Manifest) -> String {
        let mut name = format!("{}-{}", manifest.name, manifest.version);
        if self.precision != Precision::F64 {
            name = format!("{name}-{}", self.precision.name());
        }
        let whole = if self.format.has_channels() { Channels::ALL } else { Channels::SHADING };
        if self.channels == Channels::FRESNEL {
            name += "-fresnel";
        } else if self.channels != whole {
            name += "-channels";
        }
        if !self.part.is_whole() {
            name += "-part";
        }
        name + self.format.ending()
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
            Format::DropInDds1 => DropIn::of(&table)?.dds(self.precision).map(|[first, _]| first),
            Format::DropInDds2 => DropIn::of(&table)?.dds(self.precision).map(|[_, second]| second),
            Format::DropInC => DropIn::of(&table)?.text(Language::C).map(String::into_bytes),
            Format::DropInJs => DropIn::of(&table)?.text(Language::JavaScript).map(String::into_bytes),
        };
        written.map_err(|source| match source {
            TableError::PrecisionLoss { .. } | TableError::BadEntry { .. } => ApiError::Unwritable { source },
            other => other.into(),
        })
    }
}

fn format(params: &mut Params) -> Result<Format, ApiError> {
    let Some(name) = params.take("format") else { return Ok(Format::Npz) };
    Format::from_name(&name).ok_or_else(|| {
        let known: Vec<&str> = Format::ALL.iter().map(|(name, _)| *name).collect();
        ApiError::invalid("format", format!("must be one of {}, not {name:?}", known.join(", ")))
    })
}

fn precision(params: &mut Params, format: Format) -> Result<Precision, ApiError> {
    let precisions = format.precisions();
    let Some(name) = params.take("precision") else { return Ok(precisions[0]) };
    let precision = Precision::from_name(&name)
        .ok_or_else(|| ApiError::invalid("precision", format!("must be f16, f32 or f64, not {name:?}")))?;
    if !precisions.contains(&precision) {
        let known: Vec<&str> = precisions.iter().map(|p| p.name()).collect();
        let reason = format!("must be {} for {}, not {name}", known.join(" or "), format.name());
        return Err(ApiError::invalid("precision", reason));
    }
    Ok(precision)
}

fn channels(names: &str, format: Format) -> Result<Channels, ApiError> {
    let chosen = Channels::from_names(names).ok_or_else(|| {
        let reason = format!("must be some of m,magnitude,fresnel,cells, not {names:?}");
        ApiError::invalid("channels", reason)
    })?;
    if !format.has_channels() && chosen != Channels::SHADING {
        let reason = format!("must be m,magnitude,fresnel for {}", format.name());
        return Err(ApiError::invalid("channels", reason));
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
