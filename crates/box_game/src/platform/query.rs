//! Arguments in the URL of a page. `?scene=bounce&integrator=split,rk4&set=gravity%3D1.62&no-settings` is the command
//! line `box_game bounce --integrator split,rk4 --set gravity=1.62 --no-settings`.

/// The key of the positional argument.
const SCENE: &str = "scene";

/// Converts a query string (with or without its `?`) to a command line, without the program's name. A key without a
/// value is a flag. Tracking parameters of links are dropped.
pub fn words(query: &str) -> Vec<String> {
    let pairs = query.trim_start_matches('?').split('&');
    pairs
        .map(|pair| pair.split_once('=').unwrap_or((pair, "")))
        .filter(|(key, _)| !key.is_empty() && !follows_readers(key))
        .flat_map(|(key, value)| {
            let (key, value) = (decoded(key), decoded(value));
            match (key.as_str(), value.is_empty()) {
                (SCENE, _) => vec![value],
                (_, true) => vec![format!("--{key}")],
                // One word, so that a value may begin with a minus.
                (_, false) => vec![format!("--{key}={value}")],
            }
        })
        .collect()
}

/// Returns `true` for keys of campaigns, search engines and networks: `utm_source`, `fbclid`, `gclid`, `msclkid`.
fn follows_readers(key: &str) -> bool {
    key.starts_with("utm_") || key.ends_with("clid") || key.ends_with("clkid")
}

/// Converts a command line without the program's name to a query string without its `?`: a scene, then options with
/// their values, and flags.
pub fn of(words: &[String]) -> String {
    let mut pairs: Vec<String> = Vec::new();
    let mut words = words.iter().peekable();
    while let Some(word) = words.next() {
        pairs.push(match word.strip_prefix("--") {
            None => format!("{SCENE}={}", encoded(word)),
            Some(flag) => match words.next_if(|next| !next.starts_with("--")) {
                Some(value) => format!("{flag}={}", encoded(value)),
                None => flag.to_owned(),
            },
        });
    }
    pairs.join("&")
}

/// Percent-decodes; `+` is a space. Invalid codes are unchanged.
fn decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let code = (byte == b'%')
            .then(|| core::str::from_utf8(bytes.get(at + 1..at + 3)?).ok())
            .flatten()
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        out.push(code.unwrap_or(if byte == b'+' { b' ' } else { byte }));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Percent-encodes all characters that a query value must not contain.
fn encoded(text: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.~,/:=".contains(&b);
    text.bytes()
        .map(|b| {
            if plain(b) {
                char::from(b).to_string()
            } else {
                format!("%{b:02X}")
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use box_physics::prelude::Integrator;
    use clap::Parser;

    fn parsed(query: &str) -> Cli {
        let words = ["box_game".to_owned()].into_iter().chain(words(query));
        Cli::try_parse_from(words).expect(query)
    }

    #[test]
    fn a_query_is_a_command_line() {
        let cli = parsed("?scene=dzhanibekov&integrator=split,rk4&plot=error&no-settings");
        assert_eq!(cli.scene.as_deref(), Some("dzhanibekov"));
        assert_eq!(cli.integrator, [Integrator::Split, Integrator::Rk4]);
        assert!(cli.plot.is_some() && cli.no_settings);
        for query in ["", "?utm_source=a&fbclid=b", "&", "gclid=1&"] {
            assert_eq!(words(query), [""; 0], "{query}");
        }
        let cli = parsed("set=gravity%3D1.62&set=linear-drag=0.5&dt=1/120");
        assert_eq!(cli.set.len(), 2);
        assert_eq!(cli.dt, 1.0 / 120.0);
        let error = Cli::try_parse_from(["box_game".to_owned()].into_iter().chain(words("fly=1")));
        assert!(error.expect_err("unknown").to_string().contains("--fly"));
    }

    #[test]
    fn what_is_written_reads_back() {
        let line =
            "bounce --integrator split,rk4 --set gravity=1.62 --set half-x=0.5 --no-settings";
        let split: Vec<String> = line.split(' ').map(str::to_owned).collect();
        let query = of(&split);
        let start = "scene=bounce&integrator=split,rk4&set=gravity=1.62&";
        assert!(query.starts_with(start), "{query}");
        let again = words(&query);
        let again: Vec<&str> = again.iter().flat_map(|w| w.splitn(2, '=')).collect();
        assert_eq!(again.join(" "), line);
        let odd = "é &?+%20/x.ron".to_owned();
        assert_eq!(words(&of(std::slice::from_ref(&odd))), [odd]);
        assert_eq!(words("a=%zz%4"), ["--a=%zz%4"]);
    }
}
