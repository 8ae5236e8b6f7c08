// Another run on the same page: its bodies as ghosts.

import type { Compared } from "../data";
import { Motion } from "../motion";
import type { Stage } from "./stage";
import { stagedBodies, type StagedBody } from "./staged";

export class Ghosts {
    private readonly motion: Motion;
    private readonly bodies: StagedBody[];
    private readonly box: HTMLInputElement;

    constructor({ name, times, bodies }: Compared, stage: Stage, changed: () => void) {
        this.motion = new Motion({ times, bodies });
        this.bodies = stagedBodies(bodies, this.motion.bodies);
        for (const { body, axes } of this.bodies) stage.scene.add(body?.ghost ?? axes);
        const label = document.createElement("label");
        this.box = document.createElement("input");
        Object.assign(this.box, { type: "checkbox", checked: true, id: "compared" });
        this.box.addEventListener("change", changed);
        label.append(this.box, ` ${name} as a ghost`);
        document.getElementById("reset")!.before(label);
        this.recolour();
    }

    recolour() {
        for (const body of this.bodies) body.recolour();
    }

    /// Where the other run is at this time; not beside a shape that is shown alone.
    place(time: number, exaggeration: number, run: boolean) {
        const seen = run && this.box.checked;
        if (seen) this.motion.at(time);
        this.bodies.forEach((body, i) => {
            const { origin, attitude } = this.motion.bodies[i];
            (body.body?.ghost ?? body.axes).visible = seen;
            if (!seen) return;
            body.place(origin, attitude);
            body.placeGhost(this.motion.bodies[i], exaggeration);
        });
    }
}
