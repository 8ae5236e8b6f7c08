//! Writes results files into the folder that is named: seeds for the target `results`.

use std::path::PathBuf;

use flexframe_fuzz::write_results;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("name a folder")?);
    std::fs::create_dir_all(&folder)?;
    write_results(&folder.join("rigid.h5"), 1, [0, 0], 1, true)?;
    write_results(&folder.join("empty.h5"), 1, [2, 1], 0, true)?;
    write_results(&folder.join("short.h5"), 1, [2, 1], 3, true)?;
    write_results(&folder.join("unfinished.h5"), 1, [1, 2], 2, false)?;
    write_results(&folder.join("several.h5"), 3, [1, 1], 2, true)?;
    Ok(())
}
