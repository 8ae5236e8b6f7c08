// The page in a real browser. REPORTS names the folder of the pages that examples/synthetic.rs has made.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { SCALE } from "../src/picture/scale.mjs";
import { frame, launch, open, pixels } from "./browser.mjs";

let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

const time = (page) => page.evaluate(() => window.reportPage.clock.time);
const mark = (page) => page.locator("#panel-0 .now").first().evaluate((line) => new DOMMatrix(getComputedStyle(line).transform).e);

test("the picture is not blank, and play moves the body, the slider and the mark in the plots", async (t) => {
    const page = await open(t, browser, "small");
    const [first, later] = [await pixels(page, 0), await pixels(page, 0.06)];
    assert.ok(first.part > 0.02 && first.part < 0.9, `${first.part} of the picture is covered`);
    assert.notEqual(first.sum, later.sum, "the body is drawn elsewhere at another time");
    await page.evaluate(() => window.reportPage.clock.seek(0));
    const [before, start] = [await mark(page), await pixels(page)];
    await page.click("#play");
    await page.waitForFunction(() => window.reportPage.clock.time > 0.01);
    assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
    await page.click("#play");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
    assert.ok((await mark(page)) > before);
    assert.ok(Number(await page.inputValue("#time")) > 0.01);
    const stopped = await time(page);
    await frame(page);
    assert.equal(await time(page), stopped, "a paused run stands still");
    assert.notEqual((await pixels(page, stopped)).sum, start.sum);
});

test("the run is complete, and the page ends it at the last row", async (t) => {
    const page = await open(t, browser, "small");
    assert.equal(await page.textContent("#state"), "Complete run");
    await page.evaluate(() => window.reportPage.clock.seek(0.499));
    await page.click("#play");
    await page.waitForFunction(() => !window.reportPage.clock.playing);
    assert.equal(await time(page), 0.5);
});

test("the keyboard plays, steps, and changes speed and exaggeration", async (t) => {
    const page = await open(t, browser, "small");
    const press = async (...keys) => { for (const key of keys) await page.keyboard.press(key); };
    await press("End");
    assert.equal(await time(page), 0.5);
    await press("Home");
    assert.equal(await time(page), 0);
    await press("ArrowRight", "ArrowRight", "ArrowLeft");
    assert.ok(Math.abs((await time(page)) - 1e-4) < 1e-9, "one row on");
    await press("Shift+ArrowRight");
    assert.ok(Math.abs((await time(page)) - 0.0251) < 1e-9, "a twentieth of the run");
    await press("+");
    assert.equal(await page.textContent("#speed"), "0.1 s per second");
    await press("-", "-");
    assert.equal(await page.textContent("#speed"), "0.02 s per second");
    await press("]", "]");
    assert.equal(await page.textContent("#exaggeration"), "5 ×");
    await press("[", "[", "[");
    assert.equal(await page.textContent("#exaggeration"), "none");
    await press("]");
    assert.equal(await page.textContent("#exaggeration"), "true");
    await press("Space");
    assert.ok(await page.evaluate(() => window.reportPage.clock.playing));
    await press("Space");
    assert.ok(!(await page.evaluate(() => window.reportPage.clock.playing)));
    const here = await time(page);
    await page.focus("#tab-0");
    await press("ArrowRight");
    assert.equal(await page.getAttribute("#tab-1", "aria-selected"), "true");
    assert.equal(await time(page), here, "arrows on the tabs do not move the time");
});

test("a click in a plot sets the time, a drag zooms all plots, a double click shows the whole run again", async (t) => {
    const page = await open(t, browser, "small");
    await page.selectOption("#panel-0 select", "point P3");
    const plots = page.locator("#panel-0 .u-over");
    assert.equal(await plots.count(), 4);
    const box = await plots.first().boundingBox();
    const y = box.y + box.height / 2;
    await page.mouse.click(box.x + box.width / 2, y);
    assert.ok(Math.abs((await time(page)) - 0.25) < 0.002, String(await time(page)));
    const marks = () => page.locator("#panel-0 .now").evaluateAll((lines) =>
        lines.map((line) => Math.round(new DOMMatrix(getComputedStyle(line).transform).e)));
    const middle = await marks();
    assert.ok(middle.every((x) => Math.abs(x - box.width / 2) <= 2), `${middle}`);
    await page.mouse.move(box.x + box.width * 0.45, y);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.85, y, { steps: 4 });
    await page.mouse.up();
    await frame(page);
    const zoomed = await marks();
    assert.ok(zoomed.every((x) => Math.abs(x - box.width / 8) <= 4), `${zoomed} of ${box.width}`);
    assert.ok(Math.abs((await time(page)) - 0.25) < 0.002, "a drag does not set the time");
    await page.mouse.dblclick(box.x + 40, y);
    await frame(page);
    await page.mouse.click(box.x + box.width / 2, y);
    assert.ok(Math.abs((await time(page)) - 0.25) < 0.002, "all is shown again");
});

/// Colour of a level between 0 and 1, up to its brightness, which the light changes.
function colour(level) {
    const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    const x = level * (SCALE.length - 1);
    const below = Math.min(Math.floor(x), SCALE.length - 2);
    return direction(rgb(SCALE[below]).map((c, i) => c + (x - below) * (rgb(SCALE[below + 1])[i] - c)));
}

function direction(rgb) {
    const norm = Math.hypot(...rgb);
    return rgb.map((c) => c / norm);
}

test("the colours are those of the displacement and of the von Mises stress", async (t) => {
    const page = await open(t, browser, "patch");
    await page.uncheck("#path");
    // Rows: 2 × tension, 1.5 × shear, -tension + 2 × shear; and the product of both, a shear of 25 in another direction.
    const displacements = [10, 3, Math.hypot(-3, -4, 4)];
    const stresses = [200, Math.sqrt(3) * 45, Math.sqrt(100 ** 2 + 3 * (60 ** 2 + 50 ** 2))];
    for (const [field, values] of [["displacement", displacements], ["stress", stresses]]) {
        await page.selectOption("#colour", field);
        for (const [row, value] of values.entries()) {
            const { middle } = await pixels(page, 0.25 * row);
            const [found, expected] = [direction(middle), colour(value / Math.max(...values))];
            const distance = Math.hypot(...found.map((c, i) => c - expected[i]));
            assert.ok(distance < 0.02, `${field} in row ${row}: ${middle}, ${found} for ${expected}`);
        }
    }
});

test("the undeformed outline, the body axes and the fixed camera change the picture", async (t) => {
    const page = await open(t, browser, "small");
    let last = (await pixels(page, 0.02)).sum;
    for (const id of ["#outline", "#axes", "#path", "#follow"]) {
        await page.click(id);
        const { sum } = await pixels(page, 0.02);
        assert.notEqual(sum, last, id);
        last = sum;
    }
});

test("a shape can be shown alone, with its frequency, and static shapes are named as such", async (t) => {
    const page = await open(t, browser, "small");
    await page.click("#tab-2");
    const last = await page.locator("#panel-2 tbody tr").last().locator("td").allTextContents();
    assert.deepEqual(last.slice(0, 4), ["static shape of load 1", "static shape", "–", "–"]);
    await page.click("[aria-label='Show mode 3 alone']");
    assert.equal(await page.textContent("#caption"), "mode 3: 48 Hz");
    assert.equal(await page.textContent("#legend-ticks > :last-child"), "0");
    const seen = new Set();
    for (let i = 0; i < 4; i++) {
        seen.add((await pixels(page)).sum);
        await page.waitForTimeout(150);
    }
    assert.ok(seen.size > 1, "the shape swings");
    await page.selectOption("#subject", "run");
    assert.equal(await page.textContent("#caption"), "");
});

test("an unfinished run says so in words, and texts are shown as texts", async (t) => {
    const page = await open(t, browser, "unfinished");
    assert.equal(await page.textContent("#state"), "Unfinished run");
    assert.match(await page.textContent("#warnings"), /stopped at 0.5 s of 0.8 s.*<\/script><b>or a tolerance<\/b>/);
    await page.click("#tab-4");
    assert.match(await page.textContent("#panel-4 pre"), /flexible = 10 # <all>/);
});

test("the camera follows a body that turns about its end", async (t) => {
    const page = await open(t, browser, "hinged");
    for (const moment of [0, 0.1, 0.2, 0.3, 0.4, 0.5]) {
        const { body } = await pixels(page, moment);
        assert.ok(body.part > 0.003, `${body.part} of the picture at ${moment}`);
        assert.ok(Math.max(...body.middle.map(Math.abs)) < 0.3, `the body is at ${body.middle} at ${moment}`);
    }
});

test("a body of which only nodes are known is drawn by them, and the page says so", async (t) => {
    const page = await open(t, browser, "nodes");
    const [first, later] = [await pixels(page, 0.02), await pixels(page, 0.06)];
    assert.ok(first.body.part > 0.005, `${first.body.part}`);
    assert.notEqual(first.sum, later.sum);
    assert.match(await page.textContent("#no-surface"), /nodes are shown/);
    assert.ok(await page.isVisible("#colour"));
    assert.ok(!(await page.isVisible("#outline")));
    await page.selectOption("#subject", "0 0");
    assert.ok((await pixels(page)).body.part > 0.005, "a shape alone");
});

test("several bodies are drawn together, named, and followed one at a time", async (t) => {
    const page = await open(t, browser, "several");
    assert.deepEqual(await page.locator("#names > *").allTextContents(), ["plate", "left arm", "hub"]);
    assert.match(await page.textContent("#no-surface"), /shown by their axes: hub\./);
    const all = await pixels(page, 0.02);
    assert.ok(all.body.part > 0.005, `${all.body.part} of the picture`);
    // Nearer, and in the middle.
    await page.selectOption("#followed", "1");
    const arm = await pixels(page, 0.02);
    assert.notEqual(arm.sum, all.sum);
    assert.ok(arm.body.part > all.body.part, `${arm.body.part} of the picture, and ${all.body.part} with all bodies`);
    assert.ok(await page.isChecked("#follow"));
    const shapes = await page.locator("#subject option").allTextContents();
    assert.ok(shapes.some((text) => text.startsWith("left arm, mode 1")), shapes.join());
    await page.selectOption("#subject", "1 0");
    assert.match(await page.textContent("#caption"), /^left arm, mode 1: /);
    const tabs = await page.locator("#tabs > *").allTextContents();
    const bodies = tabs.indexOf("Bodies");
    assert.ok(bodies >= 0, tabs.join());
    await page.click(`#tab-${bodies}`);
    for (const name of ["plate", "left arm", "hub"]) assert.match(await page.textContent(`#panel-${bodies}`), new RegExp(name));
});

/// Pixels of a plot that are coloured: how many, and from which to which part of its height.
const curve = (plot) => plot.locator("canvas").evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const rows = [];
    for (let i = 0; i < data.length; i += 4) {
        const rgb = [data[i], data[i + 1], data[i + 2]];
        if (data[i + 3] > 100 && Math.max(...rgb) - Math.min(...rgb) > 60) rows.push(Math.floor(i / 4 / canvas.width) / canvas.height);
    }
    return { count: rows.length, least: Math.min(...rows), greatest: Math.max(...rows) };
});

test("rounding does not fill the axis of a plot, an error does", async (t) => {
    const page = await open(t, browser, "small");
    await page.click("#tab-1");
    await frame(page);
    const [, energy, , momentum] = await page.locator("#panel-1 .plot").all();
    const [error, rounding] = [await curve(energy), await curve(momentum)];
    assert.ok(error.greatest - error.least > 0.5, JSON.stringify(error));
    assert.ok(rounding.count > 100 && rounding.greatest - rounding.least < 0.05, JSON.stringify(rounding));
});

test("paper shows the picture, all parts and whole plots, in light colours", async (t) => {
    const page = await open(t, browser, "small", { colorScheme: "dark" });
    await pixels(page, 0.06);
    await page.setViewportSize({ width: 690, height: 980 }); // A4 between its margins
    await page.emulateMedia({ media: "print" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    await frame(page);
    const printed = await page.locator("#printed-picture").evaluate((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let coloured = 0;
        for (let i = 0; i < data.length; i += 4)
            if (Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 40) coloured++;
        return coloured / (canvas.width * canvas.height);
    });
    assert.ok(printed > 0.01, `${printed} of the printed picture is the body`);
    assert.ok(await page.isVisible("#printed-picture"));
    assert.ok(!(await page.isVisible("#canvas")));
    for (const tab of [0, 1, 2, 3, 4]) assert.ok(await page.isVisible(`#panel-${tab}`), `part ${tab}`);
    for (const plot of await page.locator(".plot canvas").all()) {
        const { x, width } = await plot.boundingBox();
        assert.ok(width > 500 && x >= 0 && x + width <= 690, `${x} ${width}`);
        assert.ok((await curve(plot.locator(".."))).count > 0);
    }
    const ground = await page.evaluate(() => getComputedStyle(document.querySelector(".stage")).backgroundColor.match(/\d+/g).map(Number));
    assert.ok(Math.min(...ground) > 200, `${ground}`);
    await page.emulateMedia({ media: "screen" });
    await page.setViewportSize({ width: 1440, height: 900 });
    await page.evaluate(() => dispatchEvent(new Event("afterprint")));
    await frame(page);
    assert.ok(!(await page.isVisible("#panel-1")));
    const plot = await page.locator("#panel-0 .plot canvas").first().boundingBox();
    const panel = await page.locator("#panel-0").boundingBox();
    assert.ok(Math.abs(plot.width - panel.width) < 2, `${plot.width} in ${panel.width}`);
});

test("a rigid body without a surface is drawn by its axes", async (t) => {
    const page = await open(t, browser, "rigid");
    const [first, later] = [await pixels(page, 0), await pixels(page, 0.25)];
    assert.ok(first.part > 0.002);
    assert.notEqual(first.sum, later.sum);
    assert.ok(!(await page.isVisible("#colour")));
});

test("on a phone nothing is wider than the screen, and a tap plays", async (t) => {
    const options = { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true, deviceScaleFactor: 2 };
    const page = await open(t, browser, "small", options);
    for (const tab of [0, 1, 2, 3, 4]) {
        await page.tap(`#tab-${tab}`);
        const width = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(width <= 390, `tab ${tab} is ${width} wide`);
    }
    assert.ok((await pixels(page, 0.1)).part > 0.02);
    await page.tap("#play");
    await page.waitForFunction(() => window.reportPage.clock.time > 0.101);
});

test("the page follows the dark scheme of the system", async (t) => {
    const page = await open(t, browser, "small", { colorScheme: "dark" });
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
    assert.ok(Math.max(...(await ground())) < 60);
    await page.emulateMedia({ colorScheme: "light" });
    assert.ok(Math.min(...(await ground())) > 200);
});

/// The bytes that a click lets the browser save, and their name.
async function saved(page, locator) {
    const [download] = await Promise.all([page.waitForEvent("download"), locator.click()]);
    return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

/// Width, height, and the colours of some places of a PNG, as the browser reads it.
const colours = (page, bytes, places) => page.evaluate(async ([base64, places]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    const at = ([x, y]) => [...context.getImageData(Math.round(x * image.width), Math.round(y * image.height), 1, 1).data];
    return { size: [image.width, image.height], colours: places.map(at) };
}, [bytes.toString("base64"), places]);

test("the picture is saved as it is seen, with its background and its legend", async (t) => {
    const page = await open(t, browser, "small");
    await page.evaluate(() => window.reportPage.clock.seek(0.02));
    const { name, bytes } = await saved(page, page.locator("#save-picture"));
    assert.equal(name, "Free_plate_50_N_end_pulse.at_0.02000_s.png");
    const place = await page.evaluate(() => {
        const [stage, bar] = [document.querySelector(".stage"), document.getElementById("legend-bar")].map((part) => part.getBoundingClientRect());
        const x = (bar.left + bar.width / 2 - stage.left) / stage.width;
        return { stage: [stage.width, stage.height], bar: [0.02, 0.98].map((part) => [x, (bar.top + part * bar.height - stage.top) / stage.height]) };
    });
    const { size, colours: [top, bottom, corner] } = await colours(page, bytes, [...place.bar, [0.01, 0.01]]);
    assert.deepEqual(size, place.stage.map((length) => 2 * Math.round(length)));
    const near = (found, level) => Math.hypot(...direction(found.slice(0, 3)).map((c, i) => c - colour(level)[i])) < 0.05;
    assert.ok(near(top, 0.98) && near(bottom, 0.02), `${top} ${bottom}`);
    const sky = await page.evaluate(() => getComputedStyle(document.querySelector(".stage")).backgroundColor.match(/\d+/g).map(Number));
    assert.deepEqual(corner, [...sky, 255], "the colour of the page behind the bodies");
});

test("standard views look along the axes", async (t) => {
    const page = await open(t, browser, "small");
    const seen = () => page.evaluate(() => [...document.querySelectorAll("#triad line")].map((line) =>
        ["x2", "y2"].map((name) => Math.round(Number(line.getAttribute(name))) + 0)));
    for (const [name, axes] of [
        ["xy, from z", [[26, 0], [0, -26], [0, 0]]], ["xz, from −y", [[26, 0], [0, 0], [0, -26]]],
        ["yz, from x", [[0, 0], [26, 0], [0, -26]]], ["from −z", [[26, 0], [0, 26], [0, 0]]],
    ]) {
        await page.selectOption("#view", name);
        await frame(page);
        assert.deepEqual(await seen(), axes, name);
    }
});

test("the spectrum shows the frequency of a mode, and follows the range that is shown", async (t) => {
    const page = await open(t, browser, "compared");
    await page.selectOption("#panel-0 select", "point P2");
    const button = page.locator("#panel-0 .plot-tools button", { hasText: "Spectrum" }).first();
    await button.click();
    const line = await page.locator(".peaks span").nth(2).textContent();
    // Closed form: a decaying vibration of 12 Hz; the window spreads it over 4 Hz.
    const [, frequency] = line.match(/^z: ([\d.]+) Hz/);
    assert.ok(Math.abs(frequency - 12) < 1, line);
    assert.match(await page.locator(".spectrum").textContent(), /501 rows from 0 to 0.5 s.*Hz; Hann window/);
    await button.click();
    assert.equal(await page.locator(".spectrum").count(), 0);
    // Of a long run not every row is in the page.
    const long = await open(t, browser, "small");
    await long.locator("#panel-0 .plot-tools button", { hasText: "Spectrum" }).first().click();
    assert.match(await long.locator(".spectrum").textContent(), /No spectrum: .*not every row/);
});

test("a plot is saved as a table and as a picture", async (t) => {
    const page = await open(t, browser, "compared");
    const { bytes: csv } = await saved(page, page.locator("#panel-0 .plot-tools button", { hasText: "CSV" }).first());
    const lines = csv.toString().trimEnd().split("\n");
    assert.equal(lines.length, 502);
    assert.match(lines[0], /^"time, s","position of the centre of mass \(global\) x, mm",/);
    // Closed form: the last row of the motion, x = 400 t, and half of it in the other run.
    const row = lines[501].split(",").map(Number);
    assert.deepEqual([row[0], row[1], row[4]], [0.5, 200, 100]);
    const { bytes } = await saved(page, page.locator("#panel-0 .plot-tools button", { hasText: "PNG" }).first());
    assert.equal(bytes.toString("latin1", 1, 4), "PNG");
    // Of a long run the table says that it has not got every row.
    const long = await open(t, browser, "small");
    const { bytes: thinned } = await saved(long, long.locator("#panel-0 .plot-tools button", { hasText: "CSV" }).first());
    assert.match(thinned.toString().split("\n")[0], /^# least and greatest values of ranges of rows/);
});

test("the trust card stands above the body, its worst line first", async (t) => {
    const page = await open(t, browser, "small");
    const lines = await page.locator("#trust li").evaluateAll((all) => all.map((line) => [line.className, line.textContent]));
    assert.deepEqual(lines.map(([kind]) => kind), ["noted", "unknown", "small", "small"]);
    assert.match(lines[0][1], /^modes.*3.10 %.*to do: static shapes$/);
    assert.match(lines[1][1], /^model.*not known.*flexframe check plate.h5$/);
    const below = await page.evaluate(() => ["trust", "viewer"].map((id) => document.getElementById(id).getBoundingClientRect().top));
    assert.ok(below[0] < below[1]);
});

test("another run is there as a ghost, with its courses", async (t) => {
    const page = await open(t, browser, "compared");
    const names = await page.locator("#panel-0 .plot-name").allTextContents();
    assert.ok(names.some((name) => name.endsWith(": difference, mm")), `${names}`);
    const with_ghost = await pixels(page, 0.02);
    await page.uncheck("#compared");
    const without = await pixels(page, 0.02);
    assert.ok(without.part < with_ghost.part && without.sum !== with_ghost.sum);
    await page.check("#compared");
    assert.equal((await pixels(page, 0.02)).sum, with_ghost.sum);
    await page.selectOption("#subject", "0 0");
    await page.click("#play"); // it swings
    const alone = await pixels(page, 0.02);
    await page.uncheck("#compared");
    assert.equal((await pixels(page, 0.03)).part, alone.part, "not beside a shape");
});

test("work for each frame of 60 000 vertices and 40 modes", async (t) => {
    const page = await open(t, browser, "large");
    const started = Date.now();
    for (let i = 0; i < 8; i++) await pixels(page, 0.05 * i);
    const passed = (Date.now() - started) / 8;
    const work = await page.evaluate(() => window.reportPage.viewer.work.slice(-8).sort((a, b) => a - b));
    t.diagnostic(`the page's program works ${work[4].toFixed(1)} ms for a frame (median; at the most ${work[7].toFixed(1)} ms)`);
    t.diagnostic(`a frame takes ${passed.toFixed(0)} ms with software in place of a graphics processor, with reading the pixels`);
});
