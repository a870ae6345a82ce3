"""Times nearest hits on several teapots by Embree and goniochrome in turn, one thread. Fails if hits differ."""
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
# Quads along the edge of each of 32 patches.
MESHES = [(9, "incoherent"), (40, "incoherent"), (125, "incoherent"), (32, "primary")]
# Embree works in single precision: rays that graze an edge may differ, and distances round.
MAX_STRAYS = 1e-3
DISTANCE = 1e-3


def compare(level, kind):
    seconds = {"Embree": [], "batch": [], "one by one": []}
    for _ in range(TURNS):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.argv[1], folder, str(REPEATS), str(level), kind]
            ours = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
            for method in ("batch", "one by one"):
                seconds[method] += ours[method]
            read = lambda name, kind: np.frombuffer((pathlib.Path(folder) / name).read_bytes(), kind)
            vertices = read("vertices.f32", "<f4").reshape(-1, 3)
            triangles = read("triangles.i32", "<i4").reshape(-1, 3)
            origins = read("origins.f32", "<f4").reshape(-1, 3).copy()
            directions = read("directions.f32", "<f4").reshape(-1, 3).copy()
            expected = read("distances.f64", "<f8")
        scene = rtcore_scene.EmbreeScene()
        mesh = TriangleMesh(scene, vertices[triangles])
        # The first query builds the hierarchy.
        scene.run(origins[:1], directions[:1], query="DISTANCE")
        for _ in range(REPEATS):
            start = time.process_time()
            # Distances: no query of Embree's binding returns less.
            found = scene.run(origins, directions, query="DISTANCE")
            seconds["Embree"].append(time.process_time() - start)
    hit, met = expected < np.inf, found < 1e30
    strays = np.count_nonzero(hit != met) / len(hit)
    apart = np.count_nonzero(np.abs(found - expected)[hit & met] > DISTANCE) / len(hit)
    theirs, batch, ones = (len(hit) / statistics.median(times) / 1e6 for times in seconds.values())
    print(f"{len(triangles):9} {kind:11} {hit.mean():5.0%} {theirs:9.2f} {batch:10.2f} {batch / theirs:6.2f} "
          f"{ones:12.2f} {ones / theirs:6.2f}   {strays:.1e}, {apart:.1e}", flush=True)
    if strays > MAX_STRAYS or apart > MAX_STRAYS:
        sys.exit("hits differ")


print("million rays per second of processor time, 1 thread: Embree in single precision, goniochrome in double, in a "
      "batch (intersect_batch) and one by one (intersect_nearest), each with its ratio to Embree; shares of rays of "
      "which only one program finds a hit, and of rays whose distances differ")
print(f"{'triangles':>9} {'rays':11} {'hit':>5} {'Embree':>9} {'batch':>10} {'ratio':>6} "
      f"{'one by one':>12} {'ratio':>6}   differ")
for mesh in MESHES:
    compare(*mesh)
