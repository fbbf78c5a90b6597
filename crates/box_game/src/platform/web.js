// What the game asks of its page. The page (web/index.html) puts files into boxGame.files.

const page = (globalThis.boxGame ??= { files: [] });

export const search = () => location.search;
export const address = () => location.origin + location.pathname;

/** Shows a text over the page, with a button that closes it. Where no game runs below it, that starts one. */
export function show(text, failed) {
  const box = document.createElement("dialog");
  const words = document.createElement("pre");
  words.textContent = text;
  const close = document.createElement("button");
  close.textContent = page.running ? "Close" : "Start the game";
  close.onclick = () => box.close();
  box.onclose = () => (page.running ? box.remove() : location.assign(location.pathname));
  box.append(words, close);
  box.className = failed ? "failed" : "said";
  box.setAttribute("aria-label", failed ? "Error" : "Result");
  document.body.append(box);
  box.showModal();
  page.said?.();
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

/** Copies a text, or shows it where the browser does not allow that: only secure pages have a clipboard. */
export function copy_text(text) {
  const refused = () => show(`The browser does not allow copying. The text:\n\n${text}`, false);
  if (navigator.clipboard) {
    navigator.clipboard.writeText(text).catch(refused);
    return true;
  }
  refused();
  return false;
}

/** Files that are not yet downloaded: a page with any asks before it closes. */
let open = 0;
addEventListener("beforeunload", (event) => open > 0 && !page.stopped && event.preventDefault());
export function keep_open(more) {
  open += more ? 1 : -1;
}

export const file_name = () => page.files[0]?.name;
export const file_text = () => page.files.shift().text;

/** Keys and gestures with a meaning in the game keep it; reloading, closing and the developer tools stay the browser's. */
export function keep_keys() {
  const alone = ["Space", "Backspace", "Tab", "Home", "F1", "Quote", "Slash", "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
  const withControl = ["KeyO", "KeyQ", "KeyY", "KeyZ", "+", "=", "-", "0"];
  const withAlt = ["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"];
  const canvas = document.getElementById("game");
  canvas.addEventListener("keydown", (event) => {
    const control = event.ctrlKey || event.metaKey;
    // Both: AltGr, which types a character.
    if (control && event.altKey) return;
    const own = control ? withControl : event.altKey ? withAlt : alone;
    if (own.includes(event.code) || own.includes(event.key)) event.preventDefault();
  });
  for (const kind of ["contextmenu", "wheel"]) {
    canvas.addEventListener(kind, (event) => event.preventDefault(), { passive: false });
  }
  // The middle button would scroll.
  canvas.addEventListener("mousedown", (event) => event.button === 1 && event.preventDefault());
  canvas.focus();
}
