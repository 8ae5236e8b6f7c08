// The space in which the bodies move: camera, ground, names.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { cssColour } from "../colours";
import type { Report } from "../data";
import { roundStep } from "../format";
import type { Motion, Placed } from "../motion";
import { stagedBodies, type StagedBody } from "./staged";
import { Triad } from "./triad";

const DIRECTION = new THREE.Vector3(0.55, -0.9, 0.5).normalize(); // from the body to the camera, at first
const NODE_PIXELS = 5;
const PRINT_RATIO = 2; // pixels of a print in one of the screen

export class Stage {
    readonly bodies: StagedBody[];
    /// The body that the camera goes with.
    followed: number | null;
    private readonly renderer: THREE.WebGLRenderer;
    readonly scene = new THREE.Scene();
    readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
    readonly controls: OrbitControls;
    private readonly triad: Triad;
    private readonly ground: THREE.GridHelper;
    private readonly names: HTMLElement[] = [];
    private readonly moved = new THREE.Vector3();
    /// Radius of all that the camera was last set to look at.
    private inView: number;

    /// Throws where the browser has no WebGL 2.
    constructor(readonly canvas: HTMLCanvasElement, report: Report, motion: Motion, onChange: () => void) {
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.camera.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener("change", onChange);
        this.triad = new Triad(document.querySelector<SVGSVGElement>("#triad")!);
        this.bodies = stagedBodies(report.bodies, motion.bodies);
        this.followed = this.bodies.length === 1 ? 0 : null;
        this.inView = this.bodies[0].radius;
        this.ground = this.makeGround();
        this.scene.add(this.ground);
        for (const body of this.bodies) body.addTo(this.scene);
        if (report.bodies.length > 1) this.makeNames(report);
        this.recolour();
    }

    private get way(): THREE.Box3 {
        return this.bodies.reduce((box, body) => box.union(body.way), new THREE.Box3());
    }

    private get reach() { return Math.max(...this.bodies.map((body) => body.reach)); }

    private makeGround(): THREE.GridHelper {
        const { way, reach } = this;
        const extent = way.getSize(new THREE.Vector3()).length();
        const across = extent + 6 * reach;
        const radius = Math.max(...this.bodies.map((body) => body.radius));
        const step = roundStep(Math.max(radius / 3, across / 120));
        const count = 2 * Math.ceil(across / step / 2);
        const ground = new THREE.GridHelper(count * step, count);
        const middle = way.getCenter(new THREE.Vector3());
        ground.rotation.x = Math.PI / 2; // into the plane of x and y
        ground.position.set(Math.round(middle.x / step) * step, Math.round(middle.y / step) * step, way.min.z - 1.15 * reach);
        (ground.material as THREE.Material).transparent = true;
        (ground.material as THREE.Material).depthWrite = false;
        return ground;
    }

    private makeNames(report: Report) {
        const place = document.getElementById("names")!;
        for (const { name } of report.bodies) {
            const shown = document.createElement("span");
            shown.textContent = name;
            place.append(shown);
            this.names.push(shown);
        }
    }

    /// After a change between the light and the dark scheme.
    recolour() {
        const material = this.ground.material as THREE.LineBasicMaterial;
        material.vertexColors = false;
        material.color.setStyle(cssColour("ground"));
        material.needsUpdate = true;
        for (const body of this.bodies) body.recolour();
    }

    /// Sets the places of all bodies; the camera goes with the one that it follows.
    place(motions: Placed[]) {
        this.going(() => this.bodies.forEach((body, i) => body.place(motions[i].origin, motions[i].attitude)));
    }

    /// A body in the middle of the space, as it is undeformed.
    placeAlone(body: number) {
        this.going(() => this.bodies[body].place([0, 0, 0], [0, 0, 0, 1]));
    }

    private going(place: () => void) {
        if (this.followed === null) return place();
        const { center } = this.bodies[this.followed];
        const from = this.moved.copy(center);
        place();
        const shift = from.subVectors(center, from);
        this.camera.position.add(shift);
        this.controls.target.add(shift);
    }

    /// Ground and paths belong to the run, not to a shape of the body `alone` that is shown by itself.
    show(alone: number | null, paths: boolean, axes: boolean) {
        this.ground.visible = alone === null;
        this.bodies.forEach((body, i) => {
            const shown = alone === null || alone === i;
            body.path.visible = alone === null && paths;
            body.axes.visible = shown && axes;
            if (body.body) body.body.group.visible = shown;
            if (body.body && alone !== null) body.body.ghost.visible = false;
            if (this.names[i]) this.names[i].hidden = alone !== null;
        });
    }

    /// Looks at a whole body, or at a sphere around all that the bodies may reach along the paths of their origins.
    lookAt(body: number | null) {
        const sphere = new THREE.Sphere();
        if (body === null) {
            this.way.getBoundingSphere(sphere);
            sphere.radius += this.reach;
        } else {
            sphere.set(this.bodies[body].center, this.bodies[body].radius);
        }
        const narrow = Math.min(1, this.camera.aspect);
        const distance = (1.02 * sphere.radius) / Math.sin((this.camera.fov * Math.PI) / 360) / narrow;
        this.inView = sphere.radius;
        this.controls.target.copy(sphere.center);
        this.camera.position.copy(sphere.center).addScaledVector(DIRECTION, distance);
        this.controls.update();
    }

    resize(ratio = Math.min(devicePixelRatio, 2)) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (width === 0 || height === 0) return;
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height, false);
        for (const { body } of this.bodies) body?.setPointSize(NODE_PIXELS * ratio);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
    }

    draw() {
        const distance = this.camera.position.distanceTo(this.controls.target);
        this.camera.near = Math.max(distance - 4 * this.inView, distance / 200);
        this.camera.far = distance + 1000 * this.inView;
        this.camera.updateProjectionMatrix();
        this.renderer.render(this.scene, this.camera);
        this.triad.draw(this.camera);
        this.names.forEach((name, i) => {
            const { x, y, z } = this.moved.copy(this.bodies[i].center).project(this.camera);
            name.style.left = `${50 + 50 * x}%`;
            name.style.top = `${50 - 50 * y}%`;
            name.style.visibility = Math.abs(z) < 1 ? "visible" : "hidden";
        });
    }

    /// Draws the picture into a plain canvas, too, which a printer can see: that of the graphics processor is empty by then.
    drawInto(plain: HTMLCanvasElement) {
        this.resize(PRINT_RATIO);
        this.draw();
        [plain.width, plain.height] = [this.canvas.width, this.canvas.height];
        plain.getContext("2d")!.drawImage(this.canvas, 0, 0);
        this.resize();
    }
}
