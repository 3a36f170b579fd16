// Bundle the page's program: one file, no import, the same bytes every time.
import { build } from "esbuild";
import { readFile } from "node:fs/promises";

/** The licence of a package, as text of a comment. */
async function licence(name) {
  const text = await readFile(new URL(`node_modules/${name}/LICENSE`, import.meta.url), "utf8");
  return text.replace("\u00a9", "(c)").replaceAll("\r", "").replaceAll("*/", "").trim();
}
const notices = [];
for (const name of ["three", "fflate"]) notices.push(`It holds parts of ${name}:\n${await licence(name)}`);
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
  banner: { js: `"use strict";\n/* The page of kilter. ${notices.join("\n")} */` },
});

const text = await readFile(process.argv[2] || target, "utf8");
for (const word of ["</script", "<!--", "\r", "eval(", "new Function"]) {
  if (text.includes(word)) throw new Error(`the bundle holds ${JSON.stringify(word)}`);
}
