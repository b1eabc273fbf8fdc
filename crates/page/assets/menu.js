// Asks what is to start at a labelled point, along which parameters.

import { html, numberIn } from "./element.js";
import { readable, sliderRange } from "./numbers.js";

/**
 * @typedef {import("./state.js").Interval} Interval
 * @typedef {import("./starts.js").Start} Start
 * @typedef {{start: Start, along: Interval, plane: [Interval, Interval], duration: number}} Choice `along`, `plane` and `duration` are those asked for
 */

/** The fields of a parameter and its interval. */
class IntervalFields {
  /**
   * @param {string} name
   * @param {Record<string, number>} parameters
   * @param {Interval} interval
   * @param {(key: string) => [number, number]} rangeOf
   */
  constructor(name, parameters, interval, rangeOf) {
    const keys = Object.keys(parameters);
    this.key = html("select", { "aria-label": `${name} parameter` }, ...keys.map((key) => html("option", { value: key }, key)));
    this.key.value = interval.key;
    this.start = html("input", { type: "text", inputmode: "decimal", "aria-label": `${name} parameter, from` });
    this.end = html("input", { type: "text", inputmode: "decimal", "aria-label": `${name} parameter, to` });
    this.start.value = readable(interval.start);
    this.end.value = readable(interval.end);
    this.key.addEventListener("change", () => {
      const [low, high] = rangeOf(this.key.value);
      this.start.value = readable(low);
      this.end.value = readable(high);
    });
    this.row = html("div", { class: "interval" }, this.key, " from ", this.start, " to ", this.end);
  }

  /** Nothing where its ends are no numbers. @returns {Interval | null} */
  get interval() {
    const [first, second] = [numberIn(this.start), numberIn(this.end)];
    return first === null || second === null ? null : { key: this.key.value, start: Math.min(first, second), end: Math.max(first, second) };
  }
}

/**
 * Shows the menu; the answer is nothing where it was closed.
 * @param {string} title
 * @param {Start[]} starts
 * @param {Record<string, number>} parameters with their values there
 * @param {[Interval, Interval]} intervals that are offered first
 * @param {number} duration
 * @param {(key: string) => [number, number]} [rangeOf] an interval of a parameter
 * @returns {Promise<Choice | null>}
 */
export function choose(title, starts, parameters, intervals, duration, rangeOf = (key) => sliderRange(parameters[key] ?? 0)) {
  return new Promise((resolve) => {
    const [first, second] = intervals;
    const along = new IntervalFields("first", parameters, first, rangeOf);
    const other = new IntervalFields("second", parameters, second, rangeOf);
    const time = html("input", { type: "text", inputmode: "decimal", "aria-label": "duration" });
    time.value = readable(duration);
    /** @type {Choice | null} */
    let choice = null;
    const dialog = html("dialog", { class: "menu", "aria-label": title });
    const button = (/** @type {Start} */ start) =>
      html("button", {
        type: "button",
        click: () => {
          const chosen = start.needs === "along" || start.needs === "plane" ? along.interval : first;
          const beside = start.needs === "plane" ? other.interval : second;
          const lasts = start.needs === "duration" ? numberIn(time) : duration;
          if (!chosen || !beside || lasts === null) return;
          choice = { start, along: chosen, plane: [chosen, beside], duration: lasts };
          dialog.close();
        },
      }, start.title);
    const needing = (/** @type {Start["needs"]} */ need) => starts.filter((start) => start.needs === need).map(button);
    const group = (/** @type {HTMLElement[]} */ fields, /** @type {HTMLElement[]} */ buttons) =>
      buttons.length ? html("fieldset", {}, ...fields, ...buttons) : null;
    const canVaryTwo = Object.keys(parameters).length > 1;
    dialog.append(
      html("h2", {}, title),
      group([along.row], needing("along")) ?? "",
      (canVaryTwo && group([...(needing("along").length ? [] : [along.row]), html("div", {}, "in the parameter above and"), other.row], needing("plane"))) || "",
      group([html("div", { class: "interval" }, "lasts ", time)], needing("duration")) ?? "",
      group([], needing("nothing")) ?? "",
      html("button", { type: "button", class: "quiet", click: () => dialog.close() }, "Cancel"),
    );
    dialog.addEventListener("click", (event) => {
      if (event.target === dialog) dialog.close();
    });
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(choice);
    });
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelector("button")?.focus();
  });
}
