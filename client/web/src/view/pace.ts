// Between two pictures while something moves, ms.
const WANTED = 66;
const LATE = 90;
const EARLY = 45;
const STEPS = [1, 0.7, 0.5, 0.35, 0.25] as const;

// How much of width and height to ask for, so that pictures come often enough. Steps, not shades: a new size costs the
// server a picture of its own.
export class Pace {
  private settling = 0;

  // `share` is what was asked for, `since` the time between the last two pictures.
  next(share: number, since: number): number {
    if (this.settling > 0) {
      this.settling -= 1;
      return share;
    }
    const at = Math.max(0, STEPS.findIndex((step) => step <= share));
    let to = at;
    if (since > LATE) {
      const fits = share * Math.sqrt(WANTED / since);
      while (to + 1 < STEPS.length && (STEPS[to] ?? 0) > fits) to += 1;
    } else if (since < EARLY && at > 0 && since * ((STEPS[at - 1] ?? 1) / share) ** 2 < LATE) {
      to = at - 1;
    }
    if (to !== at) this.settling = 2;
    return STEPS[to] ?? share;
  }
}
