//! `ltc export`

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use ltc_table::{Channels, DropIn, Part, Precision, Quantity, Table, drop_in::Language, files, ktx2, npz};

use crate::tables::Tables;

/// Writes a table in a format that an engine or NumPy reads.
///
/// Example: ltc export ggx-anisotropic --format ktx2 --precision f16 -o ggx.ktx2
///
/// Example: ltc export ggx-isotropic-dropin --format dropin-dds --precision f16 -o textures
#[derive(Args)]
pub struct Export {
    /// NAME, NAME@VERSION or a digest.
    #[arg(value_name = "TABLE")]
    table: String,
    /// npz: NumPy arrays. ktx2: a texture, three RGBA groups (m00 m01 m02 m10 | m11 m12 m20 m21 | m22 magnitude fresnel 0);
    /// of a table with a closed form the third is m22, the remainders of magnitude and fresnel, and 1.
    /// dropin-dds: the two textures that engines ship, DIR/ltc_1.dds and DIR/ltc_2.dds. dropin-c, dropin-js: the same as source.
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
    /// File to write; a folder for dropin-dds.
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
    DropinDds,
    DropinC,
    DropinJs,
}

/// A range of an axis.
type Crop = (Quantity, [f64; 2]);

/// Files to write.
type Files = Vec<(PathBuf, Vec<u8>)>;

impl Export {
    pub fn run(self, tables: &Tables) -> Result<()> {
        if self.format != Format::Npz && self.channels.is_some() {
            bail!("--channels is for npz; other formats always hold m, magnitude and fresnel")
        }
        let catalogue = tables.catalogue()?;
        let version = catalogue.find(&self.table)?;
        let part = Part(self.crop.clone());
        let table = part.of(version.table())?;
        if let Some(files) = self.drop_in(&table)? {
            return self.write_all(&files, &table);
        }
        let bytes = match self.format {
            Format::Npz => npz::write(&table, self.precision, self.channels.unwrap_or(Channels::ALL))?,
            _ => ktx2::write(&table, self.precision, &part.manifest(version, &table)?)?,
        };
        self.write_all(&[(self.output.clone(), bytes)], &table)
    }

    /// The files of a drop-in, if that is what is asked for.
    fn drop_in(&self, table: &Table) -> Result<Option<Files>> {
        let text = |language| -> Result<_> {
            if self.precision != Precision::F32 {
                bail!("source text is in f32; --precision is for files of numbers")
            }
            Ok(vec![(self.output.clone(), DropIn::of(table)?.text(language)?.into_bytes())])
        };
        let files = match self.format {
            Format::Npz | Format::Ktx2 => return Ok(None),
            Format::DropinDds => {
                let [ltc_1, ltc_2] = DropIn::of(table)?.dds(self.precision)?;
                std::fs::create_dir_all(&self.output).with_context(|| self.output.display().to_string())?;
                vec![(self.output.join("ltc_1.dds"), ltc_1), (self.output.join("ltc_2.dds"), ltc_2)]
            }
            Format::DropinC => text(Language::C)?,
            Format::DropinJs => text(Language::JavaScript)?,
        };
        Ok(Some(files))
    }

    fn write_all(&self, written: &[(PathBuf, Vec<u8>)], table: &Table) -> Result<()> {
        let shape = table.shape();
        for (path, bytes) in written {
            files::write_atomically(path, bytes)?;
            let (path, digest) = (path.display().to_string(), ltc_table::digest::digest(bytes));
            if self.json {
                let file = serde_json::json!({ "file": path, "bytes": bytes.len(), "shape": shape, "digest": digest });
                outln!("{file}");
            } else {
                outln!("{path}: {} bytes, shape {shape:?}", bytes.len());
            }
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
