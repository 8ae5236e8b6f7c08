// A pull at a body by the pointer, with an arrow for its force.

import * as THREE from "three";
import { number, withUnit } from "../format";
import type { Stage } from "../picture/stage";
import type { LiveRun } from "./run";
import type { Three } from "./program.mjs";

/// Nodes without facets are met within this part of the body's radius.
const NEAR = 0.04;

interface Held {
    pointer: number;
    body: number;
    vertex: number;
    /// Where the pointer is, -1 to 1 across and up.
    at: THREE.Vector2;
    /// Depth of what is held, as the camera projects it.
    depth: number;
    /// From the place that is seen to that which is computed: they differ where the deformation is exaggerated.
    shift: THREE.Vector3;
}

export class Pull {
    private held: Held | null = null;
    private readonly ray = new THREE.Raycaster();
    private readonly arrow: THREE.Line;
    private readonly tip: THREE.Mesh;

    constructor(
        private readonly stage: Stage, private readonly run: LiveRun, private readonly strength: () => number,
        private readonly exaggeration: () => number, private readonly unit: string, private readonly changed: () => void,
    ) {
        const geometry = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]);
        const over = { depthTest: false, transparent: true };
        this.arrow = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: "#d6336c", ...over }));
        this.tip = new THREE.Mesh(new THREE.ConeGeometry(0.35, 1, 12), new THREE.MeshBasicMaterial({ color: "#d6336c", ...over }));
        for (const part of [this.arrow, this.tip]) {
            part.renderOrder = 2;
            part.frustumCulled = false;
            part.visible = false;
            stage.scene.add(part);
        }
        // Before the controls of the camera, which take the pointer where no body is met.
        stage.canvas.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
        stage.canvas.addEventListener("pointermove", (event) => this.move(event));
        for (const end of ["pointerup", "pointercancel"] as const) stage.canvas.addEventListener(end, (event) => this.up(event));
    }

    get isHeld() { return this.held !== null; }

    private place({ clientX, clientY }: PointerEvent): THREE.Vector2 {
        const { left, top, width, height } = this.stage.canvas.getBoundingClientRect();
        return new THREE.Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    }

    private down(event: PointerEvent) {
        if (!this.run.active || this.held || event.button !== 0) return;
        const at = this.place(event);
        this.ray.setFromCamera(at, this.stage.camera);
        let found: { body: number; vertex: number; distance: number } | null = null;
        this.stage.bodies.forEach(({ body, radius }, i) => {
            if (!body?.group.visible) return;
            body.group.updateMatrixWorld();
            const inBody = this.ray.ray.clone().applyMatrix4(body.group.matrixWorld.clone().invert());
            const hit = body.pick(inBody, this.run.placed[i].q, this.exaggeration(), NEAR * radius);
            if (hit && (!found || hit.distance < found.distance)) found = { body: i, ...hit };
        });
        if (!found) return;
        event.stopImmediatePropagation();
        event.preventDefault();
        const { body, vertex } = found as { body: number; vertex: number };
        const [seen, computed] = [this.seen(body, vertex), this.seen(body, vertex, 1)];
        const shift = computed.sub(seen);
        this.held = { pointer: event.pointerId, body, vertex, at, depth: seen.clone().project(this.stage.camera).z, shift };
        const of = this.stage.bodies[body].body!;
        const rest = of.placeOf(vertex, this.run.placed[body].q, 0, new THREE.Vector3());
        if (!this.run.pull(body, rest.toArray() as Three, of.shapesAt(vertex), this.target().toArray() as Three, this.strength())) {
            this.held = null;
            return;
        }
        this.stage.canvas.setPointerCapture(event.pointerId);
        this.draw();
        this.changed();
    }

    private move(event: PointerEvent) {
        if (this.held?.pointer !== event.pointerId) return;
        this.held.at = this.place(event);
        this.lead();
    }

    private up(event: PointerEvent) {
        if (this.held?.pointer !== event.pointerId) return;
        this.held = null;
        this.run.letGo();
        this.draw();
        this.changed();
    }

    /// Where a vertex is in space, as it is seen or with another exaggeration.
    private seen(body: number, vertex: number, exaggeration = this.exaggeration()): THREE.Vector3 {
        const { origin, attitude, q } = this.run.placed[body];
        const place = this.stage.bodies[body].body!.placeOf(vertex, q, exaggeration, new THREE.Vector3());
        return place.applyQuaternion(new THREE.Quaternion(...attitude)).add(new THREE.Vector3(...origin));
    }

    /// The place that is pulled to, as computed.
    private target(): THREE.Vector3 {
        const { at, depth, shift } = this.held!;
        return new THREE.Vector3(at.x, at.y, depth).unproject(this.stage.camera).add(shift);
    }

    /// Tells the program where the pointer is: the camera may have moved, too.
    lead() {
        if (!this.held) return;
        this.run.movePull(this.target().toArray() as Three);
        this.draw();
        this.changed();
    }

    /// The arrow from what is held to the pointer, and the force in words.
    draw() {
        const words = document.getElementById("force")!;
        const { held } = this;
        this.arrow.visible = this.tip.visible = held !== null;
        words.hidden = held === null;
        if (!held) return;
        const [from, to] = [this.seen(held.body, held.vertex), this.target().sub(held.shift)];
        const positions = this.arrow.geometry.getAttribute("position") as THREE.BufferAttribute;
        positions.setXYZ(0, from.x, from.y, from.z);
        positions.setXYZ(1, to.x, to.y, to.z);
        positions.needsUpdate = true;
        const along = to.clone().sub(from);
        this.tip.visible = along.lengthSq() > 0;
        this.tip.position.copy(to);
        this.tip.scale.setScalar(0.03 * this.stage.camera.position.distanceTo(to));
        this.tip.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
        const force = Math.hypot(...this.run.program.pulled.force);
        words.textContent = withUnit(number(force, 3), this.unit);
        const { x, y } = to.project(this.stage.camera);
        [words.style.left, words.style.top] = [`${50 + 50 * x}%`, `${50 - 50 * y}%`];
    }
}
