//! The library that goes into every FMU.

use std::env::consts::{ARCH, DLL_PREFIX, DLL_SUFFIX, OS};
use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use foreign_program::read_at_most;

/// The environment variable that names the library for FMUs.
const LIBRARY_VARIABLE: &str = "FLEXFRAME_FMU_LIBRARY";

/// Bytes that tell which version the library is of. The program has them in it, too: what the library alone has is the name
/// of a function of FMI.
pub const fn marker() -> &'static str {
    concat!("flexframe library for FMI 2.0, version ", env!("CARGO_PKG_VERSION"), ";")
}

/// How a static library begins, such as the `.rlib` that is built beside the library.
const ARCHIVE: &[u8] = b"!<arch>";

/// Where the library is: `asked`, what the environment says, or beside the program.
pub fn library_path(asked: Option<&Path>) -> PathBuf {
    let named = std::env::var_os(LIBRARY_VARIABLE).filter(|name| !name.is_empty()).map(PathBuf::from);
    asked.map(Path::to_owned).or(named).unwrap_or_else(|| {
        let program = std::env::current_exe().unwrap_or_default();
        program.with_file_name(format!("{DLL_PREFIX}flexframe_fmi{DLL_SUFFIX}"))
    })
}

/// More bytes than any library has, also with debugging information.
const LARGEST: u64 = 1 << 30;

/// The library, and the folder and the ending that it gets in an FMU.
pub(super) struct Library {
    pub bytes: Vec<u8>,
    pub folder: &'static str,
    pub ending: &'static str,
}

impl Library {
    /// Reads the library at its [`library_path`].
    pub fn find(asked: Option<&Path>) -> Result<Self, Failure> {
        let folder = match (OS, ARCH) {
            ("linux", "x86_64") => "linux64",
            ("windows", "x86_64") => "win64",
            ("macos", "x86_64") => "darwin64",
            _ => {
                let help = "pack it on 64-bit Linux, Windows or macOS, with a processor of the x86 family";
                return Err(Kind::Refused
                    .alone()
                    .help(help)
                    .says(format!("FMI 2.0 has no name for this machine ({OS}, {ARCH})")));
            }
        };
        let path = library_path(asked);
        let refuse = |found: String| {
            let help = format!(
                "build it (./dev build, or cargo build --release -p fmi), and name it with --library or {LIBRARY_VARIABLE} where it is not \
                 beside the program"
            );
            Kind::Io.of(&path).help(help).says(found)
        };
        let bytes = read_at_most(&path, LARGEST)
            .map_err(|error| refuse(format!("the library for FMUs cannot be read ({error})")))?;
        let has = |text: &str| bytes.windows(text.len()).any(|bytes| bytes == text.as_bytes());
        // Put together here, so that the program does not have the name in it.
        let exported = "fmi2-DoStep".replace('-', "");
        if bytes.starts_with(ARCHIVE) || !has(marker()) || !has(&exported) {
            let version = env!("CARGO_PKG_VERSION");
            return Err(refuse(format!("this is not the library for FMUs of flexframe {version}")));
        }
        Ok(Self { bytes, folder, ending: DLL_SUFFIX })
    }
}
