// A point of a branch beside the diagram: its numbers, its eigenvalues or multipliers, its orbit in the phase plane and over the time.

import { Refusal, listen } from "./ask.js";
import { captureMenu, columnsOf } from "./capture.js";
import { html } from "./element.js";
import { complex, extent, readable } from "./numbers.js";
import { INNER, draw } from "./plot.js";
import { labelKind } from "./starts.js";

/**
 * @typedef {import("./chain.js").Result} Result
 * @typedef {import("./chain.js").FoundPoint} FoundPoint
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./plot.js").Point} Point
 * @typedef {{points: Point[], kind: string}} Extra a curve in the phase plane beside the orbit
 */

/** What a special point has of its normal form, with its name. */
const OF_NORMAL_FORMS = /** @type {const} */ ([
  ["frequency", "frequency"], ["first_lyapunov", "first Lyapunov coefficient"], ["criticality", "criticality"], ["quadratic", "quadratic coefficient"],
  ["cubic", "cubic coefficient"],
]);
/** How many times the width that the points of a branch need the phase plane may have to show motions. */
const WIDEST = 3;

/** All parameters at a point of a result. @param {any} data @param {any} point @returns {Record<string, number>} */
export function parametersAt(data, point) {
  const parameters = { ...data.parameters };
  if (data.along) parameters[data.along.key] = point.value;
  else if (data.in) data.in.forEach((/** @type {any} */ varying, /** @type {number} */ index) => (parameters[varying.key] = point.values[index]));
  return parameters;
}

/** The orbit of a cycle as it came while the branch grew. @param {Result} result @param {any} point */
function orbitOf(result, point) {
  const value = point.value ?? point.values[0];
  /** @type {FoundPoint | null} */
  let nearest = null;
  let least = Infinity;
  for (const found of result.points) {
    if (!found.orbit) continue;
    const distance = Math.hypot((found.values[0] ?? NaN) - value, found.orbit.period - point.period);
    if (distance < least) [least, nearest] = [distance, found];
  }
  return nearest?.orbit ?? null;
}

export class PointView {
  /**
   * @param {HTMLElement} box
   * @param {{move: (index: number) => void, start: () => void}} listener
   */
  constructor(box, listener) {
    this.box = box;
    this.listener = listener;
    /** States on the axes of the phase plane. @type {[string, string] | null} */
    this.axes = null;
    /** @type {Extra[]} */
    this.extras = [];
    /** What of the field is shown in the phase plane, and the window that it is of. @type {Set<"nullcline" | "direction">} */
    this.wanted = new Set();
    this.windowOfField = "";
    this.where = "";
    this.abort = new AbortController();
  }

  /** Leaves out what was added to the phase plane. */
  forget() {
    Object.assign(this, { extras: [], wanted: new Set(), windowOfField: "" });
  }

  clear() {
    this.box.replaceChildren(html("p", { class: "hint" }, "Press a label to start something there; press a curve to see its points here."));
    this.where = "";
  }

  /**
   * @param {{name: string, source: string} | null} model without, there is no phase plane
   * @param {Step} step
   * @param {Result} result
   * @param {number} index
   * @param {any[]} others results of the same model, for the window of the phase plane
   */
  show(model, step, result, index, others) {
    const point = result.data.points[index];
    if (!point) return this.clear();
    const where = `${result.key}:${index}`;
    if (where !== this.where) {
      this.abort.abort();
      this.abort = new AbortController();
      this.forget();
    }
    this.where = where;
    const states = Object.keys(point.state ?? point.max ?? {});
    const orbit = point.period ? orbitOf(result, point) : null;
    const parameters = parametersAt(result.data, point);
    const varying = result.data.along ? [result.data.along.key] : result.data.in.map((/** @type {any} */ other) => other.key);
    const focused = document.activeElement?.id === "along-branch";
    const slider = html("input", {
      id: "along-branch", type: "range", min: 0, max: result.data.points.length - 1, step: 1, value: index, "aria-label": "along the branch",
      input: (/** @type {Event} */ event) => this.listener.move(Number(/** @type {HTMLInputElement} */ (event.target).value)),
    });
    const rows = html("dl");
    const row = (/** @type {string} */ name, /** @type {string} */ value) => rows.append(html("dt", {}, name), html("dd", {}, value));
    for (const key of varying) row(key, readable(parameters[key], 12));
    if (point.period) row("period", readable(point.period, 12));
    if ("stable" in point) row("stability", point.stable === null ? (point.label && !["EP", "AT"].includes(labelKind(point.label)) ? "at a bifurcation" : "undecided") : point.stable ? "stable" : "unstable");
    if (point.error_estimate !== undefined) row("error estimate", readable(point.error_estimate, 2));
    for (const name of states) row(name, point.state ? readable(point.state[name]) : `${readable(point.min[name], 7)} to ${readable(point.max[name], 7)}`);
    for (const [name, value] of Object.entries(point.normal_form ?? {})) row(name.replaceAll("_", " "), readable(value, 7));
    for (const [key, name] of OF_NORMAL_FORMS) {
      const value = point[key] ?? point.special?.[key];
      if (typeof value === "number") row(name, readable(value, key === "frequency" ? 8 : 7));
      else if (typeof value === "string") row(name, value);
    }
    const title = point.label ? `${point.label}, ${result.name.replace(/\.json$/, "")}` : `Point ${index + 1} of ${result.name.replace(/\.json$/, "")}`;
    const canStart = point.label && (step.kind !== "cycles" || point.orbit || labelKind(point.label) === "HB");
    this.box.replaceChildren(
      html("h2", {}, title),
      html("div", { class: "walk" },
        html("button", { type: "button", "aria-label": "one point back", click: () => this.listener.move(index - 1) }, "‹"), slider,
        html("button", { type: "button", "aria-label": "one point on", click: () => this.listener.move(index + 1) }, "›")),
      rows,
      canStart ? html("button", { type: "button", id: "start-here", click: () => this.listener.start() }, "What can start here…") : "",
      this.spectrum(point),
      ...(model ? this.motion(model, states, point, orbit, parameters, [result.data, ...others]) : []),
    );
    if (focused) slider.focus();
  }

  /** Eigenvalues or multipliers in the complex plane. @param {any} point */
  spectrum(point) {
    const isCycle = Boolean(point.multipliers);
    /** @type {[number | null, number | null][]} */
    const numbers = point.multipliers ?? point.eigenvalues ?? [];
    const finite = numbers.filter(([re, im]) => re !== null && im !== null);
    // What is far outside would hide the circle.
    const near = isCycle ? finite.filter(([re, im]) => Math.hypot(re ?? 0, im ?? 0) < 3) : finite;
    const list = html("ol", { class: "spectrum" }, ...numbers.map((pair) => html("li", {}, complex(pair))));
    if (!numbers.length) return html("div");
    const name = isCycle ? "Floquet multipliers" : "Eigenvalues";
    const marks = near.map(([re, im]) => {
      const outside = isCycle ? Math.hypot(re ?? 0, im ?? 0) > 1 + 1e-6 : (re ?? 0) > 1e-9 * Math.abs(im ?? 0);
      return /** @type {import("./plot.js").Mark} */ ({ at: [re ?? 0, im ?? 0], shape: "cross", kind: outside ? "outside" : "inside" });
    });
    const plot = draw({ description: `${name} in the complex plane`, equal: true, circle: isCycle, curves: [], marks, x: { label: "real part" }, y: { label: "imaginary part" } });
    const columns = () => ({ re: finite.map(([re]) => re ?? 0), im: finite.map(([, im]) => im ?? 0) });
    const save = captureMenu(name, name.toLowerCase().replace(" ", "-"), () => plot.element, columns);
    return html("figure", {}, plot.element, html("figcaption", {}, isCycle && near.length < finite.length ? `${name} (${finite.length - near.length} outside the picture) ` : `${name} `, save), list);
  }

  /**
   * Phase plane and time history.
   * @param {{name: string, source: string}} model
   * @param {string[]} states
   * @param {any} point
   * @param {FoundPoint["orbit"]} orbit
   * @param {Record<string, number>} parameters
   * @param {any[]} results that tell how far the states reach
   */
  motion(model, states, point, orbit, parameters, results) {
    if (states.length < 2) return [];
    if (!this.axes || !this.axes.every((axis) => states.includes(axis))) this.axes = [states[0] ?? "", states[1] ?? ""];
    const [x, y] = this.axes;
    const [ix, iy] = [states.indexOf(x), states.indexOf(y)];
    const values = (/** @type {number} */ index) => orbit?.states[index] ?? [];
    /** @type {Point[]} */
    const curve = values(ix).map((value, sample) => [value, values(iy)[sample] ?? NaN]);
    /** @type {import("./plot.js").Mark[]} */
    const marks = point.state ? [{ at: [point.state[x], point.state[y]], kind: point.stable === true ? "equilibrium" : "equilibrium open" }] : [];
    const seen = (/** @type {string} */ key, /** @type {0 | 1} */ axis) =>
      axisOf(key, curve.length ? curve.map((at) => at[axis]) : reach(key, point, results), this.extras.filter((extra) => extra.kind === "motion").flatMap((extra) => extra.points.map((at) => at[axis])));
    const [drawnX, drawnY] = [seen(x, 0), seen(y, 1)];
    /** @type {import("./plot.js").Plot} */
    const plane = {
      description: `Phase plane of ${x} and ${y}`,
      curves: [...this.extras.map((extra) => ({ ...extra, arrows: extra.kind === "motion" ? 2 : 0 })), { points: curve, kind: "cycle", dashed: point.stable !== true, arrows: 3 }], marks,
      x: drawnX, y: drawnY,
    };
    const plot = draw(plane);
    plot.element.classList.add("pickable");
    const refresh = () => this.listener.move(-1);
    plot.element.addEventListener("click", (event) => {
      const at = plot.at(event);
      if (!at) return;
      const start = Object.fromEntries(states.map((name, index) => [name, point.state?.[name] ?? orbit?.states[index]?.[0] ?? 0]));
      start[x] = at[0];
      start[y] = at[1];
      void this.follow(model, parameters, start, point.period ? 5 * point.period : 0, refresh);
    });
    const axis = (/** @type {0 | 1} */ which) =>
      html("select", {
        "aria-label": which ? "vertical state" : "horizontal state",
        change: (/** @type {Event} */ event) => {
          if (this.axes) this.axes[which] = /** @type {HTMLSelectElement} */ (event.target).value;
          this.forget();
          refresh();
        },
      }, ...states.map((name) => html("option", { value: name, selected: name === this.axes?.[which] }, name)));
    const tools = html("div", { class: "tools" }, axis(1), " over ", axis(0));
    if (states.length === 2) {
      const add = () => void this.field(model, parameters, point, drawnX, drawnY, refresh);
      for (const [kind, name] of /** @type {["nullcline" | "direction", string][]} */ ([["nullcline", "Nullclines"], ["direction", "Directions"]])) {
        tools.append(html("button", { type: "button", "aria-pressed": String(this.wanted.has(kind)), click: () => {
          if (!this.wanted.delete(kind)) this.wanted.add(kind);
          add();
        } }, name));
      }
      // A motion has made the window larger.
      if (this.wanted.size && this.windowOfField && this.windowOfField !== JSON.stringify([drawnX, drawnY])) add();
    }
    if (this.extras.length) tools.append(html("button", { type: "button", click: () => { this.forget(); refresh(); } }, "Clear"));
    const figures = [html("figure", {}, tools, plot.element, html("figcaption", {}, "Phase plane; press it to start a motion there ", captureMenu("the phase plane", "phase-plane", () => plot.element, () => columnsOf(plane))))];
    if (orbit) {
      /** @type {import("./plot.js").Plot} */
      const course = {
        description: `${y} and ${x} over one period`,
        curves: [{ points: orbit.t.map((time, sample) => /** @type {Point} */ ([time, values(ix)[sample] ?? NaN])), kind: "cycle" }],
        x: { label: "t", low: 0, high: orbit.period }, y: { label: x },
      };
      const history = draw(course);
      figures.push(html("figure", {}, history.element, html("figcaption", {}, `${x} over one period `, captureMenu("the time history", "history", () => history.element, () => ({
        t: [...orbit.t], ...Object.fromEntries(states.map((name, index) => [name, [...values(index)]])),
      })))));
    }
    return figures;
  }

  /**
   * @param {any} request
   * @returns {Promise<any>}
   */
  async simulate(request) {
    /** @type {any} */
    let data = null;
    await listen("/api/simulate", { request }, this.abort.signal, (kind, text) => {
      if (kind === "result") data = JSON.parse(text);
      if (kind === "failure") throw new Refusal(JSON.parse(text).error);
    });
    return data;
  }

  /**
   * Follows a motion and adds it to the phase plane.
   * @param {{name: string, source: string}} model
   * @param {Record<string, number>} set
   * @param {Record<string, number>} start
   * @param {number} duration 0 for what the model asks for
   * @param {() => void} refresh
   */
  async follow(model, set, start, duration, refresh) {
    const [x, y] = this.axes ?? ["", ""];
    try {
      const request = { model: { source: { text: model }, set, start }, points: 2001, ...(duration ? { duration } : {}) };
      const data = await this.simulate(request);
      if (!data) return;
      const points = data.states[x].map((/** @type {number} */ value, /** @type {number} */ sample) => /** @type {Point} */ ([value, data.states[y][sample]]));
      this.extras.push({ points, kind: "motion" });
      refresh();
    } catch (error) {
      this.tell(error);
    }
  }

  /**
   * Adds what is wanted of the field in the window that is seen: nullclines, directions.
   * @param {{name: string, source: string}} model
   * @param {Record<string, number>} set
   * @param {any} point
   * @param {import("./plot.js").PlotAxis} horizontal
   * @param {import("./plot.js").PlotAxis} vertical
   * @param {() => void} refresh
   */
  async field(model, set, point, horizontal, vertical, refresh) {
    const [x, y] = this.axes ?? ["", ""];
    this.windowOfField = JSON.stringify([horizontal, vertical]);
    const interval = (/** @type {string} */ key, /** @type {import("./plot.js").PlotAxis} */ axis) => ({ key, start: axis.low, end: axis.high });
    try {
      const start = point.state ?? point.max;
      const request = { model: { source: { text: model }, set, start }, duration: 1e-3, points: 2, plots: [{ Listed: [x, y] }], window: [interval(x, horizontal), interval(y, vertical)] };
      const plane = (await this.simulate(request))?.phase_planes?.[0];
      if (!plane) return;
      const add = (/** @type {Point[][]} */ curves, /** @type {string} */ kind) => curves.forEach((points) => this.extras.push({ points, kind }));
      this.extras = this.extras.filter((extra) => !/^(nullcline|direction)/.test(extra.kind));
      if (this.wanted.has("direction")) add(plane.directions.map((/** @type {any} */ direction) => arrow(direction, plane.window)), "direction");
      if (this.wanted.has("nullcline")) {
        add(plane.x_nullclines, "nullcline-x");
        add(plane.y_nullclines, "nullcline-y");
      }
      refresh();
    } catch (error) {
      this.tell(error);
    }
  }

  /** @param {unknown} error */
  tell(error) {
    if (error instanceof DOMException && error.name === "AbortError") return;
    this.box.append(html("p", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)));
  }
}

/**
 * An arrow of the direction field, as long as any other on the page, as a line through its head.
 * @param {{at: Point, velocity: Point}} direction
 * @param {[Point, Point]} window
 * @returns {Point[]}
 */
function arrow({ at, velocity }, [[left, right], [low, high]]) {
  const [perX, perY] = [(right - left) / (INNER.width * 300), (high - low) / (INNER.height * 220)];
  const [dx, dy] = [velocity[0] / perX, velocity[1] / perY];
  const length = Math.hypot(dx, dy);
  if (!(length > 0)) return [];
  const [ex, ey] = [dx / length, dy / length];
  const to = (/** @type {number} */ along, /** @type {number} */ aside) => /** @type {Point} */ ([at[0] + perX * (along * ex - aside * ey), at[1] + perY * (along * ey + aside * ex)]);
  return [to(-4, 0), to(4, 0), to(1.5, 1.5), to(4, 0), to(1.5, -1.5)];
}

/**
 * How far a state reaches on the branches: on that of the point, or where it is the same all along it on the others.
 * @param {string} key
 * @param {any} point
 * @param {any[]} results
 * @returns {number[]}
 */
function reach(key, point, results) {
  const own = point.state?.[key] ?? 0;
  for (let count = 1; count <= results.length; count += Math.max(1, results.length - 1)) {
    const points = results.slice(0, count).flatMap((result) => result.points ?? []);
    const values = points.flatMap((other) => (other.state ? [other.state[key]] : [other.min?.[key], other.max?.[key]])).filter((value) => Number.isFinite(value));
    const [low, high] = extent(values, 0);
    if (values.length && high - low > 1e-3 * Math.max(Math.abs(low), Math.abs(high)) && low <= own && own <= high) return [low, high];
  }
  return own === 0 ? [-1, 1] : [0, 2 * own];
}

/**
 * An axis of the phase plane: what it must show, and motions as far as they do not go too far away.
 * @param {string} key
 * @param {number[]} needed
 * @param {number[]} wanted
 */
function axisOf(key, needed, wanted) {
  const [low, high] = extent(needed, 0.12);
  const room = ((WIDEST - 1) / 2) * (high - low);
  const [least, most] = wanted.length ? extent(wanted, 0.03) : [low, high];
  return { label: key, low: Math.max(low - room, Math.min(low, least)), high: Math.min(high + room, Math.max(high, most)) };
}
