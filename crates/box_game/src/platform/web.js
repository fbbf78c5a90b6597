// What the game asks of its page. The page (web/index.html) puts files into boxGame.files.

const page = (globalThis.boxGame ??= { files: [] });

export const search = () => location.search;
export const address = () => location.origin + location.pathname;

/** Shows a text over the page, with a button that closes it. */
export function show(text, failed) {
  const box = document.createElement("dialog");
  const words = document.createElement("pre");
  words.textContent = text;
  const close = document.createElement("button");
  close.textContent = "Close";
  close.onclick = () => box.remove();
  box.append(words, close);
  box.className = failed ? "failed" : "said";
  document.body.append(box);
  box.show();
  page.said?.(text, failed);
}

/** This frame draws the first picture: the cover goes once it is done. */
export function started() {
  queueMicrotask(() => page.started?.());
}

/** The game is over: nothing on the page moves any more. */
export function ended(text) {
  page.over?.(text);
}

export function download(name, bytes) {
  const link = document.createElement("a");
  // A copy: the game's memory may move.
  link.href = URL.createObjectURL(new Blob([bytes.slice()]));
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

export const file_name = () => page.files[0]?.name;
export const file_text = () => page.files.shift().text;

/** Keys and gestures with a meaning in the game keep it; reloading, closing and the developer tools stay the browser's. */
export function keep_keys() {
  const alone = ["Space", "Backspace", "Tab", "Home", "F1", "Quote", "Slash", "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
  const withControl = ["KeyO", "KeyQ", "KeyY", "KeyZ", "Equal", "Minus", "Digit0"];
  const canvas = document.getElementById("game");
  canvas.addEventListener("keydown", (event) => {
    if (event.altKey) return;
    const own = event.ctrlKey || event.metaKey ? withControl : alone;
    if (own.includes(event.code)) event.preventDefault();
  });
  for (const kind of ["contextmenu", "wheel"]) {
    canvas.addEventListener(kind, (event) => event.preventDefault(), { passive: false });
  }
  // The middle button would scroll.
  canvas.addEventListener("mousedown", (event) => event.button === 1 && event.preventDefault());
  canvas.focus();
}
