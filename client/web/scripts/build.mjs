// Makes dist/: index.html, scripts and styles named by their content, and the notices of what they contain (which replace
// comments of licences in them), each also compressed. Fails above 400 KB of gzip, for
// all files together but the decoder of Draco, which is fetched for files that need it.
import { build } from "esbuild";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, join, relative } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { DRACO, dracoAsModule } from "./draco.mjs";
import { noticesOf } from "./notices.mjs";

const page = fileURLToPath(new URL("..", import.meta.url));
const dist = process.env.LPV_WEB_DIST ?? join(page, "dist");
const LARGEST = 400 * 1000; // bytes of gzip

rmSync(dist, { recursive: true, force: true });
mkdirSync(join(dist, "assets"), { recursive: true });
const made = await build({
  absWorkingDir: page,
  entryPoints: { page: "src/main.ts", style: "src/style/main.css" },
  bundle: true, splitting: true, format: "esm", target: "es2022", minify: true, legalComments: "none", plugins: [dracoAsModule],
  entryNames: "[name]-[hash]", chunkNames: "[name]-[hash]", outdir: join(dist, "assets"), write: true, metafile: true,
});
const written = Object.keys(made.metafile.outputs).map((name) => join(page, name));
const named = (start) => `assets/${basename(written.find((name) => basename(name).startsWith(start)))}`;
const document = readFileSync(join(page, "src", "index.html"), "utf8")
  .replace("{{script}}", named("page-")).replace("{{style}}", named("style-"));
const index = join(dist, "index.html");
writeFileSync(index, document);
const notices = join(dist, "notices.txt");
writeFileSync(notices, noticesOf(Object.keys(made.metafile.inputs), join(page, "node_modules")));

const isDraco = (file) => Object.keys(made.metafile.outputs[relative(page, file)]?.inputs ?? {}).some((input) => DRACO.test(input));
let total = 0;
for (const file of [index, notices, ...written]) {
  const packed = gzipSync(readFileSync(file), { level: 9 });
  writeFileSync(`${file}.gz`, packed);
  if (!isDraco(file)) total += packed.length;
}
console.log(`${written.length + 2} files, ${(total / 1000).toFixed(1)} KB of gzip beside the decoder of Draco`);
if (total > LARGEST) {
  console.error(`more than ${LARGEST / 1000} KB`);
  process.exit(1);
}
