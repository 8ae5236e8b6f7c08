//! The cache: a folder in which values of the finite-element side of a body are kept from run to run.
//!
//! Each is a file of its own ([`sealed`]), `PROGRAM/MESH/KEY.kept`, named by hashes of all that it follows from: the program
//! and the machine, the bytes of the mesh file, and what the value is, with the material, the support and what else it is made
//! of. A file is never changed: it appears whole, and is checked when it is read. So any number of programs may use the folder
//! at once, and what has changed is not found.

pub(crate) mod kept;
pub(crate) mod store;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use keys::{Hash, Key};

/// Bytes that the user's cache may have.
const LIMIT: u64 = 4 << 30;
/// The folder of flexframe in that of the caches.
const NAME: &str = "flexframe";
/// Digits of the names of folders.
const PROGRAM_DIGITS: usize = 16;
const MESH_DIGITS: usize = 64;

/// Where values are kept from run to run; nowhere by default. Clones are the same cache.
#[derive(Debug, Clone, Default)]
pub struct Cache(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    folder: Option<PathBuf>,
    limit: u64,
    /// The file of the program, where that is not the one that runs.
    program: Option<PathBuf>,
    /// True if nothing can be written.
    is_closed: AtomicBool,
    /// True if a thread computes.
    computing: Mutex<bool>,
    computed_all: Condvar,
    /// Also of the caches made by [`Cache::elsewhere`].
    notes: Arc<Mutex<CacheNotes>>,
}

/// Counts of the use of a cache.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CacheNotes {
    /// Values that were read.
    pub read: usize,
    /// Values that were computed.
    pub computed: usize,
    /// How often matrices were assembled.
    pub assembled: usize,
    /// Warnings: files that could not be read or written, and other faults of reading that the user should know.
    pub warnings: Vec<String>,
}

impl Cache {
    /// None: nothing is kept.
    pub fn none() -> Self {
        Self::default()
    }

    /// A cache in a folder, which is made if it does not exist, with a limit of its bytes.
    pub fn new(folder: impl Into<PathBuf>, limit: u64) -> Self {
        Self::none().elsewhere(folder, limit)
    }

    /// One in another folder for the same user and program: its notes are those of this one.
    pub fn elsewhere(&self, folder: impl Into<PathBuf>, limit: u64) -> Self {
        let (program, notes) = (self.0.program.clone(), self.0.notes.clone());
        Self(Arc::new(Inner { folder: Some(folder.into()), limit, program, notes, ..Inner::default() }))
    }

    /// The same for the user of a program that is in another file than the one that runs: in a library of Python.
    pub fn of_program(&self, file: impl Into<PathBuf>) -> Self {
        let Inner { folder, limit, notes, .. } = &*self.0;
        let (folder, notes, program) = (folder.clone(), notes.clone(), Some(file.into()));
        Self(Arc::new(Inner { folder, limit: *limit, program, notes, ..Inner::default() }))
    }

    /// The same with notes of its own, for work after that which the user is told of.
    pub(crate) fn with_own_notes(&self) -> Self {
        let Inner { folder, limit, program, .. } = &*self.0;
        let (folder, program) = (folder.clone(), program.clone());
        Self(Arc::new(Inner { folder, limit: *limit, program, ..Inner::default() }))
    }

    /// The user's: the folder `FLEXFRAME_CACHE`, or `flexframe` in `XDG_CACHE_HOME` or in `~/.cache`, with 4 GiB at most. None
    /// where `FLEXFRAME_CACHE` is empty, or no folder is known.
    pub fn of_user() -> Self {
        let variable = |name: &str| std::env::var_os(name).map(PathBuf::from);
        let absolute = |name: &str| variable(name).filter(|folder| folder.is_absolute());
        let folder = match variable("FLEXFRAME_CACHE") {
            Some(folder) if folder.as_os_str().is_empty() => None,
            Some(folder) => Some(folder),
            None => absolute("XDG_CACHE_HOME")
                .or_else(|| absolute("HOME").map(|home| home.join(".cache")))
                .map(|caches| caches.join(NAME)),
        };
        folder.map_or_else(Self::none, |folder| Self::new(folder, LIMIT))
    }

    /// Its folder.
    pub fn folder(&self) -> Option<&Path> {
        self.0.folder.as_deref()
    }

    /// Counts of its use up to now.
    pub fn notes(&self) -> CacheNotes {
        self.0.notes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Changes the notes.
    pub(crate) fn note(&self, change: impl FnOnce(&mut CacheNotes)) {
        change(&mut self.0.notes.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// The folder of a mesh, by the hash of its file; made if it does not exist.
    pub(crate) fn of_mesh(&self, mesh: &Hash) -> Option<PathBuf> {
        let folder = self.folder()?.join(program(self.0.program.as_deref())).join(mesh.to_string());
        match whole_file::make_folder(&folder) {
            Ok(()) => Some(folder),
            Err(error) => {
                self.close(&error.to_string());
                None
            }
        }
    }

    /// Says once what is wrong.
    pub(crate) fn warn(&self, warning: String) {
        self.note(|notes| {
            if !notes.warnings.contains(&warning) {
                notes.warnings.push(warning);
            }
        });
    }

    /// Writes no more, where the folder cannot be written.
    pub(crate) fn close(&self, reason: &str) {
        if !self.0.is_closed.swap(true, Ordering::Relaxed) {
            let at = self.folder().unwrap_or(Path::new("")).display();
            self.warn(format!("the cache {at} cannot be written, and what is computed is not kept: {reason}"));
        }
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.0.is_closed.load(Ordering::Relaxed)
    }

    /// Waits until no other thread of this program computes, and keeps the others waiting until it is dropped: several threads
    /// do not compute the same.
    pub(crate) fn computing(&self) -> Computing {
        let computing = self.0.computing.lock().unwrap_or_else(PoisonError::into_inner);
        let computing = self.0.computed_all.wait_while(computing, |computing| *computing);
        *computing.unwrap_or_else(PoisonError::into_inner) = true;
        Computing(self.clone())
    }

    /// Removes the files that were used longest ago until the others are within the limit. Others may do the same at once.
    pub(crate) fn trim(&self) {
        let Some(folder) = self.folder() else { return };
        let mut files = list(folder);
        let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
        files.sort();
        for (_, size, path) in files {
            if bytes <= self.0.limit {
                break;
            }
            let _ = fs::remove_file(&path);
            // Of a mesh of which nothing is left; refused where something is.
            let _ = path.parent().map(fs::remove_dir);
            bytes -= size;
        }
    }
}

/// Only one of the threads that share a cache has this.
#[derive(Debug)]
pub(crate) struct Computing(Cache);

impl Drop for Computing {
    fn drop(&mut self) {
        let Inner { computing, computed_all, .. } = &*self.0.0;
        *computing.lock().unwrap_or_else(PoisonError::into_inner) = false;
        computed_all.notify_one();
    }
}

/// Says that a file was used now. Without the right to it, it will look older than it is.
pub(crate) fn touch(path: &Path) {
    let _ = File::options().append(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// When each file of the cache was used last, its bytes, and its path. Whatever else is in the folder is left alone.
fn list(folder: &Path) -> Vec<(SystemTime, u64, PathBuf)> {
    let mut files = Vec::new();
    for entry in hashed(folder, PROGRAM_DIGITS).iter().flat_map(|program| hashed(program, MESH_DIGITS)) {
        // What is being written has a name with a dot. Links are not followed.
        for entry in entries(&entry).filter(|entry| !entry.file_name().as_encoded_bytes().starts_with(b".")) {
            if let Some(found) = entry.metadata().ok().filter(fs::Metadata::is_file) {
                files.push((found.modified().unwrap_or(UNIX_EPOCH), found.len(), entry.path()));
            }
        }
    }
    files
}

/// The folders in a folder whose names are a given number of hexadecimal digits.
fn hashed(folder: &Path, digits: usize) -> Vec<PathBuf> {
    let is_hash = |name: &str| name.len() == digits && name.bytes().all(|byte| byte.is_ascii_hexdigit());
    entries(folder)
        .filter(|entry| entry.file_name().to_str().is_some_and(is_hash))
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
        .map(|entry| entry.path())
        .collect()
}

fn entries(folder: &Path) -> impl Iterator<Item = fs::DirEntry> {
    fs::read_dir(folder).into_iter().flatten().flatten()
}

/// The program and the machine, whose results are the same to the last bit: the version, the size and the time of the file
/// of the program, and what its processor can do.
fn program(file: Option<&Path>) -> String {
    let file = file.map_or_else(std::env::current_exe, |file| Ok(file.to_owned()));
    let built = file.and_then(fs::metadata).ok();
    let changed = built.as_ref().and_then(|file| file.modified().ok()?.duration_since(UNIX_EPOCH).ok());
    let key = Key::new().of("program", 1).with("version", env!("CARGO_PKG_VERSION"));
    let key = key.with("size", &built.map(|file| file.len()));
    let key = key.with("seconds", &changed.map(|time| time.as_secs()));
    let key = key.with("nanoseconds", &changed.map(|time| time.subsec_nanos()));
    let key = key.with("processor", std::env::consts::ARCH).with("instructions", &features());
    let digits = key.finish().to_string();
    digits[..PROGRAM_DIGITS].to_owned()
}

/// Sets of instructions that faer chooses from: 1 for each that is there.
fn features() -> Vec<u32> {
    #[cfg(target_arch = "x86_64")]
    {
        [is_x86_feature_detected!("avx512f"), is_x86_feature_detected!("avx2"), is_x86_feature_detected!("fma")]
            .map(u32::from)
            .to_vec()
    }
    #[cfg(not(target_arch = "x86_64"))]
    Vec::new()
}
