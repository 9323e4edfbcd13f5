import { el } from "../dom.ts";
import { wordsOf } from "../net/errors.ts";

const FEW = 3;

// What can be done about what is said.
export interface Choice {
  label: string;
  run: () => void;
}

// One line at the bottom that says why something was refused, in the server's words, or what was left out, until it is closed.
export class Words {
  private readonly text = el("span");
  private readonly choice = el("button", { hidden: true });
  readonly element = el("div", { class: "words", role: "alert", hidden: true }, this.text, this.choice,
    el("button", { onclick: () => this.clear() }, "Close"));

  say(message: string, choice?: Choice): void {
    this.text.textContent = message;
    this.choice.hidden = choice === undefined;
    this.choice.textContent = choice?.label ?? "";
    this.choice.onclick = choice?.run ?? null;
    this.element.hidden = false;
  }

  // The first of several sentences, and how many more there are; nothing where there are none.
  sayFew(messages: readonly string[], choice?: Choice): void {
    const more = messages.length - FEW;
    if (messages.length === 0) this.clear();
    else this.say([...messages.slice(0, FEW), ...(more > 0 ? [`There are ${more} more of the kind.`] : [])].join(" "), choice);
  }

  readonly refuse = (error: unknown): void => this.say(wordsOf(error));

  clear(): void {
    this.element.hidden = true;
  }
}
