//! The page of all columns of a results file, made of the table that results files are written by.

use flexframe::columns::COLUMNS;
use results::{Column, Components, Scope};

use super::is_made;

#[test]
fn the_page_of_columns_is_what_results_have() {
    let mut page = "# All columns of a results file\n\nMade of the table that results files are written by, by `./dev reference`. \
         [The results file](results.md) says which are there, and what the letters of the shapes are.\n\n\
         | data set | shape | unit | frame | what |\n|---|---|---|---|---|\n"
        .to_owned();
    for column in &COLUMNS {
        let (group, places) = match column.scope() {
            Scope::System => ("system/", ""),
            Scope::Body => ("", ""),
            Scope::Point => ("", "×P"),
            Scope::Support => ("", "×S"),
            Scope::Joint => ("joints/NAME/", ""),
        };
        let values = match column.components() {
            Components::Number => String::new(),
            Components::Modes => "×nf".to_owned(),
            other => format!("×{}", other.names().len()),
        };
        let Column { dimension, frame, description, .. } = column;
        let (path, unit) = (column.path(), dimension.unit());
        page += &format!("| `{group}{path}` | T{places}{values} | {unit} | {frame} | {description} |\n");
    }
    is_made("docs/reference/columns.md", &page);
}
