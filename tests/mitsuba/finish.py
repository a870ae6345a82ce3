"""Compares finished tables with Mitsuba's rough conductor and rough dielectric; see `run` for the files. Arguments:
their folder, and each table's name with its material, its distribution and its roughness along x and y. Tables have
constant indices, so that one wavelength is enough."""
import math
import sys

import mitsuba as mi
import numpy as np

from tables import direction

FOLDER = sys.argv[1]
# Rounding of both programs in single precision: of half vectors, over a roughness of 0.1, in tails of exp(−s²).
EVAL = 1e-4
# Directions near grazing, where single precision has lost the cosine.
LEAST = 0.02
mi.set_variant("scalar_rgb")
failures = []


def root(w, alpha):
    return np.hypot(w[:, 0] * alpha[0], w[:, 1] * alpha[1])


def exact(w, alpha):
    """G₁ of Beckmann's facets."""
    a = w[:, 2] / root(w, alpha)
    erf = np.array([math.erf(x) for x in a])
    return 2 / (1 + erf + np.exp(-a * a) / (a * np.sqrt(np.pi)))


def rational(w, alpha):
    """G₁ of Beckmann's facets by the rational function that Mitsuba uses, which is up to 0.4 % off."""
    a = w[:, 2] / root(w, alpha)
    return np.where(a < 1.6, (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a), 1)


for word in sys.argv[2:]:
    name, material, distribution, x, y = word.split(",")
    alpha = [float(x), float(y)]
    rows = np.genfromtxt(f"{FOLDER}/{name}.csv", delimiter=",", names=True, deletechars="")
    wi, wo = (direction(np.radians(rows[f"theta_{w}_deg"]), np.radians(rows[f"phi_{w}_deg"])) for w in "io")
    f = rows["f_550"]
    rough = {"distribution": distribution, "alpha_u": alpha[0], "alpha_v": alpha[1], "sample_visible": True}
    if material == "metal":
        bsdf = {"type": "roughconductor", "eta": 1.2, "k": 6.9}
    else:
        bsdf = {"type": "roughdielectric", "int_ior": 1.5, "ext_ior": 1.0}
    bsdf = mi.load_dict(dict(bsdf, **rough))

    def theirs(i, o):
        si = mi.SurfaceInteraction3f()
        si.wi = [float(x) for x in i]
        return list(bsdf.eval(mi.BSDFContext(), si, [float(x) for x in o]))[0] / o[2]

    want = np.array([theirs(i, o) for i, o in zip(wi, wo)])
    if distribution == "beckmann":
        want *= exact(wi, alpha) * exact(wo, alpha) / (rational(wi, alpha) * rational(wo, alpha))
    used = (wi[:, 2] > LEAST) & (wo[:, 2] > LEAST) & (want > 1e-6 * want.max())
    error = np.abs(f - want)[used] / want[used]
    print(f"{name}: {used.sum()} pairs, largest relative error of f {error.max():.1e} (limit {EVAL:g})")
    if not error.max() <= EVAL or used.sum() < 1000:
        failures.append(name)
if failures:
    sys.exit("failed: " + "; ".join(failures))
