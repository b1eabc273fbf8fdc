// The motions of the wheel: the uniform one, cycles, shimmy, and what was let go or hit; from above, over the time, and in the plane of
// caster angle and yaw rate with its basins.

import { Above } from "./above.js";
import { Refusal } from "./ask.js";
import { captureMenu } from "./capture.js";
import { byId, html, numberIn } from "./element.js";
import { extent, readable } from "./numbers.js";
import { Plane } from "./plane.js";
import { draw } from "./plot.js";

/**
 * @typedef {import("./above.js").Motion} Motion
 * @typedef {import("./wheel.js").Answer} Answer
 * @typedef {{
 *   asked: () => any, valueOf: (key: string) => number, changed: () => void, keep: (name: string, answer: Answer | null) => void,
 *   compute: (name: string, path: string, request: any, signal?: AbortSignal) => Promise<Answer>, wantsBasin: () => boolean, signal: () => AbortSignal,
 * }} Page what motions need of the page
 */

/** The fastest swing that an eye follows, in rad/s: what is faster is played slower. */
const SHOWN_SWING = 9;
/** Caster angles to either side in the plane, in rad, and yaw rates in parts of what the fastest swing makes of them. */
const WIDEST = 1;
const FASTEST = 1.4;
/** Motions across and up in a basin: at once, and then. */
const COARSE = [25, 17];
const FINE = [81, 61];

/** The name of the motion of the point that is picked, among those of branches. */
const PICKED = "picked";

/** A motion as columns. @param {Motion | null} motion @returns {Record<string, number[]>} */
function columnsOfMotion(motion) {
  if (!motion) return {};
  const { t, u, q, psi, Omega, king_pin_force: [kingX, kingY], ground_force: [groundX, groundY] } = motion;
  return { t, u, q, psi, Omega, king_pin_force_x: kingX, king_pin_force_y: kingY, ground_force_x: groundX, ground_force_y: groundY };
}

/** @param {string} id */
function field(id) {
  return /** @type {HTMLInputElement} */ (byId(id));
}

export class Motions {
  /** @param {Page} page */
  constructor(page) {
    this.page = page;
    this.above = new Above(byId("above"), (psi) => {
      field("kick").value = readable(psi - this.uniform("psi"), 3);
      field("blow").value = "0";
      void this.release([["psi", Number(field("kick").value)]], 0);
    });
    this.plane = new Plane(byId("plane"), (psi, rate) => {
      const round = (/** @type {number} */ value) => Number(value.toPrecision(4));
      void this.release([["psi", round(psi - this.uniform("psi"))], ["Omega", round(rate - this.uniform("Omega"))]], 0);
    });
    /** The uniform motion. @type {Motion | null} */
    this.uniformMotion = null;
    /** What can be played besides, by the branch it belongs to. @type {Record<string, Motion[]>} */
    this.offered = { shimmy: [], motion: [] };
    /** All states of it. @type {Record<string, number>} */
    this.uniformState = {};
    /** Who waits for the uniform motion of another wheel. @type {(() => void)[]} */
    this.waiting = [];
    /** Changes of the states from which the last motion started. @type {[string, number][]} */
    this.perturb = [];
    this.blow = 0;
    /** Whether the user has said whether the wheel may slide. */
    this.hasChosen = false;
    /** Ends the motion before when another one is let go. */
    this.abort = new AbortController();
    byId("slides").addEventListener("change", () => {
      this.hasChosen = true;
      page.changed();
    });
    byId("let-go").addEventListener("click", () => {
      const kick = numberIn(field("kick"));
      if (kick !== null) void this.release([["psi", kick]], 0);
    });
    byId("hit").addEventListener("click", () => {
      const blow = numberIn(field("blow"));
      if (blow !== null) void this.release([], blow * Number(field("blow-side").value));
    });
    const tellPlay = () => (byId("play").textContent = this.above.isPlaying ? "Pause" : "Play");
    tellPlay();
    byId("play").addEventListener("click", () => {
      this.above.isPlaying = !this.above.isPlaying;
      tellPlay();
    });
    byId("shown-motion").addEventListener("change", () => this.choose());
    const columns = () => columnsOfMotion(this.above.motion ?? this.uniformMotion);
    byId("above-tools").append(captureMenu("the wheel from above", "above", () => byId("above").querySelector("svg"), columns));
    byId("plane-tools").append(captureMenu("the plane", "plane", () => byId("plane").querySelector("svg"), columns, "Save the picture…"));
  }

  /** A state of the uniform motion. @param {"psi" | "Omega"} state */
  uniform(state) {
    return this.uniformMotion?.[state][0] ?? 0;
  }

  /** What was let go last, for the lines. */
  asked() {
    /** @type {[string, number][]} */
    const perturb = this.perturb.length || this.blow ? this.perturb : [["psi", Number(field("kick").value)]];
    return { duration: Number(field("duration").value), perturb, blow: this.blow, slides: field("slides").checked };
  }

  /**
   * Shows the uniform motion of another wheel.
   * @param {any} verdict
   * @param {boolean} isRigid
   */
  rest(verdict, isRigid) {
    const { above, plane, page } = this;
    this.abort.abort();
    this.uniformMotion = verdict.above;
    this.uniformState = verdict.state;
    // A wheel that rolls in its uniform motion may slide when it is kicked; one with a tyre has a law of its own.
    if (!this.hasChosen) field("slides").checked = verdict.rolls && isRigid;
    const swing = Math.max(...verdict.eigenvalues.map((/** @type {[number, number]} */ [, im]) => Math.abs(im)));
    above.speed = swing > SHOWN_SWING ? SHOWN_SWING / swing : 1;
    byId("slowness").textContent = above.speed < 1 ? `It plays ${readable(1 / above.speed, 2)} times slower than it moves.` : "";
    above.show({ l: page.valueOf("l"), R: page.valueOf("R"), r: page.valueOf("r"), v: page.valueOf("v") }, verdict.above);
    const middle = this.uniform("Omega");
    const half = Number((FASTEST * Math.max(swing, Math.abs(middle), 1) * WIDEST).toPrecision(2));
    const round = (/** @type {number} */ value) => Number(value.toPrecision(3));
    plane.limits = [[-WIDEST, WIDEST], [round(middle - half), round(middle + half)]];
    Object.assign(plane, { rest: verdict.above, motion: null, map: null });
    plane.draw();
    this.offered = { shimmy: [], motion: [] };
    page.keep("motion", null);
    page.keep("basin", null);
    byId("history").replaceChildren();
    byId("motion-note").textContent = "";
    this.list("");
  }

  /** Tells who waits that the uniform motion is that of the wheel. */
  rested() {
    this.waiting.splice(0).forEach((go) => go());
  }

  /** Offers the motions of a branch. @param {string} name @param {Motion[]} motions */
  offer(name, motions) {
    if (this.offered[name]?.length === motions.length && motions.every((motion, index) => motion === this.offered[name]?.[index])) return;
    this.offered[name] = motions;
    this.list(/** @type {HTMLSelectElement} */ (byId("shown-motion")).value);
  }

  /** Offers no more what belongs to curves that are gone. @param {Set<string>} names of those that are there */
  withdraw(names) {
    const gone = Object.keys(this.offered).filter((name) => name.endsWith(".json") && !names.has(name));
    gone.forEach((name) => delete this.offered[name]);
    if (gone.length) this.list(/** @type {HTMLSelectElement} */ (byId("shown-motion")).value);
  }

  /** Plays the motion of a point that is picked. @param {Motion} motion */
  pick(motion) {
    this.offered[PICKED] = [motion];
    this.list(`${PICKED}:0`);
    this.show(motion);
  }

  /** Waits for the uniform motion of another wheel. @returns {Promise<void>} */
  nextRest() {
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  /**
   * Follows the motion from a state.
   * @param {string[]} states
   * @param {number[]} values
   * @param {number} duration
   */
  async releaseAt(states, values, duration) {
    field("duration").value = readable(duration, 3);
    const changes = states.map((name, index) => /** @type {[string, number]} */ ([name, (values[index] ?? NaN) - (this.uniformState[name] ?? NaN)]));
    await this.release(changes.filter(([, change]) => Number.isFinite(change)), 0);
  }

  /** What can be played, as a list. @param {string} chosen */
  list(chosen) {
    const titles = /** @type {Record<string, string>} */ ({ cycles: "cycle", shimmy: "shimmy", motion: "what was let go", [PICKED]: "the point of the curve" });
    const options = [html("option", { value: "" }, "uniform motion")];
    for (const [file, motions] of Object.entries(this.offered)) {
      const name = file.replace(/\.json$/, "");
      motions.forEach((motion, index) => {
        const value = `${file}:${index}`;
        options.push(html("option", { value, selected: value === chosen }, `${titles[name] ?? name}${motion.label && file !== PICKED ? ` ${motion.label}` : ""}`));
      });
    }
    byId("shown-motion").replaceChildren(...options);
  }

  /** Plays what is chosen. */
  choose() {
    const [name, index] = /** @type {HTMLSelectElement} */ (byId("shown-motion")).value.split(":");
    this.show(name ? (this.offered[name]?.[Number(index)] ?? null) : null);
  }

  /** @param {Motion | null} motion */
  show(motion) {
    this.above.play(motion);
    this.plane.motion = motion;
    this.plane.draw();
    if (!motion) {
      byId("history").replaceChildren();
      return;
    }
    const curve = motion.t.map((time, index) => /** @type {[number, number]} */ ([time, motion.psi[index] ?? NaN]));
    const [low, high] = extent(motion.psi);
    const plot = draw({ description: "caster angle over the time", curves: [{ points: curve, kind: "cycle" }], x: { label: "t (s)", low: 0, high: motion.t.at(-1) ?? 1 }, y: { label: "ψ (rad)", low, high } });
    byId("history").replaceChildren(plot.element, captureMenu("the time history", "history", () => plot.element, () => columnsOfMotion(motion), "Save the picture…"));
  }

  /**
   * Lets the wheel go from a changed uniform motion, or hits it.
   * @param {[string, number][]} perturb
   * @param {number} blow in N s, towards the centre of the circle
   */
  async release(perturb, blow) {
    const { page } = this;
    if (numberIn(field("duration")) === null) return;
    this.abort.abort();
    this.abort = new AbortController();
    // Another wheel ends it too.
    const signal = AbortSignal.any([this.abort.signal, page.signal()]);
    Object.assign(this, { perturb, blow });
    page.changed();
    const { duration, slides } = this.asked();
    const note = byId("motion-note");
    try {
      const request = { ...page.asked(), duration, perturb: Object.fromEntries(perturb), blow, points: 2001, contact: slides ? "sliding" : "rolling" };
      const answer = await page.compute("motion", "/api/wheel/simulate", request, signal);
      if (signal.aborted) return;
      const [motion] = answer.motions;
      if (!motion) return;
      page.keep("motion", answer);
      this.offered.motion = [motion];
      this.list("motion:0");
      this.show(motion);
      const away = motion.psi.map((value) => Math.abs(value - this.uniform("psi")));
      const last = Math.max(...away.slice(Math.floor(0.9 * away.length)));
      const start = blow ? `it was hit with ${readable(Math.abs(blow), 3)} N s` : `it was let go at ${readable(away[0] ?? 0, 3)} rad`;
      note.replaceChildren(`In the last tenth of ${readable(motion.t.at(-1))} s the caster is up to ${readable(last, 3)} rad from rest; ${start}.`,
        ...answer.warnings.map((warning) => html("span", { class: "note" }, ` ${warning}.`)));
    } catch (error) {
      if (!signal.aborted) note.textContent = error instanceof Refusal ? error.problem.message : String(error);
    }
  }

  /** The axes of the basin. */
  basinAsked() {
    const [[left, right], [low, high]] = this.plane.limits;
    return { x: { key: "psi", start: left, end: right }, y: { key: "Omega", start: low, end: high }, counts: FINE };
  }

  /** Shows the plane without basins. */
  withoutBasin() {
    this.plane.map = null;
    this.plane.draw();
    this.page.keep("basin", null);
    byId("basin-note").textContent = "";
  }

  /** Computes the basins under the plane, roughly and then finely. @param {AbortSignal} signal @returns {Promise<boolean>} whether they are there */
  async showBasin(signal) {
    const { page, plane } = this;
    const note = byId("basin-note");
    note.textContent = "";
    try {
      for (const counts of [COARSE, FINE]) {
        const { x, y } = this.basinAsked();
        const request = { ...page.asked(), x: { ...x, count: counts[0] }, y: { ...y, count: counts[1] }, contact: field("slides").checked ? "sliding" : "rolling" };
        const answer = await page.compute("basin", "/api/wheel/basin", request, signal);
        if (signal.aborted) return false;
        page.keep("basin", answer);
        plane.map = answer.map;
        plane.draw();
        note.textContent = answer.warnings.join("; ");
      }
      return true;
    } catch (error) {
      if (!signal.aborted) note.textContent = error instanceof Refusal ? error.problem.message : String(error);
      return false;
    }
  }
}
