//! The keys and the mouse: one list for the help overlay and the README.

/// (what to press, what it does).
pub const KEYS: &[(&str, &str)] = &[
    (
        "W S · A D · E Q",
        "push the box along its own z · x · y axis; hold to repeat",
    ),
    (
        "Shift + those",
        "push at the edge of the face, so that the box spins",
    ),
    ("Alt + those", "push along the world's axes"),
    (
        "Click the box · drag it",
        "poke it there (wheel while held: strength) · hold it on a spring",
    ),
    (
        "1 … 9",
        "move the box by the integrator with this key (its tooltip says it)",
    ),
    ("Shift + 1 … 9", "simulate that one beside it, or no longer"),
    ("G · V", "ghosts on or off · next layout"),
    ("P or Space", "pause, resume"),
    (". or →", "one step while paused (with Shift: ten)"),
    (", or ←", "one step back (with Shift: ten)"),
    ("R or Backspace", "restart the scene"),
    ("- and =", "slower, faster"),
    ("0", "real time"),
    ("[ and ]", "previous scene, next scene"),
    ("Ctrl + O", "search for a scene"),
    (
        "Ctrl + Z · Ctrl + Shift + Z",
        "take back a change of a parameter or a reset · do it again",
    ),
    ("Ctrl + plus · Ctrl + minus", "size of the panel"),
    (
        "B · C · X",
        "show the bounding box · the contacts · axes and velocity",
    ),
    ("F", "put the box in the middle of the picture"),
    ("Home", "the scene's own camera"),
    (
        "Left drag beside it · right drag · wheel",
        "orbit · pan · zoom",
    ),
    ("L", "start or stop the CSV log"),
    (
        "F12",
        "save a picture of the window (of a plot: its PNG button)",
    ),
    ("M", "show or hide the plots"),
    ("` (backtick)", "show or hide the panel"),
    ("F1 or ?", "show or hide this list"),
    ("Esc", "close a list, let go of the box"),
    ("Ctrl + Q", "quit"),
];

#[cfg(test)]
mod tests {
    #[test]
    fn every_key_says_what_it_does_once() {
        for (k, (key, what)) in super::KEYS.iter().enumerate() {
            assert!(!key.is_empty() && !what.is_empty());
            assert!(super::KEYS[..k].iter().all(|(other, _)| other != key));
        }
    }
}
