// The picture of the body with its controls.

import type { Field } from "./body";
import { nextStep, type Clock } from "./clock";
import { onSchemeChange } from "./colours";
import { SCALE } from "./scale.mjs";
import type { Report } from "./data";
import { minus, number, timeDecimals, withUnit } from "./format";
import { Motion } from "./motion";
import { Stage } from "./stage";

/// A shape shown alone swings so far, as a part of the body's radius.
const SWING = 0.16;
const SWING_SECONDS = 2;
const MOST_EXAGGERATION = 1e6;

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

export class Viewer {
    private stage: Stage | null = null;
    /// The shape that is shown alone; none where the run is shown.
    private shape: number | null = null;
    private swinging = true;
    private phase = 0.25;
    private exaggeration = 1;
    private field: Field = "displacement";
    private changed = true;
    private last = 0;
    /// Milliseconds that the program worked for each frame, the latest last.
    readonly work: number[] = [];
    frames = 0;

    constructor(private readonly report: Report, private readonly motion: Motion, private readonly clock: Clock) {
        try {
            this.stage = new Stage(element<HTMLCanvasElement>("canvas"), report, motion, () => (this.changed = true));
        } catch {
            element("no-picture").hidden = false;
            element("canvas").hidden = true;
        }
        if (!report.surface) this.field = "none";
        this.fillSubjects();
        this.fillColours();
        this.connect();
        clock.onChange(() => this.showTime());
        this.showTime();
        this.showLegend();
        this.showExaggeration();
        if (this.stage) {
            motion.at(motion.start);
            this.stage.place(motion.origin, motion.attitude);
            this.stage.resize();
            this.stage.lookAt(null);
        }
        requestAnimationFrame((now) => this.frame(now));
    }

    get playing() { return this.shape === null ? this.clock.playing : this.swinging; }

    toggle() {
        if (this.shape === null) return this.clock.toggle();
        this.swinging = !this.swinging;
        this.showTime();
    }

    /// A shape alone, or the run.
    show(shape: number | null) {
        this.shape = shape;
        this.swinging = !matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.phase = 0.25; // at its greatest
        if (shape !== null) this.clock.playing = false;
        element<HTMLSelectElement>("subject").value = shape === null ? "run" : String(shape);
        this.stage?.place(shape === null ? this.motion.origin : [0, 0, 0], [0, 0, 0, 1]);
        this.prepare();
        this.stage?.lookAt(null);
        this.showLegend();
        this.showTime();
        this.showExaggeration();
    }

    exaggerate(direction: 1 | -1) {
        if (this.shape !== null) return;
        const next = this.exaggeration === 0 ? Math.max(0, direction) : nextStep(this.exaggeration, direction);
        this.exaggeration = next < 0.99 ? 0 : Math.min(MOST_EXAGGERATION, next); // below the true one there is none
        this.showExaggeration();
    }

    resetView() {
        const { following } = this.stage ?? { following: true };
        this.stage?.lookAt(following || this.shape !== null ? null : this.motion);
        this.changed = true;
    }

    private shapeText(k: number): string {
        const { name, frequency } = this.report.shapes[k];
        return frequency === null ? name : `${name}: ${withUnit(number(frequency), this.report.units.frequency)}`;
    }

    private fillSubjects() {
        const select = element<HTMLSelectElement>("subject");
        select.add(new Option("the run", "run"));
        if (!this.report.surface) return;
        this.report.shapes.forEach((_, k) => {
            select.add(new Option(this.shapeText(k), String(k)));
        });
        select.addEventListener("change", () => this.show(select.value === "run" ? null : Number(select.value)));
    }

    private fillColours() {
        const select = element<HTMLSelectElement>("colour");
        if (this.report.surface) select.add(new Option("displacement", "displacement"));
        if (this.report.surface && this.report.stress) select.add(new Option("von Mises stress", "stress"));
        select.add(new Option("none", "none"));
        select.addEventListener("change", () => {
            this.field = select.value as Field;
            this.showLegend();
        });
        element("legend-bar").style.background = `linear-gradient(to top, ${SCALE.join(", ")})`;
    }

    private connect() {
        const click = (id: string, action: () => void) => element(id).addEventListener("click", action);
        click("play", () => this.toggle());
        click("slower", () => this.clock.changeSpeed(-1));
        click("faster", () => this.clock.changeSpeed(1));
        click("less", () => this.exaggerate(-1));
        click("more", () => this.exaggerate(1));
        click("reset", () => this.resetView());
        const time = element<HTMLInputElement>("time");
        time.min = String(this.motion.start);
        time.max = String(this.motion.end);
        time.addEventListener("input", () => {
            if (this.shape !== null) this.show(null);
            this.clock.playing = false;
            this.clock.seek(Number(time.value));
        });
        const check = (id: string, action: (checked: boolean) => void) => {
            const box = element<HTMLInputElement>(id);
            const apply = () => { action(box.checked); this.changed = true; };
            box.addEventListener("change", apply);
            apply();
        };
        const { stage } = this;
        if (!stage) return;
        element<HTMLInputElement>("axes").checked = !stage.body?.hasFacets;
        for (const part of document.querySelectorAll<HTMLElement>(".of-surface")) part.hidden = !stage.body;
        element("outline").parentElement!.hidden = !stage.body?.hasFacets;
        const without = element("no-surface");
        without.hidden = stage.body?.hasFacets ?? false;
        without.textContent = stage.body
            ? "This body comes from matrices: its nodes are shown, for it has no elements and so no surface."
            : "This body has no mesh: its axes are shown.";
        check("follow", (on) => {
            stage.following = on;
            if (this.frames > 0) this.resetView();
        });
        check("outline", (on) => { if (stage.body) stage.body.outline.visible = on; });
        check("axes", (on) => { stage.bodyAxes.visible = on; });
        check("path", () => this.showSurroundings());
        new ResizeObserver(() => {
            stage.resize();
            this.changed = true;
        }).observe(element("canvas"));
        onSchemeChange(() => this.recolour());
    }

    recolour() {
        this.stage?.recolour();
        this.changed = true;
    }

    /// Draws the picture that paper shows.
    print() {
        this.recolour();
        this.prepare();
        this.stage?.drawInto(element<HTMLCanvasElement>("printed-picture"));
    }

    private showSurroundings() {
        this.stage?.showSurroundings(this.shape === null, element<HTMLInputElement>("path").checked);
    }

    /// Greatest value of the field: over the run, or of a shape where its coordinate is 1.
    private peak(): number {
        const body = this.stage?.body;
        if (this.field === "none" || !body) return 0;
        if (this.shape !== null) return (this.field === "stress" ? body.stressPeaks! : body.displacementPeaks)[this.shape];
        return this.field === "stress" ? this.report.stress!.peak : this.report.displacement_peak;
    }

    private showLegend() {
        this.changed = true;
        this.showSurroundings();
        const peak = this.peak();
        this.stage?.body?.colourBy(this.field, peak);
        element("legend").hidden = this.field === "none" || !this.stage;
        const alone = this.shape !== null;
        const unit = alone ? "relative" : this.field === "stress" ? this.report.stress!.unit : this.report.units.length;
        element("legend-name").textContent = `${this.field === "stress" ? "Von Mises stress" : "Displacement"}, ${unit}`;
        const ticks = [1, 0.75, 0.5, 0.25, 0].map((part) => {
            const tick = document.createElement("span");
            tick.textContent = number(part * (alone ? 1 : peak), 3);
            return tick;
        });
        element("legend-ticks").replaceChildren(...ticks);
    }

    private showExaggeration() {
        this.changed = true;
        const text = this.exaggeration === 0 ? "none" : this.exaggeration === 1 ? "true" : `${number(this.exaggeration)} ×`;
        element("exaggeration").textContent = this.shape === null ? text : "scaled";
        for (const id of ["less", "more", "slower", "faster"]) element<HTMLButtonElement>(id).disabled = this.shape !== null;
    }

    private showTime() {
        this.changed = true;
        const { clock, motion } = this;
        const unit = this.report.units.time;
        const decimals = timeDecimals(motion.duration);
        const now = minus(clock.time.toFixed(decimals));
        const time = element<HTMLInputElement>("time");
        time.value = String(clock.time);
        time.setAttribute("aria-valuetext", `${now} ${unit}`);
        element("now").textContent = `${now} ${unit}`;
        element("speed").textContent = `${number(clock.speed)} ${unit} per second`;
        const play = element("play");
        play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
        play.classList.toggle("playing", this.playing);
        element("caption").textContent = this.shape === null ? "" : this.shapeText(this.shape);
    }

    /// Sets the state of the body for this moment.
    private prepare() {
        const { stage, motion } = this;
        if (!stage) return;
        if (this.shape === null) {
            motion.at(this.clock.time);
            stage.place(motion.origin, motion.attitude);
            stage.body?.deform(motion.q, this.exaggeration);
            return;
        }
        const greatest = stage.body!.displacementPeaks[this.shape];
        const q = new Float32Array(motion.shapes);
        q[this.shape] = Math.sin(2 * Math.PI * this.phase);
        stage.place([0, 0, 0], [0, 0, 0, 1]);
        stage.body!.deform(q, greatest > 0 ? (SWING * stage.radius) / greatest : 0, true);
    }

    private frame(now: number) {
        requestAnimationFrame((next) => this.frame(next));
        const seconds = Math.min(0.1, (now - this.last) / 1000);
        this.last = now;
        const started = performance.now();
        if (this.playing) {
            if (this.shape === null) this.clock.advance(seconds);
            else this.phase += seconds / SWING_SECONDS;
            this.changed = true;
        }
        if (!this.changed) return;
        this.changed = false;
        this.prepare();
        this.stage?.draw();
        this.frames++;
        this.work.push(performance.now() - started);
        if (this.work.length > 600) this.work.shift();
    }
}
