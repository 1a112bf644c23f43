//! NPZ: NumPy arrays in an uncompressed zip archive, byte for byte reproducible.

use std::io::{Cursor, Read, Write};

use glam::DMat3;
use half::f16;
use ltc_core::Matrix;
use npyz::WriterBuilder;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter, write::SimpleFileOptions};

use crate::{Axis, CellStats, Channels, Precision, Table, TableError};

/// Arrays larger than this are refused on reading: no table is.
const MAX_ARRAY_BYTES: u64 = 1 << 30;

fn npz_error(reason: impl ToString) -> TableError {
    TableError::Npz { reason: reason.to_string() }
}

/// Writes the table's arrays: `m` (axes, then 3×3 row-major), `magnitude`, `fresnel`, `axis_<quantity>`, and
/// `cell_tv`, `cell_leak`, `cell_condition` where the table has them. The same table gives the same bytes.
///
/// # Errors
/// [`TableError::PrecisionLoss`] or [`TableError::BadEntry`] where `precision` cannot hold the table.
pub fn write(table: &Table, precision: Precision, channels: Channels) -> Result<Vec<u8>, TableError> {
    let table = &table.rounded(precision)?;
    let shape: Vec<u64> = table.axes().iter().map(|a| a.len as u64).collect();
    let mut archive = Archive::new(precision);
    if channels.m {
        let rows: Vec<f64> = table.m().iter().flat_map(|m| m.to_row_array()).collect();
        archive.array("m", &[&shape[..], &[3, 3]].concat(), &rows)?;
    }
    if channels.magnitude {
        archive.array("magnitude", &shape, table.magnitude())?;
    }
    if channels.fresnel {
        archive.array("fresnel", &shape, table.fresnel())?;
    }
    for axis in table.axes() {
        // Nodes keep full precision: a reader that interpolates needs them exact.
        archive.exact(&format!("axis_{}", axis.quantity.name()), &[axis.len as u64], &axis.nodes())?;
    }
    let cells = table.cells();
    for (name, values) in
        [("cell_tv", &cells.tv), ("cell_leak", &cells.leak), ("cell_condition", &cells.condition)]
    {
        if channels.cells && !values.is_empty() {
            archive.exact(name, &shape, values)?;
        }
    }
    archive.finish()
}

/// Reads the arrays of [`write()`] back, at any precision. The axes come from the manifest and must fit.
///
/// # Errors
/// [`TableError`] for an archive that is damaged, lacks an array, or contradicts the axes.
pub fn read(bytes: &[u8], axes: &[Axis]) -> Result<Table, TableError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(npz_error)?;
    let shape: Vec<u64> = axes.iter().map(|a| a.len as u64).collect();
    for axis in axes {
        check_nodes(
            axis,
            &read_array(&mut archive, &format!("axis_{}", axis.quantity.name()), &[axis.len as u64])?,
        )?;
    }
    let rows = read_array(&mut archive, "m", &[&shape[..], &[3, 3]].concat())?;
    let m = rows.as_chunks::<9>().0.iter().map(|rows| DMat3::from_row_array(*rows)).collect();
    let magnitude = read_array(&mut archive, "magnitude", &shape)?;
    let fresnel = read_array(&mut archive, "fresnel", &shape)?;
    let mut optional = |name: &str| {
        let present = archive.index_for_name(&format!("{name}.npy")).is_some();
        if present { read_array(&mut archive, name, &shape) } else { Ok(Vec::new()) }
    };
    let cells = CellStats {
        tv: optional("cell_tv")?,
        leak: optional("cell_leak")?,
        condition: optional("cell_condition")?,
    };
    Table::new(axes.to_vec(), m, magnitude, fresnel, cells)
}

fn check_nodes(axis: &Axis, nodes: &[f64]) -> Result<(), TableError> {
    let fits = nodes.iter().enumerate().all(|(i, node)| (node - axis.node(i)).abs() <= 1e-9);
    if fits {
        Ok(())
    } else {
        Err(TableError::Disagreement { what: format!("the nodes of axis {}", axis.quantity.name()) })
    }
}

fn read_array(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    name: &str,
    shape: &[u64],
) -> Result<Vec<f64>, TableError> {
    let entry =
        archive.by_name(&format!("{name}.npy")).map_err(|e| npz_error(format!("array {name}: {e}")))?;
    let mut bytes = Vec::new();
    entry.take(MAX_ARRAY_BYTES).read_to_end(&mut bytes).map_err(npz_error)?;
    let array = npyz::NpyFile::new(&bytes[..]).map_err(|e| npz_error(format!("array {name}: {e}")))?;
    if array.shape() != shape || array.order() != npyz::Order::C {
        let what = format!("the shape of {name}: {:?} in the archive, {shape:?} by the axes", array.shape());
        return Err(TableError::Disagreement { what });
    }
    let numbers = match array.dtype().descr().as_str() {
        "'<f8'" => array.into_vec::<f64>(),
        "'<f4'" => array.into_vec::<f32>().map(|v| v.into_iter().map(f64::from).collect()),
        "'<f2'" => array.into_vec::<f16>().map(|v| v.into_iter().map(f16::to_f64).collect()),
        other => return Err(npz_error(format!("array {name} has dtype {other}, not <f8, <f4 or <f2"))),
    };
    numbers.map_err(|e| npz_error(format!("array {name}: {e}")))
}

struct Archive {
    zip: ZipWriter<Cursor<Vec<u8>>>,
    precision: Precision,
}

impl Archive {
    fn new(precision: Precision) -> Self {
        Self { zip: ZipWriter::new(Cursor::new(Vec::new())), precision }
    }

    fn array(&mut self, name: &str, shape: &[u64], values: &[f64]) -> Result<(), TableError> {
        let bytes = match self.precision {
            Precision::F16 => npy(shape, values.iter().map(|v| f16::from_f64(*v))),
            Precision::F32 => npy(shape, values.iter().map(|v| *v as f32)),
            Precision::F64 => npy(shape, values.iter().copied()),
        };
        self.entry(name, &bytes.map_err(npz_error)?)
    }

    fn exact(&mut self, name: &str, shape: &[u64], values: &[f64]) -> Result<(), TableError> {
        self.entry(name, &npy(shape, values.iter().copied()).map_err(npz_error)?)
    }

    fn entry(&mut self, name: &str, bytes: &[u8]) -> Result<(), TableError> {
        // Stored, with a fixed date: the same arrays always give the same bytes, and so the same digest.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .unix_permissions(0o644);
        self.zip.start_file(format!("{name}.npy"), options).map_err(npz_error)?;
        self.zip.write_all(bytes).map_err(npz_error)
    }

    fn finish(self) -> Result<Vec<u8>, TableError> {
        Ok(self.zip.finish().map_err(npz_error)?.into_inner())
    }
}

fn npy<T: npyz::AutoSerialize>(shape: &[u64], values: impl Iterator<Item = T>) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(shape).writer(&mut bytes).begin_nd()?;
    writer.extend(values)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{anisotropic, isotropic};

    #[test]
    fn double_precision_comes_back_unchanged() {
        for table in [anisotropic(), isotropic()] {
            let bytes = write(&table, Precision::F64, Channels::ALL).unwrap();
            assert_eq!(read(&bytes, table.axes()).unwrap(), table);
            assert_eq!(bytes, write(&table, Precision::F64, Channels::ALL).unwrap());
        }
    }

    #[test]
    fn lower_precision_comes_back_rounded() {
        let table = anisotropic();
        for precision in [Precision::F16, Precision::F32] {
            let bytes = write(&table, precision, Channels::ALL).unwrap();
            assert_eq!(read(&bytes, table.axes()).unwrap(), table.rounded(precision).unwrap());
        }
    }

    #[test]
    fn damage_and_contradiction_are_errors() {
        let table = isotropic();
        let bytes = write(&table, Precision::F64, Channels::ALL).unwrap();
        assert!(matches!(read(&bytes[..bytes.len() / 2], table.axes()), Err(TableError::Npz { .. })));
        assert!(matches!(read(b"", table.axes()), Err(TableError::Npz { .. })));
        assert!(read(&bytes, anisotropic().axes()).is_err());
        let mut axes = table.axes().to_vec();
        axes[1].domain = [0.0, 0.5];
        assert!(matches!(read(&bytes, &axes), Err(TableError::Disagreement { .. })));
        let without = Channels { fresnel: false, ..Channels::ALL };
        assert!(matches!(
            read(&write(&table, Precision::F64, without).unwrap(), table.axes()),
            Err(TableError::Npz { .. })
        ));
    }
}
