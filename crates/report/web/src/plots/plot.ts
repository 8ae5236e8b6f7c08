// One plot of courses over time, with the values at the time that is shown.

import uPlot from "uplot";
import type { Clock } from "../clock";
import { cssColour } from "../colours";
import { number, withUnit } from "../format";
import { rowAt } from "../motion";
import { plotTools, type ToolSettings } from "./tools";

export interface Course { name: string; values: Float32Array }

/// Values that differ by less than such a part of the greatest differ by the rounding of single precision.
const SINGLE = 1e-6;

const HEIGHT = 170;
const COLOURS = 6; // of the style sheet: course-0 and so on
/// A press and release nearer than this is a click, not a zoom.
const CLICK_PIXELS = 4;

/// Plots that show the same range of time.
export class PlotGroup {
    private readonly plots: Plot[] = [];
    private passing = false;
    constructor(readonly clock: Clock, readonly times: Float64Array, readonly tools: ToolSettings) {
        clock.onChange(() => this.plots.forEach((plot) => plot.mark()));
    }
    add(plot: Plot) { this.plots.push(plot); }
    clear() { this.plots.splice(0).forEach((plot) => plot.destroy()); }
    recolour() { this.plots.forEach((plot) => plot.chart.redraw(false)); }
    /// Makes the plots so wide; as wide as their place without a width.
    setWidth(width?: number) { this.plots.forEach((plot) => plot.setWidth(width)); }

    passRange(from: uPlot, min: number, max: number) {
        if (this.passing) return;
        this.passing = true;
        for (const { chart } of this.plots) if (chart !== from) chart.setScale("x", { min, max });
        this.passing = false;
    }

    /// Narrows or widens about the time that is shown.
    zoom(factor: number) {
        const first = this.plots[0]?.chart;
        if (!first) return;
        const { min, max } = first.scales.x;
        const [start, end] = [this.times[0], this.times[this.times.length - 1]];
        const width = Math.min(end - start, (max! - min!) * factor);
        const middle = factor < 1 ? this.clock.time : (min! + max!) / 2;
        const low = Math.max(start, Math.min(end - width, middle - width / 2));
        if (width > 0) this.setRange(low, low + width);
    }
    all() { this.setRange(this.times[0], this.times[this.times.length - 1]); }
    private setRange(min: number, max: number) {
        for (const { chart } of this.plots) chart.setScale("x", { min, max });
    }
}

export class Plot {
    readonly chart: uPlot;
    private readonly now = document.createElement("div");
    private readonly readings: HTMLElement[] = [];
    private readonly observer: ResizeObserver;

    /// The axis of the values is at least as long as `leastRange`, so that rounding does not look like a motion.
    constructor(
        private readonly parent: HTMLElement, private readonly group: PlotGroup, title: string, private readonly unit: string,
        leastRange: number, private readonly courses: Course[],
    ) {
        const figure = document.createElement("figure");
        figure.className = "plot";
        const caption = document.createElement("figcaption");
        const name = document.createElement("span");
        name.className = "plot-name";
        name.textContent = unit === "" || unit === "1" ? title : `${title}, ${unit}`;
        caption.append(name);
        courses.forEach((course, i) => {
            const reading = document.createElement("span");
            reading.className = "reading";
            const key = document.createElement("i");
            key.style.color = `var(--course-${i % COLOURS})`;
            if (i >= COLOURS) key.className = "dashed";
            const value = document.createElement("span");
            reading.append(key, course.name ? `${course.name} ` : "", value);
            this.readings.push(value);
            caption.append(reading);
        });
        const place = document.createElement("div");
        figure.append(caption, place);
        parent.append(figure);

        const axis = { stroke: () => cssColour("muted"), grid: { stroke: () => cssColour("grid"), width: 1 },
            ticks: { stroke: () => cssColour("grid"), width: 1 }, font: "12px system-ui, sans-serif" };
        this.chart = new uPlot({
            width: Math.max(200, parent.clientWidth), height: HEIGHT,
            legend: { show: false },
            scales: { x: { time: false }, y: { range: (_, min, max) => rangeOf(min, max, leastRange) } },
            axes: [
                { ...axis, values: (_, ticks) => ticks.map((tick) => number(tick)), size: 28, gap: 3 },
                { ...axis, values: (_, ticks) => ticks.map((tick) => number(tick)), size: 68, gap: 4 },
            ],
            series: [{}, ...courses.map((_, i) => ({
                stroke: () => cssColour(`course-${i % COLOURS}`), width: 1.5, pxAlign: 0, dash: i >= COLOURS ? [6, 3] : undefined, points: { show: false },
            }))],
            cursor: {
                sync: { key: "time" }, drag: { x: true, y: false, dist: CLICK_PIXELS }, points: { size: 6 },
            },
            hooks: {
                setCursor: [() => this.read()],
                setScale: [(chart, key) => {
                    const { min, max } = chart.scales.x;
                    if (key === "x" && min != null && max != null) group.passRange(chart, min, max);
                }],
                setSize: [() => this.mark()],
                draw: [() => this.mark()],
            },
        }, [group.times, ...courses.map((course) => course.values)] as unknown as uPlot.AlignedData, place);
        const names = courses.map((course) => course.name);
        caption.append(plotTools({ chart: this.chart, figure, title, unit, names, times: group.times, values: courses.map(({ values }) => values) }, group.tools));
        this.now.className = "now";
        this.chart.over.append(this.now);
        this.listen();
        this.observer = new ResizeObserver(() => this.setWidth());
        this.observer.observe(parent);
        group.add(this);
        this.mark();
    }

    setWidth(width = this.parent.clientWidth) {
        if (width > 0 && width !== this.chart.width) this.chart.setSize({ width, height: HEIGHT });
    }

    private listen() {
        let pressed = 0;
        const { over } = this.chart;
        over.addEventListener("mousedown", (event) => (pressed = event.clientX));
        over.addEventListener("click", (event) => {
            if (Math.abs(event.clientX - pressed) > CLICK_PIXELS) return;
            this.group.clock.playing = false;
            this.group.clock.seek(this.chart.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
        });
    }

    /// Moves the mark of the time that is shown.
    mark() {
        if (!this.chart) return;
        const { min, max } = this.chart.scales.x;
        const { time } = this.group.clock;
        if (min == null || max == null) return;
        this.now.hidden = time < min || time > max;
        this.now.style.transform = `translateX(${this.chart.valToPos(time, "x")}px)`;
        this.read();
    }

    /// Values under the pointer, or else at the time that is shown.
    private read() {
        if (!this.chart) return;
        const { idx } = this.chart.cursor;
        const row = idx ?? rowAt(this.group.times, this.group.clock.time);
        this.courses.forEach((course, i) => {
            this.readings[i].textContent = this.courses.length > 1 ? number(course.values[row]) : withUnit(number(course.values[row]), this.unit);
        });
    }

    destroy() {
        this.observer.disconnect();
        this.chart.destroy();
    }
}

/// Ends of the axis of values between two numbers.
function rangeOf(min: number | null, max: number | null, leastRange: number): [number | null, number | null] {
    if (min == null || max == null) return [null, null];
    if (min === 0 && max === 0) return [-1, 1];
    const least = Math.max(leastRange, SINGLE * Math.max(Math.abs(min), Math.abs(max)));
    if (max - min >= least || least === 0) return uPlot.rangeNum(min, max, 0.1, true) as [number, number];
    const middle = (min + max) / 2;
    return [middle - least / 2, middle + least / 2];
}
