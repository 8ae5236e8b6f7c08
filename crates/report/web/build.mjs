// Builds page.html: markup, style and program in one file that needs nothing else.
//   node build.mjs [FILE]
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const read = (name) => readFileSync(join(here, name), "utf8");

const { outputFiles } = await build({
    absWorkingDir: here,
    entryPoints: ["src/main.ts"],
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    legalComments: "none", // the notices are in NOTICES.txt, which goes into the page
    outdir: "unused",
    write: false,
});
const output = (ending) => outputFiles.find(({ path }) => path.endsWith(ending)).text.trim();

const page = read("src/page.html")
    .replace("<!-- notices -->", () => `<!--\n${read("NOTICES.txt").trim()}\n-->`)
    .replace("/* style */", () => output(".css"))
    .replace("/* program */", () => output(".js"));
writeFileSync(process.argv[2] ?? join(here, "page.html"), page);
