// Back and forward of the browser as buttons and keys: what the page holds stands in its address.

import { byId } from "./element.js";

/** Whether somebody writes there, where these keys mean the text. @param {Element | null} element */
function isText(element) {
  return element instanceof HTMLTextAreaElement || (element instanceof HTMLInputElement && element.type === "text");
}

/** How many entries the page has made before this one, and in all. */
let depth = 0;
let deepest = 0;

function showButtons() {
  /** @type {HTMLButtonElement} */ (byId("undo")).disabled = depth === 0;
  /** @type {HTMLButtonElement} */ (byId("redo")).disabled = depth >= deepest;
}

/** Goes to an address. @param {string} address @param {boolean} isEntry whether it is another entry of the history */
export function enter(address, isEntry) {
  if (isEntry) deepest = ++depth;
  history[isEntry ? "pushState" : "replaceState"]({ depth }, "", address);
  showButtons();
}

/** Listens to the buttons and keys of the page. */
export function listenToUndo() {
  // A page that is loaded again knows nothing of what could be redone.
  depth = deepest = history.state?.depth ?? 0;
  showButtons();
  addEventListener("popstate", (event) => {
    depth = event.state?.depth ?? 0;
    showButtons();
  });
  byId("undo").addEventListener("click", () => history.back());
  byId("redo").addEventListener("click", () => history.forward());
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isText(document.activeElement)) return;
    const key = event.key.toLowerCase();
    if (key === "y" || (key === "z" && event.shiftKey)) history.forward();
    else if (key === "z") history.back();
    else return;
    event.preventDefault();
  });
}

/** Shows how far something is, where that is known. @param {(number | null)[]} parts of what runs, from 0 to 1 */
export function showProgress(parts) {
  const known = parts.filter((part) => part !== null && part > 0 && part <= 1);
  /** @type {HTMLElement} */
  const bar = byId("progress");
  bar.hidden = !known.length;
  if (known.length) /** @type {HTMLProgressElement} */ (bar).value = Math.min(.../** @type {number[]} */ (known));
}
