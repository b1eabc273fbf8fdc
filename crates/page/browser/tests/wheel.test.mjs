// The page for a wheel, as somebody uses it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open, serve } from "./page.mjs";

let server;
let browser;

before(async () => {
  server = await serve("kingpin");
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.end();
});

/** Waits until chart and cycles are there. */
async function done(page) {
  await page.waitForFunction(() => {
    const chart = document.querySelector("#chart-picture");
    return chart?.dataset.points === String(240 * 141) && document.querySelector("#status").textContent === ""
      && document.querySelector("#diagram-picture")?.dataset.done === "yes";
  }, null, { timeout: 120_000 });
}

test("the paper's wheel: verdict, chart, cycles, and a press on the chart takes the wheel there", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  assert.match(await page.locator("#verdict").textContent(), /Stable: small motions die out\..*8\.431 m\/s/);
  assert.match(await page.locator("#numbers").textContent(), /critical speed 8\.431037 m\/s/);
  await page.locator("#diagram-notes button", { hasText: "HB1" }).waitFor();
  assert.deepEqual(await opened.obstacles(), []);
  await opened.picture("wheel");
  const before = await page.locator("#quantity-v").inputValue();
  const box = await page.locator("#chart-picture .overlay").boundingBox();
  await page.locator("#chart-picture .overlay").click({ position: { x: 0.62 * box.width, y: 0.2 * box.height } });
  await page.waitForFunction((value) => document.querySelector("#quantity-v").value !== value, before);
  await page.locator("#verdict", { hasText: /stable/i }).waitFor();
  // The address is the page.
  await page.waitForFunction(() => location.hash.length > 10);
  const copy = await open(browser, page.url());
  await copy.page.locator("#quantity-v").waitFor();
  assert.equal(await copy.page.locator("#quantity-v").inputValue(), await page.locator("#quantity-v").inputValue());
  await copy.close();
  await opened.close();
});

test("the caster is dragged aside and let go", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await page.locator("#above .grip").waitFor({ state: "attached" });
  const box = await page.locator("#above svg").boundingBox();
  const pin = await page.locator("#above .pin").boundingBox();
  const wheel = await page.locator("#above .wheel").boundingBox();
  const middle = (part) => ({ x: part.x + part.width / 2, y: part.y + part.height / 2 });
  const at = { x: (middle(pin).x + middle(wheel).x) / 2, y: (middle(pin).y + middle(wheel).y) / 2 };
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.mouse.move(at.x, at.y - 0.15 * box.height, { steps: 5 });
  await page.mouse.up();
  await page.locator("#motion-note", { hasText: "In the last tenth" }).waitFor();
  assert.notEqual(await page.locator("#kick").inputValue(), "0.2");
  await opened.picture("let-go");
  await opened.close();
});

test("a value that is not allowed says what is", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await page.locator("#quantity-l").waitFor();
  await page.locator("#quantity-l").fill("-1");
  await page.locator("#quantity-l").press("Tab");
  assert.match(await page.locator("#quantity-l").evaluate((element) => element.validationMessage), /to/);
  // Two values that do not go together are told by the server.
  await page.getByText("All parameters").click();
  await page.locator("#quantity-mu_s").fill("0.5");
  await page.locator("#quantity-mu_s").press("Tab");
  await page.locator("#wheel-problem", { hasText: "mu_d" }).waitFor();
  opened.problems.splice(0, opened.problems.length, ...opened.problems.filter((problem) => !problem.includes("422")));
  await opened.close();
});

test("a wheel on a phone, and the page for any model beside it", async () => {
  const opened = await open(browser, server.url, { viewport: { width: 390, height: 800 } });
  const { page } = opened;
  await done(page);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await opened.picture("wheel-phone");
  await page.getByRole("link", { name: "Any model" }).click();
  await opened.settled();
  await opened.close();
});

test("60 pictures a second while it plays", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await page.locator("#above .grip").waitFor({ state: "attached" });
  await page.locator("#let-go").click();
  await page.locator("#motion-note", { hasText: "In the last tenth" }).waitFor();
  await done(page);
  const rate = await page.evaluate(() => new Promise((resolve) => {
    let [count, start] = [0, 0];
    const tick = (now) => {
      start ||= now;
      if (now - start > 1000) resolve((count * 1000) / (now - start));
      else requestAnimationFrame(tick);
      count++;
    };
    requestAnimationFrame(tick);
  }));
  // Told, not asserted: a machine that builds beside it is slower.
  console.log(`${rate.toFixed(0)} pictures a second`);
  await opened.close();
});
