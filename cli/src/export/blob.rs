//! `export --to blob`: the bytes that [`goniochrome::table::blob`] specifies. Colours are RGB. Tables of diffraction
//! orders keep their wavelengths, with the RGB of each.

use goniochrome::colour::{Quadrature, RgbSpace};
use goniochrome::table::blob::{Blob, BlobError, Contents, Precision};
use goniochrome::table::{MirrorTable as Mirror, ScatterSampler};

use crate::colour::{visible, visible_weights};
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
            let prepared = scatter.rgb_lookup()?;
            let table = prepared.table()?;
            let mut memory = filled(0.0, ScatterSampler::required_len(&scatter.layout), "the blob")?;
            let sampler = ScatterSampler::new(&table, &mut memory).map_err(Error::failed)?;
            write(scatter.metadata.named_space(), Contents::Scatter(table, sampler), precision)
        }
        Table::Orders(orders) => {
            let nm = &orders.wavelength_nm;
            if !visible(nm) {
                return Err(Error::failed("the table has no colour, as its wavelengths are invisible"));
            }
            let weights = visible_weights(nm, orders.metadata.illuminant(), Quadrature::Interpolated)?;
            let space = orders.metadata.space();
            let arrays = orders.arrays(weights.into_iter().map(|xyz| space.from_xyz(xyz)));
            write(Some(space), Contents::Orders(arrays.table()?), precision)
        }
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
    use goniochrome::colour::Illuminant;
    use goniochrome::table::match_factor;

    use super::*;
    use crate::table::metadata::MetadataKey;
    use crate::table::orders::tests::sample;

    #[test]
    fn orders_keep_their_spectra_and_their_light() {
        let mut table = sample();
        table.metadata.insert(MetadataKey::ColourSpace, "rec2020");
        table.metadata.insert(MetadataKey::Illuminant, "E");
        let bytes = encode(&table.clone().into(), Precision::Single).unwrap();
        let blob = Blob::read(&bytes).unwrap();
        assert_eq!(blob.space, Some(RgbSpace::Rec2020));
        let Contents::Orders(read) = blob.contents else { panic!("a table of orders") };
        assert_eq!((read.layout(), read.order_count(), read.wavelength_count()), (table.layout, 3, 2));
        let xyz = visible_weights(&table.wavelength_nm, Illuminant::E, Quadrature::Interpolated).unwrap();
        for (w, xyz) in xyz.into_iter().enumerate() {
            assert_eq!(read.wavelength_nm(w), table.wavelength_nm[w] as f32);
            assert_eq!(read.rgb_weight(w), RgbSpace::Rec2020.from_xyz(xyz).map(|c| c as f32));
            // The node at the normal.
            let strengths = &table.unpolarised()[table.first(w, 1)..][..3];
            let view = read.view(glam::Vec3::Z).unwrap();
            for (order, strength) in strengths.iter().enumerate() {
                let light = view.light(w, order).unwrap();
                let factor = match_factor(1.0, light.direction.z);
                // Rounding of the angles to single precision, times the differences of neighbouring nodes.
                assert!((light.efficiency - strength * factor).abs() < 1e-6, "{light:?} for {strength}");
            }
        }
        table.wavelength_nm = vec![1200.0, 1300.0];
        assert!(encode(&table.into(), Precision::Single).unwrap_err().to_string().contains("invisible"));
    }

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
