// Plots and tables beside the body.

import type { Clock } from "../clock";
import { onSchemeChange } from "../colours";
import { double, single, type BodyData, type Component, type Report } from "../data";
import { number, withUnit } from "../format";
import type { Motion } from "../motion";
import { Plot, PlotGroup } from "./plot";
import type { Viewer } from "../picture/viewer";

type Cell = string | HTMLElement;

function make<K extends keyof HTMLElementTagNameMap>(tag: K, text = "", className = ""): HTMLElementTagNameMap[K] {
    const made = document.createElement(tag);
    if (text) made.textContent = text;
    if (className) made.className = className;
    return made;
}

function table(heads: string[], rows: Cell[][], numeric: number[] = []): HTMLElement {
    const made = make("table");
    const head = made.createTHead().insertRow();
    heads.forEach((text, i) => {
        const cell = make("th", text, numeric.includes(i) ? "number" : "");
        cell.scope = "col";
        head.append(cell);
    });
    const body = made.createTBody();
    for (const cells of rows) {
        const row = body.insertRow();
        cells.forEach((content, i) => {
            const cell = row.insertCell();
            if (numeric.includes(i)) cell.className = "number";
            cell.append(content);
        });
    }
    const scroll = make("div", "", "scroll");
    scroll.append(made);
    return scroll;
}

const courses = (components: Component[]) => components.map(({ name, values }) => ({ name, values: single(values) }));

function zoomButtons(group: PlotGroup, unit: string): HTMLElement {
    const bar = make("div", "", "zoom");
    const button = (text: string, label: string, action: () => void) => {
        const made = make("button", text, "quiet");
        made.setAttribute("aria-label", label);
        made.addEventListener("click", action);
        bar.append(made);
    };
    bar.append(make("span", `time, ${unit}`, "muted"));
    button("Zoom in", "Zoom in on the time that is shown", () => group.zoom(0.5));
    button("Zoom out", "Zoom out in time", () => group.zoom(2));
    button("Whole run", "Show the whole run in the plots", () => group.all());
    return bar;
}

const tools = (report: Report, times: Float64Array) =>
    ({ time: report.units.time, frequency: report.units.frequency, thinned: times.length < report.rows });

/// A long run shows fewer points than it has rows.
function thinned(report: Report, points: number, sentence: string): HTMLElement[] {
    return points < report.rows ? [make("p", `${points} of ${report.rows} rows. ${sentence}`, "muted")] : [];
}

function histories(panel: HTMLElement, report: Report, clock: Clock, times: Float64Array): PlotGroup {
    const group = new PlotGroup(clock, times, tools(report, times));
    onSchemeChange(() => group.recolour());
    const names = [...new Set(report.histories.map((history) => history.group))];
    const plots = make("div");
    const select = make("select");
    names.forEach((name) => select.add(new Option(name)));
    const draw = () => {
        group.clear();
        plots.replaceChildren();
        for (const { name, unit, least_range, components } of report.histories.filter((history) => history.group === select.value))
            new Plot(plots, group, name, unit, least_range, courses(components));
    };
    select.addEventListener("change", draw);
    const bar = make("div", "", "bar");
    const label = make("label", "Of ");
    label.append(select);
    bar.append(label, zoomButtons(group, report.units.time));
    panel.append(bar, plots);
    panel.append(...thinned(report, times.length, "Each range of rows shows its least and its greatest value, so no peak is lost."));
    draw();
    return group;
}

function balances(panel: HTMLElement, report: Report, clock: Clock, times: Float64Array): PlotGroup {
    const rows = report.balances.map(({ group, name, unit, error_peak, term_peak }) => [
        group ? `${group}: ${name}` : name, withUnit(number(error_peak, 3), unit), withUnit(number(term_peak, 3), unit),
        term_peak > 0 ? number(error_peak / term_peak, 2) : "–",
    ]);
    panel.append(table(["Balance", "Greatest error", "Greatest term", "Ratio"], rows, [1, 2, 3]));
    const group = new PlotGroup(clock, times, tools(report, times));
    onSchemeChange(() => group.recolour());
    const names = [...new Set(report.balances.map((balance) => balance.group))];
    const select = make("select");
    names.forEach((name) => select.add(new Option(name)));
    const parts = make("div");
    const draw = () => {
        group.clear();
        parts.replaceChildren();
        for (const { name, law, unit, least_range, terms, errors } of report.balances.filter((balance) => balance.group === select.value)) {
            const part = make("section");
            part.append(make("h3", name), make("p", law, "muted"));
            parts.append(part);
            new Plot(part, group, "Terms", unit, least_range, courses(terms));
            new Plot(part, group, "Error", unit, least_range, courses(errors));
        }
    };
    select.addEventListener("change", draw);
    const label = make(names.length > 1 ? "label" : "span");
    if (names.length > 1) label.append("Of ", select);
    const bar = make("div", "", "bar");
    bar.append(label, zoomButtons(group, report.units.time));
    panel.append(bar, parts);
    draw();
    return group;
}

/// Something of each body; of several under their names.
function ofBodies(panel: HTMLElement, report: Report, fill: (of: BodyData, body: number) => HTMLElement | null) {
    report.bodies.forEach((of, body) => {
        const part = fill(of, body);
        if (!part) return;
        if (report.bodies.length > 1) panel.append(make("h3", of.name));
        panel.append(part);
    });
}

function bodies(panel: HTMLElement, report: Report) {
    const labels = [...new Set(report.bodies.flatMap(({ facts }) => facts.map(([label]) => label)))];
    const rows = report.bodies.map(({ name, facts }) =>
        [name, ...labels.map((label) => facts.find(([known]) => known === label)?.[1] ?? "–")]);
    panel.append(table(["Body", ...labels], rows));
}

function shapes(panel: HTMLElement, report: Report, viewer: Viewer, motion: Motion) {
    const kinds = { natural: "mode", static: "static shape", "second order": "second-order shape" };
    const { frequency } = report.units;
    ofBodies(panel, report, (of, body) => {
        const count = of.shapes.length;
        if (count === 0) return null;
        const greatest = new Array<number>(count).fill(0);
        motion.bodies[body].coordinates.forEach((q, i) => (greatest[i % count] = Math.max(greatest[i % count], Math.abs(q))));
        const rows = of.shapes.map((shape, k): Cell[] => {
            let name: Cell = shape.name;
            if (of.surface) {
                name = make("button", shape.name, "link");
                name.setAttribute("aria-label", `Show ${report.bodies.length > 1 ? `${of.name}, ` : ""}${shape.name} alone`);
                name.addEventListener("click", () => viewer.show({ body, shape: k }));
            }
            return [
                name, kinds[shape.kind],
                shape.frequency === null ? "–" : number(shape.frequency, 5),
                shape.damping_ratio === null ? "–" : number(shape.damping_ratio, 3),
                number(greatest[k], 3),
            ];
        });
        return table(["Shape", "Kind", `Frequency, ${frequency}`, "Damping ratio", "Greatest |coordinate|"], rows, [2, 3, 4]);
    });
    const notes = [];
    if (report.bodies.some((body) => body.surface)) notes.push("Choose a shape to see it alone.");
    if (report.bodies.some((body) => body.shapes.some((shape) => shape.kind !== "natural")))
        notes.push("Static and second-order shapes are no vibration modes: they have no natural frequency.");
    panel.append(make("p", notes.join(" "), "muted"));
}

function effects(panel: HTMLElement, report: Report) {
    ofBodies(panel, report, (of) => {
        const rows = of.effects.map(([name, state, measure, reason]): Cell[] => {
            const mark = make("span", state, state === "on" ? "mark on" : "mark");
            return [name, mark, measure, reason];
        });
        return rows.length > 0 ? table(["Effect", "State", "Measure", "Why"], rows) : null;
    });
}

function scene(panel: HTMLElement, report: Report) {
    const [file, text] = report.scene;
    const copy = make("button", "Copy", "quiet");
    copy.addEventListener("click", async () => {
        await navigator.clipboard.writeText(text).then(() => (copy.textContent = "Copied"), () => (copy.textContent = "Not allowed here"));
    });
    const bar = make("div", "", "bar");
    bar.append(make("code", file), copy);
    const listing = make("pre", text);
    listing.tabIndex = 0;
    panel.append(bar, listing);
}

export interface Panels {
    /// Makes all of them ready for paper, where there are no tabs, with plots so wide.
    print(width: number): void;
    /// Back to the screen.
    restore(): void;
}

/// Tabs; each is filled when it is first shown.
export function panels(report: Report, clock: Clock, viewer: Viewer): Panels {
    const times = double(report.history_times);
    const parts: [string, boolean, (panel: HTMLElement) => PlotGroup | void][] = [
        ["Histories", report.histories.length > 0, (panel) => histories(panel, report, clock, times)],
        ["Balances", report.balances.length > 0, (panel) => balances(panel, report, clock, times)],
        ["Bodies", report.bodies.length > 1, (panel) => bodies(panel, report)],
        ["Shapes", report.bodies.some((body) => body.shapes.length > 0), (panel) => shapes(panel, report, viewer, clock.motion)],
        ["Effects", report.bodies.some((body) => body.effects.length > 0), (panel) => effects(panel, report)],
        ["Scene", report.scene[1] !== "", (panel) => scene(panel, report)],
    ];
    const list = document.getElementById("tabs")!;
    const shown = parts.filter(([, has]) => has).map(([name, , fill], i) => {
        const tab = make("button", name);
        const panel = make("div", "", "panel");
        Object.assign(tab, { id: `tab-${i}`, role: "tab" });
        Object.assign(panel, { id: `panel-${i}`, role: "tabpanel", hidden: true });
        tab.setAttribute("aria-controls", panel.id);
        panel.setAttribute("aria-labelledby", tab.id);
        list.append(tab);
        list.parentElement!.append(panel);
        panel.append(make("h2", name, "printed"));
        return { tab, panel, fill, filled: false, plots: undefined as PlotGroup | void };
    });
    const fill = (part: (typeof shown)[number]) => {
        if (part.filled) return;
        part.filled = true;
        part.plots = part.fill(part.panel);
    };
    const select = (chosen: number) => shown.forEach((part, i) => {
        part.tab.setAttribute("aria-selected", String(i === chosen));
        part.tab.tabIndex = i === chosen ? 0 : -1;
        part.panel.hidden = i !== chosen;
        if (i === chosen) fill(part);
    });
    shown.forEach(({ tab }, i) => tab.addEventListener("click", () => select(i)));
    list.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
        if (!step) return;
        event.stopPropagation(); // the arrows move the tabs here, not the time
        const here = shown.findIndex(({ tab }) => tab === document.activeElement);
        const next = (here + step + shown.length) % shown.length;
        select(next);
        shown[next].tab.focus();
    });
    if (shown.length > 0) select(0);
    const motionRows = clock.motion.times.length;
    document.getElementById("viewer")!.append(...thinned(report, motionRows, "The motion between the rows that are shown is interpolated."));
    const resize = (width?: number) => shown.forEach(({ plots }) => {
        plots?.setWidth(width);
        plots?.recolour();
    });
    return {
        print(width) {
            shown.forEach(fill);
            resize(width);
        },
        restore: () => resize(),
    };
}
