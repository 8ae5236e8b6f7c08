// The spectrum against closed forms.

import assert from "node:assert/strict";
import { test } from "node:test";
import { peaks, spectrum } from "../src/plots/spectrum.mjs";

const times = (count, step) => Float64Array.from({ length: count }, (_, i) => 3 + i * step);

// Closed form: the amplitudes and frequencies of the sines, which lie between the lines of the spectrum.
test("sines show their amplitudes at their frequencies, and a mean shows nothing", () => {
    const t = times(1000, 1e-3);
    const values = t.map((time) => 50 + 3 * Math.sin(2 * Math.PI * 37.3 * time) + 0.5 * Math.cos(2 * Math.PI * 121.77 * time));
    const found = peaks(spectrum(t, values));
    assert.equal(found.length, 2);
    for (const [i, [frequency, amplitude]] of [[37.3, 3], [121.77, 0.5]].entries()) {
        assert.ok(Math.abs(found[i].frequency - frequency) < 0.02, `${found[i].frequency}`);
        assert.ok(Math.abs(found[i].amplitude / amplitude - 1) < 0.01, `${found[i].amplitude}`);
    }
});

// Conserved: the energy, by Parseval's theorem with the mean square of the window, 3/8.
test("the energy of noise is that of its spectrum", () => {
    let seed = 1;
    const noise = () => (seed = (16807 * seed) % 2147483647) / 2147483647 - 0.5;
    const t = times(4096, 0.01);
    const values = t.map(noise);
    const { amplitudes } = spectrum(t, values);
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const windowed = values.map((value, i) => (value - mean) * (0.5 - 0.5 * Math.cos((2 * Math.PI * (i + 0.5)) / 4096)));
    const energy = windowed.reduce((sum, value) => sum + value * value, 0);
    // |X| = amplitude × Σ weights / 2, and all lines but the first and the last are there twice.
    const lines = amplitudes.map((amplitude) => (amplitude * 4096) / 4);
    const total = lines.reduce((sum, x, k) => sum + (k === 0 || k === lines.length - 1 ? 1 : 2) * x * x, 0) / (2 * (lines.length - 1));
    assert.ok(Math.abs(total / energy - 1) < 1e-9, `${total / energy}`);
});

test("a drift has no peak", () => {
    const t = times(500, 1e-3);
    assert.deepEqual(peaks(spectrum(t, t.map((time) => 700 * time - 500 * time ** 2))), []);
});
