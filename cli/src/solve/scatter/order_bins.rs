//! Coherence `cell`: diffraction orders, each counted in the bin of its direction.

use glam::DVec3;
use goniochrome::measure::bins::DirectionGrid;

use crate::solve::diffraction::{LeftOut, OrdersRequest, default_hits, orders};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::request::{ScatterRequest, Scattered, Tracing};
use crate::support::error::Result;
use crate::table::statistics::MeanWithError;

/// Scatters light from `wi` into reflected orders, each in the bin of its direction. Transmitted orders are not
/// computed: light that is not reflected remains as imbalance.
pub(super) fn orders_in_bins<G: DirectionGrid>(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &ScatterRequest<G>,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Scattered>> {
    let Tracing { rays, seed, precision, threads, .. } = request.tracing();
    let hits = default_hits(mesh_scene);
    let orders_request = OrdersRequest { rays, seed, max_order: None, hits, precision, threads };
    let found = orders(mesh_scene, wi, wavelength_nm, &orders_request, progress)?;
    let of_wavelength = |(&nm, left_out): (&f64, &LeftOut)| {
        let mut bins = vec![MeanWithError::default(); request.bins.count()];
        let mut reflected = MeanWithError::default();
        for order in found.orders.iter().filter(|order| order.wavelength_nm == nm) {
            let (s, p) = (order.efficiency.s, order.efficiency.p);
            for sum in [&mut bins[request.bins.index(order.direction)], &mut reflected] {
                sum.value += 0.5 * (s.value + p.value);
                sum.std_error = sum.std_error.hypot(0.5 * s.std_error.hypot(p.std_error));
            }
        }
        let truncated = MeanWithError { value: left_out.truncated(hits), std_error: 0.0 };
        let remainder = 1.0 - reflected.value - truncated.value;
        let imbalance = MeanWithError { value: remainder, std_error: reflected.std_error };
        let none = MeanWithError::default();
        Scattered {
            reflected,
            transmitted: none,
            absorbed: none,
            truncated,
            imbalance,
            without_interference: none,
            bins,
        }
    };
    Ok(wavelength_nm.iter().zip(&found.left_out).map(of_wavelength).collect())
}
