"""Compares tables as read_table.py reads them with other commands. Arguments: the program, a folder to work in."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from read_table import read

PROGRAM, WORK = sys.argv[1], Path(sys.argv[2])


def run(*words):
    subprocess.run([PROGRAM, *map(str, words)], check=True)


def mirror():
    """A 2D table holds what `spectrum` prints."""
    run("estimate", "soap-bubble", "-o", WORK / "mirror.exr", "--angles", 6, "--wavelengths", "450:650:50", "-q")
    grid = ["--theta", "0,15,30,45,60,75", "--wavelengths", "450:650:50"]
    run("spectrum", "soap-bubble", *grid, "--csv", WORK / "s.csv", "-q")
    rho, theta_deg, wavelength_nm = read(str(WORK / "mirror.exr"))
    rows = list(csv.DictReader(open(WORK / "s.csv")))
    number = lambda row, *keys: [float(row[key]) for key in keys]
    expected = {tuple(number(row, "theta_deg", "wavelength_nm")): np.mean(number(row, "R_s", "R_p")) for row in rows}
    places = ((a, t, w, nm) for a, t in enumerate(theta_deg) for w, nm in enumerate(wavelength_nm))
    worst = max(abs(rho[a, w] - expected[t, nm]) for a, t, w, nm in places)
    assert worst < 1e-6 and rho.shape == (6, 5), worst
    print(f"2D table: {rho.size} reflectances within {worst:.1e}")


def scatter():
    """A 4D table holds, for the header's directions and edges of bins, the powers that `scatter` finds."""
    bins, wavelength = (8, 16), 550
    table = WORK / "scatter.exr"
    # Grooves along y show a turned or mirrored azimuth.
    run("estimate", "dvd", "-o", table, "--incident", "3x4", "--bins", "8x16", "--rays", 8192, "--wavelengths", wavelength,
        "--coherence", "none", "-q")  # fmt: skip
    f, theta_deg, phi_deg, cos_edges, phi_edges_deg, wavelength_nm = read(str(table))
    assert f.shape == (3, 4, 8, 16, 1) and list(wavelength_nm) == [wavelength]
    projected = np.diff(cos_edges**2)[:, None] / 2 * np.radians(np.diff(phi_edges_deg))[None, :]
    for t, theta in enumerate(theta_deg):
        for p, phi in enumerate(phi_deg):
            light = ["--theta", theta, "--phi", phi, "--wavelength", wavelength]
            options = ["--bins", "8x16", "--rays", 8192, "--coherence", "none"]
            run("scatter", "dvd", *light, *options, "--json", WORK / "s.json", "-q")
            said = json.loads((WORK / "s.json").read_text())
            power, error = np.zeros(bins), np.zeros(bins)
            for one in said["bins"]:
                middle = 0.5 * (one["phi_min_deg"] + one["phi_max_deg"]) - phi
                row = np.searchsorted(cos_edges, 0.5 * (one["cos_min"] + one["cos_max"])) - 1
                column = np.searchsorted(phi_edges_deg, (middle - phi_edges_deg[0]) % 360 + phi_edges_deg[0]) - 1
                power[row, column] += one["power"]
                error[row, column] = one["std_error"]
            difference = abs(f[t, p, :, :, 0] * projected - power)
            assert (difference < 1e-3 + 6 * error).all(), (theta, phi, difference.max())
            assert power.max() > 0.1
    print(f"4D table: {f.size} bins as `scatter` finds them")


def orders():
    """A table of orders holds the numbers that the tests of the file put there: lines of 700 nm, in each place
    another strength."""
    strength, numbers, beta_deg, alpha_deg, wavelength_nm = read("fuzz/seeds/exr_table/orders.exr")
    assert numbers.tolist() == [[m, n] for m in (-1, 0, 1) for n in (-1, 0, 1)] and list(beta_deg) == [-89, 0, 89]
    assert np.allclose(alpha_deg, 89 * np.array([-3, -1, 1, 3]) / 3, atol=1e-12, rtol=0)
    assert np.allclose(wavelength_nm, [435.833333, 550, 700], atol=1e-12, rtol=0)
    # In memory wavelengths, nodes (beta, then alpha) and orders run from the slowest to the fastest.
    place = np.arange(strength.size).reshape(3, 3, 4, 9).transpose(3, 1, 2, 0)
    s, p = ((place * 37 % 101 + seed) / 97 for seed in (0, 1))
    worst = abs(strength - (s + p) / 2).max()
    assert worst < 1e-6, worst
    print(f"orders: {strength.size} strengths within {worst:.1e}")


mirror()
scatter()
orders()
