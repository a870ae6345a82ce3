// Pictures of a mirror-like table with a finish: see `finish.frag`.

class Finished {
  constructor(renderer, shaders, finish) {
    this.renderer = renderer;
    const { common, light, frame, surface, levels } = shaders;
    // Written out, looks take software renderers a fifth less time than a loop.
    const looks = Array.from({ length: LOOKS }, (_, i) => `lookAlong(looks[${i}]);`).join(" ");
    const constants = `
      #define ALL_LOOKS ${looks}
      const bool BECKMANN = ${finish.beckmann}, SEPARABLE = ${finish.separable};
      const int LOOKS = ${LOOKS};
      const float RHO_STEPS = ${RHO_STEPS}.0;
    `;
    this.program = renderer.program(surface, common + constants + light + frame + levels + shaders.finish);
    this.levels = new Levels(renderer, shaders);
    this.albedo = null;
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

  /** Prepares the albedo of a roughness, and a light. */
  prepare(alpha, light) {
    const { renderer, finish, levels } = this;
    if (this.prepared !== alpha.join()) {
      const { columns, rows, values } = finish.albedo(alpha);
      renderer.gl.deleteTexture(this.albedo);
      this.albedo = renderer.texture(levels.format, columns, rows, opaque(values), true);
      this.prepared = alpha.join();
    }
    if (light !== "white") levels.of(light);
  }

  /** Hands the looks of a picture, and the light that they see, to the shader of the body. */
  bind(alpha, picture, light) {
    const { renderer, finish, levels } = this;
    const { gl } = renderer;
    const { at } = this.program;
    renderer.bind(0, this.table, at("table"));
    renderer.bind(1, this.albedo, at("albedo"));
    gl.uniform2fv(at("alpha"), alpha);
    gl.uniform4fv(at("looks"), finish.looks(picture));
    if (light === "white") return;
    const seen = levels.of(light);
    levels.bind(at, 2, seen);
    gl.uniform1f(at("sharpness"), Finish.sharpness(alpha, picture, seen.side));
  }
}
