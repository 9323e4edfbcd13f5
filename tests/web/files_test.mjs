// What people drop on the page, beside what lpvctl makes of the same files.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { after, before, test } from "node:test";
import { launch, RoomPage } from "./browser.mjs";
import { damagedGlb, dracoGlb, gltf, hdr, manyGlb, meshoptGltf, obj, pentagonPly, ply, png, quantizedGltf, roomGlb, roomObj } from "./files.mjs";
import { shared, until } from "./server.mjs";

const both = shared({ before, after }, launch);
const VIEW = ["--eye", "0.6,1.5,4", "--target", "0,0.8,0", "--exposure", "0", "--size", "320x240"];

const listed = (kind, session) =>
  both.server.lpvctl("--json", kind, "list", session).trim().split("\n").filter(Boolean).map((line) => JSON.parse(line));
const lights = (session) => listed("light", session);
const surfaces = (session) => listed("surface", session);
const shape = (one) => [Number(one.status.triangleCount), Math.round(1e6 * one.status.area), one.radiance?.x, one.radiance?.y, one.radiance?.z];

// To six digits: what lpvctl reads has been through 32-bit floats.
const rounded = (value) => {
  if (typeof value === "number") return Number(value.toPrecision(6)) + 0;
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, one]) => [key, rounded(Math.abs(one) < 1e-6 ? 0 : one)]));
};

// All that a session says of an object, but its mesh's hash and its revision: both may put vertices in another order.
function told({ mesh, revision, status, ...one }) {
  return rounded({ ...one, ...(status ? { triangles: Number(status.triangleCount), area: status.area } : {}) });
}

// As the browser hands over what somebody drops.
async function drop(page, files, content) {
  const given = files.map((file) => ({ name: basename(file), bytes: content ? Buffer.from(content).toString("base64") : readFileSync(file).toString("base64") }));
  await page.evaluate((all) => {
    const data = new DataTransfer();
    for (const { name, bytes } of all) data.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name));
    document.getElementById("stage").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
  }, given);
}

async function emptySession() {
  const session = both.server.lpvctl("session", "create").trim();
  const room = await RoomPage.open(both.browser, `${both.server.page}#session=${session}`);
  await room.shows("Connected");
  await until("somebody may edit", () => room.page.locator('button[data-keys="i"]').isEnabled());
  return { room, session };
}

async function seen(room, session, name) {
  const file = join(both.server.folder, `${name}.png`);
  both.server.lpvctl("frame", "get", session, "-o", file, ...VIEW);
  return room.decode(readFileSync(file));
}

async function dropsAsLpvctl(files, counts) {
  const { room, session } = await emptySession();
  const other = both.server.lpvctl("session", "create").trim();
  both.server.lpvctl("scene", "load", other, files[0]);
  await room.page.setInputFiles("#files", files);
  await until(`${basename(files[0])} is there`, () => lights(session).length === counts.lights);
  assert.deepEqual(lights(session).map(told), lights(other).map(told), "lights");
  assert.equal(surfaces(other).length, counts.surfaces);
  assert.deepEqual(surfaces(session).map(told), surfaces(other).map(told), "surfaces");
  const [here, there] = [await seen(room, session, "here"), await seen(room, other, "there")];
  const worst = Math.max(...here.rgb.map((value, i) => Math.abs(value - there.rgb[i])));
  assert.ok(worst <= 3, `pictures differ by up to ${worst} of 255`);
  await room.shot(basename(files[0]));
  await room.page.keyboard.press("Escape");
  await room.page.keyboard.press("Control+z");
  await until("one undo takes all of it back", () => lights(session).length + surfaces(session).length === 0);
  assert.deepEqual(room.errors, []);
  await room.page.close();
}

test("a GLB with pictures becomes the lights and surfaces that lpvctl makes of it", { timeout: 300_000 }, () =>
  dropsAsLpvctl(roomGlb(both.server.folder), { lights: 1, surfaces: 3 }));

test("an OBJ with its MTL does", { timeout: 300_000 }, () => dropsAsLpvctl(roomObj(both.server.folder), { lights: 1, surfaces: 3 }));

test("a quantized glTF does", { timeout: 300_000 }, () => dropsAsLpvctl(quantizedGltf(both.server.folder), { lights: 1, surfaces: 1 }));

// They light nothing here, and come to the middle of the grid.
test("Draco's and meshopt's squares are the lights that lpvctl makes of them", { timeout: 300_000 }, async () => {
  for (const file of [dracoGlb(both.server.folder), meshoptGltf(both.server.folder)]) {
    const { room, session } = await emptySession();
    const other = both.server.lpvctl("session", "create").trim();
    both.server.lpvctl("scene", "load", other, file);
    await room.page.setInputFiles("#files", file);
    await until(`${basename(file)} is there`, () => lights(session).length === 1);
    const placeless = (one) => ({ ...told(one), transform: rounded(one.transform.scale) });
    assert.deepEqual(lights(session).map(placeless), lights(other).map(placeless), basename(file));
    assert.ok(Math.abs(lights(session)[0].status.area - 1) < 1e-3);
    assert.deepEqual(room.errors, []);
    await room.page.close();
  }
});

test("files in which nothing emits become lights, the same as lpvctl makes of them", { timeout: 300_000 }, async () => {
  const room = await RoomPage.open(both.browser, both.server.page);
  await room.makeDemoRoom();
  const session = await room.session;
  const other = both.server.lpvctl("session", "create").trim();
  const found = async (name) => {
    await until(`${name} is there`, () => lights(session).some((one) => one.name === name));
    return lights(session).find((one) => one.name === name);
  };
  for (const [name, file] of [["panel", obj(both.server.folder)], ["plate", ply(both.server.folder)], ["pentagon", pentagonPly(both.server.folder)]]) {
    await room.page.setInputFiles("#files", file);
    const here = await found(name);
    both.server.lpvctl("light", "add", other, file, "--name", name, "--radiance", "5,5,5");
    assert.deepEqual(shape(here), shape(lights(other).find((one) => one.name === name)), name);
    await until("it is selected", async () => (await room.page.inputValue("#object-name")) === name);
  }
  const tile = gltf(both.server.folder);
  await room.page.setInputFiles("#files", tile[0]);
  await room.page.locator("text=tile.gltf needs tile.bin: drop both together.").waitFor();
  await drop(room.page, tile);
  assert.deepEqual(shape(await found("tile")), [2, Math.round(1e6 * 0.4 * 0.2 * 4), 6, 3, 1.5]);
  const picture = png(both.server.folder);
  await drop(room.page, [picture]);
  const screen = await found("screen");
  assert.deepEqual(shape(screen).slice(0, 2), [2, Math.round(1e6 * 1.6 * 0.8)]);
  both.server.lpvctl("light", "add", other, obj(both.server.folder), "--name", "screen", "--radiance", "5,5,5", "--texture", picture);
  assert.equal(screen.texture, lights(other).find((one) => one.name === "screen").texture, "a television of the same texels");
  await drop(room.page, [hdr(both.server.folder)]);
  const sky = await found("evening");
  both.server.lpvctl("light", "sky", other, hdr(both.server.folder), "--name", "evening");
  const same = lights(other).find((one) => one.name === "evening");
  assert.ok(sky.distant && same.distant);
  assert.deepEqual([sky.mesh, sky.texture], [same.mesh, same.texture], "a sky of the same texels");
  await room.shot("sky");
  await drop(room.page, [join(both.server.folder, "nonsense.txt")], "nothing");
  await room.page.locator("text=nonsense.txt: what can be dropped is").waitFor();
  await room.shot("dropped");
  assert.deepEqual(room.errors, []);
});

test("a file in which nothing emits becomes surfaces where somebody chooses so, by keys alone", { timeout: 300_000 }, async () => {
  const { room, session } = await emptySession();
  const other = both.server.lpvctl("session", "create").trim();
  const plate = ply(both.server.folder);
  both.server.lpvctl("scene", "load", other, plate);
  await room.page.setInputFiles("#files", plate);
  const choice = room.page.getByRole("button", { name: "Add as surfaces instead" });
  await choice.waitFor();
  await room.page.locator("text=What is in plate.ply was added as lights, since nothing in it emits.").waitFor();
  assert.deepEqual([lights(session).length, surfaces(session).length], [1, 0]);
  await room.shot("choice");
  await choice.focus();
  await room.page.keyboard.press("Enter");
  await until("it is a surface", () => surfaces(session).length === 1);
  assert.deepEqual(surfaces(session).map(told), surfaces(other).map(told));
  await until("it is selected", async () => (await room.page.inputValue("#object-name")) === "plate");
  assert.equal(await choice.isVisible(), false);
  await room.page.keyboard.press("Escape");
  await room.page.keyboard.press("Control+z");
  await until("one undo brings the light back", () => lights(session).length === 1 && surfaces(session).length === 0);
  assert.deepEqual(room.errors, []);
  await room.page.close();
});

test("what is left out of a file is said", { timeout: 300_000 }, async () => {
  const { room, session } = await emptySession();
  const [scene, materials, screen] = roomObj(both.server.folder);
  await drop(room.page, [scene]);
  await room.page.locator("text=scene.obj is without its materials, since scene.mtl was not dropped: drop both together.").waitFor();
  await drop(room.page, [scene, materials, screen]);
  await room.page.locator("text=scene.obj names the picture leaf.png, which was not dropped: drop both together.").waitFor();
  const before = lights(session).length;
  await drop(room.page, [damagedGlb(both.server.folder)]);
  await room.page.locator("text=damaged.glb: a mesh is damaged: its bytes are not what KHR_draco_mesh_compression writes").waitFor();
  assert.equal(lights(session).length, before);
  assert.deepEqual(room.errors, []);
});

test("a scene of more objects than an edit may have is one step, and its mesh is sent once", { timeout: 300_000 }, async () => {
  const { room, session } = await emptySession();
  let sent = 0;
  room.page.on("websocket", (socket) => socket.on("framesent", () => (sent += 1)));
  await room.page.reload();
  await until("somebody may edit", () => room.page.locator('button[data-keys="i"]').isEnabled());
  await room.page.setInputFiles("#files", manyGlb(both.server.folder, 1200));
  await until("all are there", () => surfaces(session).length === 1200);
  assert.equal(new Set(surfaces(session).map(({ mesh }) => mesh)).size, 1);
  assert.ok(sent < 600, `${sent} messages were sent`);
  await room.page.keyboard.press("Escape");
  await room.page.keyboard.press("Control+z");
  await until("one undo takes all of it back", () => lights(session).length + surfaces(session).length === 0);
});
