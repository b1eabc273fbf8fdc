// Which part of a diagram is seen: the wheel of the pointer zooms about it, dragging moves, a double click shows everything again; on the
// keyboard plus, minus, arrows and nought. The server draws the part anew.

import { html } from "./element.js";

/**
 * @typedef {import("./diagram.js").Place} Place
 * @typedef {import("./diagram.js").Span} Span
 * @typedef {{x?: [number, number], y?: [number, number]}} Window ends of the axes; an axis without is as wide as what it shows
 */

/** Factor of one turn of the wheel, of one key. */
const TURN = 1.25;
/** Part of the axes by which an arrow moves. */
const MOVE = 0.2;
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-MOVE, 0], ArrowRight: [MOVE, 0], ArrowUp: [0, MOVE], ArrowDown: [0, -MOVE] };
/** Distance in points of the page from which on a press is a drag. */
const DRAG = 4;
/** How long is waited for another turn of the wheel before the part is drawn, in milliseconds. */
const REST = 120;

/** Whether the page is dark. */
export function isDark() {
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

/** A part of an axis, from its beginning to its end. @param {Span} span @param {number} from @param {number} to @returns {[number, number]} */
function part({ low, high, logarithmic }, from, to) {
  const at = (/** @type {number} */ fraction) => (logarithmic ? low * (high / low) ** fraction : low + fraction * (high - low));
  const round = (/** @type {number} */ value) => Number(value.toPrecision(12));
  return [round(at(from)), round(at(to))];
}

export class Zoom {
  /** @param {() => void} changed is told when another part is to be seen */
  constructor(changed) {
    this.changed = changed;
    /** @type {Window} */
    this.window = {};
    /** Whether the last press was a drag. */
    this.hasDragged = false;
    /** What the axes span now. @type {{x: Span, y: Span} | null} */
    this.spans = null;
    this.timer = 0;
    const button = (/** @type {string} */ text, /** @type {string} */ name, /** @type {() => void} */ click) =>
      html("button", { type: "button", class: "zoom", "aria-label": name, title: name, click }, text);
    this.buttons = html("span", { class: "zooms" },
      button("+", "Zoom in (+)", () => this.about(0.5, 0.5, 1 / TURN)), button("−", "Zoom out (−)", () => this.about(0.5, 0.5, TURN)),
      button("All", "All of it (0)", () => this.reset()));
  }

  /** Shows everything. */
  reset() {
    this.window = {};
    this.changed();
  }

  /** Zooms about a place of the axes. @param {number} x @param {number} y @param {number} factor */
  about(x, y, factor) {
    this.see(x * (1 - factor), x + (1 - x) * factor, y * (1 - factor), y + (1 - y) * factor);
  }

  /** Shows a part of the axes. @param {number} left @param {number} right @param {number} low @param {number} high */
  see(left, right, low, high) {
    if (!this.spans) return;
    const window = { x: part(this.spans.x, left, right), y: part(this.spans.y, low, high) };
    // Beyond these nothing could be told apart.
    const isWide = ([from, to] = [0, 0]) => Math.abs(to - from) > 1e-9 * Math.max(Math.abs(from), Math.abs(to)) && Math.abs(to - from) < 1e12;
    if (!isWide(window.x) || !isWide(window.y)) return;
    this.window = window;
    const { x, y } = this.spans;
    this.spans = { x: { ...x, low: window.x[0], high: window.x[1] }, y: { ...y, low: window.y[0], high: window.y[1] } };
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.changed(), REST);
  }

  /**
   * Listens to a picture that has just been drawn.
   * @param {SVGSVGElement} overlay
   * @param {HTMLElement} box in which it lies, which hears the keys
   * @param {Place} place
   * @param {{width: number, height: number}} size
   */
  attach(overlay, box, place, size) {
    this.spans = { x: place.x, y: place.y };
    const fractions = (/** @type {MouseEvent} */ event) => {
      const bounds = overlay.getBoundingClientRect();
      const x = ((event.clientX - bounds.left) / bounds.width) * size.width;
      const y = ((event.clientY - bounds.top) / bounds.height) * size.height;
      return /** @type {const} */ ([(x - place.left) / (place.right - place.left), (place.bottom - y) / (place.bottom - place.top)]);
    };
    const isWithin = (/** @type {readonly [number, number]} */ [x, y]) => x >= 0 && x <= 1 && y >= 0 && y <= 1;
    overlay.addEventListener("wheel", (event) => {
      const at = fractions(event);
      // Beside the axes the page scrolls.
      if (!isWithin(at) || !event.deltaY) return;
      event.preventDefault();
      this.about(at[0], at[1], event.deltaY > 0 ? TURN : 1 / TURN);
    }, { passive: false });
    overlay.addEventListener("dblclick", () => this.reset());
    overlay.addEventListener("pointerdown", (event) => {
      this.hasDragged = false;
      const start = fractions(event);
      if (event.button !== 0 || event.pointerType === "touch" || !isWithin(start)) return;
      const [clientX, clientY] = [event.clientX, event.clientY];
      const drawn = /** @type {SVGElement | null} */ (box.querySelector(".drawn"));
      let to = start;
      const move = (/** @type {PointerEvent} */ moved) => {
        const [dx, dy] = [moved.clientX - clientX, moved.clientY - clientY];
        if (!this.hasDragged && Math.hypot(dx, dy) < DRAG) return;
        this.hasDragged = true;
        to = fractions(moved);
        // Until it is drawn anew the picture itself moves along.
        if (drawn) drawn.style.translate = `${dx}px ${dy}px`;
      };
      const end = () => {
        removeEventListener("pointermove", move);
        if (!this.hasDragged) return;
        const [dx, dy] = [to[0] - start[0], to[1] - start[1]];
        this.see(-dx, 1 - dx, -dy, 1 - dy);
      };
      addEventListener("pointermove", move);
      addEventListener("pointerup", end, { once: true });
    });
    box.tabIndex = 0;
    box.onkeydown = (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const [dx, dy] = ARROWS[event.key] ?? [0, 0];
      if (event.key === "+" || event.key === "=") this.about(0.5, 0.5, 1 / TURN);
      else if (event.key === "-") this.about(0.5, 0.5, TURN);
      else if (event.key === "0") this.reset();
      else if (dx || dy) this.see(dx, 1 + dx, dy, 1 + dy);
      else return;
      event.preventDefault();
    };
  }
}
