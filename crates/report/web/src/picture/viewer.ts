// The picture of the body with its controls.

import type { Vector3 } from "three";
import type { Body, Field } from "./body";
import { nextStep, type Clock } from "../clock";
import { onSchemeChange } from "../colours";
import { Ghosts } from "./compared";
import { SCALE } from "./scale.mjs";
import type { Report } from "../data";
import { minus, number, timeDecimals, withUnit } from "../format";
import { Motion } from "../motion";
import { LivePanel } from "../live/panel";
import { Pull } from "../live/pull";
import type { LiveRun } from "../live/run";
import { Stage } from "./stage";

/// A shape shown alone swings so far, as a part of the body's radius.
const SWING = 0.16;
const SWING_SECONDS = 2;
const MOST_EXAGGERATION = 1e6;

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/// A shape of a body, by their numbers.
export interface BodyShape { body: number; shape: number }

export class Viewer {
    private stage: Stage | null = null;
    private compared: Ghosts | null = null;
    /// The shape that is shown alone; none where the run is shown.
    private shape: BodyShape | null = null;
    private swinging = true;
    private phase = 0.25;
    private exaggeration = 1;
    private field: Field = "displacement";
    private changed = true;
    private last = 0;
    /// The run that the page leads on by itself, with what is done to it.
    private live: { run: LiveRun; panel: LivePanel; pull: Pull | null } | null = null;
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
        if (!this.surfaces) this.field = "none";
        this.fillSubjects();
        this.fillColours();
        this.connect();
        if (this.stage && report.compared) this.compared = new Ghosts(report.compared, this.stage, () => (this.changed = true));
        clock.onChange(() => this.showTime());
        this.showTime();
        this.showLegend();
        this.showExaggeration();
        if (this.stage) {
            motion.at(motion.start);
            this.stage.place(motion.bodies);
            this.stage.resize();
            this.stage.lookAt(this.stage.followed);
        }
        requestAnimationFrame((now) => this.frame(now));
    }

    private get several() { return this.report.bodies.length > 1; }
    private get surfaces() { return this.report.bodies.some(({ surface }) => surface); }

    get playing() { return this.shape === null ? this.clock.playing : this.swinging; }

    toggle() {
        if (this.leading) {
            this.clock.playing = !this.clock.playing;
            return this.showTime();
        }
        if (this.shape === null) return this.clock.toggle();
        this.swinging = !this.swinging;
        this.showTime();
    }

    /// Takes up a run that the page leads on by itself.
    lead(run: LiveRun) {
        const { stage, report, clock } = this;
        const stress = () => {
            const of = (stage?.bodies ?? []).map(({ body }, i) => body?.greatestStress(run.placed[i].q) ?? null);
            const known = of.filter((value) => value !== null);
            return known.length > 0 ? Math.max(...known) : null;
        };
        const panel = new LivePanel(report, run, stress, () => this.switchLive());
        const changed = () => (this.changed = true);
        const [force] = run.live.units;
        const pull = stage && new Pull(stage, run, () => panel.strength, () => this.exaggeration, force, changed);
        this.live = { run, panel, pull };
        run.onChange(changed);
        clock.show(run.time);
        this.switchLive();
    }

    /// The live run where it is shown.
    get leading(): LiveRun | null { return this.live?.run.active && this.shape === null ? this.live.run : null; }

    restartLive() { this.live?.panel.restart(); }

    /// Between the live run and the recorded one.
    toggleLive() {
        const on = element<HTMLInputElement>("live-on");
        on.checked = !on.checked;
        on.dispatchEvent(new Event("change"));
    }

    private switchLive() {
        const { live, clock, motion } = this;
        if (!live) return;
        clock.playing = false;
        for (const id of ["step", "restart", "ghost"]) element<HTMLInputElement>(id).disabled = !live.run.active;
        for (const input of document.querySelectorAll<HTMLInputElement>("#live-controls input")) input.disabled = !live.run.active;
        element<HTMLInputElement>("time").disabled = live.run.active; // what is computed has no way back
        if (live.run.active) clock.show(live.run.time);
        else clock.seek(Math.min(motion.end, clock.time));
        this.showGhost();
    }

    private showGhost() {
        const seen = this.leading !== null && element<HTMLInputElement>("ghost").checked;
        for (const { body } of this.stage?.bodies ?? []) if (body) body.ghost.visible = seen;
        this.changed = true;
    }

    /// A shape alone, or the run.
    show(shape: BodyShape | null) {
        this.shape = shape;
        this.swinging = !matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.phase = 0.25; // at its greatest
        if (shape !== null) this.clock.playing = false;
        element<HTMLSelectElement>("subject").value = shape === null ? "run" : `${shape.body} ${shape.shape}`;
        this.prepare();
        this.resetView();
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
        this.stage?.lookAt(this.shape?.body ?? this.stage.followed);
        this.changed = true;
    }

    private shapeText({ body, shape }: BodyShape): string {
        const of = this.report.bodies[body];
        const { name, frequency } = of.shapes[shape];
        const text = frequency === null ? name : `${name}: ${withUnit(number(frequency), this.report.units.frequency)}`;
        return this.several ? `${of.name}, ${text}` : text;
    }

    private fillSubjects() {
        const select = element<HTMLSelectElement>("subject");
        select.add(new Option("the run", "run"));
        this.report.bodies.forEach(({ surface, shapes }, body) => {
            if (!surface) return;
            shapes.forEach((_, shape) => select.add(new Option(this.shapeText({ body, shape }), `${body} ${shape}`)));
        });
        select.addEventListener("change", () => {
            const [body, shape] = select.value.split(" ").map(Number);
            this.show(select.value === "run" ? null : { body, shape });
        });
    }

    private fillColours() {
        const select = element<HTMLSelectElement>("colour");
        if (this.surfaces) select.add(new Option("displacement", "displacement"));
        if (this.report.bodies.some(({ surface, stress }) => surface && stress)) select.add(new Option("von Mises stress", "stress"));
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
        const drawn = stage.bodies.filter(({ body }) => body);
        const hasFacets = drawn.length > 0 && drawn.every(({ body }) => body!.hasFacets);
        element<HTMLInputElement>("axes").checked = drawn.length < stage.bodies.length || !hasFacets;
        for (const part of document.querySelectorAll<HTMLElement>(".of-surface")) part.hidden = drawn.length === 0;
        element("outline").parentElement!.hidden = !drawn.some(({ body }) => body!.hasFacets);
        this.tellOfSurfaces(stage);
        this.connectFollowing(stage);
        check("outline", (on) => drawn.forEach(({ body }) => (body!.outline.visible = on)));
        check("axes", () => this.showSurroundings());
        check("path", () => this.showSurroundings());
        new ResizeObserver(() => {
            stage.resize();
            this.changed = true;
        }).observe(element("canvas"));
        onSchemeChange(() => this.recolour());
    }

    /// Says which bodies are shown by something else than their surface.
    private tellOfSurfaces(stage: Stage) {
        const named = (is: (body: Body | null) => boolean, of: string, all: string) => {
            const names = this.report.bodies.filter((_, i) => is(stage.bodies[i].body)).map(({ name }) => name);
            return names.length === 0 ? [] : [this.several ? `${of} ${names.join(", ")}.` : all];
        };
        const words = [
            ...named((body) => body !== null && !body.hasFacets, "Only nodes are known of",
                "This body comes from matrices: its nodes are shown, for it has no elements and so no surface."),
            ...named((body) => body === null, "Without a mesh, shown by their axes:", "This body has no mesh: its axes are shown."),
        ];
        const without = element("no-surface");
        without.hidden = words.length === 0;
        without.textContent = words.join(" ");
    }

    /// Which body the camera goes with; of several none at first, so that all are seen.
    private connectFollowing(stage: Stage) {
        const box = element<HTMLInputElement>("follow");
        const select = element<HTMLSelectElement>("followed");
        this.report.bodies.forEach(({ name }, i) => select.add(new Option(name, String(i))));
        select.hidden = !this.several;
        box.checked = stage.followed !== null;
        if (this.several) element("follow-label").textContent = "Follow";
        const follow = () => {
            stage.followed = box.checked ? Number(select.value) : null;
            if (this.frames > 0) this.resetView();
        };
        box.addEventListener("change", follow);
        select.addEventListener("change", () => {
            box.checked = true;
            follow();
        });
    }

    recolour() {
        this.stage?.recolour();
        this.compared?.recolour();
        this.changed = true;
    }

    /// Draws the picture that paper shows.
    print() {
        this.recolour();
        this.drawInto(element<HTMLCanvasElement>("printed-picture"));
    }

    /// Draws the picture into a plain canvas; false where there is none.
    drawInto(plain: HTMLCanvasElement): boolean {
        this.prepare();
        this.stage?.drawInto(plain);
        this.changed = true;
        return this.stage !== null;
    }

    /// Looks from a direction at what is in the middle of the picture.
    lookFrom(direction: Vector3) {
        this.stage?.lookFrom(direction);
        this.changed = true;
    }

    private showSurroundings() {
        const checked = (id: string) => element<HTMLInputElement>(id).checked;
        this.stage?.show(this.shape?.body ?? null, checked("path"), checked("axes"));
        if (this.live) this.showGhost();
    }

    /// Greatest value of the field: over the run, or of a shape where its coordinate is 1.
    private peak(): number {
        if (this.field === "none" || !this.stage) return 0;
        if (this.shape !== null) {
            const body = this.stage.bodies[this.shape.body].body!;
            return (this.field === "stress" ? body.stressPeaks?.[this.shape.shape] : body.displacementPeaks[this.shape.shape]) ?? 0;
        }
        const of = this.report.bodies.map((body) => (this.field === "stress" ? body.stress?.peak : body.displacement_peak) ?? 0);
        return Math.max(...of);
    }

    private showLegend() {
        this.changed = true;
        this.showSurroundings();
        const peak = this.peak();
        for (const { body } of this.stage?.bodies ?? []) body?.colourBy(this.field, peak);
        element("legend").hidden = this.field === "none" || !this.stage;
        const alone = this.shape !== null;
        const stress = this.report.bodies.find((body) => body.stress)?.stress?.unit;
        const unit = alone ? "relative" : this.field === "stress" ? stress! : this.report.units.length;
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

    /// Sets the state of the bodies for this instant.
    private prepare() {
        const { stage, motion } = this;
        if (!stage) return;
        this.compared?.place(this.clock.time, this.exaggeration, this.shape === null);
        if (this.shape === null) {
            motion.at(this.clock.time);
            const shown = this.leading?.placed ?? motion.bodies;
            stage.place(shown);
            stage.bodies.forEach(({ body }, i) => body?.deform(shown[i].q, this.exaggeration));
            if (this.leading) stage.bodies.forEach((body, i) => body.placeGhost(motion.bodies[i], this.exaggeration));
            return;
        }
        const staged = stage.bodies[this.shape.body];
        const greatest = staged.body!.displacementPeaks[this.shape.shape];
        const q = new Float32Array(motion.bodies[this.shape.body].shapes);
        q[this.shape.shape] = Math.sin(2 * Math.PI * this.phase);
        stage.placeAlone(this.shape.body);
        staged.body!.deform(q, greatest > 0 ? (SWING * staged.radius) / greatest : 0, true);
    }

    private frame(now: number) {
        requestAnimationFrame((next) => this.frame(next));
        const seconds = Math.min(0.1, (now - this.last) / 1000);
        this.last = now;
        const started = performance.now();
        if (this.playing) {
            if (this.leading) {
                this.live!.pull?.lead();
                this.leading.advance(seconds);
                this.live!.pull?.draw();
            } else if (this.shape === null) this.clock.advance(seconds);
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
