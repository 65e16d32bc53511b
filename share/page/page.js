// Everything together: the window of time, playing, controls and keys, and what is drawn when.

const SPEEDS = [1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
const $ = (id) => document.getElementById(id);

class Page {
    constructor(recording) {
        this.recording = recording;
        this.eye = new Eye();
        this.budget = new Budget();
        this.colourings = colouringsOf(recording);
        this.colouring = this.colourings[0];
        this.dark = matchMedia("(prefers-color-scheme: dark)").matches;
        this.playing = false;
        this.from = 0;
        this.length = Math.min(recording.span, Number(recording.facts.window) || recording.span / 50);
        this.speed = SPEEDS.find((speed) => speed * 1.5e10 >= recording.span) ?? SPEEDS.at(-1); // all of it in 6 to 15 s
        this.step = 1;    // shares of the picture, and the next one to be drawn
        this.phase = 0;
        this.pictures = 0;
        this.cloud = new Cloud($("points"), recording);
        this.axes = new Axes($("axes"), this.cloud.box, recording.width, recording.height);
        this.frame = new EventFrame($("frame"), recording);
        this.timeline = new Timeline($("timeline"), recording, (from, to) => this.show(from, to - from));
        steer(this.eye, $("points"), () => this.turned());
        this.readHash();
        if (!recording.window(this.from, this.from + this.length).count) this.from = this.firstEvent() - this.length / 20;
        this.connect();
        this.paint();
        this.show(this.from, this.length);
        new ResizeObserver(() => this.turned()).observe($("cloud"));
        requestAnimationFrame((now) => this.tick(now));
    }

    // -- what is shown

    // The window, kept within the recording.
    show(from, length) {
        const { span } = this.recording;
        this.length = Math.max(1, Math.min(span, Math.round(length)));
        this.from = Math.max(0, Math.min(span - this.length, Math.round(from)));
        this.window = this.recording.window(this.from, this.from + this.length);
        this.windowChanged = true;
        this.turned();
    }

    // When the first event is: the first window should hold something.
    firstEvent() {
        let [before, after] = [0, this.recording.span];
        while (after - before > 1) {
            const middle = Math.floor((before + after) / 2);
            if (this.recording.window(0, middle).count) after = middle;
            else before = middle;
        }
        return before;
    }

    // The picture of the cloud is to be made anew.
    turned() { this.phase = 0; }

    // Colours of the page, from its style; of the tables, for the cloud.
    paint() {
        document.documentElement.dataset.theme = this.dark ? "dark" : "light";
        const style = getComputedStyle(document.documentElement), named = (name) => style.getPropertyValue(`--${name}`).trim();
        this.style = { line: named("line"), soft: named("soft"), mark: named("mark") };
        this.paper = this.dark ? [27, 30, 36] : [243, 244, 246];
        const polarity = this.colourings[0].table(this.dark);
        this.polarity = [`rgb(${polarity.slice(0, 3)})`, `rgb(${polarity.slice(3, 6)})`];
        this.cloud.colour(this.colouring, this.dark);
        drawLegend($("legend"), this.colouring, this.dark);
        $("colour").value = this.colouring.name;
        this.windowChanged = true;
        this.turned();
    }

    // -- pictures

    tick(now) {
        const elapsed = now - (this.last ?? now);
        this.last = now;
        if (this.drew) this.budget.took(elapsed, this.drew);
        if (this.playing) this.advance(elapsed);
        this.drew = 0;
        if (this.windowChanged) this.drawWindow();
        if (this.phase === 0) this.begin();
        else if (this.phase < this.step) this.share();
        requestAnimationFrame((next) => this.tick(next));
    }

    // The first share, of as much as a picture may have.
    begin() {
        const ratio = devicePixelRatio, { clientWidth, clientHeight } = $("cloud");
        const width = Math.round(clientWidth * ratio), height = Math.round(clientHeight * ratio);
        for (const canvas of [$("points"), $("axes")])
            if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        this.matrix = this.eye.matrix(width / Math.max(1, height));
        this.step = this.budget.stepFor(this.window.count, this.colouring);
        this.axes.draw(this.matrix, this.window, this.style, ratio);
        this.share();
        this.pictures++;
        this.writeHash();
    }

    share() {
        this.cloud.draw(this.window, this.matrix, $("size").value * devicePixelRatio, this.step, this.phase);
        this.drew = Math.ceil(this.window.count / this.step);
        this.phase++;
        const all = countText(this.window.count);
        $("drawn").textContent = this.phase >= this.step ? `all ${all} events of the window`
            : `${this.phase} in ${this.step} of the window's ${all} events`;
    }

    drawWindow() {
        const canvas = $("timeline"), ratio = devicePixelRatio;
        const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        this.windowChanged = false;
        this.frame.draw(this.window, this.colouring, this.dark, this.paper);
        this.timeline.draw(this.window, this.style, this.polarity, ratio);
        const { from, to, count } = this.window, step = (to - from) / 100, rate = count / (1e-9 * (to - from));
        $("where").textContent = `${timeText(from, step, to)} to ${timeText(to, step)}, ${countText(count)} events, `
            + `${countText(Math.round(rate))} a second`;
        if (document.activeElement !== $("length")) $("length").value = timeText(this.length, this.length / 100);
    }

    // -- playing

    advance(elapsed) {
        const { span } = this.recording, next = this.from + 1e6 * elapsed * this.speed, last = span - this.length;
        if (next <= last) this.show(next, this.length);
        else if ($("loop").checked && last > 0) this.show(0, this.length);
        else this.play(false);
    }

    play(on) {
        this.playing = on;
        if (on && this.from >= this.recording.span - this.length) this.show(0, this.length);
        $("play").textContent = on ? "stop" : "play";
        $("play").setAttribute("aria-pressed", on);
    }

    setSpeed(speed) {
        this.speed = speed;
        $("speed").value = speed;
    }

    // -- controls

    connect() {
        const { facts } = this.recording, changed = (id, act) => $(id).addEventListener("input", act);
        for (const { name } of this.colourings) $("colour").append(new Option(name, name));
        for (const speed of SPEEDS)
            $("speed").append(new Option(speed >= 1 ? `${speed} times` : `1/${Math.round(1 / speed)}`, speed));
        $("speed").value = this.speed;
        $("title").textContent = document.title = facts.title;
        $("summary").textContent = this.summary();
        changed("colour", () => this.choose($("colour").value));
        changed("speed", () => { this.speed = Number($("speed").value); });
        changed("size", () => this.turned());
        $("length").addEventListener("change", () => {
            const length = timeOf($("length").value);
            $("length").setAttribute("aria-invalid", !(length > 0));
            if (length > 0) this.show(this.from, length);
        });
        $("play").addEventListener("click", () => this.play(!this.playing));
        $("theme").addEventListener("click", () => this.turnLights());
        for (const button of document.querySelectorAll("[data-view]"))
            button.addEventListener("click", () => this.look(button.dataset.view));
        $("frame").addEventListener("pointermove", (event) => this.tellPixel(event));
        $("frame").addEventListener("keydown", (event) => this.stepPixel(event));
        addEventListener("keydown", (event) => this.key(event));
    }

    summary() {
        const { facts, count, width, height, span } = this.recording;
        const ended = facts.ended ? ": the recording goes on, but more were too many for the page" : "";
        const start = Number(facts.start) ? ` from ${Number(facts.start) / 1e9} s on, which is 0 here` : "";
        return `${countText(count)} events, ${width} x ${height} px, ${timeText(span, span / 1000)}${start}${ended}`;
    }

    choose(name) {
        this.colouring = this.colourings.find((one) => one.name === name) ?? this.colouring;
        this.paint();
    }
    look(view) {
        this.eye.look(view);
        this.turned();
    }
    turnLights() {
        this.dark = !this.dark;
        this.paint();
    }
    // Longer or shorter about its middle.
    stretch(by) { this.show(this.from + (1 - by) * this.length / 2, by * this.length); }

    tellPixel(event) {
        const canvas = $("frame"), place = canvas.getBoundingClientRect();
        const scale = Math.min(place.width / canvas.width, place.height / canvas.height);
        const x = Math.floor((event.clientX - place.left - (place.width - scale * canvas.width) / 2) / scale);
        const y = Math.floor((event.clientY - place.top - (place.height - scale * canvas.height) / 2) / scale);
        if (x < 0 || y < 0 || x >= canvas.width || y >= canvas.height) return;
        this.tell(x, y);
    }

    tell(x, y) {
        const [on, off] = EventFrame.count(this.window, x, y);
        this.pixel = [x, y];
        $("pixel").textContent = `pixel (${x}, ${y}): ${on} ON, ${off} OFF`;
    }

    // Arrow keys on the event frame go from pixel to pixel, with shift ten at a time; the text beside it says what is there.
    stepPixel(event) {
        const canvas = $("frame"), by = event.shiftKey ? 10 : 1;
        const step = { ArrowLeft: [-by, 0], ArrowRight: [by, 0], ArrowUp: [0, -by], ArrowDown: [0, by] }[event.key];
        if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
        const [x, y] = this.pixel ?? [Math.floor(canvas.width / 2), Math.floor(canvas.height / 2)];
        this.tell(Math.max(0, Math.min(canvas.width - 1, x + step[0])), Math.max(0, Math.min(canvas.height - 1, y + step[1])));
        event.stopPropagation();
        event.preventDefault();
    }

    key(event) {
        if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT)$/.test(event.target.tagName)) return;
        if (event.key === " " && /^(BUTTON|SUMMARY|A)$/.test(event.target.tagName)) return; // presses or opens it
        const faster = (by) => this.setSpeed(SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, SPEEDS.indexOf(this.speed) + by))]);
        const part = event.shiftKey ? 0.1 : 1, move = (by) => this.show(this.from + by * part * this.length, this.length);
        const next = this.colourings[(this.colourings.indexOf(this.colouring) + 1) % this.colourings.length];
        const keys = {
            " ": () => this.play(!this.playing), ArrowLeft: () => move(-1), ArrowRight: () => move(1),
            "[": () => this.stretch(1 / 1.5), "]": () => this.stretch(1.5), a: () => this.show(0, this.recording.span),
            Home: () => this.show(0, this.length), End: () => this.show(Infinity, this.length),
            ",": () => faster(-1), ".": () => faster(1), l: () => $("loop").click(), c: () => this.choose(next.name),
            r: () => this.look("slant"), 1: () => this.look("front"), 2: () => this.look("side"), 3: () => this.look("top"),
            t: () => this.turnLights(),
        };
        if (!keys[event.key]) return;
        keys[event.key]();
        event.preventDefault();
    }

    // -- the address says what is looked at, so that a page can be kept or sent as it is seen

    writeHash() {
        if (this.playing) return;
        clearTimeout(this.writing);
        this.writing = setTimeout(() => {
            const state = `#w=${this.from},${this.length}&c=${this.colouring.name}&e=${this.eye.state}`;
            try { history.replaceState(null, "", state); } catch { /* in a frame without an address */ }
        }, 300);
    }
    readHash() {
        const state = new URLSearchParams(location.hash.slice(1)), numbers = (key) => state.get(key)?.split(",").map(Number);
        const [from, length] = numbers("w") ?? [], eye = numbers("e");
        if (from >= 0 && length > 0) Object.assign(this, { from, length });
        if (eye?.length === 5 && eye.every(Number.isFinite)) this.eye.state = eye;
        this.colouring = this.colourings.find((one) => one.name === state.get("c")) ?? this.colouring;
    }
}

async function start() {
    const facts = readFacts();
    const told = (done) => { $("summary").textContent = `unpacking ${Math.round(100 * done)} %`; };
    const chunks = await readChunks(facts, told);
    window.page = new Page(new Recording(facts, chunks)); // for the console, and for tests
}

start().catch((error) => {
    $("summary").textContent = `This page can't be shown: ${error.message}`;
    throw error;
});
