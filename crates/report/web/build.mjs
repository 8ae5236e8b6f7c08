// Builds page.html, the page of a run, and responses.html, that of answers over the frequency: each markup, style and program in one file
// that needs nothing else.
//   node build.mjs [FOLDER]
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const read = (name) => readFileSync(join(here, name), "utf8");
const notices = read("NOTICES.txt").trim();

for (const [name, folder] of [["page", "src"], ["responses", "src/responses"]]) {
    const { outputFiles } = await build({
        absWorkingDir: here,
        entryPoints: [`${folder}/main.ts`],
        bundle: true,
        minify: true,
        format: "iife",
        target: "es2022",
        legalComments: "none", // the notices are in NOTICES.txt, which goes into the page
        outdir: "unused",
        write: false,
    });
    const output = (ending) => outputFiles.find(({ path }) => path.endsWith(ending)).text.trim();
    const page = read(`${folder}/page.html`)
        .replace("<!-- notices -->", () => `<!--\n${notices}\n-->`)
        .replace("/* style */", () => output(".css"))
        .replace("/* program */", () => output(".js"));
    writeFileSync(join(process.argv[2] ?? here, `${name}.html`), page);
}
