//! `flexframe new`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::new_scene;

use crate::arguments::FileArgs;
use crate::arguments::values::positive;
use crate::output;
use crate::session::Session;

/// Write a first scene of a mesh, with comments, that runs as it is.
#[derive(Debug, Args)]
pub struct New {
    /// The mesh file.
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// The scene file to write, or - for standard output [default: the mesh file's name with .toml].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Largest size of an element, where geometry is meshed.
    #[arg(long, value_name = "SIZE", value_parser = positive)]
    mesh_size: Option<f64>,
    /// Give first-order elements a node in the middle of each edge.
    #[arg(long)]
    raise_order: bool,
    #[command(flatten)]
    files: FileArgs,
}

impl New {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { mesh, output, mesh_size, raise_order, files } = self;
        let settings = new_scene::ImportSettings {
            mesh_size,
            raise_order,
            trust_geometry: session.builder.trust_geometry,
            hides_lines: false,
        };
        GivenFile::expect(&mesh, &[GivenFile::Mesh], "a mesh or geometry")?;
        if output.as_deref().is_some_and(output::is_standard) {
            let (scene, notes) = new_scene::scene_text(&mesh, &settings)?;
            output::doubts(notes);
            return output::text(&scene);
        }
        let (scene, notes) = new_scene::new_scene(&mesh, &settings, output.as_deref(), files.overwrite)?;
        output::list(&[scene])?;
        notes.iter().try_for_each(|note| output::warn(Some(note)))
    }
}
