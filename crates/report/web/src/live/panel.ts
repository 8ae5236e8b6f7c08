// What the reader does with the live run: its switches, its sliders, its numbers.

import { double, type Control, type Report } from "../data";
import { number, withUnit } from "../format";
import type { LiveRun } from "./run";

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/// Numbers are written so often, so that they can be read.
const NUMBERS_EVERY = 150; // ms
/// Strengths of a pull, as powers of ten.
const STRENGTH = { least: -2, most: 2 };

export class LivePanel {
    /// Factor on the stiffness of a pull.
    strength = 1;
    private last = -Infinity;
    /// Time at which the recorded run ends.
    private readonly end: number;
    private readonly sliders: (() => void)[] = [];

    constructor(private readonly report: Report, private readonly run: LiveRun, private readonly stress: () => number | null, switched: () => void) {
        this.end = double(report.times).at(-1)!;
        element("live").hidden = false;
        document.querySelectorAll<HTMLElement>(".of-live").forEach((part) => (part.hidden = false));
        const on = element<HTMLInputElement>("live-on");
        on.addEventListener("change", () => {
            run.active = on.checked;
            switched();
            this.show(true);
        });
        element("ghost").addEventListener("change", switched);
        element("step").addEventListener("click", () => run.step());
        element("restart").addEventListener("click", () => this.restart());
        const groups = new Map<string, HTMLElement>();
        for (const control of run.live.controls) this.group(groups, control.group).append(this.slider(control));
        element("live-controls").append(this.strengthSlider(), ...groups.values());
        run.onChange(() => this.show());
        this.show(true);
    }

    restart() {
        this.run.restart();
        for (const reset of this.sliders) reset();
        this.show(true);
    }

    private group(groups: Map<string, HTMLElement>, name: string): HTMLElement {
        const known = groups.get(name);
        if (known) return known;
        const made = document.createElement("fieldset");
        const legend = document.createElement("legend");
        legend.textContent = name === "" ? "change" : name;
        made.append(legend);
        groups.set(name, made);
        return made;
    }

    private row(name: string, range: [number, number], value: number, text: (value: number) => string, set: (value: number) => boolean) {
        const label = document.createElement("label");
        label.className = "slider";
        const words = document.createElement("span");
        const input = document.createElement("input");
        const output = document.createElement("output");
        words.textContent = name;
        Object.assign(input, { type: "range", min: String(range[0]), max: String(range[1]), step: "any", value: String(value) });
        let good = value;
        const show = () => {
            output.textContent = text(Number(input.value));
            input.setAttribute("aria-valuetext", output.textContent);
        };
        input.addEventListener("input", () => {
            if (set(Number(input.value))) good = Number(input.value);
            else input.value = String(good); // what the run refuses stays as it was
            show();
        });
        show();
        label.append(words, input, output);
        return { label, reset: () => { good = value; input.value = String(value); show(); } };
    }

    private slider(control: Control): HTMLElement {
        const { name, unit, range, recorded, change } = control;
        const text = (value: number) => (unit === "" && recorded === 1 ? `${number(value, 3)} ×` : withUnit(number(value, 3), unit));
        const { label, reset } = this.row(name, range, recorded, text, (value) => this.run.set(change, value));
        this.sliders.push(reset);
        return label;
    }

    private strengthSlider(): HTMLElement {
        const text = (power: number) => `${number(10 ** power, 2)} ×`;
        const set = (power: number) => {
            this.strength = 10 ** power;
            return true;
        };
        return this.row("strength of a pull", [STRENGTH.least, STRENGTH.most], 0, text, set).label;
    }

    /// State and numbers, from time to time.
    private show(now = false) {
        const { run } = this;
        const time = performance.now();
        if (!now && run.failure === null && time - this.last < NUMBERS_EVERY) return;
        this.last = time;
        const state = element("live-state");
        state.classList.toggle("warning", run.failure !== null);
        const slow = run.pace < 0.9 ? ` This machine keeps up with ${number(100 * run.pace, 2)} % of the speed.` : "";
        const words = !run.program.isRecorded ? "Changed: this motion is its own."
            : run.time > this.end ? "Nothing is changed: the recorded run is over, and goes on here."
            : "Nothing is changed: this is the recorded motion, computed again.";
        state.textContent = run.failure ?? (run.active ? words + slow : "The recorded run is shown.");
        const rows = run.active ? this.numbers() : [];
        element("live-numbers").replaceChildren(...rows.flatMap(([name, value]) => {
            const [term, described] = [document.createElement("dt"), document.createElement("dd")];
            [term.textContent, described.textContent] = [name, value];
            return [term, described];
        }));
    }

    private numbers(): [string, string][] {
        const { run, report } = this;
        const [, energy, momentum, angular] = run.live.units;
        const sum = (of: (body: number) => number) => report.bodies.reduce((total, _, body) => total + of(body), 0);
        const most = (of: (body: number) => number) => Math.max(...report.bodies.map((_, body) => of(body)));
        const off = (body: number, from: number, count: number) =>
            Math.hypot(...run.balances(body).slice(from, from + count).map((value, k) => value - run.firstBalances[body][from + k]));
        const stress = this.stress();
        const unit = report.bodies.find((body) => body.stress)?.stress?.unit ?? "";
        return [
            ["kinetic energy", withUnit(number(sum((body) => run.program.body(body).kinetic)), energy)],
            ["strain energy", withUnit(number(sum((body) => run.program.body(body).strain)), energy)],
            ["work done on the bodies", withUnit(number(sum((body) => run.program.body(body).work)), energy)],
            ["dissipation", withUnit(number(sum((body) => run.program.body(body).dissipation)), energy)],
            ["energy out of balance", withUnit(number(most((body) => off(body, 0, 1)), 2), energy)],
            ["momentum out of balance", withUnit(number(most((body) => off(body, 1, 3)), 2), momentum)],
            ["angular momentum out of balance", withUnit(number(most((body) => off(body, 4, 3)), 2), angular)],
            ...(stress === null ? [] : [["greatest von Mises stress", withUnit(number(stress), unit)] as [string, string]]),
        ];
    }
}
