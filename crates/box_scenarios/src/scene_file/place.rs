//! Where in a RON text a field stands. The parser knows where it stopped, not in which field; the
//! checks know the field, not where it stands: one scan of the text answers both.

/// Deeper than any scene; what lies deeper is not looked at.
const DEEPEST: usize = 16;

/// A field with a name: the names round it and its own, and the byte where its value begins.
#[derive(Debug, PartialEq)]
struct Mark {
    path: String,
    value: usize,
}

/// Line and column (characters) from 1 of byte `offset`.
pub(super) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |n| n + 1);
    let column = before.get(start..).unwrap_or_default().chars().count() + 1;
    (line, column)
}

/// The byte at `line` and `column`, both from 1.
pub(super) fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text
        .split_inclusive('\n')
        .take(line.saturating_sub(1))
        .map(str::len)
        .sum();
    let rest = text.get(start..).unwrap_or_default();
    let within = rest
        .char_indices()
        .nth(column.saturating_sub(1))
        .map_or(rest.len(), |(at, _)| at);
    start + within
}

/// The innermost field whose value began before byte `at`, or after no more than space.
pub(super) fn field_at(text: &str, at: usize) -> String {
    let at = past(text.as_bytes(), at, |b| b.is_ascii_whitespace());
    let mut marks = scan(text);
    marks.retain(|m| m.value <= at);
    marks.pop().map(|m| m.path).unwrap_or_default()
}

/// The byte where the value of `field` begins. Of several fields of that name the one that has the
/// number `value`.
pub(super) fn value_of(text: &str, field: &str, value: Option<f64>) -> Option<usize> {
    let marks = scan(text);
    // `half_extents.y` stands in `half_extents`.
    let vector = field.rsplit_once('.').map(|(vector, _)| vector);
    [Some(field), vector]
        .into_iter()
        .flatten()
        .find_map(|name| {
            let named = |m: &&Mark| m.path == name;
            let holds = |m: &&Mark| {
                let number = text.get(m.value..).unwrap_or_default();
                let end = number.find([',', ')', ']']).unwrap_or(number.len());
                let parsed = number.get(..end).and_then(|n| n.trim().parse::<f64>().ok());
                parsed.is_some() && parsed == value
            };
            let exact = marks.iter().filter(named).find(holds);
            exact.or_else(|| marks.iter().find(named)).map(|m| m.value)
        })
}

/// Every field with a name, in the order of the text.
fn scan(text: &str) -> Vec<Mark> {
    let bytes = text.as_bytes();
    let mut marks = Vec::new();
    let mut names: Vec<Option<&str>> = vec![None];
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'"' => at = past_string(bytes, at + 1),
            b'/' if bytes.get(at + 1) == Some(&b'/') => at = past_line(bytes, at),
            b'/' if bytes.get(at + 1) == Some(&b'*') => at = past_block(bytes, at + 2),
            b'r' if matches!(bytes.get(at + 1), Some(b'"' | b'#')) => {
                at = past_raw(bytes, at + 1);
            }
            b'(' | b'[' | b'{' => {
                if names.len() >= DEEPEST {
                    return marks;
                }
                names.push(None);
                at += 1;
            }
            b')' | b']' | b'}' => {
                if names.len() > 1 {
                    names.pop();
                }
                at += 1;
            }
            b if b.is_ascii_alphabetic() || b == b'_' => {
                let end = past(bytes, at, |b| b.is_ascii_alphanumeric() || b == b'_');
                let colon = past(bytes, end, |b| b.is_ascii_whitespace());
                if bytes.get(colon) == Some(&b':') {
                    let value = past(bytes, colon + 1, |b| b.is_ascii_whitespace());
                    if let Some(last) = names.last_mut() {
                        *last = text.get(at..end);
                    }
                    let path: Vec<&str> = names.iter().flatten().copied().collect();
                    marks.push(Mark {
                        path: path.join("."),
                        value,
                    });
                }
                at = end;
            }
            _ => at += 1,
        }
    }
    marks
}

fn past(bytes: &[u8], from: usize, belongs: impl Fn(u8) -> bool) -> usize {
    let rest = bytes.get(from..).unwrap_or_default();
    from + rest.iter().take_while(|&&b| belongs(b)).count()
}

fn past_line(bytes: &[u8], from: usize) -> usize {
    past(bytes, from, |b| b != b'\n')
}

fn past_string(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\\' => at += 2,
            b'"' => return at + 1,
            _ => at += 1,
        }
    }
    at
}

fn past_block(bytes: &[u8], from: usize) -> usize {
    let (mut at, mut depth) = (from, 1);
    while depth > 0 && at < bytes.len() {
        match (bytes[at], bytes.get(at + 1)) {
            (b'*', Some(b'/')) => (depth, at) = (depth - 1, at + 2),
            (b'/', Some(b'*')) => (depth, at) = (depth + 1, at + 2),
            _ => at += 1,
        }
    }
    at
}

/// From the hashes of `r##"…"##`; a lone `r` is left as it is.
fn past_raw(bytes: &[u8], from: usize) -> usize {
    let open = past(bytes, from, |b| b == b'#');
    if bytes.get(open) != Some(&b'"') {
        return open;
    }
    let hashes = open - from;
    let mut at = open + 1;
    while at < bytes.len() {
        if bytes[at] == b'"' && past(bytes, at + 1, |b| b == b'#') >= at + 1 + hashes {
            return at + 1 + hashes;
        }
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(\n  id: \"a: (b: \\\"\", // c: (\n  /* d: /* e: */ */ body: (mass: -1, half: (1, 2, 3)),\n  s: [(k: 5), (k: r#\"f: \"#), (k: 7)],\n  μ: 1, last: 2)";

    #[test]
    fn fields_are_found_through_strings_and_comments() {
        let paths: Vec<_> = scan(TEXT).into_iter().map(|m| m.path).collect();
        assert_eq!(
            paths,
            [
                "id",
                "body",
                "body.mass",
                "body.half",
                "s",
                "s.k",
                "s.k",
                "s.k",
                "last"
            ]
        );
    }

    #[test]
    fn places_are_found_both_ways() {
        let mass = value_of(TEXT, "body.mass", Some(-1.0)).expect("there");
        assert_eq!(line_and_column(TEXT, mass), (3, 34));
        assert_eq!(offset(TEXT, 3, 34), mass);
        assert_eq!(field_at(TEXT, mass + 1), "body.mass");
        // The third spring has the 7; a component stands in its vector.
        let seven = value_of(TEXT, "s.k", Some(7.0)).expect("there");
        assert!(TEXT[seven..].starts_with("7)"));
        let y = value_of(TEXT, "body.half.y", Some(2.0)).expect("there");
        assert!(TEXT[y..].starts_with("(1"));
        assert_eq!(value_of(TEXT, "nothing", None), None);
        // Columns are characters, not bytes.
        let last = value_of(TEXT, "last", None).expect("there");
        assert_eq!(line_and_column(TEXT, last), (5, 15));
        assert_eq!(offset(TEXT, 5, 15), last);
    }
}
