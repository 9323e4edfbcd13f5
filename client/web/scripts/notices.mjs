// What the licences of packages that the page contains want to be told to those who get it.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const TEXTS = { // of licences that a package names and does not bring: where else the text is
  "Apache-2.0": "typescript/LICENSE.txt",
};
const INSIDE = [ // what packages contain of others
  { file: /^three\/examples\/jsm\/libs\/draco\//, name: "Draco", about: "Copyright 2017 The Draco Authors", license: "Apache-2.0" },
];

const nameOf = (path) => path.split("/").slice(0, path.startsWith("@") ? 2 : 1).join("/");

// Comments at the start of a file that state somebody's copyright, without their slashes.
function ownNotice(text) {
  const lines = [];
  for (const line of text.split("\n")) {
    if (!line.startsWith("//")) break;
    lines.push(line.slice(2).trim());
  }
  const notice = lines.join("\n");
  return /redistribution/i.test(notice) ? notice : "";
}

// `inputs`: the files of a bundle, as esbuild names them. `modules`: node_modules.
export function noticesOf(inputs, modules) {
  const paths = inputs.map((path) => path.split("node_modules/").pop()).filter((path, i) => inputs[i].includes("node_modules/"));
  const wanted = new Set(), notices = [];
  const add = (title, license, ...texts) => {
    notices.push([title, ...texts.filter((text) => text !== "")].join("\n\n"));
    for (const each of license.match(/[A-Za-z0-9.-]+/g).filter((word) => word in TEXTS)) wanted.add(each);
  };
  for (const name of [...new Set(paths.map(nameOf))].sort()) {
    const { version, license } = JSON.parse(readFileSync(join(modules, name, "package.json"), "utf8"));
    if (!license) throw new Error(`${name} ${version} names no licence`);
    const file = readdirSync(join(modules, name)).find((each) => /^licen[cs]e/i.test(each));
    const text = file ? readFileSync(join(modules, name, file), "utf8").trim() : "";
    const parts = [...new Set(paths.filter((path) => nameOf(path) === name).map((path) => ownNotice(readFileSync(join(modules, path), "utf8"))))];
    const known = text !== "" || license.match(/[A-Za-z0-9.-]+/g).some((word) => word in TEXTS);
    if (!known) throw new Error(`${name} ${version} is under ${license}, whose text is not known to scripts/notices.mjs`);
    add(`${name} ${version}, ${license.replace(/^\(|\)$/g, "")}`, license, text, ...parts);
  }
  for (const { file, name, about, license } of INSIDE) {
    if (paths.some((path) => file.test(path))) add(`${name}, ${license}`, license, about);
  }
  for (const license of wanted) {
    const path = join(modules, TEXTS[license]);
    if (!existsSync(path)) throw new Error(`no text of ${license}: ${TEXTS[license]} is missing`);
    notices.push(`${license}\n\n${readFileSync(path, "utf8").trim()}`);
  }
  const rule = `\n\n${"-".repeat(80)}\n\n`;
  return ["This page contains work of others, under these licences.", ...notices].join(rule) + "\n";
}
