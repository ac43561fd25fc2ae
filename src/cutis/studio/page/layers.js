// @ts-check
/** The list of layers, the topmost first. */

import { clear, iconButton, make } from "./dom.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Op} Op */

export class LayerList extends EventTarget {
  constructor() {
    super();
    this.list = make("ul", { class: "layers", role: "listbox", "aria-label": WORDS.layers });
    this.tools = make("div", { class: "tools" });
    this.element = make("section", { class: "block" },
      make("header", {}, make("h2", {}, WORDS.layers), this.tools), this.list);
    /** @type {State | null} */
    this.state = null;
    /** @type {string | null} */
    this.chosen = null;
    this.tools.append(
      iconButton("up", WORDS.up, () => this.move(1)),
      iconButton("down", WORDS.down, () => this.move(-1)),
      iconButton("copy", WORDS.duplicate, () => this.chosen && this.op({ op: "duplicate", id: this.chosen }, WORDS.duplicate)),
      iconButton("bin", WORDS.remove, () => this.remove()),
      iconButton("plus", WORDS.addLayer, () => this.add()),
    );
  }

  /** @param {Op} op @param {string} what */
  op(op, what) {
    this.dispatchEvent(new CustomEvent("op", { detail: { op, what } }));
  }

  add() {
    const count = (this.state?.ids.length ?? 0) + 1;
    this.op({ op: "add", layers: [{ name: `${WORDS.layerName} ${count}` }], at: this.place() + 1 }, WORDS.addLayer);
  }

  remove() {
    if (this.chosen) this.op({ op: "remove", id: this.chosen }, WORDS.remove);
  }

  /** @param {number} by */
  move(by) {
    if (this.chosen) this.op({ op: "move", id: this.chosen, to: Math.max(0, this.place() + by) }, by > 0 ? WORDS.up : WORDS.down);
  }

  place() {
    return this.state && this.chosen ? this.state.ids.indexOf(this.chosen) : -1;
  }

  /** The layer that is chosen. */
  layer() {
    const at = this.place();
    return at < 0 ? null : (this.state?.look.layers ?? [])[at] ?? null;
  }

  toggle() {
    const layer = this.layer();
    if (layer && this.chosen) this.op({ op: "set", id: this.chosen, field: "on", value: layer.on === false }, layer.on === false ? WORDS.show : WORDS.hide);
  }

  /** @param {string | null} id */
  choose(id) {
    if (this.chosen === id) return;
    this.chosen = id;
    for (const item of /** @type {NodeListOf<HTMLElement>} */ (this.list.querySelectorAll("li"))) {
      const chosen = item.dataset.id === id;
      item.classList.toggle("chosen", chosen);
      item.setAttribute("aria-selected", String(chosen));
    }
    this.dispatchEvent(new Event("chosen"));
  }

  /** Chooses the layer so far above. @param {number} by */
  step(by) {
    const ids = this.state?.ids ?? [];
    const next = ids[this.place() + by];
    if (next) this.choose(next);
  }

  /** @param {State} state */
  show(state) {
    const before = this.state?.ids ?? [];
    this.state = state;
    const added = state.ids.filter((id) => !before.includes(id));
    if (before.length && added.length && state.ids.length > before.length) this.chosen = added[added.length - 1];
    else if (!this.chosen || !state.ids.includes(this.chosen)) {
      const old = this.chosen ? before.indexOf(this.chosen) : -1;
      this.chosen = state.ids[Math.min(Math.max(old, 0), state.ids.length - 1)] ?? null;
    }
    this.draw();
    this.dispatchEvent(new Event("chosen"));
  }

  draw() {
    const layers = this.state?.look.layers ?? [];
    const ids = this.state?.ids ?? [];
    clear(this.list);
    for (let i = ids.length - 1; i >= 0; i--) this.list.append(this.item(ids[i], layers[i] ?? {}, i));
  }

  /** @param {string} id @param {import("./types.js").Layer} layer @param {number} at */
  item(id, layer, at) {
    const on = layer.on !== false;
    const name = layer.name || `${WORDS.layerName} ${at + 1}`;
    const eye = iconButton(on ? "eye" : "hidden", on ? WORDS.hide : WORDS.show, (event) => {
      event.stopPropagation();
      this.op({ op: "set", id, field: "on", value: !on }, on ? WORDS.hide : WORDS.show);
    });
    const label = make("span", { class: "name" }, name);
    const amount = layer.amount ?? 1;
    const item = make("li", {
      role: "option", tabindex: "0", "data-id": id, "aria-selected": id === this.chosen ? "true" : "false",
      class: `${id === this.chosen ? "chosen" : ""} ${on ? "" : "off"}`,
      onclick: () => this.choose(id),
      ondblclick: () => this.rename(id, label),
      onkeydown: (/** @type {KeyboardEvent} */ event) => {
        if (event.key === "Enter") this.choose(id);
        if (event.key === "F2") this.rename(id, label);
      },
    }, eye, label, layer.mask?.length ? make("span", { class: "badge" }, "mask") : null,
      make("span", { class: "percent" }, amount < 1 ? `${Math.round(100 * amount)} %` : ""));
    return item;
  }

  /** @param {string} id @param {HTMLElement} label */
  rename(id, label) {
    const input = make("input", { type: "text", value: label.textContent ?? "", maxlength: "200", "aria-label": WORDS.rename });
    let over = false;
    const end = (/** @type {boolean} */ keep) => {
      if (over) return;
      over = true;
      if (keep && input.value.trim() && input.value !== label.textContent) {
        this.op({ op: "set", id, field: "name", value: input.value.trim() }, WORDS.rename);
      } else this.draw();
    };
    input.addEventListener("blur", () => end(true));
    input.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter") end(true);
      if (event.key === "Escape") end(false);
    });
    label.replaceWith(input);
    input.select();
  }
}
