// What events may be coloured by. Each colouring gives an event a place 0 to 255 in a table of colours; the same formula stands
// in JavaScript, for the event frame, and in GLSL, for the cloud.
//
// place(chunk, i)  for one event                 columns(chunk)  what GLSL's `value` is made of, or null: it has `label` alone
// glsl             expression of label and value  table(dark)    256 times r, g, b, of 0 to 255
// uniforms         `range` in GLSL, of those that have columns
// legend           [[place, or null, text] ...], or {low, high} for a ramp

// A colour in the Oklab space (B. Ottosson, 2020): lightness 0 to 1, chroma, hue in turns; as sRGB 0 to 255.
function oklch(lightness, chroma, turn) {
    const a = chroma * Math.cos(2 * Math.PI * turn), b = chroma * Math.sin(2 * Math.PI * turn);
    const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3;
    return [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s].map((c) => {
        const shown = c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
        return Math.max(0, Math.min(255, Math.round(255 * shown)));
    });
}

// 256 colours of a function of the place.
const table = (colour) => Uint8Array.from({ length: 256 }, (_, i) => i).reduce((all, i) => all.concat(colour(i)), []);
// Red and blue of the same lightness, the pictures' of `tides view`, which every eye tells apart; lighter where it is dark.
const onOff = (dark) => (place) => place ? (dark ? [255, 124, 105] : [201, 69, 60]) : dark ? [92, 170, 255] : [0, 114, 217];
// Kinds that have no order: hues as far apart as they go, by the golden section, in three lightnesses.
const kinds = (dark) => (place) => oklch((dark ? 0.72 : 0.55) + 0.08 * (place % 3 - 1), 0.14, 0.08 + 0.618034 * place);
const clampPlace = (value) => Math.max(0, Math.min(255, Math.floor(value)));

function byPolarity() {
    return { name: "polarity", glsl: "float(label & 1u)", place: (chunk, i) => chunk.label[i] & 1, columns: () => null,
        table: (dark) => table(onOff(dark)), legend: [[1, "ON"], [0, "OFF"]] };
}

function byCause(causes) {
    const grey = (dark) => dark ? [150, 155, 163] : [120, 125, 133];
    return { name: "cause", glsl: "float(label >> 1u)", place: (chunk, i) => chunk.label[i] >> 1, columns: () => null,
        table: (dark) => table((place) => place === 0 ? grey(dark) : kinds(dark)(place)),
        legend: causes.map((text, cause) => [cause, text]) };
}

// Between the first and the last hundredth: a few far splats would take the whole ramp.
function byDepth(recording) {
    const [low, high] = recording.quantiles((chunk, i) => chunk.depth[i] > 0 ? chunk.depth[i] : NaN, [0.01, 0.99]) ?? [0, 1];
    const scale = 255 / Math.max(high - low, 1e-9 * Math.abs(high) || 1);
    return { name: "depth", uniforms: [low, scale], glsl: "clamp((value.x - range.x) * range.y, 0.0, 255.0)",
        place: (chunk, i) => clampPlace((chunk.depth[i] - low) * scale), columns: (chunk) => [chunk.depth, chunk.depth],
        table: (dark) => table((place) => oklch((dark ? 0.92 : 0.78) - 0.5 * place / 255, 0.13, 0.22 + 0.5 * place / 255)),
        legend: { low: low.toPrecision(3), high: `${high.toPrecision(3)} scene units` } };
}

// Directions are 64 hues, speeds 4 strengths of them: up to a third, two thirds of what is fast, and beyond.
function byFlow(recording) {
    const speed = (chunk, i) => Math.hypot(chunk.u[i], chunk.v[i]);
    const [fast] = recording.quantiles(speed, [0.95]) ?? [1];
    const place = (u, v) => {
        const hue = Math.floor(64 * (Math.atan2(v, u) / (2 * Math.PI) + 1)) & 63;
        return 64 * Math.min(3, Math.floor(3 * Math.hypot(u, v) / (fast || 1))) + hue;
    };
    return { name: "flow", uniforms: [fast || 1, 0], columns: (chunk) => [chunk.u, chunk.v],
        glsl: "64.0 * min(3.0, floor(3.0 * length(value) / range.x)) + "
            + "mod(floor(64.0 * (atan(value.y, value.x) / 6.28318530718 + 1.0)), 64.0)",
        place: (chunk, i) => place(chunk.u[i], chunk.v[i]),
        table: (dark) => table((at) => oklch(dark ? 0.75 : 0.6, 0.02 + 0.05 * (at >> 6), (at & 63) / 64)),
        legend: [[192, "right"], [192 + 16, "down"], [192 + 32, "left"], [192 + 48, "up"],
            [null, `strong: ${countText(Number(fast.toPrecision(2)))} px/s and more`]] };
}

// Object k has place 1 + k, and none place 0.
function byInstance(recording) {
    const seen = new Set();
    for (const { instance } of recording.chunks) for (const k of instance) seen.add(k);
    const place = (k) => k === 65535 ? 0 : 1 + k % 255, shown = [...seen].sort((a, b) => a - b).slice(0, 16);
    return { name: "instance", uniforms: [0, 1], glsl: "value.x > 65534.5 ? 0.0 : 1.0 + mod(value.x, 255.0)",
        place: (chunk, i) => place(chunk.instance[i]), columns: (chunk) => [chunk.instance, chunk.instance],
        table: (dark) => table((at) => at === 0 ? (dark ? [130, 130, 130] : [160, 160, 160]) : kinds(dark)(at)),
        legend: shown.map((k) => [place(k), k === 65535 ? "nothing seen" : `object ${k}`]) };
}

function colouringsOf(recording) {
    const { causes, truth } = recording.facts, made = [byPolarity()];
    if (causes.length) made.push(byCause(causes));
    if (truth && recording.count) made.push(byDepth(recording), byFlow(recording), byInstance(recording));
    return made;
}

// The legend as elements.
function drawLegend(where, colouring, dark) {
    const colours = colouring.table(dark), { legend } = colouring;
    const rgb = (place) => `rgb(${colours.slice(3 * place, 3 * place + 3)})`;
    where.replaceChildren();
    if (Array.isArray(legend)) {
        for (const [place, text] of legend) {
            const entry = document.createElement("span"), patch = document.createElement("i");
            patch.style.background = rgb(place);
            if (place !== null) entry.append(patch);
            entry.append(text);
            where.append(entry);
        }
        return;
    }
    const ramp = document.createElement("canvas"), ends = document.createElement("span"), context = ramp.getContext("2d");
    ramp.width = 256;
    ramp.height = 1;
    for (let i = 0; i < 256; i++) {
        context.fillStyle = rgb(i);
        context.fillRect(i, 0, 1, 1);
    }
    ends.className = "ends";
    ends.append(legend.low, document.createElement("span"), legend.high);
    where.append(ramp, ends);
}
