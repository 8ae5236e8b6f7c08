// The program of live pages in Node: the recorded run to 1e-9, and the work of a frame. REPORTS names the folder of live pages, with
// the tables of their runs beside them.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { Program } from "../src/live/program.mjs";
import { bytesOf } from "../src/packed.mjs";

const SCENES = ["bent_rod", "thrown_plate", "double_pendulum", "chain"];

function report(scene) {
    const page = readFileSync(join(process.env.REPORTS, `${scene}.html`), "utf8");
    return JSON.parse(page.split('<script type="application/json" id="data">')[1].split("</script>")[0]);
}

/// Columns of a table by the first word of their heads; of several bodies their names are in front.
function table(scene) {
    const [heads, ...rows] = readFileSync(join(process.env.REPORTS, `${scene}.csv`), "utf8").trim().split("\n");
    const names = heads.split(",").map((head) => head.replace(/ \[.*/, ""));
    const values = rows.map((row) => row.split(",").map(Number));
    return { rows: values.length, column: (name) => {
        const at = names.indexOf(name);
        assert.ok(at >= 0, `${scene} has the column ${name} among ${names.slice(0, 40)}`);
        return values.map((row) => row[at]);
    }, has: (name) => names.includes(name) };
}

const begin = ({ live }, frame) => Program.begin(bytesOf(live.program), bytesOf(live.run), frame);

/// Names of the columns of a body, and the numbers of the program that they are.
function quantities(body) {
    const vector = (name, list) => [..."xyz"].map((axis, i) => [`${name} ${axis}`, list[i]]);
    return [
        ...vector("origin", body.origin), ...[..."wxyz"].map((part, i) => [`attitude ${part}`, body.attitude[i]]),
        ...vector("angular_velocity", body.omega), ["energy/kinetic", body.kinetic], ["energy/strain", body.strain],
        ["energy/work", body.work], ...vector("momentum/angular", body.angular),
    ];
}

for (const scene of SCENES) {
    // Independent reference: the rows that the native program has written. Functions that differ in the last bit may change a length of a step of
    // bodies in joints, and then the error of their steps.
    test(`${scene}: the live run is the recorded one`, async (t) => {
        const page = report(scene);
        const { rows, column, has } = table(scene);
        const times = column("time");
        const program = await begin(page, times[1] - times[0]);
        const several = page.bodies.length > 1;
        const prefix = (name) => (several ? `bodies/${name}/` : "");
        const worst = {};
        const columns = new Map();
        const peaks = new Map();
        for (let row = 0; row < rows; row++) {
            program.leadTo(times[row]);
            page.bodies.forEach(({ name }, i) => {
                for (const [quantity, value] of quantities(program.body(i))) {
                    const full = `${prefix(name)}${quantity}`;
                    if (!columns.has(full)) {
                        columns.set(full, column(full));
                        const group = full.replace(/ [wxyz]$/, "");
                        peaks.set(group, Math.max(peaks.get(group) ?? 0, ...columns.get(full).map(Math.abs)));
                    }
                }
            });
            page.bodies.forEach(({ name }, i) => {
                for (const [quantity, value] of quantities(program.body(i))) {
                    const full = `${prefix(name)}${quantity}`;
                    const kind = quantity.replace(/ [wxyz]$/, "");
                    // Energies are compared with the greatest of the body, so that rounding of one that is next to nothing is not.
                    const group = kind.startsWith("energy") ? ["energy/kinetic", "energy/strain", "energy/work"] : [kind];
                    const peak = Math.max(1e-300, ...group.map((of) => peaks.get(`${prefix(name)}${of}`) ?? 0));
                    const error = Math.abs(value - columns.get(full)[row]) / peak;
                    worst[kind] = Math.max(worst[kind] ?? 0, error);
                }
            });
        }
        assert.ok(program.isRecorded);
        t.diagnostic(`${rows} rows, ${program.steps} steps: ${Object.entries(worst).map(([k, e]) => `${k} ${e.toExponential(1)}`).join(", ")}`);
        for (const [kind, error] of Object.entries(worst)) assert.ok(error < (several ? 1e-5 : 1e-9), `${kind}: ${error}`);
        assert.ok(rows > 30 && has("time"));
    });
}

test("a pull, a change and a spin keep the balances, and start again gives the first motion", async () => {
    const page = report("chain");
    const program = await begin(page, 2.5e-3);
    program.leadTo(0.1);
    const shapes = (i) => new Array(3 * page.bodies[i].shapes.length).fill(0).map((_, k) => Math.sin(k));
    program.pull(2, [50, 0, 0], shapes(2), [500, 0, 200], 0.01, 1e-4);
    program.leadTo(0.15);
    const { force } = program.pulled;
    assert.ok(Math.hypot(...force) > 0.1, `${force}`);
    program.letGo();
    const joint = page.live.controls.find(({ group, name }) => group === "joint knee" && name === "stiffness");
    program.change(joint.change, 3);
    program.leadTo(0.2);
    assert.ok(!program.isRecorded);
    // Conserved: energy less work, of each body.
    for (let i = 0; i < 3; i++) {
        const { energyBalance, kinetic } = program.body(i);
        assert.ok(Math.abs(energyBalance) < 1e-3 * Math.max(1, kinetic), `${i}: ${energyBalance} of ${kinetic}`);
    }
    assert.throws(() => program.change([3, 0, 99], 2), /no such joint/);
    assert.throws(() => program.change([1, 0, 0], -1), /zero or more/);
    program.restart();
    assert.equal(program.time, 0);
    assert.ok(program.isRecorded);
});

test("the work of a frame of three bodies with 60 coordinates", async (t) => {
    const page = report("chain");
    const coordinates = page.bodies.reduce((sum, { shapes }) => sum + shapes.length, 0);
    for (const [name, speed] of [["the whole run in ten seconds of film", 0.05], ["in one second", 0.5]]) {
        const frame = speed / 60;
        const program = await begin(page, frame);
        const work = [];
        for (let i = 1; program.time + frame < 0.499; i++) {
            const started = performance.now();
            program.leadTo(i * frame);
            work.push(performance.now() - started);
        }
        work.sort((a, b) => a - b);
        const at = (part) => work[Math.floor(part * (work.length - 1))].toFixed(2);
        t.diagnostic(`${coordinates} coordinates, ${name}: median ${at(0.5)} ms, 95 % ${at(0.95)} ms, most ${at(1)} ms of ${work.length} frames, ${program.steps} steps`);
        assert.ok(program.steps < 4000);
    }
});

test("a live page of three bodies is small, and so is what makes a page a live one", (t) => {
    for (const scene of SCENES) {
        const { length } = readFileSync(join(process.env.REPORTS, `${scene}.html`));
        const { program, run } = report(scene).live;
        const [all, added] = [length, program.length + run.length].map((bytes) => bytes / 1e6);
        t.diagnostic(`${scene}: ${all.toFixed(2)} MB, of which the live run is ${added.toFixed(2)} MB`);
        assert.ok(added < 1.7, `${scene}: ${added}`);
        if (scene === "chain") assert.ok(all < 4, `${scene}: ${all}`);
    }
});
