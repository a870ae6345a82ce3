"""Times goniochrome and its peers on the 20-layer stack: 90 angles x 81 wavelengths, R of s and p, one thread.

`closed_form.py PROGRAM [PEER ...]`; without names all peers. The programs take turns. Seconds are of processor time,
and each ratio is of medians within this run. Fails if results differ.
"""
import importlib.metadata
import json
import statistics
import subprocess
import sys
import time
import warnings

import numpy as np

warnings.filterwarnings("ignore")

TURNS = 3
REPEATS = 40
THETA = np.arange(90.0)
WAVELENGTHS = np.arange(380.0, 781.0, 5.0)
FILMS = [80.0, 100.0] * 10
THICKNESS = [np.inf] + FILMS + [np.inf]
INDICES = [1.0] + [1.73 + 0.01j, 1.4] * 10 + [1.56 + 0.06j]
# Rounding in double precision, in which all peers compute 20 layers.
BETWEEN_PEERS = 1e-11


# Each peer's function computes R, and T too where the same call gives it. It returns R of [s, p][theta, wavelength].


def tmm_faster():
    import tmm_faster as peer

    indices = np.array([INDICES] * len(WAVELENGTHS))

    def run():
        result = peer.calc_coherent(indices, THICKNESS, THETA, WAVELENGTHS)
        return [np.asarray(result[name]).T for name in ("R_s", "R_p")]

    return run


def tmm_fast():
    import tmm_fast as peer
    import torch

    torch.set_num_threads(1)
    indices = torch.tensor(np.tile(np.array(INDICES)[None, :, None], (1, 1, len(WAVELENGTHS))))
    thickness = torch.tensor([THICKNESS])
    theta, wavelengths = torch.tensor(np.radians(THETA)), torch.tensor(WAVELENGTHS)

    def run():
        return [np.asarray(peer.coh_tmm(pol, indices, thickness, theta, wavelengths)["R"])[0] for pol in "sp"]

    return run


def colour_science():
    from colour.phenomena import multilayer_tmm

    def run():
        reflectance, _ = multilayer_tmm(INDICES, FILMS, WAVELENGTHS, THETA)
        return [reflectance[:, :, 0, pol].T for pol in (0, 1)]

    return run


def tmm():
    import tmm as peer

    indices = np.array(INDICES)

    def run():
        one = lambda pol, theta, wavelength: peer.coh_tmm(pol, indices, THICKNESS, theta, wavelength)["R"]
        return [np.array([[one(pol, t, w) for w in WAVELENGTHS] for t in np.radians(THETA)]) for pol in "sp"]

    return run


def pymoosh():
    import PyMoosh as peer

    squares = [complex(n) ** 2 for n in (1.0, 1.73 + 0.01j, 1.4, 1.56 + 0.06j)]
    stack = peer.Structure(squares, [0] + [1, 2] * 10 + [3], [0.0] + FILMS + [0.0], verbose=False)

    def run():
        one = lambda pol, theta, wavelength: peer.coefficient(stack, wavelength, theta, pol)[2]
        return [np.array([[one(pol, t, w) for w in WAVELENGTHS] for t in np.radians(THETA)]) for pol in (0, 1)]

    return run


# Name on PyPI: what makes the function, how it computes, and the angles that are compared. colour-science's Snell's law
# drops the imaginary part, so with absorbing layers it is right at normal incidence only (elsewhere off by up to 0.08).
EVERY, NORMAL = slice(None), slice(1)
PEERS = {
    "tmm_faster": (tmm_faster, "C++", EVERY),
    "tmm_fast": (tmm_fast, "torch", EVERY),
    "colour-science": (colour_science, "numpy", NORMAL),
    "PyMoosh": (pymoosh, "point by point", EVERY),
    "tmm": (tmm, "point by point", EVERY),
}
# Method, precision, largest difference to the first peer, name.
OURS = [
    ("stack", "f32", 1e-5, "closed form, f32"),
    ("stack", "f64", 1e-11, "closed form, f64"),
    ("trace", "f32", 1e-5, "ray tracing, f32"),
    ("trace", "f64", 1e-9, "ray tracing, f64"),
]

program, *names = sys.argv[1:]
names = names or list(PEERS)
peers = {name: PEERS[name][0]() for name in names}
seconds = {name: [] for name in names + [name for *_, name in OURS]}
expected = None
for _ in range(TURNS):
    for name, run in peers.items():
        start = time.process_time()
        found = run()
        seconds[name].append(time.process_time() - start)
        expected = found if expected is None else expected
        compared = PEERS[name][2]
        difference = max(np.abs(got - want)[compared].max() for got, want in zip(found, expected))
        if not difference <= BETWEEN_PEERS:
            sys.exit(f"{name} and {names[0]} differ by {difference:.1e}")
    for method, precision, tolerance, name in OURS:
        out = subprocess.run([program, method, precision, str(REPEATS)], check=True, capture_output=True).stdout
        result = json.loads(out)
        seconds[name] += result["seconds"]
        for got, want in zip((result["R_s"], result["R_p"]), expected):
            difference = np.abs(np.reshape(got, want.shape) - want).max()
            if not difference <= tolerance:
                sys.exit(f"{name}: differs by {difference:.1e}")

median = {name: statistics.median(values) for name, values in seconds.items()}
work = f"{len(THETA) * len(WAVELENGTHS)} angle-wavelengths, s and p, R and T, 1 thread"
print(f"{work}, milliseconds of processor time; ratios to ours")
columns = [name for *_, name in OURS]
print(f"{'':44}{'median':>10}" + "".join(f"{column:>18}" for column in columns))
for name in names:
    label = f"{name} {importlib.metadata.version(name)} ({PEERS[name][1]}, double)"
    ratios = "".join(f"{median[name] / median[column]:17.0f}x" for column in columns)
    print(f"{label:44}{median[name] * 1e3:10.2f}{ratios}")
for column in columns:
    print(f"{'goniochrome ' + column:44}{median[column] * 1e3:10.3f}")
ratio = median["ray tracing, f32"] / median["closed form, f32"]
print(f"ray tracing takes {ratio:.2f} times the closed form's time (f32)")
