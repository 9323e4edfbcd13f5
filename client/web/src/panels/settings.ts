import {
  Gloss, Quality, SessionService, Transport, Visibility, type Session, type SessionSettings,
} from "../../gen/lpv/v1/session_pb.ts";
import type { MessageInitShape } from "@bufbuild/protobuf";
import type { SessionSettingsSchema } from "../../gen/lpv/v1/session_pb.ts";
import { el } from "../dom.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { wordsOf } from "../net/errors.ts";

type Settings = MessageInitShape<typeof SessionSettingsSchema>;

// What can be set, what it costs, and how it stands in a session.
interface Row {
  label: string;
  costs: string;
  path: string;
  choices: readonly (readonly [string, Settings])[];
  now(settings: SessionSettings): string; // one of the choices, or what else the session has
}

const percent = (share: number): string => `${Number((100 * share).toPrecision(3))} %`;
const named = (names: Record<number, string>, value: number): string => names[value] ?? String(value);

const ROWS: readonly Row[] = [
  {
    label: "Wanted error", costs: "A smaller one takes a finer grid, or looks at the lights themselves.", path: "settings.max_error",
    choices: [["3 %", { maxError: 0.03 }], ["1 %", { maxError: 0.01 }], ["10 %", { maxError: 0.1 }]],
    now: ({ maxError }) => percent(maxError ?? 0.03),
  },
  {
    label: "Shadows", costs: "Most of the time of a picture where there is no GPU.", path: "settings.visibility",
    choices: [["where something is in the way", { visibility: Visibility.AUTO }], ["on", { visibility: Visibility.ON }], ["off", { visibility: Visibility.OFF }]],
    now: ({ visibility }) => (visibility === Visibility.ON ? "on" : visibility === Visibility.OFF ? "off" : "where something is in the way"),
  },
  {
    label: "Bounces", costs: "Each costs about as much as the light itself.", path: "settings.bounces",
    choices: [["all", {}], ["none", { bounces: 0 }], ["1", { bounces: 1 }], ["2", { bounces: 2 }], ["3", { bounces: 3 }]],
    now: ({ bounces }) => (bounces === undefined ? "all" : bounces === 0 ? "none" : String(bounces)),
  },
  {
    label: "Gloss", costs: "Twice the time of a stream, three times that of a single picture.", path: "settings.gloss",
    choices: [["off", { gloss: Gloss.OFF }], ["on", { gloss: Gloss.ON }]],
    now: ({ gloss }) => (gloss === Gloss.ON ? "on" : "off"),
  },
  {
    label: "Haze", costs: "Three times the time of a stream where light bounces, four times that of a single picture.", path: "settings.haze",
    choices: [["none", { haze: 0 }], ["thin: a tenth in 5 m", { haze: 0.02 }], ["a tenth in 1 m", { haze: 0.1 }], ["thick: half in 1 m", { haze: 0.7 }]],
    now: ({ haze }) => ({ 0: "none", 0.02: "thin: a tenth in 5 m", 0.1: "a tenth in 1 m", 0.7: "thick: half in 1 m" })[haze] ?? `${haze} per metre`,
  },
  {
    label: "Quality", costs: "Accurate takes longer and has less noise.", path: "settings.quality",
    choices: [["fast", { quality: Quality.FAST }], ["accurate", { quality: Quality.ACCURATE }]],
    now: ({ quality }) => (quality === Quality.ACCURATE ? "accurate" : "fast"),
  },
  {
    label: "Transport", costs: "Propagate is the paper's: cheap, with a brightness that follows the grid.", path: "settings.transport",
    choices: [["the server's choice", { transport: Transport.AUTO }], ["gather", { transport: Transport.GATHER }],
      ["direct", { transport: Transport.DIRECT }], ["propagate", { transport: Transport.PROPAGATE }]],
    now: ({ transport }) =>
      named({ [Transport.AUTO]: "the server's choice", [Transport.GATHER]: "gather", [Transport.DIRECT]: "direct", [Transport.PROPAGATE]: "propagate" }, transport),
  },
];

// The session's settings, with what the server chose and why.
export class SettingsDialog {
  private readonly rows = el("div");
  private readonly choice = el("p", {});
  private readonly said = el("p", { class: "quiet", role: "status" });
  readonly element = el("dialog", { "aria-label": "Settings", id: "settings" }, el("h2", {}, "Settings of this session"), this.rows,
    el("h3", {}, "What the server chose"), this.choice, this.said, el("form", { method: "dialog" }, el("button", {}, "Close")));

  constructor(private readonly connection: Connection, private readonly session: string) {}

  open(mayEdit: boolean): void {
    this.element.showModal();
    void this.refresh(mayEdit);
  }

  private async refresh(mayEdit: boolean): Promise<void> {
    try {
      const { session } = await unary(this.connection, SessionService.method.getSession, { name: this.session });
      if (session) this.draw(session, mayEdit);
    } catch (error) {
      this.said.textContent = wordsOf(error);
    }
  }

  private draw(session: Session, mayEdit: boolean): void {
    const { settings } = session;
    if (!settings) return;
    this.rows.replaceChildren(...ROWS.map((row) => {
      const now = row.now(settings);
      const names = row.choices.map(([name]) => name);
      if (!names.includes(now)) names.push(now);
      const select = el("select", { disabled: !mayEdit, "aria-label": row.label }, ...names.map((name) => el("option", {}, name)));
      select.selectedIndex = names.indexOf(now);
      select.addEventListener("change", () => void this.set(row, select.selectedIndex, mayEdit));
      return el("div", { class: "group" }, el("label", { class: "row" }, el("span", {}, row.label), select), el("p", { class: "quiet" }, row.costs));
    }));
    const dims = session.grid?.dims;
    this.choice.textContent = [
      dims ? `${dims.x} x ${dims.y} x ${dims.z} cells.` : "", session.choice, `Expected error ${percent(session.expectedError)}.`,
      session.measuredError === undefined ? "" : `Measured ${percent(session.measuredError)}.`,
    ].filter(Boolean).join(" ");
  }

  private async set(row: Row, index: number, mayEdit: boolean): Promise<void> {
    const settings = row.choices[index]?.[1];
    if (!settings) return;
    this.said.textContent = "";
    try {
      const { session } = await unary(this.connection, SessionService.method.updateSession, {
        session: { name: this.session, settings }, updateMask: { paths: [row.path] },
      });
      if (session) this.draw(session, mayEdit);
    } catch (error) {
      this.said.textContent = wordsOf(error);
      await this.refresh(mayEdit);
    }
  }
}
