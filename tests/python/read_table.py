#!/usr/bin/env python3
"""Reads a table of `goniochrome estimate` into NumPy in a few lines. Needs numpy and OpenEXR (PyPI).

    python3 tests/python/read_table.py table.exr

A 2D table of a mirror-like surface gives rho[angle, wavelength], the angles and the wavelengths; over a thickness
rho[thickness, angle, wavelength]. A 4D table of a cell gives s[theta_i, phi_i, phi_m, theta_m, wavelength] =
f cos theta_i cos theta_o in 1/sr, the angles of incidence, the angles of the half vectors, the wavelengths,
rho[theta_i, phi_i, lobe, wavelength] and the numbers of the lobes. A table of orders gives the unpolarised strengths of
the reflected orders, strength[order, beta, alpha, wavelength], the numbers m and n of the orders, the angles and the
wavelengths.
"""

import sys

import numpy as np
import OpenEXR


def read(path):
    header, channels = (part := OpenEXR.File(path, separate_channels=True).parts[0]).header, part.channels
    numbers = lambda key: np.array(header["goniochrome." + key].split(), float)
    wavelength_nm = numbers("wavelength_nm")
    spectra = np.stack([channels["T." + f"{nm:.6f}nm".replace(".", ",")].pixels for nm in wavelength_nm], axis=-1)
    if header["goniochrome.kind"] == "mirror":
        spectra = spectra if "goniochrome.thickness_nm" in header else spectra[0]
        return spectra, numbers("theta_deg"), wavelength_nm
    if header["goniochrome.kind"] == "orders":
        orders, angles = numbers("orders").reshape(-1, 2), [numbers("beta_deg"), numbers("alpha_deg")]
        return spectra.reshape(len(orders), *map(len, angles), -1), orders, *angles, wavelength_nm
    (t, p), (u, v), w = numbers("incident").astype(int), numbers("half_vectors").astype(int), len(wavelength_nm)
    tiles, lobes = spectra.reshape(t, -1, p, u, w).transpose(0, 2, 1, 3, 4), numbers("lobes").reshape(-1, 10)
    s, rho = tiles[:, :, :v], tiles[:, :, v:].reshape(t, p, -1, w)[:, :, : len(lobes)]
    axes = ["incident_theta_deg", "incident_phi_deg", "half_phi_deg", "half_theta_deg"]
    return s, *map(numbers, axes), wavelength_nm, rho, lobes


def direction(theta_deg, phi_deg):
    """Unit vectors of angles."""
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def mirrored(wi, theta_m_deg, phi_m_deg):
    """Outgoing directions of half vectors; in an isotropic table phi_m counts from phi_i."""
    m = direction(theta_m_deg, phi_m_deg)
    return 2 * (m @ wi)[..., None] * m - wi


def lobe_direction(wi, lobe):
    """Direction in which a lobe of flat facets leaves, or None if it is not above the horizon."""
    inside = -wi[:2] / lobe[0]
    down = 1 - inside @ inside
    turned = lobe[1:].reshape(3, 3).T @ [*inside, -np.sqrt(max(down, 0))]
    up = 1 - lobe[0] ** 2 * (turned[:2] @ turned[:2])
    return np.array([*lobe[0] * turned[:2], np.sqrt(up)]) if min(down, up, turned[2]) > 0 else None


if __name__ == "__main__":
    values, *axes = read(sys.argv[1])
    print("values", values.shape)
    for axis in axes:
        print(f"array {axis.shape}" if axis.ndim > 1 else "axis " + np.array2string(axis, threshold=8))
