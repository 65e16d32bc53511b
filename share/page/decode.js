// Events as the page holds them: scripts of class "events", each a chunk of columns as bytes in planes, deflated, in base64.
// lib/page/page_chunk.c writes them and says what lies where.

function fromBase64(text) {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const letters = atob(text), bytes = new Uint8Array(letters.length);
    for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
    return bytes;
}

async function inflate(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// A column of 32, 16 or 8 bits from its planes, lowest first; `at` is where it begins.
function column32(bytes, at, n) {
    const out = new Uint32Array(n), b = at + n, c = b + n, d = c + n;
    for (let i = 0; i < n; i++) out[i] = bytes[at + i] | bytes[b + i] << 8 | bytes[c + i] << 16 | bytes[d + i] << 24;
    return out;
}

function column16(bytes, at, n) {
    const out = new Uint16Array(n);
    for (let i = 0; i < n; i++) out[i] = bytes[at + i] | bytes[at + n + i] << 8;
    return out;
}

// {count, first, t, xy, label, depth, u, v, instance}: `first` [ns] counts from the page's start, t [ns] from `first`; xy
// alternates, as a graphics card wants it; label is polarity + 2 cause.
async function readChunk(script, facts) {
    const n = Number(script.dataset.count), bytes = await inflate(fromBase64(script.textContent));
    if (bytes.length !== n * (facts.truth ? 23 : 9)) throw new Error(`a chunk has ${bytes.length} bytes for ${n} events`);
    const t = column32(bytes, 0, n), x = column16(bytes, 4 * n, n), y = column16(bytes, 6 * n, n);
    for (let i = 1; i < n; i++) t[i] += t[i - 1];
    const xy = new Uint16Array(2 * n);
    for (let i = 0; i < n; i++) {
        xy[2 * i] = x[i];
        xy[2 * i + 1] = y[i];
    }
    const first = Number(BigInt(script.dataset.first) - facts.start);
    const chunk = { count: n, first, t, xy, label: bytes.slice(8 * n, 9 * n) };
    if (facts.truth) {
        chunk.depth = new Float32Array(column32(bytes, 9 * n, n).buffer);
        chunk.u = new Float32Array(column32(bytes, 13 * n, n).buffer);
        chunk.v = new Float32Array(column32(bytes, 17 * n, n).buffer);
        chunk.instance = column16(bytes, 21 * n, n);
    }
    return chunk;
}

function readFacts() {
    const facts = JSON.parse(document.getElementById("facts").textContent);
    for (const key of ["start", "stop", "window"]) facts[key] = BigInt(facts[key]);
    return facts;
}

// All chunks; their texts are let go. `told(done)` hears how far it is, from 0 to 1.
async function readChunks(facts, told) {
    const scripts = document.querySelectorAll("script.events"), chunks = [];
    for (const script of scripts) {
        chunks.push(await readChunk(script, facts));
        script.remove();
        told(chunks.length / scripts.length);
    }
    return chunks;
}
