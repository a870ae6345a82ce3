"""Times one solve of a Morpho ridge (33 slices, 17 different) by goniochrome, grcwa and meent: s and p, one thread.

`waves.py PROGRAM [--orders N]`. One direction (conical) and one wavelength. The peers get the same Fourier matrices
with the same factorisation rule, computed outside of the timed part: all three solve the same truncated equations. The
peers decompose each slice; goniochrome shares decompositions between slices that differ by a shift. The programs take
turns; milliseconds are of processor time, ratios of medians within this run. Fails if efficiencies differ by more than
rounding.
"""
import importlib.metadata
import json
import resource
import statistics
import subprocess
import sys
import time
import warnings

import grcwa
import grcwa.rcwa
import meent
import numpy as np
from scipy.linalg import toeplitz

warnings.filterwarnings("ignore")

DATA = "tests/data/waves.json"
WAVELENGTH, THETA, PHI = 480.0, np.radians(30.0), np.radians(40.0)
TURNS = 7
# Solves of goniochrome in one turn, timed by the difference to a turn of one solve.
SOLVES = 50
# exp(−4π · 0.06 · 20000/480) is 2e-14: no light comes back from below it.
THICK_NM = 20000.0
# Rounding of eigenvalues, exponentials and 33 interfaces in double precision.
BETWEEN_PEERS = 1e-9

program = sys.argv[1]
orders = int(sys.argv[sys.argv.index("--orders") + 1]) if "--orders" in sys.argv else 21
half = orders // 2
case = next(case for case in json.load(open(DATA))["cases"] if case["name"] == "morpho_ridge")
below = complex(*case["below"])


def matrix(edges, values):
    """Toeplitz matrix of a piecewise constant function, over the period."""
    h = np.arange(-2 * half, 2 * half + 1)
    coefficients = np.zeros(len(h), complex)
    for left, right, value in zip(edges, edges[1:], values):
        with np.errstate(all="ignore"):
            part = (np.exp(-2j * np.pi * h * left) - np.exp(-2j * np.pi * h * right)) / (2j * np.pi * h)
        coefficients += value * np.where(h == 0, right - left, part)
    return toeplitz(coefficients[2 * half :], coefficients[2 * half :: -1])


slices = []
for layer in case["layers_from_top"]:
    epsilon = np.array([complex(*index) ** 2 for index in layer["n"]])
    plain, reciprocal = matrix(layer["edges"], epsilon), matrix(layer["edges"], 1 / epsilon)
    slices.append((layer["thickness_nm"], plain, np.linalg.inv(reciprocal), np.linalg.inv(plain)))


def run_grcwa():
    """Efficiencies [s, p][order] of reflection. One S matrix serves both polarisations."""
    # The wave travels towards −x and −y; light from (θ, φ) travels towards (θ, φ + 180°).
    # It drops the last order of those asked for, and takes no order along y where that period is short.
    periods = [[case["period_nm"], 0], [0, case["period_nm"] / (2 * orders)]]
    solver = grcwa.obj(orders + 1, *periods, 1 / WAVELENGTH, THETA, PHI + np.pi, verbose=0)
    solver.Add_LayerUniform(0.0, 1.0)
    for thickness, *_ in slices:
        solver.Add_LayerGrid(thickness, 1, 1)
    solver.Add_LayerUniform(0.0, below**2)
    solver.Init_Setup(Gmethod=0)
    # Orders in ascending sequence, as the matrices have them.
    nothing = np.zeros((orders, orders))
    sequence = np.argsort(solver.G[:, 0])
    assert list(solver.G[sequence, 0]) == list(range(-half, half + 1))
    there = np.argsort(sequence)
    for i, (_, plain, x, inverse) in enumerate(slices):
        pick = np.ix_(there, there)
        epinv = inverse[pick]
        # Its electric fields are (−E_y, E_x).
        ep2 = np.block([[plain[pick], nothing], [nothing, x[pick]]])
        kp = grcwa.rcwa.MakeKPMatrix(solver.omega, 1, epinv, solver.kx, solver.ky)
        solver.kp_list[i + 1] = kp
        q, phi = grcwa.rcwa.SolveLayerEigensystem(solver.omega, solver.kx, solver.ky, kp, ep2)
        solver.q_list[i + 1], solver.phi_list[i + 1] = q, phi
    last = len(solver.thickness_list) - 1
    _, _, s21, _ = grcwa.rcwa.GetSMatrix(0, last, solver.q_list, solver.phi_list, solver.kp_list, solver.thickness_list)
    found = []
    for p, s in ((0, 1), (1, 0)):
        solver.MakeExcitationPlanewave(p, 0, s, 0)
        _, back = grcwa.rcwa.GetZPoyntingFlux(
            solver.a0, s21 @ solver.a0, solver.omega, solver.kp_list[0], solver.phi_list[0], solver.q_list[0], byorder=1
        )
        found.append(np.real(-back * solver.normalization)[sequence])
    return found


def run_meent():
    # It has no absorbing substrate: a thick slice stands for it.
    unit = np.eye(orders)
    pieces = [*slices, (THICK_NM, unit * below**2, unit * below**2, unit / below**2)]
    solver = meent.call_mee(
        backend=0, pol=0.5, n_top=1.0, n_bot=below.real, theta=THETA, phi=PHI + np.pi, fto=[half, 0],
        wavelength=WAVELENGTH, period=[case["period_nm"]], thickness=[thickness for thickness, *_ in pieces],
        type_complex=np.complex128,
    )
    # Its time dependence is exp(+iωt).
    x, y, inverse = (np.array([np.conj(piece[i]) for piece in pieces]) for i in (2, 1, 3))
    solver._grating_type_assigned = 1
    solver._assign_grating_type = lambda: None
    result = solver.solve_for_conv(WAVELENGTH, x, y, inverse)
    return [part.de_ri.flatten() for part in (result.res_te_inc, result.res_tm_inc)]


def of_child(solves):
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    out = subprocess.run([program, DATA, str(half), str(solves)], check=True, capture_output=True, text=True).stdout
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime, json.loads(out)


def milliseconds(run):
    start = time.process_time()
    run()
    return (time.process_time() - start) * 1e3


peers = {"grcwa": run_grcwa, "meent": run_meent}
times = {name: [] for name in ("goniochrome", *peers)}
ours = of_child(1)[1]
for _ in range(TURNS):
    times["goniochrome"].append((of_child(1 + SOLVES)[0] - of_child(1)[0]) / SOLVES * 1e3)
    for name, run in peers.items():
        times[name].append(milliseconds(run))
expected = {order: efficiencies for order, efficiencies in ours["reflected"]}
print(f"N = {orders}, {ours['slices']} slices ({ours['decompositions']} decomposed by goniochrome), one thread")
base = statistics.median(times["goniochrome"])
print(f"goniochrome      {base:9.2f} ms")
failed = False
for name, run in peers.items():
    found = run()
    difference = max(
        abs(found[polarisation][order + half] - efficiencies[polarisation])
        for order, efficiencies in expected.items()
        for polarisation in (0, 1)
    )
    median = statistics.median(times[name])
    version = importlib.metadata.version(name)
    print(f"{name:8} {version:7} {median:9.2f} ms   ratio {median / base:6.1f}   largest difference {difference:.1e}")
    failed |= difference > BETWEEN_PEERS
sys.exit("efficiencies differ" if failed else 0)
