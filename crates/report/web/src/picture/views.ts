// Standard views: buttons of a list, and where the camera is for each.

import * as THREE from "three";

/// From the body to the camera. Along z it is a little off, so that x points to the right.
const VIEWS: [name: string, direction: [number, number, number]][] = [
    ["isometric", [1, -1, 1]],
    ["xy, from z", [0, -1e-4, 1]],
    ["xz, from −y", [0, -1, 0]],
    ["yz, from x", [1, 0, 0]],
    ["from y", [0, 1, 0]],
    ["from −x", [-1, 0, 0]],
    ["from −z", [0, -1e-4, -1]],
];

/// A list of views in the page, which says to `look` from where.
export function offerViews(look: (direction: THREE.Vector3) => void) {
    const label = document.createElement("label");
    const select = document.createElement("select");
    select.id = "view";
    label.append("View ", select);
    select.add(new Option("as turned", ""));
    for (const [name] of VIEWS) select.add(new Option(name, name));
    select.addEventListener("change", () => {
        const found = VIEWS.find(([name]) => name === select.value);
        if (found) look(new THREE.Vector3(...found[1]).normalize());
        select.value = ""; // the same view can be chosen again
    });
    document.getElementById("reset")!.before(label);
}
