//! NPZ: NumPy arrays in an uncompressed zip archive, byte for byte reproducible.

use std::io::{Cursor, Read, Write};

use glam::DMat3;
use half::f16;
use ltc_core::Matrix;
use npyz::WriterBuilder;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter, write::SimpleFileOptions};

use crate::{Axis, CellStats, Channels, ClosedForm, Precision, Table, TableError};

/// Arrays larger than this are refused on reading: no table is.
const MAX_ARRAY_BYTES: u64 = 1 << 30;

fn npz_error(reason: impl ToString) -> TableError {
    TableError::Npz { reason: reason.to_string() }
}

/// Writes the table's arrays: `m` (axes, then 3×3 row-major), `magnitude`, `fresnel`, `axis_<quantity>`, and where the table
/// has them `closed_form` (one number, [`ClosedForm::code`]), `cell_tv`, `cell_leak`, `cell_condition`. The same table gives
/// the same bytes.
///
/// `magnitude` and `fresnel` are values at the entries also where there is a closed form: a reader that knows nothing of it and
/// interpolates them gets both channels less exactly.
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
    if let Some(form) = table.closed_form().filter(|_| channels.magnitude || channels.fresnel) {
        archive.exact("closed_form", &[], &[form.code()])?;
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
    let mut optional = |name: &str, shape: &[u64]| {
        let present = archive.index_for_name(&format!("{name}.npy")).is_some();
        if present { read_array(&mut archive, name, shape) } else { Ok(Vec::new()) }
    };
    let closed_form = optional("closed_form", &[])?.first().map(|code| ClosedForm::from_code(*code));
    let cells = CellStats {
        tv: optional("cell_tv", &shape)?,
        leak: optional("cell_leak", &shape)?,
        condition: optional("cell_condition", &shape)?,
    };
    Table::new(axes.to_vec(), m, magnitude, fresnel, cells)?.with_closed_form(closed_form.transpose()?)
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
    if array.order() != npyz::Order::C {
        return Err(npz_error(format!(
            "array {name} is in Fortran order; numpy.ascontiguousarray gives the order that is read"
        )));
    }
    if array.shape() != shape {
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
    fn the_closed_form_comes_back_at_all_precisions() {
        let plain = anisotropic();
        let table = plain.clone().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        for precision in Precision::ALL {
            let bytes = write(&table, precision, Channels::ALL).unwrap();
            let back = read(&bytes, table.axes()).unwrap();
            assert_eq!(back.closed_form(), Some(ClosedForm::GgxSmith));
            assert_eq!(back, table.rounded(precision).unwrap());
            let without = read(&write(&plain, precision, Channels::ALL).unwrap(), plain.axes()).unwrap();
            assert_eq!(without.closed_form(), None);
            assert_eq!((back.magnitude(), back.fresnel()), (without.magnitude(), without.fresnel()));
        }
        let holds = |channels| {
            let bytes = write(&table, Precision::F32, channels).unwrap();
            ZipArchive::new(Cursor::new(&bytes[..])).unwrap().index_for_name("closed_form.npy").is_some()
        };
        assert!(holds(Channels::FRESNEL) && holds(Channels::SHADING));
        assert!(!holds(Channels { magnitude: false, fresnel: false, ..Channels::ALL }));
    }

    #[test]
    fn an_unknown_closed_form_is_refused() {
        let rewritten = |table: &Table, code: &[f64]| {
            let bytes = write(table, Precision::F64, Channels::ALL).unwrap();
            let mut from = ZipArchive::new(Cursor::new(&bytes[..])).unwrap();
            let mut to = Archive::new(Precision::F64);
            for i in 0..from.len() {
                let mut entry = from.by_index(i).unwrap();
                let (name, mut bytes) =
                    (entry.name().unwrap().trim_end_matches(".npy").to_owned(), Vec::new());
                entry.read_to_end(&mut bytes).unwrap();
                to.entry(&name, &bytes).unwrap();
            }
            let shape: &[u64] = if code.len() == 1 { &[] } else { &[2] };
            to.exact("closed_form", shape, code).unwrap();
            read(&to.finish().unwrap(), table.axes())
        };
        assert_eq!(rewritten(&anisotropic(), &[1.0]).unwrap().closed_form(), Some(ClosedForm::GgxSmith));
        let error = rewritten(&anisotropic(), &[7.0]).unwrap_err();
        assert!(error.to_string().starts_with("closed_form: 7 is no form known here"), "{error}");
        assert!(matches!(rewritten(&isotropic(), &[1.0]), Err(TableError::NoClosedForm)));
        assert!(matches!(rewritten(&anisotropic(), &[1.0, 1.0]), Err(TableError::Disagreement { .. })));
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
