"""Tables as their OpenEXR files define them, read by other people's code, and as a .bsdf file can express them."""
import struct

import numpy as np
import OpenEXR

RIGHT_ANGLE = np.pi / 2


def image(path):
    part = OpenEXR.File(path, separate_channels=True).parts[0]
    return part.channels, lambda key: np.array(part.header[f"goniochrome.{key}"].split(), float)


def channels_of(channels, rgb):
    names = ["R", "G", "B"] if rgb else sorted(name for name in channels if name.startswith("T."))
    return np.stack([channels[name].pixels for name in names])


def direction(theta, phi):
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def held(place, count):
    """Neighbours and weight of a place on a grid, which is held constant beyond its ends."""
    place = np.clip(place, 0, count - 1)
    below = np.clip(place.astype(int), 0, max(count - 2, 0))
    return below, np.minimum(below + 1, count - 1), place - below


def around(turn, count):
    """Neighbours and weight of a place on a periodic grid."""
    place = (turn - np.floor(turn)) * count
    below = place.astype(int) % count
    return below, (below + 1) % count, place - np.floor(place)


class Mirror:
    """A mirror-like table through the GGX lobe: f[channel, pair]."""

    def __init__(self, path, alpha, rgb):
        channels, text = image(path)
        self.alpha, self.theta, self.rho = alpha, np.radians(text("theta_deg")), channels_of(channels, rgb)[:, 0]
        self.wavelengths = None if rgb else text("wavelength_nm")

    def root(self, cos):
        return np.sqrt(self.alpha**2 + (1 - self.alpha**2) * cos * cos)

    def density(self, m):
        return self.alpha**2 / (np.pi * (m[..., 2] ** 2 * (self.alpha**2 - 1) + 1) ** 2)

    def lobe(self, wi, m, cos_o):
        """f / D."""
        at = np.arccos(np.clip((wi * m).sum(-1), 0, 1))
        masking = 0.5 / (cos_o * self.root(wi[:, 2]) + wi[:, 2] * self.root(cos_o))
        return np.stack([np.interp(at, self.theta, row) for row in self.rho]) * masking

    def f(self, wi, wo):
        m = wi + wo
        m = m / np.linalg.norm(m, axis=-1, keepdims=True)
        return self.lobe(wi, m, wo[:, 2]) * self.density(m)

    def smooth(self, wi, m):
        """The function that the file samples: f cos θ_o 4σ/D, continued below the horizon."""
        cos_o = np.maximum(2 * (wi * m).sum(-1) * m[:, 2] - wi[:, 2], -0.5 * wi[:, 2])
        return self.lobe(wi, m, cos_o) * cos_o / self.facets(wi, m)

    def facets(self, wi, m):
        """1/4σ. The factor D belongs to the half vector in question and is not interpolated."""
        return 1 / (2 * (wi[:, 2] + self.root(wi[:, 2])))

    def expressed(self, wi, m):
        return self.density(m) * self.facets(wi, m)


class Scatter:
    """A table of tilted facets."""

    def __init__(self, path, rgb):
        channels, text = image(path)
        (self.rows, self.columns), (self.cos, self.phi) = text("incident").astype(int), text("bins").astype(int)
        self.values = channels_of(channels, rgb).reshape(-1, self.rows, self.cos, self.columns, self.phi)
        self.wavelengths = None if rgb else text("wavelength_nm")

    def f(self, wi, wo):
        phi_i = np.arctan2(wi[:, 1], wi[:, 0])
        phi_o = np.arctan2(wo[:, 1], wo[:, 0]) - phi_i
        axes = [held(np.arccos(np.clip(wi[:, 2], -1, 1)) / RIGHT_ANGLE * self.rows - 0.5, self.rows),
                held(wo[:, 2] * self.cos - 0.5, self.cos),
                around((phi_i - np.pi / self.phi) / (2 * np.pi), self.columns),
                around(phi_o / (2 * np.pi), self.phi)]
        total = 0
        for corner in range(16):
            bits = [corner >> i & 1 for i in range(4)]
            weight = np.prod([a[2] if b else 1 - a[2] for a, b in zip(axes, bits)], axis=0)
            total = total + weight * self.values[(slice(None), *[a[b] for a, b in zip(axes, bits)])]
        return total

    def smooth(self, wi, m):
        wo = 2 * (wi * m).sum(-1, keepdims=True) * m - wi
        cos_o = wo[:, 2]
        above = np.stack([wo[:, 0], wo[:, 1], np.maximum(np.abs(cos_o), 1e-6)], -1)
        return self.f(wi, above) * np.copysign(above[:, 2], cos_o)

    def expressed(self, wi, m):
        return 1.0


class Axis:
    """One axis of a warp whose density is a product; linear between samples."""

    def __init__(self, density):
        self.density, self.last = density.astype(float), len(density) - 1
        self.sums = np.concatenate([[0], np.cumsum((self.density[1:] + self.density[:-1]) / 2)])

    def to_uniform(self, place):
        at = np.clip((place * self.last).astype(int), 0, self.last - 1)
        rest, a, b = place * self.last - at, self.density[at], self.density[at + 1]
        return (self.sums[at] + rest * a + rest * rest * (b - a) / 2) / self.sums[-1]

    def from_uniform(self, share):
        target = share * self.sums[-1]
        at = np.clip(np.searchsorted(self.sums, target) - 1, 0, self.last - 1)
        a, b, rest = self.density[at], self.density[at + 1], target - self.sums[at]
        return (at + np.clip(2 * rest / (a + np.sqrt(np.maximum(a * a + 2 * rest * (b - a), 0))), 0, 1)) / self.last


class Grid:
    """The places where a .bsdf file samples its table, read from the file."""

    def __init__(self, path):
        raw = open(path, "rb").read()
        assert raw[:14] == b"tensor_file\0\x01\0"
        fields, at = {}, 18
        for _ in range(struct.unpack("<I", raw[14:18])[0]):
            (length,) = struct.unpack("<H", raw[at : at + 2])
            name = raw[at + 2 : at + 2 + length].decode()
            at += 2 + length
            dimensions, kind, offset = struct.unpack("<HBQ", raw[at : at + 11])
            shape = struct.unpack(f"<{dimensions}Q", raw[at + 11 : at + 11 + 8 * dimensions])
            at += 11 + 8 * dimensions
            fields[name] = np.frombuffer(raw, {1: "u1", 10: "<f4"}[kind], int(np.prod(shape)), offset).reshape(shape)
        self.bytes, self.theta, self.phi = len(raw), fields["theta_i"].astype(float), fields["phi_i"].astype(float)
        warp = fields["vndf"][0, 0]
        assert (fields["vndf"] == warp).all(), "the warp depends on the incident direction"
        self.axes = [Axis(warp[0]), Axis(warp[:, 0])]
        self.nodes = [np.linspace(0, 1, fields["luminance"].shape[-1])] * 2
        self.samples = fields["spectra" if "spectra" in fields else "rgb"]
        self.scale = np.ones(self.samples.shape[:3])

    def scaled(self, table):
        """Takes the factor by which the file scales each incident direction and channel to keep its albedo from the
        largest sample. Returns the factors."""
        flat = np.abs(self.samples).reshape(*self.samples.shape[:3], -1).argmax(-1)
        phi, theta, channel = np.indices(flat.shape)
        side = len(self.nodes[0])
        u, v = (axis.from_uniform(self.nodes[0][at]) for axis, at in zip(self.axes, (flat % side, flat // side)))
        half = direction((u * u * RIGHT_ANGLE).ravel(), (2 * np.pi * v - np.pi).ravel())
        wi = direction(self.theta[theta.ravel()], self.phi[phi.ravel()])
        plain = table.smooth(wi, half)[channel.ravel(), np.arange(len(wi))].reshape(flat.shape)
        largest = np.take_along_axis(self.samples.reshape(*flat.shape, -1), flat[..., None], -1)[..., 0]
        self.scale = np.divide(largest, plain, out=np.ones(flat.shape), where=plain != 0)
        return self.scale

    def halved(self):
        """A grid with every second sample of this one."""
        other = Grid.__new__(Grid)
        thin = lambda nodes: nodes if len(nodes) == 1 else np.append(nodes[:-1:2], nodes[-1])
        other.axes, other.theta, other.phi = self.axes, thin(self.theta), thin(self.phi)
        other.nodes = [thin(nodes) for nodes in self.nodes]
        indices = [thin(np.arange(len(nodes))) for nodes in (self.phi, self.theta)]
        other.scale = self.scale[indices[0]][:, indices[1]]
        return other

    def interpolated(self, table, wi, wo):
        """f cos θ_o as the format interpolates the table, and the smallest and largest of the samples around."""
        m = wi + wo
        m = m / np.linalg.norm(m, axis=-1, keepdims=True)
        theta, phi = np.arccos(np.clip(wi[:, 2], -1, 1)), np.arctan2(wi[:, 1], wi[:, 0])
        origin = phi if len(self.phi) == 1 else 0
        turn = (np.arctan2(m[:, 1], m[:, 0]) - origin + np.pi) / (2 * np.pi)
        place = [np.sqrt(np.arccos(np.clip(m[:, 2], -1, 1)) / RIGHT_ANGLE), turn - np.floor(turn)]

        def between(nodes, value):
            if len(nodes) == 1:
                return [(np.zeros(value.shape, int), 1.0)]
            at = np.clip(np.searchsorted(nodes, value) - 1, 0, len(nodes) - 2)
            weight = np.clip((value - nodes[at]) / (nodes[at + 1] - nodes[at]), 0, 1)
            return [(at, 1 - weight), (at + 1, weight)]

        inside = [between(nodes, axis.to_uniform(x)) for nodes, axis, x in zip(self.nodes, self.axes, place)]
        square = [[(axis.from_uniform(nodes[at]), weight) for at, weight in pair]
                  for axis, nodes, pair in zip(self.axes, self.nodes, inside)]
        total, low, high = 0, np.inf, -np.inf
        for u, weight_u in square[0]:
            for v, weight_v in square[1]:
                # φ_m counts from φ_i in isotropic tables, whose slices stand at φ_i = 0.
                half = direction(u * u * RIGHT_ANGLE, 2 * np.pi * v - np.pi)
                for theta_i, weight_theta in between(self.theta, theta):
                    for phi_i, weight_phi in between(self.phi, phi):
                        incident = direction(self.theta[theta_i], self.phi[phi_i])
                        sample = table.smooth(incident, half) * self.scale[phi_i, theta_i].T
                        total = total + weight_u * weight_v * weight_theta * weight_phi * sample
                        low, high = np.minimum(low, sample), np.maximum(high, sample)
        scale = table.expressed(wi, m)
        return total * scale, low * scale, high * scale


class Orders:
    """A table of diffraction orders with a spherical Gaussian around each: f cos θ_o[channel, pair]."""

    def __init__(self, path, spread_deg):
        self.path, self.kappa = path, np.radians(spread_deg) ** -2
        part = OpenEXR.File(path, separate_channels=True).parts[0]
        text = lambda key: part.header[f"goniochrome.{key}"]
        numbers = lambda key: np.array(text(key).split(), float)
        self.alpha, self.beta = np.radians(numbers("alpha_deg")), np.radians(numbers("beta_deg"))
        self.orders, self.period = numbers("orders").reshape(-1, 2), numbers("period_nm")
        self.swap, self.lines = text("periodicity") == "y", text("periodicity") != "both"
        self.wavelengths, self.index = numbers("wavelength_nm"), numbers("index_above")
        names = [name for name in part.channels if name.startswith("T.")]
        names.sort(key=lambda name: float(name[2:-2].replace(",", ".")))
        self.strength = np.stack([part.channels[name].pixels for name in names])
        self.strength = self.strength.reshape(-1, len(self.orders), len(self.beta), len(self.alpha))

    def light(self, wi):
        """Directions[wavelength, order] and efficiencies of one direction of the light."""
        along, across = (wi[1], wi[0]) if self.swap else (wi[0], wi[1])
        alpha, beta = np.arctan2(along, np.hypot(across, wi[2])), np.arctan2(across, wi[2])
        places = [(abs(beta) if self.lines else beta, self.beta), (alpha, self.alpha)]
        strength = self.strength
        for axis, (angle, nodes) in enumerate(places):
            below, above, weight = held(np.array((angle - nodes[0]) / (nodes[1] - nodes[0])), len(nodes))
            strength = strength.take(below, 2) * (1 - weight) + strength.take(above, 2) * weight
        scale = (self.wavelengths / self.index)[:, None, None]
        t = scale * self.orders / self.period - wi[:2]
        up2 = 1 - (t**2).sum(-1)
        up = np.sqrt(np.maximum(up2, 0))  # 0 for orders that do not travel
        efficiency = strength * 4 * up * wi[2] / (up + wi[2]) ** 2
        return np.concatenate([t, up[..., None]], -1), efficiency

    def albedo(self, wi):
        return self.light(wi)[1].sum(-1)

    def projected(self, wi, wo):
        """f cos θ_o[wavelength, direction] for one direction of the light."""
        directions, efficiency = self.light(wi)
        x = np.arcsin(directions[..., 2]) * np.sqrt(self.kappa)
        above = 1 / (1 + np.exp(-x * (1.5976 + 0.07056 * x * x)))
        peak = efficiency / above * self.kappa / (2 * np.pi * -np.expm1(-2 * self.kappa))
        return (peak[..., None] * np.exp(self.kappa * (directions @ wo.T - 1))).sum(1)
