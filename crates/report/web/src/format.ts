// Numbers and their units for people.

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/// A number to `digits` significant digits; a power of ten where the number is very small or large.
export function number(value: number, digits = 4): string {
    if (value === 0) return "0";
    const magnitude = Math.abs(value);
    if (magnitude >= 1e-3 && magnitude < 1e6) {
        const text = magnitude >= 10 ** digits ? value.toFixed(0) : value.toPrecision(digits);
        return minus(text.includes(".") ? text.replace(/\.?0+$/, "") : text);
    }
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const power = [...exponent.replace("+", "")].map((c) => (c === "-" ? "⁻" : SUPERSCRIPTS[Number(c)])).join("");
    const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return minus(short === "1" ? `10${power}` : `${short}×10${power}`);
}

export function minus(text: string): string {
    return text.replace("-", "−");
}

export function withUnit(text: string, unit: string): string {
    return unit === "" || unit === "1" ? text : `${text} ${unit}`;
}

/// 1, 2 or 5 times a power of ten, at or above the value.
export function roundStep(value: number): number {
    const power = 10 ** Math.floor(Math.log10(value));
    return power * ([1, 2, 5, 10].find((step) => step * power >= value * (1 - 1e-9)) ?? 10);
}

/// A decimal count that lets times of so long a run be told apart.
export function timeDecimals(duration: number): number {
    return Math.min(9, Math.max(0, 4 - Math.floor(Math.log10(duration || 1))));
}
