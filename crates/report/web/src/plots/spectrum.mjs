// The spectrum of a signal: amplitudes over frequencies, and its peaks.

/// A signal is continued by zeros to this multiple of its length or more, so that peaks are seen where they are.
const PADDING = 4;
/// A peak has such a part of the largest amplitude at least: more than the side lobes of the window, which have 2.7 %.
const LEAST_PEAK = 0.05;
const MOST_PEAKS = 6;

/// Discrete Fourier transform in place; as many values as a power of two.
function transform(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i++) {
        let bit = n >> 1;
        for (; j & bit; bit >>= 1) j ^= bit;
        j ^= bit;
        if (i < j) [re[i], re[j], im[i], im[j]] = [re[j], re[i], im[j], im[i]];
    }
    for (let size = 2; size <= n; size *= 2) {
        for (let k = 0; k < size / 2; k++) {
            const [cos, sin] = [Math.cos((2 * Math.PI * k) / size), -Math.sin((2 * Math.PI * k) / size)];
            for (let a = k; a < n; a += size) {
                const b = a + size / 2;
                const [x, y] = [re[b] * cos - im[b] * sin, re[b] * sin + im[b] * cos];
                [re[b], im[b], re[a], im[a]] = [re[a] - x, im[a] - y, re[a] + x, im[a] + y];
            }
        }
    }
}

/// The values at even times, straight between those that are given.
export function evenly(times, values) {
    const count = times.length;
    const step = (times[count - 1] - times[0]) / (count - 1);
    let row = 0;
    return Float64Array.from({ length: count }, (_, i) => {
        const time = times[0] + i * step;
        while (row < count - 2 && times[row + 1] <= time) row++;
        const f = (time - times[row]) / (times[row + 1] - times[row]);
        return values[row] + Math.min(1, Math.max(0, f)) * (values[row + 1] - values[row]);
    });
}

/// Amplitudes with the window of Hann, without the mean: a sine shows its amplitude at its frequency, in cycles per time.
export function spectrum(times, values) {
    const signal = evenly(times, values);
    const count = signal.length;
    const mean = signal.reduce((sum, value) => sum + value, 0) / count;
    let length = 2;
    while (length < PADDING * count) length *= 2;
    const [re, im] = [new Float64Array(length), new Float64Array(length)];
    let weights = 0;
    for (let i = 0; i < count; i++) {
        const weight = 0.5 - 0.5 * Math.cos((2 * Math.PI * (i + 0.5)) / count);
        weights += weight;
        re[i] = weight * (signal[i] - mean);
    }
    transform(re, im);
    const step = (times[count - 1] - times[0]) / (count - 1);
    const frequencies = Float64Array.from({ length: length / 2 + 1 }, (_, k) => k / (length * step));
    const amplitudes = frequencies.map((_, k) => (2 * Math.hypot(re[k], im[k])) / weights);
    return { frequencies, amplitudes, resolution: 1 / (count * step) };
}

/// The highest peaks, by frequency; each lies between the lines of the spectrum where a parabola through three of them does.
export function peaks({ frequencies, amplitudes, resolution }) {
    const greatest = amplitudes.reduce((a, b) => Math.max(a, b), 0);
    const spacing = frequencies[1];
    const found = [];
    for (let k = 1; k < amplitudes.length - 1; k++) {
        const [a, b, c] = [amplitudes[k - 1], amplitudes[k], amplitudes[k + 1]];
        // What does not go through three periods may be a drift.
        if (b < a || b <= c || b < LEAST_PEAK * greatest || frequencies[k] < 3 * resolution) continue;
        const [la, lb, lc] = [a, b, c].map((value) => Math.log(Math.max(value, Number.MIN_VALUE)));
        const bend = la - 2 * lb + lc;
        const off = bend < 0 ? (0.5 * (la - lc)) / bend : 0;
        found.push({ frequency: frequencies[k] + off * spacing, amplitude: Math.exp(lb - 0.25 * (la - lc) * off) });
    }
    found.sort((one, other) => other.amplitude - one.amplitude);
    return found.slice(0, MOST_PEAKS).sort((one, other) => one.frequency - other.frequency);
}
