// The list of the curves that a page keeps: each with its labels and files, to be hidden and removed.

import { colorMenu, colorsOf } from "./colors.js";
import { html } from "./element.js";
import { saveMenu, saveResults, give } from "./save.js";
import { isDark } from "./zoom.js";

/**
 * @typedef {import("./chain.js").Result} Result
 * @typedef {import("./state.js").Step} Step
 * @typedef {{
 *   hide: (step: Step) => void, remove: ((step: Step) => void) | null, pick: (step: Step, index: number) => void, end: ((step: Step) => void) | null,
 *   path: string, keeps: (step: Step) => boolean, paint: (step: Step, color: string | undefined) => void,
 * }} Actions `end` starts something at the end of a motion, `path` writes files of results, and what is not kept cannot be removed
 */

/** The name of a result without the ending of its file. @param {string} name */
export function shortName(name) {
  return name.replace(/\.json$/, "");
}

/** @param {any} data @returns {string[]} why the branches of a result end */
function endsOf(data) {
  const ends = data.ends ?? [];
  const ofBranches = (data.branches ?? []).flatMap((/** @type {any} */ branch) => branch.ends.map((/** @type {string} */ cause) => ({ cause: `${cause}` })));
  return [...ends, ...ofBranches].map((/** @type {any} */ end) => end.cause).filter(Boolean);
}

/**
 * Shows the list; whoever is at one of its elements stays there.
 * @param {HTMLElement} list
 * @param {HTMLElement[]} rows
 */
export function showRows(list, rows) {
  const active = list.contains(document.activeElement) ? document.activeElement : null;
  const name = active?.getAttribute("aria-label") ?? active?.textContent;
  list.replaceChildren(...rows);
  if (!active) return;
  const again = [...list.querySelectorAll("button, input, select")].find((element) => (element.getAttribute("aria-label") ?? element.textContent) === name);
  if (again instanceof HTMLElement) again.focus();
}

/**
 * @param {Step} step
 * @param {Result | undefined} result
 * @param {Actions} actions
 */
export function stepRow(step, result, actions) {
  const from = step.from ? ` from ${step.from.label} of ${shortName(step.from.path)}` : "";
  const line = html("li", { "data-step": step.name, "data-state": !result ? "waiting" : result.running ? "running" : result.problem ? "failed" : "done" });
  const visible = html("input", { type: "checkbox", checked: !step.hidden, "aria-label": `show ${step.name}`, change: () => actions.hide(step) });
  if (actions.remove && actions.keeps(step)) {
    line.append(html("button", { type: "button", class: "quiet", "aria-label": `remove ${step.name}`, click: () => actions.remove?.(step) }, "Remove"));
  }
  line.append(html("label", {}, visible, html("strong", {}, shortName(step.name)), from));
  // What is computed anew keeps its place until it is there.
  const data = result?.data ?? (result?.running ? result.before : null);
  if (result && data) {
    const count = data.points?.length ?? data.t?.length ?? 0;
    const color = step.kind === "simulate" ? "" : colorMenu(step, (chosen) => actions.paint(step, chosen));
    line.append(` ${count} points `, color, " ", saveMenu(step.name, ["json", "csv", "text", "svg", "png", "pdf"], async (format) => {
      if (!result.text) return;
      if (format === "json") give(new Blob([result.text], { type: "application/json" }), step.name);
      else await saveResults(actions.path, { [step.name]: result.text }, { results: [step.name], dark: isDark(), ...colorsOf([step]) }, format, shortName(step.name));
    }));
    (data.points ?? []).forEach((/** @type {any} */ point, /** @type {number} */ index) => {
      if (point.label) line.append(html("button", { type: "button", class: "label", click: () => actions.pick(step, index) }, point.label));
    });
    if (step.kind === "simulate" && actions.end) line.append(html("button", { type: "button", class: "label", click: () => actions.end?.(step) }, "END"));
    const ends = endsOf(data);
    if (ends.length) line.append(html("p", { class: "note" }, `ends: ${ends.join("; ")}`));
  }
  if (result?.problem) line.append(html("p", { class: "problem" }, result.problem.message));
  for (const warning of result?.warnings ?? []) line.append(html("p", { class: "note" }, warning));
  return line;
}
