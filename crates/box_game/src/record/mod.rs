//! Records of a run: CSV log, time series for the plots, pictures, films, application log.

pub mod apng;
pub mod application_log;
pub mod csv_log;
pub mod film;
pub mod history;
pub mod rows;
pub mod screenshot;
