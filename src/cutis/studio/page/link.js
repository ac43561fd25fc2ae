// @ts-check
/** The socket to the server: messages out, answers in, and again when it was lost. */

/** @typedef {import("./types.js").PictureHead} PictureHead */

export class Link extends EventTarget {
  constructor() {
    super();
    /** @type {WebSocket | null} */
    this.socket = null;
    this.count = 0;
    this.tries = 0;
    /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
    this.waiting = new Map();
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (event) => this.hear(event.data);
    socket.onclose = () => {
      for (const { reject } of this.waiting.values()) reject(new Error("lost"));
      this.waiting.clear();
      this.tries += 1;
      this.emit("lost", { tries: this.tries });
      setTimeout(() => this.connect(), Math.min(250 * 2 ** Math.min(this.tries, 4), 4000));
    };
  }

  /** @param {string} name @param {any} detail */
  emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /** @param {string | ArrayBuffer} data */
  hear(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      if (message.t === "hello") this.tries = 0;
      const waiting = message.n ? this.waiting.get(message.n) : undefined;
      if (waiting) {
        this.waiting.delete(message.n);
        if (message.t === "error") waiting.reject(new Error(message.text));
        else waiting.resolve(message);
      }
      this.emit(message.t, message);
      return;
    }
    const length = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    this.emit(head.t, { ...head, body: new Uint8Array(data, 4 + length) });
  }

  /**
   * Sends a message; its number.
   * @param {Record<string, any>} message
   */
  send(message) {
    this.count += 1;
    if (this.socket?.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify({ ...message, n: this.count }));
    }
    return this.count;
  }

  /**
   * Sends a message and waits for what answers it.
   * @param {Record<string, any>} message
   * @returns {Promise<any>}
   */
  ask(message) {
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) return reject(new Error("lost"));
      this.waiting.set(this.send(message), { resolve, reject });
    });
  }
}
