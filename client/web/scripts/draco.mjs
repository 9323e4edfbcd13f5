// The decoder of Draco that comes with three.js is a script for Node and pages alike. Without Node's names, what it makes becomes
// what a module exports.
import { readFileSync } from "node:fs";

export const DRACO = /draco_decoder\.js$/;

export const dracoAsModule = {
  name: "draco as a module",
  setup: ({ onLoad }) => onLoad({ filter: DRACO }, ({ path }) => ({
    contents: `let exports, module, require;\n${readFileSync(path, "utf8")}\nexport default DracoDecoderModule;`,
  })),
};
