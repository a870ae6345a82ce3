"""Compares .bsdf files in unmodified Mitsuba 3 with `goniochrome lookup`, and a MERL file with its table; see `run` for
the files. Arguments: their folder, and each table's name with the roughness of Mitsuba's rough conductor along x and y
whose variance is compared."""
import struct
import sys

import mitsuba as mi
import numpy as np

from tables import Mirror, direction

FOLDER = sys.argv[1]
# Of relative errors of f, where f is above FLOOR of its peak for its direction of the light, 99 % are at most EVAL; of
# facets of two roughnesses 95 %, since their files resolve masking near the horizon less well.
EVAL, FLOOR, SHARE, SHARE_OF_TWO = 0.005, 0.01, 99, 95
# f cos θ_o of a lobe is interpolated across the horizon, beside which it may fall below 0 by this share of the peak.
NEGATIVE = 1e-3
# Largest variance of samples over that of Mitsuba's rough conductor of equal roughness, and largest error of an albedo.
VARIANCE, ALBEDO = 1.5, 0.01
# Size in bytes of the smallest anisotropic file.
SMALLEST = 8e6
# Rounding of single precision in both programs: `lookup` prints it.
SINGLE = 1e-5
STRATA = 100
failures = []


def check(what, value, limit):
    print(f"{what}: {value:.2e} (limit {limit:g})")
    if not value <= limit:
        failures.append(what)


def found(name):
    """Directions and f of the output of `lookup`: wi, wo, wavelengths, f[pair, wavelength], f[pair, RGB]."""
    rows = np.genfromtxt(f"{FOLDER}/{name}.csv", delimiter=",", names=True, deletechars="")
    wi, wo = (direction(np.radians(rows[f"theta_{w}_deg"]), np.radians(rows[f"phi_{w}_deg"])) for w in "io")
    columns = [column for column in rows.dtype.names if column.startswith("f_")]
    f = lambda some: np.stack([rows[column] for column in some], -1)
    return wi, wo, [float(column[2:]) for column in columns[:-3]], f(columns[:-3]), f(columns[-3:])


def interaction(wi, wavelengths):
    si = mi.SurfaceInteraction3f()
    si.wi = [float(x) for x in wi]
    if wavelengths is not None:
        si.wavelengths = [float(x) for x in wavelengths]
    return si


def evaluate(bsdf, wi, wo, wavelengths):
    """f[pair, channel]; Mitsuba takes four wavelengths at a time, and multiplies by cos θ_o."""
    count = 3 if wavelengths is None else len(wavelengths)
    fours = [None] if wavelengths is None else [np.resize(wavelengths[at : at + 4], 4) for at in range(0, count, 4)]

    def one(i, o):
        o = [float(x) for x in o]
        return sum((list(bsdf.eval(mi.BSDFContext(), interaction(i, four), o)) for four in fours), [])

    return np.array([one(i, o)[:count] for i, o in zip(wi, wo)], float) / wo[:, 2:]


def evaluation(title, bsdf, wi, wo, wavelengths, want):
    got = evaluate(bsdf, wi, wo, wavelengths)
    peak = np.array([np.abs(want[(wi == light).all(-1)]).max() for light in wi])[:, None]
    peak = np.maximum(peak, 1e-6 * peak.max())
    bright = np.abs(want) > FLOOR * peak
    error = np.abs(got - want)[bright] / np.abs(want)[bright]
    print(f"{title}: {bright.sum()} of {bright.size} values, median {np.median(error):.1e}, largest {error.max():.1e}")
    for share in (SHARE, SHARE_OF_TWO):
        at, what = np.percentile(error, share), f"  {share}th percentile of the relative error of f"
        # Of the mirror, reflectance has fringes as narrow as the steps of its table, and kinks at each angle.
        if "mirror" in title or share != (SHARE_OF_TWO if "long" in title else SHARE):
            print(f"{what}: {at:.2e}")
        else:
            check(what, at, EVAL)
    check("  negative light, over the peak", (-got / peak).max(), NEGATIVE)


def weights(bsdf, si, of=None):
    """f cos θ_o/pdf of stratified samples, where f may be that of another BRDF."""
    draw, out = np.random.default_rng(2), []
    for i in range(STRATA):
        for k in range(STRATA):
            place = [float(x) for x in (np.array([i, k]) + draw.uniform(0, 1, 2)) / STRATA]
            sample, weight = bsdf.sample(mi.BSDFContext(), si, 0.5, place)
            if of is not None:
                above = sample.wo[2] > 0 and sample.pdf > 0
                weight = [x / sample.pdf if above else 0.0 for x in of.eval(mi.BSDFContext(), si, sample.wo)]
            out.append(list(weight))
    return np.array(out, float)


def sampling(title, bsdf, rough):
    """Checks the albedo by samples against a sum over directions, in RGB, and the variance of the samples in a white
    furnace over that of Mitsuba's rough aluminium. A lobe's colour changes with the angle, which aluminium's does not:
    its directions are weighted by our BRDF. Variances are added over the channels, since one density serves all."""
    facets = title.endswith("iso")  # "aniso" too
    metal = {"type": "roughconductor", "distribution": "ggx", "material": "Al"}
    metal = mi.load_dict(dict(metal, alpha_u=rough[0], alpha_v=rough[1]))
    variance = lambda w: w.var(0).sum() / (w.mean(0) ** 2).sum()
    side = 200
    z, phi = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(2 * side) + 0.5) / side * np.pi, indexing="ij")
    sphere = direction(np.arccos(z), phi).reshape(-1, 3)
    for theta in (0.2, 0.7, 1.2):
        wi = direction(theta, np.array(0.3))
        si = interaction(wi, None)
        ours, theirs = weights(bsdf, si), weights(metal, si, None if facets else bsdf)
        if min(rough) > 0.1:  # narrower lobes fall between the directions of the sum
            f = evaluate(bsdf, np.repeat(wi[None], len(sphere), 0), sphere, None) * sphere[:, 2:]
            truth = f.sum(0) * 2 * np.pi / len(sphere)
            check(f"{title}: albedo at {theta} rad", np.abs(ours.mean(0) - truth).max() / truth.max(), ALBEDO)
        print(f"{title}: relative variance at {theta} rad {variance(ours):.4f}, of aluminium {variance(theirs):.4f}")
        check("  over that of rough aluminium", variance(ours) / variance(theirs), VARIANCE)


def merl(alpha):
    raw = open(f"{FOLDER}/mirror.binary", "rb").read()
    assert len(raw) == 34992012 and struct.unpack("<3i", raw[:12]) == (90, 90, 180)
    planes = np.frombuffer(raw, "<f8", offset=12).reshape(3, 90, 90, 180)
    table = Mirror(f"{FOLDER}/mirror.exr", alpha, True)
    rng = np.random.default_rng(3)
    h, d, p = rng.integers(0, 60, 5000), rng.integers(0, 80, 5000), rng.integers(0, 180, 5000)

    def directions(th, td, pd):
        x, y, z = np.sin(td) * np.cos(pd), np.sin(td) * np.sin(pd), np.cos(td)
        turn = lambda x, y: np.stack([np.cos(th) * x + np.sin(th) * z, y, np.cos(th) * z - np.sin(th) * x], -1)
        return turn(x, y), turn(-x, -y)

    corners = []
    for a in (0.0, 0.5, 1.0):
        for b in (0.0, 0.5, 1.0):
            for c in (0.0, 0.5, 1.0):
                wi, wo = directions(((h + a) / 90) ** 2 * np.pi / 2, (d + b) / 90 * np.pi / 2, (p + c) / 180 * np.pi)
                corners.append(((wi[:, 2] > 0.01) & (wo[:, 2] > 0.01), table.f(wi, wo)))
    inside = np.all([ok for ok, _ in corners], axis=0)
    spread = np.array([v for _, v in corners])[:, :, inside]
    got = (planes[:, h, d, p] * np.array([[1 / 1500], [1.15 / 1500], [1.66 / 1500]]))[:, inside]
    low, high = np.maximum(spread.min(0), 0), np.maximum(spread.max(0), 0)
    outside = np.maximum(np.maximum(low - got, got - high), 0) / np.maximum(high, 1e-9)
    check(f"MERL: outside of what its bin holds, {inside.sum()} bins", outside.max(), 1e-3)


def formula(name, alpha):
    """Checks `lookup` of a mirror-like table against the formula of the lobe, written again here."""
    wi, wo, _, spectra, rgb = found(name)
    for colour, want in ((False, spectra), (True, rgb)):
        f = Mirror(f"{FOLDER}/{name}.exr", alpha, colour).f(wi, wo).T
        check(f"{name}: lookup against the formula", np.abs(f - want).max() / np.abs(f).max(), SINGLE)


names = [(name, [float(x) for x in rough.split(",")]) for name, rough in (word.split("=") for word in sys.argv[2:])]
merl(dict(names)["mirror"][0])
for name, rough in names:
    if rough[0] == rough[1] and name != "iso":
        formula(name, rough[0])
for variant in ("scalar_spectral", "scalar_rgb"):
    mi.set_variant(variant)
    colour = variant == "scalar_rgb"
    for name, rough in names:
        wi, wo, wavelengths, spectra, rgb = found(name)
        if name == "iso":
            # Mitsuba 3.9 leaves a field unset for isotropic files, and may mirror pairs, but none of these. A traced
            # table has noise, so it is not quite its own mirror image.
            kept = (wi[:, :2] < 0).all(-1)
            wi, wo, spectra, rgb = wi[kept], wo[kept], spectra[kept], rgb[kept]
        path = f"{FOLDER}/{name}{'-rgb' if colour else ''}.bsdf"
        bsdf, title = mi.load_dict({"type": "measured", "filename": path}), f"{variant} {name}"
        evaluation(title, bsdf, wi, wo, None if colour else wavelengths, np.maximum(rgb, 0) if colour else spectra)
        if colour:
            sampling(title, bsdf, rough)
            if name == "aniso":
                check("  bytes", len(open(path, "rb").read()), SMALLEST)
if failures:
    sys.exit("failed: " + "; ".join(failures))
