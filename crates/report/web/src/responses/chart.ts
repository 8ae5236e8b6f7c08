// One chart of curves over the frequency.

import uPlot from "uplot";
import { cssColour } from "../colours";
import { number } from "../format";
import { fileName, savePng } from "../saved/file";

/// Colours of the style sheet: course-0 and so on. Curves after them are dashed.
export const COLOURS = 6;
const HEIGHT = 300;
const SYNC = "frequency";
/// The most powers of ten that an axis of values has: what is so far below the greatest is rounding.
const DECADES = 12;
/// Powers of ten between two labels are as many that there are no more labels than this.
const LABELS = 7;

/// A curve in a chart: its values, and the colour that it has.
export interface Line { values: Float32Array; colour: number }

export class FrequencyChart {
    private chart: uPlot | null = null;
    private readonly place = document.createElement("div");
    private range: [number, number] | null = null;

    constructor(
        parent: HTMLElement, private readonly name: string, private readonly logarithmic: boolean, private readonly at: Float64Array,
        private readonly unit: string, private readonly onRead: (row: number | null) => void, private readonly onRange: (from: FrequencyChart, range: [number, number]) => void,
    ) {
        const figure = document.createElement("figure");
        figure.className = "plot";
        const caption = document.createElement("figcaption");
        const title = document.createElement("span");
        title.className = "plot-name";
        title.textContent = name;
        const tools = document.createElement("span");
        tools.className = "plot-tools";
        const save = document.createElement("button");
        save.className = "link";
        save.textContent = "PNG";
        save.setAttribute("aria-label", `${name}: save the chart as a picture`);
        save.addEventListener("click", () => this.chart && savePng(fileName(name, "png"), this.picture()));
        tools.append(save);
        caption.append(title, tools);
        figure.append(caption, this.place);
        parent.append(figure);
        new ResizeObserver(() => this.setWidth(parent.clientWidth)).observe(parent);
    }

    private setWidth(parent: number) {
        const width = Math.max(200, parent - 28);
        if (this.chart && width !== this.chart.width) this.chart.setSize({ width, height: HEIGHT });
    }

    /// Draws lines anew.
    draw(lines: Line[], logarithmicFrequency: boolean) {
        const axis = { stroke: () => cssColour("muted"), grid: { stroke: () => cssColour("grid"), width: 1 },
            ticks: { stroke: () => cssColour("grid"), width: 1 }, font: "12px system-ui, sans-serif" };
        // A logarithm has no place for a frequency of zero, or for a value of zero.
        const first = logarithmicFrequency && this.at[0] <= 0 ? 1 : 0;
        const values = lines.map((line) => Array.from(line.values.subarray(first), (value) => (this.logarithmic && value <= 0 ? null : value)));
        const words = (_: uPlot, ticks: (number | null)[]) => ticks.map((tick) => (tick === null ? "" : number(tick, 3)));
        this.chart?.destroy();
        this.chart = new uPlot({
            width: Math.max(200, this.place.clientWidth), height: HEIGHT,
            legend: { show: false },
            scales: { x: { time: false, distr: logarithmicFrequency ? 3 : 1 }, y: this.logarithmic ? { distr: 3, range: (_, min, max) => decades(min, max) } : { distr: 1 } },
            axes: [
                { ...axis, values: words, size: 30, gap: 3, label: `Frequency, ${this.unit}`, labelSize: 20, labelFont: axis.font },
                { ...axis, values: words, size: 72, gap: 4, ...(this.logarithmic ? { splits: (_: uPlot, __: number, min: number, max: number) => powers(min, max) } : {}) },
            ],
            series: [{}, ...lines.map(({ colour }) => ({
                stroke: () => cssColour(`course-${colour % COLOURS}`), width: 1.5, dash: colour >= COLOURS ? [6, 3] : undefined,
                points: { show: false },
            }))],
            cursor: { sync: { key: SYNC, scales: ["x", null] }, drag: { x: true, y: false, dist: 4 }, points: { size: 6 } },
            hooks: {
                setCursor: [({ cursor }) => this.onRead(cursor.idx == null ? null : cursor.idx + first)],
                setScale: [(chart, key) => {
                    const { min, max } = chart.scales.x;
                    if (key !== "x" || min == null || max == null) return;
                    this.range = [min, max];
                    this.onRange(this, this.range);
                }],
            },
        }, [this.at.subarray(first), ...values] as unknown as uPlot.AlignedData, this.place);
        if (this.range && !(logarithmicFrequency && this.range[0] <= 0)) this.setRange(this.range);
    }

    setRange([min, max]: [number, number]) { this.chart?.setScale("x", { min, max }); }
    redraw() { this.chart?.redraw(false); }

    /// Puts the mark on a row.
    mark(row: number) {
        if (!this.chart) return;
        const left = this.chart.valToPos(this.at[row], "x");
        this.chart.setCursor({ left, top: this.chart.bbox.height / devicePixelRatio / 2 });
    }

    private picture(): HTMLCanvasElement {
        const { ctx: { canvas: source }, width } = this.chart!;
        const ratio = source.width / width;
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [source.width, source.height + 26 * ratio];
        const context = canvas.getContext("2d")!;
        context.fillStyle = getComputedStyle(document.getElementById("charts")!).backgroundColor;
        context.fillRect(0, 0, canvas.width, canvas.height);
        context.drawImage(source, 0, 26 * ratio);
        context.scale(ratio, ratio);
        [context.fillStyle, context.font, context.textBaseline] = [cssColour("text"), "600 13px system-ui, sans-serif", "middle"];
        context.fillText(this.name, 8, 13);
        return canvas;
    }
}

/// Powers of ten about two values.
function decades(min: number | null, max: number | null): [number, number] {
    if (min === null || max === null) return [0.1, 1];
    const top = Math.ceil(Math.log10(max) + 1e-9);
    const bottom = Math.min(top - 1, Math.max(Math.floor(Math.log10(min)), top - DECADES));
    return [10 ** bottom, 10 ** top];
}

/// Powers of ten between two values, few enough to be labels.
function powers(min: number, max: number): number[] {
    const [first, last] = [Math.ceil(Math.log10(min) - 1e-9), Math.floor(Math.log10(max) + 1e-9)];
    const step = Math.max(1, Math.ceil((last - first) / LABELS));
    return Array.from({ length: Math.floor((last - first) / step) + 1 }, (_, i) => 10 ** (first + i * step));
}
