//! Films of the picture, as animated PNG: asked for by a script.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::render::view::window::screenshot::{Screenshot, ScreenshotCaptured};
use serde::{Deserialize, Serialize};

use crate::input::script::PendingPictures;
use crate::record::apng::{self, Picture};
use crate::record::screenshot::{OffscreenTarget, readable, source};
use crate::scene::session::Session;
use crate::view::ghosts::views::PictureArea;

/// What to film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// The file; ends in `.png`.
    pub file: PathBuf,
    /// How long \[s\] of the program's clock, at most 30, and 360 pictures.
    pub seconds: f64,
    /// Pictures a second, 1 to 30.
    #[serde(default = "twelve")]
    pub rate: u16,
    /// By how much it is made smaller: 2 is half the width and half the height.
    #[serde(default = "two")]
    pub reduce: u32,
    /// Without the panel.
    #[serde(default = "yes")]
    pub view_only: bool,
}

fn twelve() -> u16 {
    12
}

fn two() -> u32 {
    2
}

fn yes() -> bool {
    true
}

/// The most pictures of a film: they are kept until it is written.
const MOST: usize = 360;

/// A film being made.
#[derive(Resource, Debug)]
pub struct Recording {
    film: Film,
    began: Option<f64>,
    taken: usize,
    /// Pictures in their order; those not there yet are empty.
    pictures: Vec<Option<Picture>>,
}

impl Recording {
    /// Of `film`, from the next frame on.
    pub fn new(film: Film) -> Self {
        let rate = film.rate.clamp(1, 30);
        let seconds = if film.seconds.is_finite() {
            film.seconds.clamp(0.0, 30.0)
        } else {
            0.0
        };
        let count = (seconds * f64::from(rate)).ceil() as usize;
        Self {
            film: Film { rate, ..film },
            began: None,
            taken: 0,
            pictures: vec![None; count.clamp(1, MOST)],
        }
    }
}

/// Takes the pictures that are due and, once all are there, writes the film.
pub fn record_film(
    recording: Option<ResMut<Recording>>,
    time: Res<Time<Real>>,
    target: Option<Res<OffscreenTarget>>,
    area: Option<Res<PictureArea>>,
    mut pending: ResMut<PendingPictures>,
    mut session: ResMut<Session>,
    mut commands: Commands,
) {
    let Some(mut recording) = recording else {
        return;
    };
    if recording.pictures.iter().all(Option::is_some) {
        let text = match finish(&mut recording) {
            Ok((path, bytes)) => format!("film: {} ({} kB)", path.display(), bytes / 1000),
            Err(error) => format!("film {}: {error}", recording.film.file.display()),
        };
        session.notice(text);
        commands.remove_resource::<Recording>();
        pending.0 = pending.0.saturating_sub(1);
        return;
    }
    let now = time.elapsed_secs_f64();
    if recording.began.is_none() {
        recording.began = Some(now);
        // The film itself is one thing that is not on disk yet.
        pending.0 += 1;
    }
    let due =
        recording.began.unwrap_or(now) + recording.taken as f64 / f64::from(recording.film.rate);
    if recording.taken >= recording.pictures.len() || now < due - 1e-6 {
        return;
    }
    let number = recording.taken;
    recording.taken += 1;
    let view = area
        .map(|area| area.0)
        .filter(|area| recording.film.view_only && !area.is_empty())
        .map(|area| (area.min, area.size()));
    commands
        .spawn(Screenshot(source(target.as_deref())))
        .observe(
            move |captured: On<ScreenshotCaptured>, recording: Option<ResMut<Recording>>| {
                let Some(mut recording) = recording else {
                    return;
                };
                let reduce = recording.film.reduce;
                if let (Some(place), Ok(image)) = (
                    recording.pictures.get_mut(number),
                    captured.image.clone().try_into_dynamic(),
                ) {
                    let image = image.to_rgb8();
                    let whole = Picture {
                        width: image.width(),
                        height: image.height(),
                        rgb: image.into_raw(),
                    };
                    let part = match view {
                        Some((at, size)) => whole.cropped(at.x, at.y, size.x, size.y),
                        None => whole,
                    };
                    *place = Some(part.reduced(reduce));
                }
            },
        );
}

fn finish(recording: &mut Recording) -> Result<(PathBuf, u64), png::EncodingError> {
    let pictures: Vec<Picture> = recording.pictures.drain(..).flatten().collect();
    let path = recording.film.file.clone();
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let mut file = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
    apng::write(&mut file, &pictures, recording.film.rate)?;
    let bytes = file.as_file().metadata()?.len();
    readable(file.path())?;
    file.persist(&path).map_err(|e| e.error)?;
    Ok((path, bytes))
}
