// The page for a wheel: its verdict, its stability chart, its cycles, its motions.

import { Refusal, ask, askFile, listen } from "./ask.js";
import { Branches } from "./branches.js";
import { byId, html, numberIn } from "./element.js";
import { commandLines, pythonLines } from "./lines.js";
import { Motions } from "./motions.js";
import { readable, sliderRange } from "./numbers.js";
import { showPicture, showProblem } from "./picture.js";
import { showQuantities } from "./quantities.js";
import { give, saveMenu } from "./save.js";
import { pack, unpack } from "./state.js";
import { enter, listenToUndo, showProgress } from "./undo.js";
import { Zoom, isDark } from "./zoom.js";

/**
 * @typedef {number | "inf"} Value infinity has no number in JSON
 * @typedef {{key: string, start: number, end: number}} Interval
 * @typedef {{parameters: Record<string, Value>, tyre: string}} Wheel
 * @typedef {{wheel: Wheel, x: Interval, y: Interval, along: Interval, shimmy?: boolean, basin?: boolean, report?: boolean,
 *   steps?: import("./state.js").Step[], hidden?: boolean, color?: string | undefined}} State
 * what takes long is only computed where it is wanted; `steps` are the curves besides the first one, which may be hidden and have a colour
 * @typedef {{name: string, symbol: string, unit: string, meaning: string, lowest: number, highest: number, infinite: boolean,
 *   allowed: string, default: Value, of_the_tyre: boolean}} Key
 * @typedef {import("./diagram.js").Picture} Picture
 * @typedef {import("./above.js").Motion} Motion
 * @typedef {{request: any, text: string, data: any, picture: Picture | null, motions: Motion[], map: import("./plane.js").Map | null,
 *   warnings: string[]}} Answer
 */

/** Parameters that stand first. */
const FIRST = ["v", "l", "r", "k_u", "k_q", "c_q", "c_psi", "M_f"];
/** Numbers of points of a chart: at once, and when the sliders rest. */
const COARSE = [48, 30];
const FINE = [240, 141];
/** Time that the sliders must rest before something long begins, in milliseconds. */
const REST = 150;

/** @type {State} */
let state = { wheel: { parameters: {}, tyre: "rigid" }, x: interval("v", 0.1, 12), y: interval("l", 0.02, 0.3), along: interval("v", 0.2, 9) };
/** @type {Key[]} */
let keys = [];
/** What the numbers on the page belong to; all of it ends when the wheel is another. */
let abort = new AbortController();
/** @type {Map<string, {run: string, part: number | null}>} computations that run, with the number that stops each */
const running = new Map();
/** @type {Record<string, Answer | null>} */
const answers = { chart: null, shimmy: null, motion: null, basin: null };
/** What the verdict and the report said last. @type {any} */
let lastVerdict = null;
/** @type {Answer | null} */
let lastReport = null;
/** To what belongs each part of the page that is computed to its end. @type {Map<string, string>} */
const done = new Map();
/** Whether a slider moves and what it asks for is being computed, and whether it has moved on since. */
const glide = { isComputing: false, hasMoved: false };

const motions = new Motions({
  asked, valueOf, compute,
  changed: showCommands,
  keep(name, answer) {
    answers[name] = answer;
    byId(`${name}-tools`).hidden = !answer;
  },
  wantsBasin: () => state.basin ?? false,
  signal: () => abort.signal,
});

/** Which part of the picture of shimmy is seen. */
const shimmyZoom = new Zoom(() => void drawShimmy());
/** Which part of the chart is seen: its axes, which are computed anew. */
const chartZoom = new Zoom(() => {
  const { x, y } = chartZoom.window;
  const usual = about(state.wheel);
  const axis = (/** @type {Interval} */ old, /** @type {[number, number]} */ [start, end]) => {
    const key = keys.find((other) => other.name === old.key);
    return interval(old.key, Math.max(start, key?.lowest ?? start), Math.min(end, key?.highest ?? end));
  };
  void change({ ...state, x: x ? axis(state.x, x) : usual.x, y: y ? axis(state.y, y) : usual.y });
});
const branches = new Branches({
  asked, valueOf, wanted, motions, messageOf,
  first: () => ({ kind: "cycles", name: "cycles.json", along: state.along, hidden: state.hidden ?? false, color: state.color }),
  others: () => state.steps ?? [],
  keep: (steps, { hidden = false, color }) => void change({ ...state, steps, hidden, color }),
  range(key) {
    const known = keys.find((other) => other.name === key);
    return known ? rangeOf(known) : [0, 1];
  },
  names: () => keys.map((key) => key.name),
  take,
  changed: showStatus,
});

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

/** The keys in which the wheel is not the paper's. @returns {[string, Value][]} */
function changes() {
  const { parameters, tyre } = state.wheel;
  const changed = keys.filter((key) => key.name in parameters && (key.of_the_tyre || parameters[key.name] !== key.default));
  /** @type {[string, any][]} */
  const pairs = changed.map((key) => [key.name, parameters[key.name] ?? "inf"]);
  return tyre === "rigid" ? pairs : [["tyre", tyre], ...pairs];
}

/** The value at which a cycle is wanted: the wheel's own, where the branch passes it. */
function wanted() {
  const { key, start, end } = state.along;
  const own = valueOf(key);
  return own > start && own < end ? own : null;
}

function showCommands() {
  const shown = {
    changes: changes(), x: state.x, y: state.y, counts: FINE, along: state.along, at: wanted(), shimmy: state.shimmy ?? false, motion: motions.asked(),
    basin: state.basin ? motions.basinAsked() : null, report: state.report ?? false, steps: state.steps ?? [],
  };
  byId("lines").textContent = commandLines(shown);
  byId("python-lines").textContent = pythonLines(shown);
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
 * @param {AbortSignal} [signal]
 * @returns {Promise<Answer>}
 */
async function compute(name, path, request, signal = abort.signal) {
  /** @type {Answer} */
  const answer = { request, text: "", data: null, picture: null, motions: [], map: null, warnings: [] };
  /** @type {{run: string, part: number | null}} */
  const entry = { run: "", part: null };
  running.set(name, entry);
  showStatus();
  try {
    // Other routes have no picture.
    const look = ["chart", "shimmy"].includes(name) ? { look: { dark: isDark() } } : {};
    await listen(path, { request, ...look }, signal, (kind, text) => {
      if (kind === "run") entry.run = text;
      else if (kind === "progress") {
        entry.part = JSON.parse(text);
        showStatus();
      }
      else if (kind === "picture") answer.picture = JSON.parse(text);
      else if (kind === "motion") answer.motions.push(JSON.parse(text));
      else if (kind === "map") answer.map = JSON.parse(text);
      else if (kind === "warning") answer.warnings.push(text);
      else if (kind === "failure") throw new Refusal(JSON.parse(text).error);
      // A chart is a picture already; its numbers are only saved.
      else if (kind === "result") Object.assign(answer, { text, data: name === "chart" ? null : JSON.parse(text) });
    });
    if (!answer.text) throw new Refusal({ message: "it was stopped" });
    return answer;
  } finally {
    if (running.get(name) === entry) {
      running.delete(name);
      showStatus();
    }
  }
}

function showStatus() {
  const texts = [...running.keys(), ...branches.running];
  byId("status").textContent = texts.join(", ");
  byId("stop").hidden = texts.length === 0;
  showProgress([...running.values()].map(({ part }) => part));
}

/** @param {unknown} error */
function messageOf(error) {
  if (error instanceof Refusal) return error.problem.message;
  return error instanceof TypeError ? "the server does not answer; is it still running?" : String(error);
}

/**
 * Goes to another state and computes what belongs to it.
 * @param {State} next
 * @param {boolean} [isEntry] whether it is an entry in the history of the browser
 */
async function change(next, isEntry = true) {
  glide.hasMoved = false;
  abort.abort();
  abort = new AbortController();
  const { signal } = abort;
  running.clear();
  state = next;
  const { wheel, x, y, along } = state;
  const ofVerdict = JSON.stringify(wheel);
  const ofChart = JSON.stringify([wheel, x, y, isDark()]);
  const isOther = done.get("chart") !== ofChart;
  const verdict = once("verdict", ofVerdict, () => showVerdict(signal)).then(() => signal.aborted || motions.rested());
  const atOnce = Promise.all([verdict, isOther && showChart(signal, COARSE)]);
  showStatus();
  showFields();
  showCommands();
  const text = `#${await pack(state)}`;
  if (signal.aborted) return;
  if (text !== location.hash) enter(text, isEntry);
  try {
    await atOnce;
    // What is opened has no slider that moves on.
    if (isEntry && isOther) await new Promise((resolve) => setTimeout(resolve, REST));
    if (signal.aborted) return;
    leaveOut();
    const fine = once("chart", ofChart, () => showChart(signal, FINE));
    // After a slider the chart is what is looked at.
    if (isEntry) await fine;
    if (!signal.aborted) await Promise.all([fine, branches.show(signal)]);
    if (!signal.aborted && state.shimmy) await once("shimmy", JSON.stringify([wheel, along]), () => showShimmy(signal));
    if (!signal.aborted && state.basin) await once("basin", JSON.stringify([wheel, field("slides").checked]), () => motions.showBasin(signal));
    if (!signal.aborted && state.report) await once("report", ofVerdict, () => showReport(signal));
  } catch (error) {
    if (!signal.aborted) showProblem(byId("verdict"), messageOf(error));
  }
}

/** Shows no more what is not wanted any more. */
function leaveOut() {
  if (!state.shimmy && answers.shimmy) {
    done.delete("shimmy");
    keepShimmy(null);
    for (const id of ["shimmy-picture", "shimmy-notes"]) byId(id).replaceChildren();
  }
  if (!state.basin && answers.basin) {
    done.delete("basin");
    motions.withoutBasin();
  }
}

/** @param {Answer | null} answer */
function keepShimmy(answer) {
  answers.shimmy = answer;
  byId("shimmy-tools").hidden = !answer;
  shimmyZoom.window = {};
  motions.offer("shimmy", answer?.motions ?? []);
}

/**
 * Computes a part of the page, unless that is there.
 * @param {string} name
 * @param {string} key what it belongs to
 * @param {() => Promise<boolean>} show says whether it is there now
 */
async function once(name, key, show) {
  if (done.get(name) === key) return;
  done.delete(name);
  if (await show()) done.set(name, key);
}

/**
 * Follows a slider: computes what is fast, of the place where it is by then.
 * @param {State} next
 */
async function follow(next) {
  state = next;
  showFields();
  showCommands();
  glide.hasMoved = true;
  if (glide.isComputing) return;
  glide.isComputing = true;
  done.clear();
  abort.abort();
  abort = new AbortController();
  const { signal } = abort;
  running.clear();
  try {
    while (glide.hasMoved && !signal.aborted) {
      glide.hasMoved = false;
      await Promise.all([showVerdict(signal), showChart(signal, COARSE)]);
    }
  } catch (error) {
    if (!signal.aborted) showProblem(byId("verdict"), messageOf(error));
  } finally {
    glide.isComputing = false;
  }
}

/** @param {AbortSignal} signal @returns {Promise<boolean>} */
async function showVerdict(signal) {
  byId("wheel-problem").hidden = true;
  let verdict;
  try {
    verdict = await ask("/api/wheel/verdict", { request: asked() }, signal);
  } catch (error) {
    if (signal.aborted) return false;
    byId("wheel-problem").hidden = false;
    byId("wheel-problem").textContent = messageOf(error);
    byId("verdict").replaceChildren();
    byId("numbers").textContent = "";
    return false;
  }
  const { stable, critical_speed: critical, critical_speed_with_friction: withFriction, rolls } = verdict;
  const first = stable === null ? "Undecided whether small motions die out." : stable ? "Stable: small motions die out." : "Unstable: small motions grow.";
  const everywhere = stable === null ? "" : stable ? "At every speed at which the motion exists." : "At every speed.";
  const [low, high] = verdict.searched;
  const unchanged = verdict.closed_form ? everywhere : `No change was found from ${readable(low, 3)} to ${readable(high, 3)} m/s.`;
  const again = verdict.speeds.length > 2 ? ", and at higher speeds again" : "";
  const lines = [
    critical === null ? unchanged : `The stability changes at ${readable(critical, 5)} m/s${again}.`,
    rolls ? "The wheel rolls." : `The ground can supply only ${readable(verdict.normal_force * valueOf("mu_s"), 4)} N of the ${readable(verdict.friction_force, 4)} N that rolling needs: it slides.`,
  ];
  if (!stable && withFriction !== null) lines.push(`With dry friction about the king pin, however little, small motions die out up to ${readable(withFriction, 5)} m/s.`);
  if (Infinity === valueOf("r") && critical === null && stable === false && verdict.closed_form) lines[0] = "At every speed, without dry friction.";
  byId("verdict").replaceChildren(html("strong", {}, first), ` ${lines.join(" ")}`);
  byId("numbers").textContent = verdict.text;
  lastVerdict = verdict;
  // Their motions begin at another rest.
  done.delete("shimmy");
  done.delete("basin");
  motions.rest(verdict, state.wheel.tyre === "rigid");
  showCommands();
  return true;
}

/** @param {AbortSignal} signal @param {number[]} count @returns {Promise<boolean>} */
async function showChart(signal, count) {
  const sampled = (/** @type {Interval} */ axis, /** @type {number | undefined} */ points) => ({ ...axis, count: points });
  const box = byId("chart-picture");
  try {
    const answer = await compute("chart", "/api/wheel/chart", { ...asked(), x: sampled(state.x, count[0]), y: sampled(state.y, count[1]) });
    answers.chart = answer;
    if (!answer.picture) return false;
    showPicture(box, answer.picture, `Stability chart over ${state.x.key} and ${state.y.key}`, [valueOf(state.x.key), valueOf(state.y.key)], chartZoom, (x, y) => {
      const round = (/** @type {number} */ value) => Number(value.toPrecision(4));
      void change({ ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, [state.x.key]: round(x), [state.y.key]: round(y) } } });
    });
    box.dataset.points = String((count[0] ?? 0) * (count[1] ?? 0));
    return true;
  } catch (error) {
    if (!signal.aborted) showProblem(box, messageOf(error));
    return false;
  }
}

/** Takes the wheel to other values. @param {Record<string, number>} values */
async function take(values) {
  const rounded = Object.entries(values).map(([key, value]) => [key, Number(Number(value).toPrecision(6))]);
  await change({ ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, ...Object.fromEntries(rounded) } } });
}

/** Draws what is known of shimmy, as much of it as is seen. */
async function drawShimmy() {
  const { shimmy } = answers;
  if (!shimmy) return;
  const box = byId("shimmy-picture");
  const { window } = shimmyZoom;
  const { request, files } = askedOfShimmy(shimmy);
  try {
    const picture = await ask("/api/wheel/diagram", { request: { ...request, format: "page" }, files });
    // Who has zoomed on since, or has another result, sees that.
    if (shimmyZoom.window === window && answers.shimmy === shimmy) showShimmyPicture(picture);
  } catch (error) {
    showProblem(box, messageOf(error));
  }
}

/** @param {Picture} picture */
function showShimmyPicture(picture) {
  showPicture(byId("shimmy-picture"), picture, `Shimmy that remains along ${state.along.key}`, null, shimmyZoom, null);
}

/** What a picture of shimmy is asked with. @param {Answer} shimmy */
function askedOfShimmy({ text }) {
  return { request: { results: ["shimmy.json"], window: shimmyZoom.window, dark: isDark() }, files: { "shimmy.json": text } };
}

/** @param {AbortSignal} signal @returns {Promise<boolean>} */
async function showShimmy(signal) {
  const box = byId("shimmy-picture");
  const notes = byId("shimmy-notes");
  try {
    const answer = await compute("shimmy", "/api/wheel/shimmy", { ...asked(), along: state.along, at: wanted() === null ? [] : [wanted()] });
    keepShimmy(answer);
    if (answer.picture) showShimmyPicture(answer.picture);
    notes.replaceChildren(...labels(answer), ...answer.warnings.map((warning) => html("p", { class: "note" }, warning)));
    return true;
  } catch (error) {
    if (signal.aborted) return false;
    keepShimmy(null);
    showProblem(box, messageOf(error));
    notes.replaceChildren();
    return false;
  }
}

/** The labelled points of a branch as buttons that take the wheel there. @param {Answer} answer */
function labels(answer) {
  const { key } = state.along;
  const labelled = answer.data.points.filter((/** @type {any} */ point) => point.label && !/^EP/.test(point.label));
  return labelled.map((/** @type {any} */ point) => {
    const title = `${key} = ${readable(point.value, 7)}, period ${readable(point.period, 5)} s`;
    return html("button", { type: "button", class: "label", title, click: () => void take({ [key]: point.value }) }, `${point.label}, ${key} = ${readable(point.value, 4)}`);
  });
}

/** @param {AbortSignal} signal @returns {Promise<boolean>} */
async function showReport(signal) {
  const box = byId("findings");
  box.setAttribute("aria-busy", "true");
  try {
    lastReport = await compute("report", "/api/wheel/report", asked());
    const { data } = lastReport;
    box.replaceChildren(...data.findings.map((/** @type {any} */ finding) =>
      html("li", { class: finding.undecided ? "undecided" : null }, html("strong", {}, `${finding.subject}. `), finding.text, finding.undecided && html("em", {}, " Undecided."),
        finding.check && html("p", { class: "note" }, `Checked: ${finding.check}`))));
    return true;
  } catch (error) {
    if (!signal.aborted) box.replaceChildren(html("li", { class: "problem" }, messageOf(error)));
    return false;
  } finally {
    if (!signal.aborted) box.removeAttribute("aria-busy");
  }
}

function showFields() {
  field("basin").checked = state.basin ?? false;
  /** @type {HTMLDetailsElement} */ (byId("report")).open = state.report ?? false;
  byId("shimmy").classList.toggle("asked", state.shimmy ?? false);
  const shown = keys.filter((key) => key.name in state.wheel.parameters);
  const quantity = (/** @type {Key} */ key) => {
    const value = valueOf(key.name);
    return {
      key: key.name, symbol: key.symbol, value, note: key.unit === "1" ? "" : unitOf(key), title: `${key.meaning}; ${key.allowed}`, range: rangeOf(key),
      check: (/** @type {number} */ number) => ((number >= key.lowest && number <= key.highest) || (key.infinite && number === Infinity) ? "" : key.allowed),
    };
  };
  const moved = (/** @type {string} */ key, /** @type {number} */ value, /** @type {boolean} */ rests) => {
    const next = { ...state, wheel: { ...state.wheel, parameters: { ...state.wheel.parameters, [key]: /** @type {Value} */ (value === Infinity ? "inf" : value) } } };
    void (rests ? change(next) : follow(next));
  };
  const fill = (/** @type {string} */ id, /** @type {Key[]} */ list) => {
    // What is being moved must not be replaced under the hand.
    if (!byId(id).contains(document.activeElement)) showQuantities(byId(id), list.map(quantity), moved);
  };
  fill("parameters", shown.filter((key) => FIRST.includes(key.name)));
  fill("more", shown.filter((key) => !FIRST.includes(key.name)));
  for (const [id, axis] of /** @type {[string, Interval][]} */ ([["x", state.x], ["y", state.y], ["along", state.along]])) {
    byId(`${id}-key`).replaceChildren(...shown.map((key) => html("option", { value: key.name, selected: key.name === axis.key }, key.name === key.symbol ? key.name : `${key.name} (${plain(key.symbol)})`)));
    field(`${id}-start`).value = readable(axis.start, 6);
    field(`${id}-end`).value = readable(axis.end, 6);
  }
}

/** The unit as it is printed. @param {Key} key */
function unitOf(key) {
  return key.unit.replace("^2", "²");
}

/** A symbol without its index lowered. @param {string} symbol */
function plain(symbol) {
  return symbol.replace("_", "");
}

/** The range of a slider. @param {Key} key @returns {[number, number]} */
function rangeOf(key) {
  const value = valueOf(key.name);
  // What is not there yet should be able to come: dampers and friction begin small.
  const small = /** @type {Record<string, number>} */ ({ c_u: 1, c_q: 1, c_psi: 0.01, k_psi: 1, M_f: 0.05, F_Az: 20 })[key.name];
  const [low, high] = !Number.isFinite(value) ? [0.2, 5] : value === 0 ? [0, small ?? 1] : sliderRange(value);
  return [Math.max(low, key.lowest), Math.min(high, key.highest)];
}

/** An interval of the page; nothing where its ends are no numbers. @param {string} id */
function fields(id) {
  const [start, end] = [numberIn(field(`${id}-start`)), numberIn(field(`${id}-end`))];
  return start === null || end === null ? null : interval(field(`${id}-key`).value, start, end);
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
  const [x, y] = [fields("x"), fields("y")];
  if (x && y) void change({ ...state, x, y });
});
byId("along").addEventListener("submit", (event) => {
  event.preventDefault();
  const along = fields("along");
  if (along) void change({ ...state, along });
});
byId("stop").addEventListener("click", () => {
  for (const { run } of running.values()) if (run) ask("/api/stop", { run: Number(run) }).catch(() => {});
  branches.stop();
});
for (const [id, lines] of /** @type {[string, string][]} */ ([["copy", "lines"], ["copy-python", "python-lines"]])) {
  byId(id).addEventListener("click", () => void navigator.clipboard.writeText(byId(lines).textContent ?? ""));
}
listenToUndo();
byId("verdict-tools").append(saveMenu("the verdict", ["text", "json"], async (format) => {
  if (!lastVerdict) return;
  const { above, text, ...numbers } = lastVerdict;
  if (format === "text") give(new Blob([text], { type: "text/plain" }), "verdict.txt");
  else give(new Blob([JSON.stringify(numbers)], { type: "application/json" }), "verdict.json");
}));
byId("report-tools").append(saveMenu("the report", ["text", "json"], async (format) => {
  if (!lastReport) return;
  const told = lastReport.data.findings.map((/** @type {any} */ { subject, text, undecided, check }) => `${subject}. ${text}${undecided ? " Undecided." : ""}${check ? `\n  Checked: ${check}` : ""}`);
  if (format === "text") give(new Blob([`${told.join("\n")}\n`], { type: "text/plain" }), "report.txt");
  else give(new Blob([lastReport.text], { type: "application/json" }), "report.json");
}));
byId("follow-shimmy").addEventListener("click", () => void change({ ...state, shimmy: true }));
byId("basin").addEventListener("change", () => void change({ ...state, basin: field("basin").checked }));
byId("report").addEventListener("toggle", () => {
  const isOpen = /** @type {HTMLDetailsElement} */ (byId("report")).open;
  if (isOpen !== (state.report ?? false)) void change({ ...state, report: isOpen });
});
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
byId("chart-tools").append(chartZoom.buttons);
byId("shimmy-tools").append(shimmyZoom.buttons);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  void change(state, false);
  void drawShimmy();
});
for (const name of ["chart", "shimmy", "motion", "basin"]) {
  byId(`${name}-tools`).append(saveMenu(name, ["svg", "png", "pdf", "csv", "text", "json"], async (format) => {
    const answer = answers[name];
    if (!answer) return;
    give(await contentsOf(name, answer, format), `${name}.${format === "text" ? "txt" : format}`);
  }, name === "motion" ? "Save the motion…" : name === "basin" ? "Save the basins…" : undefined));
}
/** A result in a format. @param {string} name @param {Answer} answer @param {string} format */
function contentsOf(name, answer, format) {
  if (format === "json") return new Blob([answer.text]);
  if (name !== "shimmy" || format === "csv" || format === "text") return askFile("/api/wheel/save", { analysis: name, request: answer.request, format });
  // What is known is drawn as it is seen, and not computed again.
  const { request, files } = askedOfShimmy(answer);
  return askFile("/api/wheel/diagram", { request: { ...request, format }, files });
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
  await change(known?.wheel ? known : about(start.wheel), false);
}

void begin();
