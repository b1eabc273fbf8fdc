// Pictures of the server in which the pointer picks a place.

import { pictureElement } from "./diagram.js";
import { html, svg } from "./element.js";

/** @typedef {import("./diagram.js").Picture} Picture */

/**
 * Shows a picture; `pick` is told the place in the units of its axes, and `marked` is marked.
 * @param {HTMLElement} box
 * @param {Picture} picture
 * @param {string} description
 * @param {[number, number] | null} marked
 * @param {import("./zoom.js").Zoom | null} zoom
 * @param {((x: number, y: number) => void) | null} pick
 */
export function showPicture(box, picture, description, marked, zoom, pick) {
  const place = picture.panels[0];
  const overlay = svg("svg", { viewBox: `0 0 ${picture.width} ${picture.height}`, class: "overlay" });
  box.replaceChildren(pictureElement(picture, description), overlay);
  if (!place) return;
  const [width, height] = [place.right - place.left, place.bottom - place.top];
  if (marked) {
    const x = place.left + ((marked[0] - place.x.low) / (place.x.high - place.x.low)) * width;
    const y = place.bottom - ((marked[1] - place.y.low) / (place.y.high - place.y.low)) * height;
    const inside = x >= place.left && x <= place.right && y >= place.top && y <= place.bottom;
    if (inside) overlay.append(svg("path", { class: "chosen", d: `M${x - 6} ${y}h12M${x} ${y - 6}v12` }));
  }
  zoom?.attach(overlay, box, place, picture);
  if (!pick) return;
  overlay.addEventListener("click", (event) => {
    if (zoom?.hasDragged) return;
    const bounds = overlay.getBoundingClientRect();
    const x = ((event.clientX - bounds.left) / bounds.width) * picture.width;
    const y = ((event.clientY - bounds.top) / bounds.height) * picture.height;
    if (x < place.left || x > place.right || y < place.top || y > place.bottom) return;
    pick(place.x.low + ((x - place.left) / width) * (place.x.high - place.x.low), place.y.low + ((place.bottom - y) / height) * (place.y.high - place.y.low));
  });
}

/** @param {HTMLElement} box @param {string} message */
export function showProblem(box, message) {
  box.replaceChildren(html("p", { class: "problem" }, message));
}
