// The page for any model, as somebody uses it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { after, before, test } from "node:test";
import { PROGRAMS, launch, open, operators, saved, serve } from "./page.mjs";

let server;
let browser;

before(async () => {
  server = await serve("arclength");
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.end();
});

/** Presses a label in a diagram and chooses what starts there. */
async function start(opened, label, title) {
  await opened.page.locator(`.target[data-label="${label}"]`).first().click();
  await opened.page.locator("dialog").getByRole("button", { name: title, exact: true }).click();
  await opened.settled();
}

test("Lur'e is followed to its period doublings by clicks alone", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  assert.equal(await page.locator("#model-name").textContent(), "lure.ode");
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  await start(opened, "cycles.json:PD1", "Doubled cycles");
  await opened.picture("lure");
  // The first doubling as MatCont has it.
  await page.locator('.target[data-label="cycles.json:PD1"]').first().press("Enter");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => document.querySelector("#point h2")?.textContent?.startsWith("PD1, cycles"));
  const value = Number(await page.locator("#point dd").first().textContent());
  assert.ok(Math.abs(value - 0.6303020062) < 1e-9, String(value));
  await opened.picture("lure-point");
  await start(opened, "cycles.json:PD1", "Curve of period doublings in two parameters");
  assert.equal(await page.locator("section.diagram").count(), 2);
  const lines = await page.locator("#lines").textContent();
  assert.match(lines, /^arclength equilibria lure\.ode --along alpha=-1:2\.5 -o equilibria\.json$/m);
  assert.match(lines, /^arclength cycles --from equilibria\.json:HB1 --along alpha=-1:2\.5 -o cycles\.json$/m);
  assert.match(lines, /^arclength cycles --from cycles\.json:PD1 /m);
  const python = await page.locator("#python-lines").textContent();
  assert.match(python, /^cycles = equilibria\["HB1"\]\.cycles\(along=\("alpha", -1, 2\.5\)\)$/m);
  assert.match(python, /^locus = cycles\["PD1"\]\.locus\(\("alpha", -1, 2\.5\), \("beta", 0, 2\)\)$/m);
  await opened.picture("lure-plane");
  await opened.documented("page");

  // The address is the page: another one that opens it has the same curves.
  const copy = await open(browser, page.url());
  await copy.settled();
  assert.equal(await copy.page.locator("#steps li").count(), 4);
  assert.equal(await copy.page.locator("#lines").textContent(), lines);
  await copy.close();

  // Back is undo.
  await page.goBack();
  await page.waitForFunction(() => document.querySelectorAll("#steps li").length === 3);
  await opened.settled();
  assert.equal(await page.locator("section.diagram").count(), 1);
  await opened.close();
});

test("a mistake in a pasted model is underlined, and mended", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  await page.locator("#source").fill("par gamma=1\nx' = gama - x^2\ninit x=1\n");
  await page.locator("#source-under mark").waitFor();
  assert.equal(await page.locator("#source-under mark").textContent(), "gama");
  assert.match(await page.locator("#source-message").textContent(), /line 2, column 6: .*did you mean `gamma`/);
  await opened.picture("mistake");
  await page.locator("#source").fill("par gamma=1\nx' = gamma - x^2\ninit x=1\n");
  await page.waitForFunction(() => document.querySelector("#source-message").hidden);
  await opened.settled();
  assert.equal(await page.locator("#source-under mark").count(), 0);
  await page.locator('.target[data-label="equilibria.json:LP1"]').waitFor({ state: "attached" });
  await opened.close();
});

test("a slider moves the diagram, and a number is exact", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  // At beta = 2 the Hopf point of the origin is at alpha = 1/2.
  await page.locator("#quantity-beta").fill("2");
  await page.locator("#quantity-beta").press("Tab");
  await page.waitForFunction(() => document.querySelector("#lines").textContent.includes("beta=2"));
  await opened.settled();
  await page.locator('.target[data-label="equilibria.json:HB1"]').first().press("Enter");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => Math.abs(Number(document.querySelector("#point dd")?.textContent) - 0.5) < 1e-9);
  await opened.close();
});

test("what is no number is told beside its field, and nothing else happens", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  const before = page.url();
  const from = page.locator("#along-start");
  await from.fill("abc");
  await page.locator("#follow").click();
  assert.match(await from.evaluate((element) => element.validationMessage), /a number/);
  assert.equal(await from.inputValue(), "abc");
  assert.equal(page.url(), before);
  await from.fill("-0.5");
  await page.locator("#follow").click();
  await page.waitForFunction(() => document.querySelector("#lines").textContent.includes("alpha=-0.5:2.5"));
  await opened.settled();
  await opened.close();
});

test("while a slider moves the picture is always there, and follows", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  const places = () => page.locator('.target[data-label="equilibria.json:HB1"]').getAttribute("cx");
  const before = await places();
  await page.evaluate(() => {
    window.missing = 0;
    new MutationObserver(() => {
      if (!document.querySelector("#diagrams .drawn")) window.missing++;
    }).observe(document.querySelector("#diagrams"), { childList: true, subtree: true });
  });
  const slider = page.getByLabel("beta, slider");
  const put = (value) => slider.evaluate((element, to) => {
    element.value = String(to);
    element.dispatchEvent(new Event("input", { bubbles: true }));
  }, value);
  for (let step = 1; step <= 20; step++) await put(1 + step / 50);
  // Before it is let go.
  await page.waitForFunction((from) => document.querySelector('.target[data-label="equilibria.json:HB1"]')?.getAttribute("cx") !== from, before);
  await slider.dispatchEvent("change");
  await page.waitForFunction(() => document.querySelector("#lines").textContent.includes("beta=1.4"));
  await opened.settled();
  await page.locator('.target[data-label="equilibria.json:HB1"]').first().press("Enter");
  await page.keyboard.press("Escape");
  // At beta the Hopf point of the origin is at 1/beta.
  await page.waitForFunction(() => Math.abs(Number(document.querySelector("#point dd")?.textContent) - 1 / 1.4) < 1e-9);
  assert.equal(await page.evaluate(() => window.missing), 0);
  await opened.close();
});

test("a point is picked with the pointer, walked from, and the phase plane starts motions", async () => {
  const opened = await open(browser, `${server.url}`);
  const { page } = opened;
  await opened.settled();
  // The model that is there already begins anew.
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  await page.locator("#gallery").selectOption("lure.ode");
  await page.waitForFunction(() => document.querySelectorAll("#steps li").length === 1);
  await opened.settled();
  await page.locator("#gallery").selectOption("fitzhugh_nagumo.ode");
  await page.waitForFunction(() => document.querySelector("#model-name").textContent === "fitzhugh_nagumo.ode");
  await opened.settled();
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  await page.locator("#steps li[data-step='cycles.json'] button.label", { hasText: "EP2" }).click();
  await page.locator("#point .plot.pickable").waitFor();
  await page.locator("#point .plot.pickable").click({ position: { x: 150, y: 100 } });
  await page.locator("#point .curve.motion").waitFor({ state: "attached" });
  await page.getByRole("button", { name: "Nullclines" }).click();
  await page.locator("#point .nullcline-x").first().waitFor({ state: "attached" });
  await page.getByRole("button", { name: "Directions" }).click();
  await page.locator("#point .curve.direction").nth(50).waitFor({ state: "attached" });
  await opened.picture("nerve");
  const before = await page.locator("#point h2").textContent();
  await page.getByRole("button", { name: "one point back" }).click();
  assert.notEqual(await page.locator("#point h2").textContent(), before);
  await opened.close();
});

test("a Hopf point tells its normal form, orbits their direction, and named sets are a menu", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  await page.locator("#gallery").selectOption("morris_lecar.ode");
  await page.waitForFunction(() => document.querySelector("#model-name").textContent === "morris_lecar.ode");
  await opened.settled();
  await page.locator("#steps button.label", { hasText: "HB1" }).click();
  const told = await page.locator("#point dl").textContent();
  assert.match(told, /frequency0\.079779784/);
  assert.match(told, /first Lyapunov coefficient0\.006543187criticalitysubcritical/);
  // w goes from 0 to 1, and so does its axis.
  const ticks = await page.locator("#point .plot.pickable .value").allTextContents();
  assert.ok(ticks.includes("0.2") && !ticks.includes("-0.5"), ticks.join());
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  await page.locator("#steps li[data-step='cycles.json'] button.label", { hasText: "LPC1" }).click();
  await page.locator("#point .arrow.cycle").nth(2).waitFor({ state: "attached" });
  await page.locator("#steps li[data-step='cycles.json'] button.quiet").click();
  await page.locator("#named-set").selectOption("snic");
  await page.waitForFunction(() => /--named-set snic --along/.test(document.querySelector("#lines").textContent));
  await opened.settled();
  assert.equal(await page.locator("#quantity-phi").inputValue(), "0.06667");
  assert.match(await page.locator("#python-lines").textContent(), /named_set="snic"/);
  await page.locator('.target[data-label="equilibria.json:LP1"]').first().waitFor({ state: "attached" });
  await opened.close();
});

test("diagrams are zoomed by the wheel, moved by dragging, and by keys", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  const place = () => page.locator('.target[data-label="equilibria.json:HB1"]').first().getAttribute("cx");
  const drawn = () => page.locator("#diagrams .drawn desc").textContent();
  const first = [await place(), await drawn()];
  const box = await page.locator("#diagrams .overlay").first().boundingBox();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.4 * box.height);
  await page.mouse.wheel(0, -100);
  await page.waitForFunction((before) => document.querySelector("#diagrams .drawn desc")?.textContent !== before, first[1]);
  await opened.settled();
  await opened.picture("zoomed");
  const zoomed = await drawn();
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.45 * box.height, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction((before) => document.querySelector("#diagrams .drawn desc")?.textContent !== before, zoomed);
  await opened.settled();
  // What was dragged was not pressed.
  assert.equal(await page.locator("dialog").count(), 0);
  await page.mouse.dblclick(box.x + 0.5 * box.width, box.y + 0.2 * box.height);
  await page.waitForFunction((before) => document.querySelector("#diagrams .drawn desc")?.textContent === before, first[1]);
  await opened.settled();
  assert.equal(await place(), first[0]);
  await page.locator("#diagrams .picture").first().focus();
  await page.keyboard.press("+");
  await page.waitForFunction((before) => document.querySelector("#diagrams .drawn desc")?.textContent !== before, first[1]);
  await opened.settled();
  await page.keyboard.press("0");
  await page.waitForFunction((before) => document.querySelector("#diagrams .drawn desc")?.textContent === before, first[1]);
  await opened.close();
});

test("what takes long is stopped, and what there is of it stays", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  await page.locator("#source").fill("par a=1\nx' = y\ny' = -a*x\ninit x=1\n@ total=1e7\n");
  await page.waitForFunction(() => document.querySelector("#quantity-a"));
  await opened.settled();
  await page.getByText("Initial values").click();
  await page.locator("#simulate").click();
  await page.locator('#steps li[data-state="running"]').waitFor();
  await page.locator("#stop").click();
  await page.waitForFunction(() => document.querySelector("#steps li[data-step='simulate.json']")?.dataset.state === "done");
  assert.match(await page.locator("#steps li[data-step='simulate.json']").textContent(), /simulate\s*\d+ points/);
  assert.equal(await page.locator("#stop").isVisible(), false);
  await opened.close();
});

test("pictures and numbers are saved, of the page's own plots too, and undo is a button", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  assert.equal(await page.locator("#undo").isDisabled(), true);
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  const svg = await saved(page, page.getByLabel("Save this diagram"), "svg");
  assert.match(String(svg.contents), /^<svg [^]*<title>[^]*<desc>Horizontal axis: alpha/);
  const csv = await saved(page, page.getByLabel("Save cycles.json"), "csv");
  assert.equal(csv.name, "cycles.csv");
  assert.match(String(csv.contents), /^label,value,period,/);
  await page.locator("#steps li[data-step='cycles.json'] button.label", { hasText: "PD1" }).click();
  const plane = await saved(page, page.getByLabel("Save the phase plane"), "png");
  assert.deepEqual([...plane.contents.subarray(1, 4)], [...Buffer.from("PNG")]);
  const multipliers = await saved(page, page.getByLabel("Save Floquet multipliers"), "csv");
  assert.match(String(multipliers.contents), /^re,im\n(-?[\d.e-]+,-?[\d.e-]+\n){3}$/);
  const drawn = await saved(page, page.getByLabel("Save the time history"), "svg");
  assert.match(String(drawn.contents), /^<svg [^]*stroke="rgb\(/);
  // A PDF file has lines, not pixels: the orbit in its colour, the crosses, and the outlines of the labels.
  for (const [name, stroke] of [["the phase plane", /^0?\.835\d* 0?\.368\d* 0 RG$/m], ["the time history", /^0?\.835\d* 0?\.368\d* 0 RG$/m], ["Floquet multipliers", /^0 0?\.447\d* 0?\.698\d* RG$/m]]) {
    const pdf = operators((await saved(page, page.getByLabel(`Save ${name}`), "pdf")).contents);
    assert.ok(stroke.test(pdf) && pdf.match(/ c$/gm).length > 50, name);
  }
  await page.locator("#undo").click();
  await page.waitForFunction(() => document.querySelectorAll("#steps li").length === 1);
  await page.keyboard.press("Control+y");
  await page.waitForFunction(() => document.querySelectorAll("#steps li").length === 2);
  await opened.settled();
  await opened.close();
});

test("a curve has a colour of its own, which is kept, saved, undone and redone", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await opened.settled();
  await start(opened, "equilibria.json:HB1", "Cycles that are born there");
  const purple = "#cc79a7";
  const drawn = () => page.locator("#diagrams .drawn").evaluate((element) => element.outerHTML);
  const menu = page.getByLabel("colour of cycles.json");
  assert.equal(await menu.inputValue(), "");
  assert.ok(!(await drawn()).includes(purple));
  await menu.focus();
  await menu.selectOption("purple");
  await page.waitForFunction((color) => document.querySelector("#diagrams .drawn")?.outerHTML.includes(color), purple);
  await opened.settled();
  assert.match(await page.locator("#diagrams .drawn").textContent(), /cycles/);
  assert.ok(await menu.evaluate((element) => element === document.activeElement));
  await opened.picture("colours");
  // In pictures that are saved, of all curves and of one.
  for (const name of ["this diagram", "cycles.json"]) {
    assert.ok(String((await saved(page, page.getByLabel(`Save ${name}`), "svg")).contents).includes(purple), name);
  }
  assert.ok(!String((await saved(page, page.getByLabel("Save equilibria.json"), "svg")).contents).includes(purple));
  assert.match(String((await saved(page, page.getByLabel("Save cycles.json"), "csv")).contents), /^label,value,period,/);
  // In the address.
  const copy = await open(browser, page.url());
  await copy.settled();
  assert.equal(await copy.page.getByLabel("colour of cycles.json").inputValue(), "purple");
  await copy.page.waitForFunction((color) => document.querySelector("#diagrams .drawn")?.outerHTML.includes(color), purple);
  await copy.close();
  await page.locator("#undo").click();
  await page.waitForFunction((color) => !document.querySelector("#diagrams .drawn").outerHTML.includes(color), purple);
  assert.equal(await menu.inputValue(), "");
  await page.locator("#redo").click();
  await page.waitForFunction((color) => document.querySelector("#diagrams .drawn").outerHTML.includes(color), purple);
  await opened.settled();
  assert.deepEqual(await opened.obstacles(), []);
  await opened.close();
});

test("it fits a phone, and keys are enough", async () => {
  const opened = await open(browser, server.url, { viewport: { width: 390, height: 800 } });
  const { page } = opened;
  await opened.settled();
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await opened.picture("phone");
  await opened.documented("page-phone");
  // Whatever can be pressed has a name.
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, select, textarea, [role=button]")]
      .filter((element) => !element.hidden && !(element.getAttribute("aria-label") || element.textContent?.trim() || element.labels?.length))
      .map((element) => element.outerHTML));
  assert.deepEqual(nameless, []);
  await opened.close();
});

for (const colorScheme of ["light", "dark"]) {
  test(`nobody stumbles, ${colorScheme}`, async () => {
    const opened = await open(browser, server.url, { colorScheme });
    const { page } = opened;
    await opened.settled();
    await page.locator("#steps button.label", { hasText: "HB1" }).click();
    await page.locator("#point dl").waitFor();
    assert.deepEqual(await opened.obstacles(), []);
    await page.locator("#start-here").click();
    await page.locator("dialog").waitFor();
    assert.deepEqual(await opened.obstacles(), []);
    await opened.picture(colorScheme);
    await page.keyboard.press("Escape");
    if (colorScheme === "dark") await opened.documented("page-dark");
    await opened.close();
  });
}

test("many at once get the bytes of the command line", async () => {
  const file = new URL("../../../../gallery/models/lure.ode", import.meta.url).pathname;
  const folder = mkdtempSync(`${tmpdir()}/page-`);
  try {
    execFileSync(`${PROGRAMS}/arclength`, ["equilibria", file, "--along", "alpha=-1:2.5", "-o", `${folder}/a.json`, "--quiet"], { stdio: "ignore" });
    const expected = readFileSync(`${folder}/a.json`, "utf8");
    const source = readFileSync(file, "utf8");
    const request = { model: { source: { text: { name: "lure.ode", source } } }, along: { key: "alpha", start: -1, end: 2.5 } };
    const asked = async () => {
      const answer = await fetch(`${server.url}api/equilibria`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ request }) });
      const event = (await answer.text()).split("\n\n").find((text) => text.startsWith("event: result\n"));
      return event.split("\n").slice(1).map((line) => line.replace(/^data: /, "")).join("\n");
    };
    const answers = await Promise.all(Array.from({ length: 40 }, asked));
    for (const answer of answers) assert.equal(answer, expected);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test("everything that the page loads is fetched at once", async () => {
  const html = await (await fetch(server.url)).text();
  const preloaded = [...html.matchAll(/rel="modulepreload" href="\/(\w+\.js)"/g)].map(([, name]) => name);
  const seen = new Set();
  const queue = ["model.js"];
  while (queue.length) {
    const name = queue.pop();
    if (seen.has(name)) continue;
    seen.add(name);
    for (const [, module] of (await (await fetch(server.url + name)).text()).matchAll(/^import .*from "\.\/(\w+\.js)"/gm)) queue.push(module);
  }
  assert.deepEqual([...preloaded, "model.js"].sort(), [...seen].sort());
});

test("the whole page is small", async () => {
  let bytes = 0;
  const html = await (await fetch(server.url)).text();
  const names = [...html.matchAll(/(?:href|src)="\/([\w.]+\.(?:js|css|svg))"/g)].map(([, name]) => name);
  for (const name of ["", ...new Set(names)]) bytes += (await (await fetch(server.url + name)).arrayBuffer()).byteLength;
  console.log(`the page has ${bytes} bytes`);
  assert.ok(bytes > 100_000 && bytes < 300_000);
});

test("the server ends in the middle, and the page says so", async () => {
  const other = await serve("arclength");
  // The browser itself reports the refused connection.
  const opened = await open(browser, other.url, { expected: /net::ERR_/ });
  await opened.settled();
  assert.equal(await other.end(), 0);
  await opened.page.locator("#along-end").fill("2");
  await opened.page.locator("#follow").click();
  await opened.page.locator("#steps .problem", { hasText: "is it still running?" }).waitFor();
  await opened.close();
});
