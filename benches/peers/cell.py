"""Compares goniochrome with Mitsuba 3 on the bumpy soap film, in light from a few directions of its 16 x 32 table.

First the light that both reflect must agree, in total and in bins: within 4 combined standard errors, at most 1 % of
the bins beyond 3. Then both are timed in turn, with bins of 32 x 64 and 40 wavelengths. Usage: cell.py PROGRAM [--full]
[--index N]; --index gives Mitsuba's film another index than ours, and the comparison must fail.

What is compared: a starting ray of goniochrome is split into all its paths, in s and p light. A ray of Mitsuba draws
one path for its four wavelengths, so 40 wavelengths are ten launches, of which one is timed. Neither time includes
start-up or compilation. "Equal error" multiplies Mitsuba's time by the square of the ratio of the standard errors of
one wavelength, both taken over batches.
"""
import argparse
import json
import math
import statistics
import subprocess

import numpy as np

SCENE = "bumpy-soap-film"
INCIDENT = (16, 32)
WAVELENGTHS = [385.0 + 10 * i for i in range(40)]
COMPARED = 19  # 575 nm: near the wavelength at which Mitsuba's constant indices hold
BEYOND, MAX_DEVIATION, MAX_SHARE = 3.0, 4.0, 0.01

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("--full", action="store_true")
parser.add_argument("--index", type=float)
options = parser.parse_args()

mesh = json.loads(subprocess.run([options.program, "mesh", SCENE], check=True, capture_output=True).stdout)
for sheet in mesh["sheets"] if options.index else []:
    for side in ("above", "below"):
        sheet[side] = options.index if sheet[side] > 1.1 else sheet[side]

import mitsuba_cell  # noqa: E402  after the arguments: it takes seconds to load
from mitsuba_cell import LANES, dr, mi  # noqa: E402

cell = mitsuba_cell.Cell(mesh)
worker = subprocess.Popen([options.program, "scatter", SCENE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def direction(row):
    column = 13 * row % INCIDENT[1]
    return (row + 0.5) / INCIDENT[0] * math.pi / 2, 2 * math.pi * (2 * column + 0.5) / 64


def ours(row, rays, bins, threads=2, coherence="none", wavelengths=WAVELENGTHS, seed=1):
    theta, phi = direction(row)
    task = {"coherence": coherence, "rays": rays, "seed": seed, "cos": bins[0], "phi": bins[1], "threads": threads}
    task |= {"theta_i": theta, "phi_i": phi, "wavelengths": wavelengths}
    print(json.dumps(task), file=worker.stdin, flush=True)
    line = worker.stdout.readline()
    if not line:
        raise SystemExit(f"{options.program} ended early")
    return json.loads(line)


def over_batches(of):
    """Mean and standard error over the first axis."""
    return of.mean(0), of.std(0, ddof=1) / math.sqrt(len(of))


def agree(rows):
    """Exits unless the reflected light agrees."""
    side, batches, bins = 64, 128, (8, 16)
    deviations, totals = [], []
    for row in rows:
        found = ours(row, 8192, bins, wavelengths=[WAVELENGTHS[COMPARED]], seed=5)
        _, _, power, rest = cell.trace(*direction(row), side, batches, bins, seed=9)
        power = power[0]
        got, error = np.array(found["bins"][0]).T
        want, want_error = over_batches(power)
        # A path carries about the light of its ray, so n of them are known to 1/sqrt(n) at best, even where batches
        # hold few.
        counted = np.maximum(got, want) / (side * side * batches)
        deviations += list((got - want) / np.sqrt(error**2 + np.maximum(want_error**2, counted) + 1e-30))
        (got, error), (want, want_error) = found["reflected"][0], over_batches(power.sum(1))
        totals.append((got - want) / math.hypot(error, want_error))
        theta = math.degrees(direction(row)[0])
        both = f"reflected {got:.5f} +- {error:.5f}, Mitsuba {want:.5f} +- {want_error:.5f}"
        print(f"{theta:4.1f} deg: {both}, lost {rest[1]:.1e}")
    worst, worst_total = np.abs(deviations).max(), np.abs(totals).max()
    beyond = np.mean(np.abs(deviations) > BEYOND)
    bins = f"worst {worst:.2f} standard errors, {beyond:.2%} beyond {BEYOND:g}"
    print(f"{len(deviations)} bins: {bins}; totals: {worst_total:.2f}")
    if not (worst <= MAX_DEVIATION and worst_total <= MAX_DEVIATION and beyond <= MAX_SHARE):
        raise SystemExit("goniochrome and Mitsuba disagree")


def rms(errors):
    return math.sqrt(np.mean(np.square(errors)))


def time_both(rows, turns, threads, rays, side):
    """Medians over alternating turns for each direction and program: seconds (wall, processor), errors (total,
    bins)."""
    bins, batches = (32, 64), 32
    dr.set_thread_count(threads)
    cell.trace(*direction(rows[0]), side, batches, bins, seed=0)  # compiles
    results = []
    for row in rows:
        mine, peer = [], []
        for turn in range(turns):
            found = ours(row, rays, bins, threads, seed=turn)
            total, each = found["reflected"][COMPARED][1], rms(np.array(found["bins"][COMPARED])[:, 1])
            mine.append((found["seconds"], found["processor_seconds"], total, each))
            seconds, used, power, _ = cell.trace(*direction(row), side, batches, bins, seed=turn + 1)
            launches = len(WAVELENGTHS) / LANES
            total, each = over_batches(power[0].sum(1))[1], rms(over_batches(power[0])[1])
            peer.append((seconds * launches, used * launches, total, each))
        results.append([[statistics.median(column) for column in zip(*of)] for of in (mine, peer)])
    return np.array(results)


def report(rows, threads, turns, rays, side):
    results = time_both(rows, turns, threads, rays, side)
    mine, peer = results[:, 0], results[:, 1]
    counts = np.array([rays, 32 * side * side])
    clocks = [("wall", 0), ("processor", 1)]
    print(f"\n{threads} thread(s), {len(rows)} directions, medians of {turns} alternating turns")
    print("| clock | goniochrome, 10^6 rays x wavelengths/s | Mitsuba | ratio | equal albedo error | equal bin error |")
    print("|---|---|---|---|---|---|")
    for name, clock in clocks:
        rate = counts * len(WAVELENGTHS) * len(rows) / results[:, :, clock].sum(0) / 1e6
        time = peer[:, clock].sum() / mine[:, clock].sum()
        equal = [time * np.mean(peer[:, of] ** 2) / np.mean(mine[:, of] ** 2) for of in (2, 3)]
        rates = f"{rate[0]:.3f} | {rate[1]:.3f} | {rate[0] / rate[1]:.3f}"
        print(f"| {name} | {rates} | {equal[0]:.2f} x | {equal[1]:.2f} x |")
    scale = INCIDENT[0] * INCIDENT[1] / len(rows)
    seconds = mine[:, 0].sum() * scale
    factor = [np.mean(peer[:, of] ** 2) / np.mean(mine[:, of] ** 2) for of in (2, 3)]
    peer_seconds = peer[:, 0].sum() * scale
    print(
        f"16 x 32 directions, scaled from these: {rays} rays in {seconds:.0f} s; Mitsuba at equal error of albedo "
        f"{peer_seconds * factor[0]:.0f} s, of bins {peer_seconds * factor[1]:.0f} s"
    )
    print("\n| theta | goniochrome s | error of albedo, rms bin | Mitsuba s | errors | equal albedo error | equal bin error |")
    print("|---|---|---|---|---|---|---|")
    for row, a, b in zip(rows, mine, peer):
        times = [b[1] / a[1] * (b[of] / a[of]) ** 2 if a[1] and a[of] else math.inf for of in (2, 3)]
        print(
            f"| {math.degrees(direction(row)[0]):.1f} | {a[1]:.2f} | {a[2]:.1e}, {a[3]:.1e} "
            f"| {b[1]:.2f} | {b[2]:.1e}, {b[3]:.1e} | {times[0]:.3g} x | {times[1]:.3g} x |"
        )
    print("(processor seconds in this table)")


print(f"Mitsuba {mi.__version__}, {mitsuba_cell.VARIANT} (single precision), Embree, LLVM {dr.detail.llvm_version()}")
print("goniochrome: f32, coherence none\n")
rows = [0, 2, 4, 6, 9, 11, 13, 15] if options.full else [1, 6, 12]
agree(rows)
for threads in (1, 2) if options.full else (2,):
    report(rows, threads, 3 if options.full else 2, 2048 if options.full else 512, 64)
if options.full:
    spent = [ours(row, 256, (32, 64), 2, "ray") for row in rows]
    wall, used = (sum(of[key] for of in spent) for key in ("seconds", "processor_seconds"))
    work = 256 * len(WAVELENGTHS) * len(rows) / 1e6
    rates = f"{work / wall:.4f} x 10^6 rays x wavelengths/s in wall-clock time, {work / used:.4f} in processor time"
    print(f"\ncoherence ray, 2 threads: {rates}")
worker.stdin.close()
worker.wait()
