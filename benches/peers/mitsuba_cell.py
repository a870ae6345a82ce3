"""A polygon cell in Mitsuba 3: light from one direction, with Mitsuba's dielectrics, intersections and Stokes vectors.

One mesh holds one period. Rays that leave it at one side come in at the opposite one, inside a symbolic Dr.Jit loop. At
each hit the BSDF draws reflection or refraction. The light is unpolarised and only powers count: Mitsuba has no
interference.
"""
import math
import time

import numpy as np

import drjit as dr
import mitsuba as mi

VARIANT = "llvm_ad_spectral_polarized"
mi.set_variant(VARIANT)

# Wavelengths that one of Mitsuba's spectral rays carries.
LANES = 4
# Micrometres: coordinates near 1 round best against Mitsuba's offset of ray origins.
UNIT_NM = 1000.0
MAX_HITS = 10_000


class Cell:
    def __init__(self, mesh):
        self.period = [length / UNIT_NM for length in mesh["period_nm"]]
        vertices = np.array(mesh["vertices"]) / UNIT_NM
        vertices[:, :2] -= np.array(self.period) / 2
        self.bottom, self.top = float(vertices[:, 2].min()), float(vertices[:, 2].max())
        scene, bsdfs = {"type": "scene"}, {}
        for index, sheet in enumerate(mesh["sheets"]):
            triangles = np.array(sheet["triangles"])
            outside, inside = sheet["above"], sheet["below"]
            if outside > inside:  # one BSDF for both faces of a film spares Mitsuba its virtual calls
                triangles, outside, inside = triangles[:, ::-1], inside, outside
            key = (outside, inside)
            if key not in bsdfs:
                bsdfs[key] = mi.load_dict({"type": "dielectric", "ext_ior": outside, "int_ior": inside})
            properties = mi.Properties()
            properties["bsdf"] = bsdfs[key]
            properties["face_normals"] = True
            shape = mi.Mesh(sheet["name"], len(vertices), len(triangles), props=properties)
            parameters = mi.traverse(shape)
            parameters["vertex_positions"] = np.ravel(vertices).astype(np.float32)
            parameters["faces"] = np.ravel(triangles).astype(np.uint32)
            parameters.update()
            scene[f"sheet{index}"] = shape
        self.scene = mi.load_dict(scene)

    def trace(self, theta, phi, side, batches, bins, seed):
        """Traces `batches` of side x side rays, jittered on a grid over the period. Returns wall-clock and processor
        seconds, the power reflected in [wavelength, batch, bin], and totals [transmitted, lost]."""
        wi = [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]
        direction = mi.Vector3f(*[-component for component in wi])
        number = mi.UInt64(seed)
        dr.make_opaque(direction, number)
        dr.sync_thread()
        start, used = time.perf_counter(), time.process_time()
        histograms, totals = self._launch(direction, number, side, batches, bins)
        dr.eval(histograms, totals)
        dr.sync_thread()
        seconds, used = time.perf_counter() - start, time.process_time() - used
        rays = side * side
        power = np.array([np.array(of) for of in histograms]).reshape(LANES, batches, bins[0] * bins[1]) / rays
        return seconds, used, power, np.array(totals) / (rays * batches)

    def _launch(self, direction, number, side, batches, bins):
        count = side * side * batches
        index = dr.arange(mi.UInt32, count)
        random = mi.PCG32(size=count, initstate=number)
        cell = index % (side * side)
        u = (mi.Float(cell % side) + random.next_float32()) / side
        v = (mi.Float(cell // side) + random.next_float32()) / side
        half = [length / 2 for length in self.period]
        position = mi.Point3f((2 * u - 1) * half[0], (2 * v - 1) * half[1], self.top)
        direction = mi.Vector3f(direction.x, direction.y, direction.z) + dr.zeros(mi.Vector3f, count)
        wavelengths = mi.UnpolarizedSpectrum(450, 500, 550, 600)
        stokes = [mi.UnpolarizedSpectrum(1), *[mi.UnpolarizedSpectrum(0) for _ in range(3)]]
        stokes = [part + dr.zeros(mi.UnpolarizedSpectrum, count) for part in stokes]
        context = mi.BSDFContext(mi.TransportMode.Importance)

        def body(active, position, direction, stokes, random, hits):
            def crossing(at, towards, half):
                distance = (dr.copysign(half, towards) - at) / towards
                return dr.maximum(dr.select(towards == 0, dr.inf, distance), 0)

            cross_x = crossing(position.x, direction.x, half[0])
            cross_y = crossing(position.y, direction.y, half[1])
            leaves = dr.minimum(cross_x, cross_y)
            end = dr.select(direction.z > 0, self.top - position.z, self.bottom - position.z) / direction.z
            ray = mi.Ray3f(position, direction, leaves, 0.0, wavelengths)
            interaction = self.scene.ray_intersect(ray, active)
            hit = active & interaction.is_valid()
            sample, weight = interaction.bsdf(ray).sample(
                context, interaction, random.next_float32(), mi.Point2f(0.5, 0.5), hit
            )
            weight = interaction.to_world_mueller(weight, -interaction.wi, sample.wo)
            after = [sum(weight[row, column] * stokes[column] for column in range(4)) for row in range(4)]
            onward = interaction.spawn_ray(interaction.to_world(sample.wo))
            wrapped = ray(leaves)
            wrapped.x = dr.select(cross_x <= cross_y, -dr.copysign(half[0], direction.x), wrapped.x)
            wrapped.y = dr.select(cross_y <= cross_x, -dr.copysign(half[1], direction.y), wrapped.y)
            out = active & ~hit & (leaves >= end)
            position = dr.select(hit, onward.o, dr.select(active & ~out, wrapped, position))
            direction = dr.select(hit, onward.d, direction)
            stokes = [dr.select(hit, new, old) for new, old in zip(after, stokes)]
            hits += mi.UInt32(1)
            return active & ~out & (hits < MAX_HITS), position, direction, stokes, random, hits

        active, position, direction, stokes, random, hits = dr.while_loop(
            (mi.Bool(True) & (index < count), position, direction, stokes, random, dr.zeros(mi.UInt32, count)),
            lambda active, *rest: active,
            body,
        )
        power = stokes[0]
        up = ~active & (direction.z > 0)
        azimuth = dr.atan2(direction.y, direction.x) / dr.two_pi
        azimuth = dr.select(azimuth < 0, azimuth + 1, azimuth)
        row = dr.minimum(mi.UInt32(direction.z * bins[0]), bins[0] - 1)
        column = dr.minimum(mi.UInt32(azimuth * bins[1]), bins[1] - 1)
        place = (index // (side * side) * bins[0] + row) * bins[1] + column
        histograms = []
        for lane in range(LANES):
            histogram = dr.zeros(mi.Float, batches * bins[0] * bins[1])
            dr.scatter_reduce(dr.ReduceOp.Add, histogram, power[lane], place, up)
            histograms.append(histogram)
        totals = dr.zeros(mi.Float, 2)
        dr.scatter_reduce(dr.ReduceOp.Add, totals, power[0], dr.select(active, mi.UInt32(1), mi.UInt32(0)), ~up)
        return histograms, totals
