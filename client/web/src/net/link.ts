// Links as people share them: the session and the access token stand in the fragment, which browsers do not send.
export interface Link {
  session: string; // "sessions/{id}", or empty
  token: string;
}

const ID = /^[a-z][a-z0-9-]{0,62}$/;

export function sessionName(text: string): string {
  const id = text.trim().replace(/^sessions\//, "");
  return ID.test(id) ? `sessions/${id}` : "";
}

export function parseFragment(fragment: string): Link {
  const fields = new URLSearchParams(fragment.replace(/^#/, ""));
  return { session: sessionName(fields.get("session") ?? ""), token: (fields.get("token") ?? "").trim() };
}

// What people paste: a link, a token, or the name of a session.
export function parsePasted(text: string): Link {
  const trimmed = text.trim();
  const hash = trimmed.indexOf("#");
  if (hash >= 0) return parseFragment(trimmed.slice(hash));
  if (trimmed.startsWith("lpv_")) return { session: "", token: trimmed };
  return { session: sessionName(trimmed), token: "" };
}

export function linkTo(page: string, link: Link): string {
  const fields = new URLSearchParams({ session: link.session.replace(/^sessions\//, "") });
  if (link.token) fields.set("token", link.token);
  return `${page.split("#")[0]}#${fields}`;
}

// Takes the link from the address, and its secret out of address and history. Kept in this tab's storage only.
export function takeLink(location: Location, history: History, storage: Storage): Link {
  const given = parseFragment(location.hash);
  if (location.hash) history.replaceState(null, "", location.pathname + location.search);
  const link = {
    session: given.session || (storage.getItem("session") ?? ""),
    token: given.token || (given.session ? "" : (storage.getItem("token") ?? "")),
  };
  keepLink(link, storage);
  return link;
}

export function keepLink(link: Link, storage: Storage): void {
  storage.setItem("session", link.session);
  storage.setItem("token", link.token);
}
