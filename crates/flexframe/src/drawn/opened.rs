//! A results file with the shapes of its bodies, for all that comes after a run.

use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use results::{BodyMetadata, MeshProperties, Results, Shapes};
use sealed::{Format, SealedFile};

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

impl Drawn {
    /// Reads a results file, finished or not, and the shapes of its bodies from there, or from the body files that it names.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn open(file: &Path, part: Part) -> Result<Self, Failure> {
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
    ) -> Result<Self, Failure> {
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
            let shown: Vec<String> = places.iter().map(|place| place.display().to_string()).collect();
            let last = places.last().map_or(file, PathBuf::as_path).display();
            let help = format!("put it there, or make it: flexframe reduce {} --stress -o {last}", scene());
            let words = format!("{what}, and the body file with them is not there: looked for {}", shown.join(" and "));
            return Err(Kind::Input.of(file).help(help).says(words));
        };
        let body_file = SealedFile::open(&found, Format::BODY)?;
        if hash::of_file(&body_file).as_ref() != Some(&mesh.shapes_hash) {
            let help = format!(
                "make it of the scene of the run: flexframe reduce {} --stress -o {}",
                scene(),
                found.display()
            );
            let words = format!(
                "this body file does not have the shapes of the run in {} (another mesh, other modes, or another machine)",
                file.display()
            );
            return Err(Kind::Input.of(&found).help(help).says(words));
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
