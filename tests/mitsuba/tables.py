"""Tables as their OpenEXR files define them, read by other people's code."""
import numpy as np
import OpenEXR


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
