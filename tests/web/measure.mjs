// Rates and latencies of the page in headless Chromium, server and browser on one machine: tests/web/measure.
import { writeFileSync } from "node:fs";
import { launch, RoomPage } from "./browser.mjs";
import { Server } from "./server.mjs";

const SECONDS = Number(process.env.LPV_SECONDS ?? 8);
const browser = await launch();
const server = await new Server().start("--max-edits-per-second", "100000");
const rows = [];
const middle = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? NaN;
const number = (text) => Number(/[-\d.]+/.exec(text ?? "")?.[0] ?? NaN);

// What the strip at the page's foot says, by name.
const strip = (page) => page.evaluate(() => Object.fromEntries([...document.querySelectorAll("footer.strip span")]
  .map((one) => [one.firstChild.textContent.trim(), one.querySelector("b").textContent])));

// Moves the pointer to and fro with a handle held, sixty times a second, and reads the strip every half second after two.
async function drag(page, names) {
  const box = await page.locator("#stage").boundingBox();
  const scale = box.height / (2 * Math.tan((38 * Math.PI) / 360));
  const x = box.x + box.width / 2 + 55;
  const y = box.y + box.height / 2 - (scale * (2.7 - 1.5)) / 6.6 + 4;
  await page.waitForTimeout(700);
  await page.mouse.move(x - 1, y);
  await page.mouse.move(x, y);
  await page.mouse.down();
  const seen = Object.fromEntries(names.map((name) => [name, []]));
  const began = Date.now();
  let read = began + 2000;
  for (let i = 0; Date.now() - began < 1000 * SECONDS; ++i) {
    await page.mouse.move(x + 60 * Math.sin(i / 20), y);
    await page.waitForTimeout(16);
    if (Date.now() < read) continue;
    read += 500;
    const now = await strip(page);
    for (const name of names) seen[name].push(number(now[name]));
  }
  await page.mouse.up();
  return Object.fromEntries(names.map((name) => [name, middle(seen[name].filter(Number.isFinite))]));
}

async function demo(options = {}) {
  const room = await RoomPage.open(browser, server.page);
  await room.makeDemoRoom();
  const session = await room.session;
  if (options.settings) server.lpvctl("session", "set", session, ...options.settings);
  await room.select("lamp");
  return room;
}

async function frames(what, settings) {
  const room = await demo({ settings });
  const { Frames, ["Edit to picture"]: edit } = await drag(room.page, ["Frames", "Edit to picture"]);
  const picture = (await strip(room.page)).Picture;
  rows.push([`frames, ${what}`, `${Frames.toFixed(1)} frames/s`, `${edit.toFixed(0)} ms`, picture]);
  await room.page.context().close();
}

// With `empty` nothing is shaded, the canvas is only cleared: what the browser itself takes to show it.
async function local(empty) {
  const room = await demo({ settings: ["--grid", "32"] });
  await room.page.click("[data-keys=m]");
  await room.page.waitForTimeout(1500);
  await room.page.evaluate(() => (lpvRoom.shading.local.options.size = () => ({ width: 320, height: 180 })));
  const name = await room.page.evaluate(() => lpvRoom.shading.local.renderer.rendererName);
  if (!/SwiftShader/.test(name)) throw new Error(`this is measured on SwiftShader, not on ${name}`);
  await room.page.keyboard.press("Escape");
  if (empty) {
    await room.page.evaluate(() => {
      const { renderer } = lpvRoom.shading.local;
      const gl = renderer.renderer.getContext();
      renderer.metered = () => undefined;
      renderer.draw = (view, width, height) => {
        renderer.renderer.setSize(width, height, false);
        gl.clearColor(Math.random(), 0.5, 0.5, 1);
        gl.clear(gl.COLOR_BUFFER_BIT);
      };
    });
  }
  await room.page.evaluate(() => {
    let step = 0;
    setInterval(() => {
      const translation = { x: Math.sin(++step / 20), y: 2.7, z: 0 };
      lpvRoom.editor.apply([{ operation: { case: "updateLight", value: { light: { name: "lamp", transform: { translation } }, updateMask: { paths: ["transform.translation"] } } } }]).catch(() => {});
    }, 33);
  });
  const names = ["Drawn here", "Volumes"];
  const read = Object.fromEntries(names.map((one) => [one, []]));
  await room.page.waitForTimeout(2000);
  for (let i = 0; i < 2 * SECONDS; ++i) {
    await room.page.waitForTimeout(500);
    const now = await strip(room.page);
    for (const one of names) read[one].push(number(now[one]));
  }
  const seen = Object.fromEntries(names.map((one) => [one, middle(read[one].filter(Number.isFinite))]));
  rows.push([`local, 320x180, grid 32${empty ? ", but nothing is shaded" : ""}`, `${seen["Drawn here"].toFixed(1)} drawn/s`, "", `${seen.Volumes.toFixed(1)} volumes/s`]);
  await room.page.context().close();
}

// An empty cache; the session runs, and somebody has its picture already.
async function firstVisit() {
  const owner = await demo();
  const address = `${server.page}#session=${await owner.session}`;
  const times = [];
  for (let i = 0; i < 5; ++i) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });
    const page = await context.newPage();
    const began = Date.now();
    await page.goto(address);
    await page.waitForFunction(() => {
      const picture = document.getElementById("picture");
      return picture && picture.getContext("2d").getImageData(picture.width >> 1, picture.height >> 1, 1, 1).data[1] > 0;
    }, undefined, { polling: 20 });
    times.push(Date.now() - began);
    await context.close();
  }
  rows.push(["first visit, empty cache, to the room's first pixel", "", `${middle(times)} ms`, `of ${times.length} visits`]);
  await owner.page.context().close();
}

await firstVisit();
await frames("defaults (shadows, bounces)");
await frames("without bounces", ["--bounces", "0"]);
await frames("without shadows and bounces", ["--bounces", "0", "--visibility", "off"]);
await local(false);
await local(true);
await browser.close();
await server.close();
const table = [process.env.LPV_ABOUT ?? "", "| what | rate | latency, median | |", "|---|---|---|---|", ...rows.map((row) => `| ${row.join(" | ")} |`)].join("\n");
writeFileSync(process.argv[2], `${table}\n`);
process.exit(0);
