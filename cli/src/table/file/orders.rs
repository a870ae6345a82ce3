//! Files of tables of diffraction orders: one tile for each order, stacked from the top.
//!
//! The image is A pixels wide and K·B high for A × B directions towards the light ([`OrderLayout`]) and K orders. The
//! tile of order k begins at line k·B. Inside it, x counts α and y counts β, both ascending: pixel (x, k·B + y) belongs
//! to the light from direction (α_x, β_y) and to order k. The unit vector towards that light has the component sin α
//! along the axis of the period (y if the surface repeats along y alone, else x), cos α sin β along the other axis and
//! cos α cos β along the normal z.
//!
//! | channel | holds |
//! |---|---|
//! | `T.550,000000nm` | strength of the reflected order at a wavelength, unpolarised: the mean of the next two |
//! | `s.T.550,000000nm`, `p.T.550,000000nm` | strength of the reflected order for light in s and in p |
//! | `transmitted.s.T.550,000000nm`, `transmitted.p.T.550,000000nm` | strengths of the transmitted order; 0 where there is none |
//! | `error.T.550,000000nm` | error bar of each efficiency of this direction, by the truncation of the waves: equal for all orders |
//!
//! | attribute `goniochrome.` | holds |
//! |---|---|
//! | `kind` | `orders` |
//! | `periodicity` | `x`, `y` or `both`: the axes along which the surface repeats |
//! | `period_nm` | the periods Λx and Λy; that of an axis along which the surface does not vary has no meaning |
//! | `alpha_deg` | the A angles α: uniform from −89 to 89 |
//! | `beta_deg` | the B angles β: uniform from −89 to 89; from 0 to 89 for `x` and `y`, where −β is equal to β |
//! | `orders` | m and n of each of the K orders, ascending; (0, 0) is among them |
//! | `wavelength_nm` | the W vacuum wavelengths, ascending, at full precision |
//! | `index_above` | the refractive index of the medium above at each wavelength |
//! | `index_below` | that of the medium below; 0 where it is opaque |
//!
//! Light from `wi` at the vacuum wavelength λ leaves in order (m, n) with the tangential components
//! wo_t = −(η_a/η) wi_t + (λ/η) (m/Λx, n/Λy), where η_a is the index above and η that of the side where it leaves. The
//! term of an axis along which the surface does not vary is 0, and so is its number. The order travels if |wo_t| < 1,
//! and then cos θ_o = √(1 − |wo_t|²). Its efficiency, the power through a plane parallel to the surface as a share of
//! the power that arrives through it, is
//!
//! e = strength · 4 k_i k_o/(k_i + k_o)²,
//!
//! with k_i = η_a cos θ_i, cos θ_i = cos α cos β, and k_o = η cos θ_o. The factor is 1 for the reflected order (0, 0).
//!
//! Interpolate strengths, not efficiencies: e has a kink where an order begins, the strength is smooth there. That is
//! why there are strengths of orders that do not travel. No light leaves in these.
//!
//! Numbers in attributes are decimal, separated by spaces. Each is the shortest that reads back exactly: periods in
//! single precision, the rest in double. Blocks of 16 lines are ZIP-compressed. `tests/python/read_table.py` reads all
//! of it in a few lines of NumPy.

use exr::prelude::Compression;
use goniochrome::simd::complex::Polarised;
use goniochrome::table::{OrderLayout, Periodicity};

use super::container::{Contents, KIND, Opened, PREFIX, WAVELENGTH, channel_names, format_numbers};
use super::lazy_channel::LazyChannel;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::orders::{OrderTable, check_order_size};

/// Value of the attribute `kind`.
pub(super) const ORDERS: &str = "orders";
const NUMBERS: &str = "orders";
const PERIODICITY: &str = "periodicity";
const PERIOD: &str = "period_nm";
const AXES: [&str; 2] = ["alpha_deg", "beta_deg"];
const ABOVE: &str = "index_above";
const BELOW: &str = "index_below";
const PERIODICITIES: [(&str, Periodicity); 3] =
    [("x", Periodicity::X), ("y", Periodicity::Y), ("both", Periodicity::Both)];

/// Width and height of the image.
fn size(layout: &OrderLayout, orders: usize) -> (usize, usize) {
    let [width, height] = layout.nodes().map(|nodes| nodes as usize);
    (width, height * orders)
}

/// Names of the channels of one wavelength: reflected s and p, transmitted s and p, error bar.
fn names(unpolarised: &str) -> [String; 5] {
    ["s", "p", "transmitted.s", "transmitted.p", "error"].map(|layer| format!("{layer}.{unpolarised}"))
}

/// Angles α and β, as [`AXES`] names them.
fn axes(layout: &OrderLayout) -> [String; 2] {
    // Fractions of whole numbers of degrees, without the rounding of radians.
    let [alpha, beta] = layout.nodes().map(|nodes| f64::from(nodes - 1));
    let centred = |steps: f64| format_numbers((0..=steps as u32).map(|i| 89.0 * (2.0 * f64::from(i) - steps) / steps));
    let from_zero = |steps: f64| format_numbers((0..=steps as u32).map(|i| 89.0 * f64::from(i) / steps));
    [centred(alpha), if layout.periodicity().has_lines() { from_zero(beta) } else { centred(beta) }]
}

/// Encodes a table as an EXR file.
///
/// # Errors
/// A table that [`OrderTable::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too close
/// for names of channels.
pub fn encode<'t>(table: &'t OrderTable, threads: usize) -> Result<Vec<u8>> {
    table.check()?;
    let layout = &table.layout;
    let (nodes, orders) = (layout.count(), table.orders.len());
    let mut channels = Vec::new();
    for (w, name) in channel_names(&table.wavelength_nm)?.into_iter().enumerate() {
        // Pixels are ordered as `[order][node]`, values as `[node][order]`.
        let place = move |pixel: usize| table.first(w, pixel % nodes) + pixel / nodes;
        let values = |values: &'t [f32]| LazyChannel::new(move |pixel| values[place(pixel)]);
        let [s, p, transmitted_s, transmitted_p, error] = names(&name);
        let reflected = &table.reflected;
        let mean = move |pixel| 0.5 * (reflected.s[place(pixel)] + reflected.p[place(pixel)]);
        channels.extend([
            (name, LazyChannel::new(mean)),
            (s, values(&reflected.s)),
            (p, values(&reflected.p)),
            (transmitted_s, values(&table.transmitted.s)),
            (transmitted_p, values(&table.transmitted.p)),
            (error, LazyChannel::new(move |pixel| table.error[w * nodes + pixel % nodes])),
        ]);
    }
    let periodicity = PERIODICITIES.iter().find(|(_, periodicity)| *periodicity == layout.periodicity());
    let [alpha, beta] = axes(layout);
    let attributes = [
        (KIND, ORDERS.to_owned()),
        (PERIODICITY, periodicity.map_or("both", |(name, _)| name).to_owned()),
        (PERIOD, format_numbers(layout.period_nm())),
        (AXES[0], alpha),
        (AXES[1], beta),
        (NUMBERS, format_numbers(table.orders.as_flattened())),
        (WAVELENGTH, format_numbers(&table.wavelength_nm)),
        (ABOVE, format_numbers(&table.index_above)),
        (BELOW, format_numbers(&table.index_below)),
    ];
    let attributes = attributes.map(|(key, value)| (key.to_owned(), value)).into();
    let mut contents = Contents { size: size(layout, orders), compression: Compression::ZIP16, channels, attributes };
    contents.add_metadata(&table.metadata)?;
    contents.encode(threads)
}

/// Removes the attributes of the layout and checks that they belong to one.
fn layout(file: &mut Opened<'_>) -> Result<OrderLayout> {
    let named = file.take(PERIODICITY)?;
    let Some(&(_, periodicity)) = PERIODICITIES.iter().find(|(name, _)| *name == named) else {
        return Err(Error::failed(format_args!("{PREFIX}{PERIODICITY} is \"{named}\" where x, y or both belongs")));
    };
    let period_nm = file.take_numbers::<f32>(PERIOD)?.try_into();
    let period_nm = period_nm.map_err(|_| Error::failed(format_args!("{PREFIX}{PERIOD} must hold two numbers")))?;
    let found = [file.take(AXES[0])?, file.take(AXES[1])?];
    let nodes = [0, 1].map(|axis| u32::try_from(found[axis].split_whitespace().count()).unwrap_or(u32::MAX));
    let layout = OrderLayout::new(nodes, periodicity, period_nm).map_err(|_| {
        Error::failed(format_args!(
            "the periods must be positive, and {PREFIX}{} and {PREFIX}{} hold 2 to 1024 angles each",
            AXES[0], AXES[1]
        ))
    })?;
    for ((key, found), expected) in AXES.into_iter().zip(found).zip(axes(&layout)) {
        if found != expected {
            return Err(Error::failed(format_args!(
                "{PREFIX}{key} is not uniform as this version expects: {expected}"
            )));
        }
    }
    Ok(layout)
}

/// Decodes the table in a file of this kind.
pub(super) fn decode(mut file: Opened<'_>) -> Result<OrderTable> {
    let layout = layout(&mut file)?;
    let numbers: Vec<i32> = file.take_numbers(NUMBERS)?;
    let (orders, []) = numbers.as_chunks::<2>() else {
        return Err(Error::failed(format_args!("{PREFIX}{NUMBERS} must hold two numbers for each order")));
    };
    let wavelength_nm: Vec<f64> = file.take_numbers(WAVELENGTH)?;
    check_order_size(&layout, orders.len(), wavelength_nm.len())?;
    let unpolarised = channel_names(&wavelength_nm)?;
    file.expect(size(&layout, orders.len()), 6 * unpolarised.len())?;
    let (index_above, index_below) = (file.take_numbers(ABOVE)?, file.take_numbers(BELOW)?);

    let mut channels = file.pixels()?;
    let (nodes, count) = (layout.count(), layout.count() * orders.len());
    let strengths = || filled(0.0, count * unpolarised.len(), "the table");
    let mut arrays = [strengths()?, strengths()?, strengths()?, strengths()?];
    let mut error = filled(0.0, nodes * unpolarised.len(), "the table")?;
    for (w, name) in unpolarised.iter().enumerate() {
        channels.take(name)?;
        let names = names(name);
        for (array, name) in arrays.iter_mut().zip(&names) {
            let image = channels.take(name)?;
            for (pixel, value) in image.into_iter().enumerate() {
                array[w * count + pixel % nodes * orders.len() + pixel / nodes] = value;
            }
        }
        let image = channels.take(&names[4])?;
        let bars = &mut error[w * nodes..][..nodes];
        bars.copy_from_slice(&image[..nodes]);
        if image.chunks(nodes).any(|tile| *tile != *bars) {
            return Err(Error::failed(format_args!("the channel {} is not equal for all orders", names[4])));
        }
    }
    let [s, p, transmitted_s, transmitted_p] = arrays;
    let table = OrderTable {
        layout,
        orders: orders.to_vec(),
        wavelength_nm,
        index_above,
        index_below,
        reflected: Polarised { s, p },
        transmitted: Polarised { s: transmitted_s, p: transmitted_p },
        error,
        metadata: file.attributes.into(),
    };
    table.check()?;
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::super::{decode, encode};
    use super::*;
    use crate::table::Table;
    use crate::table::orders::tests::sample;

    /// Two periods, nine orders, nodes of an even and an odd number, metadata.
    fn crossed() -> OrderTable {
        let layout = OrderLayout::new([4, 3], Periodicity::Both, [700.1, 1e3 / 3.0]).unwrap();
        let orders: Vec<_> = (-1..=1).flat_map(|m| (-1..=1).map(move |n| [m, n])).collect();
        let wavelength_nm = vec![435.833_333, 550.0, 700.0];
        let count = layout.count() * orders.len() * wavelength_nm.len();
        let strengths = |seed: usize| (0..count).map(|i| (i * 37 % 101 + seed) as f32 / 97.0).collect::<Vec<_>>();
        let mut table = OrderTable {
            layout,
            orders,
            index_above: vec![1.33, 1.32, 1.0 / 3.0 + 1.0],
            index_below: vec![1.5, 0.0, 1.49],
            reflected: Polarised { s: strengths(0), p: strengths(1) },
            transmitted: Polarised { s: strengths(2), p: strengths(3) },
            error: (0..layout.count() * wavelength_nm.len()).map(|i| i as f32 * 1e-5).collect(),
            wavelength_nm,
            ..sample()
        };
        table.metadata.insert("scene", "crossed");
        table
    }

    #[test]
    fn a_table_round_trips_exactly_and_gives_equal_bytes() {
        for table in [sample(), crossed()] {
            let bytes = encode(&table.clone().into(), 1).unwrap();
            assert_eq!(decode(&bytes).unwrap(), Table::Orders(table.clone()));
            for threads in [2, 3, 16] {
                assert_eq!(encode(&table.clone().into(), threads).unwrap(), bytes);
            }
        }
        for (periodicity, beta) in [(Periodicity::Y, "0 89"), (Periodicity::Both, "-89 89")] {
            let layout = OrderLayout::new([3, 2], periodicity, [f32::MIN_POSITIVE, 3e38]).unwrap();
            assert_eq!(axes(&layout), ["-89 0 89", beta]);
            let table = Table::Orders(OrderTable { layout, orders: vec![[0, -1], [0, 0], [0, 1]], ..sample() });
            assert_eq!(decode(&encode(&table, 1).unwrap()).unwrap(), table);
        }
    }

    #[test]
    fn tiles_stand_where_the_head_says() {
        let table = crossed();
        let bytes = encode(&table.clone().into(), 1).unwrap();
        let file = Opened::new(&bytes).unwrap();
        assert_eq!((file.size, file.channels), ((4, 27), 18));
        let mut channels = file.pixels().unwrap();
        // α of index 2, β of index 1, order (1, -1), whose index is 6, at the second wavelength.
        let (pixel, place) = ((6 * 3 + 1) * 4 + 2, table.first(1, 4 + 2) + 6);
        let mut at = |name: &str| channels.take(name).unwrap()[pixel];
        assert_eq!(at("s.T.550,000000nm"), table.reflected.s[place]);
        assert_eq!(at("p.T.550,000000nm"), table.reflected.p[place]);
        assert_eq!(at("T.550,000000nm"), table.unpolarised()[place]);
        assert_eq!(at("transmitted.s.T.550,000000nm"), table.transmitted.s[place]);
        assert_eq!(at("transmitted.p.T.550,000000nm"), table.transmitted.p[place]);
        assert_eq!(at("error.T.550,000000nm"), table.error[12 + 4 + 2]);
    }

    #[test]
    fn the_header_names_every_direction() {
        for layout in [sample().layout, crossed().layout] {
            let [alpha, beta] =
                axes(&layout).map(|text| text.split(' ').map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
            assert_eq!([alpha.len(), beta.len()], layout.nodes().map(|n| n as usize));
            for node in 0..layout.count() {
                let angles = layout.angles(node).map(f64::to_degrees);
                let expected = [alpha[node % alpha.len()], beta[node / alpha.len()]];
                // Rounding of radians, in degrees.
                assert!(angles.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{angles:?} {expected:?}");
            }
        }
    }

    fn patched(from: &str, to: &str) -> String {
        assert_eq!(from.len(), to.len());
        let mut bytes = encode(&crossed().into(), 1).unwrap();
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        decode(&bytes).unwrap_err().to_string()
    }

    #[test]
    fn contradictions_are_named() {
        let orders = "-1 -1 -1 0 -1 1 0 -1 0 0 0 1 1 -1 1 0 1 1";
        assert!(patched(orders, "-1 -1 -1 0 -1 1 0 -1 0 0 0 1 1 -1 1 0 101").contains("two numbers for each order"));
        assert!(patched(orders, "-1 -1 -1 0 -1 1 0 -1 0 0 0 1 1 -1 1 0 0 1").contains("do not ascend"));
        assert!(patched(orders, "-1 -1 -1 0 -1 1 0 -1 0 0 0 1 1 -1 1 00011").contains("the image is 4 × 27 where"));
        assert!(patched("both", "boat").contains("goniochrome.periodicity is \"boat\" where x, y or both belongs"));
        assert!(patched("-89 0 89", "-89 1 89").contains("goniochrome.beta_deg is not uniform"));
        assert!(patched("700.1 333.33334", "700.1 -33.33334").contains("the periods must be positive"));
        assert!(patched("700.1 333.33334", "700.1.333.33334").contains("is not a number"));
        assert!(patched("1.33 1.32", "1.33_1.32").contains("goniochrome.index_above"));
        assert!(patched(" 550 700", " 550 701").contains("T.701,000000nm is missing"));
        assert!(patched("error.T.550", "error.T.551").contains("channel error.T.550,000000nm is missing"));
        let mut table = crossed();
        table.metadata.insert("alpha_deg", "x");
        assert!(encode(&table.into(), 1).unwrap_err().to_string().contains("is reserved"));
    }

    #[test]
    fn damaged_files_give_one_line_and_no_panic() {
        crate::table::file::tests::damage(&encode(&sample().into(), 1).unwrap());
    }
}
