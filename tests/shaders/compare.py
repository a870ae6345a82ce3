"""Runs the three shaders of tests/shaders/run on a texture, and compares them with the library's own look-up.

Arguments: what is compared (lut, orders, finish or facets), the folder of the shaders, the texture (.exr or .png), and
the command that looks up points. Its lines are R, G, B; for diffraction orders then the size of the terms that add up;
for a finish and for facets a fourth number, the density, and a bound of the difference for each. Facets have a texture
of their own, facets.exr in that folder.
"""
import os
import subprocess
import sys

os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"  # read by Mesa when it is loaded

import moderngl
import numpy
import OpenEXR
import png

# Half floats round values below 2 by at most 2^-11, and 16 bits by 2^-17.
TOLERANCE = 1 / 1024
# Half floats round strengths by a share of at most 2^-11. As much again is for the shaders' single precision: angles
# from approximations of the arc tangent, and directions near the horizon, where cos θ is a small difference.
RELATIVE = 2 / 2048
SIDE = 64  # points in each row and column of the list

VERTEX = """
#version 330
void main() {
    gl_Position = vec4(vec2[3](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID], 0.0, 1.0);
}
"""


def points():
    """Random points, the corners and edges of the range, and points beyond it."""
    random = numpy.random.default_rng(1).random((SIDE * SIDE, 2))
    ends = numpy.array([-0.5, 0.0, 1e-4, 0.5, 1.0 - 1e-4, 1.0, 1.5])
    corners = numpy.stack(numpy.meshgrid(ends, ends), -1).reshape(-1, 2)
    random[: len(corners)] = corners
    random[len(corners) : len(corners) + SIDE, 0] = numpy.linspace(0, 1, SIDE)  # the texels' own places
    return random.astype("f4")


def directions(random, count):
    """Directions above the horizon, some of them near it, near the normal, or on it."""
    cos = random.random(count)
    cos[::7] = 1 - 1e-3 * random.random(len(cos[::7]))
    cos[3::11] = 1e-3 + 0.02 * random.random(len(cos[3::11]))
    cos[5::64] = 1.0
    sin, phi = numpy.sqrt(1 - cos * cos), 2 * numpy.pi * random.random(count)
    return numpy.stack([sin * numpy.cos(phi), sin * numpy.sin(phi), cos], -1)


def pairs():
    """Two texels for each line: wi and a parameter; wo, of which half lie near the mirror direction, and 0, or two
    numbers, 0 and 1."""
    random = numpy.random.default_rng(2)
    count = SIDE * SIDE
    wi, wo = directions(random, count), directions(random, count)
    mirror = wi * [-1, -1, 1]
    wo[::2] = mirror[::2] + 0.2 * random.standard_normal((count // 2, 3))
    wo[:, 2] = numpy.abs(wo[:, 2])
    wo[::32, 2] *= -1  # below the horizon
    wo /= numpy.linalg.norm(wo, axis=-1, keepdims=True)
    lines = numpy.concatenate([wi, random.random((count, 1)), wo, numpy.zeros((count, 1))], -1)
    draws = numpy.concatenate([random.random((count, 2)), numpy.zeros((count, 1)), numpy.ones((count, 1))], -1)
    drawn = random.random(count) < 0.5
    lines[drawn, 4:] = draws[drawn]
    return lines.astype("f4")


def texture(context, path):
    if path.endswith(".png"):
        width, height, rows, info = png.Reader(filename=path).read()
        assert (info["bitdepth"], info["planes"], info["gamma"]) == (16, 3, 1.0), info
        texels = numpy.stack([numpy.array(row, "u2").reshape(-1, 3) for row in rows])
        dtype = "nu2"
    else:
        with OpenEXR.File(path, separate_channels=True) as file:
            channels = file.channels()
            texels = numpy.stack([channels[c].pixels for c in "RGBA" if c in channels], -1)
        dtype = {numpy.dtype("f2"): "f2", numpy.dtype("f4"): "f4"}[texels.dtype]
    height, width, depth = texels.shape
    lut = context.texture((width, height), depth, numpy.ascontiguousarray(texels).tobytes(), alignment=1, dtype=dtype)
    lut.filter = (moderngl.LINEAR, moderngl.LINEAR)
    lut.repeat_x = lut.repeat_y = False
    return lut, (width, height)


def run(context, shader, lut, at, facets=None, compensation=None):
    program = context.program(VERTEX, open(shader).read())
    names = [name for name in program if isinstance(program[name], moderngl.Uniform)]
    # spirv-cross and naga choose names that hold the variable's name or its binding; a texture may have several names.
    of_points = [name for name in names if "points" in name or "binding_2" in name]
    of_facets = [name for name in names if "facets" in name or "binding_3" in name]
    of_compensation = [name for name in names if "compensation" in name or "binding_4" in name]
    assert len(of_points) == 1 and len(names) > 1 + len(of_facets + of_compensation), names
    assert (bool(of_facets), bool(of_compensation)) == (bool(facets), bool(compensation)), names
    for name in names:
        program[name] = 3 if name in of_compensation else 2 if name in of_facets else int(name in of_points)
    # Lines of two numbers are a texel each, lines of eight are two.
    texels = max(1, at.shape[1] // 4)
    listed = context.texture((texels * SIDE, SIDE), at.shape[1] // texels, at.tobytes(), dtype="f4")
    listed.filter = (moderngl.NEAREST, moderngl.NEAREST)
    lut.use(0)
    listed.use(1)
    if facets:
        facets.use(2)
    if compensation:
        compensation.use(3)
    target = context.framebuffer([context.texture((SIDE, SIDE), 4, dtype="f4")])
    target.use()
    context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    return numpy.frombuffer(target.read(components=4, dtype="f4"), "f4").reshape(-1, 4)


def main():
    kind, folder, path, *look_up = sys.argv[1:]
    finished = kind in ("finish", "facets")
    at = pairs() if finished else points()
    asked = "\n".join(",".join(f"{float(x):.9g}" for x in line) for line in at)
    said = subprocess.run(look_up, input=asked, capture_output=True, text=True, check=True).stdout
    want = numpy.array([[float(c) for c in line.split(",")] for line in said.split()])
    channels = 4 if finished else 3
    want, said = want[:, :channels], want[:, channels:]
    allowed = {"lut": numpy.full((len(want), 1), TOLERANCE), "orders": RELATIVE * said}.get(kind, said)
    assert want.shape == (SIDE * SIDE, channels) and numpy.ptp(want) > 0.1, "the points show colours"
    context = moderngl.create_context(standalone=True, backend="egl", libgl="libGL.so.1", libegl="libEGL.so.1")
    lut, size = texture(context, path)
    facets = None
    if kind == "facets":
        facets, _ = texture(context, f"{folder}/facets.exr")
        facets.filter = (moderngl.NEAREST, moderngl.NEAREST)
    compensated = os.path.exists(f"{folder}/compensation.exr")
    compensation = texture(context, f"{folder}/compensation.exr")[0] if compensated else None
    failed = False
    for language in ("glsl", "hlsl", "wgsl"):
        got = run(context, f"{folder}/{language}.frag", lut, at, facets, compensation)[:, :channels]
        difference = numpy.abs(got - want)
        failed |= not (difference <= allowed).all()  # NaN is a failure too
        print(f"{os.path.basename(path)} {size[0]} × {size[1]}, {language} on {context.info['GL_RENDERER']}: "
              f"largest difference {difference.max():.1e} of {len(at)} points (at most {allowed.max():.1e}), "
              f"{(difference / numpy.maximum(allowed, 1e-30)).max():.2f} of what is allowed")
    sys.exit("a shader function differs from the library's look-up" if failed else 0)


if __name__ == "__main__":
    main()
