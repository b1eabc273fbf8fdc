// The curves of a wheel, as those of any model: cycles from all Hopf points, what starts at their labels, curves in two parameters. Points
// appear as they are found; every point can be picked, and is seen from above.

import { Chain } from "./chain.js";
import { Diagrams } from "./diagram.js";
import { byId, inFrames } from "./element.js";
import { choose } from "./menu.js";
import { readable } from "./numbers.js";
import { PointView, parametersAt } from "./point.js";
import { shortName, showRows, stepRow } from "./rows.js";
import { startsOfWheel } from "./starts.js";
import { freeName, without } from "./state.js";

/**
 * @typedef {import("./state.js").Step} Step
 * @typedef {import("./state.js").Interval} Interval
 * @typedef {import("./diagram.js").Picked} Picked
 * @typedef {{
 *   asked: () => any, valueOf: (key: string) => number, wanted: () => number | null, motions: import("./motions.js").Motions,
 *   messageOf: (error: unknown) => string, first: () => Step, others: () => Step[], keep: (steps: Step[], first: Step) => void,
 *   range: (key: string) => [number, number], names: () => string[], take: (values: Record<string, number>) => Promise<void>, changed: () => void,
 * }} Page what the curves need of the page
 */

/** The state whose extremes the diagrams show. */
const SHOWN = "psi";
/** The states in the order in which the server tells their extremes, of a wheel that is elastic in both directions or in one. */
const STATES = ["u", "q", "psi", "V", "Omega"];

export class Branches {
  /** @param {Page} page */
  constructor(page) {
    this.page = page;
    this.chain = new Chain(inFrames(() => this.draw()));
    /** @type {Picked | null} */
    this.picked = null;
    this.diagrams = new Diagrams(byId("diagrams"), "/api/wheel/diagram", {
      pick: (point) => this.pick(point),
      press: (point) => {
        this.pick(point);
        void this.startAt(point);
      },
    });
    this.pointView = new PointView(byId("branch-point"), {
      move: (index) => {
        if (this.picked && index >= 0) this.pick({ ...this.picked, index: Math.min(index, this.pointsOf(this.picked.name).length - 1) });
      },
      start: () => {
        if (this.picked) void this.startAt(this.picked);
      },
    });
  }

  /** All curves. */
  get steps() {
    return [this.page.first(), ...this.page.others()];
  }

  /** What is computed now, in words. */
  get running() {
    const results = [...this.chain.results.values()].filter((result) => result.running);
    return results.map((result) => `${shortName(result.name)}: ${result.points.length} points`);
  }

  /** @param {string} name @returns {any[]} */
  pointsOf(name) {
    return this.chain.results.get(name)?.data?.points ?? [];
  }

  stop() {
    this.chain.stop();
  }

  /** What a curve asks the server. @param {Step} step @returns {import("./chain.js").Question} */
  question(step) {
    const { from, along, plane } = step;
    const { page } = this;
    if (!from) {
      const wanted = page.wanted();
      return { path: "/api/wheel/cycles", request: { ...page.asked(), along, at: wanted === null ? [] : [wanted] }, from: [] };
    }
    if (step.kind === "locus") return { path: "/api/wheel/locus", request: { from, in: plane }, from: [from.path] };
    return { path: "/api/wheel/cycles", request: { from, along, stay: step.stay ?? false }, from: [from.path] };
  }

  /** Computes what is not known yet. @param {AbortSignal} signal */
  async show(signal) {
    signal.addEventListener("abort", () => this.chain.abort.abort(), { once: true });
    const computed = this.chain.run(this.steps, (step) => this.question(step));
    this.draw();
    await computed;
    if (!signal.aborted) this.draw();
  }

  draw() {
    const { page, chain, picked } = this;
    const { steps } = this;
    this.diagrams.update(steps, chain.results, SHOWN, page.valueOf("k_u") === Infinity ? STATES.filter((state) => state !== "u" && state !== "V") : STATES, picked);
    const names = new Set(steps.map((step) => step.name));
    for (const { name } of steps) page.motions.offer(name, (chain.results.get(name)?.motions ?? []).filter((motion) => motion.label));
    page.motions.withdraw(names);
    const step = steps.find((other) => other.name === picked?.name);
    const result = picked && chain.results.get(picked.name);
    if (step && result?.data?.points && picked) this.pointView.show(null, step, result, picked.index, []);
    else if (!result?.running) this.pointView.clear();
    showRows(byId("steps"), steps.map((other) => stepRow(other, chain.results.get(other.name), {
      path: "/api/wheel/diagram",
      hide: (row) => this.alter({ ...row, hidden: !row.hidden }),
      paint: (row, color) => this.alter({ ...row, color }),
      remove: (row) => page.keep(without(this.steps, row.name).slice(1), page.first()),
      pick: (row, index) => this.pick({ name: row.name, index }),
      end: null,
      keeps: (row) => Boolean(row.from),
    })));
    page.changed();
  }

  /** Keeps a curve otherwise. @param {Step} step */
  alter(step) {
    const [first = step, ...others] = this.steps.map((kept) => (kept.name === step.name ? step : kept));
    this.page.keep(others, first);
  }

  /** Picks a point, which is seen from above. @param {Picked} picked */
  pick(picked) {
    this.picked = picked;
    const result = this.chain.results.get(picked.name);
    const point = result?.data?.points[picked.index];
    if (result && point?.period) {
      let nearest = null;
      let least = 1e-9;
      for (const motion of result.motions) {
        if (!motion.at) continue;
        const [value, period] = motion.at;
        const distance = Math.abs(value - point.value) / Math.max(Math.abs(point.value), 1e-3) + Math.abs(period / point.period - 1);
        // Of a labelled cycle there are two, of which the last is the finer one.
        if (distance <= least) [least, nearest] = [distance, motion];
      }
      if (nearest) this.page.motions.pick(nearest);
    }
    this.draw();
  }

  /** Asks what is to start at a point and starts it. @param {Picked} picked */
  async startAt({ name, index }) {
    const { page } = this;
    const step = this.steps.find((other) => other.name === name);
    const data = this.chain.results.get(name)?.data;
    const point = data?.points[index];
    if (!step || !point?.label) return;
    const all = parametersAt(data, point);
    const known = page.names();
    const parameters = Object.fromEntries(Object.entries(all).filter(([key, value]) => known.includes(key) && Number.isFinite(value)));
    const there = parametersAt({ ...data, parameters: {} }, point);
    const about = (/** @type {string} */ key) => {
      const [start, end] = page.range(key);
      return { key, start: Math.min(start, parameters[key] ?? start), end: Math.max(end, parameters[key] ?? end) };
    };
    /** @type {Interval} */
    const first = step.along ?? step.plane?.[0] ?? page.first().along ?? about("v");
    /** @type {Interval} */
    const second = step.plane?.[1] ?? about(first.key === "l" ? "v" : "l");
    const at = Object.entries(there).map(([key, value]) => `${key} = ${readable(value, 7)}`).join(", ");
    const duration = point.period ? Number((10 * point.period).toPrecision(2)) : 3;
    const choice = await choose(`${point.label}, ${at}`, startsOfWheel(step.kind, point.label), parameters, [first, second], duration, (key) => page.range(key));
    if (!choice) return;
    const { start } = choice;
    if (start.needs === "nothing") return page.take(there);
    if (start.needs === "duration") return this.release(point, there, choice.duration);
    const others = page.others();
    /** @type {Step} */
    const next = { kind: start.kind, name: freeName(this.steps, start.kind), from: { path: name, label: point.label } };
    if (start.needs === "along") next.along = choice.along;
    else next.plane = choice.plane;
    if (start.stay) next.stay = true;
    page.keep([...others, next], page.first());
  }

  /** Follows a motion from a cycle: the wheel is taken there. @param {any} point @param {Record<string, number>} there @param {number} duration */
  async release(point, there, duration) {
    const { dimension = 0, states = [] } = point.orbit ?? {};
    const names = Object.keys(point.max);
    const rests = this.page.motions.nextRest();
    void this.page.take(there);
    await rests;
    // Elastic sideways only, the wheel has three states of its own.
    await this.page.motions.releaseAt(dimension === names.length ? names : ["q", "psi", "Omega"], states.slice(0, dimension), duration);
  }
}
