// Renderer of the body in WebGL2: pictures, each moved by a part of a pixel, are summed in floats until the mean is
// smooth.

const LIGHTS = { white: 0, studio: 1, image: 2, lamp: 3 };
const ATTRIBUTES = ["position", "normal", "tangent", "share"];
/** Texels in a line of a long list; the shaders hold the same number. */
const LINE = 2048;

/** What `mirror.frag` draws. */
const PARTS = { reflected: 0, through: 1, straight: 2 };

class Renderer {
  /** Throws an error for the visitor if the browser cannot draw. */
  constructor(canvas, data, table) {
    this.canvas = canvas;
    const options = { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true };
    this.gl = canvas.getContext("webgl2", options);
    if (!this.gl) throw new Error("WebGL2 is missing or switched off in this browser");
    const { gl } = this;
    // A sheet is drawn over what is seen through it.
    const blends = !table.sheet || gl.getExtension("EXT_float_blend");
    if (gl.getExtension("EXT_color_buffer_float")) this.format = blends ? gl.RGBA32F : gl.RGBA16F;
    else if (gl.getExtension("EXT_color_buffer_half_float")) this.format = gl.RGBA16F;
    else throw new Error("this graphics processor cannot draw into floats, which the page needs");
    this.orders = table.diffracts ? table : null;
    /** Number of pictures after which the mean is smooth. */
    this.enough = this.orders ? this.orders.pictures : 32;
    this.prepare(data, table);
    this.restart();
  }

  prepare(data, table) {
    const { gl } = this;
    const { common, light, frame, surface, screen, ...shaders } = data.shaders;
    const body = shaders[data.table.kind];
    this.programs = {
      surface: this.program(surface, common + light + frame + body),
      background: this.program(screen, common + light + shaders.background),
      add: this.program(screen, common + shaders.add),
      display: this.program(screen, common + shaders.display),
    };
    [this.studio, this.lamp, this.spread] = [data.studio, data.lamp, data.spread];
    if (this.orders) {
      this.programs.around = this.program(screen, common + light + shaders.around);
      /** Lights on an octahedron, by their name. */
      this.octahedra = {};
    }
    /** Lights as lobes of a width see them, by their name. */
    this.wide = {};
    if (this.spread) {
      this.programs.bake = this.program(screen, common + light + shaders.bake);
      this.programs.spread = this.program(screen, common + shaders.spread);
    }
    this.surroundings = this.texture(gl.RGBA16F, 1, 1, new Float32Array([1, 1, 1, 1]), true);
    this.tables = {};
    this.nothing = gl.createVertexArray();
    if (table.scatters) this.samples = new Samples(this, data.shaders, table);
    else if (this.orders) {
      const wide = ([width, height], values) => this.texture(gl.RGBA16F, width, height, values, true);
      this.tables = {
        strengths: this.volume(table),
        albedo: wide(table.albedoNodes, opaque(table.albedo)),
        mirrored: wide(table.nodes, opaque(table.mirrored)),
        response: wide([table.response.length / 4, 1], table.response),
      };
    } else {
      this.finished = new Finished(this, data.shaders, table.finish, table.sheet);
      const rows = table.thickness?.nm.length ?? 1;
      const list = (values) => this.texture(gl.RGB32F, values.length / 3 / rows, rows, values);
      const { lookup, through } = table.every;
      this.tables = { table: list(lookup), ...(through ? { through: list(through) } : {}) };
    }
    this.bodies = Object.fromEntries(Object.entries(data.shapes).map(([name, shape]) => [name, this.body(shape)]));
    this.size = [0, 0];
  }

  shader(type, text) {
    const { gl } = this;
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`the graphics driver refuses a shader: ${gl.getShaderInfoLog(shader)}`);
    }
    return shader;
  }

  program(vertex, fragment) {
    const { gl } = this;
    const program = gl.createProgram();
    gl.attachShader(program, this.shader(gl.VERTEX_SHADER, vertex));
    gl.attachShader(program, this.shader(gl.FRAGMENT_SHADER, fragment));
    ATTRIBUTES.forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`the graphics driver refuses a program: ${gl.getProgramInfoLog(program)}`);
    }
    const places = new Map();
    return {
      program,
      at: (name) => {
        if (!places.has(name)) places.set(name, gl.getUniformLocation(program, name));
        return places.get(name);
      },
    };
  }

  texture(format, width, height, values, filtered = false) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const outer = { [gl.RGB32F]: gl.RGB, [gl.R32F]: gl.RED }[format] ?? gl.RGBA;
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, outer, gl.FLOAT, values);
    const filter = filtered ? gl.LINEAR : gl.NEAREST;
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, filtered ? gl.REPEAT : gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Strengths of orders as a texture: four orders a texel, a layer for each wavelength. */
  volume(table) {
    const { gl } = this;
    const { width, height, depth, values } = table.packed();
    const max = gl.getParameter(gl.MAX_3D_TEXTURE_SIZE);
    if (Math.max(width, height, depth) > max) throw new Error("this graphics processor takes no table of this size");
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_3D, texture);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA16F, width, height, depth, 0, gl.RGBA, gl.FLOAT, values);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
    }
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
      gl.texParameteri(gl.TEXTURE_3D, wrap, gl.CLAMP_TO_EDGE);
    }
    return texture;
  }

  /** A texture of a long list of one or four floats each, in lines. */
  list(values, channels) {
    const { gl } = this;
    const lines = Math.ceil(values.length / channels / LINE);
    const padded = new Float32Array(lines * LINE * channels);
    padded.set(values);
    return this.texture(channels === 4 ? gl.RGBA32F : gl.R32F, LINE, lines, padded);
  }

  body(shape) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [shape.positions, shape.normals, shape.tangents].forEach((values, i) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, 3, gl.SHORT, true, 0, 0);
    });
    // Without an array, the share is 0.
    if (shape.shares) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, shape.shares, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(3);
      gl.vertexAttribPointer(3, 1, gl.UNSIGNED_SHORT, true, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, shape.triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: shape.triangles.length };
  }

  /** Takes a lat-long image as the light; too large ones are averaged down. */
  setImage({ width, height, rgb }) {
    const { gl } = this;
    const max = Math.min(gl.getParameter(gl.MAX_TEXTURE_SIZE), 4096);
    const step = Math.ceil(Math.max(width, height) / max);
    const [across, down] = [Math.ceil(width / step), Math.ceil(height / step)];
    const values = new Float32Array(4 * across * down);
    for (let y = 0; y < down; y += 1) {
      for (let x = 0; x < across; x += 1) {
        const to = 4 * (y * across + x);
        let count = 0;
        for (let j = y * step; j < Math.min(height, (y + 1) * step); j += 1) {
          for (let i = x * step; i < Math.min(width, (x + 1) * step); i += 1) {
            for (let c = 0; c < 3; c += 1) values[to + c] += rgb[3 * (j * width + i) + c];
            count += 1;
          }
        }
        for (let c = 0; c < 3; c += 1) values[to + c] /= count;
        values[to + 3] = 1;
      }
    }
    gl.deleteTexture(this.surroundings);
    this.surroundings = this.texture(gl.RGBA16F, across, down, values, true);
    this.rows = down;
    if (this.octahedra?.image) {
      gl.deleteTexture(this.octahedra.image);
      delete this.octahedra.image;
    }
    this.samples?.forgetImage();
    this.finished?.levels.forgetImage();
    gl.deleteTexture(this.wide.image ?? null);
    delete this.wide.image;
    this.restart();
  }

  /** Discards the pictures drawn so far. */
  restart() {
    this.drawn = 0;
  }

  resize(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    const { gl } = this;
    [this.canvas.width, this.canvas.height] = [width, height];
    this.size = [width, height];
    for (const target of this.targets ?? []) {
      gl.deleteTexture(target.texture);
      gl.deleteFramebuffer(target.buffer);
    }
    if (this.depth) gl.deleteRenderbuffer(this.depth);
    this.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    this.targets = [0, 1, 2].map(() => {
      const texture = this.texture(this.format, width, height, null);
      const buffer = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
      return { texture, buffer };
    });
    this.restart();
  }

  bind(unit, texture, location, target = this.gl.TEXTURE_2D) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, texture);
    gl.uniform1i(location, unit);
  }

  /** A texture to draw into, with its buffer. */
  drawable(width, height, format = this.gl.RGBA16F) {
    const { gl } = this;
    const texture = this.texture(format, width, height, null, true);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return { texture, buffer };
  }

  /** A light as a surface sees it that spreads its orders: a lat-long image. */
  spreadLight(name) {
    const { gl, programs, spread } = this;
    gl.disable(gl.DEPTH_TEST);
    const [width, height] = [2 * spread.rows, spread.rows];
    const baked = this.drawable(width, height);
    gl.viewport(0, 0, width, height);
    gl.useProgram(programs.bake.program);
    this.lighten(programs.bake, { light: name, turn: 0 });
    gl.uniform2f(programs.bake.at("cells"), width, height);
    gl.uniform1i(programs.bake.at("fine"), name === "lamp" ? Math.ceil(Math.PI / height / (0.2 * this.lamp.radius)) : 2);
    this.screen();
    const done = this.drawable(width, height);
    gl.useProgram(programs.spread.program);
    this.bind(0, baked.texture, programs.spread.at("baked"));
    gl.uniform1f(programs.spread.at("concentration"), spread.concentration);
    // Some graphics processors give up on draws that take long.
    gl.enable(gl.SCISSOR_TEST);
    for (let row = 0; row < height; row += 32) {
      gl.scissor(0, row, width, 32);
      this.screen();
      gl.flush();
    }
    gl.disable(gl.SCISSOR_TEST);
    for (const { buffer } of [baked, done]) gl.deleteFramebuffer(buffer);
    gl.deleteTexture(baked.texture);
    return done.texture;
  }

  /** A light on an octahedron, in which a surface with orders looks around; spread, if its orders are. */
  octahedron(name) {
    if (this.octahedra[name]) return this.octahedra[name];
    const { gl, programs, spread } = this;
    gl.disable(gl.DEPTH_TEST);
    const latLong = spread ? this.spreadLight(name) : null;
    // Texels are as small as those of the image, or more; edges of the studio are soft.
    const rows = spread ? spread.rows : name === "image" ? this.rows : 256;
    const side = 2 ** clamp(Math.ceil(Math.log2(1.2 * rows)), 5, 11);
    const { texture, buffer } = this.drawable(side, side);
    gl.viewport(0, 0, side, side);
    gl.useProgram(programs.around.program);
    this.lighten(programs.around, { light: name, turn: 0 }, latLong);
    gl.uniform1f(programs.around.at("side"), side);
    this.screen();
    gl.deleteFramebuffer(buffer);
    if (latLong) gl.deleteTexture(latLong);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    this.octahedra[name] = texture;
    return texture;
  }

  lighten({ at }, state, surroundings = null) {
    const { gl, studio, lamp } = this;
    gl.uniform1i(at("light"), surroundings ? LIGHTS.image : LIGHTS[state.light]);
    gl.uniform2f(at("turn"), Math.sin(radians(state.turn)), Math.cos(radians(state.turn)));
    gl.uniform3fv(at("lampTowards"), lamp.towards);
    gl.uniform4f(at("lamp"), lamp.radius, lamp.edge, lamp.radiance, lamp.surroundings);
    gl.uniform3f(at("room"), studio.ceiling, studio.horizon, studio.floor);
    studio.boxes.forEach((box, i) => {
      for (const axis of ["towards", "right", "up"]) gl.uniform3fv(at(`boxes[${i}].${axis}`), box[axis]);
      gl.uniform2fv(at(`boxes[${i}].halfExtent`), box.halfExtent);
      gl.uniform1f(at(`boxes[${i}].softness`), box.softness);
      gl.uniform1f(at(`boxes[${i}].radiance`), box.radiance);
    });
    this.bind(3, surroundings ?? this.surroundings, at("surroundings"));
  }

  /** Draws one more picture and adds it to the sum, within the rectangle that shows something. */
  add(state, camera) {
    const { gl, programs } = this;
    const [width, height] = this.size;
    const looksAround = this.orders && state.light !== "white" && (this.spread || state.light !== "lamp");
    const around = looksAround ? this.octahedron(state.light) : null;
    const cube = this.samples?.cube(state.light);
    this.samples?.prepare(this.drawn);
    const alpha = this.finished && Finish.alpha(state.roughness);
    if (alpha) this.finished.prepare(alpha, state.light);
    if (this.samples && this.spread) this.wide[state.light] ??= this.spreadLight(state.light);
    const seen = camera.at(width, height);
    this.shown = state.surroundings ? [0, 0, width, height] : camera.around(width, height);
    // Roberts' R2 sequence. The first point is the middle of the pixel.
    const within = SHIFT.map((step) => (0.5 + this.drawn * step) % 1);
    const jitter = [(1 - 2 * within[0]) / width, (1 - 2 * within[1]) / height];
    gl.viewport(0, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...this.shown);
    const [latest, added] = this.targets.filter((target) => target !== this.sum);
    gl.bindFramebuffer(gl.FRAMEBUFFER, latest.buffer);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const aim = ({ at }) => {
      for (const axis of ["right", "up", "backward"]) gl.uniform3fv(at(axis), seen[axis]);
      gl.uniform2fv(at("scale"), seen.scale);
      gl.uniform2fv(at("jitter"), jitter);
    };
    if (state.surroundings) {
      gl.disable(gl.DEPTH_TEST);
      gl.useProgram(programs.background.program);
      this.lighten(programs.background, state);
      aim(programs.background);
      this.screen();
    }
    gl.enable(gl.DEPTH_TEST);
    const program = alpha ? this.finished.program(alpha) : programs.surface;
    const { at } = program;
    gl.useProgram(program.program);
    this.lighten(program, state, state.light === "white" ? null : this.wide[state.light]);
    if (around) gl.uniform1i(at("light"), LIGHTS.image);
    aim(program);
    gl.uniform3fv(at("eye"), seen.eye);
    gl.uniform2f(at("depths"), Math.max(seen.distance - 1.05, 0.02), seen.distance + 1.05);
    // The fourth place is that of the surroundings.
    Object.entries(this.tables).forEach(([name, texture], i) => {
      this.bind(i < 3 ? i : 4, texture, at(name), name === "strengths" ? gl.TEXTURE_3D : gl.TEXTURE_2D);
    });
    gl.uniform1f(at("layer"), state.layer);
    if (this.orders) this.look(at, around);
    this.samples?.bind(at, this.drawn, cube);
    if (alpha) this.finished.bind(alpha, this.drawn, state.light);
    const body = this.bodies[state.shape];
    gl.bindVertexArray(body.array);
    if (this.tables.through) this.drawSheet(body, at, state.surroundings);
    else gl.drawElements(gl.TRIANGLES, body.count, gl.UNSIGNED_SHORT, 0);

    gl.disable(gl.DEPTH_TEST);
    if (this.drawn > 0) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, added.buffer);
      gl.useProgram(programs.add.program);
      this.bind(0, this.sum.texture, programs.add.at("sum"));
      this.bind(1, latest.texture, programs.add.at("latest"));
      this.screen();
    }
    gl.disable(gl.SCISSOR_TEST);
    this.sum = this.drawn > 0 ? added : latest;
    this.drawn += 1;
  }

  /** Draws walls that light goes through: those that face away first, each over what is seen through it. */
  drawSheet(body, at, surroundings) {
    const { gl } = this;
    const draw = (part) => {
      gl.uniform1i(at("part"), part);
      gl.drawElements(gl.TRIANGLES, body.count, gl.UNSIGNED_SHORT, 0);
    };
    gl.disable(gl.DEPTH_TEST);
    if (!surroundings) draw(PARTS.straight);
    gl.enable(gl.BLEND);
    gl.enable(gl.CULL_FACE);
    for (const hidden of [gl.FRONT, gl.BACK]) {
      gl.cullFace(hidden);
      gl.blendFuncSeparate(gl.ZERO, gl.SRC_COLOR, gl.ZERO, gl.ONE);
      draw(PARTS.through);
      gl.blendFuncSeparate(gl.ONE, gl.ONE, gl.ZERO, gl.ONE);
      draw(PARTS.reflected);
    }
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
  }

  /** Sets the wavelengths at which the next picture looks. */
  look(at, around) {
    const { gl, orders } = this;
    this.bind(5, around, at("around"));
    const { looks, layers, interval } = orders.looksOf(this.drawn);
    gl.uniform4fv(at("looks"), looks);
    gl.uniform1fv(at("layers"), layers);
    gl.uniform1i(at("lookCount"), layers.length);
    gl.uniform4fv(at("stepsX"), orders.stepsX);
    gl.uniform4fv(at("stepsY"), orders.stepsY);
    gl.uniform1i(at("blocks"), orders.blocks);
    gl.uniform2fv(at("range"), orders.range);
    gl.uniform1i(at("lines"), orders.lines);
    gl.uniform2fv(at("nodes"), orders.nodes);
    gl.uniform1f(at("interval"), interval);
  }

  show(state) {
    const { gl } = this;
    const { program, at } = this.programs.display;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...this.shown);
    gl.useProgram(program);
    this.bind(0, this.sum.texture, at("sum"));
    gl.uniform1f(at("factor"), 2 ** state.exposure);
    gl.uniform1f(at("samples"), this.drawn);
    this.screen();
    gl.disable(gl.SCISSOR_TEST);
  }

  screen() {
    const { gl } = this;
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** Draws one more picture if the mean is not smooth yet; returns whether there is more to draw. */
  advance(state, camera) {
    if (this.drawn < this.enough) this.add(state, camera);
    this.show(state);
    return this.drawn < this.enough;
  }

  /** The data URL of a PNG of any size. */
  picture(state, camera, width, height, count = this.enough) {
    const before = this.size;
    this.resize(width, height);
    this.restart();
    for (let i = 0; i < count; i += 1) this.add(state, camera);
    this.show(state);
    const url = this.canvas.toDataURL("image/png");
    this.resize(...before);
    this.restart();
    return url;
  }
}
