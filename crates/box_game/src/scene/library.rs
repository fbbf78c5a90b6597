//! The scenes to choose from: built in, and in files that are watched while the game runs.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use box_scenarios::{Scenario, scene_file};

use super::session::Session;
use super::start::open_scene;
use crate::action::Action;
use crate::platform::{self, Stamp};

/// Interval between checks of the files [s of real time].
const INTERVAL: f64 = 0.5;
/// Maximum number of files listed; a folder of thousands is a mistake.
const MAX_FILES: usize = 200;

/// All available scenes.
#[derive(Resource, Debug, Default)]
pub struct SceneLibrary {
    folder: PathBuf,
    /// The file named on the command line, in any folder.
    opened: Option<PathBuf>,
    files: Vec<SceneFile>,
    menu: Vec<Scenario>,
    looked: Option<f64>,
}

/// Summary of a scene: the first sentence of its lesson; may be empty.
pub fn watch(scene: &Scenario) -> &'static str {
    // An initial ends no sentence.
    let word = |end: usize| scene.lesson[..end].rsplit(' ').next().unwrap_or_default();
    let mut ends = scene.lesson.match_indices(". ").map(|(at, _)| at);
    let end = ends.find(|&at| word(at).chars().count() > 1);
    end.map_or(scene.lesson, |at| &scene.lesson[..=at])
}

/// A file and its last content.
#[derive(Debug, Default)]
struct SceneFile {
    path: PathBuf,
    stamp: Option<Stamp>,
    /// The last good content.
    scene: Option<Scenario>,
    error: Option<String>,
}

impl SceneFile {
    fn has(&self, id: &str) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.id == id)
    }
}

impl SceneLibrary {
    /// The built-in scenes, the files of `folder` (which need not exist) and `opened`.
    pub fn new(folder: impl Into<PathBuf>, opened: Option<PathBuf>) -> Self {
        let mut library = Self {
            folder: folder.into(),
            opened,
            ..Self::default()
        };
        library.refresh();
        library
    }

    /// The files of `assets/scenes`.
    pub fn shipped(opened: Option<PathBuf>) -> Self {
        Self::new(platform::scene_folder(), opened)
    }

    /// Every scene, in the order of the menu: built-in ones first.
    pub fn scenes(&self) -> &[Scenario] {
        &self.menu
    }

    /// The scene with this id, built in or from a file; or the file at this path.
    ///
    /// # Errors
    /// A sentence that lists the scenes, or names the error in the file.
    pub fn find(&self, text: &str) -> Result<Scenario, String> {
        let named = |f: &&SceneFile| f.has(text) || f.path == Path::new(text);
        let file = self.files.iter().find(named);
        let scene = file.and_then(|f| f.scene.clone());
        scene.map_or_else(|| open(text), Ok)
    }

    /// The path of the file with the scene of this id, if it is not built in.
    pub fn path_of(&self, id: &str) -> Option<String> {
        let file = self.files.iter().find(|f| f.has(id))?;
        Some(file.path.display().to_string())
    }

    /// Errors in the files, one line each.
    pub fn errors(&self) -> Vec<String> {
        self.files.iter().filter_map(|f| f.error.clone()).collect()
    }

    /// Reads every changed file. Returns the ids of the scenes whose content changed.
    pub fn refresh(&mut self) -> Vec<&'static str> {
        let mut paths = platform::list(&self.folder);
        paths.retain(|path| path.extension().is_some_and(|e| e == "ron"));
        paths.sort();
        paths.truncate(MAX_FILES);
        let listed = |path: &PathBuf| paths.iter().any(|p| same_file(p, path));
        if let Some(opened) = self.opened.clone().filter(|o| !listed(o)) {
            paths.push(opened);
        }
        self.files.retain(|f| paths.contains(&f.path));
        let mut changed = Vec::new();
        for path in paths {
            let stamp = platform::stamp(&path);
            let known = self.files.iter().position(|f| f.path == path);
            if known.is_some_and(|k| self.files[k].stamp == stamp) {
                continue;
            }
            let read = self.read(&path);
            let at = known.unwrap_or(self.files.len());
            if known.is_none() {
                self.files.push(SceneFile {
                    path,
                    ..SceneFile::default()
                });
            }
            let file = &mut self.files[at];
            file.stamp = stamp;
            match read {
                Ok(scene) => {
                    file.error = None;
                    if file.scene.as_ref() != Some(&scene) {
                        changed.push(scene.id);
                        file.scene = Some(scene);
                    }
                }
                // The last good scene stays.
                Err(error) => file.error = Some(error),
            }
        }
        let built_in = Scenario::ALL.iter().map(|build| build());
        let from_files = self.files.iter().filter_map(|f| f.scene.clone());
        self.menu = built_in.chain(from_files).collect();
        changed
    }

    fn read(&self, path: &Path) -> Result<Scenario, String> {
        let scene = load(path)?;
        let other = |f: &SceneFile| f.path != path && f.has(scene.id);
        if Scenario::ids().contains(&scene.id) || self.files.iter().any(other) {
            let (file, id) = (path.display(), scene.id);
            return Err(format!(
                "{file}: id: '{id}' is already the id of another scene"
            ));
        }
        Ok(scene)
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The scene with this id, or in the file at this path (which ends in `.ron`).
///
/// # Errors
/// A sentence that lists the scenes, or names the error in the file.
pub fn open(text: &str) -> Result<Scenario, String> {
    if let Some(path) = file_path(text) {
        load(&path)
    } else {
        Scenario::find(text).map_err(|e| format!("{e}; or the path of a scene file (.ron)"))
    }
}

fn load(path: &Path) -> Result<Scenario, String> {
    let bytes = platform::read(path, scene_file::MAX_BYTES + 1);
    let bytes = bytes.map_err(|error| format!("{}: {error}", path.display()))?;
    scene_file::from_bytes(path, &bytes).map_err(|error| error.to_string())
}

/// The path, if `text` names a file and not a scene.
pub fn file_path(text: &str) -> Option<PathBuf> {
    platform::with_extension(text, "ron")
}

/// Opens the chosen scene.
pub fn on_action(
    action: On<Action>,
    library: Res<SceneLibrary>,
    session: Res<Session>,
    mut commands: Commands,
) {
    let neighbor = |by: isize| {
        let scenes = library.scenes();
        let playing = session.scenario.id;
        let at = scenes.iter().position(|s| s.id == playing).unwrap_or(0);
        let next = (at as isize + by).rem_euclid(scenes.len() as isize);
        Ok(scenes[next as usize].clone())
    };
    let scene = match &*action {
        Action::SelectScene(id) => library.find(id),
        Action::NextScene => neighbor(1),
        Action::PreviousScene => neighbor(-1),
        _ => return,
    };
    commands.queue(move |world: &mut World| match scene {
        Ok(scene) => open_scene(world, scene, true),
        Err(error) => world.resource_mut::<Session>().notice(error),
    });
}

/// Reads changed files; a changed scene that is being played restarts.
pub fn watch_scenes(world: &mut World) {
    let now = world.resource::<Time<Real>>().elapsed_secs_f64();
    let mut library = world.resource_mut::<SceneLibrary>();
    if library.looked.is_some_and(|then| now - then < INTERVAL) {
        return;
    }
    let first = library.looked.replace(now).is_none();
    let before = library.errors();
    let changed = library.refresh();
    let errors = library.errors();
    let playing = world.resource::<Session>().scenario.id;
    let again = world.resource::<SceneLibrary>().find(playing);
    if let Some(scene) = again.ok().filter(|scene| changed.contains(&scene.id)) {
        let title = scene.title;
        open_scene(world, scene, false);
        let mut session = world.resource_mut::<Session>();
        session.notice(format!("{title}: reloaded"));
    }
    let mut session = world.resource_mut::<Session>();
    for error in errors.iter().filter(|e| first || !before.contains(e)) {
        session.notice(error);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(id: &str, mass: f64) -> String {
        format!(
            "(id: \"{id}\", title: \"T\", duration: 5, body: (half_extents: (1, 1, 1), mass: {mass}))"
        )
    }

    #[test]
    fn files_come_change_break_and_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mine.ron");
        let mut library = SceneLibrary::new(folder.path(), None);
        let built_in = library.scenes().len();
        assert_eq!(built_in, Scenario::ALL.len());
        std::fs::write(&path, scene("mine", 2.0)).expect("writable");
        assert_eq!(library.refresh(), ["mine"]);
        assert_eq!(library.scenes().len(), built_in + 1);
        assert!(library.refresh().is_empty(), "nothing changed");
        // Broken: the last good one stays, and the error has the line.
        std::fs::write(&path, scene("mine", -1.0)).expect("writable");
        assert!(library.refresh().is_empty());
        let error = &library.errors()[0];
        assert!(error.contains("mine.ron:1:") && error.contains("mass"));
        assert_eq!(library.find("mine").expect("kept").setup.body.mass(), 2.0);
        std::fs::write(&path, scene("mine", 33.0)).expect("writable");
        assert_eq!(library.refresh(), ["mine"]);
        assert!(library.errors().is_empty());
        assert_eq!(library.find("mine").expect("new").setup.body.mass(), 33.0);
        // A built-in scene's id is taken.
        std::fs::write(folder.path().join("b.ron"), scene("bounce", 1.0)).expect("writable");
        library.refresh();
        assert!(library.errors()[0].contains("'bounce'"));
        std::fs::remove_file(&path).expect("there");
        library.refresh();
        assert!(library.find("mine").is_err());
        let error = library.find("moon").expect_err("none");
        assert!(error.contains("dzhanibekov"), "{error}");
        assert!(error.contains(".ron"), "{error}");
    }

    #[test]
    fn an_opened_file_is_listed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ron");
        std::fs::write(&path, scene("a", 1.0)).expect("writable");
        let inside = SceneLibrary::new(folder.path(), Some(path.clone()));
        assert_eq!(inside.files.len(), 1);
        let outside = SceneLibrary::new("/nowhere", Some(path.clone()));
        assert_eq!(outside.files.len(), 1);
        assert!(outside.find("a").is_ok());
        assert!(outside.find(&path.display().to_string()).is_ok());
    }
}
