// A body in the space, with its axes and its path.

import * as THREE from "three";
import { Body } from "./body";
import { cssColour } from "../colours";
import type { BodyData } from "../data";
import type { BodyMotion, Placed } from "../motion";

const AXIS_COLOURS = ["axis-x", "axis-y", "axis-z"];

export class StagedBody {
    readonly body: Body | null;
    readonly axes = new THREE.Group();
    readonly path: THREE.Line;
    /// Box of all places of its origin.
    readonly way: THREE.Box3;
    /// Radius about its middle.
    readonly radius: number;
    /// Middle of the undeformed body, from the origin of its frame in body axes.
    private readonly middle: THREE.Vector3;
    /// Where that is in space.
    readonly center = new THREE.Vector3();

    /// A body without a mesh is drawn as large as `usual`, the radius of other bodies; 0 where there are none.
    constructor(motion: BodyMotion, body: Body | null, usual: number) {
        this.body = body;
        this.way = new THREE.Box3().setFromArray(motion.origins);
        const extent = this.way.getSize(new THREE.Vector3()).length();
        const size = body?.bounds.radius ?? 0;
        this.radius = size > 0 ? size : usual > 0 ? usual / 2 : extent > 0 ? extent / 8 : 1;
        this.middle = body?.bounds.center.clone() ?? new THREE.Vector3();
        this.path = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
        this.path.geometry.setAttribute("position", new THREE.BufferAttribute(motion.origins, 3));
        this.path.frustumCulled = false;
        for (let axis = 0; axis < 3; axis++) {
            const tip = new THREE.Vector3().setComponent(axis, 0.6 * this.radius);
            const geometry = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), tip]);
            this.axes.add(new THREE.Line(geometry, new THREE.LineBasicMaterial({ depthTest: false })));
        }
        this.axes.renderOrder = 1;
    }

    /// How far it reaches from the origin of its frame.
    get reach() { return this.radius + this.middle.length(); }

    addTo(scene: THREE.Scene) {
        scene.add(this.path, this.axes);
        if (this.body) scene.add(this.body.group, this.body.ghost);
    }

    recolour() {
        const colour = (name: string) => new THREE.Color().setStyle(cssColour(name), THREE.LinearSRGBColorSpace);
        const set = (object: THREE.Line, name: string) => (object.material as THREE.LineBasicMaterial).color.setStyle(cssColour(name));
        set(this.path, "path");
        this.axes.children.forEach((line, axis) => set(line as THREE.Line, AXIS_COLOURS[axis]));
        this.body?.setLineColours(colour("edge"), colour("outline"));
    }

    /// Shows where the body is in another motion.
    placeGhost({ origin, attitude, q }: Placed, exaggeration: number) {
        this.body?.ghost.position.set(...origin);
        this.body?.ghost.quaternion.set(...attitude);
        this.body?.deformGhost(q, exaggeration);
    }

    place(origin: ArrayLike<number>, attitude: ArrayLike<number>) {
        const placed = this.body?.group ?? this.axes;
        for (const object of [placed, this.axes]) {
            object.position.set(origin[0], origin[1], origin[2]);
            object.quaternion.set(attitude[0], attitude[1], attitude[2], attitude[3]);
        }
        // The body turns about the origin of its frame, which may be far from its middle or stand still.
        this.center.copy(this.middle).applyQuaternion(placed.quaternion).add(placed.position);
    }
}

/// All bodies of a run.
export function stagedBodies(bodies: BodyData[], motions: BodyMotion[]): StagedBody[] {
    const drawn = bodies.map((data) => (data.surface ? new Body(data) : null));
    const usual = Math.max(0, ...drawn.map((body) => body?.bounds.radius ?? 0));
    return bodies.map((_, i) => new StagedBody(motions[i], drawn[i], usual));
}
