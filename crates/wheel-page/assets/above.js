// The wheel seen from above, to scale, in the frame of the towing point: x forward, y towards the centre of the circle. Forces are arrows
// to a scale of their own, which a legend tells.

import { svg } from "./element.js";
import { readable } from "./numbers.js";

/**
 * @typedef {{l: number, R: number, r: number, v: number}} Sizes in metres and m/s; `r` may be infinite
 * @typedef {[number[], number[]]} Components
 * @typedef {{
 *   label: string | null, at?: [number, number], t: number[], u: number[], q: number[], psi: number[], Omega: number[], king_pin_force: Components,
 *   ground_force: Components,
 * }} Motion at equal distances of time; `at` is the value of the parameter and the period, of a cycle
 */

/** How wide a wheel is drawn, in radii: the model knows no width. */
const WIDTH = 0.35;
/** Length of the longest arrow, and distance of the marks on the ground, in parts of the picture's size. */
const LONGEST = 0.42;
const MARKS = 0.1;
/** Forces below this, in N, are rounding. */
const NOTHING = 1e-9;

/** The largest of the numbers 1, 2, 5, 10, .. that is not above a value. @param {number} value */
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([5, 2].find((digit) => digit * power <= value) ?? 1);
}

/** @param {Components} force */
function largest([x, y]) {
  return x.reduce((most, value, index) => Math.max(most, Math.hypot(value, y[index] ?? 0)), 0);
}

export class Above {
  /**
   * @param {HTMLElement} box
   * @param {(psi: number) => void} letGo is told the caster angle at which the caster was let go
   */
  constructor(box, letGo) {
    this.box = box;
    this.letGo = letGo;
    /** The uniform motion, one sample. @type {Motion | null} */
    this.rest = null;
    /** @type {Motion | null} */
    this.motion = null;
    this.isPlaying = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.time = 0;
    this.way = 0;
    this.before = 0;
    this.isDragged = false;
    /** Part of real time at which it plays. */
    this.speed = 1;
    /** Length in m of an arrow of 1 N. */
    this.perNewton = 0;
    requestAnimationFrame((now) => this.tick(now));
  }

  /**
   * Shows the uniform motion of a wheel.
   * @param {Sizes} sizes
   * @param {Motion} rest
   */
  show(sizes, rest) {
    this.rest = rest;
    this.motion = null;
    const { l, R, r } = sizes;
    const size = 1.25 * (l + 2 * R);
    const unit = size / 200;
    this.sizes = sizes;
    this.size = size;
    this.unit = unit;
    const element = svg("svg", { role: "img", "aria-label": "The wheel from above, with the forces on it" });
    const dashes = `${0.3 * MARKS * size} ${0.7 * MARKS * size}`;
    // The y axis of the page points down. The ground passes under the towing point.
    const line = { class: "path", "stroke-width": unit, "stroke-dasharray": dashes };
    this.ground = Number.isFinite(r) ? svg("circle", { ...line, cx: 0, cy: -r, r }) : svg("line", { ...line, x1: -size, x2: size, y1: 0, y2: 0 });
    this.springs = svg("path", { class: "spring", "stroke-width": unit });
    this.still = svg("line", { class: "rest", "stroke-width": unit });
    this.caster = svg("line", { class: "caster", "stroke-width": 3 * unit });
    this.wheel = svg("rect", { class: "wheel", x: -R, y: -0.5 * WIDTH * R, width: 2 * R, height: WIDTH * R, rx: 0.1 * R });
    this.grip = svg("line", { class: "grip", "stroke-width": 14 * unit });
    this.pin = svg("circle", { class: "pin", r: 3 * unit });
    this.arrows = {
      king: svg("path", { class: "force king-pin-force", "stroke-width": 1.6 * unit }),
      ground: svg("path", { class: "force ground-force", "stroke-width": 1.6 * unit }),
    };
    this.legend = svg("g", { class: "force-legend" });
    const box = svg("rect", { class: "box", x: -0.12 * size, y: -0.12 * size, width: 0.24 * size, height: 0.24 * size, "stroke-width": unit });
    element.append(this.ground, box, this.springs, this.still, this.wheel, this.caster, this.pin, this.arrows.king, this.arrows.ground, this.legend, this.grip);
    this.half = 0.12 * size;
    this.element = element;
    this.grip.addEventListener("pointerdown", (event) => this.drag(event));
    this.box.replaceChildren(element);
    this.scale(rest);
    this.pose(rest, 0, 0);
  }

  /** Plays a motion; with nothing, the uniform one. @param {Motion | null} motion */
  play(motion) {
    this.motion = motion;
    this.time = 0;
    const shown = motion ?? this.rest;
    if (!shown) return;
    this.scale(shown);
    this.pose(shown, 0, 0);
  }

  /** Chooses the part that is seen, the scale of the arrows for a motion, and tells that. @param {Motion} motion */
  scale(motion) {
    const { legend, size = 1, sizes, element } = this;
    if (!sizes || !element) return;
    // As far as king pin and wheel go, in the usual proportions.
    const wheels = motion.psi.map((psi, index) => [(motion.u[index] ?? 0) - sizes.l * Math.cos(psi), (motion.q[index] ?? 0) + sizes.l * Math.sin(psi)]);
    const reach = (/** @type {number[]} */ pins, /** @type {0 | 1} */ axis, /** @type {number} */ sign) =>
      wheels.reduce((most, wheel, index) => Math.max(most, sign * (pins[index] ?? 0), sign * (wheel[axis] ?? 0) + sizes.R), 0);
    const far = Math.max(1, reach(motion.u, 0, -1) / (0.95 * size), reach(motion.u, 0, 1) / (0.4 * size), reach(motion.q, 1, 1) / (0.6 * size), reach(motion.q, 1, -1) / (0.5 * size));
    const seen = size * far;
    element.setAttribute("viewBox", `${-seen} ${-seen * 0.62} ${1.45 * seen} ${1.24 * seen}`);
    const unit = (this.unit ?? 1) * far;
    const most = Math.max(largest(motion.king_pin_force), largest(motion.ground_force));
    this.perNewton = most > NOTHING ? (LONGEST * seen) / most : 0;
    Object.values(this.arrows ?? {}).forEach((arrow) => arrow.setAttribute("stroke-width", String(1.6 * unit)));
    this.head = 5 * unit;
    if (!legend) return;
    legend.replaceChildren();
    if (!this.perNewton) return;
    const newtons = roundBelow(most);
    const length = newtons * this.perNewton;
    const [left, top] = [-0.96 * seen, 0.55 * seen];
    const text = (/** @type {number} */ x, /** @type {string} */ name, /** @type {string} */ words) =>
      svg("text", { class: name, x, y: top + 4 * unit, "font-size": 10.5 * unit }, words);
    legend.append(
      svg("path", { class: "force scale", "stroke-width": 1.6 * unit, d: this.arrow(left, top, length, 0) }),
      text(left + length + 4 * unit, "value", `${readable(newtons, 3)} N`),
      text(left + length + 58 * unit, "king-pin-name", "springs, dampers"), text(left + length + 154 * unit, "ground-name", "ground"));
  }

  /** An arrow as a path. @param {number} x @param {number} y @param {number} dx @param {number} dy */
  arrow(x, y, dx, dy) {
    const length = Math.hypot(dx, dy);
    const head = Math.min(this.head ?? 0, 0.5 * length);
    if (head === 0) return "";
    const [ex, ey] = [(dx / length) * head, (dy / length) * head];
    const [tx, ty] = [x + dx, y + dy];
    return `M${x} ${y}L${tx} ${ty}M${tx - ex - 0.6 * ey} ${ty - ey + 0.6 * ex}L${tx} ${ty}L${tx - ex + 0.6 * ey} ${ty - ey - 0.6 * ex}`;
  }

  /** Shows a motion between two of its samples. @param {Motion} motion @param {number} index @param {number} part */
  pose(motion, index, part) {
    const at = (/** @type {number[]} */ values) => (values[index] ?? 0) * (1 - part) + (values[index + 1] ?? values[index] ?? 0) * part;
    const [kingX, kingY] = motion.king_pin_force;
    const [groundX, groundY] = motion.ground_force;
    this.place({ u: at(motion.u), q: at(motion.q), psi: at(motion.psi) }, [at(kingX), at(kingY)], [at(groundX), at(groundY)]);
  }

  /**
   * @param {{u: number, q: number, psi: number}} pose
   * @param {[number, number]} king
   * @param {[number, number]} ground
   */
  place({ u, q, psi }, king, ground) {
    if (!this.sizes || !this.caster || !this.wheel || !this.grip || !this.pin || !this.springs || !this.still || !this.arrows || !this.rest) return;
    const { l } = this.sizes;
    const end = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ angle) => /** @type {const} */ ([x - l * Math.cos(angle), -(y + l * Math.sin(angle))]);
    const set = (/** @type {SVGElement} */ element, /** @type {Record<string, number | string>} */ values) =>
      Object.entries(values).forEach(([name, value]) => element.setAttribute(name, String(value)));
    const [x, y] = end(u, q, psi);
    const [restU, restQ, restPsi] = [this.rest.u[0] ?? 0, this.rest.q[0] ?? 0, this.rest.psi[0] ?? 0];
    const [restX, restY] = end(restU, restQ, restPsi);
    set(this.still, { x1: restU, y1: -restQ, x2: restX, y2: restY });
    for (const line of [this.caster, this.grip]) set(line, { x1: u, y1: -q, x2: x, y2: y });
    set(this.wheel, { transform: `translate(${x} ${y}) rotate(${(psi * 180) / Math.PI})` });
    set(this.pin, { cx: u, cy: -q });
    const half = this.half ?? 0;
    set(this.springs, { d: `M${-half} ${-q}L${u} ${-q}L${half} ${-q}M${u} ${-half}L${u} ${-q}L${u} ${half}` });
    set(this.arrows.king, { d: this.arrow(u, -q, king[0] * this.perNewton, -king[1] * this.perNewton) });
    set(this.arrows.ground, { d: this.arrow(x, y, ground[0] * this.perNewton, -ground[1] * this.perNewton) });
  }

  /** @param {number} now */
  tick(now) {
    requestAnimationFrame((next) => this.tick(next));
    const passed = Math.min(now - this.before, 100) / 1000;
    this.before = now;
    const { motion, sizes, size } = this;
    if (!this.isPlaying || this.isDragged || !sizes || !size) return;
    this.way = (this.way + passed * this.speed * sizes.v) % (MARKS * size);
    // Dashes of the circle run the other way.
    this.ground?.setAttribute("stroke-dashoffset", String(Number.isFinite(sizes.r) ? -this.way : this.way));
    if (!motion || motion.t.length < 2) return;
    const end = motion.t.at(-1) ?? 0;
    this.time = (this.time + passed * this.speed) % end;
    const place = (this.time / end) * (motion.t.length - 1);
    const index = Math.min(Math.floor(place), motion.t.length - 2);
    this.pose(motion, index, place - index);
  }

  /** @param {PointerEvent} event */
  drag(event) {
    const { element, grip, rest } = this;
    if (!element || !grip || !rest) return;
    event.preventDefault();
    grip.setPointerCapture(event.pointerId);
    this.isDragged = true;
    const [u, q] = [rest.u[0] ?? 0, rest.q[0] ?? 0];
    let psi = rest.psi[0] ?? 0;
    const move = (/** @type {PointerEvent} */ moved) => {
      const matrix = element.getScreenCTM();
      if (!matrix) return;
      const at = new DOMPoint(moved.clientX, moved.clientY).matrixTransform(matrix.inverse());
      psi = Math.max(-1.4, Math.min(1.4, Math.atan2(-at.y - q, u - at.x)));
      this.place({ u, q, psi }, [0, 0], [0, 0]);
    };
    const end = (/** @type {boolean} */ isLetGo) => {
      grip.removeEventListener("pointermove", move);
      this.isDragged = false;
      if (isLetGo) this.letGo(psi);
    };
    grip.addEventListener("pointermove", move);
    grip.addEventListener("pointerup", () => end(true), { once: true });
    grip.addEventListener("pointercancel", () => end(false), { once: true });
  }
}
