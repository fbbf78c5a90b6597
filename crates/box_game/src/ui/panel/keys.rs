//! Keys and mouse controls: one list for the help overlay and `docs/game.md`.

/// The screenshot key, on platforms that leave it to the game.
pub(super) const SCREENSHOT: &str = "F12";

/// Keys and their effect.
#[rustfmt::skip]
pub const KEYS: &[(&str, &str)] = &[
    ("W S · A D · E Q", "push along the box's z · x · y axis (hold to repeat)"),
    ("Shift + these", "push off-center, so that the box spins"),
    ("Alt + these", "push along the world's axes"),
    ("Click the box · drag it", "poke (scroll while holding to set the strength) · grab"),
    ("1 … 9", "switch to the integrator with this key"),
    ("Shift + 1 … 9", "compare with that integrator, or stop"),
    ("G · V", "show or hide the comparisons · next layout"),
    ("P or Space", "pause or resume"),
    (". or →", "step once (with Shift: ten times)"),
    (", or ←", "step back (with Shift: ten times)"),
    ("R or Backspace", "restart the scene"),
    ("- and =", "slower, faster"),
    ("0", "real time"),
    ("[ and ]", "previous scene, next scene"),
    ("Ctrl + O", "search scenes"),
    ("Ctrl + Z · Ctrl + Shift + Z", "undo · redo"),
    ("Ctrl + plus · Ctrl + minus", "scale the panel"),
    ("B · C · X", "show the bounding box · contacts · axes and velocity"),
    ("F", "center the view on the box"),
    ("Home", "reset the view"),
    ("Drag elsewhere · right drag · scroll", "orbit · pan · zoom"),
    ("L", "start or stop the CSV log"),
    (SCREENSHOT, "save a screenshot"),
    ("M", "show or hide the plots"),
    ("` (backtick)", "show or hide the panel"),
    ("F1 or ?", "show or hide this list"),
    ("Esc", "close a dialog, release the box"),
    ("Ctrl + Q", "quit"),
];
