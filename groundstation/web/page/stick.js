// Thumb stick and buttons for touch screens: to the screen they are a gamepad, whose dead-man button is the touched stick.
import { ScreenSocket } from "./screen_socket.js";

const PERIOD = 50; // ms between two demands, as gamepads send; the station is neutral 250 ms after the last one
const STALLED = 200; // ms without a turn of the timer after which the page has missed events: nothing is held any more
const CLOCKS = 5; // answers of the server's clock of which the fastest counts

const panel = document.getElementById("touch");
const stick = panel.querySelector(".stick"), knob = panel.querySelector(".knob");
const pressed = new Map(); // pointer -> button that it holds
let thumb = null; // the pointer on the stick, where it went down, and how far it is from there, -1..1
let timer = null, turned = 0, wasActive = false;
const offsets = []; // the server's clock less that of this page, ms, never too much

// Take the server's clock. What is read here at t was read at t + offset there, or later: an answer takes time to come.
function readClock(data) {
  if (typeof data !== "string") return;
  const [name, value] = JSON.parse(data);
  if (name !== "clock") return;
  offsets.push(value - performance.now());
  if (offsets.length > CLOCKS) offsets.shift();
}

function tell() {
  const at = offsets.length ? performance.now() + Math.max(...offsets) : 0;
  const { x = 0, y = 0 } = thumb ?? {};
  ScreenSocket.demand({ at, held: thumb !== null, x, y, buttons: [...new Set(pressed.values())] });
}

function turn() {
  const now = performance.now();
  if (now - turned > STALLED) return letGo();
  turned = now;
  tell();
}

// Send what has changed, and go on sending while anything is held.
function update() {
  const active = thumb !== null || pressed.size > 0;
  if (active && timer === null) {
    turned = performance.now();
    timer = setInterval(turn, PERIOD);
  } else if (!active && timer !== null) {
    clearInterval(timer);
    timer = null;
  }
  if (active || wasActive) tell();
  wasActive = active;
}

function letGo() {
  thumb = null;
  pressed.clear();
  draw();
  update();
}

function draw() {
  const radius = stick.clientWidth / 2 - knob.clientWidth / 2;
  knob.style.transform = thumb ? `translate(${thumb.x * radius}px, ${-thumb.y * radius}px)` : "";
  stick.classList.toggle("-down", thumb !== null);
  for (const button of panel.querySelectorAll("[data-button]")) {
    button.classList.toggle("-down", [...pressed.values()].includes(button.dataset.button));
  }
}

function down(event) {
  const button = event.target.closest("[data-button]");
  if (button) {
    button.setPointerCapture(event.pointerId);
    pressed.set(event.pointerId, button.dataset.button);
  } else if (event.target.closest(".stick") && thumb === null) {
    stick.setPointerCapture(event.pointerId);
    thumb = { pointer: event.pointerId, from: [event.clientX, event.clientY], x: 0, y: 0 };
  }
  draw();
  update();
}

function move(event) {
  if (event.pointerId !== thumb?.pointer) return;
  const reach = stick.clientWidth / 2 - knob.clientWidth / 2;
  const [x, y] = [(event.clientX - thumb.from[0]) / reach, (thumb.from[1] - event.clientY) / reach];
  const length = Math.max(1, Math.hypot(x, y));
  const began = !thumb.x && !thumb.y;
  Object.assign(thumb, { x: x / length, y: y / length });
  draw();
  if (began) tell(); // the rest follows with the timer
}

function lift(event) {
  if (event.pointerId === thumb?.pointer) thumb = null;
  pressed.delete(event.pointerId);
  draw();
  update();
}

export function showStick() {
  if (!panel.hidden) return;
  panel.hidden = false;
  document.body.classList.add("-touch");
  ScreenSocket.onOpen(tell);
  dispatchEvent(new Event("resize")); // the terminal takes what is left
}

ScreenSocket.readers.push(readClock);
panel.addEventListener("pointerdown", down);
panel.addEventListener("pointermove", move);
for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) panel.addEventListener(end, lift);
for (const usual of ["mousedown", "contextmenu"]) panel.addEventListener(usual, (event) => event.preventDefault());
for (const leave of ["blur", "pagehide"]) addEventListener(leave, letGo);
document.addEventListener("freeze", letGo);
document.addEventListener("visibilitychange", () => document.hidden && letGo());
