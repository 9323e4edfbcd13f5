// Makes TypeScript of the messages in proto/, into gen/. Skipped where nothing has changed since.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const page = fileURLToPath(new URL("..", import.meta.url));
const root = join(page, "..", "..", "proto");
const out = join(page, "gen");
const folders = ["lpv/v1", "lpv/web/v1"];
const files = folders.flatMap((folder) =>
  readdirSync(join(root, folder)).filter((name) => name.endsWith(".proto")).map((name) => `${folder}/${name}`));
const stamp = join(out, ".made");
const newest = Math.max(...files.map((name) => statSync(join(root, name)).mtimeMs));
if (!existsSync(stamp) || statSync(stamp).mtimeMs < newest) {
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  const plugin = join(page, "node_modules", ".bin", "protoc-gen-es");
  execFileSync("protoc", [`--plugin=protoc-gen-es=${plugin}`, `--es_out=${out}`, "--es_opt=target=ts", `-I${root}`, ...files],
    { stdio: "inherit" });
  writeFileSync(stamp, "");
}
