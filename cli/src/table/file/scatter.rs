//! Files of scattering tables: an atlas, one tile per incident direction.
//!
//! The image is T·N pixels high and P·M wide for T × P incident directions and N × M outgoing bins ([`ScatterLayout`]
//! defines the directions). The tile of θ_i row t and φ_i column p begins at pixel x = p·M, y = t·N. Inside it, x
//! counts the bins in the relative azimuth φ_o − φ_i (bin 0: back to the light, bin M/2: the side of the mirror
//! direction) and y the bins in cos θ_o, **from the horizon**: the first line of a tile is grazing, its last faces the
//! normal. The first line of tiles is the incidence nearest to the normal.
//!
//! | channel | holds |
//! |---|---|
//! | `R`, `G`, `B` | linear RGB of f, in 1/sr; components may be negative |
//! | `T.550,000000nm` | f at a wavelength, in 1/sr, unpolarised: the mean over the bin, without the cosine |
//! | `error.Y` | standard error of the luminance of f, in 1/sr |
//!
//! | attribute `goniochrome.` | holds |
//! |---|---|
//! | `kind` | `scatter` |
//! | `incident` | T and P |
//! | `bins` | N and M |
//! | `incident_theta_deg` | the T angles θ_i, in the order of the rows of tiles |
//! | `incident_phi_deg` | the P azimuths φ_i, in the order of the columns of tiles |
//! | `bin_cos_edges` | the N + 1 edges of the bins in cos θ_o, from the horizon |
//! | `bin_phi_edges_deg` | the M + 1 edges of the bins in the relative azimuth φ_o − φ_i; bin 0 lies around 0° |
//! | `wavelength_nm` | the wavelengths at full precision |
//! | `reflected`, `transmitted`, `absorbed`, `truncated` | fractions of the incident light, weighted by luminance |
//! | `reflected_error` | standard error of `reflected` |
//! | `imbalance`, `imbalance_error` | what is missing from 1, and its standard error |
//! | `without_interference` | fraction of starting rays that were traced without interference |
//! | `rays` | number of starting rays |
//!
//! The last five rows hold one number for each incident direction, row by row. Numbers in attributes are decimal,
//! separated by spaces. Blocks of 16 lines are ZIP-compressed. With P = 1 the table is a mean over azimuths, and φ_i is
//! that of its first. `tests/python/read_table.py` reads all of it in a few lines of NumPy. The four lists of angles
//! follow from T, P, N and M. Older files lack them, `imbalance`, `imbalance_error` and `without_interference`.

use exr::prelude::Compression;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::table::ScatterLayout;

use super::container::{Contents, KIND, Opened, PREFIX, WAVELENGTH, channel_names, format_numbers};
use super::lazy_channel::LazyChannel;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size};
use crate::table::statistics::MeanWithError;

/// Value of the attribute `kind`.
pub(super) const SCATTER: &str = "scatter";
const INCIDENT: &str = "incident";
const BINS: &str = "bins";
const RAYS: &str = "rays";
const AXES: [&str; 4] = ["incident_theta_deg", "incident_phi_deg", "bin_cos_edges", "bin_phi_edges_deg"];
const ERROR: &str = "error.Y";
const ENERGIES: [&str; 5] = ["reflected", "reflected_error", "transmitted", "absorbed", "truncated"];
/// Energies that older files lack.
const LATER_ENERGIES: [&str; 3] = ["imbalance", "imbalance_error", "without_interference"];

/// Width and height of the atlas.
fn atlas(layout: &ScatterLayout) -> (usize, usize) {
    let bins = layout.bins();
    (layout.phi() as usize * bins.phi as usize, layout.theta() as usize * bins.cos as usize)
}

/// Pixel of every pair of directions, incident by incident, bin by bin.
fn pixels(layout: &ScatterLayout) -> impl Iterator<Item = usize> {
    let (width, _) = atlas(layout);
    let (columns, rows, tiles) = (layout.bins().phi as usize, layout.bins().cos as usize, layout.phi() as usize);
    let bins = rows * columns;
    (0..layout.count()).map(move |pair| {
        let (incident, bin) = (pair / bins, pair % bins);
        let x = (incident % tiles) * columns + bin % columns;
        let y = (incident / tiles) * rows + bin / columns;
        y * width + x
    })
}

/// Pair of directions of a pixel: the inverse of [`pixels`].
fn pair_of(layout: &ScatterLayout, pixel: usize) -> usize {
    let (width, _) = atlas(layout);
    let (columns, rows, tiles) = (layout.bins().phi as usize, layout.bins().cos as usize, layout.phi() as usize);
    let (x, y) = (pixel % width, pixel / width);
    let incident = (y / rows) * tiles + x / columns;
    (incident * rows + y % rows) * columns + x % columns
}

/// Directions of incidence and edges of bins, as [`AXES`] names them.
fn axes(layout: &ScatterLayout) -> [(&'static str, String); 4] {
    let (theta, phi, bins) = (layout.theta(), layout.phi(), layout.bins());
    // Angles of 90/N and 360/M degrees: fractions of whole numbers, without the rounding of radians.
    let columns = |p: u32| 360.0 * (layout.first_bin(p as usize) as f64 + 0.5) / f64::from(bins.phi);
    let lists = [
        format_numbers((0..theta).map(|t| 90.0 * (f64::from(t) + 0.5) / f64::from(theta))),
        format_numbers((0..phi).map(columns)),
        format_numbers((0..=bins.cos).map(|n| f64::from(n) / f64::from(bins.cos))),
        format_numbers((0..=bins.phi).map(|m| 360.0 * (f64::from(m) - 0.5) / f64::from(bins.phi))),
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
    let bins = layout.bins().count();
    // A table may fill much of memory: its channels are read where they lie.
    let of_pair =
        |at: fn(&ScatterTable, usize) -> f32| LazyChannel::new(move |pixel| at(table, pair_of(layout, pixel)));
    let mut channels = vec![
        (ERROR.to_owned(), of_pair(|table, pair| table.luminance_error[pair])),
        ("R".to_owned(), of_pair(|table, pair| table.rgb[pair][0])),
        ("G".to_owned(), of_pair(|table, pair| table.rgb[pair][1])),
        ("B".to_owned(), of_pair(|table, pair| table.rgb[pair][2])),
    ];
    for (w, name) in names.into_iter().enumerate() {
        let at = move |pixel| {
            let pair = pair_of(layout, pixel);
            table.row(pair / bins, w)[pair % bins]
        };
        channels.push((name, LazyChannel::new(at)));
    }

    let energies = |of: &dyn Fn(&Energy) -> f64| format_numbers(table.energy.iter().map(of));
    let [reflected, error, transmitted, absorbed, truncated] = ENERGIES;
    let [imbalance, imbalance_error, without_interference] = LATER_ENERGIES;
    let attributes = [
        (KIND, SCATTER.to_owned()),
        (INCIDENT, format!("{} {}", layout.theta(), layout.phi())),
        (BINS, format!("{} {}", layout.bins().cos, layout.bins().phi)),
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
    let attributes = attributes.into_iter().chain(axes(layout)).map(|(key, value)| (key.to_owned(), value)).collect();
    let mut contents = Contents { size: atlas(layout), compression: Compression::ZIP16, channels, attributes };
    contents.add_metadata(&table.metadata)?;
    contents.encode(threads)
}

/// Removes an attribute and returns its two whole numbers.
fn pair(file: &mut Opened<'_>, key: &str) -> Result<[u32; 2]> {
    let numbers: Vec<u32> = file.take_numbers(key)?;
    numbers.try_into().map_err(|_| Error::failed(format_args!("{PREFIX}{key} must hold two numbers")))
}

/// Decodes the table in a file of this kind.
pub(super) fn decode(mut file: Opened<'_>) -> Result<ScatterTable> {
    let ([theta, phi], [cos, around]) = (pair(&mut file, INCIDENT)?, pair(&mut file, BINS)?);
    let layout = ScatterLayout::new(theta, phi, DirectionBins { cos, phi: around }).map_err(Error::failed)?;
    for (key, expected) in axes(&layout) {
        if file.attributes.remove(key).is_some_and(|found| found != expected) {
            let (tiles, bins) = (format_args!("{theta} × {phi}"), format_args!("{cos} × {around}"));
            return Err(Error::failed(format_args!(
                "{PREFIX}{key} is not that of {tiles} incident directions and {bins} bins in this version"
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
                ..
            } = energy;
            *[reflected, std_error, transmitted, absorbed, truncated][quantity] = value;
        }
    }
    for (quantity, key) in LATER_ENERGIES.into_iter().enumerate() {
        if !file.attributes.contains_key(key) {
            continue;
        }
        let values: Vec<f64> = file.take_numbers(key)?;
        length(key, values.len())?;
        for (energy, value) in energy.iter_mut().zip(values) {
            let Energy { imbalance: MeanWithError { value: imbalance, std_error }, without_interference, .. } = energy;
            *[imbalance, std_error, without_interference][quantity] = value;
        }
    }
    let rays: Vec<u64> = file.take_numbers(RAYS)?;
    length(RAYS, rays.len())?;
    energy.iter_mut().zip(rays).for_each(|(energy, rays)| energy.rays = rays);

    let mut channels = file.pixels()?;
    let place: Vec<usize> = pixels(&layout).collect();
    let mut brdf = filled(0.0, layout.count() * names.len(), "the table")?;
    let bins = layout.bins().count();
    for (w, name) in names.iter().enumerate() {
        let image = channels.take(name)?;
        for (incident, place) in place.chunks(bins).enumerate() {
            let row = &mut brdf[(incident * names.len() + w) * bins..][..bins];
            row.iter_mut().zip(place).for_each(|(value, &pixel)| *value = image[pixel]);
        }
    }
    let [r, g, b] = [channels.take("R")?, channels.take("G")?, channels.take("B")?];
    let error = channels.take(ERROR)?;
    let table = ScatterTable {
        rgb: place.iter().map(|&pixel| [r[pixel], g[pixel], b[pixel]]).collect(),
        luminance_error: place.iter().map(|&pixel| error[pixel]).collect(),
        layout,
        wavelength_nm,
        brdf,
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
        assert_eq!((image.size.0, image.size.1), (8, 4));
        let names: Vec<_> = image.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R", "T.435,833333nm", "T.700,000000nm", "error.Y"]);
        let red: Vec<f32> = image.channel_data.list[4].sample_data.values_as_f32().collect();
        // θ_i row 1, φ_i column 0, cos θ_o row 1, relative azimuth 3, the second wavelength.
        assert!((red[3 * 8 + 3] - sample().row(2, 1)[7]).abs() < f32::EPSILON);
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
        assert!(
            patched("22.5 67.5", "22.5 76.5")
                .contains("goniochrome.incident_theta_deg is not that of 2 × 2 incident directions")
        );
        let mut table = sample();
        table.metadata.insert("bins", "x");
        assert!(encode(&table.into(), 1).unwrap_err().to_string().contains("is reserved"));
    }

    #[test]
    fn the_header_names_every_direction_and_edge_of_the_layout() {
        let table = sample();
        let layout = table.layout;
        let [theta, phi, cos, around] = super::axes(&layout)
            .map(|(_, text)| text.split(' ').map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        for incident in 0..layout.incident_count() {
            let [t, p] = layout.incident(incident).map(f64::to_degrees);
            let columns = layout.phi() as usize;
            assert!(close(theta[incident / columns], t) && close(phi[incident % columns], p));
        }
        for bin in 0..layout.bins().count() {
            let ([c, p], columns) = (layout.outgoing(bin), layout.bins().phi as usize);
            let (row, column) = (bin / columns, bin % columns);
            assert!(close(0.5 * (cos[row] + cos[row + 1]), c));
            assert!(close(0.5 * (around[column] + around[column + 1]), p.to_degrees()));
        }
        assert_eq!((cos.len(), around.len()), (3, 5));
    }

    #[test]
    fn files_from_before_the_header_named_directions_are_read() {
        let bytes = encode(&sample().into(), 1).unwrap();
        // Names of equal length, under another prefix: attributes of someone else.
        let older = super::AXES.iter().fold(bytes, |mut bytes, key| {
            let name = format!("goniochrome.{key}");
            let at = bytes.windows(name.len()).position(|window| window == name.as_bytes()).expect(key);
            bytes[at..at + 11].copy_from_slice(b"someoneelse");
            bytes
        });
        assert_eq!(decode(&older).unwrap(), Table::Scatter(sample()));
    }

    #[test]
    fn damaged_files_give_one_line_and_no_panic() {
        crate::table::file::tests::damage(&encode(&sample().into(), 1).unwrap());
    }
}
