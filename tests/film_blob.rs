//! Tests of blobs of films: their bytes, their rules, and look-ups before and after.

use goniochrome::microfacet::{Compensation, Distribution, FacetTable, Finish, FinishError, Masking};
use goniochrome::table::blob::{Blob, BlobError, Contents, Precision};
use goniochrome::table::{FilmArrays, FilmTable, TableError};

use crate::table_blob::{HALF_ABSOLUTE, HALF_RELATIVE, directions, film, resealed, with_film, written};

#[test]
fn films_are_looked_up_as_before_they_were_written() {
    for (finished, transparent) in [(true, true), (true, false), (false, true), (false, false)] {
        with_film(finished, transparent, |table| {
            for (precision, largest) in [(Precision::Single, 0.0), (Precision::Half, HALF_RELATIVE)] {
                let bytes = written(Contents::Film(table), precision);
                let Contents::Film(read) = Blob::read(&bytes).unwrap().contents else { panic!("a film table") };
                assert_eq!((read.finish(), read.is_transparent()), (table.finish(), transparent));
                assert_eq!((read.angles(), read.thicknesses(), read.range_nm()), (4, 2, [100.0, 250.0]));
                for (i, (wi, wo)) in directions().zip(directions().skip(3)).enumerate() {
                    let nm = 90.0 + 5.0 * i as f32;
                    let same = |got: [f32; 3], want: [f32; 3], scale: f32| {
                        // Values are at most 1.5, each rounded; so is what lies between them.
                        let slack = scale * (1.5 * largest + if largest > 0.0 { HALF_ABSOLUTE } else { 0.0 });
                        let near = got.into_iter().zip(want).all(|(got, want)| (got - want).abs() <= slack);
                        assert!(near, "{precision:?} {nm}: {got:?} for {want:?}");
                    };
                    same(read.reflectance(wi.z, nm), table.reflectance(wi.z, nm), 1.0);
                    same(read.transmittance(wi.z, nm), table.transmittance(wi.z, nm), 1.0);
                    let value = table.finish().and_then(|finish| finish.lobe(wi, wo)).map_or(0.0, |lobe| lobe.value);
                    same(read.eval(wi, wo, nm), table.eval(wi, wo, nm), 1.01 * value);
                    assert_eq!(read.pdf(wi, wo), table.pdf(wi, wo));
                    let u = [(wi.x + 1.0) / 2.0, (wo.y + 1.0) / 2.0];
                    let [got, want] = [read, table].map(|table| table.sample(wi, u, nm));
                    assert_eq!(got.map(|drawn| (drawn.wo, drawn.pdf)), want.map(|drawn| (drawn.wo, drawn.pdf)));
                    if let (Some(got), Some(want)) = (got, want) {
                        // With a finish the share of ρ is at most 1.
                        same(got.weight, want.weight, 1.01);
                    }
                }
            }
        });
    }
}

#[test]
fn the_bytes_of_films_are_those_of_the_specification() {
    let bytes = film(Precision::Half);
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
    assert_eq!(bytes[8..40], words(&[1, 5, 2, 3, 4, 2, 2, 4]));
    assert_eq!(bytes[40..48], 1.5f64.to_le_bytes());
    assert_eq!(bytes[48..60], words(&[64 + 2 * 48 + 4 * 4, 0, 2]));
    let numbers: Vec<u8> = [100f32, 250.0, 0.25, 0.5].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(bytes[64 + 2 * 48..], numbers);
    let single = film(Precision::Single);
    let value = |index: usize| f32::from_le_bytes(*single[64 + 4 * index..].first_chunk().unwrap());
    // The transmittance follows the reflectance.
    assert_eq!((value(13), value(24 + 13)), ((13 * 37 % 101) as f32 / 97.0, 1.5 - (13 * 37 % 101) as f32 / 97.0));
    let smooth = with_film(false, false, |table| written(Contents::Film(table), Precision::Single));
    assert_eq!((smooth.len(), &smooth[32..40]), (64 + 4 * 24 + 4 * 2, &words(&[1, 0])[..]));
}

#[test]
fn every_rule_of_films_is_checked_behind_a_right_checksum() {
    let with = |offset: usize, value: &[u8]| {
        let mut bytes = film(Precision::Single);
        bytes[offset..offset + value.len()].copy_from_slice(value);
        Blob::read(&resealed(bytes)).map(drop)
    };
    let numbers = 64 + 4 * 48;
    for quantities in [0, 3, u32::MAX] {
        assert_eq!(with(32, &quantities.to_le_bytes()), Err(BlobError::Field { offset: 32 }));
    }
    for finish in [5, u32::MAX] {
        assert_eq!(with(36, &finish.to_le_bytes()), Err(BlobError::Field { offset: 36 }));
    }
    assert_eq!(with(36, &0u32.to_le_bytes()), Err(BlobError::Dimensions));
    assert_eq!(with(36, &1u32.to_le_bytes()), Ok(()));
    // No channels of four times as many thicknesses, and one angle of four times as many channels.
    assert_eq!(with(20, &0u32.to_le_bytes()), Err(BlobError::Dimensions));
    assert_eq!(with(20, &[12, 0, 0, 0, 1, 0, 0, 0]), Err(BlobError::Table(TableError::Shape)));
    assert_eq!(with(40, &2f64.to_le_bytes()), Err(BlobError::Table(TableError::ThetaMax)));
    for (place, nm) in [(0, -1.0), (0, 250.0), (0, f32::NAN), (1, 100.0), (1, 2e9)] {
        assert_eq!(with(numbers + 4 * place, &nm.to_le_bytes()), Err(BlobError::Table(TableError::Thickness)), "{nm}");
    }
    for (place, alpha) in [(2, 0.0), (2, f32::NAN), (3, 1.5)] {
        let refused = Err(BlobError::Table(TableError::Finish));
        assert_eq!(with(numbers + 4 * place, &alpha.to_le_bytes()), refused, "{alpha}");
    }
    let infinite = f32::INFINITY.to_le_bytes();
    assert_eq!(with(64 + 4 * 30, &infinite), Err(BlobError::Table(TableError::NotFinite { index: 30 })));
}

/// A film of one thickness with tabulated facets.
fn with_facets<T>(size: [usize; 2], masking: Masking, use_table: impl FnOnce(FilmTable<'_>) -> T) -> T {
    let density: Vec<f32> = (0..(size[0] + 1) * size[1])
        .map(|node| {
            let (ring, turn) = ((node / size[1]) as f32 / size[0] as f32, (node % size[1]) as f32 / size[1] as f32);
            (-6.0 * ring * (1.2 + (2.0 * std::f32::consts::TAU * turn).cos())).exp()
        })
        .collect();
    let mut memory = vec![0.0; FacetTable::required_len(size)];
    let facets = FacetTable::new(size, &density, &mut memory).unwrap();
    let reflectance: Vec<f32> = (0..12).map(|i| (i * 37 % 101) as f32 / 97.0).collect();
    let arrays = FilmArrays { reflectance: &reflectance, transmittance: &[], thickness_nm: &[0.0] };
    use_table(FilmTable::new(&arrays, 3, 1.5, Some(Finish::tabulated(facets, masking))).unwrap())
}

#[test]
fn tabulated_facets_are_looked_up_in_bytes_as_in_memory() {
    for (size, number) in [([16, 1], 5), ([16, 12], 6), ([7, 8], 6)] {
        let masking = if number == 5 { Masking::Correlated } else { Masking::Separable };
        with_facets(size, masking, |table| {
            // At every alignment of the bytes.
            let bytes = written(Contents::Film(table), Precision::Single);
            for shift in 0..4 {
                let moved = [&vec![0; shift][..], &bytes].concat();
                let Contents::Film(read) = Blob::read(&moved[shift..]).unwrap().contents else { panic!("a film") };
                let finish = read.finish().unwrap();
                assert_eq!((finish.masking(), finish.alpha(), finish.distribution()), (masking, None, None));
                assert_eq!(finish.facets().unwrap().size(), size);
                assert!(finish.facets().unwrap().nodes().eq(table.finish().unwrap().facets().unwrap().nodes()));
                for (wi, wo) in directions().zip(directions().skip(3)) {
                    assert_eq!(read.eval_and_pdf(wi, wo, 0.0), table.eval_and_pdf(wi, wo, 0.0));
                    let u = [(wi.x + 1.0) / 2.0, (wo.y + 1.0) / 2.0];
                    assert_eq!(read.sample(wi, u, 0.0), table.sample(wi, u, 0.0));
                }
            }
            let [rings, sectors] = size;
            assert_eq!(bytes[36..40], [number, sectors as u8, rings as u8, 0]);
            let numbers = FacetTable::required_len(size);
            assert_eq!(bytes.len(), 64 + 4 * 12 + 4 * (1 + numbers));
            // What a film without tabulated facets may not say.
            let mut bad = bytes.clone();
            bad[36] = 1;
            assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Field { offset: 36 }));
            for [sectors, rings] in [[0, 4], [2, 4], [129, 4], [4, 0]] {
                let mut bad = bytes.clone();
                bad[37..39].copy_from_slice(&[sectors, rings]);
                assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Field { offset: 36 }));
            }
            for (place, value) in [(0, -1.0), (1, f32::NAN), (numbers - 1, f32::INFINITY), (numbers - 1, 1e19)] {
                let mut bad = bytes.clone();
                bad[64 + 4 * (13 + place)..][..4].copy_from_slice(&value.to_le_bytes());
                assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Table(TableError::Finish)), "{value}");
            }
        });
    }
    assert_eq!(FacetTable::of([4, 1], &[0.0; 3]), Err(FinishError::Size));
    // Analytic facets have no table.
    let ggx = Finish::new(Distribution::Ggx, Masking::Correlated, [0.5; 2]).unwrap();
    assert_eq!(ggx.facets(), None);
}

#[test]
fn energy_compensation_is_looked_up_in_bytes_as_in_memory() {
    let ggx = Finish::new(Distribution::Ggx, Masking::Separable, [0.5, 0.25]).unwrap();
    let losses: [f32; Compensation::LEN] = std::array::from_fn(|node| 0.5 - node as f32 / 512.0);
    let finish = ggx.with_compensation(Compensation::of(&losses).unwrap());
    let returned = [0.5, 0.25, 0.125, 1.0, 2.0, 4.0];
    let [reflectance, transmittance]: [Vec<f32>; 2] = [(); 2].map(|()| (0..24).map(|i| 0.04 * i as f32).collect());
    let thickness_nm = [100.0, 250.0];
    let arrays = FilmArrays { reflectance: &reflectance, transmittance: &transmittance, thickness_nm: &thickness_nm };
    let film = FilmTable::new(&arrays, 3, 1.5, Some(finish)).unwrap().with_returned(&returned).unwrap();
    let bytes = written(Contents::Film(film), Precision::Single);
    let Contents::Film(read) = Blob::read(&bytes).unwrap().contents else { panic!("a film") };
    for (wi, wo) in directions().zip(directions().skip(3)) {
        assert_eq!(read.eval_and_pdf(wi, wo, 180.0), film.eval_and_pdf(wi, wo, 180.0));
        let u = [(wi.x + 1.0) / 2.0, (wo.y + 1.0) / 2.0];
        assert_eq!(read.sample(wi, u, 180.0), film.sample(wi, u, 180.0));
    }
    let numbers = 64 + 4 * 48;
    assert_eq!((bytes[36..40].to_vec(), bytes.len()), (vec![8, 0, 0, 0], numbers + 4 * (2 + 2 + 129 + 6)));
    let behind: Vec<u8> = losses.iter().chain(&returned).flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(bytes[numbers + 16..], behind);
    for (place, value, error) in [
        (4, -0.1, TableError::Finish),
        (132, 1.5, TableError::Finish),
        (4, f32::NAN, TableError::Finish),
        (134, f32::INFINITY, TableError::NotFinite { index: 1 }),
    ] {
        let mut bad = bytes.clone();
        bad[numbers + 4 * place..][..4].copy_from_slice(&value.to_le_bytes());
        assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Table(error)), "{place} {value}");
    }
    let mut bad = bytes.clone();
    bad[36] = 2;
    assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Dimensions));
    let mut bad = bytes;
    bad[36] = 13;
    assert_eq!(Blob::read(&resealed(bad)).map(drop), Err(BlobError::Field { offset: 36 }));
}
