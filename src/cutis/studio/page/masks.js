// @ts-check
/** The mask of the chosen layer: a brush, ranges of maps, and how the parts go together. */

import { clear, iconButton, make } from "./dom.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").Layer} Layer */
/** @typedef {import("./types.js").MaskPart} MaskPart */

const MAPS = ["melanin", "blood", "thickness", "eumelanin", "oxygenation"];

export class Masks extends EventTarget {
  constructor() {
    super();
    /** @type {"" | "brush" | "eraser"} */
    this.tool = "";
    this.showing = false;
    this.size = slider(1, 100, 30);
    this.hardness = slider(0, 100, 40);
    this.opacity = slider(1, 100, 100);
    this.buttons = {
      brush: make("button", { type: "button", class: "plain-button small", "aria-pressed": "false", onclick: () => this.take("brush") }, WORDS.brush),
      eraser: make("button", { type: "button", class: "plain-button small", "aria-pressed": "false", onclick: () => this.take("eraser") }, WORDS.eraser),
    };
    this.look = make("button", { type: "button", class: "plain-button small", "aria-pressed": "false", onclick: () => this.toggle() }, WORDS.showMask);
    const range = make("button", { type: "button", class: "plain-button small", title: WORDS.addRange, onclick: () => this.add({ part: "range", map: "melanin", above: ["p65", "p75"] }) }, WORDS.range);
    this.brush = make("div", { class: "brush", hidden: true },
      named(WORDS.size, this.size), named(WORDS.hardness, this.hardness), named(WORDS.opacity, this.opacity));
    this.parts = make("ul", { class: "parts" });
    this.element = make("section", { class: "block" }, make("header", {}, make("h2", {}, WORDS.mask), this.look),
      make("div", { class: "buttons" }, this.buttons.brush, this.buttons.eraser, range), this.brush, this.parts);
    /** @type {string | null} */
    this.id = null;
    /** @type {MaskPart[]} */
    this.mask = [];
  }

  /** Radius of the brush as a share of the longer side. */
  get radius() {
    return 0.25 * (Number(this.size.value) / 100) ** 2 + 0.0005;
  }

  /** @param {"" | "brush" | "eraser"} tool */
  take(tool) {
    this.tool = this.tool === tool ? "" : tool;
    for (const [name, button] of Object.entries(this.buttons)) button.setAttribute("aria-pressed", String(name === this.tool));
    this.brush.hidden = !this.tool;
    this.dispatchEvent(new Event("tool"));
  }

  toggle() {
    this.showing = !this.showing;
    this.look.setAttribute("aria-pressed", String(this.showing));
    this.dispatchEvent(new Event("showing"));
  }

  /** @param {[number, number][]} points */
  stroke(points) {
    const stroke = { points, radius: this.radius, hardness: Number(this.hardness.value) / 100, opacity: Number(this.opacity.value) / 100 };
    return { op: "stroke", id: this.id, stroke: this.tool === "eraser" ? { ...stroke, erase: true } : stroke };
  }

  /** @param {MaskPart} part */
  add(part) {
    this.tell({ op: "part", part }, true, WORDS.addRange);
  }

  /** @param {any} op @param {boolean} done @param {string} what */
  tell(op, done, what) {
    if (this.id) this.dispatchEvent(new CustomEvent("op", { detail: { op: { ...op, id: this.id }, done, what } }));
  }

  /** @param {number} at @param {MaskPart | null} part @param {string} what @param {boolean} [done] */
  put(at, part, what, done = true) {
    this.tell({ op: "part", at, part }, done, what);
  }

  /** @param {string | null} id @param {Layer | null} layer */
  show(id, layer) {
    this.id = id;
    this.mask = layer?.mask ?? [];
    this.element.hidden = !layer;
    clear(this.parts);
    if (!this.mask.length) this.parts.append(make("li", { class: "hint" }, WORDS.everywhere));
    this.mask.forEach((part, at) => this.parts.append(this.item(part, at)));
  }

  /** @param {MaskPart} part @param {number} at */
  item(part, at) {
    const names = /** @type {Record<string, string>} */ (WORDS.parts);
    const title = part.part === "strokes" ? `${names.strokes}, ${part.strokes?.length ?? 0}` : names[part.part] ?? part.part;
    const how = make("select", { "aria-label": WORDS.mask }, ...Object.entries(WORDS.hows).map(([value, said]) => make("option", { value }, said)));
    how.value = part.how ?? "add";
    how.addEventListener("change", () => this.put(at, { ...part, how: how.value }, title));
    const invert = make("input", { type: "checkbox", "aria-label": `${WORDS.invert} ${title}` });
    invert.checked = Boolean(part.invert);
    invert.addEventListener("change", () => this.put(at, { ...part, invert: invert.checked }, WORDS.invert));
    const line = make("div", { class: "line" }, make("span", { class: "name" }, title), how,
      make("label", { class: "check" }, invert, WORDS.invert),
      iconButton("close", `${WORDS.remove} ${title}`, () => this.put(at, null, title)));
    const item = make("li", {}, line);
    if (part.part === "range") item.append(this.range(part, at));
    return item;
  }

  /** @param {MaskPart} part @param {number} at */
  range(part, at) {
    const labels = /** @type {Record<string, string>} */ (WORDS.maps);
    const map = make("select", { "aria-label": WORDS.range }, ...MAPS.map((name) => make("option", { value: name }, labels[name])));
    map.value = part.map;
    const [low, high] = (Array.isArray(part.above) ? part.above : ["p65", "p75"]).map((one) => Number(String(one).slice(1)));
    const level = slider(5, 95, Math.round((low + high) / 2));
    level.setAttribute("aria-label", WORDS.aboveShare);
    level.title = WORDS.aboveShare;
    const changed = (/** @type {boolean} */ done) => {
      const middle = Number(level.value);
      this.put(at, { ...part, map: map.value, above: [`p${middle - 5}`, `p${middle + 5}`] }, WORDS.range, done);
    };
    map.addEventListener("change", () => changed(true));
    level.addEventListener("input", () => changed(false));
    level.addEventListener("change", () => changed(true));
    return make("div", { class: "line" }, map, level);
  }
}

/** @param {number} min @param {number} max @param {number} value */
function slider(min, max, value) {
  return make("input", { type: "range", class: "plain", min, max, step: 1, value });
}

/** @param {string} name @param {HTMLInputElement} input */
function named(name, input) {
  input.setAttribute("aria-label", name);
  return make("div", { class: "line" }, make("span", { class: "label" }, name), input);
}
