// What a worker that decodes volumes could give local shading at most: the page as it is beside one that decodes nothing,
// in turns on the same room. tests/web/measure --decoding.
import { launch, RoomPage } from "./browser.mjs";
import { Server } from "./server.mjs";

const SECONDS = Number(process.env.LPV_SECONDS ?? 8);
const TURNS = 4;
const SIZE = { width: 320, height: 180 };

// Counts what the page does from now on; the lamp goes to and fro.
function watch(size) {
  const { local } = lpvRoom.shading;
  local.options.size = () => size;
  const seen = (window.seen = { decoding: true, decodeMs: 0, volumes: 0, drawn: [] });
  const field = Object.getPrototypeOf(local.follower.field);
  const { take } = field;
  field.take = function (part) {
    const began = performance.now();
    if (seen.decoding) take.call(this, part);
    seen.decodeMs += performance.now() - began;
  };
  const { volume, drew } = local.options.reports;
  local.options.reports.volume = (...given) => {
    seen.volumes += 1;
    volume(...given);
  };
  local.options.reports.drew = () => {
    seen.drawn.push(performance.now());
    drew();
  };
  let step = 0;
  setInterval(() => {
    const translation = { x: Math.sin(++step / 20), y: 2.7, z: 0 };
    lpvRoom.editor.apply([{ operation: { case: "updateLight", value: { light: { name: "lamp", transform: { translation } }, updateMask: { paths: ["transform.translation"] } } } }]).catch(() => {});
  }, 33);
}

async function turn(page, decoding) {
  await page.evaluate((on) => Object.assign(seen, { decoding: on }), decoding);
  await page.waitForTimeout(700);
  await page.evaluate(() => Object.assign(seen, { decodeMs: 0, volumes: 0, drawn: [] }));
  await page.waitForTimeout(1000 * SECONDS);
  const { decodeMs, volumes, drawn } = await page.evaluate(() => seen);
  const gaps = drawn.slice(1).map((at, i) => at - drawn[i]).sort((a, b) => a - b);
  return { rate: drawn.length / SECONDS, late: gaps[Math.floor(0.95 * gaps.length)] ?? NaN, volumes: volumes / SECONDS, decode: decodeMs / volumes };
}

const browser = await launch();
const server = await new Server().start("--max-edits-per-second", "100000");
console.log("| grid | decoded here | drawn/s, each turn | 95 % of the gaps between them are shorter than, ms | volumes/s | decoding a volume, ms |\n|---|---|---|---|---|---|");
try {
  for (const grid of ["32", "64"]) {
    const room = await RoomPage.open(browser, server.page);
    await room.makeDemoRoom();
    server.lpvctl("session", "set", await room.session, "--grid", grid);
    await room.page.click("[data-keys=m]");
    await room.page.waitForFunction(() => lpvRoom.shading.local?.follower.field);
    await room.page.evaluate(watch, SIZE);
    await room.page.waitForTimeout(2000);
    const turns = { true: [], false: [] };
    for (let i = 0; i < TURNS; ++i) for (const decoding of i % 2 ? [false, true] : [true, false]) turns[decoding].push(await turn(room.page, decoding));
    for (const [decoding, all] of Object.entries(turns)) {
      const each = (name, digits) => all.map((one) => one[name].toFixed(digits)).join(" ");
      console.log(`| ${grid} | ${decoding === "true" ? "yes" : "no"} | ${each("rate", 1)} | ${each("late", 0)} | ${each("volumes", 1)} | ${each("decode", 1)} |`);
    }
    await room.page.context().close();
  }
} finally {
  await browser.close();
  await server.close();
}
