"""Compares .bsdf files in unmodified Mitsuba 3, and a MERL file, with their tables; see `run` for the files."""
import struct
import sys

import mitsuba as mi
import numpy as np

from tables import Grid, Mirror, Scatter, direction

FOLDER, ALPHA = sys.argv[1], 0.2
# The goals: relative error of evaluation above 1 % of the peak; error of the albedo; variance over that of Mitsuba's
# rough conductor.
EVAL, FLOOR, ALBEDO, VARIANCE = 0.005, 0.01, 0.01, 1.5
# Mitsuba computes in single precision: a place in the warped square, between 0 and 1, results from about ten
# operations, each off by up to 2^-24, and 256 samples a side multiply the error by 256. Relative to the largest sample
# nearby, or to a thousandth of the peak, since the weights of the table's own bins are in single precision too.
SINGLE, FAINT = 10 * 256 * 2.0**-24, 1e-3
# The factor that keeps a direction's albedo is limited to 1.1 either way; only grazing directions may need as much.
SCALED = 0.1
# The error of linear interpolation falls with the spacing for continuous functions, with its square for smooth ones.
FIRST_ORDER = 0.5
PAIRS, STRATA = 3000, 150
failures = []


def check(what, value, limit):
    print(f"{what}: {value:.2e} (limit {limit:g})")
    if not value <= limit:
        failures.append(what)


def hemisphere(rng, count, least=0.0):
    z, phi = rng.uniform(least, 1, count), rng.uniform(0, 2 * np.pi, count)
    return direction(np.arccos(z), phi)


def pairs(lobe):
    rng = np.random.default_rng(1)
    wi = hemisphere(rng, PAIRS, 0.05)
    if not lobe:
        return wi, hemisphere(rng, PAIRS, 0.02)
    m = hemisphere(rng, PAIRS, 0.9)  # most random pairs miss the lobe
    wo = 2 * (wi * m).sum(-1, keepdims=True) * m - wi
    return wi[wo[:, 2] > 0.02], wo[wo[:, 2] > 0.02]


def interaction(wi, wavelengths):
    si = mi.SurfaceInteraction3f()
    si.wi = [float(x) for x in wi]
    if wavelengths is not None:
        si.wavelengths = [float(x) for x in wavelengths]
    return si


def evaluate(bsdf, wi, wo, wavelengths):
    """f cos θ_o[channel, pair]; Mitsuba takes four wavelengths at a time."""
    count = 3 if wavelengths is None else len(wavelengths)
    fours = [None] if wavelengths is None else [np.resize(wavelengths[at : at + 4], 4) for at in range(0, count, 4)]

    def one(i, o):
        o = [float(x) for x in o]
        return sum((list(bsdf.eval(mi.BSDFContext(), interaction(i, four), o)) for four in fours), [])

    return np.array([one(i, o)[:count] for i, o in zip(wi, wo)], float).T


def evaluation(title, bsdf, table, grid, lobe):
    wi, wo = pairs(lobe)
    want = table.f(wi, wo) * wo[:, 2]
    got = evaluate(bsdf, wi, wo, table.wavelengths)
    if not lobe:
        scale = grid.scaled(table)
        usual = np.cos(grid.theta) > 0.05
        median = np.median(np.abs(scale - 1))
        check(f"{title}: samples scaled to keep the albedo, median {median:.1e}, up to θ_i = 87°",
              np.abs(scale[:, usual] - 1).max(), SCALED)
    expressed, low, high = grid.interpolated(table, wi, wo)
    bright = np.abs(want) > FLOOR * np.abs(want).max()
    error = np.abs(got - want)[bright] / np.abs(want)[bright]
    at = np.percentile(error, [50, 99])
    print(f"{title}, {grid.bytes / 1e6:.0f} MB, eval against the table, goal {EVAL}: median {at[0]:.2e}, "
          f"99th percentile {at[1]:.2e}, largest {error.max():.2e}, within the goal {100 * (error <= EVAL).mean():.1f} %")
    # The file holds the table at its nodes, so the two differ only by linear interpolation.
    largest = np.maximum(np.maximum(np.abs(low), np.abs(high)).max(0), FAINT * np.abs(want).max())
    check("  eval against the table interpolated at the file's nodes", (np.abs(got - expressed) / largest).max(), SINGLE)
    # The remaining error depends on the number of nodes that a file may have.
    coarse = grid.halved().interpolated(table, wi, wo)[0]
    ratio = np.abs(expressed - want)[bright].mean() / np.abs(coarse - want)[bright].mean()
    check("  mean error, over that with every second node", ratio, FIRST_ORDER)
    if title.split()[1] != "aniso":  # whose nodes lie 2° to 4° apart, where a bin of the table is 22.5° wide
        check("  median error", at[0], EVAL)


def weights(bsdf, si, of=None, wi=None, wavelengths=None):
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


def sampling(title, bsdf, table, lobe, bare):
    """Checks the albedo by our samples, and their variance over that of Mitsuba's rough conductor of equal roughness.
    Aluminium is compared with its own aluminium. A colour that changes with the angle, which it lacks, is compared with
    its directions weighted by our BRDF. Variances are added over the channels, since one density serves all of them."""
    rgb = table.wavelengths is None
    channels = range(3) if rgb else np.arange(4) % len(table.wavelengths)
    side = 400
    z, phi = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(2 * side) + 0.5) / side * np.pi, indexing="ij")
    sphere = direction(np.arccos(z), phi).reshape(-1, 3)
    theirs = {"type": "roughconductor", "distribution": "ggx", "alpha": ALPHA, "material": "Al" if bare else "none"}
    for theta in (0.2, 0.7, 1.2):
        wi = direction(theta, np.array(0.0))
        truth = table.f(np.repeat(wi[None], len(sphere), 0), sphere) * sphere[:, 2] * (2 * np.pi / len(sphere))
        truth = truth[list(channels)]
        si = interaction(wi, None if rgb else table.wavelengths[list(channels)])
        ours = weights(bsdf, si)
        scale = np.abs(truth.sum(1)).max()
        check(f"{title} albedo at {theta} rad", np.abs(ours.mean(0) - truth.sum(1)).max() / scale, ALBEDO)
        if not lobe:
            continue
        variance = lambda w: w.var(0).sum() / (w.mean(0) ** 2).sum()
        rough = mi.load_dict(theirs)
        compared = weights(rough, si) if bare else weights(rough, si, bsdf)
        minimum = np.sqrt((truth**2).sum(0)).sum() ** 2 / (truth.sum(1) ** 2).sum() - 1
        peer = "Mitsuba’s own aluminium" if bare else "sampled by the rough conductor"
        print(f"  relative variance {variance(ours):.4f}; minimum for one density for all channels {minimum:.4f}; "
              f"{peer} {variance(compared):.4f}")
        check(f"  variance ratio at {theta} rad", variance(ours) / variance(compared), VARIANCE)


def merl():
    raw = open(f"{FOLDER}/mirror.binary", "rb").read()
    assert len(raw) == 34992012 and struct.unpack("<3i", raw[:12]) == (90, 90, 180)
    planes = np.frombuffer(raw, "<f8", offset=12).reshape(3, 90, 90, 180)
    table = Mirror(f"{FOLDER}/mirror.exr", ALPHA, True)
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


merl()
for variant in ("scalar_spectral", "scalar_rgb"):
    mi.set_variant(variant)
    rgb = variant == "scalar_rgb"
    for name in ("mirror", "bare", "iso", "aniso"):
        lobe = name in ("mirror", "bare")
        table = Mirror(f"{FOLDER}/{name}.exr", ALPHA, rgb) if lobe else Scatter(f"{FOLDER}/{name}.exr", rgb)
        path, title = f"{FOLDER}/{name}{'-rgb' if rgb else ''}.bsdf", f"{variant} {name}"
        bsdf = mi.load_dict({"type": "measured", "filename": path})
        evaluation(title, bsdf, table, Grid(path), lobe)
        sampling(title, bsdf, table, lobe, name == "bare")
if failures:
    sys.exit("failed: " + "; ".join(failures))
