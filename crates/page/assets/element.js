// Elements of the page: made in one call, found by name.

/**
 * @typedef {Node | string | null | undefined | false} Child
 * @typedef {Record<string, string | number | boolean | undefined | null | ((event: any) => void)>} Attributes
 */

/**
 * @param {Element} element
 * @param {Attributes} attributes
 * @param {Child[]} children
 */
function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) element.setAttribute(name, String(value));
  }
  for (const child of children) if (child) element.append(child);
}

/**
 * An element of HTML. A function among the attributes listens to the event of that name.
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Attributes} [attributes]
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function html(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

/**
 * An element of SVG.
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Attributes} [attributes]
 * @param {...Child} children
 * @returns {SVGElementTagNameMap[Tag]}
 */
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(element, attributes, children);
  return element;
}

/**
 * The element of the page with this name.
 * @template {HTMLElement} [Kind=HTMLElement]
 * @param {string} id
 * @returns {Kind}
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return /** @type {Kind} */ (found);
}

/**
 * A button that listens to both pointer and keys, as elements of SVG do not by themselves.
 * @param {SVGElement} element
 * @param {(event: Event) => void} press
 */
export function pressable(element, press) {
  element.setAttribute("role", "button");
  element.setAttribute("tabindex", "0");
  element.addEventListener("click", press);
  element.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    press(event);
  });
}

/**
 * The number in a field; where it is none the field says so.
 * @param {HTMLInputElement} field
 * @returns {number | null}
 */
export function numberIn(field) {
  const value = field.value.trim() === "" ? NaN : Number(field.value);
  const isNumber = Number.isFinite(value);
  field.setCustomValidity(isNumber ? "" : "a number, such as 0.5 or 2e-3");
  field.setAttribute("aria-invalid", String(!isNumber));
  if (isNumber) return value;
  // What is written next is looked at when it is needed.
  field.addEventListener("input", () => field.setCustomValidity(""), { once: true });
  field.reportValidity();
  return null;
}

/**
 * Draws once in every frame in which something has changed; what is done is drawn at once.
 * @param {() => void} draw
 * @returns {(isDone: boolean) => void}
 */
export function inFrames(draw) {
  let frame = 0;
  const now = () => {
    cancelAnimationFrame(frame);
    frame = 0;
    draw();
  };
  return (isDone) => {
    if (isDone) now();
    else frame ||= requestAnimationFrame(now);
  };
}
