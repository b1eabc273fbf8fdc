// The lines that compute what the page shows: of the command line and of Python.

/**
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./state.js").Interval} Interval
 */

/** @param {string} text */
function quoted(text) {
  return /^[\w./:=,+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** @param {Interval} interval */
function written({ key, start, end }) {
  return `${key}=${start}:${end}`;
}

/**
 * @param {State} state
 * @param {Step} step
 */
function command(state, step) {
  const words = ["arclength", step.kind];
  if (step.from) words.push("--from", `${step.from.path}:${step.from.label}`);
  else {
    words.push(state.name);
    if (state.named) words.push("--named-set", state.named);
    for (const [key, value] of Object.entries(state.set)) words.push("-s", `${key}=${value}`);
    const start = Object.entries(state.start).map(([key, value]) => `${key}=${value}`);
    if (start.length) words.push("--start", start.join(","));
  }
  if (step.stay) words.push("--stay");
  if (step.along) words.push("--along", written(step.along));
  if (step.plane) words.push("--in", step.plane.map(written).join(","));
  if (step.duration) words.push("--duration", String(step.duration));
  words.push("-o", step.name);
  return words.map(quoted).join(" ");
}

/**
 * The lines, in their order.
 * @param {State} state
 */
export function commands(state) {
  const lines = state.steps.map((step) => command(state, step));
  /** @type {Map<string, string[]>} */
  const diagrams = new Map();
  for (const step of state.steps) {
    const axes = step.plane ? step.plane.map((interval) => interval.key).join("-") : step.along?.key;
    if (axes && !step.hidden) diagrams.set(axes, [...(diagrams.get(axes) ?? []), step.name]);
  }
  for (const [axes, names] of diagrams) lines.push(`arclength show ${names.map(quoted).join(" ")} -o ${quoted(`${axes}.svg`)}`);
  return lines.join("\n");
}

/** A name of a variable for a result. @param {string} file */
function variable(file) {
  return file.replace(/\.json$/, "").replaceAll("-", "_");
}

/** @param {Interval} interval */
function tuple({ key, start, end }) {
  return `("${key}", ${start}, ${end})`;
}

/** @param {Record<string, number>} values */
function dictionary(values) {
  return `{${Object.entries(values).map(([key, value]) => `"${key}": ${value}`).join(", ")}}`;
}

/**
 * @param {State} state
 * @param {Step} step
 */
function call(state, step) {
  const { from, along, plane } = step;
  const words = [];
  if (along) words.push(`along=${tuple(along)}`);
  if (plane) words.push(...plane.map(tuple));
  if (step.duration) words.push(String(step.duration));
  if (step.stay) words.push("stay=True");
  if (!from && state.named) words.push(`named_set=${JSON.stringify(state.named)}`);
  if (!from && Object.keys(state.set).length) words.push(`set=${dictionary(state.set)}`);
  if (!from && Object.keys(state.start).length) words.push(`start=${dictionary(state.start)}`);
  const source = !from ? "model" : from.label === "END" ? `${variable(from.path)}.end` : `${variable(from.path)}["${from.label}"]`;
  return `${variable(step.name)} = ${source}.${step.kind}(${words.join(", ")})`;
}

/**
 * The lines of Python, in their order.
 * @param {State} state
 */
export function pythonLines(state) {
  return ["import arclength", "", `model = arclength.Model.from_ode(${JSON.stringify(state.name)})`, ...state.steps.map((step) => call(state, step))].join("\n");
}
