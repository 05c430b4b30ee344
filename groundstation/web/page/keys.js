// Keys as a terminal with the keyboard protocol of kitty sends them: press, repeat and release.
// https://sw.kovidgoyal.net/kitty/keyboard-protocol/ . xterm.js has the rest: pastes, the mouse, answers to pings.
import { ScreenSocket } from "./screen_socket.js";

const PRESS = 1, REPEAT = 2, RELEASE = 3;
const EVENT_TYPES = 2, ALL_KEYS = 8; // flags of the protocol without which xterm.js has the keys
const MAX_FLAGS = 8; // depth of the stack of flags
const SHIFT = 1, ALT = 2, CTRL = 4, CAPS_LOCK = 64, NUM_LOCK = 128;

const NAMED = {
  Escape: "27u", Enter: "13u", Tab: "9u", Backspace: "127u",
  ArrowUp: "1A", ArrowDown: "1B", ArrowRight: "1C", ArrowLeft: "1D", Home: "1H", End: "1F",
  Insert: "2~", Delete: "3~", PageUp: "5~", PageDown: "6~",
  F1: "1P", F2: "1Q", F3: "13~", F4: "1S", F5: "15~", F6: "17~", F7: "18~", F8: "19~", F9: "20~", F10: "21~",
  F11: "23~", F12: "24~",
};
const PLACES = {
  Minus: "-", Equal: "=", BracketLeft: "[", BracketRight: "]", Backslash: "\\", Semicolon: ";", Quote: "'",
  Backquote: "`", Comma: ",", Period: ".", Slash: "/", Space: " ",
}; // place of a key -> its character on a US keyboard

const held = new Map(); // place of a key that is down -> number and end of its sequence
const flags = [0]; // what the program in the terminal has asked for; the last one counts
let unread = "", reportsFocus = false;

const exact = () => (flags.at(-1) & EVENT_TYPES) !== 0 && (flags.at(-1) & ALL_KEYS) !== 0;

function followModes(data) {
  if (typeof data === "string") return;
  const text = unread + new TextDecoder("latin1").decode(data);
  unread = /\x1b(?:\[[=><?]?[\d;]{0,8})?$/.exec(text)?.[0] ?? "";
  for (const [, kind, numbers, ask, focus] of text.matchAll(/\x1b\[(?:([=><])([\d;]*)u|(\?u)|\?1004([hl]))/g)) {
    if (ask) ScreenSocket.type(`\x1b[?${flags.at(-1)}u`);
    else if (focus) reportsFocus = focus === "h";
    else setFlags(kind, ...numbers.split(";").map(Number));
  }
}

function setFlags(kind, value = 0, how = 1) {
  if (kind === ">") {
    flags.push(value);
    if (flags.length > MAX_FLAGS) flags.shift();
  } else if (kind === "<") {
    for (let count = value || 1; count && flags.length > 1; count--) flags.pop();
  } else {
    const now = flags.at(-1);
    flags[flags.length - 1] = how === 2 ? now | value : how === 3 ? now & ~value : value;
  }
}

function modifiersOf(event) {
  const altGr = event.getModifierState("AltGraph"); // Windows reports it as Ctrl and Alt as well
  return (event.shiftKey ? SHIFT : 0) | (event.altKey && !altGr ? ALT : 0) | (event.ctrlKey && !altGr ? CTRL : 0) |
    (event.getModifierState("CapsLock") ? CAPS_LOCK : 0) | (event.getModifierState("NumLock") ? NUM_LOCK : 0);
}

// Return the number of a key, with the shifted character and that of its place, and the end of its sequence.
function keyOf(event) {
  if (event.key in NAMED) return [NAMED[event.key].slice(0, -1), NAMED[event.key].slice(-1)];
  if ([...event.key].length !== 1) return null; // a modifier, or a key of an input method
  const place = /^(?:Key|Digit)(.)$/.exec(event.code)?.[1].toLowerCase() ?? PLACES[event.code] ?? "";
  const lower = event.key.toLowerCase();
  const plain = lower !== event.key || !event.shiftKey || !place ? lower : place;
  const number = (character) => (character ? character.codePointAt(0) : "");
  const shifted = event.shiftKey && plain !== event.key ? event.key : "";
  const base = place && place !== plain ? place : "";
  return [[number(plain), number(shifted), number(base)].join(":").replace(/:+$/, ""), "u"];
}

const sequence = ([number, end], modifiers, type, text = "") =>
  `\x1b[${number};${modifiers + 1}:${type}${text && `;${text.codePointAt(0)}`}${end}`;

function press(event) {
  const browsers = event.ctrlKey && event.shiftKey && /^Key[CVIJ]$/.test(event.code); // copy, paste, its own tools
  if (event.metaKey) releaseAll(); // macOS does not report a release while Command is held
  if (!exact() || event.isComposing || event.metaKey || browsers) return;
  const key = keyOf(event);
  if (key === null) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  const place = event.code || event.key;
  if (event.repeat && !held.has(place)) return; // held since before this page had the keys
  if (!event.repeat && held.has(place)) release(place);
  held.set(place, key);
  const modifiers = modifiersOf(event);
  const text = key[1] === "u" && [...event.key].length === 1 && !(modifiers & (ALT | CTRL)) ? event.key : "";
  ScreenSocket.type(sequence(key, modifiers, event.repeat ? REPEAT : PRESS, text));
}

function release(place, modifiers = 0) {
  ScreenSocket.type(sequence(held.get(place), modifiers, RELEASE));
  held.delete(place);
}

function lift(event) {
  const place = event.code || event.key;
  if (!held.has(place)) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  release(place, modifiersOf(event));
}

function releaseAll() {
  [...held.keys()].forEach((place) => release(place));
}

// A page that is hidden or put to sleep sees no release. It has no keys, whatever has the focus in it.
function leave() {
  releaseAll();
  if (reportsFocus) ScreenSocket.type("\x1b[O");
}

function comeBack() {
  if (reportsFocus && document.hasFocus()) ScreenSocket.type("\x1b[I");
}

// Characters without a press and a release, as of a keyboard on a touch screen: a tap, which is released at once.
function tap(text) {
  if (!exact() || text.startsWith("\x1b")) return text;
  const characters = [...text].map((character) => {
    const code = { "\r": 13, "\t": 9, "\x7f": 127 }[character];
    const key = [code ?? character.codePointAt(0), "u"];
    return sequence(key, 0, PRESS, code ? "" : character) + sequence(key, 0, RELEASE);
  });
  return characters.join("");
}

ScreenSocket.readers.push(followModes);
ScreenSocket.filters.push(tap);
addEventListener("keydown", press, true);
addEventListener("keyup", lift, true);
addEventListener("blur", releaseAll);
addEventListener("pagehide", leave);
document.addEventListener("freeze", leave);
document.addEventListener("visibilitychange", () => (document.hidden ? leave() : comeBack()));
