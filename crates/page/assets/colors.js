// Colours of one's own for curves: those of the figures, which are told apart with any colour vision.

import { html } from "./element.js";

/** @typedef {import("./state.js").Step} Step */

/** Their names, by which the server knows them and the style sheet has them. */
const NAMES = ["blue", "vermilion", "green", "purple", "orange", "sky", "black"];

/** A colour as style sheets have it; nothing where a curve has the colour of its kind. @param {Step} step */
export function ownColor(step) {
  return step.color && NAMES.includes(step.color) ? `var(--${step.color})` : undefined;
}

/** The colours of results by name, as pictures are asked with; nothing where none has one of its own. @param {Step[]} steps */
export function colorsOf(steps) {
  const own = steps.filter((step) => ownColor(step)).map((step) => [step.name, step.color]);
  return own.length ? { colors: Object.fromEntries(own) } : {};
}

/**
 * Chooses the colour of a curve.
 * @param {Step} step
 * @param {(color: string | undefined) => void} choose
 */
export function colorMenu(step, choose) {
  const select = html("select", { class: "color", "aria-label": `colour of ${step.name}`, title: "Colour" }, html("option", { value: "" }, "by kind"),
    ...NAMES.map((name) => html("option", { value: name, selected: name === step.color }, name)));
  select.style.borderLeftColor = ownColor(step) ?? `var(--${step.kind === "equilibria" ? "equilibrium" : step.kind === "cycles" ? "cycle" : "faint"})`;
  select.addEventListener("change", () => choose(select.value || undefined));
  return select;
}
