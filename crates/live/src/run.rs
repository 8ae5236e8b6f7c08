//! The run of a page as data.

use dynamics::{DescriptionError, RunDescription};
use serde::{Deserialize, Serialize};

use crate::error::LiveError;

/// The motions of a run, and which bodies of the page they move.
#[derive(Debug, Clone)]
pub struct LiveRun {
    /// The motions: each of an island.
    pub motions: Vec<LiveMotion>,
}

/// A motion of its own.
#[derive(Debug, Clone)]
pub struct LiveMotion {
    /// All that it begins with.
    pub run: RunDescription,
    /// Numbers of its bodies on the page, in the order of the run.
    pub bodies: Vec<usize>,
}

/// A motion in the data: its bodies, and the bytes of its description, which has a version of its own.
#[derive(Serialize, Deserialize)]
struct Part {
    bodies: Vec<usize>,
    run: Vec<u8>,
}

impl LiveRun {
    /// As bytes.
    ///
    /// # Errors
    /// [`LiveError::Description`] for a part that is code of one's own.
    pub fn to_bytes(&self) -> Result<Vec<u8>, LiveError> {
        let part = |motion: &LiveMotion| Ok(Part { bodies: motion.bodies.clone(), run: motion.run.to_bytes()? });
        let parts = self.motions.iter().map(part).collect::<Result<Vec<_>, DescriptionError>>()?;
        Ok(postcard::to_allocvec(&parts).map_err(DescriptionError::from)?)
    }

    /// The run of [`Self::to_bytes`].
    ///
    /// # Errors
    /// [`LiveError::Description`], [`LiveError::Bodies`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LiveError> {
        let parts: Vec<Part> = postcard::from_bytes(bytes).map_err(|_| DescriptionError::Other)?;
        let motion = |part: Part| {
            Ok::<_, LiveError>(LiveMotion { run: RunDescription::from_bytes(&part.run)?, bodies: part.bodies })
        };
        let run = Self { motions: parts.into_iter().map(motion).collect::<Result<_, _>>()? };
        run.check()?;
        Ok(run)
    }

    /// Number of bodies of all motions.
    pub fn bodies(&self) -> usize {
        self.motions.iter().map(|motion| motion.run.bodies.len()).sum()
    }

    /// Where a body of the page is: the number of its motion, and its own in that.
    pub(crate) fn place_of(&self, body: usize) -> Option<[usize; 2]> {
        let place = |(m, motion): (usize, &LiveMotion)| Some([m, motion.bodies.iter().position(|of| *of == body)?]);
        self.motions.iter().enumerate().find_map(place)
    }

    /// Refuses bodies that are moved twice, or not at all.
    pub(crate) fn check(&self) -> Result<(), LiveError> {
        for body in 0..self.bodies() {
            let times = self.motions.iter().flat_map(|motion| &motion.bodies).filter(|of| **of == body).count();
            if times != 1 {
                return Err(LiveError::Bodies { body, times });
            }
        }
        match self.motions.iter().find(|motion| motion.bodies.len() != motion.run.bodies.len()) {
            Some(motion) => Err(LiveError::Bodies { body: motion.bodies.len(), times: 0 }),
            None => Ok(()),
        }
    }
}
