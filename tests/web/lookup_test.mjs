// The page's lookup in WebGL2 against the server's in C++, on random volumes; tests/gpu/transport/lookup_test.cpp has
// the same for GLSL.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { after, before, test } from "node:test";
import { launch } from "./browser.mjs";

const PAGE = process.env.LPV_PAGE_SOURCE;
const cases = JSON.parse(execFileSync(process.env.LPV_LOOKUP_CASES, { maxBuffer: 1 << 28 }).toString());
let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

async function lookupOfPage() {
  const { transformSync } = createRequire(pathToFileURL(join(PAGE, "package.json")))("esbuild");
  const { code } = transformSync(readFileSync(join(PAGE, "src/local/shaders.ts"), "utf8"), { loader: "ts", format: "esm" });
  return (await import(`data:text/javascript,${encodeURIComponent(code)}`)).lookup;
}

// Runs in the page: E at each point, by one pixel each.
function evaluate({ one, lookup, exact }) {
  const gl = new OffscreenCanvas(16, 16).getContext("webgl2");
  if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("this browser draws no floats");
  const shader = (type, text) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, `#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler3D;\n${text}`);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }"));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `${exact ? "#define EXACT\n" : ""}${lookup}
    uniform sampler2D positions, normals;
    out vec4 colour;
    void main() {
      ivec2 at = ivec2(gl_FragCoord.xy);
      colour = vec4(irradianceAt(texelFetch(positions, at, 0).xyz, texelFetch(normals, at, 0).xyz), 1.0);
    }`));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const layers = one.scales.length;
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  const texture = (unit, target, filter, upload) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, gl.createTexture());
    for (const name of ["MIN", "MAG"]) gl.texParameteri(target, gl[`TEXTURE_${name}_FILTER`], filter);
    for (const name of ["S", "T", "R"]) gl.texParameteri(target, gl[`TEXTURE_WRAP_${name}`], gl.CLAMP_TO_EDGE);
    upload();
  };
  one.halves.forEach((halves, colour) => texture(colour, gl.TEXTURE_3D, gl.LINEAR, () =>
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA16F, one.dims[0], one.dims[1], one.dims[2] * layers, 0, gl.RGBA, gl.HALF_FLOAT, new Uint16Array(halves))));
  const count = one.points.length;
  [0, 3].forEach((first, i) => texture(3 + i, gl.TEXTURE_2D, gl.NEAREST, () =>
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, count, 1, 0, gl.RGBA, gl.FLOAT, new Float32Array(one.points.flatMap((p) => [...p.slice(first, first + 3), 0])))));
  gl.uniform1iv(at("older"), [0, 1, 2]);
  gl.uniform1iv(at("newer"), [0, 1, 2]);
  gl.uniform1i(at("positions"), 3);
  gl.uniform1i(at("normals"), 4);
  gl.uniform3i(at("dims"), ...one.dims);
  gl.uniform1i(at("layers"), layers);
  gl.uniform1fv(at("olderScale"), one.scales);
  gl.uniform1fv(at("newerScale"), one.scales);
  gl.uniform1fv(at("weight"), one.scales.map(() => 1));
  gl.uniform3f(at("origin"), ...one.origin);
  gl.uniform1f(at("cellSize"), one.cellSize);
  gl.uniform1f(at("guard"), 0);
  gl.uniform1f(at("blend"), 1);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.bindRenderbuffer(gl.RENDERBUFFER, gl.createRenderbuffer());
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, count, 1);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, gl.canvas && gl.getParameter(gl.RENDERBUFFER_BINDING));
  gl.viewport(0, 0, count, 1);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Float32Array(4 * count);
  gl.readPixels(0, 0, count, 1, gl.RGBA, gl.FLOAT, pixels);
  if (gl.getError()) throw new Error("WebGL refused something");
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return Array.from(pixels);
}

// The largest difference over the larger of what is wanted and a hundredth of the volume's largest.
function difference(one, got) {
  const least = 0.01 * Math.max(...one.wanted.flat());
  let worst = 0;
  one.wanted.forEach((wanted, i) => wanted.forEach((value, c) => {
    const off = Math.abs(got[4 * i + c] - value);
    worst = Math.max(worst, Number.isFinite(off) ? off / Math.max(value, least) : Infinity);
  }));
  return worst;
}

// Broken by: positions that are not held within the outermost centres, a layer that reads the next one's cells, D with
// the wrong order of components, the first layer's scale for all.
test("the page looks volumes up as the server does", { timeout: 120_000 }, async () => {
  const page = await (await browser.newContext()).newPage();
  const lookup = await lookupOfPage();
  const worst = { exact: 0, filtered: 0 };
  for (const one of cases) {
    for (const kind of ["exact", "filtered"]) {
      const got = await page.evaluate(evaluate, { one, lookup, exact: kind === "exact" });
      worst[kind] = Math.max(worst[kind], difference(one, got));
    }
  }
  console.log(`${cases.length} random volumes: eight texels ${worst.exact.toExponential(2)}, filtered ${worst.filtered.toExponential(2)} off at the most`);
  assert.ok(worst.exact <= 1e-3, `eight texels: ${worst.exact}`);
});
