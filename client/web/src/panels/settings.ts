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
  chosen(settings: SessionSettings): number;
}

const pick = <T>(values: readonly T[], value: T): number => Math.max(0, values.indexOf(value));

const ROWS: readonly Row[] = [
  {
    label: "Wanted error", costs: "A smaller one takes a finer grid, or looks at the lights themselves.", path: "settings.max_error",
    choices: [["3 %", { maxError: 0.03 }], ["1 %", { maxError: 0.01 }], ["10 %", { maxError: 0.1 }]],
    chosen: ({ maxError }) => pick([0.03, 0.01, 0.1], maxError ?? 0.03),
  },
  {
    label: "Shadows", costs: "Most of the time of a picture where there is no GPU.", path: "settings.visibility",
    choices: [["where something is in the way", { visibility: Visibility.AUTO }], ["off", { visibility: Visibility.OFF }]],
    chosen: ({ visibility }) => (visibility === Visibility.OFF ? 1 : 0),
  },
  {
    label: "Bounces", costs: "Each costs about as much as the light itself.", path: "settings.bounces",
    choices: [["all", {}], ["none", { bounces: 0 }], ["1", { bounces: 1 }], ["2", { bounces: 2 }], ["3", { bounces: 3 }]],
    chosen: ({ bounces }) => (bounces === undefined ? 0 : Math.min(4, bounces + 1)),
  },
  {
    label: "Gloss", costs: "Twice the time of a stream, three times that of a single picture.", path: "settings.gloss",
    choices: [["off", { gloss: Gloss.OFF }], ["on", { gloss: Gloss.ON }]],
    chosen: ({ gloss }) => (gloss === Gloss.ON ? 1 : 0),
  },
  {
    label: "Quality", costs: "Accurate takes longer and has less noise.", path: "settings.quality",
    choices: [["fast", { quality: Quality.FAST }], ["accurate", { quality: Quality.ACCURATE }]],
    chosen: ({ quality }) => (quality === Quality.ACCURATE ? 1 : 0),
  },
  {
    label: "Transport", costs: "Propagate is the paper's: cheap, with a brightness that follows the grid.", path: "settings.transport",
    choices: [["the server's choice", { transport: Transport.AUTO }], ["gather", { transport: Transport.GATHER }],
      ["direct", { transport: Transport.DIRECT }], ["propagate", { transport: Transport.PROPAGATE }]],
    chosen: ({ transport }) => pick([Transport.AUTO, Transport.GATHER, Transport.DIRECT, Transport.PROPAGATE], transport),
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
      const select = el("select", { disabled: !mayEdit, "aria-label": row.label }, ...row.choices.map(([name]) => el("option", {}, name)));
      select.selectedIndex = row.chosen(settings);
      select.addEventListener("change", () => void this.set(row, select.selectedIndex, mayEdit));
      return el("div", { class: "group" }, el("label", { class: "row" }, el("span", {}, row.label), select), el("p", { class: "quiet" }, row.costs));
    }));
    const percent = (share: number): string => `${(100 * share).toFixed(2)} %`;
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
