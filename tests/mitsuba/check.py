"""Our .bsdf files in unmodified Mitsuba 3, and our MERL file, against tables read from OpenEXR by other people's code."""
import struct
import sys

import mitsuba as mi
import numpy as np
import OpenEXR

FOLDER, ALPHA = sys.argv[1], 0.2
# The goal: relative, above 1 % of the peak.
EVAL, FLOOR, ALBEDO, VARIANCE = 0.005, 0.01, 0.01, 1.5
failures = []


def check(what, value, limit):
    print(f"{what}: {value:.2e} (limit {limit:g})")
    if not value <= limit:
        failures.append(what)


def image(name):
    part = OpenEXR.File(f"{FOLDER}/{name}.exr", separate_channels=True).parts[0]
    text = lambda key: np.array(part.header[f"goniochrome.{key}"].split(), float)
    return part.channels, text


def channels_of(channels, rgb):
    names = ["R", "G", "B"] if rgb else sorted(name for name in channels if name.startswith("T."))
    return np.stack([channels[name].pixels for name in names])


def mirror(rgb):
    channels, text = image("mirror")
    theta, rho = np.radians(text("theta_deg")), channels_of(channels, rgb)[:, 0]

    def root(c):
        return np.sqrt(ALPHA**2 + (1 - ALPHA**2) * c * c)

    def f(wi, wo):
        m = wi + wo
        m /= np.linalg.norm(m, axis=-1, keepdims=True)
        at = np.arccos(np.clip((wi * m).sum(-1), 0, 1))
        d = ALPHA**2 / (np.pi * (m[:, 2] ** 2 * (ALPHA**2 - 1) + 1) ** 2)
        g = 0.5 / (wo[:, 2] * root(wi[:, 2]) + wi[:, 2] * root(wo[:, 2]))
        return np.stack([np.interp(at, theta, row) for row in rho]) * d * g

    return f, text("wavelength_nm")


def scatter(name, rgb):
    channels, text = image(name)
    (rows, columns), (cos, phi) = text("incident").astype(int), text("bins").astype(int)
    values = channels_of(channels, rgb).reshape(-1, rows, cos, columns, phi)

    def held(place, count):
        place = np.clip(place, 0, count - 1)
        below = np.clip(place.astype(int), 0, max(count - 2, 0))
        return below, np.minimum(below + 1, count - 1), place - below

    def around(turn, count):
        place = (turn - np.floor(turn)) * count
        below = place.astype(int) % count
        return below, (below + 1) % count, place - np.floor(place)

    def f(wi, wo):
        phi_i = np.arctan2(wi[:, 1], wi[:, 0])
        phi_o = np.arctan2(wo[:, 1], wo[:, 0]) - phi_i
        axes = [held(np.arccos(np.clip(wi[:, 2], -1, 1)) / (np.pi / 2) * rows - 0.5, rows),
                held(wo[:, 2] * cos - 0.5, cos),
                around((phi_i - np.pi / phi) / (2 * np.pi), columns),
                around(phi_o / (2 * np.pi), phi)]
        total = 0
        for corner in range(16):
            bits = [corner >> i & 1 for i in range(4)]
            weight = np.prod([a[2] if b else 1 - a[2] for a, b in zip(axes, bits)], axis=0)
            total = total + weight * values[(slice(None), *[a[b] for a, b in zip(axes, bits)])]
        return total

    return f, text("wavelength_nm")


def hemisphere(rng, count, least=0.0):
    z, phi = rng.uniform(least, 1, count), rng.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], -1)


def interaction(wi, wavelengths):
    si = mi.SurfaceInteraction3f()
    si.wi = [float(x) for x in wi]
    if wavelengths is not None:
        si.wavelengths = wavelengths
    return si


def evaluate(bsdf, pairs, wavelengths):
    out = []
    for wi, wo in zip(*pairs):
        row = []
        for at in range(0, 1 if wavelengths is None else len(wavelengths), 4):
            some = None if wavelengths is None else [float(wavelengths[min(at + k, len(wavelengths) - 1)]) for k in range(4)]
            row += [float(x) for x in bsdf.eval(mi.BSDFContext(), interaction(wi, some), [float(x) for x in wo])]
        out.append(row[: 3 if wavelengths is None else len(wavelengths)])
    return np.array(out).T


def compare(variant, name, reference, wavelengths):
    mi.set_variant(variant)
    rgb = wavelengths is None
    bsdf = mi.load_dict({"type": "measured", "filename": f"{FOLDER}/{name}{'-rgb' if rgb else ''}.bsdf"})
    rng = np.random.default_rng(1)
    wi, wo = hemisphere(rng, 3000, 0.05), hemisphere(rng, 3000, 0.02)
    if name == "mirror":  # most random pairs miss the lobe
        m = wi.copy() * 0 + hemisphere(rng, 3000, 0.9)
        wo = 2 * (wi * m).sum(-1, keepdims=True) * m - wi
        wi, wo = wi[wo[:, 2] > 0.02], wo[wo[:, 2] > 0.02]
    want = reference(wi, wo) * wo[:, 2]
    got = evaluate(bsdf, (wi, wo), wavelengths)
    error = np.abs(got - want) / np.maximum(np.abs(want), 1e-30)
    bright = np.abs(want) > FLOOR * np.abs(want).max()
    print(f"  99th percentile {np.percentile(error[bright], 99):.2e}, median {np.median(error[bright]):.2e}")
    check(f"{variant} {name} eval", error[bright].max(), EVAL)
    # Furnace and sampling.
    some = None if rgb else [float(wavelengths[i % len(wavelengths)]) for i in range(4)]
    rough = mi.load_dict({"type": "roughconductor", "distribution": "ggx", "alpha": ALPHA, "material": "none"})
    for theta in (0.2, 0.7, 1.2):
        view = np.array([[np.sin(theta), 0, np.cos(theta)]])
        side = 256
        z, phi = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(2 * side) + 0.5) / side * np.pi, indexing="ij")
        s = np.sqrt(1 - z * z)
        grid = np.stack([s * np.cos(phi), s * np.sin(phi), z], -1).reshape(-1, 3)
        truth = reference(np.repeat(view, len(grid), 0), grid) * grid[:, 2] * (2 * np.pi / len(grid))
        truth = truth.sum(-1)[[i % len(truth) for i in range(3 if rgb else 4)]]

        def weights(of, count):
            si = interaction(view[0], some)
            draw = np.random.default_rng(2)
            return np.array([[float(x) for x in of.sample(mi.BSDFContext(), si, 0.5, list(draw.uniform(0, 1, 2)))[1]]
                             for _ in range(count)])

        ours = weights(bsdf, 40000 if name != "mirror" else 20000)
        mean = ours.mean(0)
        check(f"{variant} {name} albedo at {theta} rad", np.abs(mean / truth - 1).max(), ALBEDO)
        if name == "mirror":
            theirs = weights(rough, 20000)
            relative = lambda w: (w.var(0) / w.mean(0) ** 2).mean()
            print(f"  relative variance {relative(ours):.4f}, rough conductor {relative(theirs):.4f}")
            check(f"{variant} {name} variance ratio at {theta} rad", relative(ours) / relative(theirs), VARIANCE)


def merl():
    raw = open(f"{FOLDER}/mirror.binary", "rb").read()
    assert len(raw) == 34992012 and struct.unpack("<3i", raw[:12]) == (90, 90, 180)
    planes = np.frombuffer(raw, "<f8", offset=12).reshape(3, 90, 90, 180)
    f, _ = mirror(True)
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
                corners.append(((wi[:, 2] > 0.01) & (wo[:, 2] > 0.01), f(wi, wo)))
    inside = np.all([ok for ok, _ in corners], axis=0)
    spread = np.array([v for _, v in corners])[:, :, inside]
    got = (planes[:, h, d, p] * np.array([[1 / 1500], [1.15 / 1500], [1.66 / 1500]]))[:, inside]
    low, high = np.maximum(spread.min(0), 0), np.maximum(spread.max(0), 0)
    outside = np.maximum(np.maximum(low - got, got - high), 0) / np.maximum(high, 1e-9)
    check(f"MERL: outside of what its bin holds, {inside.sum()} bins", outside.max(), 1e-3)


merl()
for name, make in (("mirror", mirror), ("iso", lambda rgb: scatter("iso", rgb)), ("aniso", lambda rgb: scatter("aniso", rgb))):
    f, wavelengths = make(False)
    compare("scalar_spectral", name, f, wavelengths)
    compare("scalar_rgb", name, make(True)[0], None)
if failures:
    sys.exit("failed: " + "; ".join(failures))
