// Saves what the page draws by itself: as a picture with its colours in it, and as numbers.

import { askFile } from "./ask.js";
import { drawingOf } from "./drawing.js";
import { svg } from "./element.js";
import { INNER } from "./plot.js";
import { give, saveMenu } from "./save.js";

/** @typedef {import("./plot.js").Plot} Plot */

/** What style sheets say of an element of a picture. */
const STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "font-family", "font-size", "font-style", "visibility", "r"];
/** Width of a saved picture, in points of an SVG file and in pixels of a PNG file. */
const WIDTH = 480;
const PIXELS = 1600;
/** Width of a PDF file in points: as wide as the SVG file, whose points are smaller. */
const PDF_WIDTH = 0.75 * WIDTH;

/** The map that lies under a plot, and where it lies in the units of that. @param {SVGSVGElement} element */
function mapUnder(element) {
  const canvas = element.parentElement?.querySelector("canvas");
  if (!canvas) return null;
  const { x, y, width, height } = element.viewBox.baseVal;
  const [left, top] = [x + INNER.left * width, y + INNER.top * height];
  const frame = /** @type {import("./drawing.js").Frame} */ ([left, top, left + INNER.width * width, top + INNER.height * height]);
  return { canvas, frame };
}

/** A picture of the page as a file that stands by itself. @param {SVGSVGElement} element */
function standalone(element) {
  const copy = /** @type {SVGSVGElement} */ (element.cloneNode(true));
  const [originals, copies] = [[element, ...element.querySelectorAll("*")], [copy, ...copy.querySelectorAll("*")]];
  originals.forEach((original, index) => {
    const style = getComputedStyle(original);
    const target = copies[index];
    target?.removeAttribute("class");
    for (const name of STYLES) {
      const value = style.getPropertyValue(name);
      if (value && target instanceof SVGElement) target.setAttribute(name, value);
    }
  });
  const { x, y, width, height } = element.viewBox.baseVal;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", String(WIDTH));
  copy.setAttribute("height", String((WIDTH * height) / width));
  copy.removeAttribute("style");
  const under = mapUnder(element);
  if (under) {
    const [left, top, right, bottom] = under.frame;
    copy.prepend(svg("image", { x: left, y: top, width: right - left, height: bottom - top, href: under.canvas.toDataURL(), preserveAspectRatio: "none", "image-rendering": "pixelated" }));
  }
  copy.prepend(svg("rect", { x, y, width, height, fill: getComputedStyle(document.body).backgroundColor }));
  return new XMLSerializer().serializeToString(copy);
}

/** @param {string} text of an SVG file @param {number} ratio of height to width @returns {Promise<Blob | null>} */
async function pixels(text, ratio) {
  const image = new Image();
  // The page loads nothing but what is in its address.
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [PIXELS, Math.round(PIXELS * ratio)];
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

/** @param {string} text */
function cell(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Columns as CSV. @param {Record<string, (number | string)[]>} columns */
export function csv(columns) {
  const names = Object.keys(columns);
  const rows = Math.max(0, ...Object.values(columns).map((column) => column.length));
  const lines = [names.map(cell).join(",")];
  for (let row = 0; row < rows; row++) lines.push(names.map((name) => cell(String(columns[name]?.[row] ?? ""))).join(","));
  return `${lines.join("\n")}\n`;
}

/** The numbers of a plot: what each point belongs to, and where it is. @param {Plot} plot */
export function columnsOf(plot) {
  const parts = [
    ...plot.curves.map((curve, index) => ({ name: `${curve.kind ?? "curve"} ${index + 1}`, points: curve.points })),
    ...(plot.marks ?? []).map((mark) => ({ name: mark.text ?? mark.kind ?? "point", points: [mark.at] })),
  ];
  return {
    of: parts.flatMap(({ name, points }) => points.map(() => name)),
    [plot.x.label]: parts.flatMap(({ points }) => points.map((point) => point[0])),
    [plot.y.label]: parts.flatMap(({ points }) => points.map((point) => point[1])),
  };
}

/**
 * A menu that saves a picture of the page.
 * @param {string} what for people who do not see it
 * @param {string} name of the file, without an ending
 * @param {() => SVGSVGElement | null} picture
 * @param {() => Record<string, (number | string)[]>} columns
 * @param {string} [title] what it shows, where several stand together
 */
export function captureMenu(what, name, picture, columns, title) {
  return saveMenu(what, ["svg", "png", "pdf", "csv", "json"], async (format) => {
    if (format === "csv") return give(new Blob([csv(columns())], { type: "text/csv" }), `${name}.csv`);
    if (format === "json") return give(new Blob([JSON.stringify(columns())], { type: "application/json" }), `${name}.json`);
    const element = picture();
    if (!element) return;
    if (format === "pdf") return give(await askFile("/api/drawing", drawingOf(element, PDF_WIDTH, mapUnder(element))), `${name}.pdf`);
    const text = standalone(element);
    const { width, height } = element.viewBox.baseVal;
    const contents = format === "svg" ? new Blob([text], { type: "image/svg+xml" }) : await pixels(text, height / width);
    if (contents) give(contents, `${name}.${format}`);
  }, title);
}
