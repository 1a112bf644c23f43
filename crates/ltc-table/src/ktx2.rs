//! KTX2: the table as a texture file.
//!
//! Three RGBA groups hold the eleven channels: `m00 m01 m02 m10`, `m11 m12 m20 m21`, `m22 magnitude fresnel 0`. For a table with
//! a [`ClosedForm`] the third is `m22 remainder(magnitude) remainder(fresnel) code`: the fourth number,
//! [`ClosedForm::code`] (1), tells shaders to add the form's value at the query and to clamp both
//! sums to [0, 1]. It is the same in all entries, so that interpolation leaves it as it is.
//! - An isotropic table is a 2D array texture: x = α nodes, y = θ nodes, one layer a group.
//! - An anisotropic table is a 3D texture: x = λ nodes, y = α nodes, z = φ nodes + `len(φ)` · (θ node + `len(θ)` · group).
//!   Filter x, y and, within one θ, z by hardware; blend the two θ by hand.
//!
//! The manifest travels under the key `LtcTable`. Format: KTX 2.0 specification, Khronos Group.

use ltc_core::Matrix;

use crate::{ClosedForm, Kind, Precision, Table, TableError};

const IDENTIFIER: [u8; 12] = [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, b'\r', b'\n', 0x1A, b'\n'];
/// Identifier, header, index.
const HEADER_BYTES: usize = 80;
const LEVEL_INDEX_BYTES: usize = 24;
/// Groups of four channels.
pub const GROUPS: usize = 3;

/// The texels of a table: for each group, for each entry in table order, four numbers.
pub fn texels(table: &Table) -> Vec<[f64; 4]> {
    let mut groups: [Vec<[f64; 4]>; GROUPS] = Default::default();
    let code = table.closed_form().map_or(0.0, ClosedForm::code);
    for (i, m) in table.m().iter().enumerate() {
        let m = m.to_row_array();
        let [n, f] = table.remainders().map_or([table.magnitude()[i], table.fresnel()[i]], |r| r[i]);
        groups[0].push([m[0], m[1], m[2], m[3]]);
        groups[1].push([m[4], m[5], m[6], m[7]]);
        groups[2].push([m[8], n, f, code]);
    }
    groups.concat()
}

/// Writes the table with `manifest` (JSON) as a KTX2 file.
///
/// # Errors
/// [`TableError::PrecisionLoss`] or [`TableError::BadEntry`] where `precision` cannot hold the table, and for
/// [`Precision::F64`], which no GPU filters.
pub fn write(table: &Table, precision: Precision, manifest: &str) -> Result<Vec<u8>, TableError> {
    let vk_format: u32 = match precision {
        Precision::F16 => 97,  // VK_FORMAT_R16G16B16A16_SFLOAT
        Precision::F32 => 109, // VK_FORMAT_R32G32B32A32_SFLOAT
        Precision::F64 => {
            return Err(TableError::NoSuchPrecision { format: "KTX2", precision: precision.name() });
        }
    };
    // Whether it can be held. Remainders are rounded themselves, not the sums that they are left of.
    table.rounded(precision)?;
    let descriptor = data_format_descriptor(precision);
    let metadata = key_value_data(manifest);
    let descriptor_at = HEADER_BYTES + LEVEL_INDEX_BYTES;
    let metadata_at = descriptor_at + descriptor.len();
    let texel_bytes = 4 * precision.bytes();
    let level_at = (metadata_at + metadata.len()).next_multiple_of(texel_bytes);
    let texels = texels(table);
    let level_bytes = texels.len() * texel_bytes;

    let mut out = IDENTIFIER.to_vec();
    let [width, height, depth, layers] = extent(table);
    for word in [vk_format, precision.bytes() as u32, width, height, depth, layers, 1, 1, 0] {
        out.extend(word.to_le_bytes());
    }
    for word in [descriptor_at, descriptor.len(), metadata_at, metadata.len()] {
        out.extend((word as u32).to_le_bytes());
    }
    out.extend([0; 16]); // no supercompression global data
    for word in [level_at, level_bytes, level_bytes] {
        out.extend((word as u64).to_le_bytes());
    }
    out.extend(descriptor);
    out.extend(metadata);
    out.resize(level_at, 0);
    for number in texels.iter().flatten() {
        precision.put(*number, &mut out);
    }
    Ok(out)
}

/// Width, height, depth (0: not 3D), layers (0: no array).
fn extent(table: &Table) -> [u32; 4] {
    let shape = table.shape();
    let [width, height] = [shape[shape.len() - 1] as u32, shape[shape.len() - 2] as u32];
    match table.kind() {
        Kind::Isotropic => [width, height, 0, GROUPS as u32],
        Kind::Anisotropic => [width, height, (shape[0] * shape[1] * GROUPS) as u32, 0],
    }
}

/// A Khronos basic data format descriptor for four signed floats, linear.
fn data_format_descriptor(precision: Precision) -> Vec<u8> {
    const CHANNELS: [u8; 4] = [0, 1, 2, 15]; // R, G, B, A
    const FLOAT_SIGNED: u8 = 0xC0;
    let block_bytes: u32 = 24 + 16 * 4;
    let mut out = Vec::new();
    out.extend((block_bytes + 4).to_le_bytes());
    out.extend(0_u32.to_le_bytes()); // Khronos, basic format
    out.extend((2 | block_bytes << 16).to_le_bytes()); // version 1.3
    out.extend([1, 0, 1, 0]); // RGBSDA, primaries unspecified, linear, straight
    out.extend([0; 4]); // 1×1×1×1 texel blocks
    out.extend([4 * precision.bytes() as u8, 0, 0, 0, 0, 0, 0, 0]);
    let bits = 8 * precision.bytes() as u16;
    for (i, channel) in CHANNELS.into_iter().enumerate() {
        out.extend((i as u16 * bits).to_le_bytes());
        out.extend([(bits - 1) as u8, channel | FLOAT_SIGNED]);
        out.extend([0; 4]);
        out.extend((-1.0_f32).to_le_bytes());
        out.extend(1.0_f32.to_le_bytes());
    }
    out
}

/// Sorted by key, each entry padded to four bytes.
fn key_value_data(manifest: &str) -> Vec<u8> {
    let mut out = Vec::new();
    for (key, value) in [("KTXwriter", concat!("ltc ", env!("CARGO_PKG_VERSION"))), ("LtcTable", manifest)] {
        out.extend(((key.len() + value.len() + 2) as u32).to_le_bytes());
        for text in [key, value] {
            out.extend(text.as_bytes());
            out.push(0);
        }
        out.resize(out.len().next_multiple_of(4), 0);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{anisotropic, isotropic};

    #[test]
    fn another_crate_reads_what_we_wrote() {
        for (table, extent) in [(isotropic(), (5, 4, 0, 3)), (anisotropic(), (3, 4, 27, 0))] {
            let bytes = write(&table, Precision::F32, "{\"name\":\"test\"}").unwrap();
            let reader = ktx2::Reader::new(&bytes).unwrap();
            let header = reader.header();
            assert_eq!(header.format, Some(ktx2::Format::R32G32B32A32_SFLOAT));
            assert_eq!(
                (header.pixel_width, header.pixel_height, header.pixel_depth, header.layer_count),
                extent
            );
            let values: Vec<_> = reader.key_value_data().collect();
            assert_eq!(values[1], ("LtcTable", &b"{\"name\":\"test\"}\0"[..]));
            let level = reader.levels().next().unwrap();
            let numbers: Vec<f32> = level.data.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
            let expected: Vec<f32> = texels(&table).concat().into_iter().map(|v| v as f32).collect();
            assert_eq!(numbers, expected);
            let m = table.m()[7].to_row_array();
            assert_eq!(numbers[4 * 7 + 3], m[3] as f32, "group 0, entry 7, fourth channel is m10");
        }
    }

    #[test]
    fn a_closed_form_leaves_remainders_and_says_so() {
        let plain = anisotropic();
        let table = plain.clone().with_closed_form(Some(ClosedForm::GgxSmith)).unwrap();
        let (with, without) = (texels(&table), texels(&plain));
        let entries = plain.m().len();
        assert_eq!(with[..2 * entries], without[..2 * entries]);
        let g = ClosedForm::GgxSmith.at_entries(plain.axes()).unwrap();
        let mut differ = 0;
        for i in 0..entries {
            let ([m22, n, f, code], [m22_plain, n_plain, f_plain, none]) =
                (with[2 * entries + i], without[2 * entries + i]);
            assert_eq!((m22, code, none), (m22_plain, 1.0, 0.0));
            assert_eq!([n, f], [n_plain - g[i][0], f_plain - g[i][1]]);
            differ += usize::from(n != n_plain || f != f_plain);
        }
        assert!(differ > entries / 2, "the form changes too little to be seen");
        // Remainders are rounded once.
        let bytes = write(&table, Precision::F16, "{}").unwrap();
        let level = ktx2::Reader::new(&bytes).unwrap().levels().next().unwrap().data.to_vec();
        let halves: Vec<f64> = level.as_chunks::<2>().0.iter().map(|b| Precision::F16.get(b)).collect();
        let rounded: Vec<f64> = with.concat().into_iter().map(|v| Precision::F16.round(v)).collect();
        assert_eq!(halves, rounded);
    }

    #[test]
    fn doubles_are_refused() {
        assert!(write(&isotropic(), Precision::F64, "{}").is_err());
    }
}
