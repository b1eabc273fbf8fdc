// A point of a branch beside the diagram: its numbers, its eigenvalues or multipliers, its orbit in the phase plane and over the time.

import { Refusal, listen } from "./ask.js";
import { html } from "./element.js";
import { complex, readable } from "./numbers.js";
import { draw } from "./plot.js";
import { labelKind } from "./starts.js";

/**
 * @typedef {import("./chain.js").Result} Result
 * @typedef {import("./chain.js").FoundPoint} FoundPoint
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./plot.js").Point} Point
 * @typedef {{points: Point[], kind: string}} Extra a curve in the phase plane beside the orbit
 */

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
    this.where = "";
    this.abort = new AbortController();
  }

  clear() {
    this.box.replaceChildren(html("p", { class: "hint" }, "Press a label to start something there; press a curve to see its points here."));
    this.where = "";
  }

  /**
   * @param {{name: string, source: string}} model
   * @param {Step} step
   * @param {Result} result
   * @param {number} index
   */
  show(model, step, result, index) {
    const point = result.data.points[index];
    if (!point) return this.clear();
    const where = `${result.key}:${index}`;
    if (where !== this.where) {
      this.abort.abort();
      this.abort = new AbortController();
      this.extras = [];
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
    if (point.frequency) row("frequency", readable(point.frequency));
    if (point.first_lyapunov) row("first Lyapunov coefficient", readable(point.first_lyapunov, 7));
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
      ...this.motion(model, states, point, orbit, parameters),
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
      const outside = isCycle ? Math.hypot(re ?? 0, im ?? 0) > 1 + 1e-6 : (re ?? 0) > 0;
      return /** @type {import("./plot.js").Mark} */ ({ at: [re ?? 0, im ?? 0], shape: "cross", kind: outside ? "outside" : "inside" });
    });
    const plot = draw({ description: `${name} in the complex plane`, equal: true, circle: isCycle, curves: [], marks, x: { label: "real part" }, y: { label: "imaginary part" } });
    return html("figure", {}, plot.element, html("figcaption", {}, isCycle && near.length < finite.length ? `${name} (${finite.length - near.length} outside the picture)` : name), list);
  }

  /**
   * Phase plane and time history.
   * @param {{name: string, source: string}} model
   * @param {string[]} states
   * @param {any} point
   * @param {FoundPoint["orbit"]} orbit
   * @param {Record<string, number>} parameters
   */
  motion(model, states, point, orbit, parameters) {
    if (states.length < 2) return [];
    if (!this.axes || !this.axes.every((axis) => states.includes(axis))) this.axes = [states[0] ?? "", states[1] ?? ""];
    const [x, y] = this.axes;
    const [ix, iy] = [states.indexOf(x), states.indexOf(y)];
    const values = (/** @type {number} */ index) => orbit?.states[index] ?? [];
    /** @type {Point[]} */
    const curve = values(ix).map((value, sample) => [value, values(iy)[sample] ?? NaN]);
    /** @type {import("./plot.js").Mark[]} */
    const marks = point.state ? [{ at: [point.state[x], point.state[y]], kind: point.stable === true ? "equilibrium" : "equilibrium open" }] : [];
    const [drawnX, drawnY] = curve.length ? [{ label: x }, { label: y }] : [window(x, point), window(y, point)];
    const plot = draw({
      description: `Phase plane of ${x} and ${y}`,
      curves: [...this.extras, { points: curve, kind: "cycle", dashed: point.stable !== true }], marks,
      x: drawnX, y: drawnY,
    });
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
          this.extras = [];
          refresh();
        },
      }, ...states.map((name) => html("option", { value: name, selected: name === this.axes?.[which] }, name)));
    const tools = html("div", { class: "tools" }, axis(1), " over ", axis(0));
    if (states.length === 2) {
      tools.append(html("button", { type: "button", click: () => void this.nullclines(model, parameters, point, drawnX, drawnY, refresh) }, "Nullclines"));
    }
    if (this.extras.length) tools.append(html("button", { type: "button", click: () => { this.extras = []; refresh(); } }, "Clear"));
    const figures = [html("figure", {}, tools, plot.element, html("figcaption", {}, "Phase plane; press it to start a motion there"))];
    if (orbit) {
      const history = draw({
        description: `${y} and ${x} over one period`,
        curves: [{ points: orbit.t.map((time, sample) => /** @type {Point} */ ([time, values(ix)[sample] ?? NaN])), kind: "cycle" }],
        x: { label: "t", low: 0, high: orbit.period }, y: { label: x },
      });
      figures.push(html("figure", {}, history.element, html("figcaption", {}, `${x} over one period`)));
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
   * Adds the nullclines in the window that is seen.
   * @param {{name: string, source: string}} model
   * @param {Record<string, number>} set
   * @param {any} point
   * @param {import("./plot.js").PlotAxis} horizontal
   * @param {import("./plot.js").PlotAxis} vertical
   * @param {() => void} refresh
   */
  async nullclines(model, set, point, horizontal, vertical, refresh) {
    const [x, y] = this.axes ?? ["", ""];
    const ends = (/** @type {string} */ key) => {
      const [low, high] = point.state ? [point.state[key] - 1, point.state[key] + 1] : [point.min[key], point.max[key]];
      return [low - 0.3 * (high - low), high + 0.3 * (high - low)];
    };
    const interval = (/** @type {string} */ key, /** @type {import("./plot.js").PlotAxis} */ axis) => {
      const [low, high] = ends(key);
      return { key, start: axis.low ?? low, end: axis.high ?? high };
    };
    try {
      const start = point.state ?? point.max;
      const request = { model: { source: { text: model }, set, start }, duration: 1e-3, points: 2, plots: [{ Listed: [x, y] }], window: [interval(x, horizontal), interval(y, vertical)] };
      const plane = (await this.simulate(request))?.phase_planes?.[0];
      if (!plane) return;
      const add = (/** @type {Point[][]} */ curves, /** @type {string} */ kind) => curves.forEach((points) => this.extras.push({ points, kind }));
      add(plane.x_nullclines, "nullcline-x");
      add(plane.y_nullclines, "nullcline-y");
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

/** A window about an equilibrium. @param {string} key @param {any} point @returns {import("./plot.js").PlotAxis} */
function window(key, point) {
  const value = point.state?.[key] ?? 0;
  const half = Math.max(1, Math.abs(value));
  return { label: key, low: value - half, high: value + half };
}
