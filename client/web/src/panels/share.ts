import { Role, SessionService } from "../../gen/lpv/v1/session_pb.ts";
import { el } from "../dom.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { wordsOf } from "../net/errors.ts";
import { linkTo } from "../net/link.ts";

// Links by role, each with a token made for it; those that are good are listed and can be revoked.
export class ShareDialog {
  private readonly link = el("input", { type: "text", readonly: true, "aria-label": "Link" });
  private readonly list = el("table");
  private readonly said = el("p", { class: "quiet", role: "status" });
  readonly element = el("dialog", { "aria-label": "Share" }, el("h2", {}, "Share this session"),
    el("div", { class: "row" },
      el("button", { onclick: () => void this.make(Role.VIEWER) }, "Link for viewing"),
      el("button", { onclick: () => void this.make(Role.EDITOR) }, "Link for editing"), this.link),
    this.said, this.list, el("form", { method: "dialog" }, el("button", {}, "Close")));

  constructor(private readonly connection: Connection, private readonly session: string) {}

  open(): void {
    this.element.showModal();
    void this.refresh();
  }

  private async make(role: Role): Promise<void> {
    try {
      const { token } = await unary(this.connection, SessionService.method.createToken, { session: this.session, role });
      this.link.value = linkTo(location.href, { session: this.session, token });
      this.link.select();
      this.said.textContent = "Copy the link now: the server does not keep it. It is good for 30 days.";
      await this.refresh();
    } catch (error) {
      this.said.textContent = wordsOf(error);
    }
  }

  private async refresh(): Promise<void> {
    try {
      const { tokens } = await unary(this.connection, SessionService.method.listTokens, { session: this.session });
      this.list.replaceChildren(...tokens.map((token) => el("tr", {}, el("td", {}, token.tokenId), el("td", {}, Role[token.role].toLowerCase()),
        el("td", {}, `until ${new Date(Number(token.expireTime?.seconds ?? 0n) * 1000).toLocaleDateString()}`),
        el("td", {}, el("button", { onclick: () => void this.revoke(token.tokenId) }, "Revoke")))));
    } catch (error) {
      this.said.textContent = wordsOf(error);
    }
  }

  private async revoke(tokenId: string): Promise<void> {
    try {
      await unary(this.connection, SessionService.method.revokeToken, { session: this.session, tokenId });
      await this.refresh();
    } catch (error) {
      this.said.textContent = wordsOf(error);
    }
  }
}
