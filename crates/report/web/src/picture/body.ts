// The body on the graphics processor: the vertex shader adds up the shapes, Σ q_k φ_k, which rest in textures with one
// layer for each shape. A frame sends only the coordinates.

import * as THREE from "three";
import { indices, quantised, single, type BodyData, type Numbers } from "../data";
import { rgb } from "../colours";
import { SCALE } from "./scale.mjs";

export type Field = "none" | "displacement" | "stress";

const TEXTURE_WIDTH = 512;

const VERTEX = /* glsl */ `
uniform highp isampler2DArray shapes;
uniform vec4 weights[GROUPS];
uniform float exaggeration;
#ifdef STRESS
uniform highp isampler2DArray normalStresses;
uniform highp isampler2DArray shearStresses;
uniform vec4 stressWeights[STRESS_GROUPS];
#endif
uniform float peak;
uniform float pointSize;
out vec3 seen;
out float level;

void main() {
    ivec2 at = ivec2(gl_VertexID % ${TEXTURE_WIDTH}, gl_VertexID / ${TEXTURE_WIDTH});
    vec3 u = vec3(0.0);
    for (int k = 0; k < SHAPES; k++) {
        float weight = weights[k >> 2][k & 3];
        if (weight != 0.0) u += weight * vec3(texelFetch(shapes, ivec3(at, k), 0).xyz);
    }
    float value = length(u);
#ifdef STRESS
    vec3 s = vec3(0.0), t = vec3(0.0);
    for (int k = 0; k < STRESSES; k++) {
        float weight = stressWeights[k >> 2][k & 3];
        if (weight == 0.0) continue;
        s += weight * vec3(texelFetch(normalStresses, ivec3(at, k), 0).xyz);
        t += weight * vec3(texelFetch(shearStresses, ivec3(at, k), 0).xyz);
    }
    vec3 d = s - s.yzx;
    value = sqrt(0.5 * dot(d, d) + 3.0 * dot(t, t));
#endif
    level = peak > 0.0 ? value / peak : 0.0;
    vec4 place = modelViewMatrix * vec4(position + exaggeration * u, 1.0);
    seen = place.xyz;
    gl_Position = projectionMatrix * place;
    gl_PointSize = pointSize;
}`;

const FRAGMENT = /* glsl */ `
uniform vec3 scale[${SCALE.length}];
uniform vec3 plain;
uniform bool coloured;
in vec3 seen;
in float level;
out vec4 colour;

void main() {
#ifdef NODES
    if (length(gl_PointCoord - 0.5) > 0.5) discard;
    float light = 1.0;
#else
    // Flat facets: the normal of the deformed triangle, which faces the viewer.
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float light = 0.62 + 0.3 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.72))), 0.0) + 0.12 * normal.z;
#endif
    float x = clamp(level, 0.0, 1.0) * float(${SCALE.length - 1});
    int below = min(int(x), ${SCALE.length - 2});
    vec3 base = coloured ? mix(scale[below], scale[below + 1], x - float(below)) : plain;
    colour = vec4(base * light, 1.0);
}`;

const LINE_FRAGMENT = /* glsl */ `
uniform vec4 line;
out vec4 colour;
void main() { colour = line; }`;

/// Vectors for each shape, in a layer each.
function texture(shapes: Int16Array[], width: number, first: number, vertices: number): THREE.DataArrayTexture {
    const height = Math.max(1, Math.ceil(vertices / TEXTURE_WIDTH));
    const texels = new Int16Array(4 * TEXTURE_WIDTH * height * shapes.length);
    shapes.forEach((shape, k) => {
        const start = 4 * TEXTURE_WIDTH * height * k;
        for (let i = 0; i < vertices; i++)
            for (let axis = 0; axis < 3; axis++) texels[start + 4 * i + axis] = shape[width * i + first + axis];
    });
    const made = new THREE.DataArrayTexture(texels, TEXTURE_WIDTH, height, shapes.length);
    made.format = THREE.RGBAIntegerFormat;
    made.type = THREE.ShortType;
    made.internalFormat = "RGBA16I";
    made.needsUpdate = true;
    return made;
}

export function vonMises(s: ArrayLike<number>, i: number): number {
    const [xx, yy, zz, xy, yz, zx] = [0, 1, 2, 3, 4, 5].map((c) => s[i + c]);
    const normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2;
    return Math.sqrt(normal / 2 + 3 * (xy * xy + yz * yz + zx * zx));
}

/// Greatest magnitude of each shape where its coordinate is 1.
function peaks(shapes: Int16Array[], factors: number[], width: number, norm: (s: Int16Array, i: number) => number) {
    return shapes.map((shape, k) => {
        let greatest = 0;
        for (let i = 0; i < shape.length; i += width) greatest = Math.max(greatest, norm(shape, i));
        return greatest * factors[k];
    });
}

/// Vectors of four weights.
const groups = (count: number) => Math.max(1, Math.ceil(count / 4));

export class Body {
    readonly group = new THREE.Group();
    readonly outline: THREE.LineSegments;
    /// The edges in another motion; not seen at first.
    readonly ghost: THREE.LineSegments;
    private readonly ghostWeights: THREE.Vector4[];
    private readonly ghostExaggeration: THREE.IUniform;
    /// For what the picture asks on the main processor: places, shapes and stresses as they are stored.
    private readonly positions: Float32Array;
    private readonly triangles: ArrayLike<number>;
    private readonly shapes: Int16Array[];
    private readonly stresses: Int16Array[] = [];
    private readonly edges: THREE.LineSegments;
    readonly bounds: THREE.Sphere;
    readonly displacementPeaks: number[];
    readonly stressPeaks: number[] | null = null;
    private readonly uniforms: Record<string, THREE.IUniform>;
    private readonly materials = new Map<string, THREE.ShaderMaterial>();
    /// The facets, or the nodes where no facets are known.
    private readonly surface: THREE.Mesh | THREE.Points;
    readonly hasFacets: boolean;
    private readonly factors: number[];
    private readonly stressFactors: number[] = [];
    private readonly products: number[][] = [];
    private readonly count: number;

    constructor(data: BodyData) {
        const surface = data.surface!;
        const positions = single(surface.vertices);
        const vertices = positions.length / 3;
        this.count = data.shapes.length;
        const shapes = data.shapes.map((shape) => quantised(shape.displacement));
        [this.positions, this.shapes] = [positions, shapes];
        this.factors = data.shapes.map((shape) => shape.displacement.factor);
        this.displacementPeaks = peaks(shapes, this.factors, 3, (s, i) => Math.hypot(s[i], s[i + 1], s[i + 2]));
        const vectors = (count = this.count) => Array.from({ length: groups(count) }, () => new THREE.Vector4(0, 0, 0, 0));
        // A body without shapes keeps the sampler, which then has one empty layer.
        const layers = (list: Int16Array[], width: number, first: number) =>
            texture(list.length > 0 ? list : [new Int16Array(width * vertices)], width, first, vertices);
        this.uniforms = {
            shapes: { value: layers(shapes, 3, 0) },
            weights: { value: vectors() },
            exaggeration: { value: 1 },
            peak: { value: 1 },
            pointSize: { value: 1 },
            stressWeights: { value: [] },
            scale: { value: SCALE.map((hex) => new THREE.Vector3(...rgb(hex))) },
            plain: { value: new THREE.Vector3(0.6, 0.66, 0.72) },
            coloured: { value: true },
        };
        if (data.stress) {
            const stresses = data.stress.shapes.map((numbers: Numbers) => quantised(numbers));
            this.stresses = stresses;
            this.stressFactors = data.stress.shapes.map((numbers) => numbers.factor);
            this.stressPeaks = peaks(stresses, this.stressFactors, 6, vonMises);
            this.uniforms.normalStresses = { value: layers(stresses, 6, 0) };
            this.uniforms.shearStresses = { value: layers(stresses, 6, 3) };
            this.uniforms.stressWeights = { value: vectors(stresses.length) };
            this.products = data.stress.products;
        }
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
        const triangles = indices(surface.triangles);
        this.triangles = triangles;
        this.hasFacets = triangles.length > 0;
        if (this.hasFacets) geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
        geometry.computeBoundingSphere();
        this.bounds = geometry.boundingSphere!;
        const material = this.material("plain");
        this.surface = this.hasFacets ? new THREE.Mesh(geometry, material) : new THREE.Points(geometry, material);
        const lines = new THREE.BufferGeometry();
        lines.setAttribute("position", geometry.getAttribute("position"));
        lines.setIndex(new THREE.BufferAttribute(indices(surface.edges), 1));
        this.edges = new THREE.LineSegments(lines, this.lineMaterial(this.uniforms, 0.5));
        // The same edges with weights of zero.
        this.outline = new THREE.LineSegments(lines, this.lineMaterial({ ...this.uniforms, weights: { value: vectors() } }, 0.9));
        [this.ghostWeights, this.ghostExaggeration] = [vectors(), { value: 1 }];
        const ofGhost = { ...this.uniforms, weights: { value: this.ghostWeights }, exaggeration: this.ghostExaggeration };
        this.ghost = new THREE.LineSegments(lines, this.lineMaterial(ofGhost, 0.55));
        [this.ghost.visible, this.ghost.frustumCulled] = [false, false];
        (this.outline.material as THREE.Material).depthTest = false; // also seen within the body
        this.outline.renderOrder = 1;
        for (const part of [this.surface, this.edges, this.outline]) {
            part.frustumCulled = false; // the vertices move on the graphics processor
            this.group.add(part);
        }
    }

    private defines() {
        return { GROUPS: groups(this.count), SHAPES: this.count, ...(this.hasFacets ? {} : { NODES: 1 }) };
    }

    private material(kind: "plain" | "stress"): THREE.ShaderMaterial {
        const known = this.materials.get(kind);
        if (known) return known;
        const defines: Record<string, number> = this.defines();
        const stresses = this.stressFactors.length;
        if (kind === "stress") Object.assign(defines, { STRESS: 1, STRESSES: stresses, STRESS_GROUPS: groups(stresses) });
        const made = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
            uniforms: this.uniforms, defines, side: THREE.DoubleSide,
            polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, // edges lie before the facets
        });
        this.materials.set(kind, made);
        return made;
    }

    private lineMaterial(uniforms: Record<string, THREE.IUniform>, opacity: number): THREE.ShaderMaterial {
        return new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader: LINE_FRAGMENT,
            uniforms: { ...uniforms, line: { value: new THREE.Vector4(0, 0, 0, opacity) } }, defines: this.defines(), transparent: true,
        });
    }

    /// Diameter of nodes, in pixels of the picture.
    setPointSize(pixels: number) {
        this.uniforms.pointSize.value = pixels;
    }

    setLineColours(edge: THREE.Color, outline: THREE.Color) {
        const set = (lines: THREE.LineSegments, { r, g, b }: THREE.Color) => {
            const line = (lines.material as THREE.ShaderMaterial).uniforms.line.value as THREE.Vector4;
            line.set(r, g, b, line.w);
        };
        set(this.edges, edge);
        set(this.outline, outline);
        set(this.ghost, outline);
    }

    /// What is coloured, and the value at the end of the colours.
    colourBy(field: Field, peak: number) {
        const stressed = field === "stress" && this.stressPeaks !== null;
        this.surface.material = this.material(stressed ? "stress" : "plain");
        // A body without the quantity is plain.
        this.uniforms.coloured.value = stressed || (field === "displacement" && this.count > 0);
        this.uniforms.peak.value = peak;
    }

    /// The same coordinates as `deform`, of the motion of the ghost.
    deformGhost(q: ArrayLike<number>, exaggeration: number) {
        this.factors.forEach((factor, k) => this.ghostWeights[k >> 2].setComponent(k & 3, q[k] * factor));
        this.ghostExaggeration.value = exaggeration;
    }

    /// Place of a vertex, body axes, with `exaggeration` times its displacement.
    placeOf(vertex: number, q: ArrayLike<number>, exaggeration: number, out: THREE.Vector3): THREE.Vector3 {
        out.fromArray(this.positions, 3 * vertex);
        this.shapes.forEach((shape, k) => {
            const weight = exaggeration * q[k] * this.factors[k];
            out.x += weight * shape[3 * vertex];
            out.y += weight * shape[3 * vertex + 1];
            out.z += weight * shape[3 * vertex + 2];
        });
        return out;
    }

    /// Displacements of a vertex in a unit of each coordinate, three numbers each.
    shapesAt(vertex: number): number[] {
        return this.shapes.flatMap((shape, k) => [0, 1, 2].map((axis) => this.factors[k] * shape[3 * vertex + axis]));
    }

    /// The vertex that a ray in body axes meets: the nearest corner of the first facet, or of nodes alone the one next to the ray
    /// within `near`. None where it meets nothing.
    pick(ray: THREE.Ray, q: ArrayLike<number>, exaggeration: number, near: number): { vertex: number; distance: number } | null {
        const places = Array.from({ length: this.positions.length / 3 }, (_, i) => this.placeOf(i, q, exaggeration, new THREE.Vector3()));
        let found: { vertex: number; distance: number } | null = null;
        const take = (vertex: number, distance: number) => {
            if (!found || distance < found.distance) found = { vertex, distance };
        };
        const hit = new THREE.Vector3();
        for (let i = 0; i < this.triangles.length; i += 3) {
            const corners = [this.triangles[i], this.triangles[i + 1], this.triangles[i + 2]];
            const [a, b, c] = corners.map((corner) => places[corner]);
            if (!ray.intersectTriangle(a, b, c, false, hit)) continue;
            const nearest = corners.reduce((one, other) => (places[other].distanceTo(hit) < places[one].distanceTo(hit) ? other : one));
            take(nearest, ray.origin.distanceTo(hit));
        }
        if (!this.hasFacets) {
            places.forEach((place, vertex) => ray.distanceToPoint(place) < near && take(vertex, ray.origin.distanceTo(place)));
        }
        return found;
    }

    /// Greatest von Mises stress of all vertices at these coordinates; none without stress.
    greatestStress(q: ArrayLike<number>): number | null {
        if (this.stresses.length === 0) return null;
        const weights = this.stressFactors.map((factor, k) =>
            factor * (k < this.count ? q[k] : this.products[k - this.count].reduce((value, i) => value * q[i], 1)));
        const sums = new Float64Array(2 * this.positions.length);
        this.stresses.forEach((stress, k) => {
            if (weights[k] !== 0) for (let i = 0; i < sums.length; i++) sums[i] += weights[k] * stress[i];
        });
        let greatest = 0;
        for (let i = 0; i < sums.length; i += 6) greatest = Math.max(greatest, vonMises(sums, i));
        return greatest;
    }

    /// Coordinates of the shapes, and the factor on the displacement that is drawn. The stress of a small displacement has no
    /// products of coordinates.
    deform(q: ArrayLike<number>, exaggeration: number, small = false) {
        const set = (name: string, factors: number[], coordinate: (k: number) => number) => {
            const vectors = this.uniforms[name].value as THREE.Vector4[];
            factors.forEach((factor, k) => vectors[k >> 2].setComponent(k & 3, coordinate(k) * factor));
        };
        set("weights", this.factors, (k) => q[k]);
        const product = (factors: number[]) => (small ? 0 : factors.reduce((value, k) => value * q[k], 1));
        set("stressWeights", this.stressFactors, (k) => (k < this.count ? q[k] : product(this.products[k - this.count])));
        this.uniforms.exaggeration.value = exaggeration;
    }
}
