//! A results file with the shapes of its bodies, for all that comes after a run.

use std::path::{Path, PathBuf};

use results::{BodyMetadata, FileError, MeshProperties, Results, Shapes};
use sealed::{Format, SealedError, SealedFile};

use super::{hash, of_body_file};
use crate::files::scene_file;
use crate::rows::columns::COLUMNS;

/// A results file, and the shapes of its bodies.
#[derive(Debug)]
pub(crate) struct Drawn {
    pub results: Results,
    /// One for each body.
    pub bodies: Vec<DrawnBody>,
}

/// A body as it is drawn.
#[derive(Debug)]
pub(crate) struct DrawnBody {
    /// On the surface, or on all nodes; `None` where the file of an older version has none of a rigid body.
    pub shapes: Option<Shapes>,
    /// Elements, where the whole volume was asked for: corners, then mid-edges 01 12 02 03 23 13.
    pub tetrahedra: Vec<[u32; 10]>,
    /// The body file that the shapes come from, if they do not come from the results file.
    pub body_file: Option<PathBuf>,
}

/// How much of a body is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// The surface, which the results file carries unless it is too large.
    Surface,
    /// The elements, which are in the body file alone.
    Volume,
}

/// A body that cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum DrawnError {
    /// The results file cannot be read.
    #[error("{0}")]
    File(#[from] FileError),
    /// The body file cannot be read.
    #[error("{0}")]
    BodyFile(#[from] SealedError),
    /// The results file does not have the shapes, and the body file is not there. `what`: the part that it lacks;
    /// `places`: where the body file was looked for.
    #[error(
        "{}: {what}, and the body file with them is not there: looked for {}\n = put it there, or make it: flexframe reduce {scene} --stress -o {}",
        results.display(),
        places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(" and "),
        places.last().unwrap_or(results).display()
    )]
    NoBodyFile { results: PathBuf, what: &'static str, places: Vec<PathBuf>, scene: String },
    /// The body file is that of another body.
    #[error(
        "{}: this body file does not have the shapes of the run in {} (another mesh, other modes, or another machine); make it of the scene of the run: flexframe reduce {scene} --stress -o {}",
        body_file.display(),
        results.display(),
        body_file.display()
    )]
    OtherBody { results: PathBuf, body_file: PathBuf, scene: String },
}

impl Drawn {
    /// Reads a results file, finished or not, and the shapes of its bodies from there, or from the body files that it names.
    ///
    /// # Errors
    /// [`DrawnError`].
    pub fn open(file: &Path, part: Part) -> Result<Self, DrawnError> {
        let (results, carried) = Results::open_with_shapes(file, &COLUMNS)?;
        let bodies = results.metadata.bodies.iter().zip(carried);
        let scene = |body: &BodyMetadata| match results.metadata.only_body() {
            Some(_) => results.metadata.scene_file.clone(),
            None => format!("{} --body {}", results.metadata.scene_file, body.name),
        };
        let bodies = bodies.map(|(body, carried)| DrawnBody::of(file, part, body, carried, || scene(body)));
        let bodies = bodies.collect::<Result<_, _>>()?;
        Ok(Self { results, bodies })
    }
}

impl DrawnBody {
    fn of(
        file: &Path,
        part: Part,
        body: &BodyMetadata,
        carried: Option<Shapes>,
        scene: impl Fn() -> String,
    ) -> Result<Self, DrawnError> {
        let mesh = body.model.mesh.as_ref().filter(|mesh| !mesh.body_file.is_empty());
        let from_body_file = match (part, mesh) {
            (Part::Volume, Some(mesh)) => Some((mesh, "it has the surface of the body, and not its inside")),
            (Part::Surface, Some(mesh)) if carried.is_none() => {
                Some((mesh, "its body has more shapes than a results file carries"))
            }
            _ => None,
        };
        let Some((mesh, what)) = from_body_file else {
            return Ok(Self { shapes: carried, tetrahedra: Vec::new(), body_file: None });
        };
        let places = body_files(file, mesh);
        let Some(found) = places.iter().find(|place| place.exists()).cloned() else {
            return Err(DrawnError::NoBodyFile { results: file.to_owned(), what, places, scene: scene() });
        };
        let body_file = SealedFile::open(&found, Format::BODY)?;
        if hash::of_file(&body_file).as_ref() != Some(&mesh.shapes_hash) {
            return Err(DrawnError::OtherBody { results: file.to_owned(), body_file: found, scene: scene() });
        }
        let (shapes, tetrahedra) = of_body_file::read(&body_file, part == Part::Volume)?;
        Ok(Self { shapes: Some(shapes), tetrahedra, body_file: Some(found) })
    }
}

/// Where the body file of a results file may be: where it was, and beside the results file. Nowhere for a body of which none
/// is made.
pub(crate) fn body_files(file: &Path, mesh: &MeshProperties) -> Vec<PathBuf> {
    if mesh.body_file.is_empty() {
        return Vec::new();
    }
    let named = scene_file::to_path(&mesh.body_file);
    let beside = file.with_file_name(named.file_name().unwrap_or_default());
    if named.is_absolute() && named != beside { vec![named, beside] } else { vec![beside] }
}
