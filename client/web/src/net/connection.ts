import { Backoff } from "./backoff.ts";
import { CallError, Code } from "./errors.ts";
import { Socket } from "./socket.ts";

export type ConnectionState =
  | { kind: "connecting" }
  | { kind: "open"; version: string; since: number }
  | { kind: "lost"; why: string; retryAt: number }
  | { kind: "refused"; why: string } // until another token is shown
  | { kind: "closed" };

const WELCOME_MS = 10_000;
const NO_TOKEN = 4401; // the server's close code: no good access token was shown

// Keeps one socket open: after a loss it tries again by itself, with growing pauses. Its state is what really is:
// "open" only after the server's welcome.
export class Connection {
  private socket: Socket | undefined;
  private wire: WebSocket | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private current: ConnectionState = { kind: "connecting" };
  private readonly backoff = new Backoff();
  private readonly listeners = new Set<(state: ConnectionState) => void>();
  bytesIn = 0;
  bytesOut = 0;

  constructor(private readonly address: string, private token: string) {
    this.open();
  }

  get state(): ConnectionState {
    return this.current;
  }

  onState(listener: (state: ConnectionState) => void): () => void {
    this.listeners.add(listener);
    listener(this.current);
    return () => this.listeners.delete(listener);
  }

  // The open socket, as soon as there is one.
  ready(signal?: AbortSignal): Promise<Socket> {
    if (this.current.kind === "open" && this.socket) return Promise.resolve(this.socket);
    return new Promise((resolve, reject) => {
      const giveUp = (): void => {
        this.listeners.delete(look);
        const refused = this.current.kind === "refused" ? this.current.why : "";
        reject(new CallError(refused ? Code.unauthenticated : Code.cancelled, refused || "The call was given up."));
      };
      const look = (state: ConnectionState): void => {
        if (state.kind === "closed" || state.kind === "refused") giveUp();
        if (state.kind !== "open" || !this.socket) return;
        this.listeners.delete(look);
        signal?.removeEventListener("abort", giveUp);
        resolve(this.socket);
      };
      if (signal?.aborted || this.current.kind === "closed" || this.current.kind === "refused") return giveUp();
      signal?.addEventListener("abort", giveUp, { once: true });
      this.listeners.add(look);
    });
  }

  // Calls that begin later show this token.
  useToken(token: string): void {
    this.token = token;
    if (this.current.kind === "open") this.socket?.hello(token); // else it is said when the socket opens
    else this.retryNow();
  }

  retryNow(): void {
    if (this.current.kind === "lost" || this.current.kind === "refused") this.open();
  }

  close(): void {
    clearTimeout(this.timer);
    this.become({ kind: "closed" });
    this.socket?.lose("The page has closed the connection.");
    this.wire?.close();
  }

  private open(): void {
    clearTimeout(this.timer);
    this.become({ kind: "connecting" });
    const wire = new WebSocket(this.address);
    wire.binaryType = "arraybuffer";
    const socket = new Socket(
      (bytes) => {
        this.bytesOut += bytes.length;
        wire.send(bytes as Uint8Array<ArrayBuffer>);
      },
      (welcome) => {
        if (this.current.kind === "open") return;
        clearTimeout(this.timer);
        this.backoff.reset();
        this.become({ kind: "open", version: welcome.version, since: Date.now() });
      },
    );
    this.wire = wire;
    this.socket = socket;
    this.timer = setTimeout(() => wire.close(), WELCOME_MS);
    wire.onopen = () => socket.hello(this.token);
    wire.onmessage = (event: MessageEvent<ArrayBuffer>) => {
      this.bytesIn += event.data.byteLength;
      socket.receive(new Uint8Array(event.data));
    };
    wire.onclose = (event) => this.lost(wire, socket, event.reason, event.code !== NO_TOKEN);
  }

  // Without `again` trying is of no use before there is another token.
  private lost(wire: WebSocket, socket: Socket, reason: string, again: boolean): void {
    if (this.wire !== wire) return;
    socket.lose(reason || "The connection to the server is lost.");
    if (this.current.kind === "closed") return;
    clearTimeout(this.timer);
    if (!again) return this.become({ kind: "refused", why: reason });
    const pause = this.backoff.next();
    this.become({ kind: "lost", why: reason || "no answer from the server", retryAt: Date.now() + pause });
    this.timer = setTimeout(() => this.open(), pause);
  }

  private become(state: ConnectionState): void {
    this.current = state;
    for (const listener of [...this.listeners]) listener(state);
  }
}
