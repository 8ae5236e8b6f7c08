//! Reduced bodies in the files of other programs: the ending of a file names its form.

mod craig_bampton;
mod flex42;
mod gltf;
mod interface;
mod mbdyn;
mod op2;
mod op4;
mod reduced;
mod sid;

use std::path::Path;

use diagnostic::Failure;
use model::{BuildProgress, Builder, Model};
use report::Report;
use scene::Body;
use whole_file::{Written, write_whole};

use craig_bampton::matrices;
pub use reduced::Reduced;

use crate::commands::modes;
use crate::files::write_error::WriteError;

/// Forms of other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// OP4 of Nastran: mass, stiffness and damping matrices of the base, or of the markers of a free body, and the modes, as Craig–Bampton has
    /// them.
    Op4,
    /// The same in OP2 of Nastran.
    Op2,
    /// File of MBDyn's modal joint.
    Mbdyn,
    /// Flex file of NASA's 42.
    Flex42,
    /// Standard Input Data, of SIMPACK and Modelica.
    Sid,
    /// glTF with a moving surface, for pictures.
    Gltf,
}

impl Form {
    const ALL: [Self; 6] = [Self::Op4, Self::Op2, Self::Mbdyn, Self::Flex42, Self::Sid, Self::Gltf];

    /// The form that the ending of a file names; none for any other file.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|form| form.written().endings().contains(&ending.as_str()))
    }

    /// The kind of file.
    pub fn written(self) -> Written {
        match self {
            Self::Op4 => Written::OP4,
            Self::Op2 => Written::OP2,
            Self::Mbdyn => Written::MBDYN,
            Self::Flex42 => Written::FLEX,
            Self::Sid => Written::SID,
            Self::Gltf => Written::GLTF,
        }
    }
}

/// Reduces a scene's body as a run of it asks for, and writes it in the form of another program, with its points of the output and its
/// markers as nodes.
///
/// # Errors
/// [`Failure`].
pub fn hand_over(
    body: &Body,
    builder: &Builder,
    form: Form,
    path: &Path,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let model = builder.build(body, progress)?;
    let notes = write(body, &model, form, path)?;
    let mut report = modes::report(body, &model, None);
    report.warnings.extend(notes);
    Ok(report)
}

/// Writes the file, where its form holds what the body is about. Notes where its coordinates are others than markers ask for, and where turns
/// are not known.
fn write(given: &Body, model: &Model, form: Form, path: &Path) -> Result<Vec<String>, Failure> {
    let is_bent = model.meshed.as_ref().is_some_and(|meshed| meshed.reference.is_some());
    if is_bent && matches!(form, Form::Mbdyn | Form::Flex42 | Form::Sid) {
        let found = "modes about a bent rest, whose internal forces this form does not hold: its loads would bend the body a second time";
        let help = "remove `about`; the matrices of .op4 and .op2 are those of vibrations about the rest";
        return Err(given.refuse("modes.about", found, "modes about the undeformed body", help).into());
    }
    let mut of_turns = None;
    let mut body = || {
        let body = Reduced::new(given, model)?;
        of_turns = without_turns(&body.nodes_without_turns);
        Ok::<_, Failure>(body)
    };
    let mut of_markers = None;
    let mut named = |body: &Reduced<'_>| {
        let (matrices, note) = matrices(body);
        of_markers = note;
        matrices
    };
    let bytes = match form {
        Form::Gltf => gltf::bytes(given, model)?,
        Form::Op4 => op4::text(&named(&body()?)).into_bytes(),
        Form::Op2 => op2::bytes(&named(&body()?)),
        Form::Mbdyn => mbdyn::text(&body()?).into_bytes(),
        Form::Flex42 => flex42::text(&body()?).into_bytes(),
        Form::Sid => sid::text(&body()?).into_bytes(),
    };
    write_whole(path, bytes).map_err(WriteError::of(path))?;
    Ok(of_markers.into_iter().chain(of_turns).collect())
}

/// A sentence on nodes of the file whose turns in the modes are not known.
fn without_turns(nodes: &[&str]) -> Option<String> {
    (!nodes.is_empty()).then(|| {
        format!(
            "the nodes at {} do not tell how the material there turns: in the file it turns as the base does, and in no mode",
            nodes.join(", ")
        )
    })
}
