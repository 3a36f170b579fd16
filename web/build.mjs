// Bundle the page's program: one file, no import, the same bytes every time.
import { build } from "esbuild";
import { readFile } from "node:fs/promises";

const three = await readFile(new URL("node_modules/three/LICENSE", import.meta.url), "utf8");
const notice = three.replace("\u00a9", "(c)").replaceAll("\r", "").replaceAll("*/", "").trim();
const target = new URL("../src/kilter/show/assets/page.js", import.meta.url).pathname;

await build({
  entryPoints: [new URL("src/main.js", import.meta.url).pathname],
  absWorkingDir: new URL(".", import.meta.url).pathname,
  outfile: process.argv[2] || target,
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "ascii",
  legalComments: "none",
  banner: { js: `"use strict";\n/* The page of kilter. It holds parts of three.js:\n${notice} */` },
});

const text = await readFile(process.argv[2] || target, "utf8");
for (const word of ["</script", "<!--", "\r", "eval(", "new Function"]) {
  if (text.includes(word)) throw new Error(`the bundle holds ${JSON.stringify(word)}`);
}
