import { Backoff } from "./backoff.ts";
import { CallError, Code, wordsOf } from "./errors.ts";

// What no repetition makes good.
export const FINAL: readonly number[] = [Code.notFound, Code.permissionDenied, Code.unauthenticated, Code.invalidArgument];

// Keeps a stream of results open until `signal`: one that is lost is opened again, after pauses that grow while nothing
// comes; one that is refused for good is not. `follow` runs one stream and says whenever something has come.
export async function stayOpen(signal: AbortSignal, follow: (alive: () => void) => Promise<void>, trouble: (message: string) => void): Promise<void> {
  const backoff = new Backoff();
  while (!signal.aborted) {
    try {
      await follow(() => backoff.reset());
    } catch (error) {
      if (signal.aborted) return;
      if (!(error instanceof CallError) || error.code !== Code.unavailable) trouble(wordsOf(error));
      if (error instanceof CallError && FINAL.includes(error.code)) return;
    }
    await new Promise((resolve) => setTimeout(resolve, backoff.next()));
  }
}
