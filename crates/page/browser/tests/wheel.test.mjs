// The page for a wheel, as somebody uses it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open, operators, saved, serve } from "./page.mjs";

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
      && ["done", "failed"].includes(document.querySelector('#steps li[data-step="cycles.json"]')?.dataset.state)
      && [...document.querySelectorAll("#diagrams .picture")].every((picture) => picture.getAttribute("aria-busy") !== "true");
  }, null, { timeout: 120_000 });
}

test("the paper's wheel: verdict, chart, cycles, and a press on the chart takes the wheel there", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  assert.match(await page.locator("#verdict").textContent(), /Stable: small motions die out\..*8\.431 m\/s/);
  assert.match(await page.locator("#numbers").textContent(), /critical speed 8\.431037 m\/s/);
  await page.locator("#steps button.label", { hasText: "HB1" }).waitFor();
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

test("branches grow point by point, labels offer what starts there, and every point is seen", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await page.evaluate(() => {
    window.grown = 0;
    new MutationObserver(() => {
      if (document.querySelector("#diagrams .growing .dot")) window.grown++;
    }).observe(document.querySelector("#diagrams"), { childList: true, subtree: true });
  });
  await done(page);
  await page.locator("#steps button.label", { hasText: "HB1" }).click();
  await page.locator("#branch-point dl", { hasText: "first lyapunov" }).waitFor();
  // The same cycles once more: while they are followed nothing else is computed.
  await page.locator('#diagrams .target[data-label="cycles.json:AT1"]').first().press("Enter");
  await page.locator("dialog").getByRole("button", { name: "The cycles through it" }).click();
  await page.locator('#steps li[data-step="cycles-2.json"][data-state="done"]').waitFor();
  await done(page);
  await opened.picture("wheel-twice");
  await page.getByRole("button", { name: "remove cycles-2.json" }).click();
  await done(page);
  assert.ok(await page.evaluate(() => window.grown) > 0);
  // The pointer alone: a label, what starts there.
  await page.locator('#diagrams .target[data-label="cycles.json:HB1"]').first().click();
  await page.locator("dialog").getByRole("button", { name: "Curve of Hopf points in two parameters" }).click();
  await done(page);
  await page.locator('#steps li[data-step="locus.json"][data-state="done"]').waitFor();
  assert.equal(await page.locator("#diagrams .diagram").count(), 2);
  assert.match(await page.locator("#lines").textContent(), /^kingpin locus --from cycles\.json:HB1 --in v=0\.2:9,l=\S+ -o locus\.json -o locus\.svg$/m);
  assert.match(await page.locator("#python-lines").textContent(), /^locus = cycles\["HB1"\]\.locus\(\("v", 0\.2, 9\), \("l", /m);
  // A point without a label: its multipliers, and its motion.
  await page.locator("#steps button.label", { hasText: "AT1" }).click();
  await page.getByRole("button", { name: "one point on" }).click();
  await page.locator("#branch-point h2", { hasText: /^Point \d+ of cycles/ }).waitFor();
  assert.equal(await page.locator("#shown-motion option:checked").textContent(), "the point of the curve");
  assert.equal(await page.locator("#branch-point .cross").count(), 5);
  await page.locator("#history .plot").waitFor();
  await page.locator("#plane .curve.cycle").waitFor({ state: "attached" });
  // The slider along the branch.
  const title = await page.locator("#branch-point h2").textContent();
  await page.locator("#along-branch").focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((before) => document.querySelector("#branch-point h2").textContent !== before, title);
  assert.deepEqual(await opened.obstacles(), []);
  await opened.picture("wheel-branches");
  // Hidden, and removed.
  await page.getByLabel("show cycles.json").uncheck();
  await done(page);
  assert.equal(await page.locator("#diagrams .diagram").first().locator(".drawn").count(), 0);
  await page.getByLabel("show cycles.json").check();
  await page.getByRole("button", { name: "remove locus.json" }).click();
  await done(page);
  assert.equal(await page.locator("#steps li").count(), 1);
  await opened.close();
});

test("a curve in another colour leaves everything else as it is, and undo brings the colour back", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.locator("#let-go").click();
  await page.locator("#motion-note", { hasText: "In the last tenth" }).waitFor();
  const asked = [];
  page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  const green = "#009e73";
  await page.getByLabel("colour of cycles.json").selectOption("green");
  await page.waitForFunction((color) => document.querySelector("#diagrams .drawn")?.outerHTML.includes(color), green);
  await done(page);
  assert.match(await page.locator("#motion-note").textContent(), /In the last tenth/);
  assert.deepEqual(asked.filter((path) => path.startsWith("/api")), ["/api/wheel/diagram"]);
  const copy = await open(browser, page.url());
  await copy.page.waitForFunction((color) => document.querySelector("#diagrams .drawn")?.outerHTML.includes(color), green);
  await done(copy.page);
  await copy.close();
  await page.locator("#undo").click();
  await page.waitForFunction((color) => !document.querySelector("#diagrams .drawn").outerHTML.includes(color), green);
  await done(page);
  await opened.close();
});

test("a motion starts at a cycle", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.locator('#diagrams .target[data-label="cycles.json:AT1"]').first().press("Enter");
  await page.locator("dialog").getByRole("button", { name: "A motion from there" }).click();
  await page.locator("#motion-note", { hasText: "it was let go" }).waitFor();
  assert.match(await page.locator("#lines").textContent(), /--perturb u=\S+ --perturb q=\S+ --perturb psi=\S+ --perturb V=\S+ --perturb Omega=\S+/);
  await opened.close();
});

test("the chart is zoomed and dragged, and back is undo", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  const ends = () => page.evaluate(() => ["x-start", "x-end"].map((id) => Number(document.getElementById(id).value)));
  const width = ([from, to]) => to - from;
  const before = await ends();
  const box = await page.locator("#chart-picture .overlay").boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.4 * box.height);
  await page.mouse.wheel(0, -100);
  await page.waitForFunction((end) => Number(document.getElementById("x-end").value) < end, before[1]);
  assert.ok(width(await ends()) < width(before));
  await done(page);
  await page.goBack();
  await page.waitForFunction((end) => Number(document.getElementById("x-end").value) === end, before[1]);
  await done(page);
  await opened.close();
});

/** Length of an arrow that is drawn as a path. */
function lengthOf(path) {
  const [x, y, toX, toY] = path.match(/-?[\d.]+(e-?\d+)?/g).map(Number);
  return Math.hypot(toX - x, toY - y);
}

test("forces are arrows to a scale that is told", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  const arrow = (name) => page.locator(`#above .${name}`).getAttribute("d");
  await page.locator("#above .force-legend .value").waitFor({ state: "attached" });
  const newtons = Number((await page.locator("#above .force-legend .value").textContent()).replace(" N", ""));
  const perNewton = lengthOf(await arrow("scale")) / newtons;
  const numbers = await page.locator("#numbers").textContent();
  const friction = Number(numbers.match(/friction\D*([\d.]+)\s+N/)[1]);
  const drawn = lengthOf(await arrow("ground-force")) / perNewton;
  assert.ok(Math.abs(drawn / friction - 1) < 1e-3, `${drawn} ${friction}`);
  // The springs: k times the displacement of the king pin, which the springs are drawn to.
  const pin = page.locator("#above .pin");
  const moved = Math.hypot(Number(await pin.getAttribute("cx")), Number(await pin.getAttribute("cy")));
  const pulled = lengthOf(await arrow("king-pin-force")) / perNewton;
  assert.ok(Math.abs(pulled / (100 * moved) - 1) < 1e-3, `${pulled} ${100 * moved}`);
  await opened.close();
});

test("a cycle plays, and a blow from either side", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.locator("#shown-motion").selectOption({ label: "cycle AT1" });
  await page.locator("#history .plot").waitFor();
  await page.locator("#plane .curve.cycle").waitFor({ state: "attached" });
  const first = await page.locator("#above .caster").getAttribute("x2");
  await page.waitForFunction((x) => document.querySelector("#above .caster").getAttribute("x2") !== x, first);
  await opened.picture("wheel-cycle");
  await page.locator("#slides").uncheck();
  const turned = async (side) => {
    await page.locator("#blow-side").selectOption(side);
    await page.locator("#motion-note").evaluate((element) => element.replaceChildren());
    await page.locator("#hit").click();
    await page.locator("#motion-note", { hasText: "it was hit with 0.05 N s" }).waitFor();
    const points = (await page.locator("#history .curve").getAttribute("points")).split(" ").map((point) => Number(point.split(",")[1]));
    return Math.sign(points[0] - points[8]);
  };
  // A blow towards the centre ahead of the wheel's centre turns the caster with the yaw, psi' = omega - Omega < 0.
  assert.equal(await turned("1"), -1);
  assert.equal(await turned("-1"), 1);
  assert.match(await page.locator("#lines").textContent(), /^kingpin simulate --duration 3 --blow=-0\.05 -o motion\.json$/m);
  assert.match(await page.locator("#python-lines").textContent(), /^motion = wheel\.simulate\(3, blow=-0\.05\)$/m);
  await opened.close();
});

test("basins lie under the plane, and a press there starts a motion", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.locator("#slides").uncheck();
  await page.locator("#basin").check();
  await page.locator("#plane .basin").waitFor({ state: "attached" });
  await page.waitForFunction(() => document.querySelector("#plane .plane")?.dataset.cells === String(81 * 61), null, { timeout: 120_000 });
  assert.match(await page.locator("#plane .fates").textContent(), /uniform motion/);
  // The middle of the picture returns: its colour is that of the uniform motion.
  const [red, green, blue, opacity] = await page.locator("#plane .basin").evaluate((canvas) => [...canvas.getContext("2d").getImageData(43, 30, 1, 1).data]);
  assert.ok(opacity > 0 && blue > red && blue > green, [red, green, blue, opacity].join());
  await page.locator("#plane .plot").click({ position: { x: 170, y: 80 } });
  await page.locator("#motion-note", { hasText: "it was let go" }).waitFor();
  assert.match(await page.locator("#lines").textContent(), /--perturb psi=\S+ --perturb Omega=\S+ /);
  assert.match(await page.locator("#lines").textContent(), /^kingpin basin --x psi=-1:1:81 --y Omega=\S+:61 --contact rolling/m);
  assert.deepEqual(await opened.obstacles(), []);
  // What is saved of the plane has its map, as lines on pixels, and the wheel from above has none.
  const pdf = await saved(page, page.getByLabel("Save the plane"), "pdf");
  assert.match(operators(pdf.contents), / Do$/m);
  assert.match(String((await saved(page, page.getByLabel("Save the plane"), "svg")).contents), /<image [^>]*href="data:image\/png/);
  const above = operators((await saved(page, page.getByLabel("Save the wheel from above"), "pdf")).contents);
  assert.ok(above.match(/ c$/gm).length > 20 && !/ Do$/m.test(above));
  await opened.picture("wheel-basin");
  await opened.documented("page-wheel");
  // Without them nothing else changes.
  await page.locator("#basin").uncheck();
  await page.locator("#plane .basin").waitFor({ state: "detached" });
  assert.match(await page.locator("#motion-note").textContent(), /it was let go/);
  await opened.close();
});

test("the report is told in words", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.locator("#report summary").click();
  await page.locator("#findings li", { hasText: "stability, straight" }).waitFor({ timeout: 120_000 });
  await page.locator("#findings li", { hasText: "dampers, straight" }).waitFor();
  await page.locator("#findings li", { hasText: "blow" }).first().waitFor();
  assert.match(await page.locator("#lines").textContent(), /^kingpin report -o report$/m);
  await opened.picture("wheel-report");
  await opened.close();
});

test("shimmy with sliding is a curve, and plays", async () => {
  const file = new URL("shimmy.toml", import.meta.url).pathname;
  const other = await serve("kingpin", "--wheel", file);
  try {
    const opened = await open(browser, other.url);
    const { page } = opened;
    await done(page);
    await page.locator("#along-start").fill("7");
    await page.locator("#along-end").fill("9.6");
    await page.locator("#along button").click();
    await page.locator("#follow-shimmy").click();
    await page.locator("#shimmy-picture svg.drawn").waitFor({ timeout: 120_000 });
    await page.locator("#shimmy-notes button").first().waitFor();
    await page.locator("#shown-motion option", { hasText: "shimmy" }).first().waitFor({ state: "attached" });
    const label = await page.locator("#shown-motion option", { hasText: "shimmy" }).first().textContent();
    await page.locator("#shown-motion").selectOption({ label });
    await page.locator("#plane .curve.cycle").waitFor({ state: "attached" });
    await opened.picture("wheel-shimmy");
    // It is zoomed without being computed again, and saved as it is seen.
    const asked = [];
    page.on("request", (request) => asked.push(new URL(request.url()).pathname));
    const told = () => page.locator("#shimmy-picture .drawn desc").textContent();
    const whole = await told();
    await page.locator("#shimmy-picture").scrollIntoViewIfNeeded();
    const box = await page.locator("#shimmy-picture .overlay").boundingBox();
    await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.4 * box.height);
    await page.mouse.wheel(0, -100);
    await page.waitForFunction((before) => document.querySelector("#shimmy-picture .drawn desc")?.textContent !== before, whole);
    await opened.picture("wheel-shimmy-zoomed");
    const zoomed = await told();
    await page.mouse.down();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.45 * box.height, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((before) => document.querySelector("#shimmy-picture .drawn desc")?.textContent !== before, zoomed);
    const pdf = await saved(page, page.getByLabel("Save shimmy"), "pdf");
    assert.equal(pdf.name, "shimmy.pdf");
    operators(pdf.contents);
    await page.locator("#shimmy").getByRole("button", { name: "All of it (0)" }).click();
    await page.waitForFunction((before) => document.querySelector("#shimmy-picture .drawn desc")?.textContent === before, whole);
    assert.deepEqual([...new Set(asked)].filter((path) => path.startsWith("/api")), ["/api/wheel/diagram"]);
    await page.locator("#undo").click();
    await page.locator("#shimmy-picture svg.drawn").waitFor({ state: "detached" });
    await page.locator("#follow-shimmy").waitFor();
    await opened.close();
  } finally {
    await other.end();
  }
});

test("while a slider moves chart and verdict follow, and are always there", async () => {
  const opened = await open(browser, server.url);
  const { page } = opened;
  await done(page);
  await page.evaluate(() => {
    window.missing = 0;
    new MutationObserver(() => {
      if (!document.querySelector("#chart-picture .drawn") || !document.querySelector("#verdict strong")) window.missing++;
    }).observe(document.querySelector("#middle"), { childList: true, subtree: true });
  });
  const slider = page.getByLabel("r, slider", { exact: true });
  for (let step = 1; step <= 20; step++) {
    await slider.evaluate((element, to) => {
      element.value = String(to);
      element.dispatchEvent(new Event("input", { bubbles: true }));
    }, 1 - step / 50);
  }
  // The critical speed is r times 8.431 rad/s.
  await page.locator("#verdict", { hasText: "5.0586 m/s" }).waitFor();
  await page.waitForFunction(() => document.querySelector("#chart-picture").dataset.points === String(48 * 30));
  assert.equal(await page.evaluate(() => window.missing), 0);
  await opened.close();
});

test("a value that is not allowed says what is", async () => {
  const opened = await open(browser, server.url, { expected: /422/ });
  const { page } = opened;
  await page.locator("#quantity-l").waitFor();
  await page.locator("#quantity-l").fill("-1");
  await page.locator("#quantity-l").press("Tab");
  assert.match(await page.locator("#quantity-l").evaluate((element) => element.validationMessage), /to/);
  // Neither is a word a kick.
  await page.locator("#kick").fill("far");
  await page.locator("#let-go").click();
  assert.match(await page.locator("#kick").evaluate((element) => element.validationMessage), /a number/);
  assert.equal(await page.locator("#motion-note").textContent(), "");
  // Two values that do not go together are told by the server.
  await page.getByText("All parameters").click();
  await page.locator("#quantity-mu_s").fill("0.5");
  await page.locator("#quantity-mu_s").press("Tab");
  await page.locator("#wheel-problem", { hasText: "mu_d" }).waitFor();
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
