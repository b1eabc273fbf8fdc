// Computes the steps of a page in their order, each from the results before it. What is known already is not computed again, and what
// is no longer wanted ends.

import { Refusal, ask, listen } from "./ask.js";

/**
 * @typedef {{values: number[], max: number[], min: number[], stable: boolean | null, label: string | null,
 *   orbit: {period: number, t: number[], states: number[][]} | null}} FoundPoint
 * @typedef {{
 *   name: string, key: string, running: boolean, run: string, text: string, data: any, before: any, points: FoundPoint[], motions: any[], warnings: string[],
 *   problem: import("./ask.js").Problem | null, progress: number | null,
 * }} Result `before` is what was there before it was computed anew; `motions` are those of cycles, where the server tells them
 * @typedef {{path: string, request: any, from: string[]}} Question where it is asked, what is asked, and the results that it names
 */

export class Chain {
  /**
   * @param {(isDone: boolean) => void} changed is told of every change of a result, and whether it is its last one
   */
  constructor(changed) {
    /** @type {Map<string, Result>} */
    this.results = new Map();
    this.changed = changed;
    this.abort = new AbortController();
  }

  /**
   * Computes what is not known yet.
   * @param {{name: string}[]} steps
   * @param {(step: any) => Question} question
   */
  async run(steps, question) {
    this.abort.abort();
    const abort = new AbortController();
    this.abort = abort;
    const names = new Set(steps.map((step) => step.name));
    for (const name of this.results.keys()) if (!names.has(name)) this.results.delete(name);
    /** @type {Map<string, Promise<void>>} */
    const running = new Map();
    for (const step of steps) {
      const { path, request, from } = question(step);
      // The answer depends on the question and on what it starts from.
      const key = JSON.stringify([path, request, from.map((name) => this.results.get(name)?.key)]);
      const known = this.results.get(step.name);
      if (known && known.key === key && !known.running) continue;
      /** @type {Result} */
      const result = {
        name: step.name, key, running: true, run: "", text: "", data: null, before: known?.data ?? known?.before, points: [], motions: [], warnings: [], problem: null, progress: null,
      };
      this.results.set(step.name, result);
      this.changed(false);
      const follow = () => this.follow(result, path, request, from, abort.signal);
      // What waits for nothing is asked at once, before what shows it.
      running.set(step.name, from.length ? Promise.all(from.map((name) => running.get(name))).then(follow) : follow());
    }
    await Promise.all(running.values());
  }

  /**
   * @param {Result} result
   * @param {string} path
   * @param {any} request
   * @param {string[]} from
   * @param {AbortSignal} signal
   */
  async follow(result, path, request, from, signal) {
    try {
      /** @type {Record<string, string>} */
      const files = {};
      for (const name of from) {
        const text = this.results.get(name)?.text;
        if (!text) throw new Refusal({ message: `${name}, from which it starts, has no result` });
        files[name] = text;
      }
      await listen(path, { request, files }, signal, (kind, text) => {
        if (kind === "run") result.run = text;
        else if (kind === "point") result.points.push(JSON.parse(text));
        else if (kind === "motion") result.motions.push(JSON.parse(text));
        else if (kind === "warning") result.warnings.push(text);
        else if (kind === "progress") result.progress = JSON.parse(text);
        else if (kind === "failure") result.problem = JSON.parse(text).error;
        else if (kind === "result") {
          result.text = text;
          result.data = JSON.parse(text);
        }
        if (kind === "point" || kind === "progress") this.changed(false);
      });
      if (!result.data && !result.problem) result.problem = { message: "the server ended before there was a result" };
    } catch (error) {
      if (signal.aborted) return;
      const lost = { message: "the server does not answer; is it still running?" };
      result.problem = error instanceof Refusal ? error.problem : error instanceof TypeError ? lost : { message: String(error) };
    }
    if (signal.aborted) return;
    result.running = false;
    this.changed(true);
  }

  /** Stops everything that runs; what there is of it is kept. */
  stop() {
    for (const result of this.results.values()) {
      if (result.running && result.run) ask("/api/stop", { run: Number(result.run) }).catch(() => {});
    }
  }

  /** Whether anything is computed. */
  get isRunning() {
    return [...this.results.values()].some((result) => result.running);
  }
}
