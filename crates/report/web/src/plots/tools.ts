// What may be done with a plot: saved as a picture or a table, and seen as a spectrum.

import uPlot from "uplot";
import { cssColour } from "../colours";
import { number, withUnit } from "../format";
import { fileName, savePng, saveText } from "../saved/file";
import { peaks, spectrum, type Spectrum } from "./spectrum.mjs";

/// A plot as the tools see it.
export interface Shown {
    chart: uPlot;
    figure: HTMLElement;
    title: string;
    unit: string;
    names: string[];
    times: Float64Array;
    values: Float32Array[];
}

/// Names of the unit of time and of cycles per time, and true if the plots do not show every row.
export interface ToolSettings { time: string; frequency: string; thinned: boolean }

const COLOURS = 6;
const HEIGHT = 200;
/// Fewer rows have no spectrum worth the name.
const FEWEST = 16;
/// Amplitudes are shown down to such a part of the greatest.
const DEPTH = 1e-5;
const DIGITS = 8; // of single precision
/// First line of a table that has not got every row.
const THINNED =
    "# least and greatest values of ranges of rows, at the first and the last time of each range; every row: flexframe export --csv";

export function plotTools(shown: Shown, settings: ToolSettings): HTMLElement {
    const tools = document.createElement("span");
    tools.className = "plot-tools";
    const button = (text: string, label: string, action: () => void) => {
        const made = document.createElement("button");
        made.className = "link";
        made.textContent = text;
        made.title = label;
        made.setAttribute("aria-label", `${shown.title}: ${label}`);
        made.addEventListener("click", action);
        tools.append(made);
        return made;
    };
    let seen: { part: HTMLElement; chart: uPlot | null } | null = null;
    const toggle = button("Spectrum", "spectrum of the times that are shown", () => {
        if (seen) {
            seen.chart?.destroy();
            seen.part.remove();
            seen = null;
        } else seen = spectrumOf(shown, settings);
        toggle.setAttribute("aria-expanded", String(seen !== null));
    });
    toggle.setAttribute("aria-expanded", "false");
    button("CSV", settings.thinned ? "save the least and greatest values that are shown as a table" : "save the rows that are shown as a table", () => saveText(fileName(shown.title, "csv"), "text/csv", table(shown, settings)));
    button("PNG", "save the plot as a picture", () => savePng(fileName(shown.title, "png"), picture(shown)));
    return tools;
}

/// First and last row of the times that are shown.
function range({ chart, times }: Shown): [number, number] {
    const { min, max } = chart.scales.x;
    const rows = [...times.keys()].filter((i) => times[i] >= (min ?? -Infinity) && times[i] <= (max ?? Infinity));
    return [rows[0] ?? 0, rows[rows.length - 1] ?? -1];
}

/// The rows that are shown. Of a long run each range of rows has two lines, its least and its greatest value: that is said.
function table(shown: Shown, { time, thinned }: ToolSettings): string {
    const [first, last] = range(shown);
    const quoted = (text: string) => `"${text.replaceAll('"', '""')}"`;
    const heads = [`time, ${time}`, ...shown.names.map((name) => withUnit([shown.title, name].filter(Boolean).join(" ") + ",", shown.unit))];
    const lines = [heads.map((head) => quoted(head.replace(/,$/, ""))).join(",")];
    if (thinned) lines.unshift(THINNED);
    for (let i = first; i <= last; i++) {
        lines.push([shown.times[i], ...shown.values.map((values) => Number(values[i].toPrecision(DIGITS)))].join(","));
    }
    return `${lines.join("\n")}\n`;
}

/// The plot on a page of its colour, with its name and what the colours of its lines mean.
function picture({ chart, title, unit, names, figure }: Shown): HTMLCanvasElement {
    const source = chart.ctx.canvas;
    const ratio = source.width / chart.width;
    const head = 26;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [source.width, source.height + head * ratio];
    const context = canvas.getContext("2d")!;
    context.fillStyle = getComputedStyle(figure.closest("#panels")!).backgroundColor;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, head * ratio);
    context.scale(ratio, ratio);
    context.textBaseline = "middle";
    let x = 8;
    const write = (text: string, colour: string, font: string) => {
        [context.font, context.fillStyle] = [font, colour];
        context.fillText(text, x, head / 2);
        x += context.measureText(text).width + 14;
    };
    write(unit === "" || unit === "1" ? title : `${title}, ${unit}`, getComputedStyle(figure).color, "600 13px system-ui, sans-serif");
    names.forEach((name, i) => name && write(`— ${name}`, cssColour(`course-${i % COLOURS}`), "13px system-ui, sans-serif"));
    return canvas;
}

function spectrumOf(shown: Shown, settings: ToolSettings): { part: HTMLElement; chart: uPlot | null } {
    const part = document.createElement("div");
    part.className = "spectrum";
    shown.figure.after(part);
    const say = (text: string) => {
        const words = document.createElement("p");
        words.className = "muted";
        words.textContent = text;
        part.append(words);
    };
    const [first, last] = range(shown);
    const refused = settings.thinned
        ? "No spectrum: of this long run the page has the least and greatest values of ranges of rows, not every row. Take the rows from the results file (flexframe export --csv)."
        : last - first + 1 < FEWEST ? `No spectrum: ${last - first + 1} rows are shown, and it wants ${FEWEST} at least.` : null;
    if (refused) {
        say(refused);
        return { part, chart: null };
    }
    const times = shown.times.slice(first, last + 1);
    const spectra = shown.values.map((values) => spectrum(times, values.slice(first, last + 1)));
    const { resolution, frequencies } = spectra[0];
    const place = document.createElement("div");
    part.append(place);
    const chart = draw(place, shown, spectra, settings);
    say(`Spectrum of ${last - first + 1} rows from ${number(times[0])} to ${withUnit(number(times[times.length - 1]), settings.time)}: amplitude in ${
        shown.unit === "" || shown.unit === "1" ? "the unit of the plot" : shown.unit} over frequency in ${settings.frequency}; Hann window, without the mean. No peak is told that does not go through three periods; lines nearer than ${
        withUnit(number(2 * resolution, 2), settings.frequency)} are one; the highest frequency is ${withUnit(number(frequencies[frequencies.length - 1]), settings.frequency)}.`);
    const list = document.createElement("p");
    list.className = "peaks";
    spectra.forEach((of, i) => {
        const found = peaks(of).map(({ frequency, amplitude }) =>
            `${withUnit(number(frequency), settings.frequency)} (${withUnit(number(amplitude, 3), shown.unit)})`);
        const line = document.createElement("span");
        line.textContent = `${shown.names[i] ? `${shown.names[i]}: ` : "Peaks: "}${found.join(", ") || "no peak"}`;
        line.style.color = `var(--course-${i % COLOURS})`;
        list.append(line);
    });
    part.append(list);
    return { part, chart };
}

function draw(place: HTMLElement, shown: Shown, spectra: Spectrum[], { frequency }: ToolSettings): uPlot {
    const greatest = Math.max(...spectra.map(({ amplitudes }) => amplitudes.reduce((a, b) => Math.max(a, b), 0)));
    const top = greatest > 0 ? greatest : 1;
    const axis = { stroke: () => cssColour("muted"), grid: { stroke: () => cssColour("grid"), width: 1 },
        ticks: { stroke: () => cssColour("grid"), width: 1 }, font: "12px system-ui, sans-serif" };
    const courses = spectra.map(({ amplitudes }) => [...amplitudes].map((value) => (value < DEPTH * top ? null : value)));
    const powers = (least: number, most: number) => {
        const [first, last] = [least, most].map((value) => Math.log10(value));
        return Array.from({ length: Math.max(0, Math.floor(last) - Math.ceil(first) + 1) }, (_, i) => 10 ** (Math.ceil(first) + i));
    };
    return new uPlot({
        width: Math.max(200, shown.chart.width), height: HEIGHT,
        legend: { show: false },
        scales: { x: { time: false }, y: { distr: 3, range: [DEPTH * top, 2 * top] } },
        axes: [
            { ...axis, values: (_, ticks) => ticks.map((tick) => number(tick)), size: 28, gap: 3, label: `frequency, ${frequency}`, labelSize: 18, labelFont: axis.font },
            { ...axis, splits: (_, __, least, most) => powers(least, most), values: (_, ticks) => ticks.map((tick) => (tick == null ? "" : number(tick, 2))), size: 68, gap: 4 },
        ],
        series: [{}, ...courses.map((_, i) => ({ stroke: () => cssColour(`course-${i % COLOURS}`), width: 1.5, points: { show: false } }))],
        cursor: { drag: { x: true, y: false } },
    }, [spectra[0].frequencies, ...courses] as unknown as uPlot.AlignedData, place);
}
