// The cloud of a window's events, in WebGL 2: a point for each, straight from the columns.
//
// What is too much for one picture is drawn in shares: every k-th event first, by reading the buffers with k times their
// stride, and while nothing moves the others on top, one share a picture, until all are there. How much one picture may take
// is measured.

const VERTEX = (colouring) => `#version 300 es
precision highp float;
uniform mat4 matrix;
uniform vec3 scale;         // of x, y [px] and t [ns] into the box
uniform vec3 offset;
uniform uint origin;        // time of the first event that is drawn, so that the difference is exact
uniform vec2 range;
uniform float size;
uniform sampler2D colours;
in uint t;
in uvec2 xy;
in uint label;
in vec2 value;
out vec3 colour;
void main() {
    vec3 place = vec3(vec2(xy), float(t - origin)) * scale + offset;
    gl_Position = matrix * vec4(place, 1.0);
    gl_PointSize = size;
    float at = ${colouring.glsl};
    colour = texelFetch(colours, ivec2(int(at), 0), 0).rgb;
}`;
const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 colour;
out vec4 shown;
void main() { shown = vec4(colour, 1.0); }`;

// Shares at most: a stride has 255 bytes, a value 8, a time 4.
const sharesOf = (colouring) => colouring.uniforms ? 31 : 63;

class Cloud {
    constructor(canvas, recording) {
        this.gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true, antialias: false });
        if (!this.gl) throw new Error("this browser has no WebGL 2 here: the cloud can't be drawn");
        this.recording = recording;
        this.buffers = new Map(recording.chunks.map((chunk) => [chunk, {
            t: this.#upload(chunk.t), xy: this.#upload(chunk.xy), label: this.#upload(chunk.label), value: null }]));
        this.texture = this.gl.createTexture();
        this.gl.enable(this.gl.DEPTH_TEST);
        const longest = Math.max(recording.width, recording.height);
        this.box = [recording.width / longest / 2, recording.height / longest / 2, DEPTH / 2];
    }

    #upload(array) {
        const { gl } = this, buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
        return buffer;
    }

    #shader(type, text) {
        const { gl } = this, shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
        return shader;
    }

    // From here on events have this colouring's colours.
    colour(colouring, dark) {
        const { gl } = this;
        if (this.colouring !== colouring) this.#program(colouring);
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(colouring.table(dark)));
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }

    #program(colouring) {
        const { gl } = this, program = gl.createProgram();
        gl.attachShader(program, this.#shader(gl.VERTEX_SHADER, VERTEX(colouring)));
        gl.attachShader(program, this.#shader(gl.FRAGMENT_SHADER, FRAGMENT));
        ["t", "xy", "label", "value"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`shaders: ${gl.getProgramInfoLog(program)}`);
        if (this.program) gl.deleteProgram(this.program);
        this.program = program;
        this.colouring = colouring;
        this.at = Object.fromEntries(["matrix", "scale", "offset", "origin", "range", "size"].map(
            (name) => [name, gl.getUniformLocation(program, name)]));
        for (const buffer of this.buffers.values()) { // of the colouring before
            if (buffer.value) gl.deleteBuffer(buffer.value);
            buffer.value = null;
        }
    }

    // A chunk's value buffer, made when it is first drawn.
    #value(chunk, buffer) {
        if (buffer.value) return buffer.value;
        const [a, b] = this.colouring.columns(chunk), both = new Float32Array(2 * chunk.count);
        for (let i = 0; i < chunk.count; i++) {
            both[2 * i] = a[i];
            both[2 * i + 1] = b[i];
        }
        return buffer.value = this.#upload(both);
    }

    // Share number `phase` of `step` of the window's events; phase 0 on a clear picture.
    draw(window, matrix, size, step, phase) {
        const { gl, at } = this, { canvas } = gl;
        gl.viewport(0, 0, canvas.width, canvas.height);
        if (phase === 0) gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.useProgram(this.program);
        gl.uniformMatrix4fv(at.matrix, false, matrix);
        gl.uniform2f(at.range, ...(this.colouring.uniforms ?? [0, 1]));
        gl.uniform1f(at.size, size);
        for (const piece of window.pieces) this.#piece(piece, window, step, phase);
    }

    #piece({ chunk, begin, end }, window, step, phase) {
        const { gl, at, box, recording } = this, buffer = this.buffers.get(chunk);
        const first = begin + phase, count = Math.ceil((end - first) / step);
        if (count <= 0) return;
        const perNs = 2 * box[2] / (window.to - window.from), origin = chunk.t[first];
        const pixel = 2 * box[0] / recording.width;
        gl.uniform3f(at.scale, pixel, -pixel, perNs);
        gl.uniform3f(at.offset, pixel / 2 - box[0], box[1] - pixel / 2, (chunk.first + origin - window.from) * perNs - box[2]);
        gl.uniform1ui(at.origin, origin);
        const whole = (place, from, parts, type, bytes) => {
            gl.bindBuffer(gl.ARRAY_BUFFER, from);
            gl.enableVertexAttribArray(place);
            gl.vertexAttribIPointer(place, parts, type, bytes * step, bytes * first);
        };
        whole(0, buffer.t, 1, gl.UNSIGNED_INT, 4);
        whole(1, buffer.xy, 2, gl.UNSIGNED_SHORT, 4);
        whole(2, buffer.label, 1, gl.UNSIGNED_BYTE, 1);
        gl.disableVertexAttribArray(3);
        if (this.colouring.columns(chunk)) {
            gl.bindBuffer(gl.ARRAY_BUFFER, this.#value(chunk, buffer));
            gl.enableVertexAttribArray(3);
            gl.vertexAttribPointer(3, 2, gl.FLOAT, false, 8 * step, 8 * first);
        }
        gl.drawArrays(gl.POINTS, 0, count);
    }
}

// How many events a picture may have, so that a picture takes 20 to 40 ms.
class Budget {
    constructor() { this.events = 2e6; }

    // A picture of so many took `ms` until the next could begin.
    took(ms, events) {
        if (ms > 40 && events > 0) this.events = Math.max(1e5, 0.75 * Math.min(this.events, events));
        else if (ms < 22 && events > 0.6 * this.events) this.events = Math.min(3e7, 1.25 * this.events);
    }
    stepFor(count, colouring) { return Math.max(1, Math.min(sharesOf(colouring), Math.ceil(count / this.events))); }
}
