// Saves pictures and results.

import { askFile } from "./ask.js";
import { html } from "./element.js";

/**
 * Gives a file to the user.
 * @param {Blob} contents
 * @param {string} name
 */
export function give(contents, name) {
  const url = URL.createObjectURL(contents);
  html("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/**
 * A menu of formats.
 * @param {string} what
 * @param {string[]} formats
 * @param {(format: string) => Promise<void>} save
 * @param {string} [title] what it shows, where several stand together
 */
export function saveMenu(what, formats, save, title = "Save…") {
  const select = html("select", { class: "save", "aria-label": `Save ${what}` }, html("option", { value: "" }, title));
  for (const format of formats) select.append(html("option", { value: format }, format.toUpperCase()));
  select.addEventListener("change", async () => {
    const format = select.value;
    select.value = "";
    if (format) await save(format);
  });
  return select;
}

/**
 * Saves results in a format that the server writes.
 * @param {string} path where it is asked
 * @param {Record<string, string>} files
 * @param {{results: string[], states?: string[], window?: import("./zoom.js").Window, dark?: boolean, colors?: Record<string, string>}} what
 * @param {string} format
 * @param {string} name without an ending
 */
export async function saveResults(path, files, what, format, name) {
  give(await askFile(path, { request: { ...what, format }, files }), `${name}.${format === "text" ? "txt" : format}`);
}
