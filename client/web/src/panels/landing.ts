import { SessionService, type Session } from "../../gen/lpv/v1/session_pb.ts";
import { el } from "../dom.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { wordsOf } from "../net/errors.ts";
import { parsePasted, type Link } from "../net/link.ts";
import { demoRoom } from "../scene/demo.ts";
import { Editor } from "../scene/editor.ts";

// Before a session is chosen: says what this is, takes a link or token, lists sessions and makes one.
export class Landing {
  private readonly refusal = el("p", { class: "refusal", role: "alert" });
  private readonly sessions = el("div");
  private readonly making: HTMLButtonElement[];
  readonly element: HTMLElement;

  constructor(private readonly connection: Connection, private token: string, private readonly open: (link: Link) => void,
    private readonly tokenChanged: (token: string) => void) {
    const pasted = el("input", { type: "text", id: "pasted", "aria-label": "Link, token or session name", autocomplete: "off", placeholder: "Link, token or session name" });
    const take = (event: Event): void => {
      event.preventDefault();
      this.take(pasted.value);
    };
    this.making = [
      el("button", { class: "chief", id: "demo", onclick: () => void this.make(true) }, "Make the demo room"),
      el("button", { id: "empty", onclick: () => void this.make(false) }, "Make an empty session"),
    ];
    this.element = el("main", { class: "landing" },
      el("h1", {}, "Light in a room, shared"),
      el("p", {}, "This server computes the light of area lights in a scene and shows it to everyone who is in the session. Open a session to look around in it and, with an editor's access, to move its lights."),
      el("section", {}, el("h2", {}, "Open"), el("form", { onsubmit: take }, pasted, el("button", { type: "submit" }, "Open")),
        el("p", {}, "A link is sent to you by whoever owns the session. Its token stays in this tab.")),
      el("section", {}, el("h2", {}, "Sessions"), this.sessions),
      el("section", {}, el("h2", {}, "New"), el("div", { class: "row" }, ...this.making)),
      this.refusal);
    void this.list();
  }

  private take(text: string): void {
    const link = parsePasted(text);
    this.refusal.textContent = "";
    if (link.session) return this.open({ session: link.session, token: link.token || this.token });
    if (!link.token) {
      this.refusal.textContent = "This is neither a link nor a token nor the name of a session.";
      return;
    }
    this.token = link.token;
    this.tokenChanged(link.token);
    this.connection.useToken(link.token);
    void this.list();
  }

  private async list(): Promise<void> {
    try {
      const answer = await unary(this.connection, SessionService.method.listSessions, { pageSize: 100 });
      this.sessions.replaceChildren(answer.sessions.length > 0 ? this.table(answer.sessions) : el("p", {}, "There are none yet."));
    } catch (error) {
      this.sessions.replaceChildren(el("p", {}, wordsOf(error)));
    }
  }

  private table(sessions: Session[]): HTMLElement {
    const rows = sessions.map((session) => el("tr", {},
      el("td", {}, el("button", { onclick: () => this.open({ session: session.name, token: this.token }) }, session.name.replace("sessions/", ""))),
      el("td", {}, session.settings?.displayName ?? ""), el("td", {}, String(session.lightCount)),
      el("td", {}, String(session.surfaceCount)), el("td", {}, String(session.clientCount))));
    const head = el("tr", {}, ...["Session", "Name", "Lights", "Surfaces", "Members"].map((text) => el("th", { scope: "col" }, text)));
    return el("table", {}, el("thead", {}, head), el("tbody", {}, ...rows));
  }

  private async make(demo: boolean): Promise<void> {
    for (const button of this.making) button.disabled = true;
    try {
      const settings = demo ? { displayName: "Demo room" } : {};
      const { session, ownerToken } = await unary(this.connection, SessionService.method.createSession, { settings, requestId: requestId() });
      if (!session) throw new Error("The server made no session.");
      if (demo) await new Editor(this.connection, session.name).apply(demoRoom());
      this.open({ session: session.name, token: ownerToken || this.token });
    } catch (error) {
      this.refusal.textContent = wordsOf(error);
      for (const button of this.making) button.disabled = false;
    }
  }
}

// Of 16 random bytes; crypto.randomUUID is there on the loopback and with TLS only.
function requestId(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
