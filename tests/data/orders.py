#!/usr/bin/env python3
"""Makes the rigorous efficiencies of orders.json. Needs numpy.

    python3 tests/data/orders.py           computes R_s, R_p and change of every case anew
    python3 tests/data/orders.py --check   compares both methods with gratings.json, which other programs made

Geometry and conventions are those of goniochrome: exp(-i omega t), eta = n + i k, z up, profiles z = h(x) that are the same at
every y, theta and phi towards the light, k_m = k_in + 2 pi m / period. Lengths are in nanometres, wavevectors in units of k_0.

Two methods:

- Fourier modal method, for profiles with vertical walls and for steep ones: slices with the factorisation rules of Li (1996),
  scalar modes of H_x and E_x, which make conical mounts as cheap as classical ones, and a reflection matrix carried upwards.
- C method (Chandezon et al. 1982) for the others, in the first-order form of Li et al. (1999) with E_y and H_y coupled at the
  surface. Modal methods converge slowly for slanted metal.

`change` is the largest difference of an efficiency from that at two thirds of the harmonics.
"""

import json
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def towards(theta_deg, phi_deg):
    """The unit vector towards the light."""
    t, f = np.radians(theta_deg), np.radians(phi_deg)
    return np.array([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)])


def polarisations(wi, phi_deg):
    """The electric fields of s and p."""
    f = np.radians(phi_deg)
    s = np.array([-np.sin(f), np.cos(f), 0.0])
    return s, np.cross(s, -wi)


# --- Fourier modal method


def toeplitz(edges, values, harmonics):
    """The Fourier coefficients of a piecewise constant function of x / period."""
    order = np.arange(-2 * harmonics, 2 * harmonics + 1)
    coefficients = np.zeros(len(order), complex)
    for a, b, value in zip(edges[:-1], edges[1:], values):
        part = (np.exp(-2j * np.pi * order * a) - np.exp(-2j * np.pi * order * b)) / np.where(order == 0, 1, 2j * np.pi * order)
        part[2 * harmonics] = b - a
        coefficients += value * part
    index = np.arange(2 * harmonics + 1)
    return coefficients[index[:, None] - index[None, :] + 2 * harmonics]


def root(square):
    """The branch with Im >= 0, and Re >= 0 where Im = 0."""
    kz = np.sqrt(square.astype(complex))
    real = abs(kz.imag) <= 1e-12 * abs(kz)
    return np.where(np.where(real, kz.real < 0, kz.imag < 0), -kz, kz)


class Modes:
    """Tangential fields of the modes of a layer, W of E and V of H, and their k_z."""

    def __init__(self, kx, ky, edges, eta):
        n, epsilon, K = len(kx), [complex(value) ** 2 for value in eta], np.diag(kx)
        one = np.eye(n)
        if len(set(epsilon)) == 1:
            epsilon = epsilon[0]
            # Away from Rayleigh anomalies, where a mode has no k_z.
            kappa = epsilon - kx**2 + np.where(abs(epsilon - kx**2) < 1e-8 * abs(epsilon), 1e-8 * abs(epsilon), 0)
            kappa_a, kappa_b, psi, phi, A, inverse = kappa, kappa, one, one, one * epsilon, one / epsilon
        else:
            E = toeplitz(edges, epsilon, (n - 1) // 2)
            A = np.linalg.inv(toeplitz(edges, [1 / value for value in epsilon], (n - 1) // 2))
            inverse = np.linalg.inv(E)
            kappa_a, psi = np.linalg.eig(E - K @ K)
            kappa_b, phi = np.linalg.eig((one - K @ inverse @ K) @ A)
        za, zb = root(kappa_a - ky**2), root(kappa_b - ky**2)
        D, zero = A @ phi, np.zeros((n, n))
        self.kz = np.concatenate([zb, za])
        self.W = np.block([[phi, zero], [-ky * inverse @ K @ D / kappa_b, -psi * za / kappa_a]])
        self.V = np.block([[zero, psi], [D * zb / kappa_b, -ky * K @ psi / kappa_a]])


def slices(points, count):
    """Layers of a profile from the top: thickness, edges in periods, whether the substrate fills each piece."""
    period, pieces = points[-1][0], list(zip(points, points[1:]))
    heights = sorted({h for _, h in points})
    walls = all(a[0] == b[0] or a[1] == b[1] for a, b in pieces)
    levels = heights if walls else sorted({*np.linspace(heights[0], heights[-1], count + 1), *heights})
    found = []
    for low, high in reversed(list(zip(levels, levels[1:]))):
        z = 0.5 * (low + high)
        cuts = [a[0] + (z - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in pieces if (a[1] - z) * (b[1] - z) < 0]
        edges = (0.0, *(x / period for x in cuts), 1.0)
        middles = [0.5 * (a + b) * period for a, b in zip(edges, edges[1:])]
        inside = [next(a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) > z for a, b in pieces if a[0] <= x <= b[0] and a[0] < b[0]) for x in middles]
        found.append((high - low, edges, tuple(inside)))
    return found


def modal(points, eta, wavelength, theta_deg, phi_deg, harmonics, count):
    """Reflected orders {m: [R_s, R_p]} by the Fourier modal method."""
    period, wi = points[-1][0], towards(theta_deg, phi_deg)
    kx, ky = -wi[0] + np.arange(-harmonics, harmonics + 1) * wavelength / period, -wi[1]
    n = len(kx)
    known = {}

    def modes(edges, media):
        key = (edges, media)
        if key not in known:
            known[key] = Modes(kx, ky, edges, media)
        return known[key]

    def across(above, below, R):
        P = np.linalg.solve(above.W, below.W @ (np.eye(2 * n) + R))
        Q = np.linalg.solve(above.V, below.V @ (np.eye(2 * n) - R))
        return np.linalg.solve((P + Q).T, (P - Q).T).T

    below, R = modes((0.0, 1.0), (eta,)), np.zeros((2 * n, 2 * n), complex)
    for thickness, edges, inside in reversed(slices(points, count)):
        layer = modes(edges, tuple(eta if solid else 1.0 for solid in inside))
        X = np.exp(2j * np.pi / wavelength * layer.kz * thickness)
        R, below = X[:, None] * across(layer, below, R) * X[None, :], layer
    top = modes((0.0, 1.0), (1.0,))
    R = across(top, below, R)
    found = {}
    for e in polarisations(wi, phi_deg):
        given = np.zeros(2 * n, complex)
        given[harmonics], given[n + harmonics] = e[0], e[1]
        field = top.W @ (R @ np.linalg.solve(top.W, given))
        for place in range(n):
            up = 1 - kx[place] ** 2 - ky**2
            if up > 1e-12:
                ex, ey = field[place], field[n + place]
                ez = -(kx[place] * ex + ky * ey) / np.sqrt(up)
                power = (abs(ex) ** 2 + abs(ey) ** 2 + abs(ez) ** 2) * np.sqrt(up) / wi[2]
                found.setdefault(place - harmonics, []).append(float(power))
    return found


# --- C method


def coordinate(points, eta, wavelength, theta_deg, phi_deg, harmonics):
    """Reflected orders {m: [R_s, R_p]} by the C method."""
    samples, n, wi, period = 1 << 14, 2 * harmonics + 1, towards(theta_deg, phi_deg), points[-1][0]
    alpha, ky = -wi[0] + np.arange(-harmonics, harmonics + 1) * wavelength / period, -wi[1]
    k0, index = 2 * np.pi / wavelength, np.arange(n)
    xs, hs = np.array(points, float).T
    x = (np.arange(samples) + 0.5) / samples * period
    h, slope = np.interp(x, xs, hs), (np.diff(hs) / np.diff(xs))[np.searchsorted(xs, x, side="right") - 1]
    order = np.arange(-2 * harmonics, 2 * harmonics + 1)

    def coefficients(f):
        return (np.fft.fft(f) / samples)[order % samples] * np.exp(-1j * np.pi * order / samples)

    def matrix(f):
        return coefficients(f)[index[:, None] - index[None, :] + 2 * harmonics]

    C, D, al = matrix(1 / (1 + slope**2)), matrix(slope / (1 + slope**2)), np.diag(alpha)

    def modes(epsilon, upwards):
        # rho F = C G + D alpha F and rho G = (kappa - alpha C alpha) F + alpha D G, with G the derivative along the normal.
        kappa = epsilon - ky**2
        rho, V = np.linalg.eig(np.block([[D @ al, C], [kappa * np.eye(n) - al @ C @ al, al @ D]]))
        travels = abs(rho.imag) <= 1e-7
        keep = (rho.imag > 1e-7) if upwards else ((rho.imag < -1e-7) | (travels & (rho.real < 0)))
        return V[:n, keep], V[n:, keep]

    def plane(place, sign):
        b = sign * np.sqrt(1 - alpha[place] ** 2 - ky**2)
        wave, at = np.exp(1j * k0 * b * h), index - place + 2 * harmonics
        return coefficients(wave)[at], coefficients(wave * (b - slope * alpha[place]))[at]

    def rows(F, G, epsilon):
        # E_y, H_y, and what along the surface stands for E_t and H_t.
        w, zero = epsilon - ky**2, np.zeros_like(F)
        return np.block([[F, zero], [zero, F], [ky * al @ F / w, -G / w], [epsilon * G / w, ky * al @ F / w]])

    travelling = [place for place in range(n) if 1 - alpha[place] ** 2 - ky**2 > 1e-9]
    waves = [plane(place, 1) for place in travelling]
    F, G = modes(1.0 + 0j, True)
    above = rows(np.column_stack([f for f, _ in waves] + [F]), np.column_stack([g for _, g in waves] + [G]), 1.0)
    system = np.hstack([above, -rows(*modes(eta**2, False), eta**2)])
    f, g = plane(harmonics, -1)
    found = {}
    for e in polarisations(wi, phi_deg):
        ey, hy, w = e[1], np.cross(-wi, e)[1], 1 - ky**2
        given = np.concatenate([ey * f, hy * f, (ky * alpha * ey * f - hy * g) / w, (ey * g + ky * alpha * hy * f) / w])
        amplitude = np.linalg.solve(system, -given)
        for i, place in enumerate(travelling):
            power = (abs(amplitude[i]) ** 2 + abs(amplitude[n + i]) ** 2) / w
            up = np.sqrt(1 - alpha[place] ** 2 - ky**2)
            found.setdefault(place - harmonics, []).append(float(power * up / wi[2]))
    return found


# --- Cases


def steepest(points):
    return max(abs(b[1] - a[1]) / (b[0] - a[0]) if b[0] > a[0] else np.inf if b[1] != a[1] else 0 for a, b in zip(points, points[1:]))


def reflected(points, eta, wavelength, theta_deg, phi_deg, part):
    """By the better method, with a part of the harmonics."""
    orders = 2 * points[-1][0] / wavelength
    if steepest(points) < 3:
        return coordinate(points, eta, wavelength, theta_deg, phi_deg, int(part * (45 + orders)))
    harmonics = 60 if eta.imag > 0.5 else 30
    return modal(points, eta, wavelength, theta_deg, phi_deg, int(part * (harmonics + orders)), int(part * 40))


def make():
    file = HERE / "orders.json"
    table = json.loads(file.read_text())
    for case in table["cases"]:
        given = (case["points_nm"], complex(*case["eta"]), case["wavelength_nm"], case["theta_deg"], case["phi_deg"])
        fine, coarse = reflected(*given, 1.0), reflected(*given, 2 / 3)
        case["change"] = float(f"{max(abs(fine[m][i] - coarse[m][i]) for m in fine for i in (0, 1)):.1e}")
        case["orders"] = sorted(fine)
        for i, key in enumerate(("R_s", "R_p")):
            case[key] = [round(fine[m][i], 6) for m in sorted(fine)]
    lines = ",\n  ".join(json.dumps(case) for case in table["cases"])
    file.write_text(f'{{\n "about": {json.dumps(table["about"])},\n "cases": [\n  {lines}\n ]\n}}\n')


def check():
    for case in json.loads((HERE / "gratings.json").read_text())["cases"]:
        points, eta = [list(map(float, p)) for p in case["profile"]["points_nm"]], complex(*case["n_substrate"])
        if points[-1][1] != points[0][1]:
            points.append([float(case["period_nm"]), points[0][1]])
        worst = 0.0
        for data in case["data"]:
            found = reflected(points, eta, data["wavelength_nm"], data["theta_deg"], 180.0, 1.0)
            for place, m in enumerate(data["orders_R"]):
                worst = max(worst, abs(found[m][0] - data["R_s"][place]), abs(found[m][1] - data["R_p"][place]))
        print(f"{case['name']}: {worst:.1e}")


if __name__ == "__main__":
    check() if "--check" in sys.argv else make()
