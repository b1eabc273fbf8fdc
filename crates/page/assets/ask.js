// Questions to the server of this page.

/**
 * @typedef {{line: number, column: number, length: number}} Place
 * @typedef {{message: string, fields?: string[], given?: string, allowed?: string, place?: Place}} Problem
 */

/** An answer that says what is wrong. */
export class Refusal extends Error {
  /** @param {Problem} problem */
  constructor(problem) {
    super(problem.message);
    /** @type {Problem} */
    this.problem = problem;
  }
}

/**
 * @param {string} path
 * @param {unknown} body
 * @param {AbortSignal} [signal]
 */
async function post(path, body, signal) {
  const answer = await fetch(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
    signal,
  });
  if (answer.ok) return answer;
  const text = await answer.text();
  let problem = { message: text || answer.statusText };
  try {
    problem = JSON.parse(text).error;
  } catch {
    // What is no JSON is shown as it is.
  }
  throw new Refusal(problem);
}

/**
 * Asks for data.
 * @param {string} path
 * @param {unknown} [body] what is asked; nothing for what only needs to be fetched
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export async function ask(path, body, signal) {
  const answer = body === undefined ? await fetch(path, { signal }) : await post(path, body, signal);
  return answer.json();
}

/**
 * Asks for a file.
 * @param {string} path
 * @param {unknown} body
 */
export async function askFile(path, body) {
  return (await post(path, body)).blob();
}

/**
 * Asks for something that grows: `hear` is told every event as it comes.
 * @param {string} path
 * @param {unknown} body
 * @param {AbortSignal} signal
 * @param {(kind: string, text: string) => void} hear
 */
export async function listen(path, body, signal, hear) {
  const answer = await post(path, body, signal);
  if (!answer.body) return;
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    // Every event ends with an empty line.
    const events = (rest + value).split("\n\n");
    rest = events.pop() ?? "";
    for (const event of events) {
      const lines = event.split("\n");
      const kind = (lines[0] ?? "").replace(/^event: /, "");
      hear(kind, lines.slice(1).map((line) => line.replace(/^data: /, "")).join("\n"));
    }
  }
}
