// @ts-check
/** What is under the pointer: numbers, and the spectrum. */

import { clear, make, svg } from "./dom.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").Reading} Reading */
/** @typedef {import("./types.js").Colours} Colours */
/** @typedef {import("./types.js").Parameter} Parameter */

const WIDE = 264;
const HIGH = 104;

export class ReadingCard {
  constructor() {
    this.body = make("div", { class: "readings" }, make("p", { class: "hint" }, WORDS.pointerHint));
    this.element = make("section", { class: "card", "aria-label": WORDS.pointer }, this.body);
    /** @type {Parameter[]} */
    this.parameters = [];
    /** @type {number[]} */
    this.wavelengths = [];
  }

  /** @param {Reading} reading */
  show(reading) {
    const { original, edited } = reading;
    const after = edited ?? original;
    const same = JSON.stringify(original) === JSON.stringify(after);
    clear(this.body);
    const rows = [
      row(reading.space, numbers(original.stored), same ? "" : numbers(after.stored), "original and edited, as the file has them"),
      row("Lab", numbers(original.lab, 1), same ? "" : numbers(after.lab, 1)),
      row("ITA°", original.ita.toFixed(1), same ? "" : after.ita.toFixed(1)),
    ];
    for (const known of reading.skin ? this.parameters : []) {
      const was = original.maps?.[known.name];
      const now = after.maps?.[known.name];
      if (!now) continue;
      const label = /** @type {Record<string, string>} */ (WORDS.maps)[known.name];
      const moved = !was || was[0] !== now[0];
      rows.push(row(label, was ? withSigma(was, known) : "–", moved ? withSigma([now[0], null], known) : "", known.meaning));
    }
    const head = make("tr", {}, make("th", {}, `${reading.at[0]}, ${reading.at[1]}`),
      make("th", { scope: "col" }, WORDS.before), make("th", { scope: "col" }, same ? "" : WORDS.after));
    this.body.append(make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows)));
    if (!reading.skin) {
      this.body.append(make("p", { class: "hint" }, WORDS.noSkin));
      return;
    }
    if (original.spectrum && after.spectrum) this.body.append(this.plot(original.spectrum, after.spectrum));
  }

  /** @param {number[]} before @param {number[]} after */
  plot(before, after) {
    const w = this.wavelengths;
    const most = Math.max(0.2, Math.ceil(Math.max(...before, ...after) * 5) / 5);
    const x = (/** @type {number} */ nm) => 26 + ((WIDE - 30) * (nm - w[0])) / (w[w.length - 1] - w[0]);
    const y = (/** @type {number} */ v) => 4 + (HIGH - 20) * (1 - v / most);
    const path = (/** @type {number[]} */ values) => values.map((v, i) => `${i ? "L" : "M"}${x(w[i]).toFixed(1)} ${y(v).toFixed(1)}`).join("");
    const parts = [];
    for (const v of [0, most / 2, most]) {
      parts.push(svg("path", { d: `M26 ${y(v)}H${WIDE - 4}`, class: "grid" }), text(22, y(v) + 3, v.toFixed(1), "end"));
    }
    for (const nm of [400, 500, 600, 700]) parts.push(text(x(nm), HIGH - 2, String(nm), "middle"));
    parts.push(svg("path", { d: path(before), class: "curve was" }), svg("path", { d: path(after), class: "curve" }));
    return svg("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, class: "spectrum", role: "img", "aria-label": WORDS.spectrum }, ...parts);
  }
}

/** @param {string} label @param {string} was @param {string} now @param {string} [title] */
function row(label, was, now, title) {
  return make("tr", { title }, make("th", { scope: "row" }, label), make("td", {}, was), make("td", {}, now));
}

/** @param {number[]} values @param {number} [digits] */
function numbers(values, digits) {
  return values.map((v) => (digits === undefined ? String(v) : v.toFixed(digits)).replace("-", "−")).join(" ");
}

/** @param {[number, number | null]} pair @param {Parameter} known */
function withSigma([value, sigma], known) {
  const digits = known.unit === "µm" ? 0 : known.root > 1 ? (value < 0.1 ? 4 : 3) : 2;
  const spread = sigma === null ? "" : ` ± ${sigma.toFixed(digits)}`;
  return `${value.toFixed(digits)}${spread}`;
}

/** @param {number} x @param {number} y @param {string} said @param {string} anchor */
function text(x, y, said, anchor) {
  const element = svg("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor });
  element.append(said);
  return element;
}
