//! Pictures of the window or of the image rendered instead of it.

use std::io;
use std::path::{Path, PathBuf};

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::view::window::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::WindowRef;

use crate::input::script::PendingPictures;
use crate::scene::session::Session;

/// Asks for a picture of the next frame.
#[derive(Resource, Clone, Debug, Default)]
pub struct ScreenshotRequest {
    /// The file; without one the next free `box_game-NN.png` or `plot-NN.png`.
    pub path: Option<PathBuf>,
    /// How much of the window.
    pub part: Part,
}

impl ScreenshotRequest {
    /// Of the whole window.
    pub const fn of(path: Option<PathBuf>) -> Self {
        Self {
            path,
            part: Part::Window,
        }
    }
}

/// How much of the window is in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    #[default]
    Window,
    /// The open plot or table.
    Plot,
}

/// Where the open plot or table is \[pixels\]; empty while the drawer is shut.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct PlotArea(pub URect);

/// The image that is rendered instead of a window.
#[derive(Resource, Clone, Debug)]
pub struct OffscreenTarget(pub Handle<Image>);

/// Takes the picture that was asked for.
pub fn take_screenshot(
    request: Option<Res<ScreenshotRequest>>,
    offscreen: Option<Res<OffscreenTarget>>,
    plot: Res<PlotArea>,
    mut session: ResMut<Session>,
    mut pending: ResMut<PendingPictures>,
    mut commands: Commands,
) {
    let Some(request) = request else {
        return;
    };
    let (name, area) = match request.part {
        Part::Window => ("box_game", None),
        Part::Plot => ("plot", Some(plot.0)),
    };
    let path = request.path.clone().or_else(|| {
        (1..10_000)
            .map(|n| PathBuf::from(format!("{name}-{n:02}.png")))
            .find(|p| !p.exists())
    });
    // Who named the file knows of it; a strip about it would be in the next picture.
    let named = request.path.is_some();
    commands.remove_resource::<ScreenshotRequest>();
    let Some(path) = path else {
        session.notice(format!(
            "no free name for a picture: {name}-01.png to -9999.png are taken"
        ));
        return;
    };
    if area.is_some_and(|area| area.is_empty()) {
        session.notice("no plot is open: M opens them");
        return;
    }
    pending.0 += 1;
    commands
        .spawn(Screenshot(source(offscreen.as_deref())))
        .observe(
            move |captured: On<ScreenshotCaptured>,
                  mut session: ResMut<Session>,
                  mut pending: ResMut<PendingPictures>| {
                pending.0 = pending.0.saturating_sub(1);
                match save(&captured.image, area, &path) {
                    Ok(()) if named => info!("picture: {}", path.display()),
                    Ok(()) => session.notice(format!("picture: {}", path.display())),
                    Err(error) => session.notice(format!("picture {}: {error}", path.display())),
                }
            },
        );
}

/// What is drawn into: the window, or the image instead of it.
pub fn source(offscreen: Option<&OffscreenTarget>) -> RenderTarget {
    match offscreen {
        Some(target) => RenderTarget::Image(target.0.clone().into()),
        None => RenderTarget::Window(WindowRef::Primary),
    }
}

/// Writes a PNG beside its place and moves it there, so that nobody sees half a picture.
fn save(image: &Image, area: Option<URect>, path: &Path) -> io::Result<()> {
    let mut picture = image.clone().try_into_dynamic().map_err(io::Error::other)?;
    if let Some(URect { min, max }) = area {
        picture = picture.crop_imm(min.x, min.y, max.x - min.x, max.y - min.y);
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let file = tempfile::Builder::new()
        .suffix(".png")
        .tempfile_in(folder.unwrap_or(Path::new(".")))?;
    // The window's alpha says nothing.
    picture
        .to_rgb8()
        .save(file.path())
        .map_err(io::Error::other)?;
    readable(file.path())?;
    file.persist(path)?;
    Ok(())
}

/// Lets everybody read what a temporary file kept to its owner.
pub(crate) fn readable(path: &Path) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))?;
    }
    let _ = path;
    Ok(())
}
