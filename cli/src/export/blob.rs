//! `export --to blob`: the bytes that [`goniochrome::table::blob`] specifies, RGB.

use goniochrome::colour::RgbSpace;
use goniochrome::table::blob::{Blob, BlobError, Contents, Precision};
use goniochrome::table::{MirrorTable as Mirror, ScatterSampler, ScatterTable as Scatter};

use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::Table;
use crate::table::mirror::MirrorTable;

/// The bytes of the blob of a table.
///
/// # Errors
/// Angles that are not uniform from 0, a table without colours, values that half precision cannot hold, or too little
/// memory.
pub fn encode(table: &Table, precision: Precision) -> Result<Vec<u8>> {
    match table {
        Table::Mirror(mirror) => {
            let largest = largest_angle(mirror)?;
            let table = Mirror::new(mirror.colours()?.as_flattened(), 3, largest).map_err(Error::failed)?;
            write(mirror.metadata.named_space(), Contents::Mirror(table), precision)
        }
        Table::Scatter(scatter) => {
            let table = Scatter::new(scatter.rgb.as_flattened(), scatter.layout, 3).map_err(Error::failed)?;
            let mut memory = filled(0.0, ScatterSampler::required_len(&scatter.layout), "the blob")?;
            let sampler = ScatterSampler::new(&table, &mut memory).map_err(Error::failed)?;
            write(scatter.metadata.named_space(), Contents::Scatter(table, sampler), precision)
        }
        Table::Orders(_) => Err(Error::failed("tables of diffraction orders have no blob yet")),
    }
}

fn write(space: Option<RgbSpace>, contents: Contents<'_>, precision: Precision) -> Result<Vec<u8>> {
    let blob = Blob { space, contents };
    let length = blob.required_len(precision).ok_or_else(|| Error::failed(BlobError::Dimensions))?;
    let mut bytes = filled(0, length, "the blob")?;
    match blob.write(precision, &mut bytes) {
        Err(BlobError::Range { index }) => {
            Err(Error::failed(format_args!("value {index} is beyond half precision, 65504; leave --half out")))
        }
        result => result.map(|()| bytes).map_err(Error::failed),
    }
}

/// The last angle, in radians, of a table whose angles are uniform from 0, as those of blobs are.
fn largest_angle(table: &MirrorTable) -> Result<f64> {
    /// Deviation in degrees that is rounding: far below what a colour could show.
    const ROUNDING: f64 = 1e-6;
    let angles = &table.theta_deg;
    let last = angles.last().copied().unwrap_or_default();
    let step = last / (angles.len() as f64 - 1.0);
    let uniform = |(i, angle): (usize, &f64)| (angle - step * i as f64).abs() < ROUNDING;
    if angles.len() < 2 || !angles.iter().enumerate().all(uniform) {
        return Err(Error::failed(
            "its angles are not uniform from 0, at least two; `goniochrome estimate --angles 90` writes such a table",
        ));
    }
    Ok(last.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_a_blob_does_not_have_and_values_it_cannot_hold_are_refused() {
        let refusal = |theta_deg: &[f64], value: f32| {
            let rgb = vec![[value; 3]; theta_deg.len()];
            let table = MirrorTable { theta_deg: theta_deg.to_vec(), rgb, ..MirrorTable::default() };
            encode(&table.into(), Precision::Half).map(|bytes| bytes.len()).map_err(|error| error.to_string())
        };
        assert_eq!(refusal(&[0.0, 1.0 / 3.0, 2.0 / 3.0], 0.5), Ok(64 + 20));
        for angles in [&[0.0][..], &[], &[0.0, 1.0, 3.0], &[1.0, 2.0]] {
            assert!(refusal(angles, 0.5).unwrap_err().contains("not uniform from 0"), "{angles:?}");
        }
        assert!(refusal(&[0.0, 1.0], 1e6).unwrap_err().contains("leave --half out"));
    }
}
