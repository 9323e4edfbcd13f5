import { el } from "../dom.ts";
import { wordsOf } from "../net/errors.ts";

// One line at the bottom that says why something was refused, in the server's words, until it is closed.
export class Words {
  private readonly text = el("span");
  readonly element = el("div", { class: "words", role: "alert", hidden: true }, this.text,
    el("button", { onclick: () => this.clear() }, "Close"));

  say(message: string): void {
    this.text.textContent = message;
    this.element.hidden = false;
  }

  readonly refuse = (error: unknown): void => this.say(wordsOf(error));

  clear(): void {
    this.element.hidden = true;
  }
}
