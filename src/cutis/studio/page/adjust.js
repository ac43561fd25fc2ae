// @ts-check
/** The chosen layer: its amount, and a slider for each map. */

import { clear, iconButton, make } from "./dom.js";
import { Row } from "./sliders.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").Edit} Edit */
/** @typedef {import("./types.js").Layer} Layer */
/** @typedef {import("./types.js").Op} Op */

const RARE = ["bilirubin", "carotene", "methaemoglobin"];

export class Adjust extends EventTarget {
  constructor() {
    super();
    this.amount = make("input", { type: "range", min: "0", max: "100", step: "1", class: "plain", "aria-label": WORDS.amount });
    this.percent = make("output", { class: "percent" });
    this.rows = make("div", { class: "rows" });
    this.rare = make("details", { class: "rare" }, make("summary", {}, WORDS.rare));
    this.others = make("ul", { class: "others" });
    this.body = make("div", {},
      make("div", { class: "line amount" }, make("span", {}, WORDS.amount), this.amount, this.percent),
      this.rows, this.rare, this.others);
    this.hint = make("p", { class: "hint" }, WORDS.noLayer);
    this.element = make("section", { class: "block" }, make("header", {}, make("h2", {}, WORDS.adjust)), this.body, this.hint);
    /** @type {Map<string, Row>} */
    this.all = new Map();
    /** @type {string | null} */
    this.id = null;
    /** @type {Layer | null} */
    this.layer = null;
    this.amount.addEventListener("input", () => this.setAmount(false));
    this.amount.addEventListener("change", () => this.setAmount(true));
  }

  /** @param {import("./types.js").Parameter[]} parameters @param {Record<string, import("./types.js").Span>} spans */
  prepare(parameters, spans) {
    this.all.clear();
    clear(this.rows);
    for (const row of this.rare.querySelectorAll(".row")) row.remove();
    for (const known of parameters) {
      const row = new Row(known, spans[known.name]);
      this.all.set(known.name, row);
      (RARE.includes(known.name) ? this.rare : this.rows).append(row.element);
      row.addEventListener("how", () => this.dispatchEvent(new Event("tracks")));
      row.addEventListener("edit", (event) => {
        const { edit, done } = /** @type {CustomEvent} */ (event).detail;
        const name = /** @type {Record<string, string>} */ (WORDS.maps)[known.name];
        this.tell({ op: "tune", map: known.name, edit }, done, `${name} ${edit ? `${/** @type {any} */ (WORDS.doing)[edit.do]}${edit.by ?? edit.to}` : WORDS.reset}`);
      });
    }
  }

  /** @param {boolean} done */
  setAmount(done) {
    this.percent.value = `${this.amount.value} %`;
    this.tell({ op: "set", field: "amount", value: Number(this.amount.value) / 100 }, done, `${WORDS.amount} ${this.amount.value} %`);
  }

  /** @param {any} op @param {boolean} done @param {string} what */
  tell(op, done, what) {
    if (this.id) this.dispatchEvent(new CustomEvent("op", { detail: { op: { ...op, id: this.id }, done, what } }));
  }

  /** What each slider does, by map. */
  does() {
    return Object.fromEntries([...this.all.entries()].map(([name, row]) => [name, row.do]));
  }

  /** @param {string | null} id @param {Layer | null} layer */
  show(id, layer) {
    this.id = id;
    this.layer = layer;
    this.body.hidden = !layer;
    this.hint.hidden = Boolean(layer);
    if (!layer) return;
    const percent = Math.round(100 * (layer.amount ?? 1));
    this.amount.value = String(percent);
    this.percent.value = `${percent} %`;
    const seen = new Set();
    clear(this.others);
    (layer.edits ?? []).forEach((edit, i) => {
      const row = this.all.get(edit.map);
      if (row && !seen.has(edit.map) && plain(edit)) {
        seen.add(edit.map);
        row.show(edit);
      } else this.others.append(this.other(edit, i));
    });
    for (const [name, row] of this.all) if (!seen.has(name)) row.show(undefined);
    if (RARE.some((name) => seen.has(name))) this.rare.open = true;
  }

  /** An edit that no slider shows. @param {Edit} edit @param {number} at */
  other(edit, at) {
    const name = /** @type {Record<string, string>} */ (WORDS.maps)[edit.map];
    const where = edit.areas && edit.areas !== "all" ? `, ${edit.areas}` : "";
    const said = `${name} ${/** @type {any} */ (WORDS.doing)[edit.do] ?? edit.do} ${edit.by ?? edit.to ?? ""}${where}`;
    return make("li", {}, make("span", {}, said), iconButton("close", `${WORDS.reset} ${said}`, () => {
      const edits = (this.layer?.edits ?? []).filter((_, i) => i !== at);
      this.tell({ op: "set", field: "edits", value: edits }, true, said);
    }));
  }
}

/** @param {Edit} edit */
function plain(edit) {
  return (edit.areas ?? "all") === "all" && ["multiply", "offset", "set", "floor", "ceiling"].includes(edit.do);
}
