// Puts the page together.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Clock } from "./clock";
import { readReport, type Report } from "./data";
import { LiveRun } from "./live/run";
import { Motion } from "./motion";
import { panels } from "./plots/panels";
import { listenToPrinter } from "./print";
import { offerViews } from "./picture/views";
import { Viewer } from "./picture/viewer";
import { showTrust } from "./trust";
import { offerPicture } from "./saved/picture";

function header(report: Report) {
    document.title = `${report.title} – report`;
    document.getElementById("title")!.textContent = report.title;
    const state = document.getElementById("state")!;
    state.textContent = report.unfinished === null ? "Complete run" : "Unfinished run";
    state.classList.toggle("unfinished", report.unfinished !== null);
    const facts = document.getElementById("facts")!;
    const [only] = report.bodies;
    for (const [label, value] of report.bodies.length > 1 ? report.facts : [...only.facts, ...report.facts]) {
        const pair = document.createElement("div");
        pair.append(document.createElement("dt"), document.createElement("dd"));
        pair.firstElementChild!.textContent = label;
        pair.lastElementChild!.textContent = value;
        facts.append(pair);
    }
    showTrust(report);
    const warnings = document.getElementById("warnings")!;
    const notes = [...(report.unfinished === null ? [] : [report.unfinished]), ...report.warnings];
    for (const note of notes) {
        const paragraph = document.createElement("p");
        paragraph.className = "warning";
        paragraph.textContent = note;
        warnings.append(paragraph);
    }
    document.getElementById("footer")!.textContent = `Made by ${report.program}. This page loads nothing from a network.`;
}

/// Keys for the whole page, but not where they mean something else.
function keyboard(report: Report, clock: Clock, viewer: Viewer) {
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const target = event.target as HTMLElement;
        const range = target instanceof HTMLInputElement && target.type === "range";
        if (target.closest("select, textarea, #live-controls")) return;
        if (event.key === " " && target.closest("button, summary, input") && !range) return;
        const { leading } = viewer;
        const large = Math.max(1, Math.round(clock.motion.times.length / 20));
        const actions: Record<string, () => void> = {
            " ": () => viewer.toggle(),
            ArrowLeft: () => clock.step(event.shiftKey ? -large : -1),
            ArrowRight: () => clock.step(event.shiftKey ? large : 1),
            Home: () => clock.seek(clock.motion.start),
            End: () => clock.seek(clock.motion.end),
            "+": () => clock.changeSpeed(1),
            "=": () => clock.changeSpeed(1),
            "-": () => clock.changeSpeed(-1),
            "[": () => viewer.exaggerate(-1),
            "]": () => viewer.exaggerate(1),
            r: () => viewer.resetView(),
            R: () => viewer.resetView(),
            ...(report.live ? { l: () => viewer.toggleLive(), L: () => viewer.toggleLive() } : {}),
            ...(leading ? { ArrowLeft: () => {}, ArrowRight: () => leading.step(), Home: () => viewer.restartLive(), End: () => {} } : {}),
        };
        const action = actions[event.key];
        if (!action) return;
        event.preventDefault();
        action();
    });
}

async function begin() {
    const report = await readReport();
    header(report);
    const motion = new Motion(report);
    const clock = new Clock(motion);
    const viewer = new Viewer(report, motion, clock);
    listenToPrinter(viewer, panels(report, clock, viewer));
    keyboard(report, clock, viewer);
    offerViews((direction) => viewer.lookFrom(direction));
    offerPicture(viewer);
    // For the test of the page.
    const page: Record<string, unknown> = { clock, viewer };
    Object.assign(window, { reportPage: page });
    if (report.live) {
        LiveRun.begin(report, report.live, clock).then((run) => {
            viewer.lead(run);
            page.live = run;
        }, (error) => {
            const warning = document.createElement("p");
            warning.className = "warning";
            warning.textContent = `The live run does not start in this browser: ${error.message ?? error}`;
            document.getElementById("warnings")!.append(warning);
        });
    }
}

begin();
