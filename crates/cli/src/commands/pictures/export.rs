//! `flexframe export`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::export::{self, DrawnMotion, ExportRows, Exported};
use flexframe::given_file::GivenFile;
use flexframe::run::RunProgress;

use crate::arguments::FileArgs;
use crate::arguments::values::finite;
use crate::output;
use crate::session::{RESULTS, Session};

/// Write a results file, finished or not, as a table, or as fields for ParaView.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true).multiple(true))]
pub struct Export {
    /// The results file, such as out/plate/plate.h5, or the unfinished one of a run.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Table of the columns, with units in the heads: a file that ends in .csv, a folder, or - for standard output.
    #[arg(long, value_name = "FILE|DIR", group = "what")]
    csv: Option<PathBuf>,
    /// Columns of the table, or beginnings of their paths, such as energy,points/P1 [default: all].
    #[arg(long, value_name = "PATH,…", value_delimiter = ',', requires = "csv")]
    columns: Vec<String>,
    /// The moving body for ParaView 5.12 and later: one file with the mesh and a step for each row.
    #[arg(long, value_name = "FILE", group = "what")]
    vtkhdf: Option<PathBuf>,
    /// The same for older versions: a folder with a PVD file and a VTU file for each row.
    #[arg(long, value_name = "DIR", group = "what")]
    vtu: Option<PathBuf>,
    /// Shapes of the modes and static shapes, a field each, in one VTKHDF file.
    #[arg(long, value_name = "FILE", group = "what")]
    modes: Option<PathBuf>,
    /// The whole volume (quadratic tetrahedra) instead of the surface (triangles), from the body file beside the results file.
    #[arg(long)]
    volume: bool,
    /// First time.
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Last time.
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    to: Option<f64>,
    /// Write every N-th row.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    #[command(flatten)]
    files: FileArgs,
}

impl Export {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { file, csv, columns, vtkhdf, vtu, modes, volume, from, to, every, files } = self;
        GivenFile::expect(&file, &[GivenFile::Results], RESULTS)?;
        output::require_file("--vtkhdf", vtkhdf.as_deref())?;
        output::require_file("--vtu", vtu.as_deref())?;
        output::require_file("--modes", modes.as_deref())?;
        let rows =
            ExportRows { from, to, every: usize::try_from(every).unwrap_or(usize::MAX), overwrite: files.overwrite };
        let mut done = Vec::new();
        let to_standard = csv.as_deref().is_some_and(output::is_standard);
        if to_standard {
            let (table, warning) = export::csv_text(&file, &columns, &rows)?;
            output::doubts(warning);
            output::text(&table)?;
        }
        if let Some(csv) = csv.filter(|_| !to_standard) {
            done.push(export::export_csv(&file, &csv, &columns, &rows)?);
        }
        if vtkhdf.is_some() || vtu.is_some() || modes.is_some() {
            let motion = DrawnMotion::open(&file, volume)?;
            let mut moved = |part: f64| session.bar.run(RunProgress::Motion(part));
            if let Some(vtkhdf) = vtkhdf {
                done.push(export::export_vtkhdf(&file, &motion, &vtkhdf, &rows, &mut moved)?);
            }
            if let Some(vtu) = vtu {
                done.push(export::export_vtu(&file, &motion, &vtu, &rows, &mut moved)?);
            }
            if let Some(modes) = modes {
                done.push(export::export_modes(&file, &motion, &modes, &rows)?);
            }
        }
        drop(session.bar);
        for Exported { files, warning } in done {
            output::list(&files)?;
            output::warn(warning.as_deref())?;
        }
        Ok(())
    }
}
