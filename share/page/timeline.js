// All of the recording's time: its rate, ON above OFF, and the window, which is dragged as a whole or by its ends.

const BINS = 1000, GRIP = 8; // px around an end that take it

class Timeline {
    constructor(canvas, recording, moved) {
        this.context = canvas.getContext("2d");
        this.recording = recording;
        this.rate = recording.rate(BINS);
        let peak = 0;
        for (let i = 0; i < BINS; i++) peak = Math.max(peak, this.rate.on[i], this.rate.off[i]);
        this.peak = peak || 1;
        this.#drag(canvas, moved);
    }

    #drag(canvas, moved) {
        let held = null; // what of the window is held: "from", "to", or where in it
        const perPixel = () => this.recording.span / canvas.clientWidth;
        const time = (event) => (event.clientX - canvas.getBoundingClientRect().left) * perPixel();
        const drag = (event) => {
            const t = time(event), { from, to } = this.window;
            if (held === "from") moved(Math.min(t, to - 1), to);
            else if (held === "to") moved(from, Math.max(t, from + 1));
            else moved(t - held, t - held + to - from);
        };
        canvas.addEventListener("pointerdown", (event) => {
            const t = time(event), { from, to } = this.window, grip = GRIP * perPixel();
            const wide = to - from > 3 * grip; // else there would be no place to take it as a whole
            canvas.setPointerCapture(event.pointerId);
            if (wide && Math.abs(t - from) < grip) held = "from";
            else if (wide && Math.abs(t - to) < grip) held = "to";
            else held = t > from - grip && t < to + grip ? t - from : (to - from) / 2;
            drag(event);
        });
        canvas.addEventListener("pointermove", (event) => { if (held !== null) drag(event); });
        for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { held = null; });
    }

    // The rate, as it stays while the window moves: 2000 bars at each picture would take longer than the cloud.
    #drawRate(width, height, { soft, line }, [off, on], ratio) {
        const { rate, peak } = this, still = new OffscreenCanvas(width, height), context = still.getContext("2d");
        const middle = Math.round(0.5 * (height - 14 * ratio)), bar = width / BINS, tall = (middle - 4 * ratio) / peak;
        context.fillStyle = on;
        for (let i = 0; i < BINS; i++) context.fillRect(i * bar, middle, Math.max(1, bar), -tall * rate.on[i]);
        context.fillStyle = off;
        for (let i = 0; i < BINS; i++) context.fillRect(i * bar, middle, Math.max(1, bar), tall * rate.off[i]);
        this.#ticks(context, soft, line, ratio);
        return still;
    }

    draw(window, style, polarity, ratio) {
        const { context } = this, { width, height } = context.canvas;
        if (width === 0 || height === 0) return;
        this.window = window;
        if (this.style !== style || this.still.width !== width || this.still.height !== height)
            this.still = this.#drawRate(width, height, style, polarity, ratio);
        this.style = style;
        context.clearRect(0, 0, width, height);
        context.drawImage(this.still, 0, 0);
        const left = window.from / this.recording.span * width, right = window.to / this.recording.span * width;
        context.globalAlpha = 0.16;
        context.fillStyle = style.mark;
        context.fillRect(left, 0, Math.max(right - left, 2 * ratio), height);
        context.globalAlpha = 1;
        context.fillRect(left - ratio, 0, 2 * ratio, height);
        context.fillRect(right - ratio, 0, 2 * ratio, height);
        const { canvas } = context, start = timeText(window.from, window.to - window.from);
        canvas.setAttribute("aria-valuemin", 0);
        canvas.setAttribute("aria-valuemax", Math.round(this.recording.span));
        canvas.setAttribute("aria-valuenow", Math.round(window.from));
        canvas.setAttribute("aria-valuetext", `${start} to ${timeText(window.to, window.to - window.from)}`);
    }

    #ticks(context, soft, line, ratio) {
        const { width, height } = context.canvas, { span } = this.recording, step = roundStep(span / 2);
        context.font = `${11 * ratio}px system-ui, sans-serif`;
        context.textBaseline = "bottom";
        let taken = -Infinity; // up to where labels stand
        for (let t = 0; t <= span; t += step) {
            const x = t / span * width, text = timeText(t, step, span), long = context.measureText(text).width;
            context.fillStyle = line;
            context.fillRect(x, 0, ratio, height - 14 * ratio);
            context.fillStyle = soft;
            context.textAlign = t === 0 ? "left" : x > 0.95 * width ? "right" : "center";
            const left = t === 0 ? 0 : x > 0.95 * width ? x - long : x - long / 2;
            if (left < taken + 4 * ratio) continue;
            taken = left + long;
            context.fillText(text, x, height - ratio);
        }
    }
}
