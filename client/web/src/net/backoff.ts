// Pauses before attempts to connect again: doubled each time up to a bound, each shortened by up to a half at random so
// that many pages do not come at once.
export class Backoff {
  private attempt = 0;

  constructor(private readonly firstMs = 250, private readonly longestMs = 8000, private readonly random = Math.random) {}

  next(): number {
    const full = Math.min(this.longestMs, this.firstMs * 2 ** this.attempt);
    this.attempt += 1;
    return full * (1 - this.random() / 2);
  }

  reset(): void {
    this.attempt = 0;
  }
}
