// Bundles every tests/*_test.ts for Node and runs them with its own runner.
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { dracoAsModule } from "./draco.mjs";

const page = fileURLToPath(new URL("..", import.meta.url));
const out = join(page, ".tests");
const tests = readdirSync(join(page, "tests")).filter((name) => name.endsWith("_test.ts"));
rmSync(out, { recursive: true, force: true });
await build({
  absWorkingDir: page, entryPoints: tests.map((name) => `tests/${name}`), bundle: true, format: "esm", platform: "node",
  target: "node18", outdir: out, outExtension: { ".js": ".mjs" }, sourcemap: "inline", plugins: [dracoAsModule],
});
const run = spawnSync(process.execPath, ["--enable-source-maps", "--test", ...tests.map((name) => join(out, name.replace(/\.ts$/, ".mjs")))],
  { stdio: "inherit" });
process.exit(run.status ?? 1);
