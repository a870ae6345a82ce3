//! Files of scattering tables: an atlas, one tile per incident direction.
//!
//! The table holds s = f cos θ_i cos θ_o in 1/sr on T × P incident directions and U × V half vectors, and the fraction
//! ρ of the light that each of L lobes of flat facets reflects. The tile of θ_i row t and φ_i column p is U pixels wide
//! and V + ⌈L/U⌉ high, and begins at pixel x = p·U, y = t·(V + ⌈L/U⌉). In its first V lines x counts the half vectors
//! from the normal outwards and y their azimuths; the other lines hold ρ of the lobes, one after the other, and zeros
//! after the last.
//!
//! A half vector is m = (wi + wo)/|wi + wo|. Its angles at the nodes are in the header. Between nodes s is linear in x
//! and in y of the warped square, and between incident directions in θ_i and φ_i ([`ScatterLayout`] and
//! [`HalfVectorWarp`] define both). f = s/(cos θ_i cos θ_o); beyond the last θ_i,
//! s/cos θ_i is held. With P = 1 the table is a mean over azimuths, and φ_m counts from φ_i.
//!
//! | channel | holds |
//! |---|---|
//! | `R`, `G`, `B` | linear RGB of s or ρ; components may be negative |
//! | `T.550,000000nm` | s or ρ at a wavelength, unpolarised |
//! | `error.Y` | standard error of the luminance of s or ρ |
//!
//! | attribute `goniochrome.` | holds |
//! |---|---|
//! | `kind` | `scatter` |
//! | `incident` | T and P |
//! | `half_vectors` | U and V |
//! | `warp_u`, `warp_v` | densities of the warp over u = √(2θ_m/π) and v = (φ_m + π)/2π, at equally spaced knots from 0 to 1 |
//! | `lobes` | ten numbers for each lobe: the index n and the columns of the matrix M of [`FacetLobe`] |
//! | `incident_theta_deg` | the T angles θ_i, in the order of the rows of tiles |
//! | `incident_phi_deg` | the P azimuths φ_i, in the order of the columns of tiles |
//! | `half_theta_deg` | the U angles θ_m of half vectors |
//! | `half_phi_deg` | the V azimuths φ_m of half vectors |
//! | `wavelength_nm` | the wavelengths at full precision |
//! | `reflected`, `transmitted`, `absorbed`, `truncated` | fractions of the incident light, weighted by luminance |
//! | `reflected_error` | standard error of `reflected` |
//! | `imbalance`, `imbalance_error` | what is missing from 1, and its standard error |
//! | `without_interference` | fraction of starting rays that were traced without interference |
//! | `rays` | number of starting rays |
//!
//! The last five rows hold one number for each incident direction, row by row. Numbers in attributes are decimal,
//! separated by spaces. Blocks of 16 lines are ZIP-compressed. `tests/python/read_table.py` reads all of it in a few
//! lines of NumPy. The four lists of angles follow from the other attributes. Versions before 0.2 wrote fixed bins of
//! outgoing directions instead (attribute `bins`); such files are refused.

use exr::prelude::Compression;
use goniochrome::table::{FacetLobe, HalfVectorWarp, ScatterLayout};

use super::container::{Contents, KIND, Opened, PREFIX, WAVELENGTH, channel_names, format_numbers};
use super::lazy_channel::LazyChannel;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::metadata::Metadata;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size, warp_pairs};
use crate::table::statistics::MeanWithError;

/// Value of the attribute `kind`.
pub(super) const SCATTER: &str = "scatter";
const INCIDENT: &str = "incident";
const HALF_VECTORS: &str = "half_vectors";
const WARP: [&str; 2] = ["warp_u", "warp_v"];
const LOBES: &str = "lobes";
/// Attribute of files of earlier versions.
const BINS: &str = "bins";
const RAYS: &str = "rays";
const AXES: [&str; 4] = ["incident_theta_deg", "incident_phi_deg", "half_theta_deg", "half_phi_deg"];
const ERROR: &str = "error.Y";
const ENERGIES: [&str; 8] = [
    "reflected",
    "reflected_error",
    "transmitted",
    "absorbed",
    "truncated",
    "imbalance",
    "imbalance_error",
    "without_interference",
];

/// Width and height of the tile of an incident direction.
fn tile(layout: &ScatterLayout) -> [usize; 2] {
    let [u, v] = layout.square_sides().map(|side| side as usize);
    [u, v + layout.lobes().div_ceil(u)]
}

/// Width and height of the atlas.
fn atlas(layout: &ScatterLayout) -> (usize, usize) {
    let ([width, height], [rows, columns]) = (tile(layout), layout.incident_sides());
    (columns as usize * width, rows as usize * height)
}

/// Pixel of every value, incident by incident, place by place.
fn pixels(layout: &ScatterLayout) -> impl Iterator<Item = usize> {
    let ([width, height], columns) = (tile(layout), layout.incident_sides()[1] as usize);
    let (line, places) = (columns * width, layout.places());
    (0..layout.count()).map(move |value| {
        let (incident, place) = (value / places, value % places);
        let x = (incident % columns) * width + place % width;
        let y = (incident / columns) * height + place / width;
        y * line + x
    })
}

/// Value of a pixel: the inverse of [`pixels`]; `None` beyond the last lobe.
fn value_of(layout: &ScatterLayout, pixel: usize) -> Option<usize> {
    let ([width, height], columns) = (tile(layout), layout.incident_sides()[1] as usize);
    let (x, y) = (pixel % (columns * width), pixel / (columns * width));
    let incident = (y / height) * columns + x / width;
    let place = (y % height) * width + x % width;
    (place < layout.places()).then(|| incident * layout.places() + place)
}

/// Directions of incidence and half vectors in degrees, as [`AXES`] names them.
fn axes(layout: &ScatterLayout, warp: &HalfVectorWarp<'_>) -> [(&'static str, String); 4] {
    let ([rows, columns], [u, v]) = (layout.incident_sides(), layout.square_sides());
    let degrees = |x: f64| (x.to_degrees() * 1e9).round() / 1e9;
    let theta_m = |j: u32| {
        let plain = f64::from(warp.plain(0, layout.node(j as usize)[0] as f32));
        degrees(plain * plain * std::f64::consts::FRAC_PI_2)
    };
    let phi_m = |k: u32| {
        let plain = f64::from(warp.plain(1, layout.node((k * u) as usize)[1] as f32));
        degrees((2.0 * plain - 1.0) * std::f64::consts::PI)
    };
    let lists = [
        format_numbers((0..rows).map(|t| degrees(layout.incident((t * columns) as usize)[0]))),
        format_numbers((0..columns).map(|p| degrees(layout.incident(p as usize)[1]))),
        format_numbers((0..u).map(theta_m)),
        format_numbers((0..v).map(phi_m)),
    ];
    std::array::from_fn(|i| (AXES[i], lists[i].clone()))
}

/// Encodes a table as an EXR file.
///
/// # Errors
/// A table that [`ScatterTable::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too
/// close for names of channels.
pub fn encode(table: &ScatterTable, threads: usize) -> Result<Vec<u8>> {
    table.check()?;
    let layout = &table.layout;
    let names = channel_names(&table.wavelength_nm)?;
    let places = layout.places();
    // A table may fill much of memory: its channels are read where they lie.
    let of_value = |at: fn(&ScatterTable, usize) -> f32| {
        LazyChannel::new(move |pixel| value_of(layout, pixel).map_or(0.0, |value| at(table, value)))
    };
    let mut channels = vec![
        (ERROR.to_owned(), of_value(|table, value| table.luminance_error[value])),
        ("R".to_owned(), of_value(|table, value| table.rgb[value][0])),
        ("G".to_owned(), of_value(|table, value| table.rgb[value][1])),
        ("B".to_owned(), of_value(|table, value| table.rgb[value][2])),
    ];
    for (w, name) in names.into_iter().enumerate() {
        let at = move |pixel| value_of(layout, pixel).map_or(0.0, |value| table.row(value / places, w)[value % places]);
        channels.push((name, LazyChannel::new(at)));
    }

    let energies = |of: &dyn Fn(&Energy) -> f64| format_numbers(table.energy.iter().map(of));
    let [reflected, error, transmitted, absorbed, truncated, imbalance, imbalance_error, without_interference] =
        ENERGIES;
    let ([rows, columns], [u, v]) = (layout.incident_sides(), layout.square_sides());
    let [pairs_u, pairs_v] = warp_pairs(&table.warp)?;
    let warp = HalfVectorWarp::from_pairs(&pairs_u, &pairs_v).map_err(Error::failed)?;
    let attributes = [
        (KIND, SCATTER.to_owned()),
        (INCIDENT, format!("{rows} {columns}")),
        (HALF_VECTORS, format!("{u} {v}")),
        (WARP[0], format_numbers(&table.warp[0])),
        (WARP[1], format_numbers(&table.warp[1])),
        (LOBES, format_numbers(table.lobes.iter().flat_map(FacetLobe::to_numbers))),
        (WAVELENGTH, format_numbers(&table.wavelength_nm)),
        (reflected, energies(&|energy| energy.reflected.value)),
        (error, energies(&|energy| energy.reflected.std_error)),
        (transmitted, energies(&|energy| energy.transmitted)),
        (absorbed, energies(&|energy| energy.absorbed)),
        (truncated, energies(&|energy| energy.truncated)),
        (imbalance, energies(&|energy| energy.imbalance.value)),
        (imbalance_error, energies(&|energy| energy.imbalance.std_error)),
        (without_interference, energies(&|energy| energy.without_interference)),
        (RAYS, format_numbers(table.energy.iter().map(|energy| energy.rays))),
    ];
    let axes = axes(layout, &warp);
    let attributes = attributes.into_iter().chain(axes).map(|(key, value)| (key.to_owned(), value)).collect();
    let mut contents = Contents { size: atlas(layout), compression: Compression::ZIP16, channels, attributes };
    contents.add_metadata(&table.metadata)?;
    contents.encode(threads)
}

/// Removes an attribute and returns its two whole numbers.
fn pair(file: &mut Opened<'_>, key: &str) -> Result<[u32; 2]> {
    let numbers: Vec<u32> = file.take_numbers(key)?;
    numbers.try_into().map_err(|_| Error::failed(format_args!("{PREFIX}{key} must hold two numbers")))
}

/// Refuses files of earlier versions, with the command that makes a new one.
fn refuse_bins(file: &mut Opened<'_>) -> Result<()> {
    if !file.attributes.contains_key(BINS) {
        return Ok(());
    }
    let scene = Metadata::from(std::mem::take(&mut file.attributes));
    Err(Error::failed(format_args!(
        "the table holds fixed bins of an earlier version, in which lobes do not move with the light; make it anew: \
         goniochrome estimate {} -o table.exr",
        scene.scene_name()
    )))
}

/// Decodes the table in a file of this kind.
pub(super) fn decode(mut file: Opened<'_>) -> Result<ScatterTable> {
    refuse_bins(&mut file)?;
    let (incident, square) = (pair(&mut file, INCIDENT)?, pair(&mut file, HALF_VECTORS)?);
    let numbers: Vec<f32> = file.take_numbers(LOBES)?;
    let (lobes, rest) = numbers.as_chunks::<{ FacetLobe::LEN }>();
    if !rest.is_empty() {
        return Err(Error::failed(format_args!("{PREFIX}{LOBES} must hold ten numbers for each lobe")));
    }
    let lobes: Vec<FacetLobe> = lobes.iter().map(|numbers| FacetLobe::from_numbers(*numbers)).collect();
    let count = u32::try_from(lobes.len()).unwrap_or(u32::MAX);
    let layout = ScatterLayout::new(incident, square, count).map_err(Error::failed)?;
    let warp = [file.take_numbers(WARP[0])?, file.take_numbers(WARP[1])?];
    let [pairs_u, pairs_v] = warp_pairs(&warp)?;
    for (key, expected) in axes(&layout, &HalfVectorWarp::from_pairs(&pairs_u, &pairs_v).map_err(Error::failed)?) {
        if file.attributes.remove(key).is_some_and(|found| found != expected) {
            return Err(Error::failed(format_args!(
                "{PREFIX}{key} does not follow from the table's grid and warp: the header was changed; make the table anew"
            )));
        }
    }
    let wavelength_nm: Vec<f64> = file.take_numbers(WAVELENGTH)?;
    check_scatter_size(&layout, wavelength_nm.len())?;
    let names = channel_names(&wavelength_nm)?;
    file.expect(atlas(&layout), names.len() + 4)?;
    let mut energy = vec![Energy::default(); layout.incident_count()];
    let incident_count = energy.len();
    let length = |key: &str, found: usize| {
        if found == incident_count {
            return Ok(());
        }
        Err(Error::failed(format_args!("{PREFIX}{key} holds {found} numbers where {incident_count} belong")))
    };
    for (quantity, key) in ENERGIES.into_iter().enumerate() {
        let values: Vec<f64> = file.take_numbers(key)?;
        length(key, values.len())?;
        for (energy, value) in energy.iter_mut().zip(values) {
            let Energy {
                reflected: MeanWithError { value: reflected, std_error },
                transmitted,
                absorbed,
                truncated,
                imbalance: MeanWithError { value: imbalance, std_error: imbalance_error },
                without_interference,
                rays: _,
            } = energy;
            *[
                reflected,
                std_error,
                transmitted,
                absorbed,
                truncated,
                imbalance,
                imbalance_error,
                without_interference,
            ][quantity] = value;
        }
    }
    let rays: Vec<u64> = file.take_numbers(RAYS)?;
    length(RAYS, rays.len())?;
    energy.iter_mut().zip(rays).for_each(|(energy, rays)| energy.rays = rays);

    let mut channels = file.pixels()?;
    let pixel: Vec<usize> = pixels(&layout).collect();
    let mut values = filled(0.0, layout.count() * names.len(), "the table")?;
    let places = layout.places();
    for (w, name) in names.iter().enumerate() {
        let image = channels.take(name)?;
        for (incident, pixel) in pixel.chunks(places).enumerate() {
            let row = &mut values[(incident * names.len() + w) * places..][..places];
            row.iter_mut().zip(pixel).for_each(|(value, &pixel)| *value = image[pixel]);
        }
    }
    let [r, g, b] = [channels.take("R")?, channels.take("G")?, channels.take("B")?];
    let error = channels.take(ERROR)?;
    let table = ScatterTable {
        rgb: pixel.iter().map(|&pixel| [r[pixel], g[pixel], b[pixel]]).collect(),
        luminance_error: pixel.iter().map(|&pixel| error[pixel]).collect(),
        layout,
        warp,
        lobes,
        wavelength_nm,
        values,
        energy,
        metadata: file.attributes.into(),
    };
    table.check()?;
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::super::{decode, encode};
    use crate::table::Table;
    use crate::table::scatter::tests::sample;

    #[test]
    fn a_table_round_trips_exactly_and_gives_equal_bytes() {
        let bytes = encode(&sample().into(), 1).unwrap();
        assert_eq!(decode(&bytes).unwrap(), Table::Scatter(sample()));
        for _ in 0..3 {
            assert_eq!(encode(&sample().into(), 3).unwrap(), bytes);
        }
    }

    #[test]
    fn tiles_stand_where_the_layout_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.exr");
        super::super::write(&path, &sample().into(), 1).unwrap();
        let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap().layer_data;
        assert_eq!((image.size.0, image.size.1), (6, 6));
        let names: Vec<_> = image.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "T.435,833333nm", "T.700,000000nm", "error.Y"]);
        let red: Vec<f32> = image.channel_data.list[4].sample_data.values_as_f32().collect();
        // θ_i row 1, φ_i column 0, the second node along x, the second along y, the second wavelength; the lobe.
        assert!((red[4 * 6 + 1] - sample().row(2, 1)[4]).abs() < f32::EPSILON);
        assert!((red[5 * 6] - sample().row(2, 1)[6]).abs() < f32::EPSILON);
        assert_eq!(red[5 * 6 + 1], 0.0);
    }

    fn patched(from: &str, to: &str) -> String {
        assert_eq!(from.len(), to.len());
        let mut bytes = encode(&sample().into(), 1).unwrap();
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        decode(&bytes).unwrap_err().to_string()
    }

    #[test]
    fn contradictions_are_named() {
        assert!(patched("4096 8192", "4096x8192").contains("\"4096x8192\" in goniochrome.rays is not a number"));
        assert!(patched("4096 8192", "409628192").contains("goniochrome.rays holds 3 numbers where 4 belong"));
        assert!(patched(" 700", " 701").contains("T.701,000000nm is missing"));
        assert!(patched("error.Y", "error.X").contains("channel error.Y is missing"));
        assert!(patched("0.5 1.5 1", "0.7 1.5 1").contains("goniochrome.half_theta_deg does not follow"));
        assert!(patched("0.5 1.5 1", "0.0 1.5 1").contains("warp"));
        assert!(patched("1.5 1 0 0", "1.5 2 0 0").contains("orthogonal"));
        let mut table = sample();
        table.metadata.insert("half_vectors", "x");
        assert!(encode(&table.into(), 1).unwrap_err().to_string().contains("is reserved"));
    }

    #[test]
    fn files_of_fixed_bins_are_refused_with_the_command_that_makes_a_new_one() {
        let mut table = sample();
        table.metadata.insert("bims", "16 32");
        let mut bytes = encode(&table.into(), 1).unwrap();
        let name = b"goniochrome.bims";
        let at = bytes.windows(name.len()).position(|window| window == name).expect("the attribute");
        bytes[at..at + name.len()].copy_from_slice(b"goniochrome.bins");
        let refusal = decode(&bytes).unwrap_err().to_string();
        assert!(refusal.contains("goniochrome estimate bumps -o table.exr"), "{refusal}");
    }

    #[test]
    fn the_header_names_every_direction_and_half_vector_of_the_layout() {
        let table = sample();
        let layout = table.layout;
        let [u, v] = super::warp_pairs(&table.warp).unwrap();
        let warp = super::HalfVectorWarp::from_pairs(&u, &v).unwrap();
        let [theta, phi, half_theta, half_phi] = super::axes(&layout, &warp)
            .map(|(_, text)| text.split(' ').map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
        let close = |a: f64, b: f64| (a - b).abs() < 1e-8;
        for incident in 0..layout.incident_count() {
            let [t, p] = layout.incident(incident).map(f64::to_degrees);
            assert!(close(theta[incident / 2], t) && close(phi[incident % 2], p));
        }
        for node in 0..layout.node_count() {
            let [x, y] = layout.node(node).map(|place| place as f32);
            let (m, _) = warp.half_vector([x, y], 0.0);
            let (t, p) = (half_theta[node % 3].to_radians(), half_phi[node / 3].to_radians());
            let named = glam::DVec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos());
            // Half vectors are in single precision.
            assert!((named - m.as_dvec3()).length() < 1e-6, "{node}");
        }
    }

    #[test]
    fn damaged_files_give_one_line_and_no_panic() {
        crate::table::file::tests::damage(&encode(&sample().into(), 1).unwrap());
    }
}
