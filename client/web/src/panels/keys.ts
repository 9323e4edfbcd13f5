import { el } from "../dom.ts";

// Every action that has a key: what the list of `?` shows is what the page does.
export interface Action {
  keys: string; // as shown and as matched: "Ctrl+Z", "Delete", "g"
  does: string;
  run: () => void;
  edits?: boolean; // needs an editor's access
}

export const STEERING: readonly (readonly [string, string])[] = [
  ["W A S D, Q E", "fly, with the picture focused"],
  ["Arrows", "orbit, with the picture focused"],
  ["Arrows, Page Up, Page Down", "move, turn or scale what is selected by a step, after g, r or y; with Shift by a tenth of one"],
];

export function keyOf(event: KeyboardEvent): string {
  const command = event.ctrlKey || event.metaKey ? "Ctrl+" : "";
  const shift = event.shiftKey && event.key.length > 1 ? "Shift+" : "";
  return command ? `${command}${event.shiftKey ? "Shift+" : ""}${event.key.toUpperCase()}` : shift + event.key;
}

// True where the element takes letters itself.
export function takesText(target: EventTarget | null): boolean {
  return target instanceof HTMLInputElement && target.type !== "checkbox";
}

export function helpDialog(actions: readonly Action[]): HTMLDialogElement {
  const row = (keys: string, does: string): HTMLElement => el("tr", {}, el("td", {}, el("kbd", {}, keys)), el("td", {}, does));
  const dialog = el("dialog", { "aria-label": "Keys" }, el("h2", {}, "Keys"),
    el("table", {}, ...actions.map((action) => row(action.keys, action.does)), ...STEERING.map(([keys, does]) => row(keys, does))),
    el("p", { class: "quiet" }, "Pointer: drag orbits, with Shift or the right button pans, with Alt looks around; the wheel or two fingers come closer."),
    el("p", { class: "quiet" }, el("a", { href: "notices.txt", target: "_blank" }, "Licences of what this page contains")),
    el("form", { method: "dialog" }, el("button", {}, "Close")));
  return dialog;
}
