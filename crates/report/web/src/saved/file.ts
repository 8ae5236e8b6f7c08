// Files that the reader saves from the page.

/// Name of a file about something of this run.
export function fileName(part: string, ending: string): string {
    const plain = (text: string) => text.normalize("NFKD").replace(/[^\w.-]+/g, "_").replace(/^_+|_+$/g, "");
    return `${plain(document.getElementById("title")!.textContent ?? "") || "run"}.${plain(part) || "part"}.${ending}`;
}

export function saveText(name: string, type: string, text: string) {
    save(name, new Blob([text], { type }));
}

export function savePng(name: string, canvas: HTMLCanvasElement) {
    canvas.toBlob((blob) => blob && save(name, blob), "image/png");
}

function save(name: string, blob: Blob) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
