import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
// @ts-expect-error a script of the build, without types
import { noticesOf } from "../scripts/notices.mjs";

const modules = process.env.LPV_NODE_MODULES ?? fileURLToPath(new URL("../node_modules", import.meta.url));
const of = (...inputs: string[]): string => noticesOf(inputs.map((path) => `node_modules/${path}`), modules) as string;

// Broken by: a package that brings no file of its licence; what a file says of itself; what a package contains of others.
test("who made what the page contains is told with the licence", () => {
  const text = of("three/build/three.core.js", "@bufbuild/protobuf/dist/esm/wire/varint.js", "three/examples/jsm/libs/draco/draco_decoder.js");
  for (const part of ["three 0.", "The MIT License", "@bufbuild/protobuf 2.", "Copyright 2008 Google Inc.", "The Draco Authors", "Apache License"])
    assert.ok(text.includes(part), part);
  assert.equal(text.split("Version 2.0, January 2004").length, 2, "once");
});

test("only of what is there", () => {
  const text = of("three/build/three.core.js");
  assert.ok(!text.includes("Draco") && !text.includes("Apache"));
});
