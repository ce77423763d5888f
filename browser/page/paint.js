// Draws the triangles and labels that the C++ painter of the windows builds: one WebGL 2 program, one call.
class SceneView {
  // `redraw()` draws again what nothing else draws: after a lost WebGL context, all is gone.
  constructor(engine, side, box, redraw) {
    this.engine = engine;
    this.side = side;
    [this.solid, this.texts] = box.querySelectorAll('canvas');
    this.gl = this.solid.getContext('webgl2', { antialias: false });
    if (!this.gl) throw new Error('WebGL 2');
    this.prepare();
    this.solid.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.solid.addEventListener('webglcontextrestored', () => { this.prepare(); redraw(); });
  }
  prepare() {
    const gl = this.gl, program = gl.createProgram();
    const sources = [[gl.VERTEX_SHADER, `#version 300 es
      layout(location = 0) in vec2 place; layout(location = 1) in vec4 paint; uniform vec2 pixel; out vec4 colour;
      void main() { colour = paint; gl_Position = vec4(place * pixel + vec2(-1.0, 1.0), 0.0, 1.0); }`],
      [gl.FRAGMENT_SHADER, `#version 300 es
      precision mediump float; in vec4 colour; out vec4 shown; void main() { shown = colour; }`]];
    for (const [kind, text] of sources) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.pixel = gl.getUniformLocation(program, 'pixel');
    gl.bindVertexArray(gl.createVertexArray());
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 12, 0);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 12, 8);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }
  // Pixels of the canvas, which has those of the screen, at most two per point.
  fit() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(this.solid.clientWidth * scale), height = Math.round(this.solid.clientHeight * scale);
    for (const canvas of [this.solid, this.texts]) {
      if (canvas.width !== width) canvas.width = width;
      if (canvas.height !== height) canvas.height = height;
    }
    this.scale = scale;
    return [width, height];
  }
  // `share`: of the way to what is now. A visitor who asked for little motion gets less than all.
  draw(wallSeen, share = 1) {
    const [width, height] = this.fit();
    if (width === 0 || height === 0) return;
    const { engine, side, gl } = this;
    engine.draw(side, width, height, wallSeen, share);
    gl.viewport(0, 0, width, height);
    gl.uniform2f(this.pixel, 2 / width, -2 / height);
    gl.bufferData(gl.ARRAY_BUFFER, engine.vertices(side), gl.STREAM_DRAW);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, engine.indices(side), gl.STREAM_DRAW);
    gl.drawElements(gl.TRIANGLES, engine.indexCount(side), gl.UNSIGNED_INT, 0);
    this.write(engine.labels(side));
  }
  write(labels) {
    const context = this.texts.getContext('2d');
    context.clearRect(0, 0, this.texts.width, this.texts.height);
    context.font = `${Math.round(Math.max(12 * this.scale, this.texts.height / 38))}px system-ui, sans-serif`;
    context.textBaseline = 'middle';
    const line = 1.2 * Math.max(12 * this.scale, this.texts.height / 38), placed = [];
    for (const { x, y: wanted, colour, endsThere, text: words } of labels) {
      const text = translate(words), width = context.measureText(text).width, left = endsThere ? x - width : x;
      // On a narrow screen two labels may meet: the later one goes below the earlier one.
      let y = wanted;
      const tick = /^\d+( mm)?$/.test(words);  // of the scale: it stays where it is
      if (!tick) for (const other of placed) if (left < other.right && other.left < left + width && Math.abs(y - other.y) < line) y = other.y + line;
      if (!tick) placed.push({ left, right: left + width, y });
      context.textAlign = endsThere ? 'right' : 'left';
      context.lineWidth = 3 * this.scale;
      context.strokeStyle = 'rgba(0,0,0,0.6)';
      context.strokeText(text, x, y);
      context.fillStyle = colour;
      context.fillText(text, x, y);
    }
  }
}

// A strip of the last seconds: needle depth against the wall.
class Strip {
  constructor(canvas, seconds) {
    this.canvas = canvas;
    this.seconds = seconds;
    this.points = [];
  }
  add(time, needle, wall) {
    if (this.points.length && time < this.points[this.points.length - 1][0]) this.points = [];
    this.points.push([time, needle, wall]);
    while (this.points[0][0] < time - this.seconds) this.points.shift();
  }
  draw() {
    const canvas = this.canvas, scale = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = canvas.clientWidth * scale;
    canvas.height = canvas.clientHeight * scale;
    if (this.points.length < 2) return;
    const c = canvas.getContext('2d'), end = this.points[this.points.length - 1][0];
    const x = (t) => canvas.width * (1 - (end - t) / this.seconds);
    const y = (m) => canvas.height * (0.06 + 0.88 * (m + 0.02) / 0.22);
    const line = (column, colour, dash) => {
      c.beginPath();
      this.points.forEach((p, i) => (i ? c.lineTo(x(p[0]), y(p[column])) : c.moveTo(x(p[0]), y(p[column]))));
      c.setLineDash(dash.map((d) => d * scale));
      c.strokeStyle = colour;
      c.lineWidth = 2 * scale;
      c.stroke();
    };
    line(2, '#e8ebef', [6, 5]);
    line(1, '#e69f00', []);
    c.font = `${Math.round(13 * scale)}px system-ui, sans-serif`;
    let left = 8 * scale;
    for (const [key, colour] of [['plot_needle', '#e69f00'], ['plot_wall', '#e8ebef'], ['plot_time', '#b9c2cf']]) {
      c.fillStyle = colour;
      c.fillText(say(key), left, canvas.height - 8 * scale);
      left += c.measureText(say(key)).width + 16 * scale;
    }
  }
}
