import { el } from "../dom.ts";

const REST_MS = 1000; // between two looks at the picture, and for so long the camera has to rest
const SHOWN_MS = 12_000;
const SMALL = [16, 9] as const;
const BLACK = 4; // of 255: what JPEG makes of black
const MOST_LIT = 0.02; // of the pixels

// Says what a black picture is where there are lights: people have flown behind a wall. Quiet, and once until there is
// light again.
export class DarkHint {
  readonly element = el("p", { class: "hint", role: "status", hidden: true });
  private readonly small = el("canvas", { width: SMALL[0], height: SMALL[1] });
  private due: ReturnType<typeof setTimeout> | undefined;
  private gone: ReturnType<typeof setTimeout> | undefined;
  private said = false;

  // `lit`: whether there are lights that are on.
  constructor(private readonly picture: HTMLCanvasElement, private readonly lit: () => boolean) {}

  // There is a new picture, of the scene as it is.
  shown(): void {
    this.due ??= setTimeout(() => this.look(), REST_MS);
  }

  // The camera is not at rest.
  moving(): void {
    if (this.due === undefined) return;
    clearTimeout(this.due);
    this.due = setTimeout(() => this.look(), REST_MS);
  }

  // No pictures come any more.
  close(): void {
    clearTimeout(this.due);
    this.due = undefined;
    this.hide();
  }

  private look(): void {
    this.due = undefined;
    if (!this.lit() || !this.isBlack()) {
      this.said = false;
      return this.hide();
    }
    if (this.said) return;
    this.said = true;
    this.element.hidden = false;
    this.element.textContent = "You are looking at a side that no light reaches. Home (h) shows the first view again.";
    this.gone = setTimeout(() => this.hide(), SHOWN_MS);
  }

  private hide(): void {
    clearTimeout(this.gone);
    this.element.hidden = true;
  }

  private isBlack(): boolean {
    const [width, height] = SMALL;
    const context = this.small.getContext("2d", { willReadFrequently: true });
    if (!context) return false;
    context.drawImage(this.picture, 0, 0, width, height);
    const { data } = context.getImageData(0, 0, width, height);
    let lit = 0;
    for (let i = 0; i < data.length; i += 4) if (Math.max(data[i] ?? 0, data[i + 1] ?? 0, data[i + 2] ?? 0) > BLACK) lit += 1;
    return lit <= MOST_LIT * width * height;
  }
}
