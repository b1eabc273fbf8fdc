// The lines that compute what the page shows: of the command line and of Python.

/**
 * @typedef {import("./wheel.js").Interval} Interval
 * @typedef {import("./wheel.js").Value} Value
 * @typedef {{changes: [string, Value][], x: Interval, y: Interval, counts: number[], along: Interval, at: number | null, shimmy: boolean,
 *   motion: {duration: number, perturb: [string, number][], blow: number, slides: boolean}, basin: {x: Interval, y: Interval, counts: number[]} | null,
 *   report: boolean, steps: import("./state.js").Step[]}} Shown what the page shows; `changes` are the keys in which the wheel is not the paper's
 */

/** @param {Interval} interval @param {number} [count] */
function written({ key, start, end }, count) {
  return `${key}=${start}:${end}${count ? `:${count}` : ""}`;
}

/** @param {Interval} interval @param {number} [count] */
function tuple({ key, start, end }, count) {
  return `("${key}", ${start}, ${end}${count ? `, ${count}` : ""})`;
}

/** @param {Shown} shown */
export function commandLines({ changes, x, y, counts, along, at, shimmy, motion, basin, report, steps }) {
  const wheel = changes.map(([key, value]) => ` -s ${key}=${value}`).join("");
  const contact = motion.slides ? " --contact sliding" : "";
  const kicks = motion.perturb.map(([key, value]) => ` --perturb ${key}=${value}`).join("") + (motion.blow ? ` --blow=${motion.blow}` : "");
  const lines = [
    `kingpin steady${wheel}`,
    `kingpin stability${wheel}`,
    `kingpin chart${wheel} --x ${written(x, counts[0])} --y ${written(y, counts[1])} -o chart.svg`,
    `kingpin cycles${wheel} --along ${written(along)}${at === null ? "" : ` --at ${at}`} -o cycles.json -o cycles.svg`,
    `kingpin simulate${wheel} --duration ${motion.duration}${kicks}${contact} -o motion.json`,
  ];
  for (const step of steps) {
    const words = [`kingpin ${step.kind} --from ${step.from?.path}:${step.from?.label}`];
    if (step.stay) words.push("--stay");
    if (step.along) words.push(`--along ${written(step.along)}`);
    if (step.plane) words.push(`--in ${step.plane.map((axis) => written(axis)).join(",")}`);
    lines.push(`${words.join(" ")} -o ${step.name} -o ${step.name.replace(/json$/, "svg")}`);
  }
  if (shimmy) lines.push(`kingpin shimmy${wheel} --along ${written(along)}${at === null ? "" : ` --at ${at}`} -o shimmy.json -o shimmy.svg`);
  if (basin) lines.push(`kingpin basin${wheel} --x ${written(basin.x, basin.counts[0])} --y ${written(basin.y, basin.counts[1])} --contact ${motion.slides ? "sliding" : "rolling"} -o basin.json -o basin.svg`);
  if (report) lines.push(`kingpin report${wheel} -o report`);
  return lines.join("\n");
}

/** @param {Shown} shown */
export function pythonLines({ changes, x, y, counts, along, at, shimmy, motion, basin, report, steps }) {
  const literal = (/** @type {Value | string} */ value) => (typeof value === "number" ? String(value) : `"${value}"`);
  const wheel = changes.map(([key, value]) => `${key}=${literal(value)}`).join(", ");
  const perturb = motion.perturb.length ? `, perturb={${motion.perturb.map(([key, value]) => `"${key}": ${value}`).join(", ")}}` : "";
  const blow = motion.blow ? `, blow=${motion.blow}` : "";
  const contact = motion.slides ? ', contact="sliding"' : "";
  const wanted = at === null ? "" : `, at=${at}`;
  const lines = [
    "from arclength.kingpin import Wheel",
    "",
    `wheel = Wheel(${wheel})`,
    "steady = wheel.steady()",
    "stability = wheel.stability()",
    `chart = wheel.chart(x=${tuple(x, counts[0])}, y=${tuple(y, counts[1])})`,
    `cycles = wheel.cycles(along=${tuple(along)}${wanted})`,
    `motion = wheel.simulate(${motion.duration}${perturb}${blow}${contact})`,
  ];
  const variable = (/** @type {string} */ name) => name.replace(/\.json$/, "").replaceAll("-", "_");
  for (const step of steps) {
    const words = step.plane ? step.plane.map((axis) => tuple(axis)) : step.along ? [`along=${tuple(step.along)}`] : [];
    if (step.stay) words.push("stay=True");
    lines.push(`${variable(step.name)} = ${variable(step.from?.path ?? "")}["${step.from?.label}"].${step.kind}(${words.join(", ")})`);
  }
  if (shimmy) lines.push(`shimmy = wheel.shimmy(along=${tuple(along)}${wanted})`);
  if (basin) lines.push(`basin = wheel.basin(x=${tuple(basin.x, basin.counts[0])}, y=${tuple(basin.y, basin.counts[1])}, contact="${motion.slides ? "sliding" : "rolling"}")`);
  if (report) lines.push('report = wheel.report("report")');
  return lines.join("\n");
}
