"""Primary rays of a 1024 x 1024 picture on the teapot, one thread: Embree and goniochrome, in turns. Fails if hits differ."""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

TURNS = 3
REPEATS = 3
# Embree works in single precision: rays that graze an edge may differ, and distances round.
MOST_STRAYS = 1e-4
DISTANCE = 1e-3

seconds = {"embree": [], "goniochrome": []}
for turn in range(TURNS):
    with tempfile.TemporaryDirectory() as folder:
        out = subprocess.run([sys.argv[1], folder, str(REPEATS)], check=True, capture_output=True)
        ours = json.loads(out.stdout)
        seconds["goniochrome"] += ours["seconds"]
        read = lambda name, kind: np.frombuffer((pathlib.Path(folder) / name).read_bytes(), kind)
        vertices = read("vertices.f32", "<f4").reshape(-1, 3)
        triangles = read("triangles.i32", "<i4").reshape(-1, 3)
        directions = read("directions.f32", "<f4").reshape(-1, 3).copy()
        expected = read("distances.f64", "<f8")
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, vertices[triangles])
    origins = np.tile(np.float32(ours["eye"]), (len(directions), 1))
    for _ in range(REPEATS):
        start = time.perf_counter()
        # Distances: the least that Embree's binding returns.
        found = scene.run(origins, directions, query="DISTANCE")
        seconds["embree"].append(time.perf_counter() - start)

hit = expected < np.inf
met = found < 1e30
strays = np.count_nonzero(hit != met) / len(hit)
both = hit & met
apart = np.abs(found[both] - expected[both])
print(f"{len(triangles)} triangles, {len(hit)} rays, {np.count_nonzero(hit)} hits; strays {strays:.1e}, "
      f"distances within {DISTANCE:g} for all but {np.count_nonzero(apart > DISTANCE)} rays")
assert strays <= MOST_STRAYS and np.count_nonzero(apart > DISTANCE) <= MOST_STRAYS * len(hit)
for name, values in seconds.items():
    median = statistics.median(values)
    print(f"{name:12} {median:7.3f} s  {len(hit) / median / 1e6:6.2f} million rays/s")
