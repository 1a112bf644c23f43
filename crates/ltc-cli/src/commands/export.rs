//! `ltc export`

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use ltc_table::{Channels, Part, Precision, Quantity, files, ktx2, npz};

use crate::tables::Tables;

/// Writes a table in a format that an engine or NumPy reads.
///
/// Example: ltc export ggx-anisotropic --format ktx2 --precision f16 -o ggx.ktx2
#[derive(Args)]
pub struct Export {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "TABLE")]
    table: String,
    /// npz: NumPy arrays. ktx2: a texture, three RGBA groups (m00 m01 m02 m10 | m11 m12 m20 m21 | m22 magnitude fresnel 0).
    #[arg(long, value_enum)]
    format: Format,
    /// Number format; f64 for npz alone.
    #[arg(long, value_parser = parse_precision, default_value = "f32")]
    precision: Precision,
    /// Channels of an npz, with commas: m, magnitude, fresnel, cells.
    #[arg(long, value_parser = parse_channels)]
    channels: Option<Channels>,
    /// Keeps only the nodes around a range of an axis: theta, phi, alpha or lambda = LOW..HIGH. May be repeated.
    #[arg(long, value_name = "AXIS=LOW..HIGH", value_parser = parse_crop)]
    crop: Vec<Crop>,
    /// File to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Prints what was written as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    Npz,
    Ktx2,
}

/// A range of an axis.
type Crop = (Quantity, [f64; 2]);

impl Export {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let version = catalogue.find(&self.table)?;
        let part = Part(self.crop.clone());
        let table = part.of(version.table())?;
        let bytes = match self.format {
            Format::Npz => npz::write(&table, self.precision, self.channels.unwrap_or(Channels::ALL))?,
            Format::Ktx2 if self.channels.is_some() => {
                bail!("--channels is for npz; a ktx2 always holds m, magnitude and fresnel")
            }
            Format::Ktx2 => ktx2::write(&table, self.precision, &part.manifest(version, &table)?)?,
        };
        files::write_atomically(&self.output, &bytes)?;
        let (path, shape) = (self.output.display().to_string(), table.shape());
        if self.json {
            let digest = ltc_table::digest::digest(&bytes);
            outln!(
                "{}",
                serde_json::json!({ "file": path, "bytes": bytes.len(), "shape": shape, "digest": digest })
            );
        } else {
            outln!("{path}: {} bytes, shape {shape:?}", bytes.len());
        }
        Ok(())
    }
}

fn parse_precision(text: &str) -> Result<Precision, String> {
    Precision::from_name(text).ok_or_else(|| "must be f16, f32 or f64".to_owned())
}

fn parse_channels(text: &str) -> Result<Channels, String> {
    Channels::from_names(text).ok_or_else(|| "must be of m, magnitude, fresnel, cells".to_owned())
}

fn parse_crop(text: &str) -> Result<Crop> {
    let (axis, range) = text.split_once('=').context("must be AXIS=LOW..HIGH")?;
    let (low, high) = range.split_once("..").context("must be AXIS=LOW..HIGH")?;
    let quantity = [Quantity::Theta, Quantity::Phi, Quantity::Alpha, Quantity::Lambda]
        .into_iter()
        .find(|q| q.name() == axis)
        .context("axis must be theta, phi, alpha or lambda")?;
    Ok((quantity, [low.parse().context("LOW")?, high.parse().context("HIGH")?]))
}
