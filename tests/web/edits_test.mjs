// A page in which much has been edited: as large as before, and what it shows is what the server has.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, RoomPage } from "./browser.mjs";
import { shared, until } from "./server.mjs";
import { xxh64 } from "./xxh64.mjs";

const EDITS = Number(process.env.LPV_PAGE_EDITS ?? 600);
// Before what they leave is counted: a page is as large as it gets after some hundreds.
const FIRST_EDITS = Math.max(300, Math.round(EDITS / 20));

const both = shared({ before, after }, launch);

const lampX = (session) => JSON.parse(both.server.lpvctl("--json", "light", "list", session).split("\n")[0]).transform?.translation?.x ?? 0;

test("xxh64 is what xxHash says", () => {
  assert.equal(xxh64(new Uint8Array(0)), 0xef46db3751d8e999n);
  assert.equal(xxh64(new TextEncoder().encode("abc")), 0x44bc2cf5ad770999n);
});

// Edits through the field of a number, each sent when the one before has been acknowledged.
async function edit(room, session, from, to) {
  await room.page.evaluate(async ([first, last]) => {
    for (let i = first; i < last; ++i) {
      const input = document.querySelector('[aria-label="Position, m x"]');
      input.value = String(((i % 100) + 1) / 100);
      input.dispatchEvent(new Event("change", { bubbles: true }));
      await lpvRoom.editor.sent;
      await new Promise((resolve) => setTimeout(resolve)); // what else the page has to do
    }
  }, [from, to]);
  const wanted = (((to - 1) % 100) + 1) / 100;
  await until("the last edit arrives", () => Math.abs(lampX(session) - wanted) < 1e-6);
  // Local shading keeps two volumes, and has made all that it needs with the second.
  await until("its light is shown", () => room.page.evaluate(() => !lpvRoom.shading.local || lpvRoom.strip.volumeRevision >= lpvRoom.model.revision));
}

// Bytes of the heap in use, after collections that were asked for.
async function heapOf(room) {
  const cdp = await room.page.context().newCDPSession(room.page);
  await cdp.send("HeapProfiler.enable");
  for (let i = 0; i < 3; ++i) await cdp.send("HeapProfiler.collectGarbage");
  const { usedSize } = await cdp.send("Runtime.getHeapUsage");
  await cdp.detach();
  return usedSize;
}

const objectsOf = (room) => room.page.evaluate(() => {
  const count = ({ info: { memory, programs } }) => memory.geometries + memory.textures + programs.length;
  return count(lpvRoom.stage.handles.gizmo.renderer) + (lpvRoom.shading.local ? count(lpvRoom.shading.local.renderer.renderer) : 0);
});

// The volume that local shading holds, in the order of which the server's checksum is, and that checksum.
async function heldVolume(room) {
  const { text, checksum, revision } = await room.page.evaluate(async () => {
    const { field } = lpvRoom.shading.local.follower;
    const [nx, ny, nz] = field.dims;
    const bytes = new Uint8Array(nx * ny * nz * field.layers * 24);
    const view = new DataView(bytes.buffer);
    for (let cell = 0; cell < bytes.length / 24; ++cell) {
      field.colours.forEach((halves, colour) => {
        for (let k = 0; k < 4; ++k) view.setUint16(24 * cell + 8 * colour + 2 * k, halves[4 * cell + k], true);
      });
    }
    const address = await new Promise((resolve) => {
      const reader = new FileReader();
      reader.onload = () => resolve(reader.result);
      reader.readAsDataURL(new Blob([bytes]));
    });
    return { text: address.split(",")[1], checksum: String(field.header.result.checksum), revision: String(field.header.result.revision) };
  });
  return { hash: xxh64(Buffer.from(text, "base64")), checksum: BigInt(checksum), revision: BigInt(revision) };
}

for (const look of ["the server's pictures", "local shading"]) {
  test(`${EDITS} edits with ${look} leave the page as large as it was`, { timeout: 900_000 + 90 * EDITS }, async () => {
    const room = await RoomPage.open(both.browser, both.server.page);
    await room.makeDemoRoom();
    await room.select("lamp");
    const session = await room.session;
    if (look === "local shading") {
      await room.page.click("[data-keys=m]");
      await until("the volume is shown", () => room.page.evaluate(() => lpvRoom.strip.volumeRevision !== undefined));
    }
    const revisionOf = () => room.page.evaluate(() => String(lpvRoom.model.revision)).then(BigInt);
    const first = await revisionOf();
    await edit(room, session, 0, FIRST_EDITS);
    const earlier = { heap: await heapOf(room), objects: await objectsOf(room) };
    const began = Date.now();
    await edit(room, session, FIRST_EDITS, FIRST_EDITS + EDITS);
    const rate = (1000 * EDITS) / (Date.now() - began);
    const later = { heap: await heapOf(room), objects: await objectsOf(room) };
    console.log(`${look}: heap ${earlier.heap} after ${FIRST_EDITS} edits, ${later.heap} after ${EDITS} more; GL objects ${earlier.objects}, ${later.objects}; ${rate.toFixed(0)} edits/s`);
    assert.ok(later.heap <= 1.1 * earlier.heap, `${earlier.heap} bytes after ${FIRST_EDITS} edits, ${later.heap} after ${EDITS} more`);
    assert.ok(earlier.objects > 0);
    assert.equal(later.objects, earlier.objects);
    const revision = await revisionOf();
    assert.equal(revision - first, BigInt(FIRST_EDITS + EDITS), "each was an edit of its own");
    assert.equal(revision, BigInt(JSON.parse(both.server.lpvctl("--json", "session", "show", session)).revision));
    assert.ok(Math.abs(Number(await room.input("Position, m x").inputValue()) - lampX(session)) < 1e-6);
    if (look === "local shading") {
      const held = await heldVolume(room);
      assert.equal(held.revision, revision);
      assert.equal(held.hash, held.checksum, "what all the deltas have come to is the server's volume");
    }
    assert.deepEqual(room.errors, []);
    await room.page.context().close();
  });
}
