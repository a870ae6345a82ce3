"""Checks a .bsdf file of diffraction orders in unmodified Mitsuba 3: albedos by its own samples, and values.

Arguments: the table, the .bsdf file, and the spread in degrees.
"""
import sys

import mitsuba as mi
import numpy as np

from tables import Orders, direction

# The error of the albedo: up to 0.01 is of Monte Carlo, the rest of orders that pass off between two of the file's
# incident directions, of which the interpolation keeps a part. And the median error of values above 1 % of the peak,
# over the peak.
ALBEDO, EVAL, FLOOR = 0.06, 0.05, 0.01
STRATA, PAIRS = 100, 400


def main():
    path, bsdf_path, spread = sys.argv[1], sys.argv[2], float(sys.argv[3])
    mi.set_variant("scalar_spectral")
    table, bsdf = Orders(path, spread), mi.load_dict({"type": "measured", "filename": bsdf_path})
    chosen = np.linspace(0, len(table.wavelengths) - 1, 4).round().astype(int)
    rng, errors, kept = np.random.default_rng(1), [], []
    for theta in (0.05, 0.4, 0.8, 1.2):
        for phi in (0.1, 0.9, 2.0, 4.0):
            wi, si = direction(theta, np.array(phi)), mi.SurfaceInteraction3f()
            si.wi, si.wavelengths = [float(x) for x in wi], [float(x) for x in table.wavelengths[chosen]]
            weights, places = [], []
            for i in range(STRATA):
                for k in range(STRATA):
                    place = [float(x) for x in (np.array([i, k]) + rng.uniform(0, 1, 2)) / STRATA]
                    sample, weight = bsdf.sample(mi.BSDFContext(), si, 0.5, place)
                    weights.append(list(weight))
                    places.append(list(sample.wo))
            want = table.albedo(wi)[chosen]
            kept.append(np.abs(np.mean(weights, 0) - want).max())
            # Directions that samples choose lie in the lobes.
            wo = np.array(places)[rng.integers(0, len(places), PAIRS)]
            wo = wo[wo[:, 2] > 0.02]
            got = np.array([list(bsdf.eval(mi.BSDFContext(), si, [float(x) for x in w])) for w in wo]).T
            true = table.projected(wi, wo)[chosen]
            peak = true.max()
            errors.append((np.abs(got - true) / peak)[true > FLOOR * peak])
    errors = np.concatenate(errors)
    print(f"{bsdf_path}: albedo within {max(kept):.2e} (limit {ALBEDO}), median {np.median(kept):.1e}; values over the "
          f"peak: median error {np.median(errors):.1e} (limit {EVAL}), 99th percentile {np.percentile(errors, 99):.1e}")
    if not (max(kept) <= ALBEDO and np.median(errors) <= EVAL):
        sys.exit("a file of orders differs from its table")


if __name__ == "__main__":
    main()
