// @ts-check
/** The picture: pan, zoom, original and edited, side by side along a line that moves. */

import { make } from "./dom.js";
import { WORDS } from "./words.js";

/** @typedef {{bitmap: ImageBitmap, place: [number, number, number, number]}} Held */

const STEP = 1.25;
const MOST = 64;

export class Stage extends EventTarget {
  constructor() {
    super();
    this.canvas = make("canvas", { tabindex: "0", role: "img", "aria-label": WORDS.picture });
    this.handle = make("div", { class: "divider", role: "slider", tabindex: "0", hidden: true,
      "aria-label": WORDS.divider, "aria-valuemin": "0", "aria-valuemax": "100", "aria-valuenow": "50" });
    this.element = make("div", { class: "stage" }, this.canvas, this.handle);
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d", { alpha: false }));
    this.size = { width: 1, height: 1 };
    /** Device pixels a texel, and where texel (0, 0) is on the canvas. */
    this.scale = 1;
    this.x = 0;
    this.y = 0;
    this.fitted = true;
    /** @type {"edited" | "original" | "split"} */
    this.mode = "edited";
    this.comparing = false;
    /** A picture in place of the edited one: a map, or a mask over it. */
    this.overlay = "";
    /** Gets the pointer in place of panning. @type {((event: PointerEvent) => void) | null} */
    this.brush = null;
    /** Radius of the brush in texels. */
    this.radius = () => 0;
    /** @type {[number, number] | null} */
    this.cursor = null;
    this.share = 0.5;
    /** @type {Map<string, Held>} */
    this.pictures = new Map();
    this.frame = 0;
    this.painting = -1;
    /** Pixels of the page at the left that something covers. */
    this.covered = () => 0;
    /** @type {Map<number, {x: number, y: number}>} */
    this.fingers = new Map();
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.listen();
  }

  /** A face of so many texels. @param {number} width @param {number} height */
  show(width, height) {
    this.size = { width, height };
    for (const held of this.pictures.values()) held.bitmap.close();
    this.pictures.clear();
    this.fit();
  }

  get ratio() {
    return Math.min(window.devicePixelRatio || 1, 2);
  }

  resize() {
    const width = Math.max(1, Math.round(this.element.clientWidth * this.ratio));
    const height = Math.max(1, Math.round(this.element.clientHeight * this.ratio));
    if (width === this.canvas.width && height === this.canvas.height) return;
    this.canvas.width = width;
    this.canvas.height = height;
    if (this.fitted) this.fit();
    else this.moved();
  }

  fit() {
    const margin = 24 * this.ratio;
    const { width, height } = this.canvas;
    this.scale = Math.min((width - 2 * margin) / this.size.width, (height - 2 * margin) / this.size.height);
    if (!(this.scale > 0)) this.scale = 0.01;
    const wide = this.scale * this.size.width;
    const covered = this.covered() * this.ratio;
    this.x = covered + wide + margin <= width ? Math.max((width - wide) / 2, covered + (width - covered - wide) / 2) : (width - wide) / 2;
    this.y = (height - this.scale * this.size.height) / 2;
    this.fitted = true;
    this.moved();
  }

  /** Zooms to a scale about a place of the canvas. @param {number} scale @param {number} [px] @param {number} [py] */
  zoom(scale, px = this.canvas.width / 2, py = this.canvas.height / 2) {
    const least = Math.min(16 / Math.max(this.size.width, this.size.height), 1);
    const next = Math.min(Math.max(scale, least), MOST);
    this.x = px - ((px - this.x) * next) / this.scale;
    this.y = py - ((py - this.y) * next) / this.scale;
    this.scale = next;
    this.fitted = false;
    this.moved();
  }

  /** @param {number} dx @param {number} dy */
  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
    this.moved();
  }

  /** Keeps a part of the face in sight, and tells whoever draws. */
  moved() {
    const { width, height } = this.canvas;
    const keep = 40 * this.ratio;
    this.x = Math.min(Math.max(this.x, keep - this.scale * this.size.width), width - keep);
    this.y = Math.min(Math.max(this.y, keep - this.scale * this.size.height), height - keep);
    this.redraw();
    this.dispatchEvent(new Event("moved"));
  }

  /** The part of the face that is in sight, in texels. */
  region() {
    const { width, height } = this.canvas;
    return {
      left: Math.max(0, -this.x / this.scale), top: Math.max(0, -this.y / this.scale),
      right: Math.min(this.size.width, (width - this.x) / this.scale),
      bottom: Math.min(this.size.height, (height - this.y) / this.scale),
      scale: this.scale,
    };
  }

  /** The pictures that have to be there. @returns {string[]} */
  wanted() {
    if (this.comparing || this.mode === "original") return ["original"];
    const edited = this.overlay || "edited";
    return this.mode === "split" ? [edited, "original"] : [edited];
  }

  /** A picture has come. @param {string} name @param {ImageBitmap} bitmap @param {[number, number, number, number]} place */
  put(name, bitmap, place) {
    this.pictures.get(name)?.bitmap.close();
    this.pictures.set(name, { bitmap, place });
    this.redraw();
  }

  redraw() {
    if (!this.frame) this.frame = requestAnimationFrame(() => { this.frame = 0; this.draw(); });
  }

  draw() {
    const { context, canvas } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#262626";
    context.fillRect(0, 0, canvas.width, canvas.height);
    const wanted = this.wanted();
    const split = wanted.length > 1;
    const at = Math.round(this.share * canvas.width);
    if (split) {
      this.paint("original", 0, at);
      this.paint(wanted[0], at, canvas.width - at);
    } else {
      this.paint(wanted[0], 0, canvas.width);
    }
    this.handle.hidden = !split;
    if (split) this.handle.style.setProperty("left", `${(100 * at) / canvas.width}%`);
    if (this.brush && this.cursor) {
      context.lineWidth = this.ratio;
      for (const [colour, more] of /** @type {[string, number][]} */ ([["#000a", 1], ["#fff", 0]])) {
        context.strokeStyle = colour;
        context.beginPath();
        context.arc(this.cursor[0], this.cursor[1], this.radius() * this.scale + more * this.ratio, 0, 7);
        context.stroke();
      }
    }
    this.dispatchEvent(new Event("drawn"));
  }

  /** @param {string} name @param {number} left @param {number} width */
  paint(name, left, width) {
    const held = this.pictures.get(name) ?? this.pictures.get("edited") ?? this.pictures.get("original") ?? this.pictures.get("edited");
    if (!held || width <= 0) return;
    const { context } = this;
    const [l, t, r, b] = held.place;
    const texels = (r - l) / held.bitmap.width;
    context.save();
    context.beginPath();
    context.rect(left, 0, width, this.canvas.height);
    context.clip();
    context.beginPath();
    context.rect(this.x, this.y, this.scale * this.size.width, this.scale * this.size.height);
    context.clip();
    context.imageSmoothingEnabled = this.scale * texels < 3;
    context.imageSmoothingQuality = "high";
    context.drawImage(held.bitmap, this.x + l * this.scale, this.y + t * this.scale,
      (r - l) * this.scale, (b - t) * this.scale);
    context.restore();
  }

  /** Texel under a place on the page; null beyond the face. @param {number} clientX @param {number} clientY */
  texel(clientX, clientY) {
    const [px, py] = this.inside(clientX, clientY);
    const x = Math.floor((px - this.x) / this.scale);
    const y = Math.floor((py - this.y) / this.scale);
    return x < 0 || y < 0 || x >= this.size.width || y >= this.size.height ? null : { x, y };
  }

  /** @param {number} clientX @param {number} clientY @returns {[number, number]} */
  inside(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    return [(clientX - box.left) * this.ratio, (clientY - box.top) * this.ratio];
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [px, py] = this.inside(event.clientX, event.clientY);
      const lines = event.deltaMode === 1 ? 24 : 1;
      this.zoom(this.scale * Math.exp((-event.deltaY * lines) / 400), px, py);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      canvas.classList.add("held");
      if (this.brush && event.button === 0 && this.fingers.size === 1) {
        this.painting = event.pointerId;
        this.brush(event);
      }
    });
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => {
        const pointer = /** @type {PointerEvent} */ (event);
        this.fingers.delete(pointer.pointerId);
        if (this.painting === pointer.pointerId) {
          this.painting = -1;
          this.brush?.(pointer);
        }
        canvas.classList.remove("held");
      });
    }
    canvas.addEventListener("dblclick", () => this.fit());
    const { handle } = this;
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      this.divide(this.inside(event.clientX, 0)[0] / this.canvas.width);
    });
    handle.addEventListener("keydown", (event) => {
      const by = event.key === "ArrowLeft" ? -0.02 : event.key === "ArrowRight" ? 0.02 : 0;
      if (by) { event.preventDefault(); event.stopPropagation(); this.divide(this.share + by); }
    });
  }

  /** @param {number} share */
  divide(share) {
    this.share = Math.min(Math.max(share, 0.02), 0.98);
    this.handle.setAttribute("aria-valuenow", String(Math.round(100 * this.share)));
    this.redraw();
  }

  /** @param {PointerEvent} event */
  drag(event) {
    const last = this.fingers.get(event.pointerId);
    this.cursor = this.inside(event.clientX, event.clientY);
    if (this.brush) this.redraw();
    if (this.painting === event.pointerId) {
      const all = event.getCoalescedEvents?.() ?? [];
      for (const one of all.length ? all : [event]) this.brush?.(one);
      return;
    }
    if (!last) {
      this.dispatchEvent(new CustomEvent("point", { detail: this.texel(event.clientX, event.clientY) }));
      return;
    }
    const others = [...this.fingers.entries()].filter(([id]) => id !== event.pointerId);
    const ratio = this.ratio;
    if (others.length === 0) {
      this.pan((event.clientX - last.x) * ratio, (event.clientY - last.y) * ratio);
    } else {
      const other = others[0][1];
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      const [px, py] = this.inside((event.clientX + other.x) / 2, (event.clientY + other.y) / 2);
      this.pan(((event.clientX - last.x) * ratio) / 2, ((event.clientY - last.y) * ratio) / 2);
      if (before > 8) this.zoom((this.scale * after) / before, px, py);
    }
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  /** @param {number} by powers of a step */
  step(by) {
    this.zoom(this.scale * STEP ** by);
  }
}
