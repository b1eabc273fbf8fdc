// How fast the pages are: told, not asserted, since a machine that builds beside it is slower.

import { after, before, test } from "node:test";
import { launch, open, serve } from "./page.mjs";

let servers;
let browser;

before(async () => {
  servers = { arclength: await serve("arclength"), kingpin: await serve("kingpin") };
  browser = await launch();
});

after(async () => {
  await browser?.close();
  for (const server of Object.values(servers ?? {})) await server.end();
});

/** Prints a line of the table. */
function tell(what, value, unit) {
  console.log(`measured: ${what}: ${value < 10 ? value.toFixed(1) : value.toFixed(0)} ${unit}`);
}

/** Bytes of a page with everything that it loads. */
async function sizeOf(server, names) {
  const seen = new Set();
  let bytes = 0;
  const queue = [...names];
  while (queue.length) {
    const name = queue.pop();
    if (seen.has(name)) continue;
    seen.add(name);
    const text = await (await fetch(server.url + name)).text();
    bytes += Buffer.byteLength(text);
    for (const [, module] of text.matchAll(/from "\.\/(\w+\.js)"/g)) queue.push(module);
  }
  return bytes;
}

/** Opens a page whose browser runs already; `shown` are selectors, and the answer has when each was there first, in ms from the address on. */
async function timed(url, shown) {
  const opened = await open(browser, "about:blank");
  const { page } = opened;
  await page.addInitScript((selectors) => {
    window.shown = {};
    const look = () => {
      for (const [name, selector] of Object.entries(selectors)) if (document.querySelector(selector)) window.shown[name] ??= performance.now();
    };
    new MutationObserver(look).observe(document, { childList: true, subtree: true, attributes: true });
  }, shown);
  await page.goto(url, { waitUntil: "commit" });
  await page.waitForFunction((count) => Object.keys(window.shown).length === count, Object.keys(shown).length, { timeout: 120_000 });
  return { opened, page, times: await page.evaluate(() => window.shown) };
}

test("sizes of both pages", async () => {
  tell("page for any model", await sizeOf(servers.arclength, ["", "style.css", "icon.svg", "model.js"]) / 1000, "kB");
  tell("page for a wheel", await sizeOf(servers.kingpin, ["", "style.css", "wheel.css", "icon.svg", "wheel.js"]) / 1000, "kB");
});

test("what the thread of a page computes until its diagram is there, however busy the machine is", async () => {
  for (const [what, server] of [["any model", servers.arclength], ["a wheel", servers.kingpin]]) {
    const opened = await open(browser, "about:blank");
    const { page } = opened;
    const session = await page.context().newCDPSession(page);
    await session.send("Performance.enable", { timeDomain: "threadTicks" });
    const spent = async () => (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
    const before = await spent();
    await page.goto(server.url, { waitUntil: "commit" });
    await page.locator("#diagrams svg.drawn").waitFor();
    tell(`${what}, computed by the page until its diagram`, 1000 * (await spent() - before), "ms");
    await opened.settled();
    await opened.close();
  }
});

test("the page for any model: ready, a slider", async () => {
  const { opened, page, times } = await timed(servers.arclength.url, { diagram: "#diagrams svg.drawn" });
  tell("any model, from the address to its diagram", times.diagram, "ms");
  await opened.settled();
  const slid = await page.evaluate(() => new Promise((resolve) => {
    const began = performance.now();
    const before = document.querySelector("#diagrams .drawn");
    new MutationObserver(() => {
      if (document.querySelector("#diagrams .drawn") !== before) resolve(performance.now() - began);
    }).observe(document.querySelector("#diagrams"), { childList: true, subtree: true });
    const slider = document.querySelector("#parameters input[type=range]:nth-of-type(1)");
    slider.value = String(Number(slider.value) * 1.1 + 0.1);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }));
  tell("any model, from a slider to its diagram", slid, "ms");
  await opened.settled();
  await opened.settled();
  await opened.close();
});

test("the first point of a branch comes before its end", async () => {
  const source = "par p=-.5\nx' = p*x - y - x*(x^2+y^2)\ny' = x + p*y - y*(x^2+y^2)\n";
  const ask = (kind, body) => fetch(`${servers.arclength.url}api/${kind}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  const along = { key: "p", start: -1, end: 1 };
  const events = await (await ask("equilibria", { request: { model: { source: { text: { name: "m.ode", source } } }, along } })).text();
  const result = events.split("\n\n").find((text) => text.startsWith("event: result\n")).split("\n").slice(1).map((line) => line.replace(/^data: /, "")).join("\n");
  const start = performance.now();
  const answer = await ask("cycles", { request: { from: { path: "a.json", label: "HB1" }, along }, files: { "a.json": result } });
  let [text, first] = ["", 0];
  for await (const part of answer.body.pipeThrough(new TextDecoderStream())) {
    text += part;
    if (text.includes("event: point")) first ||= performance.now() - start;
  }
  tell("from the question for cycles to the first one", first, "ms");
  tell("from the question for cycles to the result", performance.now() - start, "ms");
});

test("the page for a wheel: verdict, coarse and fine chart, frames a second", async () => {
  const { opened, page, times } = await timed(servers.kingpin.url, {
    verdict: "#verdict strong", chart: `#chart-picture[data-points="${240 * 141}"]`, diagram: "#diagrams svg.drawn",
  });
  tell("a wheel, from the address to its verdict", times.verdict, "ms");
  tell("a wheel, from the address to its fine chart", times.chart, "ms");
  tell("a wheel, from the address to its cycles", times.diagram, "ms");
  await page.waitForFunction(() => document.querySelector("#status").textContent === "", null, { timeout: 120_000 });
  const slid = await page.evaluate(() => new Promise((resolve) => {
    const began = performance.now();
    const picture = document.querySelector("#chart-picture");
    let coarse = 0;
    new MutationObserver(() => {
      if (picture.dataset.points === String(48 * 30)) coarse ||= performance.now() - began;
      if (coarse && picture.dataset.points === String(240 * 141)) resolve([coarse, performance.now() - began]);
    }).observe(picture, { attributes: true });
    const slider = document.querySelector('[aria-label="l, slider"]');
    slider.value = "0.09";
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    slider.dispatchEvent(new Event("change", { bubbles: true }));
  }));
  tell("a wheel, from a slider to the coarse chart", slid[0], "ms");
  tell("a wheel, from a slider to the fine chart", slid[1], "ms");
  await page.locator("#let-go").click();
  await page.locator("#motion-note", { hasText: "In the last tenth" }).waitFor();
  const rate = await page.evaluate(() => new Promise((resolve) => {
    let [count, from] = [0, 0];
    const tick = (now) => {
      from ||= now;
      if (now - from > 2000) resolve((count * 1000) / (now - from));
      else requestAnimationFrame(tick);
      count++;
    };
    requestAnimationFrame(tick);
  }));
  tell("a wheel that plays", rate, "frames a second");
  await opened.close();
});
