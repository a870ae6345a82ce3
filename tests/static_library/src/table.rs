//! Functions for tables: making, writing, reading, look-up and sampling.

use goniochrome::colour::RgbSpace;
use goniochrome::glam::Vec3;
use goniochrome::microfacet::{Distribution, Finish, Masking};
use goniochrome::table::blob::{Blob, Contents, Precision};
use goniochrome::table::{
    FacetLobe, FilmArrays, FilmTable, HalfVectorWarp, MirrorTable, OrderArrays, OrderLayout, OrderTable, Periodicity,
    ScatterLayout, ScatterSampler, ScatterTable,
};

/// The sum of all that a table blob gives for two directions; NaN if it is refused.
#[unsafe(no_mangle)]
pub extern "C" fn table_look_up(bytes: &&[u8], wi: &Vec3, wo: &Vec3, u: &[f32; 2]) -> f32 {
    let Ok(blob) = Blob::read(bytes) else { return f32::NAN };
    match blob.contents {
        Contents::Mirror(table) => table.rgb(wi.x).into_iter().sum(),
        Contents::Film(table) => {
            let [first, last] = table.range_nm();
            let drawn = table.sample(*wi, *u, u[0]).map_or(0.0, |drawn| drawn.wo.z / drawn.pdf.unwrap_or(1.0));
            let [rho, tau] = [table.reflectance(wi.x, first), table.transmittance(wi.x, last)];
            table.eval(*wi, *wo, u[1]).into_iter().chain(rho).chain(tau).sum::<f32>() + table.pdf(*wi, *wo) + drawn
        }
        Contents::Scatter(table, sampler) => {
            let mut albedo = [0.0; 4];
            table.albedo(*wi, &mut albedo);
            let drawn = sampler.sample(*wi, *u).map_or(0.0, |(wo, pdf)| wo.z / pdf);
            let lobe = table.reflected(*wi, u[0] as usize, &mut albedo[1..]).map_or(0.0, |wo| wo.z);
            let density = sampler.pdf(*wi, *wo) + sampler.reflected(*wi);
            table.rgb(*wi, *wo).into_iter().sum::<f32>() + density + drawn + lobe + albedo[0] + albedo[1]
        }
        Contents::Orders(table) => {
            let Some(view) = table.view(*wo) else { return 0.0 };
            let (wavelength, order) = (wi.x as usize, wi.y as usize);
            let light = view.light_between(wavelength, wi.z, order).or(view.light(wavelength, order));
            let drawn = view.sample(wavelength, u[0]).map_or(0.0, |drawn| drawn.direction.z / drawn.probability);
            let numbers = table.order(order).into_iter().sum::<i32>() as f32;
            let known = numbers + table.wavelength_nm(wavelength) + table.rgb_weight(wavelength)[0];
            known + light.map_or(0.0, |light| light.efficiency) + drawn + view.probability(wavelength, order)
        }
    }
}

/// Makes a table of orders and writes it as a blob. Returns whether it succeeded.
#[unsafe(no_mangle)]
pub extern "C" fn orders_write(
    nodes: &[u32; 2],
    period_nm: &[f32; 2],
    orders: &&[[f32; 2]],
    numbers: &[&[f32]; 3],
    rgb_weights: &&[[f32; 3]],
    bytes: &mut &mut [u8],
) -> bool {
    let [wavelength_nm, index, strength] = *numbers;
    let arrays = OrderArrays { orders, wavelength_nm, index, rgb_weights, strength };
    let table = OrderLayout::new(*nodes, Periodicity::Both, *period_nm).and_then(|l| OrderTable::new(l, &arrays));
    table.is_ok_and(|table| {
        Blob { space: None, contents: Contents::Orders(table) }.write(Precision::Half, bytes).is_ok()
    })
}

/// Makes a film table and writes it as a blob, of a finish whose losses are computed in memory. Returns whether it
/// succeeded.
#[unsafe(no_mangle)]
pub extern "C" fn film_write(
    arrays: &[&[f32]; 4],
    alpha: &[f32; 2],
    losses: &mut &mut [f32],
    bytes: &mut &mut [u8],
) -> bool {
    let [reflectance, transmittance, thickness_nm, returned] = *arrays;
    let arrays = FilmArrays { reflectance, transmittance, thickness_nm };
    let finish = Finish::new(Distribution::Beckmann, Masking::Correlated, *alpha);
    let Ok(finish) = finish.and_then(|finish| finish.compensated(losses)) else { return false };
    let table = FilmTable::new(&arrays, 3, 1.5, Some(finish)).and_then(|table| table.with_returned(returned));
    table.is_ok_and(|table| Blob { space: None, contents: Contents::Film(table) }.write(Precision::Half, bytes).is_ok())
}

/// Makes a mirror-like or scattering table and writes it as a blob. Returns whether it succeeded.
#[unsafe(no_mangle)]
pub extern "C" fn table_write(
    values: &&[f32],
    sides: &[u32; 4],
    densities: &[&[f32]; 2],
    lobes: &&[[f32; FacetLobe::LEN]],
    channels: usize,
    half: bool,
    memory: &mut [&mut [f32]; 2],
    bytes: &mut &mut [u8],
) -> bool {
    let precision = if half { Precision::Half } else { Precision::Single };
    let write = |contents: Contents<'_>, bytes: &mut [u8]| {
        Blob { space: Some(RgbSpace::Srgb), contents }.write(precision, bytes).is_ok()
    };
    let [theta, phi, u, v] = *sides;
    let Ok(layout) = ScatterLayout::new([theta, phi], [u, v], lobes.len() as u32) else {
        let mirror = MirrorTable::new(values, channels, 1.5);
        return mirror.is_ok_and(|table| write(Contents::Mirror(table), bytes));
    };
    let [pairs, sums] = memory;
    let Ok(warp) = HalfVectorWarp::new(*densities, pairs) else { return false };
    let Ok(table) = ScatterTable::new(values, layout, warp, lobes, channels) else { return false };
    match ScatterSampler::new(&table, sums) {
        Ok(sampler) => write(Contents::Scatter(table, sampler), bytes),
        Err(_) => false,
    }
}
