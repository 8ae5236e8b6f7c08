//! The body file of a scene: what other programs read by name, and the values that later runs read.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use dynamics::Manifold;
use faer::sparse::SparseColMatRef;
use faer::{Mat, MatRef};
use fem_tet10::Mesh;
use keys::Hash;
use mesh_import::Beside;
use modal::Modes;
use scene::{Body, BodySource};
use sealed::{Declared, Kind, Number, SealedError, SealedFile, Writer};
use whole_file::TemporaryFolder;

use crate::body::origin::{ElementKeys, ORIGIN, Origin};
use crate::building::assembly::Assembled;
use crate::building::builder::Builder;
use crate::building::progress::BuildProgress;
use crate::cache::Cache;
use crate::cache::kept::{by_columns, group};
use crate::error::BuildError;
use crate::mesh::arrays::MeshArrays;
use crate::model::{Meshed, Model};
use crate::needs::Needs;
use crate::stress::shapes::BodyStress;

/// Numbers that are ready to be written.
enum Numbers {
    F64(Vec<f64>),
    U32(Vec<u32>),
}

impl Numbers {
    fn kind(&self) -> Kind {
        match self {
            Self::F64(_) => f64::KIND,
            Self::U32(_) => u32::KIND,
        }
    }
}

/// Datasets that are read by name.
struct Named<'a> {
    given: &'a Body,
    datasets: Vec<(Declared, Numbers)>,
}

impl Builder {
    /// Builds the model of a scene, and writes its body file; with `matrices`, mass and stiffness are in it. What a run of the
    /// scene asks of the mesh is in the file, with the stress of all nodes if the scene asks for any, and the file is what a
    /// scene names as `file` in `[body]`.
    ///
    /// # Errors
    /// [`BuildError`], also for a rigid body without a mesh.
    pub fn write_body(
        &self,
        body: &Body,
        path: &Path,
        matrices: bool,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        match &body.source {
            BodySource::Meshed(meshed) if !meshed.tied_masses.is_empty() => {
                let help =
                    "run the scene as it is: the cache keeps what is computed of it, so that later runs are quick";
                let found = "masses beside the body, which a body file does not have";
                return Err(body.refuse("body.tied_masses", found, "`point_masses`, or none", help).into());
            }
            BodySource::Meshed(_) | BodySource::File(_) => {}
            BodySource::Rigid(_) => {
                let help = "run the scene as it is: a rigid body is reduced already";
                return Err(body.refuse("body.rigid", "a rigid body", "a body with a mesh", help).into());
            }
            BodySource::Matrices(_) => {
                let help = "run the scene as it is: the cache keeps what is computed of the matrices, so that later runs are quick";
                return Err(body.refuse("body.matrices", "a body of matrices", "a body with a mesh", help).into());
            }
        }
        let stress_field = self.needs.stress_field || self.needed(body).any_stress();
        let builder = self.needing(Needs { stress_field, ..self.needs.clone() });
        // The values come by way of a cache, from which nothing is removed in the meantime: that of the user, or one of a time where
        // it cannot be written, which is a warning.
        if let Some(folder) = self.cache.folder().filter(|_| !self.cache.is_closed()) {
            let cache = self.cache.elsewhere(folder, u64::MAX);
            let written = builder.write_by_way_of(&cache, body, path, matrices, &mut progress);
            if written.is_ok() || !cache.is_closed() {
                return written;
            }
        }
        let temporary = TemporaryFolder::new().map_err(SealedError::system(path, "make a temporary folder"))?;
        let cache = self.cache.elsewhere(temporary.path(), u64::MAX);
        let written = builder.write_by_way_of(&cache, body, path, matrices, &mut progress);
        if written.is_err() && cache.is_closed() {
            let full = io::Error::from(io::ErrorKind::StorageFull);
            return Err(
                SealedError::system(temporary.path(), "keep what is computed in this temporary folder")(full).into()
            );
        }
        written
    }

    fn write_by_way_of(
        &self,
        cache: &Cache,
        given: &Body,
        path: &Path,
        matrices: bool,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Model, BuildError> {
        let builder = Self { cache: cache.clone(), ..self.clone() };
        let assembly = builder.assemble(given, &mut progress)?;
        if matches!(&assembly.0, Assembled::Meshed(assembled) if assembled.store.is_none()) {
            return Err(without_store(cache, given));
        }
        let mut variants = assembly.variants()?;
        let model = variants.build(given, &builder.needs, &mut progress)?;
        let (Assembled::Meshed(assembled), Some(meshed), Some(structure)) =
            (&assembly.0, &model.meshed, variants.structure())
        else {
            return Ok(model);
        };
        let Some(body) = assembled.elements() else { return Ok(model) };
        let Some(store) = &assembled.store else { return Err(without_store(cache, given)) };

        let arrays = MeshArrays::new(&meshed.mesh, &meshed.mesh_notes, &[], &Beside::default());
        let mut named = Named { given, datasets: Vec::new() };
        named.add_groups(&meshed.mesh);
        named.add_modes(&model, meshed);
        named.add_constants(&model);
        if let Some(manifold) = &model.physics.large_deflection {
            named.add_large_deflection(manifold, meshed.following.as_ref());
        }
        if let Some(reference) = &meshed.reference {
            let description = "displacement of each node of the bent body that the modes are about";
            let shape = [reference.nrows() / 3, 3];
            let numbers = Numbers::F64(by_columns(reference.as_ref()));
            named.add("reference/displacement", &shape, &given.units.length, "mesh", description, numbers);
        }
        if let Some(stress) = &model.stress {
            named.add_stress(stress, &model);
        }
        if matrices {
            // About the reference: those of the modes.
            let matrices = assembled.tangent()?;
            named.add_matrix("stiffness", matrices.stiffness());
            named.add_matrix("mass", matrices.mass());
        }
        let origin = Origin {
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            mesh: body.mesh.display().to_string(),
            mesh_hash: store.mesh_hash().to_string(),
            elements: ElementKeys::of(body),
            modes: crate::building::variants::requested(&builder.needed(given)),
            support: structure.support_hash(),
            reference: structure.reference().map(|reference| reference.hash.to_string()),
        };
        let mut texts = BTreeMap::from(arrays.texts());
        texts.extend([
            (ORIGIN.to_owned(), origin.to_json()),
            ("title".to_owned(), given.title.clone()),
            ("scene".to_owned(), given.text_alone.clone()),
            ("program_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("mesh_file".to_owned(), origin.mesh.clone()),
            ("mesh_hash".to_owned(), origin.mesh_hash.clone()),
            ("units_length".to_owned(), given.units.length.clone()),
            ("units_mass".to_owned(), given.units.mass.clone()),
            ("units_time".to_owned(), given.units.time.clone()),
        ]);
        write(path, texts, &arrays, &given.units.length, &named, &store.files()?)?;
        Ok(model)
    }
}

/// Error of a `folder` that cannot keep values of the body, of which the file is made.
fn without_store(cache: &Cache, body: &Body) -> BuildError {
    if cache.is_closed() {
        let what = cache.notes().warnings.join("; ");
        return SealedError::system(cache.folder().unwrap_or(Path::new("")), "write the cache")(std::io::Error::other(
            what,
        ))
        .into();
    }
    let found =
        "a mesh file that names others which cannot be known before: what the body is made of cannot be told later";
    let help = "write it as one MSH 4.1 file first: gmsh -3 -order 2 -format msh41 BODY.geo -o BODY.msh";
    body.refuse("body.mesh", found, "a mesh in one file", help).into()
}

/// Writes the file. An array that is there by name already gets a second name.
fn write(
    path: &Path,
    texts: BTreeMap<String, String>,
    arrays: &MeshArrays,
    unit: &str,
    named: &Named<'_>,
    kept: &[(Hash, SealedFile)],
) -> Result<(), SealedError> {
    let mut declared = arrays.declared(unit);
    let mut by_hash = BTreeMap::new();
    for (dataset, numbers) in &named.datasets {
        if let Numbers::F64(values) = numbers {
            by_hash.insert(Hash::of(values).to_string(), dataset.path.clone());
        }
        declared.push(dataset.clone());
    }
    let mut copied: Vec<(&SealedFile, &str, Kind)> = Vec::new();
    for (key, file) in kept {
        let group = format!("{}/", group(key));
        for dataset in file.datasets().filter(|dataset| dataset.starts_with(&group)) {
            let Some((kind, shape, hash)) = file.described(dataset) else { continue };
            let same_as = hash.and_then(|hash| by_hash.get(hash)).filter(|_| !shape.contains(&0)).cloned();
            if same_as.is_none() {
                copied.push((file, dataset, kind));
            }
            let (path, shape) = (dataset.to_owned(), shape.to_vec());
            declared.push(Declared { path, kind, shape, attributes: Vec::new(), same_as });
        }
    }
    let mut writer = Writer::create(path, texts, &declared)?;
    arrays.write(&mut writer)?;
    for (dataset, numbers) in &named.datasets {
        match numbers {
            Numbers::F64(values) => writer.write(&dataset.path, values),
            Numbers::U32(values) => writer.write(&dataset.path, values),
        }?;
    }
    for (file, dataset, kind) in copied {
        match kind {
            Kind::F64 => writer.write(dataset, &file.read::<f64>(dataset)?.values),
            Kind::F32 => writer.write(dataset, &file.read::<f32>(dataset)?.values),
            Kind::U64 => writer.write(dataset, &file.read::<u64>(dataset)?.values),
            Kind::U32 => writer.write(dataset, &file.read::<u32>(dataset)?.values),
        }?;
    }
    writer.finish(true)
}

impl Named<'_> {
    fn add(&mut self, path: &str, shape: &[usize], unit: &str, frame: &str, description: &str, numbers: Numbers) {
        let attributes =
            vec![("unit", unit.to_owned()), ("frame", frame.to_owned()), ("description", description.to_owned())];
        let (path, shape, kind) = (path.to_owned(), shape.to_vec(), numbers.kind());
        self.datasets.push((Declared { path, kind, shape, attributes, same_as: None }, numbers));
    }

    fn add_groups(&mut self, mesh: &Mesh) {
        let surface = mesh.outer_faces();
        self.add(
            "mesh/surface_triangles",
            &[surface.len(), 6],
            "1",
            "none",
            "nodes of the faces on the surface, from 0, seen from outside: corners, then mid-edges 01 12 20",
            Numbers::U32(surface.into_flattened()),
        );
        let parts = mesh.parts();
        for (group, name) in parts.groups.iter().enumerate() {
            let of_group =
                (0..).zip(&parts.element_regions).filter(|(_, region)| parts.regions[**region].contains(&group));
            let elements: Vec<u32> = of_group.map(|(element, _)| element).collect();
            self.add_group("volumes", group, name, "its elements, from 0", elements);
        }
        for (group, surface) in parts.surfaces.iter().enumerate() {
            let nodes = mesh.group_nodes(&surface.name).unwrap_or_default();
            self.add_group("surfaces", group, &surface.name, "its nodes, from 0", nodes);
        }
        for (group, of_nodes) in parts.node_groups.iter().enumerate() {
            let kind = ["points", "curves"][of_nodes.dimension.min(1)];
            let nodes = mesh.group_nodes(&of_nodes.name).unwrap_or_default();
            self.add_group(kind, group, &of_nodes.name, "its nodes, from 0", nodes);
        }
    }

    /// Groups are numbered, since a name may be no name for HDF5.
    fn add_group(&mut self, kind: &str, number: usize, name: &str, description: &str, members: Vec<u32>) {
        let path = format!("groups/{kind}/{number}");
        self.add(&path, &[members.len()], "1", "none", description, Numbers::U32(members));
        if let Some((declared, _)) = self.datasets.last_mut() {
            declared.attributes.push(("name", name.to_owned()));
        }
    }

    fn add_modes(&mut self, model: &Model, meshed: &Meshed) {
        let modes = &meshed.modes;
        let natural = modes.natural();
        let damping = model.damping_ratios();
        // Beside a static answer only the large modes are as they were.
        let what = match modes.answer {
            None => "natural mode",
            Some(_) => {
                "coordinate, of which one is a static answer, the large ones are natural modes and the others combinations of these"
            }
        };
        self.add_shapes("modes", what, modes, damping, 0..natural);
        let all = modes.eigenvalues.len();
        self.add_shapes("static_shapes", "static shape (no natural frequency)", modes, damping, natural..all);
        let unit = format!("{}^-0.5", self.given.units.mass);
        let rigid = modes.rigid.shapes.as_ref();
        let description = "displacement of each node in each of the rigid modes (zero where the body has less)";
        self.add(
            "rigid_modes/shapes",
            &[6, rigid.nrows() / 3, 3],
            &unit,
            "mesh",
            description,
            Numbers::F64(by_columns(rigid)),
        );
    }

    fn add_shapes(&mut self, group: &str, what: &str, modes: &Modes, damping: &[f64], which: std::ops::Range<usize>) {
        let (mass, time) = (self.given.units.mass.clone(), self.given.units.time.clone());
        let shapes = modes.shapes.subcols(which.start, which.len());
        let nodes = shapes.nrows() / 3;
        let circular: Vec<f64> = modes.eigenvalues[which.clone()].iter().map(|lambda| lambda.sqrt()).collect();
        let frequencies = circular.iter().map(|omega| omega / std::f64::consts::TAU).collect();
        let hertz = if time == "s" { "Hz".to_owned() } else { format!("1/{time}") };
        let count = which.len();
        let mut add = |name: &str, shape: &[usize], unit: &str, frame: &str, description: String, values: Vec<f64>| {
            self.add(&format!("{group}/{name}"), shape, unit, frame, &description, Numbers::F64(values));
        };
        let of_each = |quantity: &str| format!("{quantity} of each {what}");
        let of_shapes = of_each("displacement of each node in a unit of the modal coordinate");
        let unit = format!("{mass}^-0.5");
        add("shapes", &[count, nodes, 3], &unit, "mesh", of_shapes, by_columns(shapes));
        add("frequencies", &[count], &hertz, "none", of_each("frequency"), frequencies);
        add("circular_frequencies", &[count], &format!("rad/{time}"), "none", of_each("circular frequency"), circular);
        let ratios = damping.get(which).unwrap_or_default().to_vec();
        add("damping_ratios", &[count], "1", "none", of_each("damping ratio"), ratios);
    }

    /// [`reduced_body::Constants`].
    fn add_constants(&mut self, model: &Model) {
        let body = &model.body;
        let nf = body.flexible();
        let all = 6 + nf;
        let (length, mass, time) = {
            let units = &self.given.units;
            (units.length.clone(), units.mass.clone(), units.time.clone())
        };
        let (root, first) = (format!("{mass}^0.5"), format!("{mass}^0.5 {length}"));
        let mut add = |name: &str, shape: &[usize], unit: &str, frame: &str, description: &str, values: Vec<f64>| {
            self.add(&format!("constants/{name}"), shape, unit, frame, description, Numbers::F64(values));
        };
        let rows = |matrix: &nalgebra::Matrix3<f64>| matrix.transpose().as_slice().to_vec();
        let matrices = |matrices: &mut dyn Iterator<Item = &Mat<f64>>| {
            matrices.flat_map(|matrix| by_columns(matrix.transpose())).collect::<Vec<f64>>()
        };
        add("mass", &[], &mass, "none", "total mass m", vec![body.mass]);
        add("center_of_mass", &[3], &length, "mesh", "centre of mass", body.center_of_mass.as_slice().to_vec());
        add("origin", &[3], &length, "mesh", "origin of the body", body.origin.as_slice().to_vec());
        let inertia = format!("{mass} {length}^2");
        add("inertia", &[3, 3], &inertia, "body", "inertia J0 about the origin, undeformed", rows(&body.inertia));
        let of_translation = "T: velocity of the origin by the first three rigid modal velocities";
        add(
            "translation_basis",
            &[3, 3],
            &format!("{mass}^-0.5"),
            "body",
            of_translation,
            rows(&body.translation_basis),
        );
        let of_rotation = "B: angular velocity by the last three rigid modal velocities";
        let unit = format!("{mass}^-0.5 {length}^-1");
        add("rotation_basis", &[3, 3], &unit, "body", of_rotation, rows(&body.rotation_basis));
        let circular = body.circular_frequencies.clone();
        let unit = format!("rad/{time}");
        add("circular_frequencies", &[nf], &unit, "none", "of the natural modes, then of the static shapes", circular);
        if let Some(answer) = model.meshed.as_ref().and_then(|meshed| meshed.modes.answer.as_ref()) {
            let of_coupling = "stiffness between coordinates, beside the squares of circular_frequencies";
            add(
                "coupling",
                &[nf, nf],
                &format!("rad^2/{time}^2"),
                "none",
                of_coupling,
                by_columns(answer.stiffness().as_ref()),
            );
        }
        let products = matrices(&mut body.rotation_products.iter().flatten());
        add("rotation_products", &[3, 3, all, all], "1", "body", "E_ab = Psi^T M (I x e_a e_b^T) Psi", products);
        let positions = body.position_products.iter().flatten().flatten().copied().collect();
        add("position_products", &[3, 3, all], &first, "body", "Psi^T M (I x e_a e_b^T) X", positions);
        let pairs = "ij = 11, 22, 33, 23, 13, 12";
        let of_first = format!("c_ij = sym Psi_f^T M (I x [e_i x]^T [e_j x]) X, {pairs}");
        add("inertia_first", &[6, nf], &first, "body", &of_first, body.inertia_first.concat());
        let of_second = format!("N_ij = sym Psi_f^T M (I x [e_i x]^T [e_j x]) Psi_f, {pairs}");
        add("inertia_second", &[6, nf, nf], "1", "body", &of_second, matrices(&mut body.inertia_second.iter()));
        let of_gyroscopic = "G_i = Psi_f^T M (I x [e_i x]) Psi_f";
        add("gyroscopic", &[3, nf, nf], "1", "body", of_gyroscopic, matrices(&mut body.gyroscopic.iter()));
        let of_translation = "t_i = Psi_f^T M (1 x e_i)";
        add("translation_first", &[3, nf], &root, "body", of_translation, body.translation_first.concat());
        let of_rotation = "b_i = Psi_f^T M (I x [e_i x]) X";
        add("rotation_first", &[3, nf], &first, "body", of_rotation, body.rotation_first.concat());
        if let Some(stiffness) = &body.stress_stiffness {
            let of_stress = format!("stiffness by the stress of the spin omega_i omega_j, {pairs}");
            add("stress_stiffness", &[6, nf, nf], "1", "body", &of_stress, matrices(&mut stiffness.iter()));
        }
    }

    /// Adds the terms by which the coordinates of all shapes follow from those of the modes: see [`Manifold`].
    fn add_large_deflection(&mut self, manifold: &Manifold, following: MatRef<'_, f64>) {
        let (mass, length) = (self.given.units.mass.clone(), self.given.units.length.clone());
        let products = manifold.products();
        let factor = |product: &Vec<usize>, i: usize| product.get(i).copied().unwrap_or(manifold.modes()) as u32;
        let list = products.iter().flat_map(|product| [0, 1, 2].map(|i| factor(product, i))).collect();
        let mut add = |name: &str, shape: &[usize], unit: &str, frame: &str, description: &str, numbers: Numbers| {
            self.add(&format!("large_deflection/{name}"), shape, unit, frame, description, numbers);
        };
        add(
            "factors",
            &[products.len(), 3],
            "1",
            "none",
            "coordinates of each product, from 0; one more than there are stands for a factor of 1",
            Numbers::U32(list),
        );
        let of_products = Numbers::F64(manifold.of_products().to_vec());
        let description = "what a unit of each product adds to the coordinates of the modes, the static shapes and the shapes that \
                           follow";
        let shape = [products.len(), manifold.body().flexible()];
        // Products of two have this unit, those of three (mass^0.5 length)^-2.
        add("products", &shape, &format!("{mass}^-0.5 {length}^-1"), "none", description, of_products);
        let description =
            "displacement of each node in a unit of the coordinate of each shape that only follows large modes";
        let shape = [following.ncols(), following.nrows() / 3, 3];
        add("shapes", &shape, &format!("{mass}^-0.5"), "mesh", description, Numbers::F64(by_columns(following)));
    }

    /// The stress of each coordinate, and of each product of two large modes.
    fn add_stress(&mut self, stress: &BodyStress, model: &Model) {
        let Some((nodes, of_coordinates)) = stress.field() else { return };
        let (length, mass, time) = {
            let units = &self.given.units;
            (units.length.clone(), units.mass.clone(), units.time.clone())
        };
        let sites = nodes.len();
        let description = "node of each row of the stresses; a node between materials has a row for each";
        self.add("stress/nodes", &[sites], "1", "none", description, Numbers::U32(nodes.to_vec()));
        let products = model.physics.large_deflection.as_ref().map_or(0, |manifold| manifold.products().len());
        let (linear, second) = of_coordinates.split_at(of_coordinates.len() - products);
        let order = "xx, yy, zz, xy, yz, zx";
        let description =
            format!("stress of a unit of each coordinate of modes, static shapes, shapes that follow: {order}");
        let unit = format!("{mass}^0.5 {length}^-2 {time}^-2");
        let numbers = Numbers::F64(linear.concat());
        self.add("stress/shapes", &[linear.len(), sites, 6], &unit, "mesh", &description, numbers);
        if products > 0 {
            let numbers = Numbers::F64(second.concat());
            let description = format!("stress of a unit of each of the products of large_deflection/factors: {order}");
            let (shape, unit) = ([second.len(), sites, 6], format!("{length}^-3 {time}^-2"));
            self.add("stress/products", &shape, &unit, "mesh", &description, numbers);
        }
    }

    /// By compressed columns; more entries than 32 bits can number take 50 GB.
    fn add_matrix(&mut self, name: &str, matrix: SparseColMatRef<'_, usize, f64>) {
        let (mass, time) = (&self.given.units.mass, &self.given.units.time);
        let unit = if name == "mass" { mass.clone() } else { format!("{mass}/{time}^2") };
        let words = |values: &[usize]| Numbers::U32(values.iter().map(|value| *value as u32).collect());
        let (starts, rows) = (matrix.symbolic().col_ptr(), matrix.symbolic().row_idx());
        let description = "entries, by columns; row and column 3 node + axis";
        let values = Numbers::F64(matrix.val().to_vec());
        self.add(&format!("matrices/{name}/data"), &[matrix.val().len()], &unit, "mesh", description, values);
        self.add(&format!("matrices/{name}/indices"), &[rows.len()], "1", "none", "row of each entry", words(rows));
        self.add(
            &format!("matrices/{name}/indptr"),
            &[starts.len()],
            "1",
            "none",
            "start of each column",
            words(starts),
        );
    }
}
