// Chromium without a window, and what tests ask of a page that shows a room.
import { mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { PATIENCE, until } from "./server.mjs";

const SHOTS = process.env.LPV_SCREENSHOTS;
const SMALL = [128, 96];
const require = createRequire(pathToFileURL(join(process.env.LPV_PAGE_SOURCE, "package.json")));
const { chromium } = require("playwright-core");

export function launch() {
  mkdirSync(SHOTS, { recursive: true });
  return chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
}

export class RoomPage {
  errors = [];

  static async open(browser, address, given) {
    const room = new RoomPage();
    const context = given ?? (await browser.newContext({ viewport: { width: 1280, height: 720 } }));
    room.page = await context.newPage();
    room.page.setDefaultTimeout(PATIENCE);
    room.page.on("pageerror", (error) => room.errors.push(error.message));
    room.page.on("request", (request) => {
      if (!request.url().startsWith("blob:") && new URL(request.url()).hostname !== "127.0.0.1") room.errors.push(`request to ${request.url()}`);
    });
    await room.page.goto(address);
    return room;
  }

  async makeDemoRoom() {
    await this.page.click("#demo");
    await this.seesPicture();
  }

  get session() {
    return this.page.evaluate(() => sessionStorage.getItem("session").replace("sessions/", ""));
  }

  shows(text) {
    return this.page.locator("#state", { hasText: text }).waitFor();
  }

  shot(name) {
    return this.page.screenshot({ path: join(SHOTS, `${name}.png`) });
  }

  // Width and height of the picture, and red, green and blue, 0..255, of the picture made smaller.
  pixels() {
    return this.page.evaluate(([width, height]) => {
      const canvas = document.getElementById("picture");
      const context = new OffscreenCanvas(width, height).getContext("2d");
      context.drawImage(canvas, 0, 0, width, height);
      const { data } = context.getImageData(0, 0, width, height);
      return { width: canvas.width, height: canvas.height, rgb: Array.from(data.filter((_, i) => i % 4 !== 3)) };
    }, SMALL);
  }

  // The same of an encoded file, which the browser decodes.
  decode(file) {
    return this.page.evaluate(async ([text, [width, height]]) => {
      const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
      const picture = await createImageBitmap(new Blob([bytes]));
      const context = new OffscreenCanvas(width, height).getContext("2d");
      context.drawImage(picture, 0, 0, width, height);
      const { data } = context.getImageData(0, 0, width, height);
      return { width: picture.width, height: picture.height, rgb: Array.from(data.filter((_, i) => i % 4 !== 3)) };
    }, [file.toString("base64"), SMALL]);
  }

  seesPicture() {
    return until("the page shows the lit room", async () => {
      if ((await this.page.locator("#picture").count()) === 0) return false;
      return mean((await this.pixels()).rgb) > 30;
    });
  }

  eye() {
    return this.page.evaluate(() => lpvRoom.shading.view.eye);
  }

  // Presses a key until the camera has moved by so many metres. It is not held: a busy page would go round once and more.
  async steer(key, metres) {
    const before = await this.eye();
    await until(`${key} steers`, async () => {
      await this.page.keyboard.press(key, { delay: 100 });
      return apart(before, await this.eye()) > metres;
    });
  }

  async select(name) {
    await this.page.click(`[data-name="${name}"]`);
    await this.page.locator("#object-name").waitFor();
  }

  input(label) {
    return this.page.locator(`[aria-label="${label}"]`);
  }
}

export function apart(a, b) {
  return Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

export function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

// Of two pictures of any size, both made as small.
export function difference(a, b) {
  return mean(a.rgb.map((value, i) => Math.abs(value - b.rgb[i])));
}
