// The state of the bodies at any time between the rows.

import { double, single, type BodyData, type Report } from "./data";

/// The motion of all bodies, which have their rows at the same times.
export class Motion {
    readonly times: Float64Array;
    readonly bodies: BodyMotion[];

    constructor({ times, bodies }: Pick<Report, "times" | "bodies">) {
        this.times = double(times);
        this.bodies = bodies.map((body) => new BodyMotion(body));
    }

    get start() { return this.times[0]; }
    get end() { return this.times[this.times.length - 1]; }
    get duration() { return this.end - this.start; }

    /// The last row at or before a time.
    row(time: number): number {
        return rowAt(this.times, time);
    }

    /// Sets the states of all bodies.
    at(time: number): void {
        const a = this.row(time);
        const b = Math.min(a + 1, this.times.length - 1);
        const span = this.times[b] - this.times[a];
        const f = span > 0 ? Math.min(1, Math.max(0, (time - this.times[a]) / span)) : 0;
        for (const body of this.bodies) body.between(a, b, f);
    }
}

/// Where a body is, and how it is deformed.
export interface Placed {
    origin: [number, number, number];
    /// x, y, z, w
    attitude: [number, number, number, number];
    q: Float32Array;
}

export class BodyMotion implements Placed {
    readonly origins: Float32Array;
    readonly coordinates: Float32Array;
    readonly shapes: number;
    private readonly attitudes: Float32Array;
    /// Filled by `between`.
    readonly origin: [number, number, number] = [0, 0, 0];
    /// x, y, z, w
    readonly attitude: [number, number, number, number] = [0, 0, 0, 1];
    readonly q: Float32Array;

    constructor(body: BodyData) {
        this.origins = single(body.motion.origins);
        this.attitudes = single(body.motion.attitudes);
        this.coordinates = single(body.motion.coordinates);
        this.shapes = body.shapes.length;
        this.q = new Float32Array(this.shapes);
    }

    /// Straight between two rows; the attitude on the shorter way.
    between(a: number, b: number, f: number): void {
        const between = (list: Float32Array, width: number, i: number) =>
            list[width * a + i] * (1 - f) + list[width * b + i] * f;
        for (let i = 0; i < 3; i++) this.origin[i] = between(this.origins, 3, i);
        for (let k = 0; k < this.shapes; k++) this.q[k] = between(this.coordinates, this.shapes, k);
        let dot = 0;
        for (let i = 0; i < 4; i++) dot += this.attitudes[4 * a + i] * this.attitudes[4 * b + i];
        const g = dot < 0 ? -f : f;
        let norm = 0;
        for (let i = 0; i < 4; i++) {
            const value = this.attitudes[4 * a + i] * (1 - f) + this.attitudes[4 * b + i] * g;
            this.attitude[(i + 3) % 4] = value;
            norm += value * value;
        }
        for (let i = 0; i < 4; i++) this.attitude[i] /= Math.sqrt(norm);
    }
}

/// Index of the last entry at or before a time, 0 where there is none.
export function rowAt(times: Float64Array, time: number): number {
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (times[middle] <= time) low = middle;
        else high = middle - 1;
    }
    return low;
}
