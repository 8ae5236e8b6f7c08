// The time that the body and all plots show.

import type { Motion } from "./motion";
import { roundStep } from "./format";

const FILM_SECONDS = 10; // the whole run, at first

export class Clock {
    time: number;
    playing = false;
    /// Time of the run that passes in a second of film.
    speed: number;
    private readonly listeners: (() => void)[] = [];

    constructor(readonly motion: Motion) {
        this.time = motion.start;
        this.speed = motion.duration > 0 ? roundStep(motion.duration / FILM_SECONDS) : 1;
    }

    onChange(listener: () => void) { this.listeners.push(listener); }
    private changed() { for (const listener of this.listeners) listener(); }

    seek(time: number) {
        this.time = Math.min(this.motion.end, Math.max(this.motion.start, time));
        this.changed();
    }

    /// A time that something else has come to, which may be beyond the recorded run.
    show(time: number) {
        this.time = time;
        this.changed();
    }

    /// To a neighbouring row.
    step(rows: number) {
        this.playing = false;
        const { motion } = this;
        const here = motion.row(this.time);
        const back = rows < 0 && this.time > motion.times[here] ? 1 : 0; // between two rows the one before is a step
        this.seek(motion.times[Math.min(motion.times.length - 1, Math.max(0, here + rows + back))]);
    }

    toggle() {
        this.playing = !this.playing && this.motion.duration > 0;
        if (this.playing && this.time >= this.motion.end) this.time = this.motion.start;
        this.changed();
    }

    /// Through 1, 2 and 5 times the powers of ten.
    changeSpeed(direction: 1 | -1) {
        this.speed = nextStep(this.speed, direction);
        this.changed();
    }

    /// After this number of seconds of film.
    advance(seconds: number) {
        const time = this.time + seconds * this.speed;
        if (time >= this.motion.end) this.playing = false;
        this.seek(time);
    }
}

/// The neighbour among 1, 2 and 5 times the powers of ten.
export function nextStep(value: number, direction: 1 | -1): number {
    return direction > 0 ? roundStep(value * 1.01) : 1 / roundStep((1 / value) * 1.01);
}
