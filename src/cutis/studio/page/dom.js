// @ts-check
/** Elements made by hand: texts are always texts, never markup. */

/**
 * An element with attributes and children. `on…` attributes are listeners, `class` its classes.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Node | string | null | undefined)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else element.setAttribute(name, String(value));
  }
  for (const child of children) if (child !== null && child !== undefined) element.append(child);
  return element;
}

/**
 * An SVG element.
 * @param {string} tag
 * @param {Record<string, string | number>} [attributes]
 * @param {...Node} children
 */
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/** Paths of icons on a grid of 16. @type {Record<string, string>} */
const ICONS = {
  undo: "M6 3 3 6l3 3M3 6h6a4 4 0 0 1 0 8H6",
  redo: "m10 3 3 3-3 3m3-3H7a4 4 0 0 0 0 8h3",
  eye: "M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8Zm4.5 0a2 2 0 1 0 4 0 2 2 0 1 0-4 0",
  hidden: "M2 2l12 12M6.5 3.7A6 6 0 0 1 8 3.5c4 0 6.500 4.500 6.500 4.500a12 12 0 0 1-1.800 2.300M4 4.800A12 12 0 0 0 1.500 8S4 12.500 8 12.500a6 6 0 0 0 2.800-.7",
  plus: "M8 3v10M3 8h10",
  copy: "M5.500 5.500h8v8h-8zM10.500 5.500v-3h-8v8h3",
  bin: "M3 4.500h10M6.500 4.500V3h3v1.500M4.500 4.500l.7 9h5.600l.7-9",
  up: "M8 13V3M4 7l4-4 4 4",
  down: "M8 3v10M4 9l4 4 4-4",
  close: "M4 4l8 8M12 4l-8 8",
  reset: "M3 8a5 5 0 1 0 1.500-3.500L3 6M3 3v3h3",
};

/** @param {string} name */
export function icon(name) {
  return svg("svg", { viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" },
    svg("path", { d: ICONS[name], fill: "none", stroke: "currentColor", "stroke-width": 1.4,
      "stroke-linecap": "round", "stroke-linejoin": "round" }));
}

/**
 * A button with an icon, whose name is read aloud and shown on hover.
 * @param {string} name of the icon
 * @param {string} label
 * @param {(event: Event) => void} act
 * @param {Record<string, any>} [more]
 */
export function iconButton(name, label, act, more = {}) {
  return make("button", { type: "button", class: "quiet", title: label, "aria-label": label, onclick: act, ...more }, icon(name));
}

/** Takes all children away. @param {Element} element */
export function clear(element) {
  element.replaceChildren();
}
