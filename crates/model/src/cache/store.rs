//! Where the values of the body of a scene are kept from run to run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use keys::{Hash, Key};
use mesh_import::{Imported, MeshFile};
use scene::{Body, MeshedBody};
use sealed::{Array, Declared, Format, Kind, SealedError, SealedFile, Writer};

use crate::body::origin::{ElementKeys, Origin};
use crate::cache::kept::{Arrays, Keep, Kept, group};
use crate::cache::{Cache, touch};
use crate::error::BuildError;
use crate::mesh::arrays::{self, MeshArrays};

/// The name of the file of a mesh.
const MESH: &str = "mesh.kept";

/// The values of one body.
pub(crate) struct Store {
    cache: Cache,
    /// The body file that the scene names.
    given: Option<SealedFile>,
    /// The folder of the mesh in the cache.
    folder: Option<PathBuf>,
    /// The hash of what was read of the mesh, or of the matrices.
    mesh: Hash,
    /// The start of all keys.
    body: Key,
    /// Keys of all that was asked for, for who writes a body file.
    asked: Mutex<BTreeSet<Hash>>,
}

impl Store {
    /// The values of the mesh in a file, or in the body file that the scene names. None where nothing is kept.
    pub fn open(
        cache: &Cache,
        body: &MeshedBody,
        given: Option<SealedFile>,
        file: Option<&MeshFile>,
    ) -> Result<Option<Self>, BuildError> {
        let cache = cache.clone();
        let mesh = match &given {
            Some(file) => Origin::read(file)?.mesh_hash.parse().ok(),
            None if cache.folder().is_none() => return Ok(None),
            None => file.and_then(MeshFile::hash),
        };
        let Some(mesh) = mesh else { return Ok(None) };
        let folder = cache.of_mesh(&mesh);
        if folder.is_none() && given.is_none() {
            return Ok(None);
        }
        let body = Key::new().of("body", 1).with("mesh", &mesh).with("elements", &*ElementKeys::of(body).to_json());
        Ok(Some(Self { cache, given, folder, mesh, body, asked: Mutex::default() }))
    }

    /// The same for matrices from another program, with the hash of what was read of them.
    pub fn of_matrices(cache: &Cache, mesh: Hash) -> Option<Self> {
        let cache = cache.clone();
        let folder = Some(cache.of_mesh(&mesh)?);
        let body = Key::new().of("matrices", 1).with("files", &mesh);
        Some(Self { cache, given: None, folder, mesh, body, asked: Mutex::default() })
    }

    /// The start of the key of anything that follows from the body.
    pub fn key(&self) -> Key {
        self.body.clone()
    }

    /// The hash of the mesh file.
    pub fn mesh_hash(&self) -> &Hash {
        &self.mesh
    }

    /// The body file that the scene names.
    pub fn given(&self) -> Option<&SealedFile> {
        self.given.as_ref()
    }

    /// The mesh of the body, with what its file has that was left out; `made` of the file where it is not kept.
    pub fn mesh(
        &self,
        body: &Body,
        meshed: &MeshedBody,
        made: impl FnOnce() -> Result<Imported, BuildError>,
    ) -> Result<Imported, BuildError> {
        let source = meshed.mesh.display().to_string();
        if let Some(file) = &self.given {
            return Ok(arrays::read(file, source)?);
        }
        let place = self.folder.as_ref().map(|folder| folder.join(MESH));
        let kept = place.as_ref().and_then(|place| self.read(place, |file| arrays::read(file, source.clone())));
        if let Some(imported) = kept {
            return Ok(imported);
        }
        let imported = made()?;
        if let Some(place) = place.filter(|_| !self.cache.is_closed()) {
            let arrays = MeshArrays::new(&imported.mesh, &imported.notes, &imported.materials, &imported.beside);
            let texts = BTreeMap::from(arrays.texts());
            self.write(&place, texts, &arrays.declared(&body.units.length), |writer| arrays.write(writer));
        }
        Ok(imported)
    }

    /// A value by its key, if it is kept.
    pub fn recall<T: Keep>(&self, key: &Hash, known: T::Known<'_>) -> Result<Option<T>, BuildError> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).insert(*key);
        let read = |file: &SealedFile| T::read(&Kept { file, group: group(key) }, known);
        if let Some(file) = self.given.as_ref().filter(|file| has(file, key)) {
            let value = read(file)?;
            self.cache.note(|notes| notes.read += 1);
            return Ok(Some(value));
        }
        Ok(self.place(key).and_then(|place| self.read(&place, read)))
    }

    /// Keeps a value that was computed.
    pub fn keep(&self, key: &Hash, value: &impl Keep) {
        self.cache.note(|notes| notes.computed += 1);
        let Some(place) = self.place(key).filter(|_| !self.cache.is_closed()) else { return };
        let mut arrays = Arrays::default();
        value.write(&mut arrays);
        let path = |name: &str| format!("{}/{name}", group(key));
        let declared = |(name, array): &(&str, Array<f64>)| {
            let (kind, shape) = (Kind::F64, array.shape.clone());
            Declared { path: path(name), kind, shape, attributes: Vec::new(), same_as: None }
        };
        let datasets: Vec<Declared> = arrays.0.iter().map(declared).collect();
        self.write(&place, BTreeMap::new(), &datasets, |writer| {
            arrays.0.iter().try_for_each(|(name, array)| writer.write(&path(name), &array.values))
        });
    }

    /// The files that have all that was asked for.
    pub fn files(&self) -> Result<Vec<(Hash, SealedFile)>, BuildError> {
        let asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let file = |key: Hash| {
            let given = self.given.as_ref().filter(|file| has(file, &key)).map(|file| file.path().to_owned());
            let place = given.or_else(|| self.place(&key)).unwrap_or_default();
            Ok((key, SealedFile::open(place, Format::BODY)?))
        };
        asked.into_iter().map(file).collect()
    }

    fn place(&self, key: &Hash) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{key}.kept")))
    }

    /// Content of a file of the cache; none where there is no file, or a damaged one.
    fn read<T>(&self, place: &Path, read: impl Fn(&SealedFile) -> Result<T, SealedError>) -> Option<T> {
        match SealedFile::open(place, Format::BODY).and_then(|file| read(&file)) {
            Ok(found) => {
                touch(place);
                self.cache.note(|notes| notes.read += 1);
                Some(found)
            }
            Err(SealedError::System { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => {
                self.cache.warn(format!("cache entry damaged; recomputing: {error}"));
                None
            }
        }
    }

    fn write(
        &self,
        place: &Path,
        texts: BTreeMap<String, String>,
        datasets: &[Declared],
        write: impl FnOnce(&mut Writer) -> Result<(), SealedError>,
    ) {
        let written = Writer::plain(place, texts, datasets).and_then(|mut writer| {
            write(&mut writer)?;
            writer.finish(false)
        });
        match written {
            Ok(()) => self.cache.trim(),
            Err(error) => self.cache.close(&error.to_string()),
        }
    }
}

/// True if a file has a value, or a part of it.
fn has(file: &SealedFile, key: &Hash) -> bool {
    let group = group(key);
    file.datasets().any(|dataset| dataset.strip_prefix(&group).is_some_and(|rest| rest.starts_with('/')))
}
