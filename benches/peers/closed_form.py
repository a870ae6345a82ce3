"""The 20-layer beetle, 90 angles x 81 wavelengths, s and p, R and T, one thread: tmm_faster (C++) and goniochrome.

The programs take turns; each ratio is of medians within this run. Fails if the results differ.
"""
import json
import statistics
import subprocess
import sys
import time

import numpy as np
import tmm_faster

TURNS = 5
REPEATS = 40
# Method, precision, largest difference to tmm_faster, which computes in double precision.
OURS = [("stack", "f32", 1e-5), ("stack", "f64", 1e-11), ("trace", "f32", 1e-5), ("trace", "f64", 1e-9)]

theta = np.arange(90.0)
wavelengths = np.arange(380.0, 781.0, 5.0)
thickness = [np.inf] + [80.0, 100.0] * 10 + [np.inf]
indices = np.array([[1.0] + [1.73 + 0.01j, 1.4] * 10 + [1.56 + 0.06j]] * len(wavelengths))


def peer():
    start = time.perf_counter()
    result = tmm_faster.calc_coherent(indices, thickness, theta, wavelengths)
    return time.perf_counter() - start, result


def ours(method, precision):
    out = subprocess.run([sys.argv[1], method, precision, str(REPEATS)], check=True, capture_output=True)
    return json.loads(out.stdout)


peer_seconds = []
seconds = {(method, precision): [] for method, precision, _ in OURS}
for _ in range(TURNS):
    for _ in range(3):
        elapsed, expected = peer()
        peer_seconds.append(elapsed)
    for method, precision, tolerance in OURS:
        result = ours(method, precision)
        seconds[method, precision] += result["seconds"]
        # Not T_p: into an absorbing substrate tmm_faster takes Re(n cos) where tmm and we take Re(n conj(cos)).
        for quantity in ("R_s", "R_p", "T_s"):
            want = np.asarray(expected[quantity])
            got = np.asarray(result[quantity]).reshape(len(theta), len(wavelengths))
            got = got if want.shape == got.shape else got.T
            difference = np.abs(got - want).max()
            if not difference <= tolerance:
                sys.exit(f"{method} {precision}: {quantity} differs by {difference:.1e}")

samples = len(theta) * len(wavelengths)
baseline = statistics.median(peer_seconds)
print(f"{samples} angle-wavelengths, s and p, R and T, 1 thread, {TURNS} turns")
print(f"{'program':34}{'median':>12}{'ratio':>9}")
print(f"{'tmm_faster 0.1.3 (C++, double)':34}{baseline * 1e3:9.2f} ms{1:8.1f}x")
for method, precision, _ in OURS:
    median = statistics.median(seconds[method, precision])
    name = "closed form" if method == "stack" else "ray tracing"
    print(f"{f'goniochrome {name} {precision}':34}{median * 1e3:9.3f} ms{baseline / median:8.1f}x")
closed, traced = (statistics.median(seconds[method, "f32"]) for method in ("stack", "trace"))
print(f"ray tracing takes {traced / closed:.2f} times the closed form's time (f32)")
