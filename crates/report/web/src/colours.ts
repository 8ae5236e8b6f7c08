// Colours of fields, and those that the style sheet names.

export function rgb(hex: string): [number, number, number] {
    const value = parseInt(hex.slice(1), 16);
    return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}

const probe = document.createElement("span");

/// A colour of the style sheet, in the light or dark scheme that is shown, as the browser computes it.
export function cssColour(name: string): string {
    probe.style.color = `var(--${name})`;
    document.body.append(probe);
    const colour = getComputedStyle(probe).color;
    probe.remove();
    return colour;
}

const dark = matchMedia("(prefers-color-scheme: dark)");
export function onSchemeChange(listener: () => void) { dark.addEventListener("change", listener); }
