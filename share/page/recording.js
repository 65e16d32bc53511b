// The events in memory: found by time, counted over time. Times are ns from the page's start, as numbers: exact for 104 days.

class Recording {
    constructor(facts, chunks) {
        this.facts = facts;
        this.chunks = chunks;
        this.width = facts.width;
        this.height = facts.height;
        this.start = facts.start;
        this.span = Number(facts.stop - facts.start);
        this.count = chunks.reduce((sum, chunk) => sum + chunk.count, 0);
    }

    // The first event of a chunk that isn't before `time`.
    static lowerBound(chunk, time) {
        const after = time - chunk.first;
        let low = 0, high = chunk.count;
        while (low < high) {
            const middle = (low + high) >> 1;
            if (chunk.t[middle] < after) low = middle + 1;
            else high = middle;
        }
        return low;
    }

    // Events with from <= t < to, as pieces [chunk, begin, end), which hold at least one event each.
    window(from, to) {
        const pieces = [];
        let count = 0;
        for (const chunk of this.chunks) {
            if (chunk.first >= to) break;
            if (chunk.first + chunk.t[chunk.count - 1] < from) continue;
            const begin = Recording.lowerBound(chunk, from), end = Recording.lowerBound(chunk, to);
            if (end > begin) pieces.push({ chunk, begin, end });
            count += end - begin;
        }
        return { from, to, pieces, count };
    }

    // ON and OFF events in `bins` equal parts of all there is.
    rate(bins) {
        const on = new Uint32Array(bins), off = new Uint32Array(bins), scale = bins / this.span;
        for (const { count, first, t, label } of this.chunks)
            for (let i = 0; i < count; i++) {
                const bin = Math.min(bins - 1, (first + t[i]) * scale | 0);
                if (label[i] & 1) on[bin]++;
                else off[bin]++;
            }
        return { on, off, length: this.span / bins };
    }

    // Quantiles of up to some 20000 values that `value(chunk, i)` gives, those that aren't finite left out; null without any.
    quantiles(value, parts) {
        const sample = [], step = Math.max(1, Math.floor(this.count / 20000));
        for (const chunk of this.chunks)
            for (let i = 0; i < chunk.count; i += step) {
                const one = value(chunk, i);
                if (Number.isFinite(one)) sample.push(one);
            }
        sample.sort((a, b) => a - b);
        return sample.length ? parts.map((part) => sample[Math.round(part * (sample.length - 1))]) : null;
    }
}

// "12.5 ms", with the digits that tell `step` apart, in the unit of times as long as `scale`.
function timeText(ns, step, scale = Math.max(Math.abs(ns), step)) {
    const [unit, length] = scale >= 1e9 ? ["s", 1e9] : scale >= 1e6 ? ["ms", 1e6] : scale >= 1e3 ? ["\u00b5s", 1e3] : ["ns", 1];
    const digits = Math.max(0, Math.min(9, Math.ceil(-Math.log10(step / length))));
    return `${(ns / length).toFixed(digits)} ${unit}`;
}
// The other way, in ns; NaN where it isn't a time.
function timeOf(text) {
    const found = /^\s*([\d.]+(?:e[-+]?\d+)?)\s*(s|ms|us|\u00b5s|ns)?\s*$/i.exec(text);
    const units = { s: 1e9, ms: 1e6, us: 1e3, "\u00b5s": 1e3, ns: 1 };
    return found ? Number(found[1]) * units[(found[2] || "ms").toLowerCase()] : NaN;
}
const countText = (n) => n.toLocaleString("en").replaceAll(",", "\u2009");
