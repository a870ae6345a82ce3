"""Computes iridescent_fresnel of KHR_materials_iridescence in double precision, from the extension's text alone.

It shares no code with cli/src/export/gltf/iridescence.rs, whose test holds what this prints. Given files of `export
--to gltf`, it computes the colours of their materials and compares them with those that they state. Needs only
Python 3.
"""
import cmath
import json
import math
import sys

# Gaussian fits of the CIE 1931 curves over wave numbers (Belcour & Barla 2017, table 1): amplitude, mean (1/m),
# variance (1/m²).
X_RED, X_BLUE = (5.4856e-13, 1.6810e6, 4.3278e9), (9.7470e-14, 2.2399e6, 4.5282e9)
Y, Z = (4.4201e-13, 1.7953e6, 9.3046e9), (5.2481e-13, 2.2084e6, 6.6121e9)
WHITE = 1.0685e-7
XYZ_TO_RGB = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
]


def gaussian(fit, path_m, shift):
    amplitude, mean, variance = fit
    k = 2 * math.pi * path_m
    wave = cmath.exp(1j * (mean * k + shift)).real
    return amplitude * math.sqrt(2 * math.pi * variance) * wave * math.exp(-variance * k * k) / WHITE


def sensitivity(path_nm, shifts):
    path = path_nm * 1e-9
    xyz = [gaussian(X_RED, path, shifts[0]) + gaussian(X_BLUE, path, shifts[0]),
           gaussian(Y, path, shifts[1]), gaussian(Z, path, shifts[2])]
    return [sum(m * c for m, c in zip(row, xyz)) for row in XYZ_TO_RGB]


def schlick(f0, cosine):
    return f0 + (1 - f0) * (1 - cosine) ** 5


def iridescent_fresnel(outside, film, cosine, thickness_nm, base_f0):
    t = min(max(thickness_nm / 0.03, 0), 1)
    film = outside + (film - outside) * t * t * (3 - 2 * t)
    inner_sine = outside / film * math.sqrt(1 - cosine ** 2)
    if inner_sine > 1:
        return [1.0] * 3
    inner = math.sqrt(1 - inner_sine ** 2)
    r12 = schlick(((film - outside) / (film + outside)) ** 2, cosine)
    t121 = 1 - r12
    phi21 = 0.0 if film < outside else math.pi
    bases = [(1 + math.sqrt(f)) / (1 - math.sqrt(f)) for f in (min(max(f, 0), 0.9999) for f in base_f0)]
    phis = [phi21 + (math.pi if base < film else 0.0) for base in bases]
    r23 = [schlick(((base - film) / (base + film)) ** 2, inner) for base in bases]
    r123 = [min(max(r12 * r, 1e-5), 0.9999) for r in r23]
    rs = [t121 ** 2 * r / (1 - rr) for r, rr in zip(r23, r123)]
    path = 2 * film * thickness_nm * inner
    total = [r12 + r for r in rs]
    for m in (1, 2):
        waves = sensitivity(m * path, [m * phi for phi in phis])
        for c in range(3):
            total[c] += (rs[c] - t121) * math.sqrt(r123[c]) ** m * 2 * waves[c]
    return [max(c, 0.0) for c in total]


def material_rgb(material, theta_deg):
    """Specular reflectance of a glTF material with KHR_materials_iridescence, linear sRGB."""
    film = material["extensions"]["KHR_materials_iridescence"]
    base = material["pbrMetallicRoughness"]
    ior = material["extensions"].get("KHR_materials_ior", {}).get("ior", 1.5)
    f0 = base["baseColorFactor"][:3] if base["metallicFactor"] == 1 else [((ior - 1) / (ior + 1)) ** 2] * 3
    cosine = math.cos(math.radians(theta_deg))
    iridescent = iridescent_fresnel(1.0, film["iridescenceIor"], cosine, film["iridescenceThicknessMaximum"], f0)
    factor = film["iridescenceFactor"]
    return [(1 - factor) * schlick(f, cosine) + factor * i for f, i in zip(f0, iridescent)]


def transmitted(material, theta_deg):
    """The share of light that is transmitted, or None for opaque materials. fresnel_mix and rgb_mix of the extension's
    text multiply the base, which is all transmission here, by 1 minus the largest channel."""
    if "KHR_materials_transmission" not in material["extensions"]:
        return None
    base = material["pbrMetallicRoughness"]
    assert material["extensions"]["KHR_materials_transmission"] == {"transmissionFactor": 1}
    assert base["baseColorFactor"] == [1, 1, 1, 1] and base["metallicFactor"] == 0
    film = material["extensions"]["KHR_materials_iridescence"]
    factor = film["iridescenceFactor"]
    of = lambda share: max(material_rgb({**material, "extensions": {
        **material["extensions"], "KHR_materials_iridescence": {**film, "iridescenceFactor": share}}}, theta_deg))
    return max(1 - (1 - factor) * of(0) - factor * of(1), 0)


# The program computes in single precision (see the test of iridescence.rs), and the file has five digits.
TOLERANCE = 6e-5 + 0.5e-5


def check(path):
    material = json.load(open(path))["materials"][0]
    colours = material["extras"]["goniochrome"]["colours"]
    assert len(colours) > 1
    worst = max(abs(a - b) for stated in colours
                for a, b in zip(stated["gltf_rgb"], material_rgb(material, stated["theta_deg"])))
    for stated in colours:
        through = transmitted(material, stated["theta_deg"])
        assert (through is None) == ("gltf_transmitted_grey" not in stated), path
        if through is not None:
            worst = max(worst, abs(through - stated["gltf_transmitted_grey"]))
            exact = zip(stated["exact_rgb"], stated["exact_transmitted_rgb"])
            assert all(abs(r + t - 1) < 2e-5 for r, t in exact), path
    print(f"{path}: stated colours are the formula's within {worst:.1e} (at most {TOLERANCE:.1e})")
    return worst <= TOLERANCE


CASES = [
    # outside, film, cos θ, nm, F0
    (1.0, 1.33, 1.0, 100.0, (0.04, 0.04, 0.04)),
    (1.0, 1.33, 0.5, 400.0, (0.04, 0.04, 0.04)),
    (1.0, 1.33, 0.0871557, 800.0, (0.04, 0.04, 0.04)),
    (1.0, 1.8, 0.9, 250.0, (0.04, 0.04, 0.04)),  # more than the base
    (1.0, 1.3, 0.7, 320.0, (0.95, 0.64, 0.54)),  # copper
    (1.0, 2.0, 0.3, 550.0, (0.0, 0.5, 1.0)),
    (1.0, 1.5, 0.6, 0.01, (0.1, 0.2, 0.3)),  # within the fade to no film
    (1.5, 1.2, 0.8, 300.0, (0.04, 0.04, 0.04)),  # from glass into a lighter film
    (1.5, 1.2, 0.2, 300.0, (0.04, 0.04, 0.04)),  # total reflection
]

if __name__ == "__main__":
    if sys.argv[1:]:
        sys.exit(not all([check(path) for path in sys.argv[1:]]))
    for case in CASES:
        outside, film, cosine, nm, f0 = case
        rgb = ", ".join(str(round(c, 7)) for c in iridescent_fresnel(*case))
        print(f"([{outside}, {film}, {cosine}, {nm}], {list(f0)}, [{rgb}]),")
