//! The rules on `[body]`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use fem_tet10::{Material, Materials, PointMass};
use matrix_import::MatrixFiles;
use nalgebra::{Matrix3, Vector3};

use super::Check;
use crate::body::{BodySource, FileBody, MeshedBody, RigidBody, TiedMass};
use crate::document::join;
use crate::error::SceneError;
use crate::section::{BodySection, MatricesSection, RigidSection};

/// Relative difference of entries of an inertia tensor that should be equal, still taken for rounding.
const ASYMMETRY: f64 = 1e-6;

/// Relative excess of a principal moment over the sum of the others, still taken for rounding: that of a flat body
/// is their sum, written with some digits.
const EXCESS: f64 = 1e-3;

impl Check<'_> {
    pub fn source(&self, section: BodySection) -> Result<BodySource, SceneError> {
        let BodySection {
            mesh,
            file,
            matrices,
            mesh_size,
            raise_order,
            material,
            materials,
            point_masses,
            tied_masses,
            rigid,
            markers: _,
        } = section;
        if let Some(matrices) = matrices {
            return self.matrices(&matrices).map(BodySource::Matrices);
        }
        let raise_order = raise_order.unwrap_or_default();
        let Some(rigid) = rigid else {
            let mesh = mesh.as_deref().map(|mesh| self.mesh(mesh)).transpose()?;
            let mesh = mesh.map(|mesh| self.document.folder().join(mesh));
            self.mesh_size(mesh_size)?;
            let Some(file) = file else {
                let Some(mesh) = mesh else {
                    let is_meshed = material.is_some() || materials.is_some();
                    return Err(if is_meshed { self.missing("body", "mesh") } else { self.nothing() });
                };
                let materials = self.materials(material, materials)?;
                self.point_masses(&point_masses)?;
                self.tied_masses(&tied_masses)?;
                let body = MeshedBody { mesh, mesh_size, raise_order, materials, point_masses, tied_masses };
                return Ok(BodySource::Meshed(body));
            };
            if self.has("body.tied_masses") {
                let help = "keep `file` without it, or give the body its mesh and materials";
                let place = self.document.place("body.tied_masses");
                return Err(place.refuse("both `file` and `tied_masses`", "a body of a mesh", help));
            }
            let is_given = material.is_some() || materials.is_some();
            return Ok(BodySource::File(FileBody {
                file: self.body_file(&file, mesh.is_some())?,
                mesh,
                mesh_size,
                raise_order,
                materials: if is_given { Some(self.materials(material, materials)?) } else { None },
                point_masses: self.has("body.point_masses").then_some(point_masses),
            }));
        };
        for key in ["mesh", "file", "mesh_size", "raise_order", "material", "materials", "point_masses", "tied_masses"]
        {
            if self.has(&join("body", key)) {
                return Err(self.document.place(&join("body", key)).refuse(
                    format!("both `rigid` and `{key}`"),
                    "mass properties, or a mesh with its materials and point masses",
                    "keep `rigid` for a rigid body without a mesh, or the mesh and what belongs to it",
                ));
            }
        }
        self.rigid(&rigid).map(BodySource::Rigid)
    }

    /// The refusal of a body that is not said.
    fn nothing(&self) -> SceneError {
        let help = "give `mesh` and its material, `rigid` (mass properties) for a body that does not deform, `file` for one that \
                    `flexframe reduce` has written, or `matrices` for those of another program";
        self.document.place("body.mesh").refuse(
            "a body with nothing of its own",
            "one of `mesh`, `rigid`, `file` and `matrices`",
            help,
        )
    }

    /// Matrices say all of a body but its shape.
    fn matrices(&self, section: &MatricesSection) -> Result<MatrixFiles, SceneError> {
        let others = ["mesh", "file", "mesh_size", "raise_order", "material", "materials", "rigid"];
        for (key, help) in others
            .map(|key| (key, "keep `matrices`, or the other and what belongs to it"))
            .into_iter()
            .chain(["point_masses", "tied_masses"].map(|key| {
                (key, "put the masses into the mass matrix: in CalculiX and Abaqus by elements of type MASS")
            }))
        {
            if self.has(&join("body", key)) {
                let found = format!("both `matrices` and `{key}`");
                return Err(self.document.place(&join("body", key)).refuse(
                    found,
                    "matrices, which stand for all of the body",
                    help,
                ));
            }
        }
        let file = |key: &str, name: &str| -> Result<PathBuf, SceneError> {
            let key = join("body.matrices", key);
            self.require(
                !name.is_empty() && !name.contains('\0'),
                &key,
                "the name of a file",
                "see docs/reference/matrices.md",
            )?;
            Ok(self.document.folder().join(name))
        };
        Ok(MatrixFiles {
            mass: file("mass", &section.mass)?,
            stiffness: file("stiffness", &section.stiffness)?,
            nodes: file("nodes", &section.nodes)?,
            dofs: section.dofs.as_ref().map(|name| file("dofs", name)).transpose()?,
        })
    }

    /// The place of a body file. What it holds is looked at when the body is built.
    fn body_file(&self, file: &str, has_mesh: bool) -> Result<PathBuf, SceneError> {
        const HELP: &str = "make the file: flexframe reduce SCENE -o FILE, from a scene without `file`";
        self.require(!file.is_empty() && !file.contains('\0'), "body.file", "the name of a body file", HELP)?;
        let of_mesh = ["mesh_size", "raise_order"].iter().find(|key| self.has(&join("body", key)));
        match of_mesh.filter(|_| !has_mesh) {
            None => Ok(self.document.folder().join(file)),
            Some(key) => Err(self.document.place(&join("body", key)).refuse(
                format!("`{key}` for a body file, whose mesh is there"),
                "it beside `mesh`",
                "remove it",
            )),
        }
    }

    fn mesh_size(&self, size: Option<f64>) -> Result<(), SceneError> {
        let help = "give the largest size of an element in your unit of length";
        size.map_or(Ok(()), |size| self.positive("body.mesh_size", size, help))
    }

    fn rigid(&self, section: &RigidSection) -> Result<RigidBody, SceneError> {
        let &RigidSection { mass, center_of_mass, inertia, about } = section;
        let help = "give the mass of the body in your unit of mass";
        self.positive("body.rigid.mass", mass, help)?;
        let key = "body.rigid.inertia";
        let given = Matrix3::from_fn(|i, j| inertia[i][j]);
        if given == Matrix3::zeros() {
            let help = "remove it: a point mass is at `center_of_mass`";
            self.require(about.is_none(), "body.rigid.about", "no other point for a zero inertia", help)?;
            return Ok(RigidBody { mass, center_of_mass, inertia });
        }
        let asymmetry = (given - given.transpose()).amax();
        if asymmetry > ASYMMETRY * given.amax() {
            return Err(self.document.place(key).refuse(
                format!("a matrix whose entries across the diagonal differ by up to {asymmetry:?}"),
                "a symmetric matrix",
                "give the inertia tensor [[Jxx, Jxy, Jxz], [Jxy, Jyy, Jyz], [Jxz, Jyz, Jzz]], with \
                 Jxy = −∫ x y dm",
            ));
        }
        let center = Vector3::from(center_of_mass);
        let arm = about.map_or(center, Vector3::from) - center;
        let transport = (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass;
        let central = (given + given.transpose()) / 2.0 - transport;
        if let Some(found) = not_an_inertia(&central) {
            return Err(self.document.place(key).refuse(
                format!("{found} about the centre of mass"),
                "positive principal moments of inertia, none above the sum of the other two, or zeros for a point mass",
                "correct the tensor, or set `about` to the point it is given for (default: the centre of mass)",
            ));
        }
        let inertia = [0, 1, 2].map(|i| [0, 1, 2].map(|j| central[(i, j)]));
        Ok(RigidBody { mass, center_of_mass, inertia })
    }

    /// Refuses a point mass that nothing ties.
    pub fn turns(&self, body: &BodySource) -> Result<(), SceneError> {
        match body {
            BodySource::Rigid(rigid) if rigid.is_point() => Err(self.document.place("body.rigid.inertia").refuse(
                "zeros for a body that neither a joint nor a spring ties to another or to the ground",
                "an inertia",
                "give it one: the place of a body that moves alone does not depend on it",
            )),
            _ => Ok(()),
        }
    }

    fn mesh<'m>(&self, mesh: &'m str) -> Result<&'m str, SceneError> {
        self.require(
            !mesh.is_empty() && !mesh.contains('\0'),
            "body.mesh",
            "the name of a mesh file",
            "name a gmsh mesh, relative to the folder of the scene file: `mesh = \"plate.msh\"`",
        )?;
        Ok(mesh)
    }

    fn materials(
        &self,
        whole: Option<Material>,
        by_group: Option<BTreeMap<String, Material>>,
    ) -> Result<Materials, SceneError> {
        match (whole, by_group) {
            (Some(_), Some(_)) => Err(self.document.place("body.materials").refuse(
                "both `material` and `materials`",
                "exactly one of them",
                "keep `material` for the whole mesh, or `materials` by physical group",
            )),
            (None, None) => {
                let at = self.document.place("body.material").into();
                Err(SceneError::MissingKey { at, key: "material".to_owned() })
            }
            (Some(material), None) => {
                self.material("body.material", &material)?;
                Ok(Materials::Uniform(material))
            }
            (None, Some(groups)) => {
                self.require(
                    !groups.is_empty(),
                    "body.materials",
                    "a material for each physical group of the mesh",
                    "add `group_name = { young_modulus = …, poisson_ratio = …, density = … }`",
                )?;
                for (group, material) in &groups {
                    self.material(&join("body.materials", group), material)?;
                }
                Ok(Materials::ByGroup(groups))
            }
        }
    }

    fn material(&self, key: &str, material: &Material) -> Result<(), SceneError> {
        let &Material { young_modulus, poisson_ratio, density } = material;
        self.positive(
            &join(key, "young_modulus"),
            young_modulus,
            "give Young's modulus as force per area in your units, e.g. 70000 N/mm² for aluminium",
        )?;
        self.require(
            poisson_ratio > -1.0 && poisson_ratio < 0.5,
            &join(key, "poisson_ratio"),
            "a number between -1 and 0.5, both excluded",
            "give Poisson's ratio of the material, e.g. 0.33; for a nearly incompressible one \
             less than 0.5, e.g. 0.49",
        )?;
        self.positive(
            &join(key, "density"),
            density,
            "give the density as mass per volume in your units, e.g. 2.7e-9 Mg/mm³ for aluminium",
        )
    }

    fn point_masses(&self, masses: &[PointMass]) -> Result<(), SceneError> {
        let help = "mesh that many masses as a part of the body, with a material of their density";
        self.not_too_many("body.point_masses", masses.len(), help)?;
        for (i, point_mass) in masses.iter().enumerate() {
            let key = format!("body.point_masses[{i}]");
            self.positive(
                &join(&key, "mass"),
                point_mass.mass,
                "give the mass in your unit of mass, or remove the point mass",
            )?;
            if let Some(radius) = point_mass.spread {
                self.positive(
                    &join(&key, "spread"),
                    radius,
                    "give a radius, or remove `spread` to put the mass on one node",
                )?;
            }
        }
        Ok(())
    }
}

impl Check<'_> {
    fn tied_masses(&self, masses: &[TiedMass]) -> Result<(), SceneError> {
        self.not_too_many("body.tied_masses", masses.len(), "mesh that many masses as a part of the body")?;
        for (i, tied) in masses.iter().enumerate() {
            let key = format!("body.tied_masses[{i}]");
            self.positive(&join(&key, "mass"), tied.mass, "give the mass in your unit of mass, or remove it")?;
        }
        Ok(())
    }
}

/// Reason why the tensor is none of inertia.
fn not_an_inertia(tensor: &Matrix3<f64>) -> Option<String> {
    let size = tensor.amax();
    if !(size > 0.0 && tensor.iter().all(|entry| entry.is_finite())) {
        return Some(format!("a tensor with the largest entry {size:?}"));
    }
    // Scaled, so that the squares of its entries are finite.
    let mut moments: [f64; 3] = (tensor / size).symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [least, middle, largest] = moments;
    let possible = least > f64::EPSILON && largest <= (least + middle) * (1.0 + EXCESS);
    (!possible).then(|| {
        let [a, b, c] = moments.map(|moment| moment * size);
        format!("the principal moments {a:.6e}, {b:.6e}, {c:.6e}")
    })
}
