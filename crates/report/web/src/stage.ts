// The space in which the body moves: camera, ground, path, axes.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Body } from "./body";
import { cssColour } from "./colours";
import type { Report } from "./data";
import { roundStep } from "./format";
import type { Motion } from "./motion";
import { Triad } from "./triad";

const DIRECTION = new THREE.Vector3(0.55, -0.9, 0.5).normalize(); // from the body to the camera, at first
const NODE_PIXELS = 5;
const PRINT_RATIO = 2; // pixels of a print in one of the screen
const AXIS_COLOURS = ["axis-x", "axis-y", "axis-z"];

export class Stage {
    readonly body: Body | null;
    readonly bodyAxes = new THREE.Group();
    readonly path: THREE.Line;
    following = true;
    private readonly renderer: THREE.WebGLRenderer;
    private readonly scene = new THREE.Scene();
    private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
    private readonly controls: OrbitControls;
    private readonly triad: Triad;
    private readonly ground: THREE.GridHelper;
    /// Middle of the undeformed body, from the origin of its frame in body axes.
    private readonly middle: THREE.Vector3;
    /// Where that is in space.
    private readonly center = new THREE.Vector3();
    private readonly moved = new THREE.Vector3();
    /// Radius of the body about its middle.
    readonly radius: number;
    /// Radius of all that the camera was last set to look at.
    private inView: number;

    /// Throws where the browser has no WebGL 2.
    constructor(private readonly canvas: HTMLCanvasElement, report: Report, motion: Motion, onChange: () => void) {
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.camera.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener("change", onChange);
        this.triad = new Triad(document.querySelector<SVGSVGElement>("#triad")!);
        this.body = report.surface ? new Body(report) : null;
        const path = new THREE.Box3().setFromArray(motion.origins);
        const extent = path.getSize(new THREE.Vector3()).length();
        const size = this.body?.bounds.radius ?? 0;
        this.radius = size > 0 ? size : extent > 0 ? extent / 8 : 1;
        this.inView = this.radius;
        this.middle = this.body?.bounds.center.clone() ?? new THREE.Vector3();

        this.path = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
        this.path.geometry.setAttribute("position", new THREE.BufferAttribute(motion.origins, 3));
        this.path.frustumCulled = false;
        for (let axis = 0; axis < 3; axis++) {
            const tip = new THREE.Vector3().setComponent(axis, 0.6 * this.radius);
            const geometry = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), tip]);
            this.bodyAxes.add(new THREE.Line(geometry, new THREE.LineBasicMaterial({ depthTest: false })));
        }
        this.bodyAxes.renderOrder = 1;
        this.ground = this.makeGround(path, extent);
        this.scene.add(this.path, this.bodyAxes, this.ground);
        if (this.body) this.scene.add(this.body.group);
        this.recolour();
    }

    /// How far the body reaches from the origin of its frame.
    private get reach() { return this.radius + this.middle.length(); }

    private makeGround(path: THREE.Box3, extent: number): THREE.GridHelper {
        const across = extent + 6 * this.reach;
        const step = roundStep(Math.max(this.radius / 3, across / 120));
        const count = 2 * Math.ceil(across / step / 2);
        const ground = new THREE.GridHelper(count * step, count);
        const middle = path.getCenter(new THREE.Vector3());
        ground.rotation.x = Math.PI / 2; // into the plane of x and y
        ground.position.set(Math.round(middle.x / step) * step, Math.round(middle.y / step) * step, path.min.z - 1.15 * this.reach);
        (ground.material as THREE.Material).transparent = true;
        (ground.material as THREE.Material).depthWrite = false;
        return ground;
    }

    /// After a change between the light and the dark scheme.
    recolour() {
        const colour = (name: string) => new THREE.Color().setStyle(cssColour(name), THREE.LinearSRGBColorSpace);
        const set = (object: THREE.Line, name: string) => (object.material as THREE.LineBasicMaterial).color.setStyle(cssColour(name));
        set(this.path, "path");
        this.bodyAxes.children.forEach((line, axis) => set(line as THREE.Line, AXIS_COLOURS[axis]));
        const material = this.ground.material as THREE.LineBasicMaterial;
        material.vertexColors = false;
        material.color.setStyle(cssColour("ground"));
        material.needsUpdate = true;
        this.body?.setLineColours(colour("edge"), colour("outline"));
    }

    /// Sets the place of the body; the camera goes with it if it follows.
    place(origin: ArrayLike<number>, attitude: ArrayLike<number>) {
        const placed = this.body?.group ?? this.bodyAxes;
        const from = this.moved.copy(this.center);
        for (const object of [placed, this.bodyAxes]) {
            object.position.set(origin[0], origin[1], origin[2]);
            object.quaternion.set(attitude[0], attitude[1], attitude[2], attitude[3]);
        }
        // The body turns about the origin of its frame, which may be far from its middle or stand still.
        this.center.copy(this.middle).applyQuaternion(placed.quaternion).add(placed.position);
        if (this.following) {
            const shift = from.subVectors(this.center, from);
            this.camera.position.add(shift);
            this.controls.target.add(shift);
        }
    }

    /// Ground and path belong to the run, not to a shape that is shown alone.
    showSurroundings(shown: boolean, path: boolean) {
        this.ground.visible = shown;
        this.path.visible = shown && path;
    }

    /// Looks at the whole body, or at a sphere around all that it may reach along the path of the origin.
    lookAt(motion: Motion | null) {
        const sphere = new THREE.Sphere(new THREE.Vector3(), this.radius);
        if (motion) {
            new THREE.Box3().setFromArray(motion.origins).getBoundingSphere(sphere);
            sphere.radius += this.reach;
        } else {
            sphere.center.copy(this.center);
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
        this.body?.setPointSize(NODE_PIXELS * ratio);
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
