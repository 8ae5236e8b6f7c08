//! The rules on the values of a scene that need no mesh.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::document::{Document, join};
use crate::error::{SceneError, shorten};
use crate::load::{Force, History, Load};
use crate::scene::{
    Frame, Initial, Material, Materials, Method, Modes, Output, PointMass, Rows, Stepping, Time, Units,
};
use crate::section::{Formulation, OutputSection, Scheme, TimeSection};

/// Three points whose triangle has an angle with a smaller sine count as lying on one line.
const LEAST_SINE: f64 = 1e-6;

/// Intervals between rows where the scene gives a tolerance and no interval.
const DEFAULT_ROWS: f64 = 500.0;

/// The rules, on the values of one document.
pub(crate) struct Check<'d>(pub &'d Document<'d>);

impl Check<'_> {
    /// Refuses the value with the key path `key`, as it is written, unless `rule` holds.
    fn require(&self, rule: bool, key: &str, expected: &str, cure: &str) -> Result<(), SceneError> {
        if rule {
            return Ok(());
        }
        let node = self.0.nearest(key);
        Err(node.place().refuse(shorten(node.written()), expected, cure))
    }

    fn positive(&self, key: &str, value: f64, cure: &str) -> Result<(), SceneError> {
        self.require(value > 0.0, key, "a number greater than 0", cure)
    }

    pub fn label(&self, key: &str, text: &str) -> Result<(), SceneError> {
        self.require(
            !text.contains(char::is_control),
            key,
            "a text on one line, without control characters",
            "remove line breaks, tabs and `\\u0000`",
        )
    }

    pub fn units(&self, units: &Units) -> Result<(), SceneError> {
        self.label("units.length", &units.length)?;
        self.label("units.mass", &units.mass)?;
        self.label("units.time", &units.time)
    }

    pub fn mesh<'m>(&self, mesh: &'m str) -> Result<&'m str, SceneError> {
        self.require(
            !mesh.is_empty() && !mesh.contains('\0'),
            "body.mesh",
            "the name of a mesh file",
            "name a gmsh mesh, relative to the folder of the scene file: `mesh = \"plate.msh\"`",
        )?;
        Ok(mesh)
    }

    pub fn materials(
        &self,
        whole: Option<Material>,
        by_group: Option<BTreeMap<String, Material>>,
    ) -> Result<Materials, SceneError> {
        match (whole, by_group) {
            (Some(_), Some(_)) => Err(self.0.place("body.materials").refuse(
                "both `material` and `materials`",
                "exactly one of them",
                "keep `material` for the whole mesh, or `materials` by physical group",
            )),
            (None, None) => {
                let at = self.0.place("body.material").into();
                Err(SceneError::MissingKey { at, key: "material".to_owned() })
            }
            (Some(material), None) => {
                self.material("body.material", &material)?;
                Ok(Materials::Whole(material))
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

    pub fn point_masses(&self, masses: &[PointMass]) -> Result<(), SceneError> {
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

    pub fn modes(&self, modes: &Modes) -> Result<(), SceneError> {
        self.require(
            modes.damping_ratio >= 0.0,
            "modes.damping_ratio",
            "a number of 0 or more",
            "give the fraction of critical damping, e.g. 0.05; a negative one would feed energy in",
        )
    }

    pub fn frame(&self, frame: Option<&Frame>) -> Result<(), SceneError> {
        let Some(frame) = frame else { return Ok(()) };
        let [r, p, q] = [frame.r, frame.p, frame.q].map(Vector3::from);
        let cure = "choose three points of the body that span a triangle, \
                    or remove [frame] to have them chosen";
        for (key, one, other, same) in
            [("frame.P", "R", "P", r == p), ("frame.Q", "R", "Q", r == q), ("frame.Q", "P", "Q", p == q)]
        {
            if same {
                let found = format!("the same point for {one} and {other}");
                return Err(self.0.place(key).refuse(found, "three different points", cure));
            }
        }
        let sine = least_sine(&r, &p, &q);
        if sine >= LEAST_SINE {
            return Ok(());
        }
        Err(self.0.place("frame").refuse(
            format!("R, P, Q on one line (the smallest sine of an angle is {sine:.1e})"),
            format!("a triangle with no sine below {LEAST_SINE:e}"),
            cure,
        ))
    }

    pub fn initial(&self, initial: &Initial, modes: &Modes) -> Result<(), SceneError> {
        for (key, list) in [
            ("initial.modal_displacement", &initial.modal_displacement),
            ("initial.modal_velocity", &initial.modal_velocity),
        ] {
            if list.len() > modes.flexible {
                return Err(self.0.place(key).refuse(
                    format!("{} entries", list.len()),
                    format!("at most {}, one for each flexible mode", modes.flexible),
                    format!("remove entries, or set `flexible = {}` in [modes]", list.len()),
                ));
            }
        }
        Ok(())
    }

    /// Checks the loads and normalises their directions.
    pub fn loads(&self, loads: &mut [Load]) -> Result<(), SceneError> {
        for (i, load) in loads.iter_mut().enumerate() {
            let key = format!("loads[{i}]");
            match load {
                Load::Force(force) => self.force(&key, force)?,
            }
        }
        Ok(())
    }

    fn force(&self, key: &str, force: &mut Force) -> Result<(), SceneError> {
        let direction = unit(&Vector3::from(force.direction));
        self.require(
            direction.is_some(),
            &join(key, "direction"),
            "a vector that is not zero",
            "give the direction of the force; its length does not matter",
        )?;
        force.direction = direction.unwrap_or_default().into();
        self.history(&join(key, "history"), &force.history)
    }

    fn history(&self, key: &str, history: &History) -> Result<(), SceneError> {
        match *history {
            History::HalfSine { duration, .. } => self.positive(
                &join(key, "duration"),
                duration,
                "give the length of the pulse in time, e.g. `duration = 0.02`",
            ),
        }
    }

    pub fn time(&self, section: &TimeSection) -> Result<Time, SceneError> {
        let &TimeSection { end, step, tolerance, formulation, scheme } = section;
        let cure = "the run starts at 0 and makes at least one step, e.g. `end = 0.5`";
        self.positive("time.end", end, cure)?;
        let method = self.method(formulation, scheme)?;
        let expected = "exactly one of them";
        let cure = "give `step`, the length of a step, e.g. `step = 1e-4`, or `tolerance`, \
                    the relative error allowed in a step, e.g. `tolerance = 1e-8`";
        let stepping = match (step, tolerance) {
            (Some(_), Some(_)) => {
                return Err(self.0.place("time.tolerance").refuse("both `step` and `tolerance`", expected, cure));
            }
            (None, None) => {
                return Err(self.0.place("time.step").refuse("neither `step` nor `tolerance`", expected, cure));
            }
            (Some(step), None) => {
                self.positive("time.step", step, "give the length of a time step, e.g. `step = 1e-4`")?;
                self.part_of_the_run("time.step", step, end, "step")?;
                Stepping::Step(step)
            }
            (None, Some(tolerance)) => {
                self.tolerance(tolerance, method)?;
                Stepping::Tolerance(tolerance)
            }
        };
        Ok(Time { end, stepping, method })
    }

    fn method(&self, formulation: Option<Formulation>, scheme: Option<Scheme>) -> Result<Method, SceneError> {
        match (formulation, scheme) {
            (Some(Formulation::Conservative), Some(Scheme::Paper)) => {
                let found = "the conservative formulation with the scheme `paper`";
                let expected = "the formulation `paper`, which that scheme belongs to";
                let cure = "remove `formulation`, or set `scheme = \"exponential\"` for the conservative one";
                Err(self.0.place("time.formulation").refuse(found, expected, cure))
            }
            (None | Some(Formulation::Paper), Some(Scheme::Paper)) | (Some(Formulation::Paper), None) => {
                Ok(Method::Paper)
            }
            (Some(Formulation::Paper), Some(Scheme::Rkmk4)) => Ok(Method::PaperRkmk4),
            (Some(Formulation::Paper), Some(Scheme::Exponential | Scheme::Strang)) => {
                let scheme = self.0.nearest("time.scheme");
                let found = format!("{} with the formulation `paper`", shorten(scheme.written()));
                let expected = "`paper` or `rkmk4`, since `exponential` and `strang` need the conservative form";
                let cure = "set `scheme = \"rkmk4\"`, or `formulation = \"conservative\"`";
                Err(scheme.place().refuse(found, expected, cure))
            }
            (None | Some(Formulation::Conservative), Some(Scheme::Rkmk4)) => Ok(Method::Rkmk4),
            (None | Some(Formulation::Conservative), Some(Scheme::Strang)) => Ok(Method::Strang),
            (None | Some(Formulation::Conservative), Some(Scheme::Exponential) | None) => Ok(Method::Exponential),
        }
    }

    fn tolerance(&self, tolerance: f64, method: Method) -> Result<(), SceneError> {
        let found = match method {
            Method::Rkmk4 | Method::Exponential => {
                return self.require(
                    tolerance > 0.0 && tolerance < 1.0,
                    "time.tolerance",
                    "a number between 0 and 1, both excluded",
                    "give the relative error allowed in a step, e.g. `tolerance = 1e-8`",
                );
            }
            Method::Paper | Method::PaperRkmk4 => "a tolerance with the paper's formulation",
            Method::Strang => "a tolerance with the scheme `strang`",
        };
        Err(self.0.place("time.tolerance").refuse(
            found,
            "`step`, since only `exponential` and `rkmk4` on the conservative form estimate the error of a step",
            "give `step`, e.g. `step = 1e-4`, or set `scheme = \"exponential\"` and \
             `formulation = \"conservative\"`",
        ))
    }

    /// Refuses a length of time beyond the end of the run, or lost in rounding beside it.
    fn part_of_the_run(&self, key: &str, length: f64, end: f64, name: &str) -> Result<(), SceneError> {
        self.require(
            length <= end,
            key,
            &format!("at most the end of the run, {end:?}"),
            &format!("make the {name} shorter or the run longer"),
        )?;
        self.require(
            end + length > end,
            key,
            &format!("a {name} that is not lost in rounding beside the end of the run, {end:?}"),
            &format!("make the {name} longer or the run shorter"),
        )
    }

    pub fn output(&self, section: OutputSection, time: &Time) -> Result<Output, SceneError> {
        let OutputSection { every, interval, points } = section;
        let rows = match (every, interval, time.stepping) {
            (Some(_), Some(_), _) => {
                return Err(self.0.place("output.interval").refuse(
                    "both `every` and `interval`",
                    "at most one of them",
                    "keep `every` for a row after so many steps, or `interval` for rows at its multiples",
                ));
            }
            (Some(_), None, Stepping::Tolerance(_)) => {
                return Err(self.0.place("output.every").refuse(
                    "`every` with a tolerance",
                    "`interval`, since steps under a tolerance are not equally long",
                    "replace it by the time between two rows, e.g. `interval = 1e-3`",
                ));
            }
            (Some(every), None, Stepping::Step(_)) => {
                self.require(
                    every >= 1,
                    "output.every",
                    "a whole number, 1 or more",
                    "write 1 for every step, 10 for every tenth",
                )?;
                Rows::EverySteps(every)
            }
            (None, Some(interval), _) => {
                let cure = "give the time between two rows, e.g. `interval = 1e-3`";
                self.positive("output.interval", interval, cure)?;
                self.part_of_the_run("output.interval", interval, time.end, "interval")?;
                Rows::Interval(interval)
            }
            (None, None, Stepping::Step(_)) => Rows::EverySteps(1),
            (None, None, Stepping::Tolerance(_)) => Rows::Interval(time.end / DEFAULT_ROWS),
        };
        for name in points.keys() {
            let names_a_group = !matches!(name.as_str(), "" | "." | "..");
            if !names_a_group || name.contains(|c: char| c == '/' || c.is_control()) {
                return Err(self.0.nearest(&join("output.points", name)).place_of_key().refuse(
                    format!("the name {:?}", shorten(name)),
                    "a name that is not empty, `.` or `..`, without `/` and control characters",
                    "rename the point, e.g. `P1`: it names a group in the results file",
                ));
            }
        }
        Ok(Output { rows, points })
    }
}

/// The vector with length 1, of any finite length but 0 (scaled first, so that neither huge nor
/// tiny components are lost in their squares).
fn unit(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = vector.amax();
    (largest > 0.0).then(|| (vector / largest).normalize())
}

/// The smallest sine of an angle of the triangle: the altitude on the longest side over the
/// second longest side. Near 0 if the points are on one line or two of them close together.
fn least_sine(r: &Vector3<f64>, p: &Vector3<f64>, q: &Vector3<f64>) -> f64 {
    let scale = r.amax().max(p.amax()).max(q.amax());
    let [rp, rq, pq] = [p / scale - r / scale, q / scale - r / scale, q / scale - p / scale];
    let mut sides = [rp.norm(), rq.norm(), pq.norm()];
    sides.sort_by(f64::total_cmp);
    rp.cross(&rq).norm() / (sides[1] * sides[2])
}
