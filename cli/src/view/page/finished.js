// Pictures of a mirror-like table with a finish: see `finish.frag`.

/** Texels along a side of the light that facets lose around normals, and of the light by which it is drawn. */
const RETURNED_SIDE = 16;
const SEEN_SIDE = 32;

class Finished {
  constructor(renderer, shaders, finish, isSheet) {
    this.renderer = renderer;
    const { common, light, frame, surface, screen, levels } = shaders;
    // Written out, looks take software renderers a fifth less time than a loop.
    const looks = (count) => Array.from({ length: count }, (_, i) => `lookAlong(looks[${i}]);`).join(" ");
    const constants = (count) => `
      #define ALL_LOOKS ${looks(count)}
      const bool BECKMANN = ${finish.beckmann}, SEPARABLE = ${finish.separable}, SHEET = ${isSheet}, COMPENSATED = ${finish.compensated};
      const int LOOKS = ${count};
      const float RHO_STEPS = ${RHO_STEPS}.0, RETURNED_SIDE = ${RETURNED_SIDE}.0;
    `;
    const program = (tabulated) => renderer.program(
      surface, `${common}const bool TABULATED = ${tabulated};${constants(tabulated ? NORMALS : LOOKS)}${light}${frame}${levels}${shaders.finish}`,
    );
    this.analytic = program(false);
    this.tabulated = finish.facets && program(true);
    this.levels = new Levels(renderer, shaders);
    [this.albedo, this.through, this.losses] = [null, null, null];
    if (finish.compensated) {
      const sides = `const float RETURNED_SIDE = ${RETURNED_SIDE}.0, SEEN_SIDE = ${SEEN_SIDE}.0;`;
      this.around = renderer.program(screen, common + sides + levels + shaders.returned);
      this.returned = renderer.drawable(RETURNED_SIDE + 2, RETURNED_SIDE + 2, this.levels.format);
    }
    if (finish.facets) {
      const { views: [rows, sectors], seen } = finish.facets;
      this.seen = renderer.texture(this.levels.format, sectors, rows, Float32Array.from({ length: 4 * seen.length }, (_, i) => seen[i >> 2]), true);
    }
    this.setFinish(finish);
  }

  /** Takes the reflectance of the facets. */
  setFinish(finish) {
    const { renderer, levels } = this;
    this.finish = finish;
    renderer.gl.deleteTexture(this.table ?? null);
    this.table = renderer.texture(levels.format, RHO_STEPS + 1, 1, opaque(finish.rho), true);
    this.prepared = null;
  }

  /** The program that draws facets of a roughness. */
  program(alpha) {
    return alpha === TABULATED ? this.tabulated : this.analytic;
  }

  /** Prepares the albedo of a roughness, and a light. */
  prepare(alpha, light) {
    const { renderer, finish, levels } = this;
    if (this.prepared !== alpha.join()) {
      const { columns, rows, values, through } = finish.albedo(alpha);
      for (const texture of [this.albedo, this.through, this.losses]) renderer.gl.deleteTexture(texture);
      [this.albedo, this.through] =
        [values, through].map((list) => renderer.texture(levels.format, columns, rows, opaque(list), true));
      if (finish.compensated) {
        const lost = finish.losses(alpha).values;
        this.losses = renderer.texture(levels.format, lost.length, 1, Float32Array.from({ length: 4 * lost.length }, (_, i) => lost[i >> 2]), true);
        this.several = finish.several(alpha);
        this.seenAround = null;
      }
      this.prepared = alpha.join();
    }
    if (light === "white") return;
    const seen = levels.of(light);
    if (finish.compensated && this.seenAround !== seen) this.lookAround(seen);
  }

  /** Draws the light that facets lose around each normal. */
  lookAround(seen) {
    const { renderer, levels, around: { program, at }, returned } = this;
    const { gl } = renderer;
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(program);
    levels.bind(at, 0, seen);
    renderer.bind(1, this.losses, at("losses"));
    gl.bindFramebuffer(gl.FRAMEBUFFER, returned.buffer);
    gl.viewport(0, 0, RETURNED_SIDE + 2, RETURNED_SIDE + 2);
    renderer.screen();
    this.seenAround = seen;
  }

  /** Hands the looks of a picture, and the light that they see, to the shader of the body. */
  bind(alpha, picture, light) {
    const { renderer, finish, levels } = this;
    const { gl } = renderer;
    const { at } = this.program(alpha);
    renderer.bind(0, this.table, at("table"));
    renderer.bind(1, this.albedo, at("albedo"));
    renderer.bind(4, this.through, at("through"));
    if (alpha === TABULATED) renderer.bind(5, this.seen, at("seenFacets"));
    else gl.uniform2fv(at("alpha"), alpha);
    gl.uniform4fv(at("looks"), finish.looks(alpha, picture));
    if (finish.compensated) {
      renderer.bind(6, this.losses, at("losses"));
      renderer.bind(7, this.returned.texture, at("returnedLight"));
      gl.uniform3fv(at("several"), this.several);
    }
    if (light === "white") return;
    const seen = levels.of(light);
    levels.bind(at, 2, seen);
    gl.uniform1f(at("sharpness"), Finish.sharpness(alpha, picture, seen.side));
  }
}
