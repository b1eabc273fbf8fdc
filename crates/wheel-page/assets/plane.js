// The plane of caster angle and yaw rate: the motion in it, and under it where motions that start there end.

import { html } from "./element.js";
import { INNER, draw } from "./plot.js";

/**
 * @typedef {import("./above.js").Motion} Motion
 * @typedef {{columns: number, rows: number, fates: {name: string, color: number[]}[], ends: [[number, number], [number, number]], cells: string}} Map
 * one digit for every cell, row by row from the lowest: the place of its fate in the list
 * @typedef {[[number, number], [number, number]]} Limits of caster angle and yaw rate
 */

/** How strong the colours of the map are, of 255: the motion must be seen on them. */
const STRENGTH = 120;

/** @param {Map} map */
function canvasOf({ columns, rows, fates, cells }) {
  const colors = fates.map(({ color }) => color);
  const image = new ImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const color = colors[cells.charCodeAt(row * columns + column) - 48] ?? [0, 0, 0];
      // The page counts rows from above.
      image.data.set([...color, STRENGTH], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  const canvas = html("canvas", { class: "basin", width: columns, height: rows, "aria-hidden": "true" });
  canvas.getContext("2d")?.putImageData(image, 0, 0);
  const part = (/** @type {number} */ value) => `${100 * value}%`;
  Object.assign(canvas.style, { left: part(INNER.left), top: part(INNER.top), width: part(INNER.width), height: part(INNER.height) });
  return canvas;
}

export class Plane {
  /**
   * @param {HTMLElement} box
   * @param {(psi: number, rate: number) => void} start is told where a motion is to start
   */
  constructor(box, start) {
    this.box = box;
    this.start = start;
    /** @type {Motion | null} */
    this.motion = null;
    /** @type {Motion | null} */
    this.rest = null;
    /** @type {Map | null} */
    this.map = null;
    /** @type {Limits} */
    this.limits = [[-1, 1], [-1, 1]];
  }

  draw() {
    const { motion, rest, map, limits } = this;
    // A map stands where it was computed; without one the plane reaches as far as the motion.
    /** @param {[number, number]} ends @param {number[]} values @returns {[number, number]} */
    const reach = ([low, high], values) => (map ? [low, high] : [values.reduce((least, value) => Math.min(least, value), low), values.reduce((most, value) => Math.max(most, value), high)]);
    const [left, right] = reach(limits[0], motion?.psi ?? []);
    const [low, high] = reach(limits[1], motion?.Omega ?? []);
    /** @type {import("./plot.js").Point[]} */
    const points = (motion?.psi ?? []).map((psi, index) => [psi, motion?.Omega[index] ?? NaN]);
    const plot = draw({
      description: `Motion in the plane of caster angle and yaw rate${map ? ", over the map of where motions end" : ""}`,
      curves: [{ points, kind: "cycle" }], marks: rest ? [{ at: [rest.psi[0] ?? 0, rest.Omega[0] ?? 0], kind: "equilibrium" }] : [],
      x: { label: "ψ (rad)", low: left, high: right }, y: { label: "Ω (rad/s)", low, high },
    });
    plot.element.classList.add("pickable");
    plot.element.addEventListener("click", (event) => {
      const at = plot.at(event);
      if (at) this.start(...at);
    });
    const fates = map ? [...new Set(map.cells)].map((digit) => map.fates[Number(digit)]).filter((fate) => fate !== undefined) : [];
    const swatch = (/** @type {number[]} */ color) => {
      const square = html("span", { class: "swatch" });
      square.style.background = `rgb(${color.join(" ")})`;
      return square;
    };
    const picture = html("div", { class: "plane" }, map && canvasOf(map), plot.element);
    if (map) picture.dataset.cells = String(map.cells.length);
    this.box.replaceChildren(picture, html("p", { class: "fates" }, ...fates.map(({ name, color }) => html("span", {}, swatch(color), name))));
  }
}
