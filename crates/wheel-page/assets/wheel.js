// The page for a wheel: its verdict, its stability chart, its cycles, its motions.

import { Above } from "./above.js";
import { Refusal, ask, askFile, listen } from "./ask.js";
import { byId, html } from "./element.js";
import { extent, readable, sliderRange } from "./numbers.js";
import { showPicture, showProblem } from "./picture.js";
import { draw } from "./plot.js";
import { showQuantities } from "./quantities.js";
import { give, saveMenu } from "./save.js";
import { pack, unpack } from "./state.js";

/**
 * @typedef {number | "inf"} Value infinity has no number in JSON
 * @typedef {{key: string, start: number, end: number}} Interval
 * @typedef {{parameters: Record<string, Value>, tyre: string}} Wheel
 * @typedef {{wheel: Wheel, x: Interval, y: Interval, along: Interval}} State
 * @typedef {{name: string, symbol: string, unit: string, meaning: string, lowest: number, highest: number, infinite: boolean,
 *   allowed: string, default: Value, of_the_tyre: boolean}} Key
 * @typedef {import("./diagram.js").Picture} Picture
 * @typedef {{request: any, text: string, data: any, picture: Picture | null}} Answer
 */

/** Parameters that stand first. */
const FIRST = ["v", "l", "r", "k_u", "k_q", "c_q", "c_psi", "M_f"];
/** Numbers of points of a chart: at once, and when the sliders rest. */
const COARSE = [48, 30];
const FINE = [240, 141];
/** The fastest swing that an eye follows, in rad/s: what is faster is played slower. */
const SHOWN_SWING = 9;
/** Time that the sliders must rest before something long begins, in milliseconds. */
const REST = 250;

/** @type {State} */
let state = { wheel: { parameters: {}, tyre: "rigid" }, x: interval("v", 0.1, 12), y: interval("l", 0.02, 0.3), along: interval("v", 0.2, 9) };
/** @type {Key[]} */
let keys = [];
/** What the numbers on the page belong to; all of it ends when the wheel is another. */
let abort = new AbortController();
/** @type {Map<string, string>} computations that run, with the number that stops each */
const running = new Map();
/** @type {Record<string, Answer | null>} */
const answers = { chart: null, cycles: null, motion: null };
const above = new Above(byId("above"), (psi) => void release(psi - rest.psi));
/** Whether the user has said whether the wheel may slide. */
let hasChosen = false;
let rest = { u: 0, q: 0, psi: 0 };

/** @param {string} key @param {number} start @param {number} end @returns {Interval} */
function interval(key, start, end) {
  return { key, start: Math.min(start, end), end: Math.max(start, end) };
}

/** @param {string} key */
function valueOf(key) {
  const value = state.wheel.parameters[key];
  return value === "inf" ? Infinity : (value ?? NaN);
}

/** The wheel as requests have it. */
function asked() {
  const set = Object.entries(state.wheel.parameters).map(([key, value]) => ({ key, value: String(value) }));
  if (state.wheel.tyre !== "rigid") set.unshift({ key: "tyre", value: state.wheel.tyre });
  return { set };
}

/** The options that make the wheel from the paper's. */
function options() {
  const changed = keys.filter((key) => key.name in state.wheel.parameters && (key.of_the_tyre || state.wheel.parameters[key.name] !== key.default));
  const words = changed.map((key) => `-s ${key.name}=${state.wheel.parameters[key.name]}`);
  if (state.wheel.tyre !== "rigid") words.unshift(`-s tyre=${state.wheel.tyre}`);
  return words.map((word) => ` ${word}`).join("");
}

function showCommands() {
  const axis = (/** @type {Interval} */ { key, start, end }, /** @type {number | undefined} */ count) => `${key}=${start}:${end}${count ? `:${count}` : ""}`;
  byId("lines").textContent = [
    `kingpin steady${options()}`,
    `kingpin stability${options()}`,
    `kingpin chart${options()} --x ${axis(state.x, FINE[0])} --y ${axis(state.y, FINE[1])} -o chart.svg`,
    `kingpin cycles${options()} --along ${axis(state.along, undefined)} -o cycles.json -o cycles.svg`,
    `kingpin simulate${options()} --duration ${field("duration").value} --perturb psi=${field("kick").value}${field("slides").checked ? " --contact sliding" : ""} -o motion.json`,
  ].join("\n");
}

/** @param {string} id */
function field(id) {
  return /** @type {HTMLInputElement} */ (byId(id));
}

/**
 * Follows a computation to its result.
 * @param {string} name
 * @param {string} path
 * @param {any} request
 * @returns {Promise<Answer>}
 */
async function compute(name, path, request) {
  const { signal } = abort;
  /** @type {Answer} */
  const answer = { request, text: "", data: null, picture: null };
  running.set(name, "");
  showStatus();
  try {
    await listen(path, { request }, signal, (kind, text) => {
      if (kind === "run") running.set(name, text);
      else if (kind === "picture") answer.picture = JSON.parse(text);
      else if (kind === "failure") throw new Refusal(JSON.parse(text).error);
      else if (kind === "result") Object.assign(answer, { text, data: JSON.parse(text) });
    });
    if (!answer.data) throw new Refusal({ message: "it was stopped" });
    return answer;
  } finally {
    if (!signal.aborted) {
      running.delete(name);
      showStatus();
    }
  }
}

function showStatus() {
  byId("status").textContent = [...running.keys()].join(", ");
  byId("stop").hidden = running.size === 0;
}

/** @param {unknown} error */
function messageOf(error) {
  if (error instanceof Refusal) return error.problem.message;
  return error instanceof TypeError ? "the server does not answer; is it still running?" : String(error);
}

/**
 * Goes to another state and computes what belongs to it.
 * @param {State} next
 * @param {boolean} [rests] whether it is an entry in the history of the browser
 */
async function change(next, rests = true) {
  abort.abort();
  abort = new AbortController();
  const { signal } = abort;
  running.clear();
  state = next;
  showStatus();
  showFields();
  showCommands();
  if (rests) {
    const text = `#${await pack(state)}`;
    if (signal.aborted) return;
    if (text !== location.hash) history.pushState(null, "", text);
  }
  try {
    await Promise.all([showVerdict(signal), showChart(signal, COARSE)]);
    await new Promise((resolve) => setTimeout(resolve, REST));
    if (signal.aborted) return;
    await showChart(signal, FINE);
    if (!signal.aborted) await showCycles(signal);
  } catch (error) {
    if (!signal.aborted) showProblem(byId("verdict"), messageOf(error));
  }
}

/** @param {AbortSignal} signal */
async function showVerdict(signal) {
  byId("wheel-problem").hidden = true;
  let verdict;
  try {
    verdict = await ask("/api/wheel/verdict", { request: asked() }, signal);
  } catch (error) {
    if (signal.aborted) return;
    byId("wheel-problem").hidden = false;
    byId("wheel-problem").textContent = messageOf(error);
    byId("verdict").replaceChildren();
    byId("numbers").textContent = "";
    return;
  }
  const { stable, critical_speed: critical, critical_speed_with_friction: withFriction, rolls } = verdict;
  const first = stable === null ? "Undecided whether small motions die out." : stable ? "Stable: small motions die out." : "Unstable: small motions grow.";
  const everywhere = stable === null ? "" : stable ? "At every speed at which the motion exists." : "At every speed.";
  const lines = [
    critical === null ? everywhere : `The stability changes at ${readable(critical, 5)} m/s.`,
    rolls ? "The wheel rolls." : `The ground can supply only ${readable(verdict.normal_force * valueOf("mu_s"), 4)} N of the ${readable(verdict.friction_force, 4)} N that rolling needs: it slides.`,
  ];
  if (!stable && withFriction !== null) lines.push(`With dry friction about the king pin, however little, small motions die out up to ${readable(withFriction, 5)} m/s.`);
  if (Infinity === valueOf("r") && critical === null && stable === false) lines[0] = "At every speed, without dry friction.";
  byId("verdict").replaceChildren(html("strong", {}, first), ` ${lines.join(" ")}`);
  byId("numbers").textContent = verdict.text;
  rest = { u: verdict.state.u ?? 0, q: verdict.state.q ?? 0, psi: verdict.state.psi ?? 0 };
  // A wheel that rolls in its uniform motion may slide when it is kicked; one with a tyre has a law of its own.
  if (!hasChosen) field("slides").checked = rolls && state.wheel.tyre === "rigid";
  showCommands();
  const swing = Math.max(...verdict.eigenvalues.map((/** @type {[number, number]} */ [, im]) => Math.abs(im)));
  above.speed = swing > SHOWN_SWING ? SHOWN_SWING / swing : 1;
  byId("slowness").textContent = above.speed < 1 ? `It plays ${readable(1 / above.speed, 2)} times slower than it moves.` : "";
  above.play(null);
  above.show({ l: valueOf("l"), R: valueOf("R"), r: valueOf("r") }, rest);
}

/** @param {AbortSignal} signal @param {number[]} count */
async function showChart(signal, count) {
  const sampled = (/** @type {Interval} */ axis, /** @type {number | undefined} */ points) => ({ ...axis, count: points });
  const box = byId("chart-picture");
  try {
    const answer = await compute("chart", "/api/wheel/chart", { ...asked(), x: sampled(state.x, count[0]), y: sampled(state.y, count[1]) });
    answers.chart = answer;
    if (!answer.picture) return;
    showPicture(box, answer.picture, `Stability chart over ${state.x.key} and ${state.y.key}`, [valueOf(state.x.key), valueOf(state.y.key)], (x, y) => {
      const round = (/** @type {number} */ value) => Number(value.toPrecision(4));
      void change({ ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, [state.x.key]: round(x), [state.y.key]: round(y) } } });
    });
    box.dataset.points = String((count[0] ?? 0) * (count[1] ?? 0));
  } catch (error) {
    if (!signal.aborted) showProblem(box, messageOf(error));
  }
}

/** @param {AbortSignal} signal */
async function showCycles(signal) {
  const box = byId("diagram-picture");
  const notes = byId("diagram-notes");
  try {
    const answer = await compute("cycles", "/api/wheel/cycles", { ...asked(), along: state.along });
    answers.cycles = answer;
    if (answer.picture) showPicture(box, answer.picture, `Limit cycles along ${state.along.key}`, null, null);
    const labelled = answer.data.points.filter((/** @type {any} */ point) => point.label && !/^EP/.test(point.label));
    notes.replaceChildren(...labelled.map((/** @type {any} */ point) =>
      html("button", { type: "button", class: "label", title: `${state.along.key} = ${readable(point.value, 7)}, period ${readable(point.period, 5)} s`, click: () => take(point) }, `${point.label}, ${state.along.key} = ${readable(point.value, 4)}`)));
    box.dataset.done = "yes";
  } catch (error) {
    if (signal.aborted) return;
    answers.cycles = null;
    showProblem(box, messageOf(error));
    notes.replaceChildren();
    box.dataset.done = "yes";
  }
}

/** Takes the wheel to a point of a branch. @param {any} point */
function take(point) {
  const { key } = state.along;
  void change({ ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, [key]: Number(Number(point.value).toPrecision(6)) } } });
}

/** Lets the caster go at an angle from the uniform motion. @param {number} psi */
async function release(psi) {
  field("kick").value = readable(psi, 3);
  showCommands();
  const duration = Number(field("duration").value);
  const note = byId("motion-note");
  try {
    const answer = await compute("motion", "/api/wheel/simulate", { ...asked(), duration, perturb: { psi }, points: 2001, contact: field("slides").checked ? "sliding" : "rolling" });
    answers.motion = answer;
    byId("motion-tools").hidden = false;
    const { data } = answer;
    above.play({ t: data.t, u: data.u ?? data.t.map(() => 0), q: data.q, psi: data.psi });
    const away = data.psi.map((/** @type {number} */ value) => Math.abs(value - rest.psi));
    const last = Math.max(...away.slice(Math.floor(0.9 * away.length)));
    note.textContent = `In the last tenth of ${readable(duration)} s the caster is up to ${readable(last, 3)} rad from rest; it was let go at ${readable(Math.abs(psi), 3)} rad.`;
    const curve = data.t.map((/** @type {number} */ time, /** @type {number} */ index) => [time, data.psi[index]]);
    const [low, high] = extent(data.psi);
    const plot = draw({ description: "caster angle over the time", curves: [{ points: curve, kind: "cycle" }], x: { label: "t (s)", low: 0, high: duration }, y: { label: "ψ (rad)", low, high } });
    byId("history").replaceChildren(plot.element);
  } catch (error) {
    if (!abort.signal.aborted) note.textContent = messageOf(error);
  }
}

function showFields() {
  const shown = keys.filter((key) => key.name in state.wheel.parameters);
  const quantity = (/** @type {Key} */ key) => {
    const value = valueOf(key.name);
    return {
      key: key.name, value, note: key.unit === "1" ? "" : key.unit, title: `${key.meaning}; ${key.allowed}`, range: rangeOf(key),
      check: (/** @type {number} */ number) => ((number >= key.lowest && number <= key.highest) || (key.infinite && number === Infinity) ? "" : key.allowed),
    };
  };
  const moved = (/** @type {string} */ key, /** @type {number} */ value, /** @type {boolean} */ rests) =>
    void change({ ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, [key]: value === Infinity ? "inf" : value } } }, rests);
  const fill = (/** @type {string} */ id, /** @type {Key[]} */ list) => {
    // What is being moved must not be replaced under the hand.
    if (!byId(id).contains(document.activeElement)) showQuantities(byId(id), list.map(quantity), moved);
  };
  fill("parameters", shown.filter((key) => FIRST.includes(key.name)));
  fill("more", shown.filter((key) => !FIRST.includes(key.name)));
  for (const [id, axis] of /** @type {[string, Interval][]} */ ([["x", state.x], ["y", state.y], ["along", state.along]])) {
    byId(`${id}-key`).replaceChildren(...shown.map((key) => html("option", { value: key.name, selected: key.name === axis.key }, key.name)));
    field(`${id}-start`).value = readable(axis.start, 6);
    field(`${id}-end`).value = readable(axis.end, 6);
  }
}

/** The range of a slider. @param {Key} key @returns {[number, number]} */
function rangeOf(key) {
  const value = valueOf(key.name);
  // What is not there yet should be able to come: dampers and friction begin small.
  const small = /** @type {Record<string, number>} */ ({ c_u: 1, c_q: 1, c_psi: 0.01, k_psi: 1, M_f: 0.05, F_Az: 20 })[key.name];
  const [low, high] = !Number.isFinite(value) ? [0.2, 5] : value === 0 ? [0, small ?? 1] : sliderRange(value);
  return [Math.max(low, key.lowest), Math.min(high, key.highest)];
}

/** An interval of the page. @param {string} id */
function fields(id) {
  return interval(field(`${id}-key`).value, Number(field(`${id}-start`).value), Number(field(`${id}-end`).value));
}

/** Axes that suit a wheel. @param {Wheel} wheel @returns {State} */
function about(wheel) {
  const number = (/** @type {string} */ key) => (wheel.parameters[key] === "inf" ? Infinity : Number(wheel.parameters[key]));
  const round = (/** @type {number} */ value) => Number(value.toPrecision(3));
  const speed = round(3 * number("v"));
  return { wheel, x: interval("v", round(speed / 100), speed), y: interval("l", round(number("l") / 4), round(number("l") * 3.75)), along: interval("v", round(speed / 60), round(0.75 * speed)) };
}

for (const id of ["x", "y", "along"]) {
  byId(`${id}-key`).addEventListener("change", () => {
    const key = keys.find((other) => other.name === field(`${id}-key`).value);
    if (!key) return;
    const [low, high] = rangeOf(key);
    field(`${id}-start`).value = readable(low, 6);
    field(`${id}-end`).value = readable(high, 6);
  });
}
byId("axes").addEventListener("submit", (event) => {
  event.preventDefault();
  void change({ ...state, x: fields("x"), y: fields("y") });
});
byId("along").addEventListener("submit", (event) => {
  event.preventDefault();
  void change({ ...state, along: fields("along") });
});
byId("stop").addEventListener("click", () => {
  for (const run of running.values()) if (run) ask("/api/stop", { run: Number(run) }).catch(() => {});
});
byId("slides").addEventListener("change", () => {
  hasChosen = true;
  showCommands();
});
byId("let-go").addEventListener("click", () => void release(Number(field("kick").value)));
byId("play").addEventListener("click", () => {
  above.isPlaying = !above.isPlaying;
  byId("play").textContent = above.isPlaying ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(!above.isPlaying));
});
byId("copy").addEventListener("click", () => void navigator.clipboard.writeText(byId("lines").textContent ?? ""));
byId("save-wheel").addEventListener("click", () => {
  const written = (/** @type {Value} */ value) => (value === "inf" ? "inf" : String(value));
  const lines = Object.entries(state.wheel.parameters).map(([key, value]) => `${key} = ${written(value)}`);
  if (state.wheel.tyre !== "rigid") lines.unshift(`tyre = "${state.wheel.tyre}"`);
  give(new Blob([`${lines.join("\n")}\n`], { type: "text/plain" }), "wheel.toml");
});
field("file").addEventListener("change", async () => {
  const file = field("file").files?.[0];
  field("file").value = "";
  if (!file) return;
  try {
    await change(about(await ask("/api/wheel", { text: await file.text() })));
  } catch (error) {
    byId("wheel-problem").hidden = false;
    byId("wheel-problem").textContent = `${file.name}: ${messageOf(error)}`;
  }
});
for (const name of ["chart", "cycles", "motion"]) {
  byId(`${name}-tools`).append(saveMenu(name, ["svg", "png", "pdf", "csv", "text", "json"], async (format) => {
    const answer = answers[name];
    if (!answer) return;
    const contents = format === "json" ? new Blob([answer.text]) : await askFile("/api/wheel/save", { analysis: name, request: answer.request, format });
    give(contents, `${name}.${format === "text" ? "txt" : format}`);
  }));
}
addEventListener("popstate", async () => {
  const known = await unpack(location.hash.slice(1));
  if (known?.wheel) void change(known, false);
});

async function begin() {
  const [start, allKeys, wheels, known] = await Promise.all([ask("/api/start"), ask("/api/keys"), ask("/api/wheels"), unpack(location.hash.slice(1))]);
  keys = allKeys;
  /** @type {HTMLSelectElement} */
  const list = byId("wheels");
  wheels.forEach((/** @type {any} */ entry, /** @type {number} */ index) => list.append(html("option", { value: String(index) }, entry.title)));
  list.addEventListener("change", () => {
    const entry = wheels[Number(list.value)];
    list.value = "";
    if (entry) void change(about(entry.wheel));
  });
  await change(known?.wheel ? known : about(start.wheel));
}

void begin();
