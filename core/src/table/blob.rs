//! Tables as bytes, for run time: a [`MirrorTable`], a [`FilmTable`], a [`ScatterTable`] with its [`ScatterSampler`],
//! or an [`OrderTable`].
//!
//! [`Blob::read`] checks the bytes once and borrows them; nothing is copied. The bytes need no alignment.
//!
//! # Format, version 1
//!
//! Little endian throughout; offsets and sizes in bytes.
//!
//! | offset | size | holds |
//! |---|---|---|
//! | 0 | 8 | magic: 89 47 4F 4E 49 0D 0A 1A (hexadecimal; "GONI" between bytes that text conversion damages) |
//! | 8 | 4 | u32 version: 1 |
//! | 12 | 4 | u32 kind: 1 mirror, 3 orders, 4 scatter, 5 film |
//! | 16 | 4 | u32 bytes of a value: 4 for IEEE 754 binary32, 2 for binary16 |
//! | 20 | 4 | u32 channels C, at least 1; the first three are linear red, green, blue; orders: number of orders |
//! | 24 | 4 | u32 rows T: mirror and film: angles, at least 2; scatter: rows of incident directions; orders: nodes along β |
//! | 28 | 4 | u32 columns P of incident directions; mirror: 1; film: thicknesses; orders: nodes along α |
//! | 32 | 4 | u32 nodes U of half vectors along x; mirror: 1; film: 1 reflectance, 2 transmittance too; orders: number of wavelengths N |
//! | 36 | 4 | u32 nodes V along y; mirror: 1; film: u8 finish, 0 none, 1 GGX, 2 GGX with separable masking, 3 and 4 Beckmann, 5 and 6 tabulated facets likewise, 7 to 12 these six with energy compensation; tabulated facets: u8 sectors S and u16 rings K, else 0; orders: axes along which the surface repeats, 1 x, 2 y, 3 both |
//! | 40 | 8 | f64 largest angle in radians, in (0, π/2]; scatter: u32 number of lobes L, u16 knots K_u and K_v of the warp; orders: two binary32, the periods along x and y in nm |
//! | 48 | 8 | u64 size of the whole blob |
//! | 56 | 4 | u32 colour space of the first three channels, or of the RGB weights of orders: 0 unknown, 1 linear sRGB, 2 linear Rec. 2020, 3 ACEScg, 4 the paper's matrix ([`RgbSpace`]) |
//! | 60 | 4 | u32 CRC-32 (of zlib, PNG and Ethernet) of all other bytes: those from 0 to 59, then those from 64 to the end |
//! | 64 | T·C values; film: U·P·T·C; scatter: T·P·(U·V + L)·C; orders: N·T·P·C | mirror: ρ, `[angle][channel]`; film: ρ, then the transmittance, `[thickness][angle][channel]`; scatter: s = f cos θ_i cos θ_o in 1/sr at the nodes, x fastest, then ρ of the lobes, `[incident][place][channel]`; orders: strengths, `[wavelength][node][order]` |
//! | | 0 to 3 | zeros, up to a multiple of 4 |
//! | | 4·(2·(K_u + K_v) + 10·L + T·P·(1 + V + U·V)) | scatter only: binary32: normalised density and integral at each knot over u, then over v; index and matrix of each lobe, by columns ([`FacetLobe`]); for each incident direction: what it reflects without lobes, the mean of \|s\| over channels summed over the square, over cos θ_i; V cumulative probabilities of the rows of nodes; in each row, U cumulative probabilities of its nodes |
//! | | 4·(2·C + 5·N) | orders only: binary32: m and n of each order; N vacuum wavelengths in nm; N refractive indices of the medium above; three RGB weights of each wavelength |
//! | | 4·P, 4·(P + 2) with a finish, or 4·(P + F) with tabulated facets; 4·(129 + P·C) more with energy compensation | film only: binary32: thicknesses in nm; roughness α along x and along y, or the facets; losses of facets at cos θ = (i/128)², then what several bounces return, `[thickness][channel]` |
//!
//! Angle t of a mirror or film is t/(T − 1) of the largest. Thicknesses of films increase, from 0 to 10⁹ nm; where none
//! varies there is one, of any size. Roughnesses are from 0.001 to 1. Values are finite and their magnitudes at most
//! 10³⁰, so that interpolated values are finite too.
//!
//! Tabulated facets ([`FacetTable`](crate::microfacet::FacetTable)) have 1 to 1024 rings, and 1 or 4 to 128 sectors.
//! Their F numbers are, with S' = 1 and S" = 1 for one sector, else S' = S + 1 and S" = S + 3:
//!
//! | numbers | hold |
//! |---|---|
//! | (K + 1)·S' | D at sin²θ_m = (k/K)⁴ and φ_m = 2π j/S, `[ring][sector]`, each ring's first number repeated at its end |
//! | 257·S" | squared roughness e that directions of cos θ = (i/256)² see, `[i][sector]`, from the last sector on, with the first two repeated at the end; the visible area is (cos θ + √(cos²θ + e sin²θ))/2 |
//! | K + 1 | probability of normals within each ring |
//! | (K + 1)·S | mean of D in each sector, between this azimuth and the next, summed up to it |
//!
//! D is linear in sin²θ_m and φ_m, e is linear in √cos θ and cubic (Catmull & Rom) in φ. Magnitudes are at most 10¹⁸, D
//! is not negative.
//!
//! With energy compensation ([`Compensation`](crate::microfacet::Compensation)), losses are from 0 to 1 and linear in
//! √cos θ. f has a further part: both directions' losses times what several bounces return, in 1/sr.
//!
//! Incident directions and nodes are those of [`ScatterLayout`], columns running fastest; the warp is
//! [`HalfVectorWarp`]'s. Scatter sides are at most 1024, T and U at least 2; knots are from 2 to 1025. The first number
//! of an incident direction is in [0, 4·10³²]. Cumulative probabilities do not decrease and end in exactly 1. Densities
//! of the warp are 0.001 at least; its integrals increase from 0 to exactly 1, and differ from trapezia of the
//! densities by 3·2⁻²³ at most.
//!
//! The nodes of orders are those of [`OrderLayout`], α running fastest; [`OrderTable`] says what strengths are and how
//! they are looked up. Sides are from 2 to 1024, and there are at most 2²⁰ orders. Strengths are not negative. m and n
//! are whole numbers up to 10⁶, and 0 along an axis along which the surface does not repeat. Periods, wavelengths and
//! indices are positive, and wavelengths increase.
//!
//! Nothing follows the last section. A reader refuses bytes that break any of these rules. Kind 2 held scatter tables
//! of fixed outgoing bins before version 0.2; it is refused as [`BlobError::Retired`]. A reader that does not know
//! kinds 3, 4 or 5 refuses them for their kind.

use super::blob_error::VERSION;
use super::blob_finish::FinishField;
use super::film::FilmTable;
use super::layout::ScatterLayout;
use super::lobe::FacetLobe;
use super::mirror::MirrorTable;
use super::order_layout::{OrderLayout, Periodicity};
use super::orders::OrderTable;
use super::sampler::ScatterSampler;
use super::scatter::ScatterTable;
use super::warp::HalfVectorWarp;
use crate::colour::RgbSpace;
use crate::values::{Values, half_is_finite, to_half};
use crc32fast::Hasher;

pub use super::blob_error::BlobError;

/// First bytes of every blob.
const MAGIC: [u8; 8] = *b"\x89GONI\r\n\x1a";
/// Size of the header in bytes.
const HEADER: usize = 64;
/// Offset of the checksum.
const CHECKSUM: usize = 60;
/// Number of a mirror-like table's kind.
const MIRROR: u32 = 1;
/// Number of the kind of scatter tables in fixed outgoing bins, which are no longer read.
const RETIRED: u32 = 2;
/// Number of the kind of a table of diffraction orders.
const ORDERS: u32 = 3;
/// Number of a scatter table's kind.
const SCATTER: u32 = 4;
/// Number of a film table's kind.
const FILM: u32 = 5;
/// Periodicities in the order of their numbers, from 1.
const PERIODICITIES: [Periodicity; 3] = [Periodicity::X, Periodicity::Y, Periodicity::Both];

/// Number of a colour space in a blob's header; 0 if the space is unknown.
#[must_use]
pub fn space_number(space: Option<RgbSpace>) -> u32 {
    match space {
        None => 0,
        Some(RgbSpace::Srgb) => 1,
        Some(RgbSpace::Rec2020) => 2,
        Some(RgbSpace::AcesCg) => 3,
        Some(RgbSpace::Paper) => 4,
    }
}

/// Colour space of a number in a blob's header; `None` if the number has no meaning.
fn space_of_number(number: u32) -> Option<Option<RgbSpace>> {
    let spaces = [None, Some(RgbSpace::Srgb), Some(RgbSpace::Rec2020), Some(RgbSpace::AcesCg), Some(RgbSpace::Paper)];
    spaces.into_iter().find(|&space| space_number(space) == number)
}

/// Number format of a blob's values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// IEEE 754 binary32: values are unchanged.
    #[default]
    Single,
    /// IEEE 754 binary16: values are rounded by at most 5e-4 of their magnitude, or 3e-8; magnitudes up to 65504.
    Half,
}

/// Table of a blob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contents<'a> {
    /// Table of a mirror-like surface.
    Mirror(MirrorTable<'a>),
    /// Table of a mirror-like surface with a transmittance, a thickness that varies, or a finish.
    Film(FilmTable<'a>),
    /// Table of a surface that reflects into every direction, with its importance sampler.
    Scatter(ScatterTable<'a>, ScatterSampler<'a>),
    /// Table of the diffraction orders of a periodic surface.
    Orders(OrderTable<'a>),
}

/// Table and colour space that have been read from bytes, or are to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob<'a> {
    /// Linear colour space of the first three channels, or of the RGB weights of orders; `None` if it is unknown.
    pub space: Option<RgbSpace>,
    /// The table.
    pub contents: Contents<'a>,
}

/// Header fields that determine the size of a blob.
#[derive(Clone, Copy)]
struct Dimensions {
    kind: u32,
    value_bytes: u32,
    channels: u32,
    /// Sides T, P, U and V; of orders T, P, N and the periodicity.
    sides: [u32; 4],
    /// Eight bytes from 40 on: the largest angle, the lobes and knots, or the periods.
    extent: u64,
}

impl Dimensions {
    /// Number of values; `None` beyond 64 bits.
    fn count(&self) -> Option<u64> {
        let [rows, columns, third, fourth] = self.sides.map(u64::from);
        let places = match self.kind {
            SCATTER => third.checked_mul(fourth)?.checked_add(self.lobes())?,
            _ => third,
        };
        [columns, places, self.channels.into()].iter().try_fold(rows, |n, &side| n.checked_mul(side))
    }

    /// Number of lobes of a scatter table.
    fn lobes(&self) -> u64 {
        self.extent & 0xffff_ffff
    }

    /// Numbers of knots of a scatter table's warp.
    fn knots(&self) -> [u64; 2] {
        [self.extent >> 32 & 0xffff, self.extent >> 48]
    }

    /// Sizes of the two sections in bytes: values with their padding, and sampler or axes of orders; `None` beyond 64
    /// bits.
    fn sections(&self) -> Option<[u64; 2]> {
        let [rows, columns, third, fourth] = self.sides.map(u64::from);
        let values = self.count()?.checked_mul(self.value_bytes.into())?.checked_next_multiple_of(4)?;
        let numbers = match self.kind {
            MIRROR => 0,
            FILM => {
                let finish = FinishField::of(self.sides[3])?;
                let returned = if finish.is_compensated() { columns.checked_mul(self.channels.into())? } else { 0 };
                returned.checked_add(columns + finish.numbers() as u64)?
            }
            // Sums of products of 32 bits.
            ORDERS => 2 * u64::from(self.channels) + 5 * third,
            _ => {
                let of_incident = third.checked_mul(fourth)?.checked_add(1 + fourth)?;
                let sampler = rows.checked_mul(columns)?.checked_mul(of_incident)?;
                let [knots_u, knots_v] = self.knots();
                sampler.checked_add(2 * (knots_u + knots_v) + FacetLobe::LEN as u64 * self.lobes())?
            }
        };
        Some([values, numbers.checked_mul(4)?])
    }

    /// Size of the whole blob in bytes; `None` beyond 64 bits.
    fn blob_len(&self) -> Option<u64> {
        let [values, sampler] = self.sections()?;
        values.checked_add(sampler)?.checked_add(HEADER as u64)
    }
}

/// Little-endian number at an offset that is a multiple of 4.
fn u32_at(bytes: &[u8; HEADER], offset: usize) -> u32 {
    let (fields, _) = bytes.as_chunks::<4>();
    fields.get(offset / 4).map_or(0, |&field| u32::from_le_bytes(field))
}

/// Little-endian number at an offset that is a multiple of 8.
fn u64_at(bytes: &[u8; HEADER], offset: usize) -> u64 {
    let (fields, _) = bytes.as_chunks::<8>();
    fields.get(offset / 8).map_or(0, |&field| u64::from_le_bytes(field))
}

/// CRC-32 of all bytes but the checksum itself.
fn checksum(header: &[u8; HEADER], payload: &[u8]) -> u32 {
    let mut hasher = Hasher::new();
    hasher.update(header.get(..CHECKSUM).unwrap_or(header));
    hasher.update(payload);
    hasher.finalize()
}

impl<'a> Blob<'a> {
    /// Checks all bytes of a blob and borrows them. Nothing that they contain can make a later look-up fail or panic.
    ///
    /// # Errors
    /// [`BlobError::Magic`], [`BlobError::Version`], [`BlobError::Length`] and [`BlobError::Checksum`] if the bytes are
    /// not a whole, undamaged blob of this version; [`BlobError::Field`], [`BlobError::Dimensions`],
    /// [`BlobError::Table`] and [`BlobError::Range`] if what they describe breaks a rule of the format.
    pub fn read(bytes: &'a [u8]) -> Result<Self, BlobError> {
        let Some((header, payload)) = bytes.split_first_chunk::<HEADER>() else {
            let begins = bytes.iter().zip(MAGIC).all(|(&byte, magic)| byte == magic);
            return Err(if begins { BlobError::Length { required: HEADER as u64 } } else { BlobError::Magic });
        };
        if !header.starts_with(&MAGIC) {
            return Err(BlobError::Magic);
        }
        let word = |offset| u32_at(header, offset);
        if word(8) != VERSION {
            return Err(BlobError::Version { found: word(8) });
        }
        let required = u64_at(header, 48);
        if bytes.len() as u64 != required {
            return Err(BlobError::Length { required });
        }
        if checksum(header, payload) != word(CHECKSUM) {
            return Err(BlobError::Checksum);
        }
        let dimensions = Dimensions {
            kind: word(12),
            value_bytes: word(16),
            channels: word(20),
            sides: [word(24), word(28), word(32), word(36)],
            extent: u64_at(header, 40),
        };
        let space = space_of_number(word(56)).ok_or(BlobError::Field { offset: 56 })?;
        Ok(Self { space, contents: contents(dimensions, payload)? })
    }

    /// Size of the blob in bytes, which [`Blob::write`] needs; `None` if it is beyond the size of memory.
    #[must_use]
    pub fn required_len(&self, precision: Precision) -> Option<usize> {
        usize::try_from(self.dimensions(precision)?.blob_len()?).ok()
    }

    /// Writes the blob to `bytes`, which are [`Blob::required_len`] long.
    ///
    /// # Errors
    /// [`BlobError::Length`] if `bytes` has another length, [`BlobError::Dimensions`] if the table is too large for the
    /// format, and [`BlobError::Range`] for a value that half precision cannot represent.
    pub fn write(&self, precision: Precision, bytes: &mut [u8]) -> Result<(), BlobError> {
        let dimensions = self.dimensions(precision).ok_or(BlobError::Dimensions)?;
        let required = dimensions.blob_len().ok_or(BlobError::Dimensions)?;
        let wrong = BlobError::Length { required };
        if bytes.len() as u64 != required {
            return Err(wrong);
        }
        let (header, payload) = bytes.split_first_chunk_mut::<HEADER>().ok_or(wrong)?;
        // The first section has up to two parts, the last up to four.
        let nothing = Values::Numbers(&[]);
        let mut alpha = [0.0; 2];
        let (values, numbers) = match &self.contents {
            Contents::Mirror(table) => ([table.values(), nothing], [nothing; 4]),
            Contents::Film(table) => {
                let finish = table.finish();
                alpha = finish.and_then(|finish| finish.alpha()).unwrap_or(alpha);
                let of_finish = match finish.map(|finish| finish.facets()) {
                    None => nothing,
                    Some(None) => Values::Numbers(&alpha),
                    Some(Some(facets)) => facets.values(),
                };
                let losses = finish.and_then(|finish| finish.compensation()).map_or(nothing, |losses| losses.values());
                (table.values(), [table.thickness_values(), of_finish, losses, table.returned_values()])
            }
            Contents::Scatter(table, sampler) => {
                let [u, v] = table.warp().values();
                ([table.values(), nothing], [u, v, table.lobe_numbers(), sampler.values()])
            }
            Contents::Orders(table) => ([table.strengths(), nothing], table.axes()),
        };
        let values = values.into_iter().flat_map(Values::iter);
        payload.fill(0);
        let [value_bytes, _] = dimensions.sections().ok_or(BlobError::Dimensions)?;
        let (value_bytes, number_bytes) = payload.split_at_mut_checked(value_bytes as usize).ok_or(wrong)?;
        match precision {
            Precision::Single => write_singles(values, value_bytes),
            Precision::Half => {
                for (index, (value, bytes)) in values.zip(value_bytes.as_chunks_mut().0).enumerate() {
                    *bytes = to_half(value).ok_or(BlobError::Range { index })?.to_le_bytes();
                }
            }
        }
        write_singles(numbers.into_iter().flat_map(Values::iter), number_bytes);
        let [rows, columns, third, fourth] = dimensions.sides;
        let words =
            [VERSION, dimensions.kind, dimensions.value_bytes, dimensions.channels, rows, columns, third, fourth];
        header[..8].copy_from_slice(&MAGIC);
        for (word, place) in words.into_iter().zip(header[8..40].as_chunks_mut().0) {
            *place = word.to_le_bytes();
        }
        header[40..48].copy_from_slice(&dimensions.extent.to_le_bytes());
        header[48..56].copy_from_slice(&required.to_le_bytes());
        header[56..CHECKSUM].copy_from_slice(&space_number(self.space).to_le_bytes());
        let checksum = checksum(header, payload);
        header[CHECKSUM..].copy_from_slice(&checksum.to_le_bytes());
        Ok(())
    }

    fn dimensions(&self, precision: Precision) -> Option<Dimensions> {
        let value_bytes = match precision {
            Precision::Single => 4,
            Precision::Half => 2,
        };
        let (kind, channels, sides, extent) = match &self.contents {
            Contents::Mirror(table) => {
                let sides = [u32::try_from(table.rows()).ok()?, 1, 1, 1];
                (MIRROR, table.channels(), sides, table.theta_max().to_bits())
            }
            Contents::Film(table) => {
                let quantities = if table.is_transparent() { 2 } else { 1 };
                let [angles, thicknesses] = [table.angles(), table.thicknesses()].map(|n| u32::try_from(n).ok());
                let sides = [angles?, thicknesses?, quantities, FinishField::field(table.finish())];
                (FILM, table.channels(), sides, table.theta_max().to_bits())
            }
            Contents::Scatter(table, _) => {
                let layout = table.layout();
                let ([rows, columns], [u, v]) = (layout.incident_sides(), layout.square_sides());
                // Both are at most 1025.
                let [knots_u, knots_v] = table.warp().knots().map(|knots| knots as u64);
                let extent = knots_v << 48 | knots_u << 32 | layout.lobes() as u64;
                (SCATTER, table.channels(), [rows, columns, u, v], extent)
            }
            Contents::Orders(table) => {
                let layout = table.layout();
                let [alpha, beta] = layout.nodes();
                let periodicity = PERIODICITIES.iter().zip(1..).find(|(p, _)| **p == layout.periodicity());
                let wavelengths = u32::try_from(table.wavelength_count()).ok()?;
                let sides = [beta, alpha, wavelengths, periodicity?.1];
                (ORDERS, table.order_count(), sides, period_bits(layout.period_nm()))
            }
        };
        Some(Dimensions { kind, value_bytes, channels: u32::try_from(channels).ok()?, sides, extent })
    }
}

/// Periods as the eight bytes of the header that hold the largest angle of other tables.
fn period_bits([x, y]: [f32; 2]) -> u64 {
    u64::from(y.to_bits()) << 32 | u64::from(x.to_bits())
}

/// Checks the table that a header describes, in the bytes after the header.
fn contents(dimensions: Dimensions, payload: &[u8]) -> Result<Contents<'_>, BlobError> {
    let field = |offset| Err(BlobError::Field { offset });
    if dimensions.kind == RETIRED {
        return Err(BlobError::Retired);
    }
    if !(MIRROR..=FILM).contains(&dimensions.kind) {
        return field(12);
    }
    if !(dimensions.value_bytes == 2 || dimensions.value_bytes == 4) {
        return field(16);
    }
    let Dimensions { sides: [rows, columns, third, fourth], extent, .. } = dimensions;
    if dimensions.kind == MIRROR && [columns, third, fourth] != [1; 3] {
        return field(28);
    }
    if dimensions.kind == FILM && !(1..=2).contains(&third) {
        return field(32);
    }
    let finish = match (dimensions.kind, FinishField::of(fourth)) {
        (FILM, None) => return field(36),
        (FILM, Some(finish)) => finish,
        _ => FinishField::Smooth,
    };
    let [value_bytes, number_bytes] = dimensions.sections().ok_or(BlobError::Dimensions)?;
    if value_bytes.checked_add(number_bytes) != Some(payload.len() as u64) {
        return Err(BlobError::Dimensions);
    }
    // From here on every product of the dimensions is at most the size of memory.
    let (bytes, numbers) = payload.split_at_checked(value_bytes as usize).ok_or(BlobError::Dimensions)?;
    let count = dimensions.count().ok_or(BlobError::Dimensions)? as usize;
    let values = values(bytes, dimensions.value_bytes, count)?;
    let numbers = Values::Single(numbers.as_chunks().0);
    let channels = dimensions.channels as usize;
    match dimensions.kind {
        MIRROR => Ok(Contents::Mirror(MirrorTable::of(values, channels, f64::from_bits(extent))?)),
        FILM => {
            let of_one = if third == 1 { values.len() } else { values.len() / 2 };
            let quantities = [values.part(0, of_one), values.part(of_one, values.len() - of_one)];
            let columns = columns as usize;
            let of_finish = numbers.part(columns, finish.numbers());
            let thickness_nm = numbers.part(0, columns);
            let surface = finish.finish(of_finish)?;
            let mut table = FilmTable::of(quantities, thickness_nm, channels, f64::from_bits(extent), surface)?;
            if finish.is_compensated() {
                let before = columns + of_finish.len();
                table.set_returned(numbers.part(before, numbers.len() - before))?;
            }
            Ok(Contents::Film(table))
        }
        SCATTER => {
            let layout = ScatterLayout::new([rows, columns], [third, fourth], dimensions.lobes() as u32)?;
            // Parts of the numbers, whose sizes are at most that of memory.
            let [of_u, of_v] = dimensions.knots().map(|knots| 2 * knots as usize);
            let of_lobes = FacetLobe::LEN * layout.lobes();
            let warp = HalfVectorWarp::of([numbers.part(0, of_u), numbers.part(of_u, of_v)])?;
            let lobes = numbers.part(of_u + of_v, of_lobes);
            let table = ScatterTable::of(values, layout, warp, lobes, channels)?;
            let from = of_u + of_v + of_lobes;
            let sampler = ScatterSampler::of(numbers.part(from, numbers.len() - from), &table)?;
            Ok(Contents::Scatter(table, sampler))
        }
        _ => {
            let Some((&periodicity, _)) = PERIODICITIES.iter().zip(1..).find(|(_, number)| *number == fourth) else {
                return field(36);
            };
            let period_nm = [extent as u32, (extent >> 32) as u32].map(f32::from_bits);
            let layout = OrderLayout::new([columns, rows], periodicity, period_nm)?;
            Ok(Contents::Orders(OrderTable::from_parts(layout, values, numbers, channels, third as usize)?))
        }
    }
}

/// Borrows `count` finite values, and checks the padding after them.
fn values(bytes: &[u8], value_bytes: u32, count: usize) -> Result<Values<'_>, BlobError> {
    if value_bytes == 4 {
        return Ok(Values::Single(bytes.as_chunks().0));
    }
    let (halves, padding) = bytes.as_chunks().0.split_at_checked(count).ok_or(BlobError::Dimensions)?;
    // Infinite half-precision numbers would read as large finite ones.
    if let Some(index) = halves.iter().position(|&half| !half_is_finite(u16::from_le_bytes(half))) {
        return Err(BlobError::Range { index });
    }
    match padding.iter().all(|&zero| zero == [0; 2]) {
        true => Ok(Values::Half(halves)),
        false => Err(BlobError::Field { offset: HEADER + 2 * count }),
    }
}

/// Writes values in single precision.
fn write_singles(values: impl Iterator<Item = f32>, bytes: &mut [u8]) {
    for (value, bytes) in values.zip(bytes.as_chunks_mut().0) {
        *bytes = value.to_le_bytes();
    }
}
