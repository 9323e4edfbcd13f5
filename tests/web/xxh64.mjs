// XXH64 with seed 0, which results carry of what they say.
const MASK = (1n << 64n) - 1n;
const [P1, P2, P3, P4, P5] = [0x9e3779b185ebca87n, 0xc2b2ae3d27d4eb4fn, 0x165667b19e3779f9n, 0x85ebca77c2b2ae63n, 0x27d4eb2f165667c5n];
const turn = (value, bits) => ((value << bits) | (value >> (64n - bits))) & MASK;
const times = (a, b) => (a * b) & MASK;
const round = (state, lane) => times(turn((state + times(lane, P2)) & MASK, 31n), P1);

// Of bytes, as a BigInt.
export function xxh64(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  let hash = P5;
  if (bytes.length >= 32) {
    const states = [(P1 + P2) & MASK, P2, 0n, (1n << 64n) - P1];
    for (; at + 32 <= bytes.length; at += 32) states.forEach((state, i) => (states[i] = round(state, view.getBigUint64(at + 8 * i, true))));
    hash = states.reduce((sum, state, i) => sum + turn(state, [1n, 7n, 12n, 18n][i]), 0n) & MASK;
    for (const state of states) hash = (times(hash ^ round(0n, state), P1) + P4) & MASK;
  }
  hash = (hash + BigInt(bytes.length)) & MASK;
  for (; at + 8 <= bytes.length; at += 8) hash = (times(turn(hash ^ round(0n, view.getBigUint64(at, true)), 27n), P1) + P4) & MASK;
  if (at + 4 <= bytes.length) {
    hash = (times(turn(hash ^ times(BigInt(view.getUint32(at, true)), P1), 23n), P2) + P3) & MASK;
    at += 4;
  }
  for (; at < bytes.length; ++at) hash = times(turn(hash ^ times(BigInt(bytes[at]), P5), 11n), P1);
  hash = times(hash ^ (hash >> 33n), P2);
  hash = times(hash ^ (hash >> 29n), P3);
  return hash ^ (hash >> 32n);
}
