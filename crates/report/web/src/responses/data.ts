// Data of the page; `src/responses.rs` of the crate writes the same fields.

import { double, readData, single, type Numbers } from "../data";

/// A chart: one of the values of each curve over the frequency.
export interface Chart { name: string; logarithmic: boolean }
/// A curve: its values in each chart with their units, and numbers about the whole of it, one under each heading.
export interface Curve { name: string; units: string[]; values: Numbers[]; about: string[] }
interface Data {
    program: string; title: string; facts: [string, string][]; warnings: string[]; frequency_unit: string; logarithmic: boolean;
    frequencies: Numbers; charts: Chart[]; headings: string[]; curves: Curve[]; left_out: string | null;
}
export interface Responses extends Data { at: Float64Array; of: Float32Array[][] }

/// The data, with the values `of` each curve in each chart `at` the frequencies.
export async function readResponses(): Promise<Responses> {
    const data = await readData<Data>();
    const of = data.curves.map((curve) => curve.values.map((values) => single(values)));
    return { ...data, at: double(data.frequencies), of };
}
