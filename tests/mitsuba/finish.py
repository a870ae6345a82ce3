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

    # Glass draws reflection alone, as a finish does.
    reflection = mi.BSDFContext()
    reflection.type_mask = mi.BSDFFlags.GlossyReflection

    def theirs(i, o):
        si = mi.SurfaceInteraction3f()
        si.wi = [float(x) for x in i]
        wo = [float(x) for x in o]
        return list(bsdf.eval(reflection, si, wo))[0] / o[2], bsdf.pdf(reflection, si, wo)

    want, pdf = np.array([theirs(i, o) for i, o in zip(wi, wo)]).T
    if distribution == "beckmann":
        of_light, of_viewer = (exact(w, alpha) / rational(w, alpha) for w in (wi, wo))
        want, pdf = want * of_light * of_viewer, pdf * of_light
    used = (wi[:, 2] > LEAST) & (wo[:, 2] > LEAST) & (want > 1e-6 * want.max())
    for what, ours, of in (("f", f, want), ("the density", rows["pdf"], pdf)):
        error = (np.abs(ours - of)[used] / of[used]).max()
        print(f"{name}: {used.sum()} pairs, largest relative error of {what} {error:.1e} (limit {EVAL:g})")
        if not error <= EVAL or used.sum() < 1000:
            failures.append(f"{name}, {what}")
if failures:
    sys.exit("failed: " + "; ".join(failures))
