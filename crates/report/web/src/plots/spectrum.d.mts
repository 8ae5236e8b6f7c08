export interface Spectrum { frequencies: Float64Array; amplitudes: Float64Array; resolution: number }
export function evenly(times: ArrayLike<number>, values: ArrayLike<number>): Float64Array;
export function spectrum(times: ArrayLike<number>, values: ArrayLike<number>): Spectrum;
export function peaks(spectrum: Spectrum): { frequency: number; amplitude: number }[];
