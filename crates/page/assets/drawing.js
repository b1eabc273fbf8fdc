// A picture of the page as plain shapes and texts, from which the server writes a PDF file.

/**
 * @typedef {[number, number]} Point
 * @typedef {[number, number, number, number]} Color red, green and blue from 0 to 255, opacity from 0 to 1
 * @typedef {[number, number, number, number]} Frame left, top, right, bottom
 * @typedef {{color: Color, width: number, dashed: boolean}} Stroke
 * @typedef {{fill?: Color, stroke?: Stroke, clip?: Frame}} Style
 * @typedef {Style & {kind: "lines", lines: Point[][]}} Lines
 * @typedef {Style & {kind: "polygon", corners: Point[]}} Polygon
 * @typedef {Style & {kind: "circle", center: Point, radius: number}} Circle
 * @typedef {{kind: "text", text: string, at: Point, size: number, anchor: number, degrees: number, color: Color}} Text
 * @typedef {{kind: "raster", frame: Frame, columns: number, pixels: number[]}} Raster
 * @typedef {Lines | Polygon | Circle | Text | Raster} Item
 * @typedef {{width: number, height: number, title: string, paper: Color, items: Item[]}} Drawing lengths in points from the upper left corner
 */

/** Part of the width of a text that lies left of its place. */
const ANCHORS = /** @type {Record<string, number>} */ ({ middle: 0.5, end: 1 });

/** A colour of a style sheet. @param {string} text @param {string} [opacity] @returns {Color | null} */
function colorOf(text, opacity = "1") {
  const numbers = text.match(/[\d.]+/g)?.map(Number) ?? [];
  const [red, green, blue, own = 1] = numbers;
  const whole = own * Number(opacity);
  return red === undefined || green === undefined || blue === undefined || whole === 0 ? null : [red, green, blue, whole];
}

/** @param {string} text of numbers in pairs @returns {Point[]} */
function pairs(text) {
  const numbers = text.match(/-?[\d.]+(?:e[-+]?\d+)?/g)?.map(Number) ?? [];
  return Array.from({ length: Math.floor(numbers.length / 2) }, (_, index) => [numbers[2 * index] ?? 0, numbers[2 * index + 1] ?? 0]);
}

/** @param {Element} element @param {string[]} names */
function attributes(element, ...names) {
  return names.map((name) => Number(element.getAttribute(name) ?? 0));
}

/** The pieces of a shape in its own units, and whether they are closed. @param {SVGElement} element @returns {{pieces: Point[][], closed: boolean}} */
function piecesOf(element) {
  if (element.localName === "polyline") return { pieces: [pairs(element.getAttribute("points") ?? "")], closed: false };
  if (element.localName === "line") {
    const [x1 = 0, y1 = 0, x2 = 0, y2 = 0] = attributes(element, "x1", "y1", "x2", "y2");
    return { pieces: [[[x1, y1], [x2, y2]]], closed: false };
  }
  if (element.localName === "rect") {
    const [x = 0, y = 0, width = 0, height = 0] = attributes(element, "x", "y", "width", "height");
    return { pieces: [[[x, y], [x + width, y], [x + width, y + height], [x, y + height]]], closed: true };
  }
  const text = element.getAttribute("d") ?? "";
  return { pieces: text.split("M").slice(1).map(pairs), closed: text.endsWith("Z") };
}

/** The shapes of one picture. */
class Collector {
  /** @param {SVGSVGElement} element @param {number} width of the drawing */
  constructor(element, width) {
    this.element = element;
    this.box = element.viewBox.baseVal;
    this.scale = width / this.box.width;
    this.toPicture = element.getScreenCTM()?.inverse();
  }

  /** @param {SVGGraphicsElement} element @returns {(point: Point) => Point} */
  placing(element) {
    const own = element.getScreenCTM();
    const matrix = this.toPicture && own ? this.toPicture.multiply(own) : new DOMMatrix();
    return ([x, y]) => {
      const at = new DOMPoint(x, y).matrixTransform(matrix);
      return [this.scale * (at.x - this.box.x), this.scale * (at.y - this.box.y)];
    };
  }

  /** @param {Element} element @param {CSSStyleDeclaration} style @returns {Style} */
  style(element, style) {
    const fill = colorOf(style.fill, style.fillOpacity);
    const stroke = colorOf(style.stroke);
    const clipped = element.getAttribute("clip-path")?.slice(5, -1);
    const rect = clipped && this.element.querySelector(`#${clipped} rect`);
    const [x = 0, y = 0, width = 0, height = 0] = rect ? attributes(rect, "x", "y", "width", "height") : [];
    const place = ([px, py] = [0, 0]) => [this.scale * (px - this.box.x), this.scale * (py - this.box.y)];
    return {
      ...(fill ? { fill } : {}),
      ...(stroke ? { stroke: { color: stroke, width: this.scale * parseFloat(style.strokeWidth), dashed: style.strokeDasharray !== "none" } } : {}),
      ...(rect ? { clip: /** @type {Frame} */ ([...place([x, y]), ...place([x + width, y + height])]) } : {}),
    };
  }

  /** @param {SVGGraphicsElement} element @returns {Item[]} */
  items(element) {
    const style = getComputedStyle(element);
    if (style.visibility === "hidden" || style.display === "none") return [];
    const place = this.placing(element);
    const [x = 0, y = 0] = attributes(element, "x", "y");
    if (element.localName === "text") {
      const color = colorOf(style.fill);
      const [from, to] = [place([x, y]), place([x + 1, y])];
      const degrees = (Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI;
      // Print has a sign of its own for what a keyboard writes as a hyphen.
      const text = (element.textContent ?? "").replace(/^-(?=[\d.])/, "−");
      return color && text ? [{ kind: "text", text, at: from, size: this.scale * parseFloat(style.fontSize), anchor: ANCHORS[style.textAnchor] ?? 0, degrees, color }] : [];
    }
    const drawn = this.style(element, style);
    if (!drawn.fill && !drawn.stroke) return [];
    if (element.localName === "circle") {
      const [cx = 0, cy = 0] = attributes(element, "cx", "cy");
      return [{ kind: "circle", center: place([cx, cy]), radius: this.scale * parseFloat(style.getPropertyValue("r")), ...drawn }];
    }
    const { pieces, closed } = piecesOf(element);
    const placed = pieces.map((piece) => piece.map(place)).filter((piece) => piece.length > 1);
    if (closed) return placed.map((corners) => ({ kind: "polygon", corners, ...drawn }));
    const { fill: _, ...line } = drawn;
    return placed.length && line.stroke ? [{ kind: "lines", lines: placed, ...line }] : [];
  }
}

/**
 * A map that lies under a picture as an item of its drawing.
 * @param {HTMLCanvasElement} canvas
 * @param {Frame} frame
 * @returns {Raster[]}
 */
function rasterOf(canvas, frame) {
  const data = canvas.getContext("2d")?.getImageData(0, 0, canvas.width, canvas.height).data;
  return data ? [{ kind: "raster", frame, columns: canvas.width, pixels: [...data] }] : [];
}

/**
 * A picture of the page as plain shapes, on the paper of the page.
 * @param {SVGSVGElement} element
 * @param {number} width in points
 * @param {{canvas: HTMLCanvasElement, frame: Frame} | null} under a map under it, and where that lies in the units of the picture
 * @returns {Drawing}
 */
export function drawingOf(element, width, under) {
  const collector = new Collector(element, width);
  const { box, scale } = collector;
  const shapes = /** @type {SVGGraphicsElement[]} */ ([...element.querySelectorAll("line, polyline, path, rect, circle, text")]);
  const frame = under?.frame.map((value, index) => scale * (value - (index % 2 ? box.y : box.x)));
  return {
    width, height: scale * box.height, title: element.getAttribute("aria-label") ?? "",
    paper: colorOf(getComputedStyle(document.body).backgroundColor) ?? [255, 255, 255, 1],
    items: [
      ...(under && frame ? rasterOf(under.canvas, /** @type {Frame} */ (frame)) : []),
      ...shapes.filter((shape) => !shape.closest("clipPath")).flatMap((shape) => collector.items(shape)),
    ],
  };
}
