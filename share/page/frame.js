// The window's events by pixel. By polarity a pixel shows ON minus OFF, from paper to full colour at 3 more of one than of the
// other; by anything else the colour of its latest event.

const FULL = 3;

class EventFrame {
    constructor(canvas, recording) {
        canvas.width = recording.width;
        canvas.height = recording.height;
        this.context = canvas.getContext("2d", { willReadFrequently: true }); // in memory: each picture is made there
        this.image = this.context.createImageData(recording.width, recording.height);
        this.pixels = new Uint32Array(this.image.data.buffer);
        this.balance = new Int32Array(this.pixels.length);
        this.width = recording.width;
    }

    // The paper's colour as r, g, b.
    draw(window, colouring, dark, paper) {
        const colours = colouring.table(dark), word = ([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;
        const blank = word(paper);
        if (colouring.name === "polarity") this.#balance(window, colours, paper, word);
        else {
            this.pixels.fill(blank);
            const words = Uint32Array.from({ length: 256 }, (_, i) => word(colours.slice(3 * i, 3 * i + 3)));
            for (const { chunk, begin, end } of window.pieces)
                for (let i = begin; i < end; i++)
                    this.pixels[chunk.xy[2 * i + 1] * this.width + chunk.xy[2 * i]] = words[colouring.place(chunk, i)];
        }
        this.context.putImageData(this.image, 0, 0);
    }

    #balance(window, colours, paper, word) {
        this.balance.fill(0);
        for (const { chunk, begin, end } of window.pieces)
            for (let i = begin; i < end; i++)
                this.balance[chunk.xy[2 * i + 1] * this.width + chunk.xy[2 * i]] += 2 * (chunk.label[i] & 1) - 1;
        const shades = Uint32Array.from({ length: 2 * FULL + 1 }, (_, i) => {
            const strength = Math.abs(i - FULL) / FULL, place = i > FULL ? 3 : 0;
            return word(paper.map((c, k) => Math.round(c + strength * (colours[place + k] - c))));
        });
        for (let i = 0; i < this.pixels.length; i++)
            this.pixels[i] = shades[Math.max(-FULL, Math.min(FULL, this.balance[i])) + FULL];
    }

    // [ON, OFF] events of the window at a pixel.
    static count(window, x, y) {
        const counts = [0, 0];
        for (const { chunk, begin, end } of window.pieces)
            for (let i = begin; i < end; i++)
                if (chunk.xy[2 * i] === x && chunk.xy[2 * i + 1] === y) counts[1 - (chunk.label[i] & 1)]++;
        return counts;
    }
}
