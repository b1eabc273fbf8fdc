// The wheel seen from above, to scale, in the frame of the towing point: x forward, y towards the centre of the circle.

import { svg } from "./element.js";

/**
 * @typedef {{l: number, R: number, r: number}} Sizes in metres; `r` may be infinite
 * @typedef {{t: number[], u: number[], q: number[], psi: number[]}} Motion
 * @typedef {{u: number, q: number, psi: number}} Pose
 */

/** How wide a wheel is drawn, in radii: the model knows no width. */
const WIDTH = 0.35;

export class Above {
  /**
   * @param {HTMLElement} box
   * @param {(psi: number) => void} letGo is told the caster angle at which the caster was let go
   */
  constructor(box, letGo) {
    this.box = box;
    this.letGo = letGo;
    /** @type {Motion | null} */
    this.motion = null;
    /** @type {Pose} */
    this.rest = { u: 0, q: 0, psi: 0 };
    this.isPlaying = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.time = 0;
    this.before = 0;
    this.isDragged = false;
    /** Part of real time at which it plays. */
    this.speed = 1;
    requestAnimationFrame((now) => this.tick(now));
  }

  /**
   * @param {Sizes} sizes
   * @param {Pose} rest
   */
  show(sizes, rest) {
    this.rest = rest;
    const { l, R, r } = sizes;
    const size = 1.25 * (l + 2 * R);
    const unit = size / 200;
    const element = svg("svg", { viewBox: `${-size} ${-size * 0.62} ${1.45 * size} ${1.24 * size}`, role: "img", "aria-label": "The wheel from above" });
    // The y axis of the page points down.
    if (Number.isFinite(r)) element.append(svg("circle", { class: "path", cx: 0, cy: -r, r, "stroke-width": unit }));
    else element.append(svg("line", { class: "path", x1: -size, x2: size, y1: 0, y2: 0, "stroke-width": unit }));
    element.append(svg("rect", { class: "box", x: -0.12 * size, y: -0.12 * size, width: 0.24 * size, height: 0.24 * size, "stroke-width": unit }));
    this.springs = svg("path", { class: "spring", "stroke-width": unit });
    this.still = svg("line", { class: "rest", "stroke-width": unit });
    this.caster = svg("line", { class: "caster", "stroke-width": 3 * unit });
    this.wheel = svg("rect", { class: "wheel", x: -R, y: -0.5 * WIDTH * R, width: 2 * R, height: WIDTH * R, rx: 0.1 * R });
    this.grip = svg("line", { class: "grip", "stroke-width": 14 * unit });
    this.pin = svg("circle", { class: "pin", r: 3 * unit });
    element.append(this.springs, this.still, this.wheel, this.caster, this.grip, this.pin);
    this.sizes = sizes;
    this.half = 0.12 * size;
    this.element = element;
    this.grip.addEventListener("pointerdown", (event) => this.drag(event));
    this.box.replaceChildren(element);
    this.pose(rest);
  }

  /** @param {Motion | null} motion */
  play(motion) {
    this.motion = motion;
    this.time = 0;
  }

  /** @param {Pose} pose */
  pose({ u, q, psi }) {
    if (!this.sizes || !this.caster || !this.wheel || !this.grip || !this.pin || !this.springs || !this.still) return;
    const { l } = this.sizes;
    const end = (/** @type {Pose} */ at) => [at.u - l * Math.cos(at.psi), -(at.q + l * Math.sin(at.psi))];
    const set = (/** @type {SVGElement} */ element, /** @type {Record<string, number | string>} */ values) =>
      Object.entries(values).forEach(([name, value]) => element.setAttribute(name, String(value)));
    const [x, y] = end({ u, q, psi });
    const [restX, restY] = end(this.rest);
    set(this.still, { x1: this.rest.u, y1: -this.rest.q, x2: restX ?? 0, y2: restY ?? 0 });
    for (const line of [this.caster, this.grip]) set(line, { x1: u, y1: -q, x2: x ?? 0, y2: y ?? 0 });
    set(this.wheel, { transform: `translate(${x} ${y}) rotate(${(psi * 180) / Math.PI})` });
    set(this.pin, { cx: u, cy: -q });
    const half = this.half ?? 0;
    set(this.springs, { d: `M${-half} ${-q}L${u} ${-q}L${half} ${-q}M${u} ${-half}L${u} ${-q}L${u} ${half}` });
  }

  /** @param {number} now */
  tick(now) {
    requestAnimationFrame((next) => this.tick(next));
    const passed = Math.min(now - this.before, 100) / 1000;
    this.before = now;
    const { motion } = this;
    if (!motion || !this.isPlaying || this.isDragged || motion.t.length < 2) return;
    const end = motion.t.at(-1) ?? 0;
    this.time = (this.time + passed * this.speed) % end;
    // Samples stand at equal distances.
    const place = (this.time / end) * (motion.t.length - 1);
    const index = Math.min(Math.floor(place), motion.t.length - 2);
    const part = place - index;
    const at = (/** @type {number[]} */ values) => (values[index] ?? 0) * (1 - part) + (values[index + 1] ?? 0) * part;
    this.pose({ u: at(motion.u), q: at(motion.q), psi: at(motion.psi) });
  }

  /** @param {PointerEvent} event */
  drag(event) {
    const { element, grip, rest } = this;
    if (!element || !grip) return;
    event.preventDefault();
    grip.setPointerCapture(event.pointerId);
    this.isDragged = true;
    let { psi } = rest;
    const move = (/** @type {PointerEvent} */ moved) => {
      const matrix = element.getScreenCTM();
      if (!matrix) return;
      const at = new DOMPoint(moved.clientX, moved.clientY).matrixTransform(matrix.inverse());
      psi = Math.max(-1.4, Math.min(1.4, Math.atan2(-at.y - rest.q, rest.u - at.x)));
      this.pose({ u: rest.u, q: rest.q, psi });
    };
    const end = () => {
      grip.removeEventListener("pointermove", move);
      this.isDragged = false;
      this.letGo(psi);
    };
    grip.addEventListener("pointermove", move);
    grip.addEventListener("pointerup", end, { once: true });
  }
}
