// @ts-check
/** The studio: parts of the page, and how they work together. */

import { Adjust } from "./adjust.js";
import { keysDialog, OpenDialog, Said, SaveDialog } from "./dialogs.js";
import { clear, iconButton, make } from "./dom.js";
import { LayerList } from "./layers.js";
import { Masks } from "./masks.js";
import { Shelf } from "./shelf.js";
import { Link } from "./link.js";
import { ReadingCard } from "./reading.js";
import { Stage } from "./stage.js";
import { WORDS } from "./words.js";

/** @typedef {import("./types.js").Face} Face */
/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Op} Op */

const COARSE = 1;

class Studio {
  constructor() {
    this.link = new Link();
    this.stage = new Stage();
    this.layers = new LayerList();
    this.adjust = new Adjust();
    this.masks = new Masks();
    this.shelf = new Shelf();
    this.card = new ReadingCard();
    /** @type {[number, number][]} points of a stroke in the making */
    this.points = [];
    this.opening = new OpenDialog();
    this.saving = new SaveDialog();
    this.keys = keysDialog();
    this.said = new Said();
    /** @type {Face | null} */
    this.face = null;
    this.file = 0;
    this.sent = 0;
    this.left = 0;
    /** @type {import("./types.js").Parameter[]} */
    this.parameters = [];
    /** @type {Op | null} what is drawn as if it were done */
    this.preview = null;
    this.coarse = false;
    this.asked = 0;
    this.dirty = false;
    this.fine = 0;
    this.moved = 0;
    /** When the slider moved that the picture on its way answers, and the one that has come. */
    this.began = 0;
    this.painted = 0;
    /** The revision of the picture that has come. */
    this.shown = "";
    /** @type {{x: number, y: number} | null} */
    this.point = null;
    this.reading = false;
    /** @type {Record<string, HTMLButtonElement>} */
    this.turns = {};
    this.name = make("button", { type: "button", class: "file", title: WORDS.open, onclick: () => this.askFiles() }, "…");
    this.modes = /** @type {Record<string, HTMLButtonElement>} */ ({});
    const views = make("div", { class: "segments", role: "group", "aria-label": WORDS.views });
    for (const mode of /** @type {const} */ (["original", "split", "edited"])) {
      this.modes[mode] = make("button", { type: "button", "aria-pressed": "false", onclick: () => this.setMode(mode) }, WORDS[mode]);
      views.append(this.modes[mode]);
    }
    this.zoomed = make("button", { type: "button", class: "quiet zoom", title: WORDS.fit, onclick: () => this.stage.fit() }, "100 %");
    this.undo = iconButton("undo", WORDS.undo, () => this.step(-1), { disabled: true });
    this.redo = iconButton("redo", WORDS.redo, () => this.step(1), { disabled: true });
    this.save = make("button", { type: "button", class: "primary", disabled: true, onclick: () => this.saving.open() }, WORDS.save);
    const help = make("button", { type: "button", class: "quiet", title: WORDS.keys, "aria-label": WORDS.keys, onclick: () => this.keys.showModal() }, "?");
    const bar = make("header", { class: "bar" },
      make("div", { class: "side" }, this.name),
      make("div", { class: "middle" }, views, this.kind = this.kinds()),
      make("div", { class: "side end" }, this.zoomed, this.undo, this.redo, help, this.save));
    this.bars = make("div", { class: "progress", hidden: true, role: "progressbar", "aria-label": WORDS.estimating, "aria-valuemin": "0", "aria-valuemax": "100" }, make("i"));
    this.status = make("span", { class: "doing" });
    this.facts = make("footer", { class: "facts" });
    this.panel = make("aside", { class: "panel", "aria-label": WORDS.adjust }, this.tabs(), this.editing = make("div", {}, this.layers.element, this.adjust.element, this.masks.element), this.shelf.presets, this.shelf.history);
    this.turn("edit");
    this.bar = make("figure", { class: "bar-of-map", hidden: true });
    const work = make("main", { class: "work" }, this.stage.element, this.card.element, this.bar, this.said.element,
      make("div", { class: "waiting", hidden: true }, this.bars, this.status));
    this.waiting = /** @type {HTMLElement} */ (work.querySelector(".waiting"));
    document.body.append(bar, work, this.panel, this.facts, this.opening.element, this.saving.element, this.keys);
    this.setMode("edited");
    this.stage.covered = () => {
      const box = this.card.element.getBoundingClientRect();
      return box.width ? box.width + 24 : 0;
    };
    this.listen();
    this.link.connect();
  }

  /** Which of the panels is shown. */
  tabs() {
    const list = make("div", { class: "tabs", role: "group" });
    for (const [name, said] of Object.entries(WORDS.tabs)) {
      this.turns[name] = make("button", { type: "button", "aria-pressed": "false", onclick: () => this.turn(name) }, said);
      list.append(this.turns[name]);
    }
    return list;
  }

  /** @param {string} name */
  turn(name) {
    for (const [one, button] of Object.entries(this.turns)) button.setAttribute("aria-pressed", String(one === name));
    if (this.editing) this.editing.hidden = name !== "edit";
    this.shelf.presets.hidden = name !== "presets";
    this.shelf.history.hidden = name !== "history";
    if (name === "presets" && !this.shelf.urls.length) this.link.send({ t: "ask", what: "presets" });
    this.turned = name;
    if (name === "history") this.link.send({ t: "ask", what: "history" });
  }

  /** What is drawn: the picture, a map, its σ. */
  kinds() {
    const maps = /** @type {Record<string, string>} */ (WORDS.maps);
    const five = ["melanin", "blood", "thickness", "eumelanin", "oxygenation"];
    const select = make("select", { class: "kind", "aria-label": WORDS.whatIsDrawn, title: WORDS.whatIsDrawn },
      make("option", { value: "" }, WORDS.picture_),
      ...five.map((name) => make("option", { value: `map:${name}` }, maps[name])),
      ...five.map((name) => make("option", { value: `sigma:${name}` }, `${WORDS.sigmaOf} ${maps[name].toLowerCase()}`)),
      make("option", { value: "confidence:all" }, WORDS.confidence));
    select.addEventListener("change", () => { this.overlay(); select.blur(); });
    return select;
  }

  /** What lies over the edited face: a map, the mask of the chosen layer, or nothing. */
  overlay() {
    const mask = this.masks.showing && this.layers.chosen ? `mask:${this.layers.chosen}` : "";
    this.stage.overlay = this.kind?.value || mask;
    this.bar.hidden = !this.kind?.value;
    this.stage.redraw();
    this.want();
  }

  /** The scale of a map. @param {{unit: string, ticks: [string, number][], colours: string[]}} bar */
  scale(bar) {
    clear(this.bar);
    const strip = make("div", { class: "strip" });
    strip.style.setProperty("background", `linear-gradient(90deg, ${bar.colours.join(", ")})`);
    const ticks = bar.ticks.map(([text, place]) => {
      const tick = make("span", {}, text);
      tick.style.setProperty("left", `${100 * place}%`);
      return tick;
    });
    this.bar.append(make("figcaption", {}, `${this.kind?.selectedOptions[0]?.textContent ?? ""} ${bar.unit}`), strip, make("div", { class: "ticks" }, ...ticks));
  }

  /** A stroke of the brush begins, goes on or ends. @param {PointerEvent} event */
  paint(event) {
    const { stage, masks } = this;
    const [px, py] = stage.inside(event.clientX, event.clientY);
    const { width, height } = stage.size;
    const round = (/** @type {number} */ v) => Math.min(Math.max(Math.round(v * 1e5) / 1e5, -1), 2);
    /** @type {[number, number]} */
    const point = [round((px - stage.x) / stage.scale / width), round((py - stage.y) / stage.scale / height)];
    const last = this.points[this.points.length - 1];
    const far = last ? Math.hypot((point[0] - last[0]) * width, (point[1] - last[1]) * height) : Infinity;
    if (far >= Math.min(0.15 * masks.radius * Math.max(width, height), 4 / stage.scale) || event.type === "pointerdown") this.points.push(point);
    if (event.type === "pointerup" || event.type === "pointercancel") {
      const op = masks.stroke(this.points);
      this.points = [];
      this.do({ op, what: WORDS[masks.tool === "eraser" ? "eraser" : "brush"] });
      return;
    }
    this.preview = masks.stroke(this.points);
    this.coarse = true;
    this.want();
  }

  listen() {
    const { link, stage, layers, adjust, masks, shelf } = this;
    masks.addEventListener("op", (event) => {
      const { op, what, done } = /** @type {CustomEvent} */ (event).detail;
      if (done) this.do({ op, what });
      else { this.preview = op; this.coarse = true; this.want(); }
    });
    masks.addEventListener("showing", () => this.overlay());
    masks.addEventListener("tool", () => {
      stage.brush = masks.tool ? (event) => this.paint(event) : null;
      stage.radius = () => masks.radius * Math.max(stage.size.width, stage.size.height);
      stage.redraw();
    });
    shelf.addEventListener("preset", (event) => this.do(/** @type {CustomEvent} */ (event).detail));
    shelf.addEventListener("go", (event) => link.send({ t: "go", number: /** @type {CustomEvent} */ (event).detail }));
    const on = (/** @type {string} */ name, /** @type {(detail: any) => void} */ act) => {
      link.addEventListener(name, (event) => act(/** @type {CustomEvent} */ (event).detail));
    };
    on("hello", (message) => {
      this.card.parameters = message.parameters;
      this.card.wavelengths = message.wavelengths;
      this.parameters = message.parameters;
      this.said.hush();
      this.asked = 0;
      this.reading = false;
      const wanted = Number(new URLSearchParams(location.hash.slice(1)).get("face") ?? this.file);
      this.open(Number.isInteger(wanted) && wanted >= 0 ? wanted : 0);
    });
    on("lost", ({ tries }) => {
      if (tries > 1) this.said.say(tries > 6 ? WORDS.gone : WORDS.lost, true);
    });
    on("face", (face) => this.opened(face));
    on("ready", () => this.ready());
    on("progress", ({ share, doing }) => this.wait(doing, share));
    on("state", ({ state }) => this.show(state));
    on("reading", (reading) => {
      this.reading = false;
      this.card.show(reading);
      if (this.point && (this.point.x !== reading.at[0] || this.point.y !== reading.at[1])) this.read();
    });
    on("preset", (preset) => shelf.add(preset));
    on("history", ({ states }) => shelf.list(states, this.number ?? 0));
    on("files", ({ files }) => this.opening.show(files, this.file));
    on("saved", (done) => this.saving.done(done));
    on("picture", (picture) => this.arrived(picture));
    on("error", ({ text, n }) => {
      this.reading = false;
      if (n === this.asked) {
        this.asked = 0;
        if (this.dirty) this.ask();
      }
      if (this.saving.element.open) this.saving.failed(text);
      else this.said.say(text);
      if (!this.face) this.wait("", null);
    });
    stage.addEventListener("moved", () => {
      this.zoomed.textContent = `${Math.round((100 * stage.scale) / stage.ratio)} %`;
      this.want();
    });
    stage.addEventListener("drawn", () => {
      if (this.shown) document.body.dataset.drawn = this.shown;
      if (this.painted) performance.measure("slider", { start: this.painted, end: performance.now() });
      this.painted = 0;
    });
    stage.addEventListener("point", (event) => {
      this.point = /** @type {CustomEvent} */ (event).detail;
      this.read();
    });
    layers.addEventListener("op", (event) => this.do(/** @type {CustomEvent} */ (event).detail));
    layers.addEventListener("chosen", () => {
      if (!this.preview) {
        adjust.show(layers.chosen, layers.layer());
        masks.show(layers.chosen, layers.layer());
      }
      this.overlay();
      this.askTracks();
    });
    adjust.addEventListener("tracks", () => this.askTracks());
    adjust.addEventListener("op", (event) => {
      const { op, what, done } = /** @type {CustomEvent} */ (event).detail;
      if (done) this.do({ op, what });
      else {
        this.preview = op;
        this.moved = this.moved || performance.now();
        this.coarse = true;
        this.want();
      }
    });
    this.opening.addEventListener("file", (event) => this.open(/** @type {CustomEvent} */ (event).detail));
    this.saving.addEventListener("save", (event) => {
      const { kind, label } = /** @type {CustomEvent} */ (event).detail;
      this.link.send({ t: "save", kind, label });
    });
    window.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("keyup", (event) => { if (event.key === "\\") this.compare(false); });
    window.addEventListener("blur", () => this.compare(false));
  }

  // faces ---------------------------------------------------------------------------------------

  /** @param {number} file */
  open(file) {
    this.file = file;
    this.wait(WORDS.opening, null);
    this.link.send({ t: "open", file });
  }

  async askFiles() {
    await this.link.ask({ t: "ask", what: "files" }).catch(() => undefined);
  }

  /** @param {Face} face */
  opened(face) {
    const again = this.face && this.face.file === face.file && this.stage.size.width === face.width;
    this.face = face;
    this.file = face.file;
    history.replaceState(null, "", `/#face=${face.file}`);
    document.title = `${face.name} – ${WORDS.name}`;
    this.name.textContent = face.name;
    this.name.title = `${face.name}: ${WORDS.open}`;
    clear(this.facts);
    this.facts.append(
      make("span", {}, `${face.width} × ${face.height}`), make("span", {}, face.depth),
      make("span", { title: face.origin }, face.space), ...face.notes.slice(0, 1).map((note) => make("span", {}, note)),
      make("span", { class: "right" }, this.took = make("span"), ` ${WORDS.drawnHere}`));
    this.adjust.prepare(this.parameters ?? [], face.spans);
    this.adjust.id = null;
    this.shelf.forget();
    this.panel.inert = !face.ready;
    this.save.disabled = !face.ready;
    if (!again) this.stage.show(face.width, face.height);
    this.show(face.state);
    this.want();
    if (!face.ready) this.wait(WORDS.estimating, 0);
  }

  ready() {
    if (this.face) this.face.ready = true;
    this.panel.inert = false;
    this.save.disabled = false;
    this.waiting.hidden = true;
    this.askTracks();
    this.want();
    document.body.dataset.ready = "yes";
  }

  /** @param {string} doing @param {number | null} share */
  wait(doing, share) {
    this.waiting.hidden = !doing;
    this.status.textContent = doing;
    this.bars.hidden = share === null;
    /** @type {HTMLElement} */ (this.bars.firstElementChild).style.setProperty("width", `${100 * (share ?? 0)}%`);
    this.bars.setAttribute("aria-valuenow", String(Math.round(100 * (share ?? 0))));
  }

  // state ---------------------------------------------------------------------------------------

  /** @param {State} state */
  show(state) {
    this.undo.disabled = !state.undo;
    this.redo.disabled = !state.redo;
    document.body.dataset.revision = String(state.revision);
    this.number = state.number;
    this.layers.show(state);
    if (this.turned === "history") this.link.send({ t: "ask", what: "history" });
    this.want();
  }

  /** @param {{op: Op, what: string}} what */
  async do({ op, what }) {
    this.preview = op.op === "tune" || op.op === "set" ? op : null;
    if (op.op === "stroke") this.dirty = false;
    this.coarse = false;
    try {
      await this.link.ask({ t: "do", op, what });
    } catch {
      // it was said already
    }
    if (this.preview === op) this.preview = null;
    this.adjust.show(this.layers.chosen, this.layers.layer());
    this.masks.show(this.layers.chosen, this.layers.layer());
    this.want();
  }

  /** @param {-1 | 1} by */
  step(by) {
    this.link.send({ t: "step", by });
  }

  askTracks() {
    if (this.face?.ready && this.layers.chosen) {
      this.link.ask({ t: "tracks", id: this.layers.chosen, does: this.adjust.does() }).then((message) => {
        if (message.id !== this.layers.chosen) return;
        for (const [name, track] of Object.entries(message.tracks)) this.adjust.all.get(name)?.paint(track);
      }).catch(() => undefined);
    }
  }

  // pictures ------------------------------------------------------------------------------------

  /** A new picture is wanted: asked for at once, or when the one that is being drawn has come. */
  want() {
    if (!this.face) return;
    this.dirty = true;
    if (!this.asked) this.ask();
    else if (performance.now() - this.sent > 5000) this.ask();
  }

  ask() {
    if (!this.face) return;
    this.dirty = false;
    this.sent = performance.now();
    const show = this.stage.wanted();
    this.left = show.length;
    const moving = this.coarse || this.stage.fingers.size > 0;
    this.began = this.moved;
    this.moved = 0;
    this.asked = this.link.send({
      t: "view", ...this.stage.region(), show, coarser: moving && this.face.ready ? COARSE : 0,
      ...(this.preview ? { preview: this.preview } : {}),
    });
    clearTimeout(this.fine);
    if (moving) this.fine = window.setTimeout(() => { this.coarse = false; this.want(); }, 250);
  }

  /** @param {any} picture */
  async arrived(picture) {
    const bitmap = await createImageBitmap(new Blob([picture.body], { type: "image/jpeg" }));
    this.stage.put(picture.show, bitmap, picture.place);
    if (picture.bar) this.scale(picture.bar);
    if (this.took) this.took.textContent = `${Math.round(picture.took)} ms`;
    if (picture.n === this.asked) {
      this.left = (this.left ?? 1) - 1;
      if (this.left < 1) {
        this.asked = 0;
        this.painted = this.began;
        if (!picture.coarser && !this.preview) this.shown = String(picture.revision);
        if (this.dirty) this.ask();
        else if (!picture.coarser && !this.stage.pictures.has("original")) this.prefetch();
      }
    }
  }

  /** The original of the same view, so that comparing need not wait. */
  prefetch() {
    this.left = 1;
    this.sent = performance.now();
    this.asked = this.link.send({ t: "view", ...this.stage.region(), show: ["original"], coarser: 0 });
  }

  /** @param {"edited" | "original" | "split"} mode */
  setMode(mode) {
    this.stage.mode = mode;
    for (const [name, button] of Object.entries(this.modes)) button.setAttribute("aria-pressed", String(name === mode));
    this.stage.redraw();
    this.want();
  }

  /** @param {boolean} on */
  compare(on) {
    if (this.stage.comparing === on) return;
    this.stage.comparing = on;
    this.stage.redraw();
    this.want();
  }

  read() {
    if (!this.point || this.reading || !this.face) return;
    this.reading = true;
    this.link.send({ t: "read", x: this.point.x, y: this.point.y });
  }

  // keys ----------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event */
  key(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    const control = event.ctrlKey || event.metaKey;
    if (control && event.key.toLowerCase() === "z") { event.preventDefault(); return this.step(event.shiftKey ? 1 : -1); }
    if (control && event.key.toLowerCase() === "y") { event.preventDefault(); return this.step(1); }
    if (control && event.key.toLowerCase() === "s") { event.preventDefault(); if (!this.save.disabled) this.saving.open(); return; }
    if (control || event.altKey || document.querySelector("dialog[open]")) return;
    const typing = target.matches("input[type=text], select, textarea");
    if (typing) return;
    const sliding = target.matches("input[type=range]");
    const by = 60 * this.stage.ratio;
    /** @type {Record<string, () => void>} */
    const acts = {
      e: () => this.setMode("edited"), o: () => this.setMode("original"), s: () => this.setMode("split"),
      "\\": () => this.compare(true), 0: () => this.stage.fit(), 1: () => this.stage.zoom(this.stage.ratio),
      "+": () => this.stage.step(1), "=": () => this.stage.step(1), "-": () => this.stage.step(-1),
      b: () => this.masks.take("brush"), x: () => this.masks.take("eraser"), m: () => this.masks.toggle(),
      Escape: () => { if (this.masks.tool) this.masks.take(this.masks.tool); },
      n: () => this.layers.add(), h: () => this.layers.toggle(), Delete: () => this.layers.remove(),
      "[": () => this.layers.step(-1), "]": () => this.layers.step(1), "?": () => this.keys.showModal(),
      i: () => {
        this.card.element.hidden = !this.card.element.hidden;
        if (this.stage.fitted) this.stage.fit();
      },
    };
    if (!sliding) Object.assign(acts, {
      ArrowLeft: () => this.stage.pan(by, 0), ArrowRight: () => this.stage.pan(-by, 0),
      ArrowUp: () => this.stage.pan(0, by), ArrowDown: () => this.stage.pan(0, -by),
    });
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act && !(event.repeat && event.key === "\\")) { event.preventDefault(); act(); }
  }
}

new Studio();
