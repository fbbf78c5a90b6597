//! The CSV log: one row per step and integrator, with units in the column names. Another thread writes and syncs the
//! file. A killed program loses at most the rows of a few milliseconds, a power cut those of a tenth of a second.

use std::io;
use std::path::{Path, PathBuf};

use bevy::prelude::Resource;
use box_scenarios::Status;
use serde::Serialize;

use crate::platform::{self, SyncedFile};

/// One row. Columns without a value are empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// Id of the run: scene, seed and, in the game, the number of starts.
    pub run_id: String,
    /// Drawn frame.
    pub frame: u64,
    /// Simulated time \[s\].
    pub sim_t_s: f64,
    /// Time since the program started \[s\].
    pub wall_t_s: Option<f64>,
    /// 0 for the main box, then the comparisons; in the headless comparison one per integrator.
    pub trajectory: u32,
    /// Id of the integrator.
    pub integrator: String,
    /// Step \[s\].
    pub dt_s: f64,
    /// Substeps per step.
    pub substeps: u32,
    /// Force evaluations of this row's step: sum of all boxes (main box), or mean of a step (comparisons).
    pub rhs_evals: u64,
    /// Shortest recent time [ns per body-step].
    pub step_ns_min: Option<f64>,
    /// Median recent time [ns per body-step].
    pub step_ns_med: Option<f64>,
    /// Distance from the reference \[m\].
    pub pos_err_m: Option<f64>,
    /// Angle to the reference \[°\].
    pub rot_err_deg: Option<f64>,
    /// Distance after one step from the reference's state \[m\].
    pub local_pos_err_m: Option<f64>,
    /// Kinetic and potential energy \[J\].
    pub energy_j: f64,
    /// Unaccounted energy: the change not due to inputs, forces and floor, over |E₀|.
    pub energy_rel: Option<f64>,
    /// Unaccounted angular momentum (vector, world axes), over |L₀|.
    pub angmom_rel: Option<f64>,
    /// Corners at the floor.
    pub contacts: u32,
    /// ok, contact, resting, quarantined or diverged.
    #[serde(serialize_with = "id")]
    pub state: Status,
    /// CPU of this process [% of all cores].
    pub cpu_process_pct: Option<f64>,
    /// CPU of the system \[%\].
    pub cpu_system_pct: Option<f64>,
    /// Duration of the last frame \[ms\].
    pub frame_ms: Option<f64>,
    /// Pushes, switches and changes before this step.
    pub event: String,
}

fn id<S: serde::Serializer>(status: &Status, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(status.id())
}

/// An open log.
#[derive(Resource)]
pub struct CsvLog {
    /// Full path.
    pub path: PathBuf,
    /// Rows written.
    pub rows: u64,
    file: SyncedFile,
}

impl CsvLog {
    /// Creates `path` (replacing it) and writes the metadata lines.
    ///
    /// # Errors
    /// The error of the file system, with the path.
    pub fn create(path: &Path, scene: &str, seed: u64) -> io::Result<Self> {
        let named = |e: io::Error| io::Error::new(e.kind(), format!("{}: {e}", path.display()));
        let file = platform::create(path).map_err(named)?;
        let head = format!(
            "# box_game {} log\n# scene: {scene}\n# seed: {seed}\n# precision: f64\n# architecture: {}, {} logical cores\n# os: {}\n",
            env!("CARGO_PKG_VERSION"),
            std::env::consts::ARCH,
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            std::env::consts::OS,
        );
        let mut file = SyncedFile::new(file).map_err(named)?;
        file.write(head.into_bytes()).map_err(named)?;
        let path = platform::absolute(path).map_err(named)?;
        Ok(Self {
            path,
            rows: 0,
            file,
        })
    }

    /// Writes one row.
    ///
    /// # Errors
    /// The error of the file system, possibly of an earlier row.
    pub fn write(&mut self, row: &Row) -> io::Result<()> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(self.rows == 0)
            .buffer_capacity(512)
            .from_writer(Vec::new());
        writer.serialize(row).map_err(io::Error::other)?;
        let bytes = writer.into_inner().map_err(|e| e.into_error())?;
        self.file.write(bytes)?;
        self.rows += 1;
        Ok(())
    }

    /// Waits until every row is on disk.
    ///
    /// # Errors
    /// The error of the file system, possibly of an earlier row.
    pub fn sync(&mut self) -> io::Result<()> {
        self.file.sync()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: &str = "run_id,frame,sim_t_s,wall_t_s,trajectory,integrator,dt_s,substeps,rhs_evals,\
step_ns_min,step_ns_med,pos_err_m,rot_err_deg,local_pos_err_m,energy_j,energy_rel,angmom_rel,\
contacts,state,cpu_process_pct,cpu_system_pct,frame_ms,event";

    #[test]
    fn rows_are_on_disk_after_a_sync() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        let mut log = CsvLog::create(&path, "throw", 7).expect("writable");
        for n in 0..3 {
            let row = Row {
                run_id: "throw-7".to_owned(),
                sim_t_s: f64::from(n) / 60.0,
                ..Default::default()
            };
            log.write(&row).expect("writable");
            log.sync().expect("on disk");
            let text = std::fs::read_to_string(&path).expect("readable");
            let rows: Vec<_> = text.lines().filter(|l| !l.starts_with('#')).collect();
            assert_eq!(rows[0], COLUMNS);
            assert_eq!(rows.len(), 2 + n as usize);
        }
        let text = std::fs::read_to_string(&path).expect("readable");
        assert!(text.contains("# seed: 7"));
    }

    #[test]
    fn an_impossible_path_is_named() {
        let path = "/nowhere/at/all.csv";
        let error = CsvLog::create(Path::new(path), "throw", 1).err();
        assert!(error.expect("no folder").to_string().contains(path));
    }
}
