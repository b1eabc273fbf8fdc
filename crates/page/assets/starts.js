// What can start at a labelled point.

/**
 * @typedef {import("./state.js").Step} Step
 * @typedef {{
 *   title: string, kind: Step["kind"], needs: "along" | "plane" | "duration" | "nothing", stay?: boolean,
 * }} Start `needs`: a parameter with its interval, two of them, how long it lasts, or nothing
 */

/** The kind of a label: `HB` of `HB1`. @param {string} label */
export function labelKind(label) {
  return label.replace(/\d+$/, "");
}

const OF_EQUILIBRIA = /** @type {Record<string, string>} */ ({
  HB: "Curve of Hopf points in two parameters",
  LP: "Curve of folds in two parameters",
  BP: "Curve of branch points in two parameters",
});
const OF_CYCLES = /** @type {Record<string, string>} */ ({
  LPC: "Curve of folds of cycles in two parameters",
  PD: "Curve of period doublings in two parameters",
  NS: "Curve of torus bifurcations in two parameters",
});

/**
 * What can start at a labelled point of a branch of cycles, or of a curve, of a wheel.
 * @param {Step["kind"]} kind
 * @param {string} label
 * @returns {Start[]}
 */
export function startsOfWheel(kind, label) {
  const point = labelKind(label);
  /** @type {Start[]} */
  const starts = [];
  if (point === "HB") {
    starts.push({ title: "Cycles that are born there", kind: "cycles", needs: "along" });
    if (kind === "cycles") starts.push({ title: "Curve of Hopf points in two parameters", kind: "locus", needs: "plane" });
  } else if (kind === "cycles") {
    if (point === "PD") starts.push({ title: "Doubled cycles", kind: "cycles", needs: "along" });
    if (point === "BPC") starts.push({ title: "The other branch of cycles", kind: "cycles", needs: "along" });
    const curve = OF_CYCLES[point];
    if (curve) starts.push({ title: curve, kind: "locus", needs: "plane" });
    starts.push({ title: "The cycles through it", kind: "cycles", needs: "along", stay: point === "PD" || point === "BPC" });
  }
  if (kind === "cycles" && point !== "HB") starts.push({ title: "A motion from there", kind: "simulate", needs: "duration" });
  starts.push({ title: "Take the wheel there", kind: "equilibria", needs: "nothing" });
  return starts;
}

/**
 * What can start at a labelled point of a result.
 * @param {Step["kind"]} kind that of the step that gave the result
 * @param {string} label
 * @param {boolean} isCycle whether the point is a cycle
 * @returns {Start[]}
 */
export function startsAt(kind, label, isCycle) {
  const point = labelKind(label);
  /** @type {Start[]} */
  const starts = [];
  if (kind === "simulate") {
    return [
      { title: "Cycles on which the motion has settled", kind: "cycles", needs: "along" },
      { title: "The motion goes on", kind: "simulate", needs: "duration" },
    ];
  }
  if (kind === "equilibria") {
    if (point === "HB") starts.push({ title: "Cycles that are born there", kind: "cycles", needs: "along" });
    if (point === "BP") starts.push({ title: "The other branch", kind: "equilibria", needs: "along" });
    const curve = OF_EQUILIBRIA[point];
    if (curve) starts.push({ title: curve, kind: "locus", needs: "plane" });
  }
  if (kind === "cycles") {
    if (point === "PD") starts.push({ title: "Doubled cycles", kind: "cycles", needs: "along" });
    if (point === "BPC") starts.push({ title: "The other branch of cycles", kind: "cycles", needs: "along" });
    const curve = OF_CYCLES[point];
    if (curve) starts.push({ title: curve, kind: "locus", needs: "plane" });
  }
  if (isCycle) starts.push({ title: "The cycles through it", kind: "cycles", needs: "along", stay: point === "PD" || point === "BPC" });
  else if (point !== "BP") starts.push({ title: "The equilibria through it", kind: "equilibria", needs: "along" });
  starts.push({ title: "A motion from there", kind: "simulate", needs: "duration" });
  return starts;
}
