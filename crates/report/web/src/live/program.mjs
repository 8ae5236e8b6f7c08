// The motion itself, as WebAssembly: the crate `live`. Used by the page, and by the tests in Node.

/// Numbers of a body before the coordinates of its shapes: `live::BODY_NUMBERS`.
const BODY_NUMBERS = 27;

import { unpacked } from "../packed.mjs";

export class Program {
    /// Begins a run; both are bytes packed by gzip. Systems are seen at least every `frame` of their time.
    static async begin(program, run, frame) {
        const { instance } = await WebAssembly.instantiate(await unpacked(program), {});
        return new Program(instance.exports, new Uint8Array(await unpacked(run)), frame);
    }

    constructor(exports, run, frame) {
        this.exports = exports;
        this.give(run);
        this.check(exports.begin(run.length, frame));
        this.firsts = [];
        this.counts = [];
        let first = 1;
        for (let body = 0; body < exports.bodies(); body++) {
            this.firsts.push(first);
            this.counts.push(exports.coordinates(body));
            first += BODY_NUMBERS + exports.coordinates(body);
        }
        this.last = first;
    }

    /// Writes bytes to where the program reads them.
    give(bytes) {
        const at = this.exports.room(bytes.length);
        new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
    }

    check(failed) {
        if (failed === 0) return;
        const { memory, message, message_length } = this.exports;
        throw new Error(new TextDecoder().decode(new Uint8Array(memory.buffer, message(), message_length())));
    }

    /// All numbers of the state, as `Player::numbers` has them. They are good until the next call.
    numbers() {
        const { memory, numbers, number_count } = this.exports;
        return new Float64Array(memory.buffer, numbers(), number_count());
    }

    /// The state of a body; its lists are good until the next call.
    body(body) {
        const first = this.firsts[body];
        const all = this.numbers();
        const list = (from, count) => all.subarray(first + from, first + from + count);
        return {
            origin: list(0, 3), attitude: list(3, 4), omega: list(7, 3),
            kinetic: all[first + 10], strain: all[first + 11], work: all[first + 12], dissipation: all[first + 13],
            linear: list(14, 3), angular: list(17, 3),
            energyBalance: all[first + 20], linearBalance: list(21, 3), angularBalance: list(24, 3),
            coordinates: list(BODY_NUMBERS, this.counts[body]),
        };
    }

    /// The point that is pulled at, and the force on it.
    get pulled() {
        const all = this.numbers();
        return { point: all.slice(this.last, this.last + 3), force: all.slice(this.last + 3, this.last + 6) };
    }

    get time() { return this.numbers()[0]; }
    get isRecorded() { return this.exports.is_recorded() === 1; }
    get steps() { return this.exports.steps(); }

    leadTo(time) { this.check(this.exports.lead_to(time)); }
    restart() { this.check(this.exports.restart()); }
    change([kind, of, item], value) { this.check(this.exports.change(kind, of, item, value)); }
    spin(body, value) { this.check(this.exports.spin(body, value)); }

    /// Pulls at a place of a body, from its origin in its axes, where its shapes have these displacements, three numbers each.
    pull(body, place, shapes, target, stiffness, damping) {
        this.give(new Uint8Array(new Float64Array([...place, ...target, stiffness, damping, ...shapes]).buffer));
        this.check(this.exports.pull(body));
    }
    movePull([x, y, z]) { this.check(this.exports.move_pull(x, y, z)); }
    letGo() { this.check(this.exports.let_go()); }
}
