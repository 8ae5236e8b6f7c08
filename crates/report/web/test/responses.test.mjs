// The page of answers over the frequency in a real browser: two oscillators at 10 and 100 Hz of examples/synthetic.rs.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { frame, launch, open } from "./browser.mjs";

let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

const cells = (page, row) => page.locator("#table tbody tr").nth(row).locator("td").allTextContents();
const place = (page) => page.textContent("#place");
const range = (page) => page.evaluate(() => window.responsesPage.charts.map(({ chart }) => [chart.scales.x.min, chart.scales.x.max]));

async function hover(page, frequency) {
    const at = await page.evaluate((frequency) => {
        const { chart } = window.responsesPage.charts[0];
        const box = chart.over.getBoundingClientRect();
        return [box.left + chart.valToPos(frequency, "x") + 0.6, box.top + box.height / 2];
    }, frequency);
    await page.mouse.move(...at);
    await frame(page);
}

test("values under the pointer are those of the curves, also of those that are not shown", async (t) => {
    const page = await open(t, browser, "responses");
    assert.equal(await page.textContent("#title"), "Two oscillators: frequency response");
    assert.equal(await page.textContent("#warnings"), "a warning");
    await hover(page, 20);
    assert.equal(await place(page), "At 20 Hz");
    // Closed form: 1/|10² − 20² + i 0.04 10 20|, and the phase of its like.
    const slow = await cells(page, 0);
    assert.equal(slow[1], (1 / Math.hypot(300, 8)).toPrecision(5).replace(/0+$/, ""));
    assert.equal(slow[2], `−${((Math.atan2(8, -300) * 180) / Math.PI).toPrecision(5)}`);
    assert.deepEqual(slow.slice(3), ["mm per N", "at 10 Hz"]);
    assert.ok((await cells(page, 1))[1].startsWith("1.04"));
    assert.equal((await cells(page, 2))[0], "nothing / </script><b>push");
});

test("curves come and go, keys step, and both charts show the same range", async (t) => {
    const page = await open(t, browser, "responses");
    const checked = () => page.locator("#table input").evaluateAll((boxes) => boxes.map((box) => box.checked));
    assert.deepEqual(await checked(), [true, false, true], "those of the first unit are shown");
    await page.locator("#table input").nth(1).check();
    await page.locator("#table input").nth(0).uncheck();
    assert.deepEqual(await checked(), [false, true, true]);
    await page.click("#none");
    assert.deepEqual(await checked(), [false, false, false]);
    await page.click("#some");
    await page.keyboard.press("End");
    assert.equal(await place(page), "At 499 Hz");
    await page.keyboard.press("ArrowLeft");
    assert.equal(await place(page), "At 498 Hz");
    await page.evaluate(() => window.responsesPage.charts[0].chart.setScale("x", { min: 50, max: 150 }));
    await frame(page);
    assert.deepEqual(await range(page), [[50, 150], [50, 150]]);
    await page.check("#logarithmic");
    await page.click("#all");
    await frame(page);
    for (const [min, max] of await range(page)) assert.ok(min > 0 && max >= 499, `${min} ${max}`);
    await page.fill("#filter", "fast");
    assert.equal(await page.locator("#table tbody tr:visible").count(), 1);
});
