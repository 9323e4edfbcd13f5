import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "../src/view/pace.ts";

// A server that takes `full` ms for a whole picture, and pictures by their pixels.
function settled(full: number, from = 1): number {
  const pace = new Pace();
  let share = from;
  for (let i = 0; i < 40; ++i) share = pace.next(share, 15 + full * share * share);
  return share;
}

test("a fast server draws whole pictures", () => {
  assert.equal(settled(30), 1);
  assert.equal(settled(30, 0.25), 1);
});

test("a slow one smaller pictures, as small as is needed and no smaller", () => {
  const share = settled(240);
  assert.ok(share < 1 && 15 + 240 * share * share < 90, String(share));
  assert.ok(settled(2000) === 0.25, "a quarter is the least");
  assert.ok(settled(120) > settled(600));
});

test("it does not swing between two sizes", () => {
  for (const full of [60, 100, 150, 240, 400, 900]) {
    const pace = new Pace();
    let share = 1;
    const asked: number[] = [];
    for (let i = 0; i < 60; ++i) asked.push((share = pace.next(share, 15 + full * share * share)));
    assert.equal(new Set(asked.slice(-20)).size, 1, `${full}: ${asked.slice(-20).join(" ")}`);
  }
});
