// What the page shows, as plain data, in its address: a copy of the address is a copy of the page.

/**
 * @typedef {{key: string, start: number, end: number}} Interval
 * @typedef {{path: string, label: string}} Reference
 * @typedef {{
 *   kind: "equilibria" | "cycles" | "locus" | "simulate", name: string, from?: Reference, along?: Interval,
 *   plane?: [Interval, Interval], stay?: boolean, duration?: number, hidden?: boolean, color?: string | undefined,
 * }} Step something that is computed; `name` is that of its result file, `color` that of its own, if it has one
 * @typedef {{
 *   name: string, source: string, set: Record<string, number>, start: Record<string, number>, steps: Step[], shown: string, named?: string,
 * }} State `shown` is the state on the vertical axis, `named` the named set of values that is taken before `set` and `start`
 */

/**
 * @param {BufferSource} bytes
 * @param {GenericTransformStream} stream
 */
async function through(bytes, stream) {
  // What is broken is told by what is read.
  const writer = stream.writable.getWriter();
  writer.write(bytes).catch(() => {});
  writer.close().catch(() => {});
  return new Uint8Array(await new Response(stream.readable).arrayBuffer());
}

/**
 * A state as text that may stand in an address.
 * @param {unknown} state
 */
export async function pack(state) {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  const packed = await through(bytes, new CompressionStream("deflate-raw"));
  const text = btoa(Array.from(packed, (byte) => String.fromCharCode(byte)).join(""));
  return text.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/**
 * The state in such a text; nothing where it is none.
 * @param {string} text
 * @returns {Promise<any>}
 */
export async function unpack(text) {
  if (!text) return null;
  try {
    const binary = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(binary, (character) => character.charCodeAt(0));
    return JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"))));
  } catch {
    return null;
  }
}

/**
 * A name for the result of the next step of a kind.
 * @param {{name: string}[]} steps
 * @param {string} kind
 */
export function freeName(steps, kind) {
  const taken = new Set(steps.map((step) => step.name));
  for (let number = 1; ; number++) {
    const name = number === 1 ? `${kind}.json` : `${kind}-${number}.json`;
    if (!taken.has(name)) return name;
  }
}

/**
 * The steps without one of them and what starts from it.
 * @template {{name: string, from?: Reference}} S
 * @param {S[]} steps
 * @param {string} name
 */
export function without(steps, name) {
  const gone = new Set([name]);
  for (const step of steps) if (step.from && gone.has(step.from.path)) gone.add(step.name);
  return steps.filter((step) => !gone.has(step.name));
}
