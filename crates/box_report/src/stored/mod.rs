//! `check` and `bless`: values and tables that the program generates and the repository stores.
//!
//! [`ITEMS`] lists them. `check` generates each item again and compares it; `bless` stores what it generates and prints
//! what changed. Times are never compared.

mod digests;
mod errors;
pub(crate) mod tables;

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;

use crate::context::Stop;
use crate::files;

/// The repository to check.
#[derive(Args)]
pub(crate) struct Repository {
    /// The folder of the repository
    #[arg(long, value_name = "DIR", default_value_os_t = own())]
    root: PathBuf,
}

/// Options of the command bless.
#[derive(Args)]
pub(crate) struct BlessOptions {
    #[command(flatten)]
    repository: Repository,
    /// Skip the table of keys, which needs a build of the game
    #[arg(long)]
    without_game: bool,
}

fn own() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A stored file, or a section of one.
struct Item {
    /// Path relative to the root of the repository.
    file: &'static str,
    /// The name of the section between `<!-- name -->` and `<!-- /name -->`; `None` is the whole file.
    section: Option<&'static str>,
    make: fn() -> Result<String, Stop>,
    /// Describes every difference between the stored text and the new one.
    differences: fn(&str, &str) -> Result<Vec<String>, String>,
}

#[rustfmt::skip]
const ITEMS: [Item; 5] = [
    Item { file: "tests/expected/digests.csv", section: None, make: digests::make, differences: digests::differences },
    Item { file: "tests/expected/report.csv", section: None, make: errors::make, differences: errors::differences },
    Item { file: "docs/integrators.md", section: Some("integrators"), make: tables::integrators, differences: tables::differences },
    Item { file: "docs/integrators.md", section: Some("sources"), make: tables::sources, differences: tables::differences },
    Item { file: "docs/contact.md", section: Some("cases"), make: tables::contact, differences: tables::differences },
];

/// The range of `text` between `<!-- name -->` and `<!-- /name -->`.
pub(crate) fn section(file: &str, text: &str, name: &str) -> Result<core::ops::Range<usize>, Stop> {
    let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let place = text.find(&open).and_then(|at| {
        let from = at + open.len();
        Some(from..from + text.get(from..)?.find(&close)?)
    });
    place.ok_or_else(|| {
        Stop::Usage(format!(
            "{file}: no section between '{}' and '{close}'",
            open.trim()
        ))
    })
}

/// Maximum number of differences shown per item.
const MAX_SHOWN: usize = 40;

impl Item {
    fn path(&self, root: &Path) -> PathBuf {
        root.join(self.file)
    }

    /// The range of the item in the text of its file.
    fn place(&self, text: &str) -> Result<core::ops::Range<usize>, Stop> {
        match self.section {
            None => Ok(0..text.len()),
            Some(name) => section(self.file, text, name),
        }
    }

    /// Describes what differs between `stored` and `new`, under the item's name; empty if they are equal.
    fn compare(&self, stored: &str, new: &str) -> Result<String, Stop> {
        let unreadable = |e| Stop::Usage(format!("{}: {e}", self.file));
        let differences = (self.differences)(stored, new).map_err(unreadable)?;
        if differences.is_empty() {
            return Ok(String::new());
        }
        let count = differences.len();
        let plural = if count == 1 { "" } else { "s" };
        let mut text = format!("{}: {count} difference{plural}", self.file);
        for d in differences.iter().take(MAX_SHOWN) {
            text += &format!("\n  {d}");
        }
        if count > MAX_SHOWN {
            text += &format!("\n  … and {} more", count - MAX_SHOWN);
        }
        Ok(text)
    }
}

/// Generates every item again and compares it with the stored one.
///
/// # Errors
/// There are differences, or a stored file cannot be read.
pub(crate) fn check(repository: &Repository) -> Result<(), Stop> {
    let mut changed = Vec::new();
    for item in &ITEMS {
        let text = files::read(&item.path(&repository.root))?;
        let stored = &text[item.place(&text)?];
        let found = item.compare(stored, &(item.make)()?)?;
        if found.is_empty() {
            println!("{}: as stored", item.file);
        } else {
            changed.push(found);
        }
    }
    if changed.is_empty() {
        return Ok(());
    }
    Err(Stop::Changed(format!(
        "{}\nif this is intended: box_report bless",
        changed.join("\n")
    )))
}

/// Generates every item again, stores it, and prints what changed.
///
/// # Errors
/// A file cannot be written, or an item cannot be generated.
pub(crate) fn bless(options: &BlessOptions) -> Result<(), Stop> {
    let root = &options.repository.root;
    for item in &ITEMS {
        let path = item.path(root);
        // A file that is a whole item need not exist yet.
        let mut text = match item.section {
            None if !path.exists() => String::new(),
            _ => files::read(&path)?,
        };
        let place = item.place(&text)?;
        let new = (item.make)()?;
        let found = item.compare(&text[place.clone()], &new)?;
        println!(
            "{}",
            if found.is_empty() {
                format!("{}: unchanged", item.file)
            } else {
                found
            }
        );
        if text[place.clone()] != new {
            text.replace_range(place, &new);
            files::write(&path, &text)?;
        }
    }
    if options.without_game {
        return Ok(());
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let done = Command::new(cargo)
        .args(["test", "--release", "--locked", "--test", "keys"])
        .env("UPDATE_KEYS", "1")
        .current_dir(root)
        .status();
    match done {
        Ok(status) if status.success() => Ok(()),
        _ => Err(Stop::Failed(
            "the table of keys: cargo test --release --locked --test keys failed".to_owned(),
        )),
    }
}
