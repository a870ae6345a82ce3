"""Writes ../data/precise.txt: R and T of 500 stacks to the last digit of a double, computed with 80 digits.

It carries fields, not reflection coefficients: (E, H) for s and (H, E) for p, upwards from the substrate. Inputs are
exact doubles, angles are in degrees. Run: pip install mpmath && python3 stacks.py
"""

import math
import random
from pathlib import Path

import mpmath
from mpmath import mp, mpc, mpf

mp.dps = 80
rng = random.Random(20)


def power(n, d, deg, nm):
    """[R_s, R_p, T_s, T_p] of a stack. Without a medium below the last layer it lies on a perfect mirror."""
    if deg == 90:
        sine, cosine = mpf(1), mpf(0)
    else:
        angle = mpf(deg) * mp.pi / 180
        sine, cosine = mpmath.sin(angle), mpmath.cos(angle)
    media = [mpc(*eta) for eta in n]
    tangential = (mpf(n[0][0]) * sine) ** 2
    normals = []
    for eta in media:
        q = mpmath.sqrt(eta**2 - tangential)
        normals.append(-q if q.imag < 0 else q)
    normals[0] = mpf(n[0][0]) * cosine
    reflected, transmitted = [], []
    for weight in (lambda eta: 1, lambda eta: eta**2):
        admittance = [q / weight(eta) for q, eta in zip(normals, media)]
        layers = len(d)
        mirror = len(n) == layers + 1
        if mirror:
            e, h = (mpc(0), mpc(1)) if weight(mpf(2)) == 1 else (mpc(1), mpc(0))
        else:
            e, h = mpc(1), admittance[-1]
        passed = mpc(1)
        for j in range(layers, 0, -1):
            phase = 2 * mp.pi * normals[j] * mpf(d[j - 1]) / mpf(nm)
            step = mpmath.exp(1j * phase)
            square = step**2
            k = admittance[j]
            if k == 0:
                q = 2 * mp.pi * mpf(d[j - 1]) / mpf(nm)
                low, up = -2j * q * weight(media[j]), mpc(0)
            else:
                low, up = (1 - square) / k, (1 - square) * k
            e, h = ((1 + square) * e + low * h) / 2, ((1 + square) * h + up * e) / 2
            passed *= step
        k = admittance[0]
        r = (k * e - h) / (k * e + h)
        reflected.append(float(abs(r) ** 2))
        ratio = 0 if mirror or k == 0 else admittance[-1].real / k.real
        transmitted.append(float(abs(2 * k * passed / (k * e + h)) ** 2 * ratio))
    return reflected + transmitted


def digits(x, count):
    return float(f"{x:.{count}g}")


def uniform(low, high, count=6):
    return digits(rng.uniform(low, high), count)


def dielectric():
    return [uniform(1.0, 3.0, 4), 0.0]


def absorber():
    return [digits(10 ** rng.uniform(-1.3, 0.7), 4), digits(10 ** rng.uniform(-4, 0.9), 4)]


def ordinary():
    medium = lambda: dielectric() if rng.random() < 0.7 else absorber()
    layers = rng.randrange(13)
    n = [[uniform(1.0, 2.0, 4), 0.0]] + [medium() for _ in range(layers)]
    if rng.random() < 0.9:
        n.append(medium())
    return n, [uniform(0.0, 2000.0) for _ in range(layers)], uniform(0, 89.9)


def narrow_filter():
    """[HL]^m H LL [HL]^m H, quarter waves at 550 nm under a random angle of incidence, at or near the peak."""
    high, low = uniform(1.9, 2.6, 4), uniform(1.3, 1.6, 4)
    deg = rng.choice([0.0, 0.0, uniform(0, 70)])
    sine = math.sin(math.radians(deg))
    mirror = [high, low] * rng.randrange(1, 13) + [high]
    films = mirror + [low, low] + mirror
    quarter = {n: 550.0 / (4 * math.sqrt(n * n - sine * sine)) for n in (high, low)}
    n = [[1.0, 0.0]] + [[n, 0.0] for n in films] + [[1.52, 0.0]]
    return n, [quarter[n] for n in films], deg


def critical():
    """A film whose wave runs along it, between media or films of higher index."""
    ambient, film = uniform(1.5, 2.4, 4), uniform(1.0, 1.45, 4)
    deg = math.degrees(math.asin(film / ambient)) + rng.choice([0.0, 0.0, 1e-12, -1e-9, 1e-6, -1e-3])
    n = [[ambient, 0.0]]
    d = []
    for _ in range(rng.randrange(1, 4)):
        n += [[film, 0.0], [uniform(1.5, 2.4, 4), 0.0]]
        d += [uniform(10, 3000), uniform(10, 500)]
    return n, d[:-1], deg


def grazing():
    """Films and gaps of the ambient's own index, at 85 degrees and beyond."""
    n, d = [[1.0, 0.0]], []
    for _ in range(rng.randrange(1, 5)):
        n += [[uniform(1.4, 3.0, 4), 0.0], [1.0, 0.0]]
        d += [uniform(50, 400), uniform(50, 400)]
    deg = rng.choice([uniform(85, 89.9), 89.9, 89.99, 89.9999, 90 - 1e-6, 90 - 1e-9])
    return n, d[:-1], deg


def coupled():
    """Thin metals and prisms: evanescent waves that couple to plasmons; nearly empty films."""
    metal = [uniform(0.04, 0.3, 3), uniform(1.5, 7.0, 3)]
    if rng.random() < 0.3:
        empty = [10 ** rng.uniform(-6, -1), 0.0]
        return [[1.0, 0.0], empty, dielectric()], [uniform(10, 300)], 0.0
    n, d = [[uniform(1.5, 2.2, 4), 0.0]], []
    for _ in range(rng.randrange(1, 4)):
        n += [metal, [uniform(1.0, 1.5, 4), 0.0]]
        d += [uniform(3, 60), uniform(10, 600)]
    return n + [dielectric()], d, uniform(0, 89.9)


def named():
    quarter = lambda n: 550.0 / (4 * n)
    for m in (2, 4, 6, 8, 10, 12):
        films = [2.35, 1.46] * m + [2.35, 1.46, 1.46] + [2.35, 1.46] * m + [2.35]
        n = [[1.0, 0.0]] + [[n, 0.0] for n in films] + [[1.52, 0.0]]
        yield f"filter of {m} pairs", n, [quarter(n) for n in films], 0.0, 550.0
    for eta in (1e-6, 1e-2):
        yield f"film of n = {eta:g}", [[1.0, 0.0], [eta, 0.0], [1.5, 0.0]], [100.0], 0.0, 550.0
    gap = [[2.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    yield "gap at its critical angle", gap, [100.0], 30.0, 633.0
    films = [[1.0, 0.0], [2.4, 0.0], [1.0, 0.0], [2.4, 0.0], [1.0, 0.0], [2.4, 0.0], [1.0, 0.0]]
    for deg in (89.0, 89.9, 90 - 1e-9, 90.0):
        for nm in (436.0, 550.0, 700.0):
            yield f"three films at {deg!r}, {nm:g} nm", films, [180.0] * 5, deg, nm
    yield "a millimetre of glass", [[1.0, 0.0], [1.52, 0.0], [1.0, 0.0]], [1e6], 40.0, 550.0


def cases():
    yield from named()
    for place in range(500 - sum(1 for _ in named())):
        kind = (ordinary, narrow_filter, critical, grazing, coupled)[place % 5]
        n, d, deg = kind()
        nm = 550.0 if kind is narrow_filter else uniform(300, 1100)
        if kind is narrow_filter and rng.random() < 0.3:
            nm *= 1 + 10 ** rng.uniform(-9, -3)
        yield kind.__name__, n, d, deg, nm


HEAD = """# R and T of planar stacks, made by tests/precise/stacks.py (mpmath, 80 digits): name; degrees; nm; n of ambient, layers
# and substrate, as n or n+ki, the last missing on a mirror; thicknesses in nm; R_s R_p T_s T_p. Numbers are doubles, to
# the last digit.
"""


def index(eta):
    return repr(eta[0]) if eta[1] == 0 else f"{eta[0]!r}+{eta[1]!r}i"


def line(name, n, d, deg, nm):
    lists = [" ".join(map(index, n)), " ".join(map(repr, d)), " ".join(map(repr, power(n, d, deg, nm)))]
    return "; ".join([name, repr(deg), repr(nm)] + lists) + "\n"


if __name__ == "__main__":
    (Path(__file__).parent / "../data/precise.txt").write_text(HEAD + "".join(line(*case) for case in cases()))
