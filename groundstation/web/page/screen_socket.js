// The socket to the screen of this tab. textual.js opens it and draws what arrives; keys.js and stick.js use it, too.
const MAX_WAITING = 4096;
// Bytes that wait for the network above which a demand of the stick is not sent: the next one is newer.

export class ScreenSocket extends WebSocket {
  static current = null;
  static readers = []; // called with each message that arrives
  static filters = []; // called with what textual.js types; return the text to send
  static #openers = [];
  static #closers = [];

  constructor(url) {
    super(url);
    ScreenSocket.current = this;
    this.addEventListener("message", (event) => ScreenSocket.readers.forEach((read) => read(event.data)));
    this.addEventListener("open", () => ScreenSocket.#openers.forEach((call) => call()));
    this.addEventListener("close", (event) => ScreenSocket.#closers.forEach((call) => call(event.reason)));
  }

  send(text) {
    if (this.readyState !== WebSocket.OPEN) return;
    const [name, value] = JSON.parse(text);
    if (name === "stdin") {
      super.send(JSON.stringify([name, ScreenSocket.filters.reduce((typed, filter) => filter(typed), value)]));
    } else {
      super.send(text);
    }
  }

  // Call when the socket is open, at once if it is.
  static onOpen(call) {
    ScreenSocket.#openers.push(call);
    if (ScreenSocket.current?.readyState === WebSocket.OPEN) call();
  }

  // Call with the reason that the server gives, when the socket has ended.
  static onClose(call) {
    ScreenSocket.#closers.push(call);
  }

  static type(text) {
    ScreenSocket.#say("stdin", text);
  }

  static demand(value) {
    const full = ScreenSocket.current && ScreenSocket.current.bufferedAmount > MAX_WAITING;
    if (!full || !(value.held || value.buttons.length)) ScreenSocket.#say("pad", value);
  }

  static #say(...message) {
    const socket = ScreenSocket.current;
    if (socket && socket.readyState === WebSocket.OPEN) WebSocket.prototype.send.call(socket, JSON.stringify(message));
  }
}

window.WebSocket = ScreenSocket;
