// Live pages in a real browser. REPORTS names the folder of the pages; pictures of them are left there.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { frame, launch, open as openPage, pixels } from "./browser.mjs";

let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

async function open(t, scene, options) {
    const page = await openPage(t, browser, scene, options);
    await page.waitForFunction(() => window.reportPage.live);
    return page;
}

const picture = (page, name) => page.screenshot({ path: join(process.env.REPORTS, `${name}.png`) });
const time = (page) => page.evaluate(() => window.reportPage.live.time);
const state = (page) => page.textContent("#live-state");
const speed = (page, value) => page.evaluate((value) => (window.reportPage.clock.speed = value), value);

/// Where a body's origin is on the screen.
function middleOf(page, body) {
    return page.evaluate((body) => {
        const { stage } = window.reportPage.viewer;
        const { left, top, width, height } = stage.canvas.getBoundingClientRect();
        const { x, y } = stage.bodies[body].center.clone().project(stage.camera);
        return [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
    }, body);
}

test("it plays, pauses, steps, and is the recorded run, with its ghost upon it", async (t) => {
    const page = await open(t, "chain");
    assert.match(await state(page), /Nothing is changed/);
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 0.1);
    await page.keyboard.press("Space");
    await frame(page);
    const stands = await time(page);
    await frame(page);
    assert.equal(await time(page), stands, "a paused run stands still");
    await page.keyboard.press("ArrowRight");
    assert.ok((await time(page)) > stands, "a step goes on");
    await page.click("#step");
    // Systems are seen at rows; within one the recorded run is where the live one is.
    const apart = await page.evaluate(() => {
        const { live, viewer } = window.reportPage;
        viewer.motion.at(live.time);
        return Math.max(...live.placed.map(({ origin }, i) => Math.hypot(...origin.map((x, k) => x - viewer.motion.bodies[i].origin[k]))));
    });
    assert.ok(apart < 10, `${apart} mm from the recorded run, which is seen between its rows`);
    assert.ok(await page.evaluate(() => window.reportPage.viewer.stage.bodies.every(({ body }) => body.ghost.visible)));
    await picture(page, "chain-recorded");
    assert.match(await state(page), /Nothing is changed/);
    await page.keyboard.press("Home");
    assert.equal(await time(page), 0);
});

test("a body is pulled with the pointer: force and arrow are seen, it follows, and lets go", async (t) => {
    const page = await open(t, "chain");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 0.05);
    await page.keyboard.press("Space");
    await frame(page);
    const [x, y] = await middleOf(page, 2);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y - 90, { steps: 5 });
    assert.ok(await page.isVisible("#force"), "the body was met");
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 0.12);
    assert.match(await page.textContent("#force"), /\d/);
    assert.match(await state(page), /Changed/);
    await picture(page, "chain-pulled");
    const [nowX, nowY] = await middleOf(page, 2);
    const pulled = await page.evaluate(() => Math.hypot(...window.reportPage.live.program.pulled.force));
    assert.ok(pulled > 0, `${pulled}`);
    await page.mouse.up();
    await frame(page);
    assert.ok(!(await page.isVisible("#force")));
    assert.ok(Math.hypot(nowX - x, nowY - y) > 5, "it has moved");
    await page.keyboard.press("Space");
    const numbers = await page.textContent("#live-numbers");
    assert.match(numbers, /energy out of balance/);
    // Beside the body the pointer turns the view.
    const before = await page.evaluate(() => window.reportPage.viewer.stage.camera.position.toArray());
    const box = await page.locator("#canvas").boundingBox();
    await page.mouse.move(box.x + 15, box.y + 15);
    await page.mouse.down();
    await page.mouse.move(box.x + 80, box.y + 60, { steps: 4 });
    await page.mouse.up();
    assert.notDeepEqual(await page.evaluate(() => window.reportPage.viewer.stage.camera.position.toArray()), before);
});

test("sliders change the run by keyboard and pointer; what is refused is told; start again puts all back", async (t) => {
    const page = await open(t, "chain");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 0.03);
    const slider = page.locator(".slider", { hasText: "stiffness" }).first().locator("input");
    await slider.focus();
    await page.keyboard.press("End");
    await page.waitForFunction(() => !window.reportPage.live.program.isRecorded);
    assert.equal(await page.locator(".slider", { hasText: "stiffness" }).first().locator("output").textContent(), "3 ×");
    const spin = page.locator(".slider", { hasText: "spin" }).first().locator("input");
    await spin.fill(await spin.getAttribute("max"));
    const reached = await time(page);
    await page.waitForFunction((reached) => window.reportPage.live.time > reached + 0.03, reached);
    await picture(page, "chain-changed");
    await page.click("#restart");
    assert.equal(await page.locator(".slider", { hasText: "stiffness" }).first().locator("output").textContent(), "1 ×");
    assert.ok(await page.evaluate(() => window.reportPage.live.program.isRecorded));
    await page.evaluate(() => window.reportPage.live.set([3, 0, 99], 2));
    assert.match(await state(page), /no such joint/);
});

test("it goes on beyond the end of the recorded run, and the recorded run is one switch away", async (t) => {
    const page = await open(t, "thrown_plate");
    // The film of all its steps takes as long as the machine does: they are computed at once.
    await page.evaluate(() => window.reportPage.live.program.leadTo(0.999));
    await speed(page, 0.1);
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 1.001, null, { timeout: 60000 });
    await page.keyboard.press("Space");
    await frame(page);
    assert.ok((await pixels(page)).body.part > 0.002, "the body is still in the picture");
    assert.match(await state(page), /recorded run is over/);
    await picture(page, "thrown-beyond");
    await page.keyboard.press("l");
    assert.ok(await page.evaluate(() => window.reportPage.clock.time <= 1));
    assert.match(await state(page), /recorded run is shown/);
    await page.keyboard.press("Home");
    assert.equal(await page.evaluate(() => window.reportPage.clock.time), 0);
    await page.keyboard.press("l");
    assert.ok((await page.evaluate(() => window.reportPage.clock.time)) > 1.001);
});

test("stress is live: colours and the greatest stress are those of the computed motion", async (t) => {
    const page = await open(t, "bent_rod");
    if (await page.locator('#colour option[value="stress"]').count()) await page.selectOption("#colour", "stress");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.time > 0.15, null, { timeout: 60000 });
    await page.waitForFunction(() => /greatest von Mises stress[^0-9]*[1-9]/.test(document.getElementById("live-numbers").textContent));
    await page.keyboard.press("Space");
    await picture(page, "rod-stress");
});

test("on a phone a finger pulls", async (t) => {
    const options = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
    const page = await open(t, "chain", options);
    const client = await page.context().newCDPSession(page);
    const touch = (type, points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
    await page.locator("#canvas").scrollIntoViewIfNeeded();
    await frame(page);
    const [x, y] = await middleOf(page, 1);
    await touch("touchStart", [[x, y]]);
    await touch("touchMove", [[x + 20, y + 40]]);
    await frame(page);
    assert.ok(await page.isVisible("#force"));
    await page.evaluate(() => window.reportPage.live.step());
    await picture(page, "phone-pulled");
    await touch("touchEnd", []);
    await frame(page);
    assert.ok(!(await page.isVisible("#force")));
    await page.locator("#live").scrollIntoViewIfNeeded();
    await picture(page, "phone-controls");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
    assert.ok(!wide, "nothing sticks out");
});

test("the work of a frame is recorded", async (t) => {
    const page = await open(t, "chain");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.reportPage.live.work.length > 60, null, { timeout: 60000 });
    const [motion, all] = await page.evaluate(() => [window.reportPage.live.work, window.reportPage.viewer.work].map((list) => [...list].sort((a, b) => a - b)));
    const at = (list, part) => list[Math.floor(part * (list.length - 1))].toFixed(2);
    t.diagnostic(`motion: median ${at(motion, 0.5)} ms, 95 % ${at(motion, 0.95)} ms; with the picture: median ${at(all, 0.5)} ms`);
    assert.ok(motion.length > 60);
});
