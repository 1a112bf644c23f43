//! Where tables come from.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use ltc_table::Catalogue;

/// The tables in the program, and those of a folder.
#[derive(Args)]
pub struct Tables {
    /// A folder of further tables, as `ltc fit -o` writes it: NAME/VERSION/{manifest.json,table.npz}. Versions in it
    /// replace embedded ones of the same name and number.
    #[arg(long = "tables", value_name = "DIR", env = "LTC_TABLES", global = true)]
    folder: Option<PathBuf>,
}

impl Tables {
    /// Reads them all, digests checked.
    pub fn catalogue(&self) -> Result<Catalogue> {
        let mut catalogue = ltc_tables::shipped().context("an embedded table is damaged")?;
        if let Some(folder) = &self.folder {
            catalogue.extend(&Catalogue::read_folder(folder)?);
        }
        Ok(catalogue)
    }
}
