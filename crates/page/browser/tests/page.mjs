// A server and a browser for a test. Every page is watched: an error on the console or a request that leaves this machine fails the test.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { once } from "node:events";
import { chromium } from "playwright-core";

export const PROGRAMS = process.env.PROGRAMS ?? new URL("../../../../target/debug", import.meta.url).pathname;
/** Where pictures of the page are kept; nowhere unless asked for. */
const PICTURES = process.env.PICTURES;
/** Whether the pictures of the documentation are made again. */
const DOCUMENTATION = process.env.DOCUMENTATION;

const AXE = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");

/** Starts `program serve`; `end` stops it as Ctrl-C does. */
export async function serve(program, ...options) {
  const child = spawn(`${PROGRAMS}/${program}`, ["serve", "--port", "0", ...options], { stdio: ["ignore", "pipe", "inherit"] });
  let line = "";
  // It may come in parts.
  while (!line.includes("\n")) line += String((await once(child.stdout, "data"))[0]);
  const url = line.trim();
  return {
    url,
    async end() {
      if (child.exitCode !== null) return child.exitCode;
      child.kill("SIGINT");
      const [code] = await once(child, "exit");
      return code;
    },
  };
}

/** What a menu saves. */
export async function saved(page, menu, format) {
  const download = page.waitForEvent("download");
  await menu.selectOption(format);
  const file = await download;
  return { name: file.suggestedFilename(), contents: readFileSync(await file.path()) };
}

/** What is drawn on the page of a PDF file, as its operators. */
export function operators(pdf) {
  assert.match(String(pdf.subarray(0, 8)), /^%PDF-/);
  const text = pdf.toString("latin1");
  const pages = [...text.matchAll(/stream\r?\n/g)].filter(({ index }) => text.slice(index - 3, index) !== "end").map(({ 0: head, index }) => {
    try {
      return inflateSync(pdf.subarray(index + head.length)).toString("latin1");
    } catch {
      return "";
    }
  });
  // Maps are streams too.
  return pages.at(-1) ?? "";
}

export async function launch() {
  return chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
  });
}

/** Opens a page; `problems` gathers what must not happen, and what does not match `expected`, whenever it comes. */
export async function open(browser, url, { expected, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, ...options });
  const page = await context.newPage();
  const problems = [];
  const isExpected = (text) => expected?.test(text) ?? false;
  page.on("console", (message) => {
    if (message.type() === "error" && !isExpected(message.text())) problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`script: ${error.stack}`));
  page.on("request", (request) => {
    const { protocol, hostname } = new URL(request.url());
    if (protocol === "http:" && hostname !== "127.0.0.1") problems.push(`request: ${request.url()}`);
  });
  await page.goto(url);
  return {
    page,
    problems,
    /** Waits until everything is computed and drawn. */
    async settled() {
      await page.waitForFunction(() => {
        const rows = [...document.querySelectorAll("#steps li")];
        const pictures = [...document.querySelectorAll(".diagram .picture")];
        // A picture that is asked for is not yet the one of the rows.
        return rows.length > 0 && rows.every((row) => row.dataset.state !== "running") && pictures.every((picture) => picture.getAttribute("aria-busy") !== "true");
      }, null, { timeout: 120_000 });
    },
    /** What axe-core finds that people with disabilities would stumble over. */
    async obstacles() {
      await page.evaluate(AXE);
      return page.evaluate(async () => (await axe.run()).violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join("; ")}`));
    },
    async picture(name) {
      if (!PICTURES) return;
      mkdirSync(PICTURES, { recursive: true });
      await page.screenshot({ path: `${PICTURES}/${name}.png`, fullPage: true });
    },
    /** The picture of this name in the documentation. */
    async documented(name) {
      if (!DOCUMENTATION) return;
      // Nothing is pointed at.
      await page.evaluate(() => document.activeElement?.blur());
      // A column that scrolls by itself is shown whole.
      const { width } = page.viewportSize();
      const height = await page.evaluate(() => Math.max(document.documentElement.scrollHeight, (document.querySelector("#point")?.scrollHeight ?? 0) + 120));
      await page.setViewportSize({ width, height: Math.max(height, page.viewportSize().height) });
      await page.screenshot({ path: new URL(`../../../../docs/${name}.png`, import.meta.url).pathname, fullPage: true });
    },
    async close() {
      await context.close();
      assert.deepEqual(problems, []);
    },
  };
}
