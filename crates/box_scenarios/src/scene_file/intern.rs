//! Interned texts that live as long as the program. Most scenes are built in, and their texts are `&'static`. Reading a
//! text again (hot reload) leaks no further memory.

use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

static TEXTS: Mutex<Option<HashSet<&'static str>>> = Mutex::new(None);
static LISTS: Mutex<Option<HashSet<&'static [&'static str]>>> = Mutex::new(None);

/// The interned copy of `text`.
pub(super) fn text(text: String) -> &'static str {
    let mut known = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = known.get_or_insert_default();
    if let Some(&same) = known.get(text.as_str()) {
        return same;
    }
    let kept: &'static str = text.leak();
    known.insert(kept);
    kept
}

/// The interned copy of a list of texts.
pub(super) fn list(texts: Vec<String>) -> &'static [&'static str] {
    let texts: Vec<&'static str> = texts.into_iter().map(text).collect();
    let mut known = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = known.get_or_insert_default();
    if let Some(&same) = known.get(texts.as_slice()) {
        return same;
    }
    let kept: &'static [&'static str] = texts.leak();
    known.insert(kept);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_text_is_kept_once() {
        let a = text("a text of the test".to_owned());
        let b = text("a text of the test".to_owned());
        assert!(core::ptr::eq(a, b));
        let one = list(vec!["split".to_owned(), "rk4".to_owned()]);
        let two = list(vec!["split".to_owned(), "rk4".to_owned()]);
        assert!(core::ptr::eq(one, two));
    }
}
