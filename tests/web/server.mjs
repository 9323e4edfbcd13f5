// A real lpvd with its door for browsers, on free ports of the loopback.
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const LPVD = process.env.LPVD;
const LPVCTL = process.env.LPVCTL;
const DIST = process.env.LPV_PAGE_DIST;
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// What a busy machine may take for anything that is waited for: no test asserts a speed.
export const PATIENCE = 60_000;

export async function until(what, look, ms = PATIENCE) {
  const end = Date.now() + ms;
  for (;;) {
    const value = await look();
    if (value) return value;
    if (Date.now() > end) throw new Error(`not within ${ms / 1000} s: ${what}`);
    await pause(200);
  }
}

// One server and one browser for all tests of a file, made before them and gone after.
export function shared({ before, after }, launch) {
  const both = {};
  before(async () => {
    both.browser = await launch();
    both.server = await new Server().start("--max-edits-per-second", "100000");
  });
  after(async () => {
    await both.browser.close();
    await both.server.close();
  });
  return both;
}

export class Server {
  folder = mkdtempSync(join(tmpdir(), "lpv-web-"));
  webPort = 0;
  adminToken = "";

  async start(...options) {
    const grpcFile = join(this.folder, "grpc-port");
    const webFile = join(this.folder, "web-port");
    for (const file of [grpcFile, webFile]) rmSync(file, { force: true });
    this.options = options;
    this.process = spawn(LPVD, ["--listen", "127.0.0.1:0", "--port-file", grpcFile, "--device", "software",
      "--web", `127.0.0.1:${this.webPort}`, "--web-port-file", webFile, "--web-files", DIST, ...options],
    { stdio: ["ignore", "ignore", "inherit"], detached: true, env: { ...process.env, LPVD_LOG_LEVEL: "warn" } });
    const read = (file) => existsSync(file) && Number(readFileSync(file, "utf8"));
    this.grpcPort = await until("lpvd writes its port", () => read(grpcFile));
    this.webPort = await until("lpvd writes its port for browsers", () => read(webFile));
    return this;
  }

  withAdminToken() {
    this.adminToken = "admin-token-of-the-browser-tests";
    const file = join(this.folder, "admin-token");
    writeFileSync(file, `${this.adminToken}\n`, { mode: 0o600 });
    return this.start("--admin-token-file", file);
  }

  get page() {
    return `http://127.0.0.1:${this.webPort}/`;
  }

  lpvctl(...args) {
    return execFileSync(LPVCTL, ["--server", `127.0.0.1:${this.grpcPort}`, ...args], { encoding: "utf8" });
  }

  // As the power going: no notice, no draining.
  async kill() {
    const { process: child } = this;
    if (!child || child.exitCode !== null || child.signalCode !== null) return;
    const gone = new Promise((resolve) => child.once("exit", resolve));
    process.kill(-child.pid, "SIGKILL");
    await gone;
  }

  restart() {
    return this.start(...this.options);
  }

  async close() {
    await this.kill();
    rmSync(this.folder, { recursive: true, force: true });
  }
}
