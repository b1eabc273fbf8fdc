// Diagrams: while something is computed the points appear as they arrive; what is finished is drawn by the server, with labels that can
// be pressed and points that can be picked on top.

import { ask } from "./ask.js";
import { colorsOf, ownColor } from "./colors.js";
import { html, pressable, svg } from "./element.js";
import { readable } from "./numbers.js";
import { draw } from "./plot.js";
import { saveMenu, saveResults } from "./save.js";
import { labelKind } from "./starts.js";
import { Zoom, isDark } from "./zoom.js";

/**
 * @typedef {import("./chain.js").Result} Result
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./plot.js").Point} Point
 * @typedef {{name: string, index: number}} Picked a point of a result
 * @typedef {{low: number, high: number, logarithmic: boolean}} Span
 * @typedef {{left: number, top: number, right: number, bottom: number, x: Span, y: Span}} Place
 * @typedef {{svg: string, width: number, height: number, panels: (Place | null)[]}} Picture
 * @typedef {{key: string, title: string, steps: Step[]}} Group
 * @typedef {{pick: (picked: Picked) => void, press: (picked: Picked) => void}} Listener
 */

/** Time between two pictures of what grows, in milliseconds. */
const PATIENCE = 60;
/** How long the picture stands still of curves that are computed anew, in milliseconds: what is there by then shows no growth. */
const STILL = 1000;
/** Distance from a point within which it is picked, in points of the picture. */
const REACH = 12;
/** Labels that are not shown in pictures. */
const UNSHOWN = new Set(["EP", "NSE"]);

/** @param {Step} step @param {string} shown @param {any} point @returns {Point[]} where a point of a result stands */
export function placesOf(step, shown, point) {
  if (step.plane) return [[point.values[0], point.values[1]]];
  if (point.state) return [[point.value, point.state[shown]]];
  return [[point.value, point.max[shown]], [point.value, point.min[shown]]];
}

/** Where something is on an axis, from 0 to 1. @param {Span} span @param {number} value */
function fraction({ low, high, logarithmic }, value) {
  return logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** @param {Place} place @param {Point} point @returns {Point} */
function onPage(place, [x, y]) {
  return [
    place.left + fraction(place.x, x) * (place.right - place.left),
    place.bottom - fraction(place.y, y) * (place.bottom - place.top),
  ];
}

/** Whether a point of the page is within the axes. @param {Place} place @param {Point} point */
function isInside({ left, top, right, bottom }, [x, y]) {
  return x >= left - 1 && x <= right + 1 && y >= top - 1 && y <= bottom + 1;
}

/** A finished picture of the server as an element. @param {Picture} picture @param {string} description */
export function pictureElement(picture, description) {
  // The page allows no styles of its own in elements; the attribute beside it says the same.
  const text = picture.svg.replace(/ style="[^"]*"/g, "");
  const parsed = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  const element = /** @type {SVGSVGElement} */ (/** @type {unknown} */ (document.adoptNode(parsed)));
  element.setAttribute("aria-label", description);
  element.setAttribute("class", "drawn");
  return element;
}

/** One diagram with its heading. */
class Diagram {
  /**
   * @param {string} path where pictures are asked for
   * @param {Listener} listener
   */
  constructor(path, listener) {
    this.path = path;
    this.listener = listener;
    this.title = html("h2");
    this.tools = html("span", { class: "tools" });
    this.picture = html("div", { class: "picture" });
    this.element = html("section", { class: "diagram" }, html("header", {}, this.title, this.tools), this.picture);
    this.drawn = "";
    /** The curves of the finished picture that is seen. @type {Set<string>} */
    this.finished = new Set();
    this.last = 0;
    this.timer = 0;
    /** Since when something is computed. */
    this.since = 0;
    /** Until the picture that was asked for last is there. @type {Promise<void>} */
    this.isShown = Promise.resolve();
    /** @type {Group} */
    this.group = { key: "", title: "", steps: [] };
    /** @type {Map<string, Result>} */
    this.results = new Map();
    this.shown = "";
    /** The states in their order, which a growing result does not name. @type {string[]} */
    this.stateNames = [];
    /** @type {Picked | null} */
    this.picked = null;
    /** @type {Place | null} */
    this.place = null;
    /** @type {SVGSVGElement | null} */
    this.overlay = null;
    this.marker = svg("circle", { class: "picked", r: 5, visibility: "hidden" });
    /** Which part is seen. */
    this.zoom = new Zoom(() => void (this.isShown = this.finish()));
    this.tools.append(this.zoom.buttons, saveMenu("this diagram", ["svg", "png", "pdf"], (format) => this.save(format)));
  }

  /** Results that are to be seen and have points. */
  get seen() {
    return this.group.steps.filter((step) => !step.hidden && this.results.get(step.name)?.data);
  }

  get files() {
    return Object.fromEntries(this.seen.map((step) => [step.name, this.results.get(step.name)?.text ?? ""]));
  }

  get states() {
    // A wheel has one diagram; its states are not asked for.
    return this.group.steps[0]?.kind === "simulate" || this.group.steps[0]?.plane || this.path !== "/api/diagram" ? [] : [this.shown];
  }

  /** What a picture of it is asked with. */
  get asked() {
    const { states } = this;
    return { results: this.seen.map((step) => step.name), ...(states.length ? { states } : {}), window: this.zoom.window, dark: isDark(), ...colorsOf(this.seen) };
  }

  /** @param {string} format */
  async save(format) {
    await saveResults(this.path, this.files, this.asked, format, this.group.key.replace(/\W+/g, "-"));
  }

  /**
   * @param {Group} group
   * @param {Map<string, Result>} results
   * @param {string} shown
   */
  update(group, results, shown) {
    Object.assign(this, { group, results, shown });
    this.title.textContent = group.title;
    const running = group.steps.some((step) => results.get(step.name)?.running);
    clearTimeout(this.timer);
    if (running) {
      this.element.hidden = false;
      this.picture.setAttribute("aria-busy", "true");
    }
    if (!running) {
      this.since = 0;
      this.isShown = this.finish();
      return;
    }
    this.since ||= performance.now();
    // A curve that was not there yet grows; one that is computed anew, as while a slider moves, stays until the new one is there.
    const isNew = group.steps.some((step) => !step.hidden && !this.finished.has(step.name));
    const earliest = Math.max(this.last + PATIENCE, this.since + (isNew ? 0 : STILL));
    this.timer = setTimeout(() => this.grow(), Math.max(0, earliest - performance.now()));
  }

  /** Draws what there is so far. */
  grow() {
    const { steps } = this.group;
    const [first] = steps;
    if (!first || first.kind === "simulate" || !steps.some((step) => !step.hidden && this.results.get(step.name)?.points.length)) return;
    this.last = performance.now();
    /** @type {import("./plot.js").Curve[]} */
    const curves = [];
    /** @type {import("./plot.js").Mark[]} */
    const marks = [];
    for (const step of steps) {
      const result = this.results.get(step.name);
      if (step.hidden || !result) continue;
      const kind = step.kind === "cycles" ? "cycle" : "equilibrium";
      const color = ownColor(step);
      if (result.data) curves.push(...pieces(step, this.shown, result.data.points, kind).map((curve) => ({ ...curve, color })));
      else {
        const index = this.stateNames.indexOf(this.shown);
        for (const point of result.points) {
          const x = point.values[0] ?? NaN;
          const ys = step.plane ? [point.values[1] ?? NaN] : [point.max[index] ?? NaN, point.min[index] ?? NaN];
          for (const y of new Set(ys)) marks.push({ at: [x, y], kind: point.stable === false ? `${kind} open` : kind, color });
          if (point.label && !UNSHOWN.has(labelKind(point.label))) {
            marks.push({ at: [x, ys[0] ?? NaN], kind: "special", text: labelKind(point.label) });
          }
        }
      }
    }
    const [x, y] = first.plane ? first.plane.map((interval) => interval.key) : [first.along?.key ?? "", this.shown];
    const interval = first.plane?.[0] ?? first.along;
    const plot = draw({
      description: `${this.group.title}, growing`, width: 520, height: 370, curves, marks,
      x: { label: x ?? "", low: interval?.start, high: interval?.end }, y: { label: y ?? "" },
    });
    this.drawn = "";
    this.finished.clear();
    this.picture.classList.add("growing");
    this.picture.replaceChildren(plot.element);
  }

  /** Shows the finished picture. */
  async finish() {
    const names = this.seen.map((step) => step.name);
    const signature = JSON.stringify([this.asked, this.shown, names.map((name) => this.results.get(name)?.key)]);
    if (signature === this.drawn) {
      this.mark();
      // It was computed anew, and is the same.
      await this.isShown;
      if (this.drawn === signature) this.picture.removeAttribute("aria-busy");
      return;
    }
    this.drawn = signature;
    this.picture.setAttribute("aria-busy", "true");
    this.element.hidden = !names.length;
    if (!names.length) {
      this.picture.replaceChildren();
      this.picture.classList.remove("growing");
      this.picture.removeAttribute("aria-busy");
      return;
    }
    /** @type {Picture} */
    let picture;
    try {
      picture = await ask(this.path, { request: { ...this.asked, format: "page" }, files: this.files });
    } catch (error) {
      if (this.drawn !== signature) return;
      this.picture.replaceChildren(html("p", { class: "problem" }, error instanceof Error ? error.message : String(error)));
      this.picture.classList.remove("growing");
      this.picture.removeAttribute("aria-busy");
      return;
    }
    if (this.drawn !== signature) return;
    this.picture.classList.remove("growing");
    this.picture.removeAttribute("aria-busy");
    this.finished = new Set(names);
    this.place = picture.panels[0] ?? null;
    this.overlay = svg("svg", { viewBox: `0 0 ${picture.width} ${picture.height}`, class: "overlay" });
    this.picture.replaceChildren(pictureElement(picture, this.group.title), this.overlay);
    if (this.place) this.zoom.attach(this.overlay, this.picture, this.place, picture);
    if (this.group.steps[0]?.kind === "simulate") return;
    this.overlay.append(this.marker);
    this.overlay.addEventListener("click", (event) => {
      if (!this.zoom.hasDragged) this.pickNear(event);
    });
    this.addLabels();
    this.mark();
  }

  addLabels() {
    for (const step of this.seen) {
      const points = this.results.get(step.name)?.data.points ?? [];
      points.forEach((/** @type {any} */ point, /** @type {number} */ index) => {
        if (!point.label || UNSHOWN.has(labelKind(point.label)) || !this.place) return;
        const at = placesOf(step, this.shown, point)[0];
        if (!at) return;
        const [x, y] = onPage(this.place, at);
        if (!isInside(this.place, [x, y])) return;
        const where = step.plane ? point.values.map((/** @type {number} */ value) => readable(value, 6)).join(", ") : readable(point.value, 6);
        const target = svg("circle", {
          class: "target", cx: x, cy: y, r: 7, "data-label": `${step.name}:${point.label}`,
          "aria-label": `${point.label} at ${where}, what can start there`,
        }, svg("title", {}, `${point.label} at ${where}: what can start there`));
        pressable(target, (event) => {
          event.stopPropagation();
          this.listener.press({ name: step.name, index });
        });
        this.overlay?.append(target);
      });
    }
  }

  /** @param {MouseEvent} event */
  pickNear(event) {
    if (!this.overlay || !this.place) return;
    const box = this.overlay.getBoundingClientRect();
    const view = this.overlay.viewBox.baseVal;
    const [x, y] = [((event.clientX - box.left) / box.width) * view.width, ((event.clientY - box.top) / box.height) * view.height];
    /** @type {Picked | null} */
    let nearest = null;
    let least = REACH;
    for (const step of this.seen) {
      const points = this.results.get(step.name)?.data.points ?? [];
      for (const [index, point] of points.entries()) {
        for (const place of placesOf(step, this.shown, point)) {
          const [px, py] = onPage(this.place, place);
          const distance = Math.hypot(px - x, py - y);
          if (distance < least) [least, nearest] = [distance, { name: step.name, index }];
        }
      }
    }
    if (nearest) this.listener.pick(nearest);
  }

  /** Marks the point that is picked, where it is one of this diagram. */
  mark() {
    const step = this.picked && this.seen.find((other) => other.name === this.picked?.name);
    const point = step && this.results.get(step.name)?.data.points[this.picked?.index ?? 0];
    const at = step && point && placesOf(step, this.shown, point)[0];
    this.marker.setAttribute("visibility", at && this.place ? "visible" : "hidden");
    if (!at || !this.place) return;
    const [x, y] = onPage(this.place, at);
    if (!isInside(this.place, [x, y])) this.marker.setAttribute("visibility", "hidden");
    this.marker.setAttribute("cx", String(x));
    this.marker.setAttribute("cy", String(y));
  }
}

/**
 * A branch in pieces that are stable or not.
 * @param {Step} step
 * @param {string} shown
 * @param {any[]} points
 * @param {string} kind
 */
function pieces(step, shown, points, kind) {
  /** @type {import("./plot.js").Curve[]} */
  const curves = [];
  const places = points.map((point) => placesOf(step, shown, point));
  for (let side = 0; side < (places[0]?.length ?? 0); side++) {
    points.forEach((point, index) => {
      const [from, to] = [places[index]?.[side], places[index + 1]?.[side]];
      // Where a branch ends another one may begin.
      if (!from || !to || point.branch !== points[index + 1].branch) return;
      const dashed = !step.plane && (point.stable ?? points[index + 1].stable) !== true;
      const last = curves.at(-1);
      if (index > 0 && last && last.dashed === dashed && points[index - 1].branch === point.branch) last.points.push(to);
      else curves.push({ points: [from, to], kind, dashed });
    });
  }
  return curves;
}

/** All diagrams of the page. */
export class Diagrams {
  /**
   * @param {HTMLElement} box
   * @param {string} path where pictures are asked for
   * @param {Listener} listener
   */
  constructor(box, path, listener) {
    this.box = box;
    this.path = path;
    this.listener = listener;
    /** @type {Map<string, Diagram>} */
    this.diagrams = new Map();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const diagram of this.diagrams.values()) diagram.isShown = diagram.finish();
    });
  }

  /** Shows all of everything. */
  reset() {
    for (const diagram of this.diagrams.values()) diagram.zoom.window = {};
  }

  /** Waits until the pictures that were asked for are there. */
  async shown() {
    await Promise.all([...this.diagrams.values()].map((diagram) => diagram.isShown));
  }

  /**
   * @param {Step[]} steps
   * @param {Map<string, Result>} results
   * @param {string} shown
   * @param {string[]} states
   * @param {Picked | null} picked
   */
  update(steps, results, shown, states, picked) {
    /** @type {Map<string, Group>} */
    const groups = new Map();
    for (const step of steps) {
      const keys = step.plane?.map((interval) => interval.key);
      const key = step.kind === "simulate" ? step.name : (keys?.join(", ") ?? step.along?.key ?? "");
      const title = step.kind === "simulate" ? "Motion" : keys ? `In the plane of ${keys.join(" and ")}` : `Along ${key}`;
      const group = groups.get(key) ?? { key, title, steps: [] };
      group.steps.push(step);
      groups.set(key, group);
    }
    for (const [key, diagram] of this.diagrams) {
      if (groups.has(key)) continue;
      diagram.element.remove();
      this.diagrams.delete(key);
    }
    for (const [key, group] of groups) {
      let diagram = this.diagrams.get(key);
      if (!diagram) {
        diagram = new Diagram(this.path, this.listener);
        this.diagrams.set(key, diagram);
        this.box.append(diagram.element);
      }
      diagram.stateNames = states;
      diagram.picked = picked;
      diagram.update(group, results, shown);
    }
  }
}
