// The little cross that shows where the global axes point.

import type { Camera } from "three";

const LENGTH = 26;

export class Triad {
    private readonly axes: { line: SVGElement; name: SVGElement }[];

    constructor(svg: SVGSVGElement) {
        const make = (tag: string, axis: string) => {
            const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
            element.setAttribute("class", `axis-${axis}`);
            svg.append(element);
            return element;
        };
        this.axes = ["x", "y", "z"].map((axis) => {
            const name = make("text", axis);
            name.textContent = axis;
            return { line: make("line", axis), name };
        });
    }

    draw(camera: Camera) {
        const view = camera.matrixWorldInverse.elements;
        this.axes.forEach(({ line, name }, axis) => {
            const [x, y, z] = [view[4 * axis], -view[4 * axis + 1], view[4 * axis + 2]];
            const set = (element: SVGElement, values: Record<string, number>) =>
                Object.entries(values).forEach(([key, value]) => element.setAttribute(key, value.toFixed(1)));
            set(line, { x1: 0, y1: 0, x2: LENGTH * x, y2: LENGTH * y });
            set(name, { x: (LENGTH + 8) * x, y: (LENGTH + 8) * y + 4 });
            line.style.opacity = String(z < 0 ? 0.55 : 1); // away from the viewer
        });
    }
}
