// Small plots that follow the pointer and what arrives: drawn here, at once. Finished diagrams are drawn by the server.

import { svg } from "./element.js";
import { extent, readable, ticks } from "./numbers.js";

/**
 * @typedef {[number, number]} Point
 * @typedef {{points: Point[], kind?: string, dashed?: boolean, arrows?: number, color?: string | undefined}} Curve `kind` is a class of the style sheet; so many
 * arrow heads tell in which direction it is passed; `color` is one in place of that of the kind
 * @typedef {{at: Point, kind?: string, text?: string, shape?: "cross" | "dot", color?: string | undefined}} Mark
 * @typedef {{label: string, low?: number, high?: number}} PlotAxis
 * @typedef {{
 *   description: string, x: PlotAxis, y: PlotAxis, curves: Curve[], marks?: Mark[],
 *   equal?: boolean, circle?: boolean, width?: number, height?: number,
 * }} Plot `equal`: the same scale on both axes; `circle`: the unit circle
 * @typedef {{element: SVGSVGElement, at: (event: MouseEvent) => Point | null, place: (point: Point) => Point}} Drawn
 */

const MARGIN = { left: 46, right: 8, top: 8, bottom: 34 };
const WIDTH = 300;
const HEIGHT = 220;

/** Where the axes of a plot of the usual size stand, in parts of its width and height. */
export const INNER = {
  left: MARGIN.left / WIDTH, top: MARGIN.top / HEIGHT, width: (WIDTH - MARGIN.left - MARGIN.right) / WIDTH, height: (HEIGHT - MARGIN.top - MARGIN.bottom) / HEIGHT,
};

/** Names of clipping paths are those of the whole page. */
let clips = 0;

/**
 * Draws a plot.
 * @param {Plot} plot
 * @returns {Drawn}
 */
export function draw(plot) {
  const { width = WIDTH, height = HEIGHT } = plot;
  const marks = plot.marks ?? [];
  const all = [...plot.curves.flatMap((curve) => curve.points), ...marks.map((mark) => mark.at)];
  if (plot.circle) all.push([-1.1, -1.1], [1.1, 1.1]);
  let [left, right] = range(plot.x, all.map((point) => point[0]));
  let [low, high] = range(plot.y, all.map((point) => point[1]));
  const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  if (plot.equal) {
    const unit = Math.max((right - left) / inner.width, (high - low) / inner.height);
    const [x, y] = [(left + right) / 2, (low + high) / 2];
    [left, right] = [x - (unit * inner.width) / 2, x + (unit * inner.width) / 2];
    [low, high] = [y - (unit * inner.height) / 2, y + (unit * inner.height) / 2];
  }
  /** @param {Point} point @returns {Point} */
  const place = ([x, y]) => [
    MARGIN.left + ((x - left) / (right - left)) * inner.width,
    MARGIN.top + ((high - y) / (high - low)) * inner.height,
  ];
  const element = svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "plot", role: "img", "aria-label": plot.description });
  const clip = `clip-${++clips}`;
  element.append(svg("title", {}, plot.description), svg("clipPath", { id: clip }, svg("rect", { x: MARGIN.left, y: MARGIN.top, width: inner.width, height: inner.height })));
  const bottom = MARGIN.top + inner.height;
  for (const value of ticks(left, right, inner.width / 70)) {
    const [x] = place([value, 0]);
    element.append(svg("line", { class: "tick", x1: x, x2: x, y1: bottom, y2: bottom - 4 }));
    element.append(svg("text", { class: "value", x, y: bottom + 12, "text-anchor": "middle" }, readable(value, 4)));
  }
  for (const value of ticks(low, high, inner.height / 40)) {
    const [, y] = place([0, value]);
    element.append(svg("line", { class: "tick", x1: MARGIN.left, x2: MARGIN.left + 4, y1: y, y2: y }));
    element.append(svg("text", { class: "value", x: MARGIN.left - 4, y: y + 3, "text-anchor": "end" }, readable(value, 4)));
  }
  if (plot.circle) element.append(polyline(circle().map(place), "reference"));
  if (plot.equal && !plot.circle && left < 0 && right > 0) element.append(polyline([place([0, low]), place([0, high])], "reference"));
  for (const curve of plot.curves) {
    const line = polyline(curve.points.map(place), `curve ${curve.kind ?? ""}${curve.dashed ? " dashed" : ""}`);
    // What leaves the axes that were asked for is cut off.
    line.setAttribute("clip-path", `url(#${clip})`);
    if (curve.color) line.style.stroke = curve.color;
    element.append(line);
    for (const head of arrowHeads(curve.points.map(place), curve.arrows ?? 0)) {
      element.append(svg("path", { class: `arrow ${curve.kind ?? ""}`, d: head, "clip-path": `url(#${clip})` }));
    }
  }
  for (const mark of marks) {
    const [x, y] = place(mark.at);
    if (mark.shape === "cross") {
      element.append(svg("path", { class: `cross ${mark.kind ?? ""}`, d: `M${x - 3.5} ${y - 3.5}L${x + 3.5} ${y + 3.5}M${x + 3.5} ${y - 3.5}L${x - 3.5} ${y + 3.5}` }));
    } else {
      const dot = svg("circle", { class: `dot ${mark.kind ?? ""}`, cx: x, cy: y, r: 3 });
      if (mark.color) dot.style.stroke = mark.color;
      if (mark.color && !mark.kind?.includes("open")) dot.style.fill = mark.color;
      element.append(dot);
    }
    if (mark.text) element.append(svg("text", { class: "value", x: x + 5, y: y - 5 }, mark.text));
  }
  element.append(svg("rect", { class: "frame", x: MARGIN.left, y: MARGIN.top, width: inner.width, height: inner.height }));
  element.append(svg("text", { class: "label", x: MARGIN.left + inner.width / 2, y: height - 6, "text-anchor": "middle" }, plot.x.label));
  const turned = `translate(11 ${MARGIN.top + inner.height / 2}) rotate(-90)`;
  element.append(svg("text", { class: "label", transform: turned, "text-anchor": "middle" }, plot.y.label));
  return {
    element,
    place,
    at(event) {
      const box = element.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * width;
      const y = ((event.clientY - box.top) / box.height) * height;
      const inside = x >= MARGIN.left && x <= width - MARGIN.right && y >= MARGIN.top && y <= bottom;
      if (!inside) return null;
      return [left + ((x - MARGIN.left) / inner.width) * (right - left), high - ((y - MARGIN.top) / inner.height) * (high - low)];
    },
  };
}

/**
 * @param {PlotAxis} axis
 * @param {number[]} values
 * @returns {[number, number]}
 */
function range(axis, values) {
  const [low, high] = extent(values);
  return [axis.low ?? low, axis.high ?? high];
}

/**
 * Arrow heads at equal distances along a line of the page, as paths.
 * @param {Point[]} line
 * @param {number} count
 */
function arrowHeads(line, count) {
  const points = line.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
  const ways = [0];
  points.forEach(([x, y], index) => {
    const before = points[index - 1];
    if (before) ways.push((ways.at(-1) ?? 0) + Math.hypot(x - before[0], y - before[1]));
  });
  const whole = ways.at(-1) ?? 0;
  // On a line that is hardly longer than its heads they would only hide it.
  if (whole < 20 * count) return [];
  const heads = [];
  for (let head = 0; head < count; head++) {
    const way = ((head + 0.5) / count) * whole;
    const index = ways.findIndex((passed) => passed >= way);
    const [from, to] = [points[index - 1], points[index]];
    if (!from || !to) continue;
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const [ex, ey] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    const part = (way - (ways[index - 1] ?? 0)) / length;
    const [x, y] = [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])];
    const corner = (/** @type {number} */ along, /** @type {number} */ aside) => `${(x + along * ex - aside * ey).toFixed(1)} ${(y + along * ey + aside * ex).toFixed(1)}`;
    heads.push(`M${corner(4, 0)}L${corner(-3, 3)}L${corner(-3, -3)}Z`);
  }
  return heads;
}

/** @returns {Point[]} */
function circle() {
  return Array.from({ length: 121 }, (_, index) => [Math.cos((index * Math.PI) / 60), Math.sin((index * Math.PI) / 60)]);
}

/**
 * @param {Point[]} points
 * @param {string} kind
 */
function polyline(points, kind) {
  const finite = points.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
  const text = finite.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");
  return svg("polyline", { class: kind, points: text });
}
