"""Compares tables as read_table.py reads them with other commands. Arguments: the program, a folder to work in."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from read_table import direction, lobe_direction, mirrored, read

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
    """A 4D table holds, at the header's directions and half vectors, the f that `lookup` gives."""
    table, pairs, found = WORK / "scatter.exr", WORK / "pairs.csv", WORK / "found.csv"
    # Scratches along y show a turned or mirrored azimuth.
    run("estimate", "brushed-metal", "-o", table, "--incident", "4x5", "--half-vectors", "8x16", "--rays", 256,
        "--wavelengths", "450,550", "--coherence", "none", "-q")  # fmt: skip
    s, theta_deg, phi_deg, phi_m_deg, theta_m_deg, wavelength_nm, _, _ = read(str(table))
    assert s.shape == (4, 5, 16, 8, 2) and list(wavelength_nm) == [450, 550]
    lines, expected = [], []
    for t, theta in enumerate(theta_deg):
        for p, phi in enumerate(phi_deg):
            wi = direction(theta, phi)
            wo = mirrored(wi, theta_m_deg, phi_m_deg[:, None])
            for place in np.ndindex(wo.shape[:2]):
                # Towards the horizon an angle of ten digits is not the node's any more.
                if wo[place][2] > 0.05:
                    x, y, z = wo[place]
                    angles = theta, phi, np.degrees(np.arctan2(np.hypot(x, y), z)), np.degrees(np.arctan2(y, x))
                    lines.append(",".join(f"{angle:.12g}" for angle in angles))
                    expected.append(s[t, p, *place] / (wi[2] * z))
    pairs.write_text("\n".join(lines) + "\n")
    run("lookup", table, "--pairs", pairs, "--csv", found, "-q")
    rows = csv.DictReader(open(found))
    f = np.array([[float(row["f_450"]), float(row["f_550"])] for row in rows])
    # Single precision rounds half vectors, whose azimuths err most at the first node off the normal. The warp is up to
    # 23 times as dense there as its mean, and f changes by up to its peak from one of the nodes to the next.
    azimuth = np.finfo(np.float32).eps / np.sin(np.radians(theta_m_deg[1]))
    allowed = len(phi_m_deg) * 23 * azimuth / (2 * np.pi)
    difference = abs(f - expected).max() / f.max()
    assert f.shape == np.shape(expected) and f.max() > 0.1 and difference < allowed, (difference, allowed)
    print(f"4D table: {f.size} values at nodes as `lookup` finds them, within {difference:.1e} of the peak")


def lobes():
    """Lobes of flat facets leave in the bins, and with the power, that `scatter` finds."""
    table, bins, wavelength = WORK / "lobes.exr", (8, 16), 550
    run("estimate", "silicon-pyramids", "-o", table, "--incident", "4x5", "--half-vectors", "8x16", "--rays", 4096,
        "--wavelengths", wavelength, "--coherence", "none", "-q")  # fmt: skip
    _, theta_deg, phi_deg, _, _, _, rho, numbers = read(str(table))
    assert len(numbers) > 4
    worst, total = 0, 0
    # Not at φ = −180°, whence lobes leave along edges of bins.
    for t, p in (1, 1), (1, 3), (2, 2):
        wi = direction(theta_deg[t], phi_deg[p])
        light = ["--theta", theta_deg[t], "--phi", phi_deg[p], "--wavelength", wavelength]
        options = ["--bins", "8x16", "--rays", 8192, "--coherence", "none"]
        run("scatter", "silicon-pyramids", *light, *options, "--json", WORK / "s.json", "-q")
        said = json.loads((WORK / "s.json").read_text())["bins"]
        power = np.zeros(bins)
        for lobe, share in zip(numbers, rho[t, p, :, 0]):
            if (wo := lobe_direction(wi, lobe)) is not None:
                turn = np.arctan2(wo[1], wo[0]) / (2 * np.pi) % 1
                power[min(int(wo[2] * bins[0]), bins[0] - 1), int(turn * bins[1])] += share
        theirs, error = (np.array([one[key] for one in said]) for key in ("power", "std_error"))
        # Light in weaker lobes counts in the table's nodes, wherever they lie. Its rays are half as many.
        noise, rest = 8 * error + 2 / 4096, theirs.sum() - power.sum()
        assert (power.ravel() <= theirs + noise).all() and (theirs <= power.ravel() + noise + rest).all(), (t, p)
        assert -noise.max() <= rest < 0.2 * theirs.sum(), (rest, theirs.sum())
        worst = max(worst, rest / theirs.sum(), key=abs)
        total += power.sum()
    assert total > 0.1, total
    print(f"lobes: {len(numbers)} leave where `scatter` finds them, and hold all its light but {worst:.1%}")


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
lobes()
orders()
