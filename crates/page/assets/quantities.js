// Parameters and initial values: a slider and exact entry for each.

import { html } from "./element.js";
import { readable, sliderRange } from "./numbers.js";

/**
 * @typedef {{key: string, symbol?: string, value: number, note?: string, title?: string, range?: [number, number], check?: (value: number) => string}} Quantity
 * `symbol` is that of print, with its index after a low line; `note` stands behind the number, its unit for example
 */

/**
 * Rows of quantities. While a slider moves `moved` is told, when it rests `set`.
 * @param {HTMLElement} box
 * @param {Quantity[]} quantities
 * @param {(key: string, value: number, rests: boolean) => void} moved
 */
export function showQuantities(box, quantities, moved) {
  box.replaceChildren(...quantities.map((quantity) => row(quantity, moved)));
}

/** A key with its symbol before it, where that is another. @param {string} key @param {string} [symbol] */
function named(key, symbol) {
  if (symbol === undefined) return [key];
  const [letter, index] = symbol.split("_");
  const printed = html("var", {}, letter ?? "", index === undefined ? null : html("sub", {}, index));
  return symbol === key && index === undefined ? [printed] : [printed, html("span", { class: "key" }, key)];
}

/**
 * @param {Quantity} quantity
 * @param {(key: string, value: number, rests: boolean) => void} moved
 */
function row({ key, symbol, value, note, title, range, check }, moved) {
  const [low, high] = range ?? sliderRange(value);
  const id = `quantity-${key}`;
  const slider = html("input", { type: "range", min: low, max: high, step: "any", value, "aria-label": `${key}, slider` });
  const entry = html("input", { id, type: "text", inputmode: "decimal", value: value === Infinity ? "inf" : readable(value, 12), autocomplete: "off", spellcheck: false });
  slider.addEventListener("input", () => {
    // As many digits as the slider can be moved to.
    const rough = Number(Number(slider.value).toPrecision(4));
    entry.value = readable(rough, 12);
    moved(key, rough, false);
  });
  slider.addEventListener("change", () => moved(key, Number(Number(slider.value).toPrecision(4)), true));
  entry.addEventListener("change", () => {
    const text = entry.value.trim().toLowerCase();
    const number = text === "inf" ? Infinity : text === "" ? NaN : Number(text);
    const problem = check ? check(number) : Number.isFinite(number) ? "" : "a number";
    entry.setCustomValidity(problem);
    entry.setAttribute("aria-invalid", String(Boolean(problem)));
    if (problem) {
      entry.reportValidity();
      return;
    }
    slider.value = String(number);
    moved(key, number, true);
  });
  return html("div", { class: "quantity" }, html("label", { for: id, title }, ...named(key, symbol)), slider, entry, note ? html("span", { class: "note" }, note) : null);
}
