"""Writes pairs of directions for `goniochrome lookup --pairs`: FILE, and the roughness of half vectors along x and y.

Of each direction towards the light there are several towards the viewer. Most of their half vectors follow facets of
the roughness, as GGX does; the others lie anywhere.
"""
import sys

import numpy as np

from tables import direction

LIGHTS, VIEWERS, IN_LOBE = 120, 40, 0.8
# Largest θ_i in degrees, and least cos θ_o.
THETA, LEAST = 87, 0.02


def main():
    path, rough = sys.argv[1], np.array([float(x) for x in sys.argv[2:4]])
    rng = np.random.default_rng(1)
    wi = np.repeat(direction(np.radians(rng.uniform(0, THETA, LIGHTS)), rng.uniform(-np.pi, np.pi, LIGHTS)), VIEWERS, 0)
    count = len(wi)
    share, turn = rng.uniform(0, 1, count), rng.uniform(-np.pi, np.pi, count)
    slope = np.sqrt(share / (1 - share))[:, None] * np.stack([np.cos(turn), np.sin(turn)], -1) * rough
    m = np.concatenate([slope, np.ones((count, 1))], -1)
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    anywhere = rng.uniform(0, 1, count) > IN_LOBE
    m[anywhere] = direction(rng.uniform(0, np.pi / 2, count), turn)[anywhere]
    wo = 2 * (wi * m).sum(-1, keepdims=True) * m - wi
    above = wo[:, 2] > LEAST
    both = wi[above], wo[above]
    angles = [[np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2]), np.arctan2(w[:, 1], w[:, 0])] for w in both]
    rows, header = np.degrees(np.concatenate(angles)).T, "theta_i,phi_i,theta_o,phi_o"
    np.savetxt(path, rows, "%.9f", ",", header=header, comments="")


if __name__ == "__main__":
    main()
