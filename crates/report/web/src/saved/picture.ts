// The picture of the bodies as a PNG: what is seen, with the legend, the axes, the names and the time.

import type { Viewer } from "../picture/viewer";
import { fileName, savePng } from "./file";

const FONT = "system-ui, sans-serif";

/// A button that saves what is seen.
export function offerPicture(viewer: Viewer) {
    const button = document.createElement("button");
    button.id = "save-picture";
    button.className = "quiet";
    button.textContent = "Save picture";
    button.addEventListener("click", () => {
        const canvas = picture(viewer);
        if (canvas) savePng(fileName(`at_${document.getElementById("now")!.textContent ?? ""}`, "png"), canvas);
    });
    document.getElementById("reset")!.after(button);
}

/// What is seen, on a canvas of its own.
function picture(viewer: Viewer): HTMLCanvasElement | null {
    const bodies = document.createElement("canvas");
    if (!viewer.drawInto(bodies)) return null;
    const stage = document.querySelector<HTMLElement>(".stage")!;
    const frame = stage.getBoundingClientRect();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [bodies.width, bodies.height];
    const context = canvas.getContext("2d")!;
    context.fillStyle = getComputedStyle(stage).backgroundColor;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(bodies, 0, 0);
    context.scale(canvas.width / frame.width, canvas.height / frame.height);
    context.textBaseline = "middle";
    drawBar(context, frame);
    for (const id of ["legend-name", "legend-ticks", "names", "caption", "no-surface"]) drawTexts(context, frame, document.getElementById(id)!);
    drawTriad(context, frame);
    const ink = getComputedStyle(document.body).color;
    write(context, document.getElementById("now")!.textContent ?? "", frame.width - 12, frame.height - 16, "right", `13px ${FONT}`, ink);
    return canvas;
}

function write(context: CanvasRenderingContext2D, text: string, x: number, y: number, align: CanvasTextAlign, font: string, colour: string) {
    context.font = font;
    context.fillStyle = colour;
    context.textAlign = align;
    context.fillText(text, x, y);
}

/// Texts of an element and of those in it, where they are seen.
function drawTexts(context: CanvasRenderingContext2D, frame: DOMRect, element: HTMLElement) {
    for (const part of element.children.length > 0 ? [...element.children] as HTMLElement[] : [element]) {
        const style = getComputedStyle(part);
        const range = document.createRange();
        range.selectNodeContents(part); // its box may be wider than its text
        const box = range.getBoundingClientRect();
        if (!part.textContent || box.width === 0 || style.visibility === "hidden") continue;
        const middle = box.left + box.width / 2 - frame.left;
        write(context, part.textContent, middle, box.top + box.height / 2 - frame.top, "center",
            `${style.fontWeight} ${style.fontSize} ${FONT}`, style.color);
    }
}

/// The bar of colours; its style sheet has the colours from the bottom to the top.
function drawBar(context: CanvasRenderingContext2D, frame: DOMRect) {
    const bar = document.getElementById("legend-bar")!;
    const box = bar.getBoundingClientRect();
    if (box.width === 0) return;
    const [top, left] = [box.top - frame.top, box.left - frame.left];
    const gradient = context.createLinearGradient(0, top + box.height, 0, top);
    const colours = getComputedStyle(bar).backgroundImage.match(/rgb\([^)]*\)/g) ?? [];
    colours.forEach((colour, i) => gradient.addColorStop(i / Math.max(1, colours.length - 1), colour));
    context.fillStyle = gradient;
    context.fillRect(left, top, box.width, box.height);
}

function drawTriad(context: CanvasRenderingContext2D, frame: DOMRect) {
    const svg = document.getElementById("triad")!;
    const box = svg.getBoundingClientRect();
    const scale = box.width / 80; // of its view box
    context.save();
    context.translate(box.left + box.width / 2 - frame.left, box.top + box.height / 2 - frame.top);
    context.scale(scale, scale);
    for (const part of svg.children) {
        const at = (name: string) => Number(part.getAttribute(name));
        const style = getComputedStyle(part);
        if (part.tagName === "line") {
            context.strokeStyle = style.stroke;
            context.lineWidth = 2;
            context.beginPath();
            context.moveTo(at("x1"), at("y1"));
            context.lineTo(at("x2"), at("y2"));
            context.stroke();
        } else {
            context.textBaseline = "alphabetic";
            write(context, part.textContent ?? "", at("x"), at("y"), "center", `13px ${FONT}`, style.fill);
        }
    }
    context.restore();
}
