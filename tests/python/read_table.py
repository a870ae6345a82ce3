#!/usr/bin/env python3
"""Reads a table of `goniochrome estimate` into NumPy in a few lines. Needs numpy and OpenEXR (PyPI).

    python3 tests/python/read_table.py table.exr

A 2D table of a mirror-like surface gives rho[angle, wavelength], the angles and the wavelengths. A 4D table of a cell
gives f[theta_i, phi_i, cos_o, phi_o, wavelength] in 1/sr, the angles of incidence, the edges of the outgoing bins
(phi_o relative to phi_i) and the wavelengths. A table of orders gives the unpolarised strengths of the reflected
orders, strength[order, beta, alpha, wavelength], the numbers m and n of the orders, the angles and the wavelengths.
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
        return spectra[0], numbers("theta_deg"), wavelength_nm
    if header["goniochrome.kind"] == "orders":
        orders, angles = numbers("orders").reshape(-1, 2), [numbers("beta_deg"), numbers("alpha_deg")]
        return spectra.reshape(len(orders), *map(len, angles), -1), orders, *angles, wavelength_nm
    (t, p), (n, m) = numbers("incident").astype(int), numbers("bins").astype(int)
    f = spectra.reshape(t, n, p, m, -1).transpose(0, 2, 1, 3, 4)
    axes = ["incident_theta_deg", "incident_phi_deg", "bin_cos_edges", "bin_phi_edges_deg"]
    return f, *map(numbers, axes), wavelength_nm


if __name__ == "__main__":
    values, *axes = read(sys.argv[1])
    print("values", values.shape, *("axis " + np.array2string(axis, threshold=8) for axis in axes), sep="\n")
