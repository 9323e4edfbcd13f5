import { el } from "../dom.ts";
import { wordsOf } from "../net/errors.ts";

const FEW = 3;

// One line at the bottom that says why something was refused, in the server's words, until it is closed.
export class Words {
  private readonly text = el("span");
  readonly element = el("div", { class: "words", role: "alert", hidden: true }, this.text,
    el("button", { onclick: () => this.clear() }, "Close"));

  say(message: string): void {
    this.text.textContent = message;
    this.element.hidden = false;
  }

  // The first of several sentences, and how many more there are; nothing where there are none.
  sayFew(messages: readonly string[]): void {
    const more = messages.length - FEW;
    if (messages.length === 0) this.clear();
    else this.say([...messages.slice(0, FEW), ...(more > 0 ? [`There are ${more} more of the kind.`] : [])].join(" "));
  }

  readonly refuse = (error: unknown): void => this.say(wordsOf(error));

  clear(): void {
    this.element.hidden = true;
  }
}
