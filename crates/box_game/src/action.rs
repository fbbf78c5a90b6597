//! Everything a person can ask of the game. Keys, the panel, the command line and scripts all emit
//! these; one system applies them, so a test of an action is a test of every way to trigger it.

use box_physics::prelude::{DVec3, Integrator};

use crate::compare::CompareAction;

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Simulate every box with this scheme from the next step on; the state is carried over.
    SetIntegrator(Integrator),
    /// Stop or resume the clock.
    TogglePause,
    /// This many steps while paused (pauses first).
    Step(u32),
    /// The scene from its start, with the present parameters.
    Restart,
    /// Target speed: simulated seconds per second, 0.01 to 4.
    SetSpeed(f64),
    /// One notch down the speed ladder.
    Slower,
    /// One notch up the speed ladder.
    Faster,
    /// Step size dt \[s\], 1/1920 to 0.5.
    SetStep(f64),
    /// Substeps per step, 1 to 64.
    SetSubsteps(u32),
    /// Gravity, downwards [m/s²].
    SetGravity(f64),
    /// Restitution of the floor, 0 to 1.
    SetRestitution(f64),
    /// Friction of the floor, ≥ 0.
    SetFriction(f64),
    /// Linear drag c₁ [N s/m].
    SetLinearDrag(f64),
    /// Angular damping γ [1/s].
    SetAngularDamping(f64),
    /// Size of the box: half-extents \[m\]. Restarts the scene.
    SetHalfExtents(DVec3),
    /// Mass of the box \[kg\]. Restarts the scene.
    SetMass(f64),
    /// Strength of a push \[N s\].
    SetImpulse(f64),
    /// Number of boxes. Restarts the scene.
    SetBoxes(u32),
    /// Every parameter back to the scene's own.
    ResetParameters,
    /// This scene, by its id.
    SelectScene(String),
    /// The next scene of the list.
    NextScene,
    /// The previous scene of the list.
    PreviousScene,
    /// An impulse on the hero box.
    Push(Push),
    /// Draw the re-fitted bounding boxes.
    ToggleAabb,
    /// Draw contact points, normals and impulses.
    ToggleContacts,
    /// Draw body axes and velocity.
    ToggleAxes,
    /// Start or stop the CSV log.
    ToggleLog,
    /// Save a PNG of the window.
    Screenshot,
    /// Put the hero in the middle of the picture.
    FrameCamera,
    /// The scene's own camera.
    HomeCamera,
    /// Show or hide the list of keys.
    ToggleHelp,
    /// Show or hide the panel; hidden leaves a one-line display.
    TogglePanel,
    /// Show or hide the drawer with the plots.
    TogglePlots,
    /// Choose the plot in the drawer.
    SelectPlot(Plot),
    /// Of the comparison of schemes.
    Compare(CompareAction),
    /// End the program.
    Quit,
}

/// A push along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Direction: a unit vector along ±x, ±y or ±z.
    pub direction: DVec3,
    /// Along the world's axes instead of the box's own.
    pub world: bool,
    /// At the edge of the face instead of its middle, so that it spins.
    pub off_centre: bool,
}

impl Plot {
    /// Every tab with its name on the command line.
    pub const ALL: [(Self, &str); 6] = [
        (Self::Error, "error"),
        (Self::Energy, "energy"),
        (Self::Timing, "timing"),
        (Self::Cpu, "cpu"),
        (Self::WorkPrecision, "work-precision"),
        (Self::Table, "table"),
    ];
}

/// What the drawer shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plot {
    /// Distance and angle to the reference over time.
    Error,
    /// Energy and angular momentum that are not accounted for, over time.
    #[default]
    Energy,
    /// ns per body-step of every scheme over time.
    Timing,
    /// CPU use of the process and the system over time.
    Cpu,
    /// Error against cost.
    WorkPrecision,
    /// The figures of every scheme.
    Table,
}
