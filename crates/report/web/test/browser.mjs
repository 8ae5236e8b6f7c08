// A headless Chromium with a report in it, and the pixels of its picture.

import { chromium } from "playwright-core";
import { pathToFileURL } from "node:url";
import { join } from "node:path";
import assert from "node:assert/strict";

// WebGL in software, and no connection of the browser's own.
const ARGUMENTS = [
    "--no-sandbox", "--no-first-run", "--disable-quic", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];

export function launch() {
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ARGUMENTS });
}

/// Opens a report; at the end of the test there must be no error, and nothing loaded.
export async function open(t, browser, kind, options = {}) {
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, ...options });
    const said = [];
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && said.push(message.text()));
    page.on("pageerror", (error) => said.push(error.message));
    const url = pathToFileURL(join(process.env.REPORTS, `${kind}.html`)).href;
    page.on("request", (request) => request.url() !== url && !request.url().startsWith("data:") && said.push(request.url()));
    t.after(async () => {
        await page.close();
        // ANGLE says that reading pixels, which only the test does, is slow.
        assert.deepEqual(said.filter((text) => !text.includes("GPU stall due to ReadPixels")), []);
    });
    await page.goto(url);
    await page.waitForFunction(() => window.reportPage ?? window.responsesPage);
    await frame(page);
    return page;
}

/// Waits until a frame has been drawn after what was done before.
export function frame(page) {
    return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));
}

/// The pixels of the picture at a time of the run: how many are covered, a sum that tells pictures apart, the middle one, and
/// the part of the picture that is coloured, by the body, with its middle (-1 to 1 across and up).
export function pixels(page, time) {
    return page.evaluate((time) => new Promise((done) => {
        if (time !== null) window.reportPage.clock.seek(time);
        else window.reportPage.viewer.recolour(); // draws it again
        // In the same frame, after the page has drawn: later the buffer is empty.
        requestAnimationFrame(() => {
            const gl = document.getElementById("canvas").getContext("webgl2");
            const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
            const bytes = new Uint8Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
            let covered = 0;
            let sum = 0;
            let [coloured, across, up] = [0, 0, 0];
            for (let i = 0; i < bytes.length; i += 4) {
                if (bytes[i + 3] > 0) covered++;
                if (Math.max(bytes[i], bytes[i + 1], bytes[i + 2]) - Math.min(bytes[i], bytes[i + 1], bytes[i + 2]) > 40) {
                    coloured++;
                    across += ((i / 4) % width) / width;
                    up += Math.floor(i / 4 / width) / height;
                }
                sum = (31 * sum + bytes[i] + 256 * bytes[i + 1] + 65536 * bytes[i + 2]) % 1000003;
            }
            const middle = 4 * (Math.floor(height / 2) * width + Math.floor(width / 2) + 8);
            done({
                part: covered / (width * height), sum, middle: [...bytes.slice(middle, middle + 3)],
                body: { part: coloured / (width * height), middle: [across, up].map((x) => (2 * x) / coloured - 1) },
            });
        });
    }), time ?? null);
}
