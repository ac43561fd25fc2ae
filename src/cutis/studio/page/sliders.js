// @ts-check
/** A row for each map: how it is edited, by how much, on a track painted with the skin it gives. */

import { iconButton, make } from "./dom.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").Edit} Edit */
/** @typedef {import("./types.js").Track} Track */
/** @typedef {import("./types.js").Parameter} Parameter */

const PLACES = 1000;
const DOES = ["multiply", "offset", "set", "floor", "ceiling"];
/** What changes nothing. @type {Record<string, number | null>} */
const NEUTRAL = { multiply: 1, offset: 0, set: null, floor: null, ceiling: null };

export class Row extends EventTarget {
  /** @param {Parameter} known @param {[string, number, number]} span */
  constructor(known, span) {
    super();
    this.known = known;
    this.usual = span[0];
    this.do = this.usual;
    /** @type {Track} */
    this.track = { values: [], colours: [] };
    /** @type {number | null} */
    this.value = NEUTRAL[this.do];
    const label = /** @type {Record<string, string>} */ (WORDS.maps)[known.name];
    const id = `slider-${known.name}`;
    this.range = make("input", { type: "range", id, min: "0", max: String(PLACES), step: "1", class: "track" });
    this.number = make("input", { type: "text", inputmode: "decimal", class: "number", "aria-label": `${label}, ${known.unit === "1" ? "number" : known.unit}`, autocomplete: "off", spellcheck: "false" });
    this.how = make("select", { class: "how", "aria-label": `${label}: ${WORDS.how}`, title: WORDS.how },
      ...DOES.map((one) => make("option", { value: one, title: /** @type {any} */ (WORDS.doingLong)[one] }, /** @type {any} */ (WORDS.doing)[one])));
    this.how.value = this.do;
    this.reset = iconButton("reset", `${WORDS.reset} ${label}`, () => this.clear(), { class: "quiet reset" });
    this.element = make("div", { class: "row" },
      make("div", { class: "line" },
        make("label", { for: id, title: `${known.meaning} (${known.symbol})` }, label),
        this.reset, this.how, this.number,
        this.unit = make("span", { class: "unit" })),
      this.range);
    this.range.addEventListener("input", () => this.slid(false));
    this.range.addEventListener("change", () => this.slid(true));
    this.range.addEventListener("dblclick", () => this.clear());
    this.number.addEventListener("change", () => this.typed());
    this.number.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.number.blur();
      if (event.key === "Escape") { this.write(); this.number.blur(); }
    });
    this.how.addEventListener("change", () => {
      this.do = this.how.value;
      this.value = NEUTRAL[this.do];
      this.dispatchEvent(new Event("how"));
      if (this.value !== null || this.do === "set") this.tell(null, true);
    });
    this.write();
  }

  /** The edit as a look has it; null for none. @returns {Edit | null} */
  edit() {
    if (this.value === null || this.value === NEUTRAL[this.do]) return null;
    const key = this.do === "multiply" || this.do === "offset" ? "by" : "to";
    return /** @type {Edit} */ ({ do: this.do, map: this.known.name, [key]: this.value });
  }

  /** Shows an edit of a look. @param {Edit | undefined} edit */
  show(edit) {
    if (edit && DOES.includes(edit.do)) {
      this.do = edit.do;
      this.value = edit.by ?? edit.to ?? null;
    } else {
      if (!(this.value === null || this.value === NEUTRAL[this.do])) this.value = NEUTRAL[this.do];
      if (!edit && NEUTRAL[this.do] !== null) this.value = NEUTRAL[this.do];
    }
    this.how.value = this.do;
    this.write();
  }

  /** @param {Track} track */
  paint(track) {
    this.track = track;
    const stops = track.colours.map((c, i) => `${c} ${((100 * i) / (track.colours.length - 1)).toFixed(1)}%`);
    this.range.style.setProperty("--track", `linear-gradient(90deg, ${stops.join(", ")})`);
    this.write();
  }

  ends() {
    const { values } = this.track;
    return values.length ? [values[0], values[values.length - 1]] : [0, 1];
  }

  /** Value at a share of the track: between the server's places. @param {number} share */
  valueAt(share) {
    const { values } = this.track;
    if (!values.length) return NEUTRAL[this.do] ?? 0;
    const at = share * (values.length - 1);
    const i = Math.min(Math.floor(at), values.length - 2);
    const [a, b] = [values[i], values[i + 1]];
    return this.do === "multiply" ? a * (b / a) ** (at - i) : a + (b - a) * (at - i);
  }

  /** @param {number} value */
  shareOf(value) {
    const { values } = this.track;
    if (!values.length) return 0.5;
    if (value <= values[0]) return 0;
    for (let i = 0; i + 1 < values.length; i++) {
      if (value <= values[i + 1]) {
        const [a, b] = [values[i], values[i + 1]];
        const part = this.do === "multiply" ? Math.log(value / a) / Math.log(b / a) : (value - a) / (b - a);
        return (i + part) / (values.length - 1);
      }
    }
    return 1;
  }

  /** @param {boolean} done */
  slid(done) {
    let value = this.valueAt(Number(this.range.value) / PLACES);
    const neutral = NEUTRAL[this.do];
    if (neutral !== null && Math.abs(this.shareOf(neutral) * PLACES - Number(this.range.value)) < 8) value = neutral;
    this.value = Number(value.toPrecision(4));
    this.write(true);
    this.tell(this.edit(), done);
  }

  typed() {
    const value = Number(this.number.value.replace(",", ".").replace(/[×+=≥≤\s]/g, "").replace("−", "-"));
    const low = this.do === "offset" ? -Infinity : this.do === "multiply" ? 0 : this.known.low;
    const high = this.do === "offset" || this.do === "multiply" ? 1e6 : this.known.high;
    if (!Number.isFinite(value) || this.number.value.trim() === "") return this.write();
    this.value = Math.min(Math.max(value, low), high);
    this.write();
    this.tell(this.edit(), true);
  }

  clear() {
    this.value = NEUTRAL[this.do];
    if (this.value === null) { this.do = this.usual; this.value = NEUTRAL[this.do]; this.dispatchEvent(new Event("how")); }
    this.how.value = this.do;
    this.write();
    this.tell(null, true);
  }

  /** @param {Edit | null} edit @param {boolean} done */
  tell(edit, done) {
    this.dispatchEvent(new CustomEvent("edit", { detail: { edit, done } }));
  }

  /** @param {boolean} [sliding] */
  write(sliding = false) {
    const set = this.value !== null;
    if (document.activeElement !== this.number) {
      this.number.value = set ? shown(/** @type {number} */ (this.value), this.do) : "";
    }
    if (!sliding) this.range.value = String(Math.round(PLACES * (set ? this.shareOf(/** @type {number} */ (this.value)) : 0.5)));
    this.unit.textContent = this.do === "multiply" || this.known.unit === "1" ? "" : this.known.unit;
    const idle = this.edit() === null;
    this.element.classList.toggle("idle", idle);
    this.reset.hidden = idle;
    this.range.setAttribute("aria-valuetext", set ? `${/** @type {any} */ (WORDS.doing)[this.do]} ${this.number.value}` : "–");
  }
}

/** @param {number} value @param {string} how */
function shown(value, how) {
  const digits = Math.abs(value) >= 100 ? 0 : Math.abs(value) >= 10 ? 1 : Math.abs(value) < 0.01 && value !== 0 ? 4 : Math.abs(value) < 0.1 && value !== 0 ? 3 : 2;
  const text = value.toFixed(digits).replace("-", "−");
  return how === "offset" && value > 0 ? `+${text}` : text;
}
