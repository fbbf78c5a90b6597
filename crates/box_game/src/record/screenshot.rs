//! Pictures of the window, or of the image rendered instead of it: one by one, or a numbered series.

use std::io;
use std::path::{Path, PathBuf};

use bevy::ecs::system::SystemParam;
use bevy::image::ImageFormat;
use bevy::prelude::*;
use bevy::render::view::window::screenshot::{Screenshot, ScreenshotCaptured};

use crate::action::{Action, Film};
use crate::platform;
use crate::scene::session::Session;
use crate::view::renderer::PictureTarget;

/// Area of the open plot or table \[pixels\]; empty while the drawer is closed.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct PlotArea(pub URect);

/// The requested pictures.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct Pictures {
    /// Number of pictures not yet on disk; the program waits for them before it ends.
    pub pending: u32,
    /// Files named by the command line or a script that are not on disk: not yet, or because of an error.
    pub missing: Vec<PathBuf>,
}

/// Requests a picture of the next frame.
#[derive(Resource, Clone, Debug)]
pub(crate) struct ScreenshotRequest {
    /// The file; without one the next free `box_game-NN.png` or `plot-NN.png`.
    pub path: Option<PathBuf>,
    /// The open plot or table alone.
    pub plot: bool,
}

/// A series of pictures being taken.
#[derive(Resource, Debug)]
pub(crate) struct Filming {
    film: Film,
    taken: u32,
    /// Time of the first picture \[s\].
    began: Option<f64>,
}

pub(crate) fn on_action(action: On<Action>, mut session: ResMut<Session>, mut commands: Commands) {
    let (path, plot) = match &*action {
        Action::Screenshot => (None, false),
        Action::ScreenshotTo(path) => (Some(path.clone()), false),
        Action::SavePlot(path) => (path.clone(), true),
        Action::Record(film) => {
            if !(film.rate > 0.0 && film.rate.is_finite()) {
                session.notice(format!("Record: rate {}: allowed: above 0", film.rate));
                return;
            }
            commands.insert_resource(Filming {
                film: film.clone(),
                taken: 0,
                began: None,
            });
            return;
        }
        _ => return,
    };
    commands.insert_resource(ScreenshotRequest { path, plot });
}

/// System parameter that takes pictures.
#[derive(SystemParam)]
pub(crate) struct Capture<'w, 's> {
    target: Res<'w, PictureTarget>,
    session: ResMut<'w, Session>,
    pictures: ResMut<'w, Pictures>,
    commands: Commands<'w, 's>,
}

pub(crate) fn take_screenshot(
    request: If<Res<ScreenshotRequest>>,
    plot: Res<PlotArea>,
    mut capture: Capture,
) {
    capture.commands.remove_resource::<ScreenshotRequest>();
    let name = if request.plot { "plot" } else { "box_game" };
    // A file that was named needs no notice, which would be in the next picture.
    let named = request.path.is_some();
    let path = request.path.clone();
    match path.map_or_else(|| platform::next_free(name, "png"), Ok) {
        Err(error) => capture.session.notice(error.to_string()),
        Ok(_) if request.plot && plot.0.is_empty() => {
            capture
                .session
                .notice("no plot is open; press M to show the plots");
        }
        Ok(path) => capture.picture(request.plot.then_some(plot.0), path, named),
    }
}

/// Takes the pictures of a series that are due.
pub(crate) fn film(mut filming: If<ResMut<Filming>>, time: Res<Time<Real>>, mut capture: Capture) {
    let now = time.elapsed_secs_f64();
    let began = *filming.began.get_or_insert(now);
    if now < began + f64::from(filming.taken) / filming.film.rate - 1e-6 {
        return;
    }
    let folder = &filming.film.folder;
    if filming.taken == 0
        && let Err(error) = platform::create_folder(folder)
    {
        capture
            .session
            .notice(format!("{}: {error}", folder.display()));
        capture.commands.remove_resource::<Filming>();
        return;
    }
    let path = folder.join(format!("{:04}.png", filming.taken + 1));
    capture.picture(None, path, true);
    filming.taken += 1;
    if filming.taken >= filming.film.pictures {
        capture.commands.remove_resource::<Filming>();
    }
}

impl Capture<'_, '_> {
    /// Takes a picture, or the part `area` of it, and saves it at `path`.
    fn picture(&mut self, area: Option<URect>, path: PathBuf, named: bool) {
        self.pictures.pending += 1;
        if named {
            self.pictures.missing.push(path.clone());
        }
        let picture = Screenshot(self.target.0.clone());
        self.commands.spawn(picture).observe(
            move |captured: On<ScreenshotCaptured>,
                  mut session: ResMut<Session>,
                  mut pictures: ResMut<Pictures>| {
                pictures.pending = pictures.pending.saturating_sub(1);
                let saved = save(&captured.image, area, &path);
                if saved.is_ok() {
                    pictures.missing.retain(|missing| *missing != path);
                }
                match saved {
                    Ok(()) if named => info!("screenshot: {}", path.display()),
                    Ok(()) => session.notice(format!("screenshot: {}", path.display())),
                    Err(error) => {
                        session.notice(format!("screenshot {}: {error}", path.display()));
                    }
                }
            },
        );
    }
}

fn save(image: &Image, area: Option<URect>, path: &Path) -> io::Result<()> {
    let mut picture = image.clone().try_into_dynamic().map_err(io::Error::other)?;
    if let Some(URect { min, max }) = area {
        picture = picture.crop_imm(min.x, min.y, max.x - min.x, max.y - min.y);
    }
    let mut png = io::Cursor::new(Vec::new());
    let format = ImageFormat::Png.as_image_crate_format();
    let format = format.ok_or_else(|| io::Error::other("built without PNG support"))?;
    // The alpha of a window has no meaning.
    picture
        .to_rgb8()
        .write_to(&mut png, format)
        .map_err(io::Error::other)?;
    platform::write(path, png.get_ref())
}
