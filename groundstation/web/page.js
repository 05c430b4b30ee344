// Gives the keys to the terminal: once it is connected, and whenever its window or tab is chosen again.
function focusTerminal() {
  if (document.body.classList.contains("-loaded")) {
    document.querySelector(".xterm-helper-textarea")?.focus();
  }
}
addEventListener("load", () => {
  new MutationObserver(focusTerminal).observe(document.body, { attributeFilter: ["class"] });
});
addEventListener("focus", focusTerminal);
