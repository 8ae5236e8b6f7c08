// The page of answers over the frequency: charts one above the other, and a table of the curves with their values under the pointer.

import "uplot/dist/uPlot.min.css";
import "../style.css";
import "./style.css";
import { onSchemeChange } from "../colours";
import { number, withUnit } from "../format";
import { COLOURS, FrequencyChart } from "./chart";
import { readResponses, type Responses } from "./data";

/// Curves that are shown at first.
const AT_FIRST = 6;

function element<Name extends keyof HTMLElementTagNameMap>(name: Name, text = ""): HTMLElementTagNameMap[Name] {
    const made = document.createElement(name);
    made.textContent = text;
    return made;
}

function header(data: Responses) {
    document.title = data.title;
    document.getElementById("title")!.textContent = data.title;
    for (const [label, value] of data.facts) {
        const pair = element("div");
        pair.append(element("dt", label), element("dd", value));
        document.getElementById("facts")!.append(pair);
    }
    for (const warning of data.warnings) {
        const paragraph = element("p", warning);
        paragraph.className = "warning";
        document.getElementById("warnings")!.append(paragraph);
    }
    const leftOut = document.getElementById("left-out")!;
    leftOut.hidden = data.left_out === null;
    leftOut.textContent = data.left_out;
    document.getElementById("footer")!.textContent = `Made by ${data.program}. This page loads nothing from a network.`;
}

class Page {
    private readonly charts: FrequencyChart[];
    private readonly rows: HTMLTableRowElement[] = [];
    private readonly readings: HTMLElement[][] = [];
    private readonly checks: HTMLInputElement[] = [];
    /// Curves that are shown, by the colour that they have.
    private readonly shown: (number | undefined)[] = [];
    private readonly logarithmic = document.getElementById("logarithmic") as HTMLInputElement;
    private row: number | null = null;
    private passing = false;

    constructor(private readonly data: Responses) {
        const parent = document.getElementById("charts")!;
        this.charts = data.charts.map(({ name, logarithmic }) => new FrequencyChart(
            parent, name, logarithmic, data.at, data.frequency_unit, (row) => this.read(row), (from, range) => this.passRange(from, range),
        ));
        this.table();
        this.logarithmic.checked = data.logarithmic;
        this.logarithmic.addEventListener("change", () => this.draw());
        document.getElementById("all")!.addEventListener("click", () => this.all());
        document.getElementById("none")!.addEventListener("click", () => this.choose([]));
        document.getElementById("some")!.addEventListener("click", () => this.choose(this.ofOneUnit()));
        const filter = document.getElementById("filter") as HTMLInputElement;
        filter.addEventListener("input", () => this.rows.forEach((row, i) => (row.hidden = !data.curves[i].name.includes(filter.value.trim()))));
        document.addEventListener("keydown", (event) => this.key(event));
        onSchemeChange(() => this.charts.forEach((chart) => chart.redraw()));
        this.choose(this.ofOneUnit().slice(0, AT_FIRST));
    }

    private table() {
        const table = document.getElementById("table") as HTMLTableElement;
        const { charts, curves, headings } = this.data;
        const head = table.createTHead().insertRow();
        for (const text of ["Curve", ...charts.map(({ name }) => name), "Unit", ...headings]) head.append(element("th", text));
        const body = table.createTBody();
        curves.forEach((curve, i) => {
            const row = body.insertRow();
            const [label, check, key] = [element("label"), element("input"), element("i")];
            check.type = "checkbox";
            check.addEventListener("change", () => this.toggle(i, check.checked));
            label.append(check, key, curve.name);
            row.insertCell().append(label);
            this.readings.push(charts.map(() => row.insertCell()));
            const units = [...new Set(curve.units.filter((unit) => unit !== "°" && unit !== ""))].join(", ");
            for (const text of [units, ...curve.about]) row.insertCell().textContent = text;
            this.rows.push(row);
            this.checks.push(check);
        });
    }

    /// Curves of the unit that the first one has.
    private ofOneUnit(): number[] {
        const { curves } = this.data;
        return [...curves.keys()].filter((i) => curves[i].units[0] === curves[0].units[0]);
    }

    private choose(curves: number[]) {
        this.shown.length = 0;
        this.shown.push(...curves);
        this.draw();
    }

    private toggle(curve: number, on: boolean) {
        const free = this.shown.indexOf(undefined);
        if (!on) this.shown[this.shown.indexOf(curve)] = undefined;
        else if (free >= 0) this.shown[free] = curve;
        else this.shown.push(curve);
        this.draw();
    }

    private draw() {
        const { of } = this.data;
        const colours = [...this.shown.keys()].filter((colour) => this.shown[colour] !== undefined);
        this.rows.forEach((row, i) => {
            const colour = this.shown.indexOf(i);
            const key = row.querySelector("i")!;
            row.classList.toggle("shown", colour >= 0);
            key.style.color = `var(--course-${Math.max(0, colour) % COLOURS})`;
            key.classList.toggle("dashed", colour >= COLOURS);
            this.checks[i].checked = colour >= 0;
        });
        this.passing = true;
        this.charts.forEach((chart, k) => chart.draw(colours.map((colour) => ({ values: of[this.shown[colour]!][k], colour })), this.logarithmic.checked));
        this.passing = false;
        this.read(this.row);
    }

    /// Values at a row; without one at the last that was read.
    private read(row: number | null) {
        const { at, of, frequency_unit } = this.data;
        if (row === null && this.row !== null) return;
        this.row = row;
        const place = document.getElementById("place")!;
        place.textContent = row === null ? "" : `At ${withUnit(number(at[row], 7), frequency_unit)}`;
        this.readings.forEach((readings, i) => readings.forEach((reading, k) => {
            reading.textContent = row === null ? "" : number(of[i][k][row], 5);
        }));
    }

    private passRange(from: FrequencyChart, range: [number, number]) {
        if (this.passing) return;
        this.passing = true;
        for (const chart of this.charts) if (chart !== from) chart.setRange(range);
        this.passing = false;
    }

    private all() {
        const { at } = this.data;
        const first = this.logarithmic.checked && at[0] <= 0 ? at[1] : at[0];
        this.charts.forEach((chart) => chart.setRange([first, at[at.length - 1]]));
    }

    private key(event: KeyboardEvent) {
        if (event.ctrlKey || event.metaKey || event.altKey || (event.target as HTMLElement).closest("input[type=search]")) return;
        const last = this.data.at.length - 1;
        const at = this.row ?? 0;
        const rows: Record<string, number> = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: last };
        if (!(event.key in rows)) return;
        event.preventDefault();
        const row = Math.min(last, Math.max(0, rows[event.key]));
        this.charts[0].mark(row);
        this.row = null;
        this.read(row);
    }
}

void readResponses().then((data) => {
    header(data);
    Object.assign(window, { responsesPage: new Page(data) });
});
