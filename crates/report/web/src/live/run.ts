// The run that the page leads on by itself, beside the recorded one.

import type { Clock } from "../clock";
import type { LiveData, Report } from "../data";
import type { Placed } from "../motion";
import { bytesOf } from "../packed.mjs";
import { Program, type Three } from "./program.mjs";

/// A frame may compute so long; what takes longer lets the film run slower.
const MOST_MILLISECONDS = 12;
const FRAMES = 60; // a second
/// The change of a spin, which the program has a function of its own for.
const SPIN = 7;
/// A pull swings so often in a second of film.
const PULL_FREQUENCY = 1.5;

export class LiveRun {
    active = true;
    /// Places of the bodies, as the picture takes them.
    readonly placed: Placed[];
    /// Words of the last failure; none while all goes well.
    failure: string | null = null;
    /// Part of the asked speed that the machine keeps up with.
    pace = 1;
    /// Milliseconds that the motion took for each frame, the latest last.
    readonly work: number[] = [];
    /// Balances of each body at the beginning.
    readonly firstBalances: number[][];
    private readonly listeners: (() => void)[] = [];

    static async begin(report: Report, live: LiveData, clock: Clock): Promise<LiveRun> {
        const program = await Program.begin(bytesOf(live.program), bytesOf(live.run), clock.speed / FRAMES);
        return new LiveRun(program, report, live, clock);
    }

    private constructor(readonly program: Program, report: Report, readonly live: LiveData, private readonly clock: Clock) {
        this.placed = report.bodies.map(({ shapes }) =>
            ({ origin: [0, 0, 0], attitude: [0, 0, 0, 1], q: new Float32Array(shapes.length) }));
        this.firstBalances = this.placed.map((_, body) => this.balances(body));
        this.read();
    }

    onChange(listener: () => void) { this.listeners.push(listener); }

    get time() { return this.program.time; }

    /// Balances of a body: of energy, and of linear and angular momentum.
    balances(body: number): number[] {
        const { energyBalance, linearBalance, angularBalance } = this.program.body(body);
        return [energyBalance, ...linearBalance, ...angularBalance];
    }

    /// Tries something of the program; a failure stops the film and is told.
    private attempt(work: () => void): boolean {
        try {
            work();
            this.failure = null;
        } catch (error) {
            this.failure = error instanceof Error ? error.message : String(error);
            this.clock.playing = false;
        }
        this.read();
        for (const listener of this.listeners) listener();
        return this.failure === null;
    }

    /// After this number of seconds of film.
    advance(seconds: number) {
        const ahead = seconds * this.pace * this.clock.speed;
        const started = performance.now();
        if (!this.attempt(() => this.program.leadTo(this.program.time + ahead))) return;
        const took = performance.now() - started;
        this.work.push(took);
        if (this.work.length > 600) this.work.shift();
        if (took > MOST_MILLISECONDS) this.pace = Math.max(1e-3, this.pace * Math.max(0.5, MOST_MILLISECONDS / took));
        else if (took < MOST_MILLISECONDS / 2) this.pace = Math.min(1, 1.1 * this.pace);
        this.clock.show(this.program.time);
    }

    /// A frame on, where the film stands still.
    step() {
        this.clock.playing = false;
        this.attempt(() => this.program.leadTo(this.program.time + this.clock.speed / FRAMES));
        this.clock.show(this.program.time);
    }

    restart() {
        this.attempt(() => this.program.restart());
        this.clock.show(this.program.time);
    }

    set(change: [number, number, number], value: number) {
        const [kind, body] = change;
        return this.attempt(() => (kind === SPIN ? this.program.spin(body, value) : this.program.change(change, value)));
    }

    /// Pulls at a place of a body; `strength` is 1 for a spring that swings the whole body as fast as a hand does.
    pull(body: number, place: Three, shapes: number[], target: Three, strength: number) {
        const rate = (2 * Math.PI * PULL_FREQUENCY) / this.clock.speed;
        const mass = this.live.masses[body] * strength;
        return this.attempt(() => this.program.pull(body, place, shapes, target, mass * rate * rate, mass * rate));
    }
    movePull(target: Three) { this.attempt(() => this.program.movePull(target)); }
    letGo() { this.attempt(() => this.program.letGo()); }

    private read() {
        this.placed.forEach((placed, i) => {
            const { origin, attitude, coordinates } = this.program.body(i);
            for (let k = 0; k < 3; k++) placed.origin[k] = origin[k];
            for (let k = 0; k < 4; k++) placed.attitude[(k + 3) % 4] = attitude[k]; // w, x, y, z to x, y, z, w
            for (let k = 0; k < placed.q.length; k++) placed.q[k] = coordinates[k] ?? 0;
        });
    }
}
