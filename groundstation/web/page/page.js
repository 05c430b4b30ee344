// The page of one screen: the keys go to its terminal, and a touch screen has a thumb stick below it.
import "./keys.js";
import { ScreenSocket } from "./screen_socket.js";
import { showStick } from "./stick.js";

const COLUMNS = 80; // of the whole display of a screen
const LETTER = 0.604; // width of a letter, in its size
const LEAST_FONT = 7, USUAL_FONT = 12; // pixels on a touch screen; with the usual one a narrow screen shows a strip

const touches = matchMedia("(pointer: coarse)");
let types = !touches.matches; // no keyboard over half of a touch screen until it is asked for

// Give the keys to the terminal: once it is connected, and whenever its window or tab is chosen again.
function focusTerminal() {
  const field = document.querySelector(".xterm-helper-textarea");
  if (!field || !document.body.classList.contains("-loaded")) return;
  field.inputMode = types ? "text" : "none";
  field.focus();
}

function chooseFont(terminal) {
  const fits = Math.floor(terminal.clientWidth / COLUMNS / LETTER);
  return fits < LEAST_FONT ? USUAL_FONT : Math.min(fits, USUAL_FONT);
}

if (touches.matches) {
  showStick();
  const terminal = document.getElementById("terminal");
  if (!new URLSearchParams(location.search).has("fontsize")) terminal.dataset.fontSize = chooseFont(terminal);
}
document.querySelector("#touch .keyboard").addEventListener("click", () => {
  types = !types;
  document.querySelector(".xterm-helper-textarea")?.blur();
  focusTerminal();
});
addEventListener("pointerdown", (event) => event.pointerType === "touch" && showStick(), true);
addEventListener("load", () => {
  new MutationObserver(focusTerminal).observe(document.body, { attributeFilter: ["class"] });
});
addEventListener("focus", focusTerminal);
ScreenSocket.onClose((reason) => {
  document.querySelector(".why").textContent = reason && ` ${reason}.`;
});
