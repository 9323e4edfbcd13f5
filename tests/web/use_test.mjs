// The page as people use it who have no mouse, or a tablet.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { after, before, test } from "node:test";
import { apart, difference, launch, RoomPage } from "./browser.mjs";
import { shared, until } from "./server.mjs";

const AXE = readFileSync(createRequire(pathToFileURL(join(process.env.LPV_PAGE_SOURCE, "package.json"))).resolve("axe-core"), "utf8");

const both = shared({ before, after }, launch);

const light = (session) => JSON.parse(both.server.lpvctl("--json", "light", "list", session).split("\n")[0]);
const lights = (session) => both.server.lpvctl("--json", "light", "list", session).trim().split("\n").filter(Boolean).length;

// Faults that axe-core calls serious or critical. Its script is put into the page past the page's own policy.
async function faults(room) {
  await room.page.evaluate(AXE);
  return room.page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
    return violations.filter(({ impact }) => impact === "serious" || impact === "critical")
      .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`);
  });
}

test("axe-core finds no serious fault, in light and in dark", { timeout: 300_000 }, async () => {
  const room = await RoomPage.open(both.browser, both.server.page);
  for (const colorScheme of ["light", "dark"]) {
    await room.page.emulateMedia({ colorScheme });
    assert.deepEqual(await faults(room), [], `landing, ${colorScheme}`);
  }
  await room.makeDemoRoom();
  await room.select("lamp");
  for (const colorScheme of ["light", "dark"]) {
    await room.page.emulateMedia({ colorScheme });
    assert.deepEqual(await faults(room), [], `room, ${colorScheme}`);
  }
  await room.shot("dark");
  await room.page.keyboard.press("g");
  assert.deepEqual(await faults(room), [], "handles");
  await room.page.keyboard.press("Escape");
  await room.page.keyboard.press("?");
  assert.deepEqual(await faults(room), [], "keys");
  await room.page.keyboard.press("Escape");
  await room.page.keyboard.press("c");
  await room.page.locator("#settings select").first().waitFor();
  assert.deepEqual(await faults(room), [], "settings");
});

// What each key does, seen where it can be: in the page, or on the server.
test("every action of ? is done by keys alone", { timeout: 300_000 }, async () => {
  const room = await RoomPage.open(both.browser, both.server.page);
  const { page } = room;
  let choosers = 0;
  page.on("filechooser", () => (choosers += 1));
  await page.keyboard.press("Tab");
  await until("the demo room's button has the focus", async () => {
    if ((await page.evaluate(() => document.activeElement?.id)) === "demo") return true;
    await page.keyboard.press("Tab");
    return false;
  });
  await page.keyboard.press("Enter");
  await room.seesPicture();
  const session = await room.session;
  const pressed = (keys) => page.locator(`[data-keys="${keys}"]`).getAttribute("aria-pressed");
  const tried = new Set();
  const press = async (keys) => {
    tried.add(keys);
    await page.keyboard.press(keys.replace("Ctrl+", "Control+"));
  };

  const find = async (name) => {
    await press("/");
    await page.keyboard.type(name);
    await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await until(`${name} is selected`, async () => (await page.locator("#object-name").count()) === 1 && (await page.inputValue("#object-name")) === name);
  };

  await find("lamp");
  await press("i");
  await until("files can be chosen", () => choosers === 1);
  await press("v");
  assert.equal(await page.evaluate(() => document.activeElement.id), "stage");
  for (const keys of ["r", "y", "g"]) await press(keys);
  assert.equal(await page.evaluate(() => document.activeElement.id), "handle-keys");
  await page.keyboard.press("ArrowLeft");
  tried.add("Arrows, Page Up, Page Down");
  await until("an arrow moves the lamp", () => Math.abs((light(session).transform.translation.x ?? 0) + 0.1) < 1e-4);
  for (const keys of ["x", "b"]) {
    await press(keys);
    assert.equal(await pressed(keys), "true");
  }
  await press("t");
  await until("t turns the lamp off", () => light(session).enabled === false);
  await press("Ctrl+Z");
  await until("Ctrl+Z turns it on", () => light(session).enabled !== false);
  await press("Ctrl+Y");
  await until("Ctrl+Y turns it off again", () => light(session).enabled === false);
  await press("Ctrl+D");
  await until("there is a second lamp", () => lights(session) === 2);
  await until("it is selected", async () => (await page.inputValue("#object-name")) !== "lamp");
  await press("Delete");
  await until("it is gone", () => lights(session) === 1);
  await find("lamp");
  await press("t");
  await until("the lamp is on", () => light(session).enabled !== false);
  await press("Ctrl+D");
  await until("there is a lamp beside it", () => lights(session) === 2);
  await until("which is selected", async () => (await page.inputValue("#object-name")) !== "lamp");
  await press("k");
  await until("k turns the first lamp off", () => all(session).filter((one) => one.enabled !== false).length === 1);
  await press("k");
  await until("and on again", () => all(session).filter((one) => one.enabled !== false).length === 2);
  await press("Ctrl+A");
  await until("both are selected", async () => (await page.locator('.list button[aria-current="true"]').count()) === 2);
  await find("lamp");
  await press("/");
  await page.keyboard.press("Delete");
  for (let i = 0; i < 3; ++i) await page.keyboard.press("Tab");
  await page.keyboard.press("Shift+Enter");
  await until("Shift+Enter selects one more", async () => (await page.locator('.list button[aria-current="true"]').count()) === 2);
  await page.keyboard.press("Shift+Enter");
  await until("and no longer", async () => (await page.inputValue("#object-name")) === "lamp");
  await press("Delete");
  await until("one is left", () => lights(session) === 1);
  await press("Ctrl+Z");
  await until("both are there again", () => lights(session) === 2);
  await press("Ctrl+A");
  await press("Delete");
  await until("both go at once", () => lights(session) === 0);
  await press("Ctrl+Z");
  await until("and come back at once", () => lights(session) === 2);
  await find("lamp");
  await press("Escape");
  assert.equal(await page.locator("#object-name").count(), 0);

  await find("ball");
  await press("v");
  await page.waitForTimeout(1500);
  const home = await room.pixels();
  await press("f");
  await until("f comes closer", async () => difference(home, await room.pixels()) > 5);
  await press("h");
  await press("n");
  assert.equal(await page.evaluate(() => document.activeElement.id), "object-name");
  await page.keyboard.press("Escape");
  await press("v");
  for (const [listed, keys] of [["W A S D, Q E", ["w", "a", "s", "d", "q", "e"]], ["Arrows", ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"]]]) {
    tried.add(listed);
    for (const key of keys) await room.steer(key, 0.1);
  }
  for (const keys of ["p", "u", "o"]) {
    const download = page.waitForEvent("download");
    await press(keys);
    assert.match((await download).suggestedFilename(), /\.(png|exr|lpv)$/);
  }
  await press("l");
  await page.keyboard.press("Escape");
  await press("m");
  await until("m shades here", async () => (await pressed("m")) === "true");
  await press("m");
  await press("j");
  await page.locator('[aria-label="Slice of the volume"] p', { hasText: "W/m²" }).waitFor();
  await room.shot("slice");
  await press("j");
  await until("j closes it", async () => (await page.locator('[aria-label="Slice of the volume"]').count()) === 0);
  await press("c");
  await page.locator("#settings select").first().waitFor();
  await page.locator('[aria-label="Bounces"]').focus();
  await page.keyboard.type("none");
  await until("bounces are off", () => /bounces\W+(none|0)/i.test(both.server.lpvctl("session", "show", session)));
  await room.shot("settings");
  await page.keyboard.press("Escape");
  await press("?");
  const listed = await page.locator("dialog[open] kbd").allTextContents();
  assert.ok(listed.length > 15);
  assert.deepEqual(listed.filter((keys) => !tried.has(keys)), [], "listed and not tried");
  assert.deepEqual(room.errors, []);
});

const all = (session) => both.server.lpvctl("--json", "light", "list", session).trim().split("\n").filter(Boolean).map((line) => JSON.parse(line));

async function touch(page, paths) {
  const cdp = await page.context().newCDPSession(page);
  const points = (step) => paths.map(([from, to], id) => ({
    id, x: from[0] + (to[0] - from[0]) * step, y: from[1] + (to[1] - from[1]) * step,
  }));
  await cdp.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: points(0) });
  for (let step = 1; step <= 10; ++step) {
    await cdp.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: points(step / 10) });
    await page.waitForTimeout(30);
  }
  await cdp.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
}

test("a tablet: one finger orbits, two come closer, a handle is dragged", { timeout: 300_000 }, async () => {
  const context = await both.browser.newContext({ viewport: { width: 1024, height: 768 }, hasTouch: true });
  const room = await RoomPage.open(both.browser, both.server.page, context);
  const { page } = room;
  await page.tap("#demo");
  await room.seesPicture();
  const session = await room.session;
  const box = await page.locator("#stage").boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  const at = (dx, dy) => [middle[0] + dx, middle[1] + dy];
  const [first, before] = [await room.pixels(), await room.eye()];
  await touch(page, [[at(-80, 60), at(80, 60)]]);
  const orbited = await room.eye();
  assert.ok(apart(before, orbited) > 1, "one finger orbits");
  await until("the picture follows", async () => difference(first, await room.pixels()) > 3);
  await touch(page, [[at(-40, 0), at(-150, 0)], [at(40, 0), at(150, 0)]]);
  const closer = await room.eye();
  assert.ok(Math.hypot(closer.x, closer.y - 1.45, closer.z) < 0.7 * Math.hypot(orbited.x, orbited.y - 1.45, orbited.z), "two fingers come closer");
  await page.keyboard.press("h");
  await page.tap("[data-name=lamp]");
  await page.locator("#object-name").waitFor();
  const scale = box.height / (2 * Math.tan((38 * Math.PI) / 360));
  const handle = at(55, -(scale * (2.7 - 1.5)) / 6.6 + 4);
  await page.waitForTimeout(500);
  await touch(page, [[handle, [handle[0] + 100, handle[1]]]]);
  await until("the lamp has moved", () => (light(session).transform?.translation?.x ?? 0) > 0.2);
  await room.shot("tablet");
  assert.deepEqual(room.errors, []);
});
