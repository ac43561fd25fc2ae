// @ts-check
/** Presets with pictures of this face, and the history. */

import { clear, make } from "./dom.js";
import { WORDS } from "./words.js";

export class Shelf extends EventTarget {
  constructor() {
    super();
    this.grid = make("ul", { class: "presets" });
    this.presets = make("section", { class: "block" }, make("p", { class: "hint" }, WORDS.presetNote), this.grid);
    this.states = make("ol", { class: "history" });
    this.history = make("section", { class: "block" }, this.states);
    /** @type {string[]} */
    this.urls = [];
  }

  forget() {
    for (const url of this.urls) URL.revokeObjectURL(url);
    this.urls = [];
    clear(this.grid);
  }

  /** @param {{name: string, note: string, layers: any[], body: Uint8Array<ArrayBuffer>}} preset */
  add(preset) {
    const url = URL.createObjectURL(new Blob([preset.body], { type: "image/jpeg" }));
    this.urls.push(url);
    const label = preset.name.replaceAll("-", " ");
    const button = make("button", { type: "button", title: preset.note || label, onclick: () => {
      this.dispatchEvent(new CustomEvent("preset", { detail: { op: { op: "add", layers: preset.layers }, what: label } }));
    } }, make("img", { src: url, alt: "" }), make("span", {}, label));
    this.grid.append(make("li", {}, button));
  }

  /** @param {[number, string][]} states @param {number} now */
  list(states, now) {
    clear(this.states);
    for (const [number, what] of [...states].reverse()) {
      this.states.append(make("li", {}, make("button", { type: "button", "aria-current": number === now ? "step" : null,
        onclick: () => this.dispatchEvent(new CustomEvent("go", { detail: number })) }, what || "–")));
    }
  }
}
