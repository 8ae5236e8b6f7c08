// The report on paper: all its parts, in the light scheme, with a picture that stands still.

import type { Panels } from "./plots/panels";
import type { Viewer } from "./picture/viewer";

/// Width of plots: that of A4 and of Letter between their margins, with some room.
const PLOT_WIDTH = 660;

export function listenToPrinter(viewer: Viewer, panels: Panels) {
    const root = document.documentElement;
    addEventListener("beforeprint", () => {
        root.classList.add("printing");
        viewer.print();
        panels.print(PLOT_WIDTH);
    });
    addEventListener("afterprint", () => {
        root.classList.remove("printing");
        viewer.recolour();
        panels.restore();
    });
}
