// The text of a model, with what is wrong underlined.

import { byId, html } from "./element.js";

/** @typedef {import("./ask.js").Place} Place */

export class Editor {
  /** @param {(text: string) => void} changed is told of the text when it has changed */
  constructor(changed) {
    /** @type {HTMLTextAreaElement} */
    this.text = byId("source");
    this.under = byId("source-under");
    this.message = byId("source-message");
    /** @type {Place | null} */
    this.place = null;
    let timer = 0;
    this.text.addEventListener("input", () => {
      this.clear();
      clearTimeout(timer);
      timer = setTimeout(() => changed(this.text.value), 400);
    });
    this.text.addEventListener("scroll", () => this.scroll());
    const box = byId("editor");
    box.addEventListener("dragover", (event) => event.preventDefault());
    box.addEventListener("drop", async (event) => {
      const file = event.dataTransfer?.files[0];
      if (!file) return;
      event.preventDefault();
      await this.take(file, changed);
    });
    /** @type {HTMLInputElement} */
    const chooser = byId("file");
    chooser.addEventListener("change", async () => {
      const file = chooser.files?.[0];
      if (file) await this.take(file, changed);
      chooser.value = "";
    });
    this.name = "model.ode";
  }

  /**
   * @param {File} file
   * @param {(text: string) => void} changed
   */
  async take(file, changed) {
    this.show(await file.text(), file.name);
    changed(this.text.value);
  }

  /**
   * @param {string} text
   * @param {string} name
   */
  show(text, name) {
    this.name = name;
    if (this.text.value !== text) this.text.value = text;
    byId("model-name").textContent = name;
    this.clear();
  }

  clear() {
    this.mark(null, "");
  }

  /**
   * Says what is wrong, and underlines it.
   * @param {Place | null} place
   * @param {string} message
   */
  mark(place, message) {
    this.place = place;
    this.message.textContent = message;
    this.message.hidden = !message;
    this.text.setAttribute("aria-invalid", String(Boolean(message)));
    this.under.replaceChildren();
    if (!place) return;
    const lines = this.text.value.split(/\r\n|\n|\r/);
    const before = lines.slice(0, place.line - 1).map((line) => `${line}\n`).join("");
    const characters = Array.from(lines[place.line - 1] ?? "");
    const start = place.column - 1;
    const marked = characters.slice(start, start + place.length).join("") || " ";
    this.under.append(before + characters.slice(0, start).join(""), html("mark", {}, marked));
    this.under.append(characters.slice(start + place.length).join("") + "\n" + lines.slice(place.line).join("\n"));
    this.scroll();
  }

  scroll() {
    this.under.scrollTop = this.text.scrollTop;
    this.under.scrollLeft = this.text.scrollLeft;
  }
}
