const PATIENCE_MS = 150; // so long what is drawn waits for a picture

// What changes in the page with what is dragged, drawn once however often it is asked for: in the next animation frame.
// Without a GPU the browser composes the page in the time that pictures need, a twentieth of a second for the smallest
// change: there all is drawn together with the next picture, the server's or this browser's own.
export class Drawings {
  withPictures = false;
  private readonly due = new Set<() => void>();
  private timer: ReturnType<typeof setTimeout> | undefined;

  ask(draw: () => void): void {
    this.due.add(draw);
    if (this.due.size > 1) return;
    if (this.withPictures) this.timer = setTimeout(() => this.now(), PATIENCE_MS);
    else requestAnimationFrame(() => this.now());
  }

  // All that was asked for: what somebody waits for.
  now(): void {
    clearTimeout(this.timer);
    const due = [...this.due];
    this.due.clear();
    for (const draw of due) draw();
  }
}
