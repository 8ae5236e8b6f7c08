//! The hash by which a body file is known to have the shapes of a run.

use faer::MatRef;
use keys::{Digest, Hash};
use model::Meshed;
use sealed::SealedFile;

/// The datasets of a body file that are hashed.
const DATASETS: [&str; 2] = ["modes/shapes", "static_shapes/shapes"];

/// The hash of the shapes on all nodes, in hexadecimal digits.
pub(super) fn of_model(meshed: &Meshed) -> String {
    let modes = &meshed.modes;
    let (natural, all) = (modes.natural(), modes.shapes.ncols());
    let parts = [modes.shapes.subcols(0, natural), modes.shapes.subcols(natural, all - natural)];
    digest(parts.map(of_columns))
}

/// The same of a body file, from its head; `None` where it has no shapes.
pub(super) fn of_file(file: &SealedFile) -> Option<String> {
    let hash = |dataset: &str| file.described(dataset)?.2?.parse::<Hash>().ok();
    Some(digest([hash(DATASETS[0])?, hash(DATASETS[1])?]))
}

fn digest(parts: [Hash; 2]) -> String {
    parts.iter().fold(Digest::new(), |digest, part| digest.hash(part)).finish().to_string()
}

/// The hash of a matrix, column by column.
fn of_columns(matrix: MatRef<'_, f64>) -> Hash {
    Hash::of_lists(matrix.col_iter().map(|column| match column.try_as_col_major() {
        Some(column) => column.as_slice().into(),
        None => column.iter().copied().collect::<Vec<f64>>().into(),
    }))
}
