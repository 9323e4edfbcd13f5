import assert from "node:assert/strict";
import { test } from "node:test";
import { linkTo, parseFragment, parsePasted, takeLink } from "../src/net/link.ts";

function storage(): Storage {
  const kept = new Map<string, string>();
  return {
    getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => void kept.set(key, value),
    removeItem: (key: string) => void kept.delete(key), clear: () => kept.clear(), key: () => null, length: 0,
  };
}

test("what links say is read back", () => {
  const link = { session: "sessions/room", token: "lpv_0123+/=&" };
  const text = linkTo("https://host/page#old", link);
  assert.equal(text.split("#")[0], "https://host/page");
  assert.deepEqual(parsePasted(text), link);
  assert.deepEqual(parsePasted(" lpv_x "), { session: "", token: "lpv_x" });
  assert.deepEqual(parsePasted("sessions/room"), { session: "sessions/room", token: "" });
  assert.equal(parseFragment("#session=../etc").session, "");
});

test("the token leaves address and history, and another session's token is not kept for this one", () => {
  const kept = storage();
  const replaced: string[] = [];
  const history = { replaceState: (_: unknown, __: string, url: string) => void replaced.push(url) } as unknown as History;
  const at = (hash: string) => ({ hash, pathname: "/", search: "" }) as Location;
  assert.deepEqual(takeLink(at("#session=a&token=lpv_1"), history, kept), { session: "sessions/a", token: "lpv_1" });
  assert.deepEqual(replaced, ["/"]);
  assert.deepEqual(takeLink(at(""), history, kept), { session: "sessions/a", token: "lpv_1" });
  assert.deepEqual(takeLink(at("#session=b"), history, kept), { session: "sessions/b", token: "" });
});
