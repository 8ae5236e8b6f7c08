//! How a moving picture is made.

use figures::View;

/// An animation has no more frames.
pub const MAX_FRAMES: u64 = 10_000;

/// The coloured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coloured {
    /// Length of the displacement by deformation.
    #[default]
    Displacement,
    /// Von Mises stress.
    Stress,
}

/// How the picture is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnimationSettings {
    /// Number of frames, first and last state among them (two to [`MAX_FRAMES`]).
    pub frames: u64,
    /// Factor on the deformation that is drawn.
    pub magnification: f64,
    /// Time of the first frame; `None` for the start of the run.
    pub from: Option<f64>,
    /// Time of the last frame; `None` for the end of the run.
    pub to: Option<f64>,
    /// From where the body is seen.
    pub view: View,
    /// The coloured quantity.
    pub coloured: Coloured,
}

impl Default for AnimationSettings {
    fn default() -> Self {
        Self {
            frames: 60,
            magnification: 1.0,
            from: None,
            to: None,
            view: View::default(),
            coloured: Coloured::default(),
        }
    }
}
