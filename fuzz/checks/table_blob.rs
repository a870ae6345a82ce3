//! Fuzzing of table blobs from any bytes. A blob that can be read gives numbers at every look-up, draws directions with
//! the density that it states, and is written again byte for byte.

use glam::Vec3;
use goniochrome::colour::RgbSpace;
use goniochrome::microfacet::{Compensation, Distribution, FacetTable, Finish, Masking};
use goniochrome::table::blob::{Blob, Contents, Precision};
use goniochrome::table::{
    FacetLobe, FilmArrays, FilmTable, HalfVectorWarp, MirrorTable, OrderArrays, OrderLayout, OrderTable, Periodicity,
    ScatterLayout, ScatterSampler, ScatterTable,
};
use goniochrome::trace::random::Random;

const HEADER: usize = 64;
const CHECKSUM: usize = 60;
/// Number of the kind of a table of orders.
const ORDERS: usize = 3;
/// Number of the kind of a scatter table.
const SCATTER: usize = 4;
/// Number of a film table's kind.
const FILM: usize = 5;
/// Largest number of bytes of a blob that is mended or made.
const MAX: usize = 1 << 16;

/// Checks any bytes in three ways: as they are, with size and checksum put right, which no fuzzer guesses, and as the
/// numbers of a table.
pub fn check(bytes: &[u8]) {
    holds(bytes);
    if let Some(mended) = mended(bytes) {
        holds(&mended);
    }
    if let Some(made) = made(bytes) {
        assert!(Blob::read(&made).is_ok(), "what was written is refused");
        holds(&made);
    }
}

/// The bytes with the size that their dimensions ask for, and with the right checksum.
pub fn mended(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = bytes.to_vec();
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
    let (kind, value, channels) = (word(12)?, word(16)?, word(20)?);
    let [rows, columns, third, fourth] = [word(24)?, word(28)?, word(32)?, word(36)?];
    let (lobes, knots) = (word(40)?, (word(44)? & 0xffff) + (word(44)? >> 16));
    let incident = rows.checked_mul(columns)?;
    let nodes = third.checked_mul(if kind == ORDERS || kind == FILM { 1 } else { fourth })?;
    let places = if kind == SCATTER { nodes.checked_add(lobes)? } else { nodes };
    let values =
        incident.checked_mul(places)?.checked_mul(channels)?.checked_mul(value)?.checked_next_multiple_of(4)?;
    let numbers = match kind {
        SCATTER => {
            let sampler = incident.checked_mul(nodes.checked_add(fourth)?.checked_add(1)?)?;
            sampler.checked_add(2 * knots)?.checked_add(lobes.checked_mul(FacetLobe::LEN)?)?
        }
        FILM => {
            let (number, size) = (fourth & 0xff, [fourth >> 16, fourth >> 8 & 0xff]);
            let compensation = if number > 6 { Compensation::LEN + columns.checked_mul(channels)? } else { 0 };
            let of_finish = match number {
                0 => 0,
                1..=4 | 7..=10 => 2,
                _ => FacetTable::required_len(size),
            };
            columns.checked_add(compensation)?.checked_add(of_finish)?
        }
        ORDERS => channels.checked_mul(2)?.checked_add(third.checked_mul(5)?)?,
        _ => 0,
    };
    let size = HEADER.checked_add(values)?.checked_add(numbers.checked_mul(4)?).filter(|size| *size <= MAX)?;
    bytes.resize(size, 0);
    bytes[48..56].copy_from_slice(&(size as u64).to_le_bytes());
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..CHECKSUM]);
    hasher.update(&bytes[HEADER..]);
    bytes[CHECKSUM..HEADER].copy_from_slice(&hasher.finalize().to_le_bytes());
    Some(bytes)
}

/// A blob of the numbers that the bytes spell, in a grid that the first four choose; nothing if no table takes them.
pub fn made(bytes: &[u8]) -> Option<Vec<u8>> {
    let (&[kind, sides, shape, space], numbers) = bytes.split_first_chunk()?;
    let values: Vec<f32> = numbers.as_chunks().0.iter().map(|&bits| f32::from_le_bytes(bits)).collect();
    let channels = 1 + usize::from(kind >> 2 & 3);
    let precision = if kind & 2 == 0 { Precision::Single } else { Precision::Half };
    let is_compensated = space & 0x80 != 0;
    let spaces = [RgbSpace::Srgb, RgbSpace::Rec2020, RgbSpace::AcesCg, RgbSpace::Paper];
    let space = usize::from(space % 5).checked_sub(1).map(|place| spaces[place]);
    let write = |contents| {
        let blob = Blob { space, contents };
        let mut bytes = vec![0; blob.required_len(precision)?];
        blob.write(precision, &mut bytes).ok()?;
        Some(bytes)
    };
    if kind & 0x10 != 0 {
        let periodicity = [Periodicity::X, Periodicity::Y, Periodicity::Both][usize::from(kind >> 5) % 3];
        let nodes = [2 + u32::from(sides & 7), 2 + u32::from(sides >> 3 & 7)];
        let (orders, wavelengths) = (i32::from(1 + (shape & 7)), 1 + usize::from(shape >> 3 & 7));
        let sign = 1.0 - f32::from(shape >> 6 & 2);
        // Orders in a row, along the axis of the period or along a diagonal.
        let number = |k: i32, repeats: bool| if repeats { sign * (k - orders / 2) as f32 } else { 0.0 };
        let number = |k| [number(k, periodicity != Periodicity::Y), number(k, periodicity != Periodicity::X)];
        let orders: Vec<_> = (0..orders).map(number).collect();
        let mut next = values.iter().copied().cycle();
        let layout = OrderLayout::new(nodes, periodicity, [next.next()?, next.next()?]).ok()?;
        let increasing = next.by_ref().take(wavelengths).scan(0.0, |nm, x| {
            *nm += x.abs();
            Some(*nm)
        });
        let wavelength_nm: Vec<f32> = increasing.collect();
        let mut positive: Vec<f32> = next.by_ref().take(layout.count() * wavelengths * orders.len()).collect();
        positive.iter_mut().for_each(|x| *x = x.abs());
        let arrays = OrderArrays {
            orders: &orders,
            wavelength_nm: &wavelength_nm,
            index: positive.get(..wavelengths)?,
            rgb_weights: values.as_chunks().0.get(..wavelengths)?,
            strength: &positive,
        };
        return write(Contents::Orders(OrderTable::new(layout, &arrays).ok()?));
    }
    if kind & 1 == 0 {
        let theta_max = f64::from(sides.max(1)) / 255.0 * std::f64::consts::FRAC_PI_2;
        if kind & 0x20 != 0 {
            let increasing = |nm: &mut f32, x: &u8| {
                *nm += 1.0 + f32::from(*x);
                Some(*nm)
            };
            let thickness_nm: Vec<f32> =
                numbers.iter().take(1 + usize::from(shape & 7)).scan(0.0, increasing).collect();
            let distribution = if shape & 8 == 0 { Distribution::Ggx } else { Distribution::Beckmann };
            let masking = if shape & 0x10 == 0 { Masking::Correlated } else { Masking::Separable };
            let alpha = [shape >> 5, sides & 7].map(|x| f32::from(x) / 7.0);
            // Every other finish is tabulated, of densities that the bytes spell.
            let size = [1 + usize::from(sides & 3), if sides & 4 == 0 { 1 } else { 4 }];
            let density: Vec<f32> = numbers.iter().map(|&byte| f32::from(byte)).take((size[0] + 1) * size[1]).collect();
            let mut memory = vec![0.0; FacetTable::required_len(size)];
            let finish = if kind & 0x80 == 0 {
                Finish::new(distribution, masking, alpha).ok()
            } else {
                FacetTable::new(size, &density, &mut memory).ok().map(|facets| Finish::tabulated(facets, masking))
            };
            let transmittance = if kind & 0x40 == 0 { &[][..] } else { &values };
            let arrays = FilmArrays { reflectance: &values, transmittance, thickness_nm: &thickness_nm };
            let film = |finish| FilmTable::new(&arrays, channels, theta_max, finish).ok();
            if !is_compensated {
                return write(Contents::Film(film(finish)?));
            }
            let losses = numbers.iter().cycle().map(|&byte| f32::from(byte) / 255.0);
            let losses: Vec<f32> = losses.take(Compensation::LEN).collect();
            let film = film(Some(finish?.with_compensation(Compensation::of(&losses).ok()?)))?;
            let returned = values.get(..channels * thickness_nm.len())?;
            return write(Contents::Film(film.with_returned(returned).ok()?));
        }
        return write(Contents::Mirror(MirrorTable::new(&values, channels, theta_max).ok()?));
    }
    let incident = [2 + u32::from(sides & 7), 1 + u32::from(sides >> 3 & 3)];
    let lobes = usize::from(sides >> 5 & 3);
    let layout = ScatterLayout::new(incident, [2 + u32::from(shape & 15), 1 + u32::from(shape >> 4)], lobes as u32)
        .expect("small sides");
    // Densities from 1/4 to 5/4, and facets of any slope, by the bytes that follow.
    let mut next = numbers.iter().map(|&byte| f32::from(byte) / 255.0).cycle();
    let mut number = || next.next().unwrap_or(0.5);
    let density: [f32; 8] = std::array::from_fn(|_| 0.25 + number());
    let (along_u, along_v) = density.split_at(2 + usize::from(kind >> 5 & 3));
    let mut pairs = vec![0.0; HalfVectorWarp::required_len([along_u.len(), along_v.len()])];
    let warp = HalfVectorWarp::new([along_u, along_v], &mut pairs).expect("densities like one another");
    let lobes: Vec<_> = std::iter::repeat_with(|| {
        let normal = Vec3::new(number() - 0.5, number() - 0.5, 0.5 + number()).normalize();
        FacetLobe { index: 0.5 + 2.0 * number(), ..FacetLobe::reflection(normal) }.to_numbers()
    })
    .take(lobes)
    .collect();
    // The numbers that there are, repeated.
    let values: Vec<f32> = values.iter().copied().cycle().take(layout.count() * channels).collect();
    let table = ScatterTable::new(&values, layout, warp, &lobes, channels).ok()?;
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
    let sampler = ScatterSampler::new(&table, &mut memory).expect("memory of the stated size");
    write(Contents::Scatter(table, sampler))
}

fn holds(bytes: &[u8]) {
    let Ok(blob) = Blob::read(bytes) else { return };
    let precision = if bytes[16] == 2 { Precision::Half } else { Precision::Single };
    let mut again = vec![0; blob.required_len(precision).expect("it has been that long")];
    blob.write(precision, &mut again).expect("what was read can be written");
    assert!(again == bytes, "written again, a blob differs");
    let checksum = u32::from_le_bytes(*bytes[CHECKSUM..].first_chunk().expect("a header"));
    let mut numbers = Numbers(Random::new(0, checksum));
    match &blob.contents {
        Contents::Mirror(table) => mirror(table, &mut numbers),
        Contents::Film(table) => film(table, &mut numbers),
        Contents::Scatter(table, sampler) => {
            if table.layout().count() * table.channels() <= MAX {
                scatter(table, sampler, &mut numbers);
            }
        }
        Contents::Orders(table) => orders(table, &mut numbers),
    }
}

/// Random numbers in single precision that choose where a table is looked up: another sequence for each blob.
struct Numbers(Random);

impl Numbers {
    /// The next number, in [0, 1): cut to the 24 bits of single precision, since rounding might give 1.
    fn next(&mut self) -> f32 {
        const STEPS: f32 = (1 << 24) as f32;
        (self.0.next() * f64::from(STEPS)).floor() as f32 / STEPS
    }

    /// A direction above the horizon; sometimes the normal, or almost the horizon.
    fn direction(&mut self) -> Vec3 {
        let cos = match (8.0 * self.next()) as u32 {
            0 => 1.0,
            1 => f32::MIN_POSITIVE,
            _ => self.next().max(1e-6),
        };
        let (sin, phi) = ((1.0 - cos * cos).sqrt(), std::f32::consts::TAU * self.next());
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }
}

/// Rounding, in single precision, of an interpolation between two numbers and of weighted sums of sixteen.
const ROUNDINGS: f32 = 32.0 * f32::EPSILON;

fn within(x: f32, [low, high]: [f32; 2]) {
    let slack = ROUNDINGS * low.abs().max(high.abs()) + f32::MIN_POSITIVE;
    assert!(x >= low - slack && x <= high + slack, "{x:e} is not between {low:e} and {high:e}");
}

fn mirror(table: &MirrorTable<'_>, numbers: &mut Numbers) {
    let theta_max = table.theta_max() as f32;
    let row = |row: usize| row as f32 / (table.rows() - 1) as f32 * theta_max;
    for _ in 0..4 {
        let place = (numbers.next() * (table.rows() - 1) as f32) as usize;
        let theta =
            [0.0, theta_max, 2.0, row(place), row(place) + numbers.next() * row(1)][(5.0 * numbers.next()) as usize];
        let rgb = table.rgb(theta);
        for (c, x) in rgb.into_iter().enumerate() {
            assert!(x.is_finite(), "{x} at {theta}");
            let channel = c.min(table.channels() - 1);
            assert_eq!(x, table.channel(theta, channel));
            let (from, to) = (table.channel(0.0, channel), table.channel(2.0, channel));
            if table.rows() == 2 {
                within(x, [from.min(to), from.max(to)]);
            }
        }
    }
}

fn film(table: &FilmTable<'_>, numbers: &mut Numbers) {
    let [first, last] = table.range_nm();
    for _ in 0..4 {
        let nm =
            [first, last, f32::NAN, 1e30, first + numbers.next() * (last - first)][(5.0 * numbers.next()) as usize];
        let cos = [numbers.next(), 2.0, -1.0, f32::NAN][(4.0 * numbers.next()) as usize];
        let (rho, tau) = (table.reflectance(cos, nm), table.transmittance(cos, nm));
        assert!(rho.iter().chain(&tau).all(|x| x.is_finite()), "{rho:?} {tau:?} at {cos} and {nm} nm");
        assert!(table.is_transparent() || tau == [0.0; 3]);
        if table.angles() == 2 && table.thicknesses() == 1 {
            let [a, b] = [0.0, 1.0].map(|cos| table.reflectance(cos, nm));
            (0..3).for_each(|c| within(rho[c], [a[c].min(b[c]), a[c].max(b[c])]));
        }
        let (wi, wo) = (numbers.direction(), numbers.direction());
        let (f, pdf) = (table.eval(wi, wo, nm), table.pdf(wi, wo));
        assert!(f.iter().all(|f| f.is_finite()), "{f:?} at {wi} {wo}");
        assert!(pdf >= 0.0 && pdf.is_finite(), "density {pdf} at {wi} {wo}");
        assert!(table.finish().is_some() || (f, pdf) == ([0.0; 3], 0.0));
        for below in [-wi, Vec3::new(wi.x, wi.y, 0.0)] {
            assert!(table.sample(below, [0.5; 2], nm).is_none());
            assert_eq!((table.eval(below, wo, nm), table.pdf(wi, -wo)), ([0.0; 3], 0.0));
        }
        let Some(drawn) = table.sample(wi, [numbers.next(), numbers.next()], nm) else { continue };
        assert!((drawn.wo.length() - 1.0).abs() < ROUNDINGS && drawn.wo.z > 0.0, "{drawn:?}");
        assert_eq!(drawn.pdf.is_some(), table.finish().is_some());
        assert!(drawn.pdf.is_none_or(|pdf| pdf > 0.0 && pdf.is_finite()), "{drawn:?}");
        assert!(drawn.weight.iter().all(|weight| weight.is_finite()), "{drawn:?}");
    }
}

fn scatter(table: &ScatterTable<'_>, sampler: &ScatterSampler<'_>, numbers: &mut Numbers) {
    let mut all = vec![0.0; table.channels()];
    for _ in 0..4 {
        let (wi, wo) = (numbers.direction(), numbers.direction());
        table.eval(wi, wo, &mut all);
        assert!(all.iter().all(|f| f.is_finite()), "{all:?} at {wi} {wo}");
        assert_eq!(table.rgb(wi, wo)[0], all[0]);
        let pdf = sampler.pdf(wi, wo);
        assert!(pdf >= 0.0 && pdf.is_finite(), "density {pdf} at {wi} {wo}");
        for below in [-wi, Vec3::new(wi.x, wi.y, 0.0)] {
            assert!(sampler.sample(below, [0.5; 2]).is_none() && sampler.pdf(below, wo) == 0.0);
            assert_eq!(table.rgb(below, wo), [0.0; 3]);
        }
        let drawn = sampler.sample(wi, [numbers.next(), numbers.next()]);
        if let Some((wo, pdf)) = drawn {
            assert!((wo.length() - 1.0).abs() < ROUNDINGS && wo.z > 0.0, "{wo}");
            assert!(pdf > 0.0 && pdf.is_finite(), "density {pdf} at {wi} {wo}");
        }
        let reflected = sampler.reflected(wi);
        assert!(reflected >= 0.0 && reflected.is_finite(), "{reflected} at {wi}");
        let lobe = (numbers.next() * (table.layout().lobes() + 1) as f32) as usize;
        if let Some(wo) = table.reflected(wi, lobe, &mut all) {
            // Matrices are orthogonal to 10⁻⁴; n times the tangential part enlarges that.
            let rounding = 1e-3 * table.lobe(lobe).index.max(1.0);
            assert!(lobe < table.layout().lobes() && (wo.length() - 1.0).abs() < rounding, "{wo}");
        }
        assert!(all.iter().all(|rho| rho.is_finite()), "{all:?} at {wi}");
    }
    let ([u, v], [knots_u, knots_v]) = (table.layout().square_sides(), table.warp().knots());
    if (u as usize + knots_u) * (v as usize + knots_v) <= MAX {
        table.albedo(numbers.direction(), &mut all);
        assert!(all.iter().all(|a| a.is_finite()), "albedo {all:?}");
        density_is_at_most_one(table, sampler, numbers.direction());
    }
}

fn orders(table: &OrderTable<'_>, numbers: &mut Numbers) {
    /// Largest number of orders whose probabilities are added up.
    const FEW: usize = 64;
    for _ in 0..4 {
        let wo = numbers.direction();
        let view = table.view(wo).expect("wo is above the surface");
        assert!([-wo, Vec3::new(wo.x, wo.y, 0.0)].iter().all(|below| table.view(*below).is_none()));
        let of = |count: usize, numbers: &mut Numbers| (numbers.next() * (count + 1) as f32) as usize;
        let wavelength = of(table.wavelength_count(), numbers);
        let order = of(table.order_count(), numbers);
        let lights = [view.light(wavelength, order), view.light_between(wavelength, numbers.next(), order)];
        for light in lights.into_iter().flatten() {
            let missing = wavelength == table.wavelength_count() || order == table.order_count();
            assert!(!missing, "light of what the table lacks");
            assert!(light.efficiency >= 0.0 && light.efficiency.is_finite(), "{light:?} at {wo}");
            assert!((light.direction.length() - 1.0).abs() < ROUNDINGS && light.direction.z > 0.0, "{light:?} at {wo}");
        }
        let (albedo, probability) = (view.albedo(wavelength), view.probability(wavelength, order));
        assert!(albedo >= 0.0 && albedo.is_finite() && (0.0..=1.0).contains(&probability), "{probability} of {albedo}");
        match view.sample(wavelength, numbers.next()) {
            Some(drawn) => {
                assert!(drawn.probability > 0.0 && drawn.probability == view.probability(wavelength, drawn.order));
                assert!((drawn.efficiency / drawn.probability).is_finite(), "{drawn:?}");
            }
            None => assert!(albedo == 0.0, "nothing is drawn of {albedo}"),
        }
        if albedo > 0.0 && table.order_count() <= FEW {
            let sum: f32 = (0..table.order_count()).map(|order| view.probability(wavelength, order)).sum();
            assert!((sum - 1.0).abs() < 2.0 * FEW as f32 * f32::EPSILON, "probabilities add up to {sum}");
        }
    }
}

/// Between four nodes the density over the square is bilinear: its integral is its value in the middle. All of the
/// square would give 1, but half vectors that reflect below the horizon are left out.
fn density_is_at_most_one(table: &ScatterTable<'_>, sampler: &ScatterSampler<'_>, wi: Vec3) {
    /// A direction is rounded by 2⁻²³ or so. That moves a half vector of the first cell, some 10⁻³ from the pole in u
    /// and 10⁻⁶ in θ, by a tenth, but that cell has a small part of the whole.
    const ROUNDING: f32 = 0.05;
    const FEW: usize = 256;
    const MIN_DENSITY: f32 = 0.1;
    let (layout, warp) = (table.layout(), table.warp());
    let [u, v] = layout.square_sides();
    let smooth = (0..2).all(|axis| (0..warp.knots()[axis]).all(|knot| warp.density(axis, knot) >= MIN_DENSITY));
    if layout.node_count() > FEW || !smooth {
        return;
    }
    let mut sum = 0.0;
    for (column, row) in (0..u - 1).flat_map(|column| (0..v).map(move |row| (column, row))) {
        let place = [(column as f32 + 0.5) / (u - 1) as f32, (row as f32 + 0.5) / v as f32];
        let (m, solid_angle) = warp.half_vector(place, layout.origin(wi));
        let wo = 2.0 * wi.dot(m) * m - wi;
        if wi.dot(m) > 0.0 && wo.z > 0.0 {
            sum += sampler.pdf(wi, wo) * solid_angle * wi.dot(m);
        }
    }
    let whole = sum / ((u - 1) * v) as f32;
    assert!(whole <= 1.0 + ROUNDING, "the density adds up to {whole} for {wi}");
}
