// The box around the cloud: its edges, ends of x and y, and times along the edge that lies lowest. Behind the points.

// A length of 1, 2 or 5 times a power of ten, of which some five go into `span`.
function roundStep(span) {
    const power = 10 ** Math.floor(Math.log10(span / 5)), part = span / 5 / power;
    return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

class Axes {
    constructor(canvas, box, width, height) {
        this.context = canvas.getContext("2d");
        Object.assign(this, { box, width, height });
    }

    // Where a place of the box, each coordinate -1 to 1, is on the canvas; null behind the eye.
    #project(matrix, ...corner) {
        const { canvas } = this.context, [x, y, z] = corner.map((c, i) => c * this.box[i]);
        const clip = (row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row];
        const w = clip(3);
        if (w < 0.05) return null;
        return { x: canvas.width / 2 * (1 + clip(0) / w), y: canvas.height / 2 * (1 - clip(1) / w) };
    }

    #line(a, b) {
        if (!a || !b) return;
        this.context.beginPath();
        this.context.moveTo(a.x, a.y);
        this.context.lineTo(b.x, b.y);
        this.context.stroke();
    }

    draw(matrix, window, { line, soft }, ratio) {
        const { context } = this, ends = [-1, 1];
        context.clearRect(0, 0, context.canvas.width, context.canvas.height);
        context.strokeStyle = line;
        context.fillStyle = soft;
        context.lineWidth = ratio;
        context.font = `${12 * ratio}px system-ui, sans-serif`;
        context.textAlign = "center";
        context.textBaseline = "middle";
        this.taken = []; // by labels: where one stands there is no room for another
        for (const a of ends)
            for (const b of ends) {
                this.#line(this.#project(matrix, -1, a, b), this.#project(matrix, 1, a, b));
                this.#line(this.#project(matrix, a, -1, b), this.#project(matrix, a, 1, b));
                this.#line(this.#project(matrix, a, b, -1), this.#project(matrix, a, b, 1));
            }
        this.#times(matrix, window, ratio);
        this.#pixels(matrix, ratio);
    }

    // Away from the middle of the picture of the box.
    #label(matrix, at, text, ratio) {
        const middle = this.#project(matrix, 0, 0, 0);
        if (!at || !middle) return;
        const dx = at.x - middle.x, dy = at.y - middle.y, far = Math.hypot(dx, dy) || 1;
        const x = at.x + 24 * ratio * dx / far, y = at.y + 14 * ratio * dy / far;
        const half = this.context.measureText(text).width / 2 + 3 * ratio, high = 8 * ratio;
        const apart = (one) => Math.abs(x - one.x) >= half + one.half || Math.abs(y - one.y) >= 2 * high;
        if (!this.taken.every(apart)) return;
        this.taken.push({ x, y, half });
        this.context.fillText(text, x, y);
    }

    // Of the box's edges along one axis the one that `better` likes most: [a, b] of the two other coordinates.
    #edge(matrix, axis, better) {
        let best = null, chosen = null;
        for (const a of [-1, 1])
            for (const b of [-1, 1]) {
                const corner = [a, b];
                corner.splice(axis, 0, 0);
                const at = this.#project(matrix, ...corner);
                if (at && (!best || better(at, best))) [best, chosen] = [at, [a, b]];
            }
        return chosen;
    }

    #times(matrix, window, ratio) {
        const edge = this.#edge(matrix, 2, (a, b) => a.y > b.y), span = window.to - window.from, step = roundStep(span);
        const near = edge && this.#project(matrix, ...edge, 1), far = edge && this.#project(matrix, ...edge, -1);
        if (!near || !far || Math.hypot(near.x - far.x, near.y - far.y) < 90 * ratio) return; // seen along time
        for (let t = Math.ceil(window.from / step) * step; t <= window.to; t += step) {
            const z = 2 * (t - window.from) / span - 1;
            this.#label(matrix, this.#project(matrix, ...edge, z), timeText(t, step, Math.abs(window.to)), ratio);
        }
    }

    #pixels(matrix, ratio) {
        const x = this.#edge(matrix, 0, (a, b) => a.y > b.y), y = this.#edge(matrix, 1, (a, b) => a.x < b.x);
        const along = (a, b, middle, text) => {
            if (a && b && Math.hypot(a.x - b.x, a.y - b.y) > 60 * ratio) this.#label(matrix, middle, text, ratio);
        };
        const at = (...corner) => this.#project(matrix, ...corner);
        if (x) along(at(-1, ...x), at(1, ...x), at(0, ...x), `x: ${this.width} px`);
        if (y) along(at(y[0], -1, y[1]), at(y[0], 1, y[1]), at(y[0], 0, y[1]), `y: ${this.height} px`);
    }
}
