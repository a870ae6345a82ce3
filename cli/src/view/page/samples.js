// Samples of a scatter table, and the lights that they see: see `scatter.frag`.

/** Samples of a picture: a Fibonacci number, and the one before it. */
const SAMPLES = [55, 34];
/** Steps of Roberts' R2 sequence, by which the samples of each picture are shifted. */
const SHIFT = [0.7548776662466927, 0.5698402909980532];
/** Right, up and towards of the faces of a cube, as OpenGL orders them. */
const FACES = [
  [[0, 0, -1], [0, -1, 0], [1, 0, 0]], [[0, 0, 1], [0, -1, 0], [-1, 0, 0]], [[1, 0, 0], [0, 0, 1], [0, 1, 0]],
  [[1, 0, 0], [0, 0, -1], [0, -1, 0]], [[1, 0, 0], [0, -1, 0], [0, 0, 1]], [[-1, 0, 0], [0, -1, 0], [0, 0, -1]],
];
/** Cells along an edge of the cube that holds a light of the page: of 0.2° to 0.5°, a tenth of the lamp. */
const BUILT_IN_SIDE = 256;

/** RGB as opaque RGBA. */
const opaque = (rgb) => Float32Array.from({ length: (rgb.length / 3) * 4 }, (_, i) => (i % 4 < 3 ? rgb[3 * (i >> 2) + (i % 4)] : 1));

class Samples {
  constructor(renderer, { common, light, screen, ...shaders }, table) {
    [this.renderer, this.table] = [renderer, table];
    const { gl } = renderer;
    this.programs = {
      prepare: renderer.program(screen, common + shaders.prepare),
      settle: renderer.program(screen, common + shaders.settle),
      cube: renderer.program(screen, common + light + shaders.cube),
    };
    const [rows, columns] = table.views;
    const { atlas, sums, knots } = table.packed();
    this.atlas = renderer.list(atlas, 4);
    this.sums = renderer.list(sums, 1);
    this.knots = renderer.texture(gl.RGBA32F, knots.length / 8, 2, knots);
    this.lobes = renderer.texture(gl.RGBA32F, 3, Math.max(table.lobes.length, 1), table.packedLobes());
    this.scattered = renderer.texture(gl.RGBA16F, columns, rows, opaque(table.scattered), true);
    [this.looks, this.strengths] = [0, 1].map(() => {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
      gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA16F, columns, rows, SAMPLES[0]);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D_ARRAY, filter, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_S, gl.REPEAT);
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
      return texture;
    });
    this.buffer = gl.createFramebuffer();
    this.rest = renderer.drawable(columns, rows);
    /** The picture whose samples are prepared. */
    this.picture = -1;
    /** Lights on a cube, by their name. */
    this.cubes = {};
  }

  /** Forgets the light of an image. */
  forgetImage() {
    this.renderer.gl.deleteTexture(this.cubes.image?.texture ?? null);
    delete this.cubes.image;
  }

  /** Draws the samples of a picture for all directions of the viewer. */
  prepare(picture) {
    if (this.picture === picture) return;
    this.picture = picture;
    const { renderer, table, programs } = this;
    const { gl } = renderer;
    const [count, step] = SAMPLES;
    const [rows, columns] = table.views;
    gl.disable(gl.DEPTH_TEST);
    gl.viewport(0, 0, columns, rows);
    const { at } = programs.prepare;
    gl.useProgram(programs.prepare.program);
    [this.atlas, this.sums, this.knots].forEach((list, i) => renderer.bind(i, list, at(["atlas", "sums", "knots"][i])));
    gl.uniform2iv(at("incident"), table.incident);
    gl.uniform2iv(at("nodes"), table.nodes);
    gl.uniform2iv(at("views"), table.views);
    gl.uniform2iv(at("intervals"), table.warp.map((pairs) => pairs.length / 2 - 1));
    gl.uniform1i(at("places"), table.places);
    gl.uniform1i(at("count"), count);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffer);
    for (let i = 0; i < count; i += 1) {
      [this.looks, this.strengths].forEach((texture, n) => {
        gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + n, texture, 0, i);
      });
      gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
      const place = [(i + 0.5) / count, ((i * step) % count + 0.5) / count];
      gl.uniform2fv(at("u"), place.map((u, axis) => (u + picture * SHIFT[axis]) % 1));
      renderer.screen();
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.rest.buffer);
    gl.useProgram(programs.settle.program);
    renderer.bind(0, this.strengths, programs.settle.at("strengths"), gl.TEXTURE_2D_ARRAY);
    renderer.bind(1, this.scattered, programs.settle.at("scattered"));
    gl.uniform1i(programs.settle.at("count"), count);
    renderer.screen();
  }

  /** A light on a cube, with coarser and coarser means. */
  cube(name) {
    if (this.cubes[name]) return this.cubes[name];
    const { renderer } = this;
    const { gl } = renderer;
    // Cells are as small as those of the image at the middle of a face.
    const side = name === "image" ? 2 ** clamp(Math.ceil(Math.log2(0.5 * renderer.rows)), 4, 10) : BUILT_IN_SIDE;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_CUBE_MAP, texture);
    gl.texStorage2D(gl.TEXTURE_CUBE_MAP, Math.log2(side) + 1, gl.RGBA16F, side, side);
    gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    const { at, program } = this.programs.cube;
    gl.disable(gl.DEPTH_TEST);
    gl.viewport(0, 0, side, side);
    gl.useProgram(program);
    renderer.lighten(this.programs.cube, { light: name, turn: 0 });
    gl.uniform1f(at("side"), side);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    FACES.forEach((face, i) => {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_CUBE_MAP_POSITIVE_X + i, texture, 0);
      gl.uniformMatrix3fv(at("face"), false, face.flat());
      renderer.screen();
    });
    gl.deleteFramebuffer(buffer);
    gl.bindTexture(gl.TEXTURE_CUBE_MAP, texture);
    gl.generateMipmap(gl.TEXTURE_CUBE_MAP);
    this.cubes[name] = { texture, side };
    return this.cubes[name];
  }

  /** Hands the samples of a picture, and the light that they see, to the shader of the body. */
  bind(at, picture, { texture, side }) {
    const { renderer, table } = this;
    const { gl } = renderer;
    renderer.bind(0, this.looks, at("looks"), gl.TEXTURE_2D_ARRAY);
    renderer.bind(1, this.strengths, at("strengths"), gl.TEXTURE_2D_ARRAY);
    renderer.bind(2, this.rest.texture, at("rest"));
    // The third place is that of the surroundings.
    renderer.bind(4, this.scattered, at("scattered"));
    renderer.bind(5, texture, at("around"), gl.TEXTURE_CUBE_MAP);
    renderer.bind(6, this.atlas, at("atlas"));
    renderer.bind(7, this.lobes, at("lobes"));
    gl.uniform2iv(at("incident"), table.incident);
    gl.uniform2iv(at("views"), table.views);
    gl.uniform1i(at("places"), table.places);
    gl.uniform1i(at("lobeCount"), table.lobes.length);
    gl.uniform1i(at("count"), SAMPLES[0]);
    // The first picture is as soft as its samples are apart; later ones fill the gaps, and are sharper.
    gl.uniform1f(at("level"), Math.log2(side / 2) - 0.5 * Math.log2(picture + 1));
  }
}
