// The report as the page receives it; `src/data.rs` of the crate writes the same fields.

import { bytesOf, unpacked } from "./packed.mjs";

/// A list of numbers, packed as `src/numbers.rs` of the crate says; `values` is there once the report is read.
export interface Numbers { type: "f64" | "f32" | "i16" | "u16" | "u32"; factor: number; stride: number; packed: string; values?: ArrayBuffer }
export interface Component { name: string; values: Numbers }
export interface History { group: string; name: string; unit: string; least_range: number; components: Component[] }
export interface Balance {
    group: string; name: string; law: string; unit: string; least_range: number; error_peak: number; term_peak: number;
    terms: Component[]; errors: Component[];
}
export interface Shape {
    name: string; kind: "natural" | "static" | "second order";
    frequency: number | null; damping_ratio: number | null; displacement: Numbers;
}
export interface BodyData {
    name: string;
    facts: [string, string][];
    surface: { vertices: Numbers; triangles: Numbers; edges: Numbers } | null;
    shapes: Shape[];
    displacement_peak: number;
    stress: { unit: string; peak: number; shapes: Numbers[]; products: number[][] } | null;
    motion: { origins: Numbers; attitudes: Numbers; coordinates: Numbers };
    effects: [string, string, string, string][];
}
export interface Report {
    title: string; program: string; unfinished: string | null;
    units: { length: string; time: string; frequency: string };
    facts: [string, string][];
    rows: number;
    times: Numbers;
    bodies: BodyData[];
    history_times: Numbers;
    histories: History[];
    balances: Balance[];
    scene: [string, string];
    warnings: string[];
    trust: { lines: TrustLine[]; unseen: string };
    live: LiveData | null;
    compared: Compared | null;
}
/// A place where the answer may be wrong; the error is relative, and null where it is not known.
export interface TrustLine { place: string; body: string; error: number | null; meaning: string; known: string; next: string }
/// Another run, whose bodies are seen as ghosts. Its courses are among the histories.
export interface Compared { name: string; times: Numbers; bodies: BodyData[] }
/// A run that the page leads on by itself.
export interface LiveData {
    program: string; run: string; masses: number[]; controls: Control[];
    units: [force: string, energy: string, momentum: string, angularMomentum: string];
}
export interface Control {
    group: string; name: string; unit: string; change: [number, number, number];
    range: [number, number]; recorded: number;
}

const TYPES = { f64: Float64Array, f32: Float32Array, i16: Int16Array, u16: Uint16Array, u32: Uint32Array };

/// Undoes the packing: bytes of the same place beside each other, of differences to the number a stride before.
async function unpack(numbers: Numbers) {
    const planes = new Uint8Array(await unpacked(bytesOf(numbers.packed)));
    const size = TYPES[numbers.type].BYTES_PER_ELEMENT;
    const count = planes.length / size;
    const bytes = new Uint8Array(planes.length);
    for (let i = 0; i < count; i++) {
        const before = (i - numbers.stride) * size;
        let carry = 0;
        for (let byte = 0; byte < size; byte++) {
            carry += planes[byte * count + i] + (before < 0 ? 0 : bytes[before + byte]);
            bytes[i * size + byte] = carry; // the low eight bits
            carry >>= 8;
        }
    }
    numbers.values = bytes.buffer;
}

/// The numbers as they are stored, without their factor.
export function stored<T extends Numbers["type"]>(numbers: Numbers & { type: T }): InstanceType<(typeof TYPES)[T]> {
    return new TYPES[numbers.type](numbers.values!.slice(0)) as InstanceType<(typeof TYPES)[T]>;
}

export const single = (numbers: Numbers) => stored(numbers as Numbers & { type: "f32" });
export const double = (numbers: Numbers) => stored(numbers as Numbers & { type: "f64" });
export const quantised = (numbers: Numbers) => stored(numbers as Numbers & { type: "i16" });
export const indices = (numbers: Numbers) => stored(numbers as Numbers & { type: "u16" | "u32" });

/// The data of the page, with all its lists.
export async function readData<Data>(): Promise<Data> {
    const lists: Numbers[] = [];
    const data = JSON.parse(document.getElementById("data")!.textContent!, (_, value) => {
        if (typeof value?.packed === "string") lists.push(value);
        return value;
    }) as Data;
    await Promise.all(lists.map(unpack));
    return data;
}

export const readReport = () => readData<Report>();
