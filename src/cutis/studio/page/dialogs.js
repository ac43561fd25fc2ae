// @ts-check
/** Windows over the page: open, save, keys. And the line that says what happened. */

import { clear, make } from "./dom.js";
import { WORDS } from "./words.js";

/** @param {string} title @param {string} name @param {...Node} body */
export function dialog(title, name, ...body) {
  const heading = make("h2", { id: `${name}-title` }, title);
  const element = make("dialog", { class: name, "aria-labelledby": `${name}-title` }, heading, ...body);
  element.addEventListener("click", (event) => { if (event.target === element) element.close(); });
  return element;
}

export function keysDialog() {
  const rows = WORDS.shortcuts.map(([key, what]) => make("tr", {}, make("th", { scope: "row" }, ...key.split("  ").map((k) => make("kbd", {}, k))), make("td", {}, what)));
  const close = make("button", { type: "button", class: "plain-button" }, WORDS.close);
  const element = dialog(WORDS.keys, "keys", make("table", {}, make("tbody", {}, ...rows)), make("footer", {}, close));
  close.addEventListener("click", () => element.close());
  return element;
}

export class OpenDialog extends EventTarget {
  constructor() {
    super();
    this.list = make("ul", { class: "files" });
    this.element = dialog(WORDS.openTitle, "open", make("p", { class: "hint" }, WORDS.openNote), this.list);
  }

  /** @param {{file: number, name: string}[]} files @param {number} now */
  show(files, now) {
    clear(this.list);
    for (const { file, name } of files) {
      const button = make("button", { type: "button", "aria-current": file === now ? "true" : null }, name);
      button.addEventListener("click", () => {
        this.element.close();
        this.dispatchEvent(new CustomEvent("file", { detail: file }));
      });
      this.list.append(make("li", {}, button));
    }
    if (files.length < 2) this.list.append(make("li", { class: "hint" }, WORDS.openNone));
    if (!this.element.open) this.element.showModal();
  }
}

export class SaveDialog extends EventTarget {
  constructor() {
    super();
    this.name = make("input", { type: "text", id: "save-name", value: "edited", maxlength: "40", pattern: "[A-Za-z0-9][A-Za-z0-9 _\\-]*", autocomplete: "off", spellcheck: "false" });
    this.result = make("div", { class: "result", "aria-live": "polite" });
    this.albedo = make("button", { type: "submit", class: "primary" }, WORDS.saveAlbedo);
    this.look = make("button", { type: "button", class: "plain-button" }, WORDS.saveLook);
    const close = make("button", { type: "button", class: "plain-button" }, WORDS.close);
    const form = make("form", { method: "dialog" },
      make("label", { for: "save-name" }, WORDS.saveName), this.name,
      make("p", { class: "hint" }, WORDS.saveNote), this.result,
      make("footer", {}, close, this.look, this.albedo));
    this.element = dialog(WORDS.saveTitle, "save", form);
    close.addEventListener("click", () => this.element.close());
    form.addEventListener("submit", (event) => { event.preventDefault(); this.ask("albedo"); });
    this.look.addEventListener("click", () => this.ask("look"));
  }

  open() {
    clear(this.result);
    this.busy(false);
    this.element.showModal();
    this.name.select();
  }

  /** @param {string} kind */
  ask(kind) {
    if (!this.name.reportValidity()) return;
    this.busy(true);
    clear(this.result);
    this.result.append(make("span", { class: "wait" }, "…"));
    this.dispatchEvent(new CustomEvent("save", { detail: { kind, label: this.name.value } }));
  }

  /** @param {boolean} busy */
  busy(busy) {
    this.albedo.disabled = this.look.disabled = busy;
  }

  /** @param {{name: string, command: string, notes: string[]}} done */
  done(done) {
    this.busy(false);
    clear(this.result);
    const copy = make("button", { type: "button", class: "plain-button small" }, WORDS.copy);
    copy.addEventListener("click", async () => {
      await navigator.clipboard.writeText(done.command);
      copy.textContent = WORDS.copied;
    });
    this.result.append(make("p", { class: "wrote" }, `${WORDS.saved} `, make("strong", {}, done.name)),
      make("p", { class: "hint" }, WORDS.sameAs), make("div", { class: "command" }, make("code", { tabindex: "0" }, done.command), copy),
      ...done.notes.map((note) => make("p", { class: "hint" }, note)));
  }

  /** @param {string} text */
  failed(text) {
    this.busy(false);
    clear(this.result);
    this.result.append(make("p", { class: "wrong" }, text));
  }
}

/** The line that says what went wrong or happened; goes away by itself. */
export class Said {
  constructor() {
    this.element = make("div", { class: "said", role: "status", "aria-live": "polite", hidden: true });
    this.timer = 0;
  }

  /** @param {string} text @param {boolean} [stays] */
  say(text, stays = false) {
    this.element.textContent = text;
    this.element.hidden = false;
    clearTimeout(this.timer);
    if (!stays) this.timer = window.setTimeout(() => this.hush(), 6000);
  }

  hush() {
    this.element.hidden = true;
  }
}
