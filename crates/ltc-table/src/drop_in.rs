//! The two textures that engines already ship for isotropic GGX, and the files that hold them.
//!
//! - `ltc_1`: `M⁻¹` divided by its middle entry, as `(00, 20, 02, 22)`; the other entries are 0, the middle one 1.
//! - `ltc_2`: magnitude, Fresnel term, 0, and the form factor of a sphere cut at the horizon ([`clipped_sphere`]).
//!
//! Texel (i, j) of N × N is the node `√α = i/(N − 1)`, `√(1 − cos θ) = j/(N − 1)`; for the form factor it is `cos ω = 2i/(N − 1) − 1`,
//! `sin²σ = j/(N − 1)`. Engines read both at `u (N − 1)/N + ½/N`, bilinearly: what is interpolated is this layout, not `M`.

use glam::DMat3;
use ltc_core::{Ltc, Matrix};

use crate::{
    Axis, Kind, Lobe, Lookup, Mapping, Precision, Quantity, Query, Table, TableError,
    form_factor::clipped_sphere,
    lookup::{Corner, corners},
};

/// Both textures, in `f64`.
#[derive(Clone, Debug, PartialEq)]
pub struct DropIn {
    axes: [Axis; 2],
    /// `ltc_1`, row by row.
    matrices: Vec<[f64; 4]>,
    /// `ltc_2`, row by row.
    albedos: Vec<[f64; 4]>,
}

/// Bytes of a DDS file before its texels.
const DDS_HEADER: usize = 128;

/// A language for [`DropIn::text`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// `static const float LTC_1[…]`
    C,
    /// `export const LTC_1 = [ … ]`
    JavaScript,
}

/// What the layout holds of `M`: `M⁻¹ / (M⁻¹)₁₁`, if its other entries are 0.
pub fn stored(m: DMat3) -> Option<[f64; 4]> {
    let inverse = m.inverse();
    let rows = (inverse * (1.0 / inverse.y_axis.y)).to_row_array();
    let others = [rows[1], rows[3], rows[5], rows[7]];
    let usable = rows.iter().all(|x| x.is_finite()) && others.iter().all(|x| x.abs() <= 1e-12);
    usable.then_some([rows[0], rows[6], rows[2], rows[8]])
}

/// `M⁻¹` of a texel.
pub fn inverse([m00, m20, m02, m22]: [f64; 4]) -> DMat3 {
    DMat3::from_row_array([m00, 0.0, m02, 0.0, 1.0, 0.0, m20, 0.0, m22])
}

impl DropIn {
    /// The textures of an isotropic table with as many θ as α nodes, spaced as the layout has them.
    ///
    /// # Errors
    /// [`TableError::NotDropIn`] for any other table.
    pub fn of(table: &Table) -> Result<Self, TableError> {
        let no = |reason: &str| Err(TableError::NotDropIn { reason: reason.to_owned() });
        if table.kind() != Kind::Isotropic {
            return no("it is not isotropic");
        }
        let n = table.shape()[0];
        let axes = axes(n);
        if table.axes() != axes {
            return no("its axes are not √(1 − cos θ) and √α over the whole domain, with as many nodes each");
        }
        let mut matrices = Vec::with_capacity(n * n);
        for (index, m) in table.m().iter().enumerate() {
            let Some(texel) = stored(*m) else {
                return no(&format!("entry {index} has entries off the x-z plane of symmetry"));
            };
            matrices.push(texel);
        }
        let node = |i: usize| i as f64 / (n - 1) as f64;
        let albedos = (0..n * n)
            .map(|i| {
                let sphere = clipped_sphere(2.0 * node(i % n) - 1.0, node(i / n));
                [table.magnitude()[i], table.fresnel()[i], 0.0, sphere]
            })
            .collect();
        Ok(Self { axes, matrices, albedos })
    }

    /// Texels along each side.
    pub fn size(&self) -> usize {
        self.axes[0].len
    }

    /// `ltc_1`, row by row.
    pub fn matrices(&self) -> &[[f64; 4]] {
        &self.matrices
    }

    /// `ltc_2`, row by row.
    pub fn albedos(&self) -> &[[f64; 4]] {
        &self.albedos
    }

    /// What an engine gets for a query: both textures bilinearly at its coordinates, then `M` as the inverse of `ltc_1`.
    ///
    /// # Errors
    /// [`TableError::Input`] for an invalid query, [`TableError::NotIsotropic`] for α_x ≠ α_y, [`TableError::NotDropIn`] where
    /// rounded texels interpolate to a singular matrix.
    pub fn lookup(&self, query: &Query) -> Result<Lookup, TableError> {
        let folded = query.fold()?;
        if folded.lambda != 1.0 {
            let (alpha_x, alpha_y) = (query.alpha_x, query.alpha_y);
            return Err(TableError::NotIsotropic { alpha_x, alpha_y });
        }
        let (mut matrix, mut albedo) = ([0.0; 4], [0.0; 4]);
        for Corner { index, weight } in corners(&self.axes, [folded.theta, folded.alpha]) {
            for k in 0..4 {
                matrix[k] += weight * self.matrices[index][k];
                albedo[k] += weight * self.albedos[index][k];
            }
        }
        let m = inverse(matrix).inverse();
        if Ltc::<f64>::new(m).is_err() {
            let reason =
                format!("θ = {}, α = {} interpolates to a singular matrix", folded.theta, folded.alpha);
            return Err(TableError::NotDropIn { reason });
        }
        let turn = DMat3::from_rotation_z(query.phi);
        let m = (turn * m * turn.transpose()).to_row_array();
        Ok(Lookup { lobes: vec![Lobe { weight: 1.0, m }], magnitude: albedo[0], fresnel: albedo[1] })
    }

    /// The textures with every number rounded to `precision`.
    ///
    /// # Errors
    /// [`TableError::PrecisionLoss`] for a number that overflows, [`TableError::BadEntry`] for a matrix that rounding turns
    /// singular.
    pub fn rounded(&self, precision: Precision) -> Result<Self, TableError> {
        let round = |array: &'static str, texels: &[[f64; 4]]| -> Result<Vec<[f64; 4]>, TableError> {
            let mut rounded = texels.to_vec();
            for (index, value) in
                rounded.iter_mut().enumerate().flat_map(|(i, t)| t.iter_mut().map(move |v| (i, v)))
            {
                let before = *value;
                *value = precision.round(before);
                if !value.is_finite() {
                    let precision = precision.name();
                    return Err(TableError::PrecisionLoss { array, index, value: before, precision });
                }
            }
            Ok(rounded)
        };
        let matrices = round("ltc_1", &self.matrices)?;
        for (index, texel) in matrices.iter().enumerate() {
            let determinant = inverse(*texel).determinant();
            if determinant <= 0.0 {
                let reason = format!("rounded to {}, det is {determinant}", precision.name());
                return Err(TableError::BadEntry { array: "ltc_1", index, reason });
            }
        }
        Ok(Self { axes: self.axes.clone(), matrices, albedos: round("ltc_2", &self.albedos)? })
    }

    /// `ltc_1.dds` and `ltc_2.dds`: one RGBA surface each, without mipmaps, in the header that predates DX10 and that every
    /// reader knows.
    ///
    /// # Errors
    /// As [`DropIn::rounded`], and for [`Precision::F64`].
    pub fn dds(&self, precision: Precision) -> Result<[Vec<u8>; 2], TableError> {
        let rounded = self.rounded(precision)?;
        let header = dds_header(self.size() as u32, precision)?;
        Ok([&rounded.matrices, &rounded.albedos].map(|texels| {
            let mut file = header.clone();
            for value in texels.iter().flatten() {
                precision.put(*value, &mut file);
            }
            file
        }))
    }

    /// Reads what [`DropIn::dds`] wrote, or an engine's own files.
    ///
    /// # Errors
    /// [`TableError::Dds`] for files of another kind.
    pub fn read_dds(ltc_1: &[u8], ltc_2: &[u8]) -> Result<Self, TableError> {
        let (size, matrices) = read_surface(ltc_1)?;
        let (other, albedos) = read_surface(ltc_2)?;
        if size != other {
            return Err(dds("the two textures differ in size"));
        }
        Ok(Self { axes: axes(size), matrices, albedos })
    }

    /// Both textures as source text, in single precision: arrays `LTC_1` and `LTC_2`, four numbers a texel.
    ///
    /// # Errors
    /// As [`DropIn::rounded`].
    pub fn text(&self, language: Language) -> Result<String, TableError> {
        use core::fmt::Write;
        let rounded = self.rounded(Precision::F32)?;
        let n = self.size();
        let mut out =
            format!("// {n} x {n} texels of four numbers. Row: sqrt(1 - cos theta); column: sqrt(alpha).\n");
        for (name, texels) in [("LTC_1", &rounded.matrices), ("LTC_2", &rounded.albedos)] {
            let (open, close) = match language {
                Language::C => (format!("static const float {name}[{}] = {{\n", 4 * n * n), "};\n"),
                Language::JavaScript => (format!("export const {name} = [\n"), "];\n"),
            };
            out.push_str(&open);
            let suffix = if language == Language::C { "f" } else { "" };
            for texel in texels {
                for value in texel {
                    // The shortest digits that read back as the same single; `{:?}` keeps the point that C asks for.
                    let _ = write!(out, "{:?}{suffix}, ", *value as f32);
                }
                out.truncate(out.trim_end().len());
                out.push('\n');
            }
            out.push_str(close);
        }
        Ok(out)
    }
}

/// The axes of the layout.
pub fn axes(size: usize) -> [Axis; 2] {
    [
        Axis::full(Quantity::Theta, Mapping::SqrtOneMinusCos, size),
        Axis::full(Quantity::Alpha, Mapping::Sqrt, size),
    ]
}

/// `DDS_HEADER`: magic, 124 bytes of header, in it 32 of pixel format. FourCC 113 is RGBA of half floats, 116 of floats.
fn dds_header(size: u32, precision: Precision) -> Result<Vec<u8>, TableError> {
    let four_cc: u32 = match precision {
        Precision::F16 => 113,
        Precision::F32 => 116,
        Precision::F64 => {
            return Err(TableError::NoSuchPrecision { format: "DDS", precision: precision.name() });
        }
    };
    const FLAGS: u32 = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000; // caps, height, width, pitch, pixel format
    const FOUR_CC: u32 = 0x4;
    const TEXTURE: u32 = 0x1000;
    let pitch = size * 4 * precision.bytes() as u32;
    let mut words = vec![124, FLAGS, size, size, pitch, 0, 0];
    words.extend([0; 11]);
    words.extend([32, FOUR_CC, four_cc, 0, 0, 0, 0, 0]);
    words.extend([TEXTURE, 0, 0, 0, 0]);
    let mut out = b"DDS ".to_vec();
    out.extend(words.iter().flat_map(|w| w.to_le_bytes()));
    Ok(out)
}

fn dds(reason: &str) -> TableError {
    TableError::Dds { reason: reason.to_owned() }
}

fn read_surface(file: &[u8]) -> Result<(usize, Vec<[f64; 4]>), TableError> {
    let word = |at: usize| {
        let bytes = file.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
        bytes.map(u32::from_le_bytes).ok_or_else(|| dds("shorter than its header"))
    };
    if !file.starts_with(b"DDS ") || word(4)? != 124 {
        return Err(dds("not a DDS file"));
    }
    let (height, width, four_cc) = (word(12)?, word(16)?, word(84)?);
    if height != width || !(2..=4096).contains(&width) {
        return Err(dds(&format!("{width} × {height} texels, must be square, 2 to 4096 a side")));
    }
    let precision = match four_cc {
        113 => Precision::F16,
        116 => Precision::F32,
        _ => return Err(dds("must hold four half or single floats a texel")),
    };
    let numbers = 4 * (width * height) as usize;
    let texels = file.get(DDS_HEADER..).unwrap_or_default();
    if texels.len() < numbers * precision.bytes() {
        return Err(dds("shorter than its texels"));
    }
    let values: Vec<f64> =
        texels.chunks_exact(precision.bytes()).take(numbers).map(|b| precision.get(b)).collect();
    if let Some(i) = values.iter().position(|v| !v.is_finite()) {
        return Err(dds(&format!("texel {}: {}", i / 4, values[i])));
    }
    let (texels, _) = values.as_chunks::<4>();
    Ok((width as usize, texels.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CellStats, testing};

    /// Lobes that lean away from the view, wider with α.
    fn table(size: usize) -> Table {
        let axes = axes(size).to_vec();
        let mut m = Vec::new();
        for theta in axes[0].nodes() {
            for alpha in axes[1].nodes() {
                let (sin, cos) = (0.98 * theta).sin_cos();
                let w = alpha.max(1e-3);
                m.push(
                    DMat3::from_row_array([cos, 0.0, -sin, 0.0, 1.0, 0.0, sin, 0.0, cos])
                        * DMat3::from_diagonal(glam::DVec3::new(w, 0.9 * w, 1.0)),
                );
            }
        }
        let channel = |scale: f64| (0..m.len()).map(|i| scale / (1.0 + i as f64)).collect();
        Table::new(axes, m.clone(), channel(1.0), channel(0.1), CellStats::default()).unwrap()
    }

    #[test]
    fn an_engine_reads_back_what_was_written() {
        let table = table(64);
        let drop_in = DropIn::of(&table).unwrap();
        for (precision, bytes, close) in [(Precision::F16, 32_896, 2e-3), (Precision::F32, 65_664, 1e-6)] {
            let [one, two] = drop_in.dds(precision).unwrap();
            assert_eq!((one.len(), two.len()), (bytes, bytes), "the size of the files that engines ship");
            let back = DropIn::read_dds(&one, &two).unwrap();
            for index in [0, 70, 4095] {
                let (texel, m) = (back.matrices()[index], table.m()[index].inverse());
                let middle = m.y_axis.y;
                for (value, expected) in texel.iter().zip([m.x_axis.x, m.x_axis.z, m.z_axis.x, m.z_axis.z]) {
                    assert!((value - expected / middle).abs() <= close, "{index}: {texel:?}");
                }
                assert!((back.albedos()[index][0] - table.magnitude()[index]).abs() <= close);
            }
            // At a node the lookup is the entry's lobe: the same matrix but for scale.
            let (theta, alpha) = (table.axes()[0].node(40), table.axes()[1].node(30));
            let query = Query { theta, phi: 0.0, alpha_x: alpha, alpha_y: alpha };
            let m = DMat3::from_row_array(back.lookup(&query).unwrap().lobes[0].m);
            let expected = table.m()[40 * 64 + 30];
            assert!((m * (1.0 / m.y_axis.y)).abs_diff_eq(expected * (1.0 / expected.y_axis.y), 10.0 * close));
        }
    }

    #[test]
    fn engines_interpolate_the_inverse() {
        let drop_in = DropIn::of(&table(8)).unwrap();
        let axes = axes(8);
        let value =
            |axis: &Axis, u: f64| axis.mapping.value(u / 7.0 * axis.mapping.coordinate(axis.domain[1]));
        let (theta, alpha) = (value(&axes[0], 3.0), value(&axes[1], 4.5));
        let query = Query { theta, phi: 0.0, alpha_x: alpha, alpha_y: alpha };
        let m = DMat3::from_row_array(drop_in.lookup(&query).unwrap().lobes[0].m).inverse();
        let (low, high) = (drop_in.matrices()[3 * 8 + 4], drop_in.matrices()[3 * 8 + 5]);
        assert!((m.z_axis.z / m.y_axis.y - 0.5 * (low[3] + high[3])).abs() < 1e-12);
    }

    #[test]
    fn text_holds_the_same_numbers() {
        let drop_in = DropIn::of(&table(4)).unwrap();
        for language in [Language::C, Language::JavaScript] {
            let text = drop_in.text(language).unwrap();
            let body = text.split(['{', '[']).next_back().unwrap();
            let numbers: Vec<f32> = body
                .split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)))
                .filter_map(|word| word.parse().ok())
                .collect();
            let expected: Vec<f32> = drop_in.albedos().iter().flatten().map(|v| *v as f32).collect();
            assert_eq!(numbers, expected);
        }
    }

    #[test]
    fn what_is_no_drop_in_is_refused() {
        assert!(matches!(DropIn::of(&testing::anisotropic()), Err(TableError::NotDropIn { .. })));
        assert!(matches!(DropIn::of(&testing::isotropic()), Err(TableError::NotDropIn { .. })));
        let drop_in = DropIn::of(&table(8)).unwrap();
        assert!(drop_in.dds(Precision::F64).is_err());
        let [one, two] = drop_in.dds(Precision::F16).unwrap();
        assert!(DropIn::read_dds(&one[..100], &two).is_err());
        assert!(DropIn::read_dds(&one[..one.len() - 1], &two).is_err());
        assert!(DropIn::read_dds(b"PNG", &two).is_err());
        let other = DropIn::of(&table(4)).unwrap().dds(Precision::F16).unwrap();
        assert!(DropIn::read_dds(&one, &other[1]).is_err());
        let mut broken = one.clone();
        broken[DDS_HEADER..DDS_HEADER + 2].copy_from_slice(&[0x00, 0x7e]);
        assert!(DropIn::read_dds(&broken, &two).is_err(), "a NaN");
    }
}
