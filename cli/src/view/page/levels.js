// Lights at levels of blur, as rough facets see them: see `levels.glsl`.

/** Texels along the finest level of a light of the page, of 0.4° on average, and along the coarsest one. */
const LEVEL_SIDES = [512, 8];
/** Largest finest level. */
const MAX_LEVEL_SIDE = 1024;
/** Standard deviation of a level's blur in radians, times its texels along a side: 1.1 to 2.5 texels. */
const BLUR = 5;

/** Number of the coarsest level, for texels along the finest one. */
const lastOf = (side) => Math.log2(side / LEVEL_SIDES[1]);
/** Width and height of a texture of all levels with their borders. */
const sizeOf = (side) => [side + 2, 2 * side - LEVEL_SIDES[1] + 2 * (lastOf(side) + 1)];

class Levels {
  constructor(renderer, { common, light, screen, levels, level }) {
    this.renderer = renderer;
    this.program = renderer.program(screen, common + light + levels + level);
    const { gl } = renderer;
    // Without this extension, textures of floats cannot be filtered.
    const floats = renderer.format === gl.RGBA32F && gl.getExtension("OES_texture_float_linear");
    this.format = floats ? gl.RGBA32F : gl.RGBA16F;
    /** Lights by their name. */
    this.lights = {};
  }

  forgetImage() {
    this.renderer.gl.deleteTexture(this.lights.image?.texture ?? null);
    delete this.lights.image;
  }

  /** A light: its texture, and the texels along its finest level. */
  of(name) {
    this.lights[name] ??= this.drawn(name);
    return this.lights[name];
  }

  drawn(name) {
    const { renderer, format } = this;
    const { gl } = renderer;
    // Texels are as small as those of the image.
    const side = name === "image" ? 2 ** clamp(Math.ceil(Math.log2(1.2 * renderer.rows)), 5, Math.log2(MAX_LEVEL_SIDE)) : LEVEL_SIDES[0];
    const last = lastOf(side);
    const texture = renderer.texture(format, ...sizeOf(side), null, true);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    const scratch = renderer.drawable(side + 2, side + 2, format);
    const { program, at } = this.program;
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(program);
    renderer.lighten(this.program, { light: name, turn: 0 });
    const light = { texture, side };
    this.bind(at, 0, light);
    for (let level = 0; level <= last; level += 1) {
      const size = side / 2 ** level;
      gl.bindFramebuffer(gl.FRAMEBUFFER, scratch.buffer);
      gl.viewport(0, 0, size + 2, size + 2);
      gl.uniform1f(at("level"), level);
      // Variances add up: three quarters of a level's are new.
      gl.uniform1f(at("blur"), (Math.sqrt(0.75) * BLUR) / size);
      renderer.screen();
      gl.copyTexSubImage2D(gl.TEXTURE_2D, 0, 0, 2 * (side - size + level), 0, 0, size + 2, size + 2);
    }
    gl.deleteFramebuffer(scratch.buffer);
    gl.deleteTexture(scratch.texture);
    return light;
  }

  /** Hands a light to a shader. */
  bind(at, unit, { texture, side }) {
    const { gl } = this.renderer;
    this.renderer.bind(unit, texture, at("levels"));
    gl.uniform1f(at("side"), side);
    gl.uniform1f(at("last"), lastOf(side));
    gl.uniform2fv(at("texel"), sizeOf(side).map((size) => 1 / size));
  }
}
