//! Tests of table blobs: a written blob is read in place with equal results, and damaged ones are refused.

use glam::Vec3;
use goniochrome::colour::RgbSpace;
use goniochrome::microfacet::{Distribution, Finish, Masking};
use goniochrome::table::blob::{Blob, BlobError, Contents, Precision};
use goniochrome::table::{
    FacetLobe, FilmArrays, FilmTable, HalfVectorWarp, MirrorTable, OrderArrays, OrderLayout, OrderTable, Periodicity,
    ScatterLayout, ScatterSampler, ScatterTable, TableError,
};

/// Relative rounding of binary16.
pub const HALF_RELATIVE: f32 = 1.0 / 2048.0;
/// Half of the smallest step of binary16.
pub const HALF_ABSOLUTE: f32 = 1.0 / 33_554_432.0;

/// Densities of the warp, of 3 and of 2 knots.
const WARP: [&[f32]; 2] = [&[1.0, 2.0, 0.5], &[1.0, 1.0]];

/// Grid of 3 × 2 incident directions and 3 × 4 nodes, with a lobe.
fn layout() -> ScatterLayout {
    ScatterLayout::new([3, 2], [3, 4], 1).unwrap()
}

fn scatter_values() -> Vec<f32> {
    (0..3 * layout().count()).map(|i| (i as f32 * 0.7).sin() * 10f32.powi(i as i32 % 7 - 4)).collect()
}

fn lobe() -> FacetLobe {
    FacetLobe { index: 1.5, ..FacetLobe::reflection(Vec3::new(0.28, 0.0, 0.96)) }
}

fn with_scatter<T>(use_table: impl FnOnce(ScatterTable<'_>, ScatterSampler<'_>) -> T) -> T {
    let values = scatter_values();
    let mut pairs = [0.0; HalfVectorWarp::required_len([3, 2])];
    let lobes = [lobe().to_numbers()];
    let table =
        ScatterTable::new(&values, layout(), HalfVectorWarp::new(WARP, &mut pairs).unwrap(), &lobes, 3).unwrap();
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout())];
    let sampler = ScatterSampler::new(&table, &mut memory).unwrap();
    use_table(table, sampler)
}

fn mirror_values() -> Vec<f32> {
    (0..9).map(|i| 1.0 / (i as f32 + 1.0) - 0.2).collect()
}

pub fn written(contents: Contents<'_>, precision: Precision) -> Vec<u8> {
    let blob = Blob { space: Some(RgbSpace::Rec2020), contents };
    let mut bytes = vec![0xa5; blob.required_len(precision).unwrap()];
    blob.write(precision, &mut bytes).unwrap();
    bytes
}

fn scatter(precision: Precision) -> Vec<u8> {
    with_scatter(|table, sampler| written(Contents::Scatter(table, sampler), precision))
}

fn mirror(precision: Precision) -> Vec<u8> {
    written(Contents::Mirror(MirrorTable::new(&mirror_values(), 3, 1.5).unwrap()), precision)
}

/// Two thicknesses of four angles; with a finish or without, with transmittance or without.
pub fn with_film<T>(finished: bool, transparent: bool, use_table: impl FnOnce(FilmTable<'_>) -> T) -> T {
    let reflectance: Vec<f32> = (0..24).map(|i| (i * 37 % 101) as f32 / 97.0).collect();
    let transmittance: Vec<f32> = reflectance.iter().map(|rho| 1.5 - rho).collect();
    let transmittance = if transparent { &transmittance[..] } else { &[] };
    let finish = Finish::new(Distribution::Beckmann, Masking::Separable, [0.25, 0.5]).unwrap();
    let arrays = FilmArrays { reflectance: &reflectance, transmittance, thickness_nm: &[100.0, 250.0] };
    use_table(FilmTable::new(&arrays, 3, 1.5, finished.then_some(finish)).unwrap())
}

pub fn film(precision: Precision) -> Vec<u8> {
    with_film(true, true, |table| written(Contents::Film(table), precision))
}

const ORDERS: [[f32; 2]; 5] = [[-1.0, 0.0], [0.0, -1.0], [0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
const NM: [f32; 3] = [450.0, 550.0, 700.0];
const INDEX: [f32; 3] = [1.34, 1.33, 1.32];
const WEIGHTS: [[f32; 3]; 3] = [[0.0, 0.1, 0.9], [0.3, 0.7, 0.1], [0.7, 0.2, -0.1]];
/// Values of the table of orders: 3 wavelengths, 4 × 3 nodes, 5 orders.
const STRENGTHS: usize = 180;

fn with_orders<T>(use_table: impl FnOnce(OrderTable<'_>) -> T) -> T {
    let layout = OrderLayout::new([4, 3], Periodicity::Both, [1600.0, 740.0]).unwrap();
    let strength: Vec<f32> = (0..STRENGTHS).map(|i| (i * 37 % 101) as f32 / 97.0).collect();
    let arrays =
        OrderArrays { orders: &ORDERS, wavelength_nm: &NM, index: &INDEX, rgb_weights: &WEIGHTS, strength: &strength };
    use_table(OrderTable::new(layout, &arrays).unwrap())
}

fn orders(precision: Precision) -> Vec<u8> {
    with_orders(|table| written(Contents::Orders(table), precision))
}

/// The bytes with a right checksum, so that only the other checks can refuse them.
pub fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&bytes[..60]);
    crc.update(&bytes[64..]);
    bytes[60..64].copy_from_slice(&crc.finalize().to_le_bytes());
    bytes
}

pub fn directions() -> impl Iterator<Item = Vec3> {
    (0..40).map(|i| {
        let (cos, phi) = (0.02 + 0.024 * i as f32, 2.4 * i as f32);
        let sin = (1.0 - cos * cos).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    })
}

#[test]
fn single_precision_is_looked_up_bit_for_bit_wherever_it_lies() {
    let bytes = scatter(Precision::Single);
    for shift in 0..4 {
        let mut moved = vec![0; shift];
        moved.extend(&bytes);
        let blob = Blob::read(&moved[shift..]).unwrap();
        assert_eq!(blob.space, Some(RgbSpace::Rec2020));
        let Contents::Scatter(read, reader) = blob.contents else { panic!("a scatter table") };
        with_scatter(|table, sampler| {
            assert_eq!((read.layout(), read.channels(), read.lobe(0)), (table.layout(), 3, lobe()));
            assert_eq!(read.warp().knots(), [3, 2]);
            for (wi, wo) in directions().zip(directions().skip(3)) {
                assert_eq!(read.rgb(wi, wo), table.rgb(wi, wo));
                assert_eq!(reader.pdf(wi, wo), sampler.pdf(wi, wo));
                let u = [(wi.x + 1.0) / 2.0, (wo.y + 1.0) / 2.0];
                assert_eq!(reader.sample(wi, u), sampler.sample(wi, u));
                let [mut got, mut want] = [[0.0; 4]; 2];
                assert_eq!(read.reflected(wi, 0, &mut got), table.reflected(wi, 0, &mut want));
                assert_eq!(got, want);
                read.albedo(wi, &mut got);
                table.albedo(wi, &mut want);
                assert_eq!(got, want);
            }
        });
    }
    let bytes = mirror(Precision::Single);
    let Contents::Mirror(read) = Blob::read(&bytes).unwrap().contents else { panic!("a mirror table") };
    let values = mirror_values();
    let table = MirrorTable::new(&values, 3, 1.5).unwrap();
    assert_eq!((read.rows(), read.channels(), read.theta_max()), (3, 3, 1.5));
    for i in 0..100 {
        let theta = 0.02 * i as f32 - 0.1;
        assert_eq!(read.rgb(theta), table.rgb(theta));
    }
}

#[test]
fn orders_are_looked_up_as_before_they_were_written() {
    for (precision, largest) in [(Precision::Single, 0.0), (Precision::Half, HALF_RELATIVE)] {
        let mut bytes = vec![0];
        bytes.extend(orders(precision));
        let blob = Blob::read(&bytes[1..]).unwrap();
        assert_eq!(blob.space, Some(RgbSpace::Rec2020));
        let Contents::Orders(read) = blob.contents else { panic!("a table of orders") };
        with_orders(|table| {
            assert_eq!(read.layout(), table.layout());
            assert_eq!((read.order_count(), read.wavelength_count()), (5, 3));
            (0..5).for_each(|order| assert_eq!(read.order(order), table.order(order)));
            for w in 0..3 {
                assert_eq!((read.wavelength_nm(w), read.rgb_weight(w)), (table.wavelength_nm(w), table.rgb_weight(w)));
            }
            for wo in directions() {
                let (seen, expected) = (read.view(wo).unwrap(), table.view(wo).unwrap());
                for (w, order) in (0..3).flat_map(|w| (0..5).map(move |order| (w, order))) {
                    match (seen.light_between(w, 0.3, order), expected.light_between(w, 0.3, order)) {
                        (Some(got), Some(want)) => {
                            assert_eq!(got.direction, want.direction);
                            // Strengths are below 1.04, each rounded, and the sums of eight are too.
                            let slack = 1.04 * largest + if largest > 0.0 { HALF_ABSOLUTE } else { 0.0 };
                            assert!((got.efficiency - want.efficiency).abs() <= slack, "{got:?} for {want:?}");
                        }
                        (got, want) => assert_eq!(got, want),
                    }
                }
                if precision == Precision::Single {
                    assert_eq!(seen.sample(1, 0.4), expected.sample(1, 0.4));
                }
            }
        });
    }
}

#[test]
fn half_precision_rounds_values_and_nothing_else() {
    let bytes = scatter(Precision::Half);
    let Contents::Scatter(read, reader) = Blob::read(&bytes).unwrap().contents else { panic!("a scatter table") };
    let single = scatter(Precision::Single);
    let Contents::Scatter(table, sampler) = Blob::read(&single).unwrap().contents else { panic!("a scatter table") };
    let largest = scatter_values().iter().fold(0.0f32, |max, x| max.max(x.abs()));
    for (wi, wo) in directions().zip(directions().skip(3)) {
        assert_eq!(reader.pdf(wi, wo), sampler.pdf(wi, wo));
        let cosines = wi.z.max(0.0174) * wo.z;
        for (got, want) in read.rgb(wi, wo).into_iter().zip(table.rgb(wi, wo)) {
            let rounding = 1.01 * HALF_RELATIVE * largest + HALF_ABSOLUTE;
            assert!((got - want).abs() * cosines <= rounding, "{got} for {want}");
        }
    }
    // 9 values of two bytes and their padding.
    assert_eq!(mirror(Precision::Half).len(), 64 + 20);
}

#[test]
fn the_bytes_are_those_of_the_specification() {
    let bytes = mirror(Precision::Single);
    let header: [&[u8]; 15] = [
        b"\x89GONI\r\n\x1a",
        &1u32.to_le_bytes(),
        &1u32.to_le_bytes(),
        &4u32.to_le_bytes(),
        &3u32.to_le_bytes(),
        &3u32.to_le_bytes(),
        &1u32.to_le_bytes(),
        &1u32.to_le_bytes(),
        &1u32.to_le_bytes(),
        &1.5f64.to_le_bytes(),
        &100u64.to_le_bytes(),
        &2u32.to_le_bytes(),
        &CRC_OF_PYTHON.to_le_bytes(),
        &mirror_values()[0].to_le_bytes(),
        &mirror_values()[1].to_le_bytes(),
    ];
    assert_eq!(bytes[..72], header.concat());
}

/// `zlib.crc32(blob[:60] + blob[64:])` of Python, for a blob packed there.
const CRC_OF_PYTHON: u32 = 0x097d_2e52;

#[test]
fn the_bytes_of_scatter_tables_are_those_of_the_specification() {
    let bytes = scatter(Precision::Half);
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
    let numbers = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    assert_eq!(bytes[8..44], words(&[1, 4, 2, 3, 3, 2, 3, 4, 1]));
    assert_eq!(bytes[44..48], [3, 0, 2, 0]);
    // 6 incident directions of 12 nodes and a lobe; 10 numbers of the warp, 10 of the lobe; 17 for each direction.
    let from = 64 + 2 * 3 * 6 * 13;
    assert_eq!(bytes.len(), from + 4 * (10 + 10 + 6 * 17));
    // The mean of the densities over u is 1.375: trapezia of 1.5 and 1.25.
    let [a, b, c] = [1.0, 2.0, 0.5].map(|d| (d / 1.375) as f32);
    let warp = [a, 0.0, b, (1.5 / 2.75) as f32, c, 1.0, 1.0, 0.0, 1.0, 1.0];
    assert_eq!(bytes[from..from + 40], numbers(&warp));
    assert_eq!(bytes[from + 40..from + 80], numbers(&lobe().to_numbers()));
    // s of the second node of the first direction, and the lobe's ρ there.
    let single = scatter(Precision::Single);
    assert_eq!(single[64 + 4 * 3..][..12], numbers(&scatter_values()[3..6]));
    assert_eq!(single[64 + 4 * 3 * 12..][..12], numbers(&scatter_values()[36..39]));
}

#[test]
fn the_bytes_of_orders_are_those_of_the_specification() {
    let bytes = orders(Precision::Half);
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
    let numbers = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    assert_eq!(bytes[8..40], words(&[1, 3, 2, 5, 3, 4, 3, 3]));
    assert_eq!(bytes[40..48], numbers(&[1600.0, 740.0]));
    assert_eq!(bytes[48..60], words(&[64 + 2 * STRENGTHS as u32 + 4 * 25, 0, 2]));
    assert_eq!(orders(Precision::Single)[64 + 4 * 37..][..4], ((37 * 37 % 101) as f32 / 97.0).to_le_bytes());
    let tail = [ORDERS.as_flattened(), &NM, &INDEX, WEIGHTS.as_flattened()].concat();
    assert_eq!(bytes[64 + 2 * STRENGTHS..], numbers(&tail));
}

#[test]
fn every_rule_of_orders_is_checked_behind_a_right_checksum() {
    let with = |offset: usize, value: &[u8]| {
        let mut bytes = orders(Precision::Single);
        bytes[offset..offset + value.len()].copy_from_slice(value);
        Blob::read(&resealed(bytes)).map(drop)
    };
    let word = |offset, word: u32| with(offset, &word.to_le_bytes());
    let number = |offset, number: f32| with(offset, &number.to_le_bytes());
    for sides in [0, 4, 7] {
        assert_eq!(word(36, sides), Err(BlobError::Field { offset: 36 }));
    }
    // Lines along y: the order (0, -1) is none of theirs.
    assert_eq!(word(36, 1), Err(BlobError::Table(TableError::Orders)));
    for period in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(number(40, period), Err(BlobError::Table(TableError::OrderLayout)));
        assert_eq!(number(44, period), Err(BlobError::Table(TableError::OrderLayout)));
    }
    // Nodes of another grid of equal size.
    assert_eq!(with(24, &[1, 0, 0, 0, 12, 0, 0, 0]), Err(BlobError::Table(TableError::OrderLayout)));
    assert_eq!(with(24, &[6, 0, 0, 0, 2, 0, 0, 0]), Ok(()));
    for strength in [f32::NAN, -0.5, f32::INFINITY, 2e30] {
        assert_eq!(number(64 + 4 * 9, strength), Err(BlobError::Table(TableError::Strength { index: 9 })));
    }
    let axes = 64 + 4 * STRENGTHS;
    // The first order, the second wavelength, the first index, the last weight.
    let places = [(0, 0.5), (0, 2e6), (0, f32::NAN), (11, 450.0), (10, 0.0), (13, -1.0), (13, 0.0), (24, f32::NAN)];
    for (place, value) in places {
        assert_eq!(number(axes + 4 * place, value), Err(BlobError::Table(TableError::Orders)), "{place}: {value}");
    }
    let mut half = orders(Precision::Half);
    half[64..66].copy_from_slice(&[0, 0x7c]);
    assert_eq!(Blob::read(&resealed(half)), Err(BlobError::Range { index: 0 }));
}

#[test]
fn every_length_but_the_right_one_is_refused() {
    let scattering = [scatter(Precision::Single), scatter(Precision::Half)];
    for bytes in
        scattering.into_iter().chain([mirror(Precision::Half), orders(Precision::Single), film(Precision::Half)])
    {
        for length in 0..bytes.len() {
            assert!(matches!(Blob::read(&bytes[..length]), Err(BlobError::Length { .. })), "{length}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert_eq!(Blob::read(&longer), Err(BlobError::Length { required: bytes.len() as u64 }));
    }
}

#[test]
fn every_changed_byte_is_found() {
    for bytes in [scatter(Precision::Single), mirror(Precision::Half), orders(Precision::Half), film(Precision::Half)] {
        for at in 0..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                assert!(Blob::read(&damaged).is_err(), "byte {at}");
            }
        }
    }
}

#[test]
fn absurd_headers_are_refused_or_harmless() {
    let wild = [0, 1, 2, 3, 5, 1024, 1025, 65_536, u32::MAX / 2, u32::MAX];
    let scattering = [scatter(Precision::Single), scatter(Precision::Half)];
    for bytes in
        scattering.into_iter().chain([mirror(Precision::Single), orders(Precision::Single), film(Precision::Single)])
    {
        for at in (12..44).step_by(4) {
            for (word, other) in wild.iter().flat_map(|a| wild.map(|b| (*a, b))) {
                let mut damaged = bytes.clone();
                damaged[at..at + 4].copy_from_slice(&word.to_le_bytes());
                damaged[at + 4..at + 8].copy_from_slice(&other.to_le_bytes());
                // Some headers describe another table of equal size, and looking that up must be safe.
                match Blob::read(&resealed(damaged)).map(|blob| blob.contents) {
                    Ok(Contents::Mirror(table)) => assert!(table.rgb(0.3).iter().all(|x| x.is_finite())),
                    Ok(Contents::Film(table)) => {
                        let wi = Vec3::new(0.6, 0.0, 0.8);
                        let all = [
                            table.reflectance(0.3, 120.0),
                            table.transmittance(0.3, 1e9),
                            table.eval(wi, Vec3::Z, 0.0),
                        ];
                        assert!(all.as_flattened().iter().all(|x| x.is_finite()));
                        assert!(table.sample(wi, [0.3, 0.9], 120.0).is_none_or(|drawn| drawn.pdf != Some(0.0)));
                    }
                    Ok(Contents::Scatter(table, sampler)) => {
                        let (wi, mut albedo) = (Vec3::new(0.6, 0.0, 0.8), [0.0; 3]);
                        assert!(sampler.sample(wi, [0.3, 0.9]).is_none_or(|(_, pdf)| pdf > 0.0));
                        assert!(table.rgb(Vec3::Z, wi).iter().all(|x| x.is_finite()));
                        table.albedo(wi, &mut albedo);
                        assert!(albedo.iter().all(|x| x.is_finite()));
                        for lobe in 0..=table.layout().lobes() {
                            let _ = table.reflected(wi, lobe, &mut albedo);
                        }
                    }
                    Ok(Contents::Orders(table)) => {
                        let view = table.view(Vec3::new(0.6, 0.0, 0.8)).unwrap();
                        assert!(view.albedo(0).is_finite());
                        assert!(view.sample(0, 0.5).is_none_or(|sample| sample.probability > 0.0));
                    }
                    Err(_) => {}
                }
            }
        }
    }
    let set = |offset: usize, word: u32| {
        let mut bytes = scatter(Precision::Single);
        bytes[offset..offset + 4].copy_from_slice(&word.to_le_bytes());
        Blob::read(&resealed(bytes)).unwrap_err()
    };
    assert_eq!(set(0, 7), BlobError::Magic);
    assert_eq!(set(8, 2), BlobError::Version { found: 2 });
    assert_eq!(set(12, 2), BlobError::Retired);
    assert_eq!(set(12, 0), BlobError::Field { offset: 12 });
    assert_eq!(set(12, 6), BlobError::Field { offset: 12 });
    assert_eq!(set(16, 8), BlobError::Field { offset: 16 });
    assert_eq!(set(24, u32::MAX), BlobError::Dimensions);
    // As many lobes as no memory holds; and a warp of other knots, of the same number in all.
    assert_eq!(set(40, u32::MAX), BlobError::Dimensions);
    assert_eq!(set(44, 3 << 16 | 2), BlobError::Table(TableError::Warp));
    assert_eq!(set(44, 4 << 16 | 1), BlobError::Table(TableError::Warp));
    assert_eq!(set(56, 5), BlobError::Field { offset: 56 });
    assert!(matches!(set(52, 1), BlobError::Length { .. }));
}

#[test]
fn unsound_numbers_are_refused_even_with_a_right_checksum() {
    let with = |bytes: Vec<u8>, from: usize, value: &[u8]| {
        let mut damaged = bytes;
        damaged[from..from + value.len()].copy_from_slice(value);
        Blob::read(&resealed(damaged)).map(drop)
    };
    assert!(with(mirror(Precision::Single), 64, &f32::NAN.to_le_bytes()).is_err());
    assert_eq!(with(mirror(Precision::Half), 66, &[0, 0x7c]), Err(BlobError::Range { index: 1 }));
    assert_eq!(with(mirror(Precision::Half), 82, &[1, 0]), Err(BlobError::Field { offset: 82 }));
    let warp = 64 + 4 * 3 * layout().count();
    let number = |place: usize, value: f32| with(scatter(Precision::Single), warp + 4 * place, &value.to_le_bytes());
    // The first density and its integral, the integral in the middle and its end; no density is below 10⁻³.
    for (place, value) in [(0, 0.0), (0, f32::NAN), (0, 1.1), (1, 0.1), (3, 1.0), (3, 0.41), (5, 0.9), (6, 1e-4)] {
        assert_eq!(number(place, value), Err(BlobError::Table(TableError::Warp)), "{place} {value}");
    }
    // The lobe follows the warp's ten numbers: its index, and its matrix.
    for (place, value) in [(10, 0.0), (10, f32::NAN), (11, 1.0), (12, 0.5), (19, f32::INFINITY)] {
        assert_eq!(number(place, value), Err(BlobError::Table(TableError::Lobe)), "{place} {value}");
    }
    // What the first incident direction reflects, then its probabilities of rows.
    for (place, value) in [(0, -1.0), (0, f32::INFINITY), (1, f32::NAN), (2, -0.1), (4, 0.9), (5, 1.5)] {
        let refused = Err(BlobError::Table(TableError::NotFinite { index: 0 }));
        assert_eq!(number(20 + place, value), refused, "{place} {value}");
    }
}

#[test]
fn what_half_precision_cannot_hold_is_not_written() {
    let values = [0.0, 70_000.0];
    let blob =
        Blob { space: Some(RgbSpace::Srgb), contents: Contents::Mirror(MirrorTable::new(&values, 1, 1.0).unwrap()) };
    let mut bytes = [0; 68];
    assert_eq!(blob.write(Precision::Half, &mut bytes), Err(BlobError::Range { index: 1 }));
    assert_eq!(blob.write(Precision::Single, &mut bytes), Err(BlobError::Length { required: 72 }));
}
