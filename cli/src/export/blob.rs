//! `export --to blob`: the bytes that [`goniochrome::table::blob`] specifies. Colours are RGB. Tables of diffraction
//! orders keep their wavelengths, with the RGB of each.

use goniochrome::colour::{Quadrature, RgbSpace};
use goniochrome::table::blob::{Blob, BlobError, Contents, Precision};
use goniochrome::table::{FilmArrays, FilmTable, MirrorTable as Mirror, ScatterSampler};

use crate::colour::{visible, visible_weights};
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::Table;
use crate::table::finish::{FinishChoice, returned};
use crate::table::mirror::MirrorTable;

/// The bytes of the blob of a table, with the finish of a mirror-like one.
///
/// # Errors
/// Angles that are not uniform from 0, a table without colours, values that half precision cannot hold, a finish that
/// cannot be, or too little memory.
pub fn encode(table: &Table, finish: FinishChoice, precision: Precision) -> Result<Vec<u8>> {
    match table {
        Table::Mirror(mirror) => of_mirror(mirror, finish, precision),
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

/// The blob of a mirror-like table: of the kind `film` if it has more than a reflectance for each angle.
fn of_mirror(mirror: &MirrorTable, finish: FinishChoice, precision: Precision) -> Result<Vec<u8>> {
    let largest = largest_angle(mirror)?;
    let finish = finish.of(&mirror.metadata)?;
    let finish = finish.as_ref().map(OwnedFinish::finish);
    let (reflectance, space) = (mirror.colours()?.as_flattened(), mirror.metadata.named_space());
    if finish.is_none() && mirror.thickness.is_none() && !mirror.is_transparent() {
        let table = Mirror::new(reflectance, 3, largest).map_err(Error::failed)?;
        return write(space, Contents::Mirror(table), precision);
    }
    let thickness_nm: Vec<f32> = match &mirror.thickness {
        Some(axis) => axis.nm.iter().map(|nm| *nm as f32).collect(),
        None => vec![0.0],
    };
    let transmittance = mirror.rgb_transmitted.as_flattened();
    let arrays = FilmArrays { reflectance, transmittance, thickness_nm: &thickness_nm };
    let returned = finish.map_or(Vec::new(), |finish| returned(&finish, &mirror.theta_deg, reflectance, 3));
    let mut table = FilmTable::new(&arrays, 3, largest, finish).map_err(Error::failed)?;
    if !returned.is_empty() {
        table = table.with_returned(&returned).map_err(Error::failed)?;
    }
    write(space, Contents::Film(table), precision)
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
    use goniochrome::microfacet::{Distribution, Finish, Masking};
    use goniochrome::table::match_factor;

    use super::*;
    use crate::table::finish::keep;
    use crate::table::metadata::MetadataKey;
    use crate::table::mirror::ThicknessAxis;
    use crate::table::orders::tests::sample;

    #[test]
    fn orders_keep_their_spectra_and_their_light() {
        let mut table = sample();
        table.metadata.insert(MetadataKey::ColourSpace, "rec2020");
        table.metadata.insert(MetadataKey::Illuminant, "E");
        let bytes = encode(&table.clone().into(), FinishChoice::default(), Precision::Single).unwrap();
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
        assert!(
            encode(&table.into(), FinishChoice::default(), Precision::Single)
                .unwrap_err()
                .to_string()
                .contains("invisible")
        );
    }

    #[test]
    fn films_keep_their_thicknesses_their_transmittance_and_their_finish() {
        let rgb = |shift: f32| (0..6).map(|i| [0.1 * i as f32 + shift, 0.5, 0.25]).collect::<Vec<_>>();
        let mut table = MirrorTable {
            theta_deg: vec![0.0, 40.0, 80.0],
            rgb: rgb(0.0),
            rgb_transmitted: rgb(0.3),
            transmittance_s: vec![0.5; 6],
            thickness: Some(ThicknessAxis { layer: 1, nm: vec![100.0, 300.0] }),
            ..MirrorTable::default()
        };
        let own = Finish::new(Distribution::Beckmann, Masking::Separable, [0.1, 0.4]).unwrap();
        keep(&OwnedFinish::analytic(own), &mut table.metadata);
        let other = FinishChoice { roughness: Some([0.5, 0.5]), ..FinishChoice::default() };
        let mirror = FinishChoice { roughness: Some([0.0, 0.0]), ..FinishChoice::default() };
        for (choice, roughness) in
            [(FinishChoice::default(), Some([0.1, 0.4])), (other, Some([0.5; 2])), (mirror, None)]
        {
            let bytes = encode(&table.clone().into(), choice, Precision::Single).unwrap();
            let Contents::Film(film) = Blob::read(&bytes).unwrap().contents else { panic!("a film table") };
            assert_eq!(film.finish().and_then(|finish| finish.alpha()), roughness);
            assert!(film.finish().is_none_or(|finish| finish.masking() == Masking::Separable));
            assert_eq!((film.range_nm(), film.angles()), ([100.0, 300.0], 3));
            for (t, nm) in [100.0, 300.0].into_iter().enumerate() {
                assert_eq!(film.reflectance(1.0, nm), table.rgb[3 * t]);
                assert_eq!(film.transmittance(0.0, nm), table.rgb_transmitted[3 * t + 2]);
            }
        }
        let plain = MirrorTable { theta_deg: vec![0.0, 80.0], rgb: vec![[0.5; 3]; 2], ..MirrorTable::default() };
        let bytes = encode(&plain.into(), mirror, Precision::Single).unwrap();
        assert!(matches!(Blob::read(&bytes).unwrap().contents, Contents::Mirror(_)));
    }

    #[test]
    fn angles_that_a_blob_does_not_have_and_values_it_cannot_hold_are_refused() {
        let refusal = |theta_deg: &[f64], value: f32| {
            let rgb = vec![[value; 3]; theta_deg.len()];
            let table = MirrorTable { theta_deg: theta_deg.to_vec(), rgb, ..MirrorTable::default() };
            encode(&table.into(), FinishChoice::default(), Precision::Half)
                .map(|bytes| bytes.len())
                .map_err(|error| error.to_string())
        };
        assert_eq!(refusal(&[0.0, 1.0 / 3.0, 2.0 / 3.0], 0.5), Ok(64 + 20));
        for angles in [&[0.0][..], &[], &[0.0, 1.0, 3.0], &[1.0, 2.0]] {
            assert!(refusal(angles, 0.5).unwrap_err().contains("not uniform from 0"), "{angles:?}");
        }
        assert!(refusal(&[0.0, 1.0], 1e6).unwrap_err().contains("leave --half out"));
    }
}
