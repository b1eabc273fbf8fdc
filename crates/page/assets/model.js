// The page for any model: keeps the state, asks for what it needs, shows what comes.

import { Refusal, ask } from "./ask.js";
import { Chain } from "./chain.js";
import { commands, pythonLines } from "./commands.js";
import { Diagrams } from "./diagram.js";
import { Editor } from "./editor.js";
import { byId, html, inFrames, numberIn } from "./element.js";
import { choose } from "./menu.js";
import { readable, sliderRange } from "./numbers.js";
import { PointView, parametersAt } from "./point.js";
import { showQuantities } from "./quantities.js";
import { showRows, stepRow } from "./rows.js";
import { give } from "./save.js";
import { startsAt } from "./starts.js";
import { freeName, pack, unpack, without } from "./state.js";
import { enter, listenToUndo, showProgress } from "./undo.js";

/**
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./diagram.js").Picked} Picked
 * @typedef {{
 *   states: Record<string, number>, parameters: Record<string, number>, along: import("./state.js").Interval | null,
 *   named_sets: {name: string, states: Record<string, number>, parameters: Record<string, number>}[], duration: number | null, time: import("./ask.js").Place | null,
 *   warnings: {message: string, place: import("./ask.js").Place}[],
 * }} Model what the server says of the text
 */

/** How long a slider waits for what it asked for before it asks for something else, in milliseconds. */
const LONG = 500;

/** @type {State} */
let state = { name: "model.ode", source: "", set: {}, start: {}, steps: [], shown: "" };
/** @type {Model | null} */
let model = null;
/** @type {Picked | null} */
let picked = null;
/** Whether what a slider asks for is being computed, and whether it has moved on since. */
let isFollowing = false;
let hasMoved = false;
let onMove = () => {};

const chain = new Chain(inFrames(showResults));
const editor = new Editor((source) => beginWith(editor.name, source));
const diagrams = new Diagrams(byId("diagrams"), "/api/diagram", {
  pick(point) {
    picked = point;
    showResults();
  },
  press(point) {
    picked = point;
    showResults();
    void startAt(point);
  },
});
const pointView = new PointView(byId("point"), {
  move(index) {
    if (!picked) return;
    const count = chain.results.get(picked.name)?.data?.points.length ?? 0;
    if (index >= 0) picked = { ...picked, index: Math.min(index, count - 1) };
    showResults();
  },
  start() {
    if (picked) void startAt(picked);
  },
});

/** @returns {State} a state with nothing but what the text says */
function fresh() {
  return { ...state, set: {}, start: {}, steps: [], shown: "", named: undefined };
}

/** Begins anew with a text, even with that which is there. @param {string} name @param {string} source */
function beginWith(name, source) {
  model = null;
  void change({ ...fresh(), name, source });
}

/** A state of an address, if it is one. @param {any} known @returns {State | null} */
function addressed(known) {
  return typeof known?.source === "string" && Array.isArray(known.steps) ? { ...fresh(), ...known } : null;
}

/** What a step asks the server. @param {Step} step @returns {import("./chain.js").Question} */
function question(step) {
  const { from } = step;
  const source = from ? { point: from } : { text: { name: state.name, source: state.source } };
  const chosen = from ? { source } : { source, named_set: state.named ?? null, set: state.set, start: state.start };
  const path = `/api/${step.kind}`;
  const names = from ? [from.path] : [];
  if (step.kind === "equilibria") return { path, request: { model: chosen, along: step.along }, from: names };
  if (step.kind === "cycles") return { path, request: { from, along: step.along, stay: step.stay ?? false }, from: names };
  if (step.kind === "locus") return { path, request: { from, in: step.plane }, from: names };
  return { path, request: { model: chosen, ...(step.duration ? { duration: step.duration } : {}) }, from: names };
}

/**
 * Goes to another state, with an entry in the history of the browser so that back is undo.
 * @param {State} next
 * @param {boolean} [isEntry]
 */
async function change(next, isEntry = true) {
  hasMoved = false;
  const isOther = next.source !== state.source || next.name !== state.name || !model;
  state = next;
  if (isOther) {
    chain.abort.abort();
    chain.results.clear();
    diagrams.reset();
    picked = null;
    model = null;
    editor.show(state.source, state.name);
    try {
      const answer = await ask("/api/model", { name: state.name, source: state.source });
      if (state !== next) return;
      if (answer.mistake) throw new Refusal(answer.mistake);
      model = /** @type {Model} */ (answer);
      const [warning] = model.warnings;
      if (warning) editor.mark(warning.place, warning.message);
    } catch (error) {
      if (state !== next) return;
      const problem = error instanceof Refusal ? error.problem : { message: "the server does not answer; is it still running?" };
      editor.mark(problem.place ?? null, problem.message);
    }
    complete();
  }
  document.body.classList.toggle("mistaken", !model);
  if (!model) {
    showResults();
    return;
  }
  void chain.run(state.steps, question);
  showModel();
  showResults();
  const text = `#${await pack(state)}`;
  // Who has gone on since has an address of its own.
  if (state === next && text !== location.hash) enter(text, isEntry);
}

/**
 * Follows a slider: what it asks for is computed to its end and shown, then what it asks for by then.
 * @param {State} next
 */
async function follow(next) {
  state = next;
  hasMoved = true;
  onMove();
  byId("lines").textContent = commands(state);
  byId("python-lines").textContent = pythonLines(state);
  if (isFollowing) return;
  isFollowing = true;
  while (hasMoved) {
    hasMoved = false;
    const hasMovedOn = new Promise((resolve) => (onMove = () => resolve(null)));
    const isLong = new Promise((resolve) => setTimeout(resolve, LONG));
    const computed = chain.run(state.steps, question);
    const { abort } = chain;
    await Promise.race([computed, Promise.all([hasMovedOn, isLong])]);
    if (abort.signal.aborted) break;
    showResults();
    await diagrams.shown();
  }
  isFollowing = false;
}

/** Fills in what a state that only has a text begins with. */
function complete() {
  if (!model) return;
  const names = Object.keys(model.states);
  state.shown = names.includes(state.shown) ? state.shown : (names[0] ?? "");
  if (state.steps.length) return;
  const [key] = Object.keys(model.parameters);
  if (model.time || key === undefined) {
    state.steps = [{ kind: "simulate", name: "simulate.json" }];
    return;
  }
  const [start, end] = sliderRange(model.parameters[key] ?? 0);
  state.steps = [{ kind: "equilibria", name: "equilibria.json", along: model.along ?? { key, start, end } }];
}

/** @param {State} next @param {boolean} rests whether the slider has come to rest */
function moved(next, rests) {
  void (rests ? change(next) : follow(next));
}

function showModel() {
  if (!model) return;
  const named = model.named_sets.find((other) => other.name === state.named);
  const [parameters, states] = [{ ...model.parameters, ...named?.parameters }, { ...model.states, ...named?.states }];
  const { set, start } = state;
  byId("named").hidden = !model.named_sets.length;
  byId("named-set").replaceChildren(html("option", { value: "" }, "the model itself"),
    ...model.named_sets.map(({ name }) => html("option", { value: name, selected: name === state.named }, `the set ${name}`)));
  const active = document.activeElement;
  // What is being moved must not be replaced under the hand.
  if (!byId("parameters").contains(active)) {
    const quantities = Object.entries(parameters).map(([key, value]) => ({ key, value: set[key] ?? value, range: sliderRange(value) }));
    showQuantities(byId("parameters"), quantities, (key, value, rests) => moved({ ...state, set: { ...state.set, [key]: value } }, rests));
  }
  if (!byId("states").contains(active)) {
    const quantities = Object.entries(states).map(([key, value]) => ({ key, value: start[key] ?? value }));
    showQuantities(byId("states"), quantities, (key, value, rests) => moved({ ...state, start: { ...state.start, [key]: value } }, rests));
  }
  /** @type {HTMLSelectElement} */
  const shown = byId("shown");
  shown.replaceChildren(...Object.keys(states).map((name) => html("option", { value: name, selected: name === state.shown }, name)));
  /** @type {HTMLSelectElement} */
  const key = byId("along-key");
  const along = state.steps.find((step) => step.kind === "equilibria" && !step.from)?.along ?? model.along;
  key.replaceChildren(...Object.keys(parameters).map((name) => html("option", { value: name, selected: name === along?.key }, name)));
  if (along) fillAlong(along.start, along.end);
}

/** @param {number} start @param {number} end */
function fillAlong(start, end) {
  /** @type {HTMLInputElement} */ (byId("along-start")).value = readable(start, 12);
  /** @type {HTMLInputElement} */ (byId("along-end")).value = readable(end, 12);
}

function showResults() {
  diagrams.update(state.steps, chain.results, state.shown, Object.keys(model?.states ?? {}), picked);
  const step = state.steps.find((other) => other.name === picked?.name);
  const result = picked && chain.results.get(picked.name);
  const others = state.steps.filter((other) => other !== step && other.kind !== "locus").flatMap(({ name }) => chain.results.get(name)?.data ?? []);
  if (step && result?.data?.points && picked) pointView.show({ name: state.name, source: state.source }, step, result, picked.index, others);
  else if (!result?.running) pointView.clear();
  showRows(byId("steps"), state.steps.map((step) => stepRow(step, chain.results.get(step.name), actions)));
  byId("stop").hidden = !chain.isRunning;
  const running = [...chain.results.values()].find((other) => other.running);
  byId("status").textContent = running ? `${running.name.replace(/\.json$/, "")}: ${running.points.length} points` : "";
  showProgress([...chain.results.values()].filter((other) => other.running).map((other) => other.progress));
  byId("lines").textContent = commands(state);
  byId("python-lines").textContent = pythonLines(state);
}

const actions = {
  path: "/api/diagram",
  hide: (/** @type {Step} */ step) => void change({ ...state, steps: state.steps.map((other) => (other === step ? { ...step, hidden: !step.hidden } : other)) }),
  remove: (/** @type {Step} */ step) => void change({ ...state, steps: without(state.steps, step.name) }),
  pick: (/** @type {Step} */ step, /** @type {number} */ index) => {
    picked = { name: step.name, index };
    showResults();
  },
  end: (/** @type {Step} */ step) => void startAt({ name: step.name, index: 0 }),
  keeps: () => true,
  paint: (/** @type {Step} */ step, /** @type {string | undefined} */ color) =>
    void change({ ...state, steps: state.steps.map((other) => (other === step ? { ...step, color } : other)) }),
};

/** Asks what is to start at a point and starts it. @param {Picked} point */
async function startAt({ name, index }) {
  const step = state.steps.find((other) => other.name === name);
  const data = chain.results.get(name)?.data;
  if (!step || !data || !model) return;
  const found = data.points?.[index];
  const label = step.kind === "simulate" ? "END" : found?.label;
  if (!label) return;
  const parameters = found ? parametersAt(data, found) : { ...data.parameters };
  const first = step.along ?? step.plane?.[0] ?? state.steps.find((other) => other.along)?.along ?? intervalOf(parameters, Object.keys(parameters)[0] ?? "");
  const second = step.plane?.[1] ?? intervalOf(parameters, Object.keys(parameters).find((key) => key !== first.key) ?? first.key);
  const isCycle = Boolean(found?.period) && step.kind !== "equilibria" && (step.kind !== "cycles" || (found.intervals ?? 0) > 0);
  const at = found ? `, ${Object.entries(parametersAt({ ...data, parameters: {} }, found)).map(([key, value]) => `${key} = ${readable(value, 7)}`).join(", ")}` : "";
  const duration = found?.period ? 5 * found.period : (model.duration ?? 20);
  const choice = await choose(`${label}${at}`, startsAt(step.kind, label, isCycle), parameters, [first, second], duration);
  if (!choice) return;
  const { start } = choice;
  /** @type {Step} */
  const next = { kind: start.kind, name: freeName(state.steps, start.kind), from: { path: name, label } };
  if (start.needs === "along") next.along = choice.along;
  if (start.needs === "plane") next.plane = choice.plane;
  if (start.needs === "duration") next.duration = choice.duration;
  if (start.stay) next.stay = true;
  await change({ ...state, steps: [...state.steps, next] });
}

/** A sensible interval of a parameter. @param {Record<string, number>} parameters @param {string} key */
function intervalOf(parameters, key) {
  const [start, end] = sliderRange(parameters[key] ?? 0);
  return { key, start, end };
}

listenToUndo();
byId("stop").addEventListener("click", () => chain.stop());
byId("shown").addEventListener("change", (event) => void change({ ...state, shown: /** @type {HTMLSelectElement} */ (event.target).value }));
byId("named-set").addEventListener("change", (event) => {
  const named = /** @type {HTMLSelectElement} */ (event.target).value || undefined;
  // What was set by hand would hide the values of the set.
  void change({ ...state, named, set: {}, start: {} });
});
byId("along-key").addEventListener("change", (event) => {
  const key = /** @type {HTMLSelectElement} */ (event.target).value;
  const named = model?.named_sets.find((other) => other.name === state.named)?.parameters[key];
  const [start, end] = sliderRange(state.set[key] ?? named ?? model?.parameters[key] ?? 0);
  fillAlong(start, end);
});
byId("along").addEventListener("submit", (event) => {
  event.preventDefault();
  const key = /** @type {HTMLSelectElement} */ (byId("along-key")).value;
  const [first, second] = [numberIn(byId("along-start")), numberIn(byId("along-end"))];
  if (first === null || second === null) return;
  const along = { key, start: Math.min(first, second), end: Math.max(first, second) };
  // Another question: what started from the answer to the old one would not fit.
  void change({ ...state, steps: [{ kind: "equilibria", name: "equilibria.json", along }] });
});
byId("simulate").addEventListener("click", () => {
  void change({ ...state, steps: [...state.steps, { kind: "simulate", name: freeName(state.steps, "simulate"), duration: model?.duration ?? 20 }] });
});
byId("save-model").addEventListener("click", () => give(new Blob([state.source], { type: "text/plain" }), state.name));
for (const [id, lines] of /** @type {[string, string][]} */ ([["copy", "lines"], ["copy-python", "python-lines"]])) {
  byId(id).addEventListener("click", () => void navigator.clipboard.writeText(byId(lines).textContent ?? ""));
}
addEventListener("popstate", async () => {
  const known = addressed(await unpack(location.hash.slice(1)));
  if (known) void change(known, false);
});

async function begin() {
  const [start, models, known] = await Promise.all([ask("/api/start"), ask("/api/gallery"), unpack(location.hash.slice(1))]);
  /** @type {HTMLSelectElement} */
  const gallery = byId("gallery");
  for (const entry of models) gallery.append(html("option", { value: entry.name }, entry.title));
  gallery.addEventListener("change", () => {
    const entry = models.find((/** @type {any} */ other) => other.name === gallery.value);
    gallery.value = "";
    if (entry) beginWith(entry.name, entry.source);
  });
  const first = start.model ?? models[0];
  await change(addressed(known) ?? { ...fresh(), name: first.name, source: first.source }, false);
}

void begin();
