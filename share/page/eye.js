// The eye: turns about the middle of the box of x, y and t, comes near, moves aside. The box has its longest side of the image
// from -1/2 to 1/2, x to the right, y up, and time, twice as long, towards who looks along it.

const DEPTH = 2;                                                                         // of the window's time, in box units
const VIEWS = { slant: [-0.95, 0.32], front: [0, 0], side: [-Math.PI / 2, 0], top: [-Math.PI / 2, Math.PI / 2 - 0.001] };

class Eye {
    constructor() { this.look("slant"); }

    look(view) {
        [this.turn, this.tilt] = VIEWS[view];
        this.distance = view === "front" ? 3.4 : 2.9;
        this.aside = [0, view === "slant" ? 0.09 : 0]; // times stand below
    }
    rotate(dx, dy) {
        this.turn -= dx;
        this.tilt = Math.max(-1.57, Math.min(1.57, this.tilt + dy));
    }
    zoom(by) { this.distance = Math.max(0.15, Math.min(40, this.distance * by)); }
    // By parts of the picture's height.
    move(dx, dy) {
        this.aside[0] += dx * this.distance * 0.7;
        this.aside[1] -= dy * this.distance * 0.7;
    }

    // Column-major, as WebGL takes it: from the box to clip coordinates of a picture of this aspect. 39 degrees high.
    matrix(aspect) {
        const focal = 2.83, near = 0.05, far = 100, sin = Math.sin, cos = Math.cos;
        const right = [cos(this.turn), 0, -sin(this.turn)];
        const back = [sin(this.turn) * cos(this.tilt), sin(this.tilt), cos(this.turn) * cos(this.tilt)];
        const up = [-sin(this.turn) * sin(this.tilt), cos(this.tilt), -cos(this.turn) * sin(this.tilt)];
        const fit = Math.min(1, aspect / 1.55), a = (far + near) / (near - far), b = 2 * far * near / (near - far);
        const out = new Float32Array(16);
        for (let i = 0; i < 3; i++) {
            out[4 * i] = right[i] * focal * fit / aspect;
            out[4 * i + 1] = up[i] * focal * fit;
            out[4 * i + 2] = back[i] * a;
            out[4 * i + 3] = -back[i];
        }
        out[12] = this.aside[0] * focal * fit / aspect;
        out[13] = this.aside[1] * focal * fit;
        out[14] = -this.distance * a + b;
        out[15] = this.distance;
        return out;
    }

    get state() { return [this.turn, this.tilt, this.distance, ...this.aside].map((x) => Number(x.toFixed(3))); }
    set state(numbers) { [this.turn, this.tilt, this.distance, ...this.aside] = numbers; }
}

// Drag, pinch, wheel and keys on an element; `moved()` after each change.
function steer(eye, element, moved) {
    const fingers = new Map();
    const changed = (event) => {
        event.preventDefault();
        moved();
    };
    const spread = () => {
        const [a, b] = [...fingers.values()];
        return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
    };
    element.addEventListener("pointerdown", (event) => {
        element.setPointerCapture(event.pointerId);
        fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    element.addEventListener("pointermove", (event) => {
        const last = fingers.get(event.pointerId), height = element.clientHeight;
        if (!last) return;
        const before = fingers.size === 2 ? spread() : null;
        const dx = (event.clientX - last.x) / height, dy = (event.clientY - last.y) / height;
        fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (before) {
            const now = spread();
            eye.zoom(before.apart / Math.max(1, now.apart));
            eye.move((now.x - before.x) / height, (now.y - before.y) / height);
        } else if (event.shiftKey || event.buttons & 6) {
            eye.move(dx, dy);
        } else {
            eye.rotate(4 * dx, 4 * dy);
        }
        changed(event);
    });
    for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, (event) => fingers.delete(event.pointerId));
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => {
        eye.zoom(Math.exp(0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)));
        changed(event);
    }, { passive: false });
    element.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
        const by = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
        if (event.ctrlKey || event.metaKey || event.altKey || (!step && !by)) return;
        if (step && event.shiftKey) eye.move(...step);
        else if (step) eye.rotate(...step);
        else eye.zoom(by);
        event.stopPropagation();
        changed(event);
    });
}
