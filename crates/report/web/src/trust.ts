// The trust card: where the answer may be wrong, the worst first.

import type { Report } from "./data";

/// An error from which on a line calls for attention.
const NOTED = 0.01;

/// Words with what stands between back quotes in code font.
function words(text: string): Node[] {
    return text.split("`").map((part, i) => {
        if (i % 2 === 0) return document.createTextNode(part);
        const code = document.createElement("code");
        code.textContent = part;
        return code;
    });
}

/// Fills the card; without lines it stays hidden.
export function showTrust(report: Report) {
    const { lines, unseen } = report.trust;
    if (lines.length === 0) return;
    const card = document.getElementById("trust")!;
    const list = card.querySelector("ol")!;
    for (const { place, body, error, meaning, known, next } of lines) {
        const item = document.createElement("li");
        item.className = error === null ? "unknown" : error >= NOTED ? "noted" : "small";
        const [name, text, more] = ["strong", "span", "span"].map((tag) => document.createElement(tag));
        name.textContent = place;
        text.append(...words(`${body ? `body ${body}: ` : ""}${meaning}`));
        more.className = "muted";
        more.append(...words([known, next && `to do: ${next}`].filter(Boolean).join("; ")));
        item.append(name, text, more);
        list.append(item);
    }
    card.querySelector("p")!.textContent = unseen;
    card.hidden = false;
}
