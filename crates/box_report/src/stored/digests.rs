//! The digests of the exact results of all integrators, which `tests/determinism.rs` asserts.

use box_physics::digest::fingerprint;
use box_physics::integrators::Integrator;
use serde::{Deserialize, Serialize};

use crate::context::Stop;
use crate::files;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    integrator: String,
    /// 16 hexadecimal digits.
    digest: String,
}

pub(super) fn make() -> Result<String, Stop> {
    let rows: Vec<Row> = Integrator::ALL
        .iter()
        .map(|&i| Row {
            integrator: i.id().to_owned(),
            digest: format!("{:016x}", fingerprint(i)),
        })
        .collect();
    files::csv_text(&rows).map_err(|e| Stop::Internal(e.to_string()))
}

pub(super) fn differences(stored: &str, new: &str) -> Result<Vec<String>, String> {
    let (stored, new): (Vec<Row>, Vec<Row>) = (files::parse_csv(stored)?, files::parse_csv(new)?);
    let find = |rows: &[Row], id: &str| {
        let row = rows.iter().find(|r| r.integrator == id);
        row.map_or_else(|| "missing".to_owned(), |r| r.digest.clone())
    };
    let mut ids: Vec<&str> = new.iter().map(|r| r.integrator.as_str()).collect();
    ids.extend(stored.iter().map(|r| r.integrator.as_str()));
    let mut seen = std::collections::HashSet::new();
    ids.retain(|id| seen.insert(*id));
    Ok(ids
        .into_iter()
        .map(|id| (id, find(&stored, id), find(&new, id)))
        .filter(|(_, before, after)| before != after)
        .map(|(id, before, after)| format!("{id}: was {before}, is {after}"))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_added_and_removed_digests_are_named() {
        let old = "integrator,digest\nsplit,01\nrk4,02\n";
        let new = "integrator,digest\nsplit,03\nexact,04\n";
        assert_eq!(
            differences(old, new).expect("readable"),
            [
                "split: was 01, is 03",
                "exact: was missing, is 04",
                "rk4: was 02, is missing"
            ]
        );
        assert!(differences(old, old).expect("readable").is_empty());
        assert!(differences("digest\n1\n", new).is_err());
    }
}
