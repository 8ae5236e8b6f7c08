//! `flexframe equilibrium`: where the forces on bodies in joints balance.

use std::f64::consts::TAU;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Equilibrium, JointObservation, Observation, Stability, SteadyError, SystemMotion};
use model::{BuildProgress, Builder, Model};
use nalgebra::Vector3;
use report::{Form, Report, Table, Value};
use scene::Scene;

use crate::commands::modes::frequency_unit;
use crate::commands::system_modes::{TiedMotion, body_names, placed_motions};
use crate::report::{counted, quantity, rounded};
use crate::rows::units::UnitLabels;
use crate::surface::Surface;

/// Finds the equilibrium of each system of a scene, down the energy from where the bodies are placed, and others near by: places, reactions,
/// forces of springs, stability.
///
/// # Errors
/// [`Failure`]: of the scene, and where the forces balance nowhere.
pub fn equilibrium(scene: &Scene, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Report, Failure> {
    if !scene.has_connections() {
        let help = "tie bodies to each other or to the ground; `flexframe check` has the static shape of a body that constraints hold";
        let found = "a scene without joints, springs and bushings";
        return Err(Kind::Input.of(&scene.path).found(found).expected("bodies that are tied").help(help).into());
    }
    let models = builder.models(scene, progress)?;
    let of_system = |motion: &TiedMotion| {
        let at = motion.run.motion();
        let found = at.equilibrium().map_err(|source| source.in_file(&scene.path))?;
        let others = at.other_equilibria(&found).map_err(|source| source.in_file(&scene.path))?;
        let names = Names { scene, models: &models, motion };
        let mut report = names.report(&found)?;
        if names.deflection(&found) > FAR {
            let words =
                format!("a body bends by over {FAR} of its length, further than its modes hold: take large modes");
            report.warnings.push(words);
        }
        let (others, beyond): (Vec<_>, Vec<_>) = others.iter().partition(|other| names.deflection(other) <= FAR);
        let others = others.into_iter().map(|other| Ok((None, names.report(other)?)));
        let others = others.collect::<Result<Vec<_>, Failure>>()?;
        match others.len() {
            0 => report.line("others", "none is near by, along the softest motions of the joints"),
            count => report.line("others", format!("{} near by:", counted(count, ["equilibrium", "equilibria"]))),
        }
        if !beyond.is_empty() {
            let beyond = counted(beyond.len(), ["more bends", "more bend"]);
            report.line("", format!("{beyond} a body by over {FAR} of its length, further than its modes hold"));
        }
        report.list("others", others);
        Ok((None, report))
    };
    let systems = placed_motions(scene, &models)?.iter().map(of_system).collect::<Result<Vec<_>, Failure>>()?;
    let mut report = Report::new(&scene.title);
    report.put("frequency_unit", frequency_unit(&scene.units.time));
    report.list("systems", systems);
    if scene.joints.iter().any(|joint| joint.spring.as_ref().is_some_and(|spring| spring.friction.is_some())) {
        report.warnings.push(
            "friction of joints does not count: where it holds, the bodies may also rest beside the equilibrium"
                .to_owned(),
        );
    }
    Ok(report)
}

/// A deflection over the length above which a body of modes is not right.
const FAR: f64 = 0.1;
/// A part of the largest number that is rounding.
const ROUNDING: f64 = 1e-9;

/// A system with the names of its parts.
struct Names<'a> {
    scene: &'a Scene,
    models: &'a [Model],
    motion: &'a TiedMotion,
}

impl Names<'_> {
    /// The largest deflection of a body over its length.
    fn deflection(&self, found: &Equilibrium) -> f64 {
        let of_body =
            |(number, body): (usize, &usize)| self.models[*body].deflection(found.steady.modal_displacement(number));
        self.motion.bodies.iter().enumerate().map(of_body).fold(0.0, f64::max)
    }

    fn report(&self, found: &Equilibrium) -> Result<Report, Failure> {
        let Self { scene, motion, .. } = self;
        let units = UnitLabels::from(&scene.units);
        let failed = |source: dynamics::SetupError| source.in_file(&scene.path);
        let mut at = SystemMotion::new(motion.run.motion().system().clone(), &found.steady.states()).map_err(failed)?;
        at.find_reactions().map_err(|_| SteadyError::Inertia.in_file(&scene.path))?;
        let mut report = Report::default();
        let Stability { unstable, indifferent } = found.stability;
        let stability = match (unstable, indifferent) {
            (0, 0) => "stable".to_owned(),
            (0, count) => format!("stable, but nothing resists {}", counted(count, ["motion", "motions"])),
            (count, _) => format!("unstable along {}", counted(count, ["motion", "motions"])),
        };
        report.say("rest", "stability", stability);
        report.put("unstable", unstable);
        report.put("indifferent", indifferent);
        let vibrations = found.steady.linear.vibrations().map_err(|source| source.in_file(&scene.path))?;
        let mut frequencies = vibrations.modes.iter().map(|mode| mode.circular_frequency() / TAU);
        let lowest = frequencies.find(|frequency| *frequency > 0.0);
        report.put("lowest_frequency", lowest);
        if let Some(lowest) = lowest {
            let unit = frequency_unit(&scene.units.time);
            report.line("slowest", format!("vibration about it: {} {unit}", quantity(lowest)));
        }
        report.table(self.bodies(&mut at, found, &units)?);
        let (joints, elements) = (at.system().joints().len(), at.system().elements().len());
        let of_joints: Vec<(String, JointObservation)> =
            (0..joints).map(|joint| (at.system().joints()[joint].name.clone(), at.observe_joint(joint))).collect();
        let size = motion.run.size();
        report.table(table_of_joints(&of_joints, size, &units));
        let of_elements: Vec<(String, JointObservation)> =
            (0..elements).map(|element| (motion.elements[element].clone(), at.observe_element(element))).collect();
        if !of_elements.is_empty() {
            report.table(table_of_springs(&of_elements, size, &units));
        }
        Ok(report)
    }

    /// Where the bodies stand.
    fn bodies(&self, at: &mut SystemMotion, found: &Equilibrium, units: &UnitLabels<'_>) -> Result<Table, Failure> {
        let Self { scene, models, motion } = self;
        let mut rows = Vec::new();
        for (number, body) in motion.bodies.iter().enumerate() {
            let mut out = Observation::new(found.steady.modal_displacement(number).len(), 0);
            at.observe(number, &[], &mut out).map_err(|_| SteadyError::Inertia.in_file(&scene.path))?;
            let model = &models[*body];
            let bent =
                Surface::of_model(model).displacements(&model.coordinates(found.steady.modal_displacement(number)));
            let bent = bent.iter().map(Vector3::norm).fold(0.0, f64::max);
            rows.push((out, (model.body.flexible() > 0).then_some(bent)));
        }
        let place = |(out, _): &(Observation, Option<f64>)| Value::of(&<[f64; 3]>::from(out.position_global));
        let words = |(out, _): &(Observation, Option<f64>)| three(&out.position_global, self.motion.run.size());
        let (length, each) = (units.length, || rows.iter());
        Ok(Table::new("bodies", "bodies")
            .all()
            .shown("name", "body", Form::Plain, body_names(scene, &motion.bodies))
            .column("position", each().map(place))
            .column("attitude", each().map(|(out, _)| Value::of(&out.attitude.wxyz())))
            .text_only(format!("center of mass, {length}"), Form::Plain, each().map(words))
            .shown("deflection", format!("deflection, {length}"), Form::Plain, each().map(|(_, bent)| *bent)))
    }
}

/// The columns of force and moment in the axes of the first marker. What is rounding of the largest is 0 in the text.
fn with_wrenches(table: Table, all: &[(String, JointObservation)], size: f64, units: &UnitLabels<'_>) -> Table {
    let each = || all.iter().map(|(_, out)| out);
    let vector = |vector: &Vector3<f64>| Value::of(&<[f64; 3]>::from(*vector));
    let largest = each().map(|out| out.force_marker.norm().max(out.moment_marker.norm() / size)).fold(0.0, f64::max);
    let (force, moment) = (format!("force, {}", units.force()), format!("moment, {}", units.moment()));
    table
        .column("force", each().map(|out| vector(&out.force_marker)))
        .text_only(force, Form::Plain, each().map(|out| three(&out.force_marker, largest)))
        .column("moment", each().map(|out| vector(&out.moment_marker)))
        .text_only(moment, Form::Plain, each().map(|out| three(&out.moment_marker, size * largest)))
}

fn table_of_joints(joints: &[(String, JointObservation)], size: f64, units: &UnitLabels<'_>) -> Table {
    let each = || joints.iter().map(|(_, out)| out);
    let slide = format!("slide, {}", units.length);
    let table = Table::new("joints", "joints")
        .all()
        .shown("name", "joint", Form::Plain, joints.iter().map(|(name, _)| name))
        .column("turn", each().map(|out| out.coordinates.turn))
        .text_only("turn, rad", Form::Plain, each().map(|out| digits(out.coordinates.turn, 1.0)))
        .column("slide", each().map(|out| out.coordinates.slide))
        .text_only(slide, Form::Plain, each().map(|out| digits(out.coordinates.slide, size)));
    with_wrenches(table, joints, size, units)
        .shown("turn_effort", "along its turn", Form::Plain, each().map(|out| out.turn_effort))
        .shown("slide_effort", "along its slide", Form::Plain, each().map(|out| out.slide_effort))
}

fn table_of_springs(springs: &[(String, JointObservation)], size: f64, units: &UnitLabels<'_>) -> Table {
    let table = Table::new("springs", "springs")
        .all()
        .shown("name", "spring", Form::Plain, springs.iter().map(|(name, _)| name))
        .shown(
            "length",
            format!("length, {}", units.length),
            Form::Plain,
            springs.iter().map(|(_, out)| out.line.length),
        );
    with_wrenches(table, springs, size, units)
}

/// Five digits; 0 of a number that is rounding beside another one.
fn digits(number: f64, beside: f64) -> String {
    quantity(rounded(if number.abs() < ROUNDING * beside { 0.0 } else { number }, 5))
}

/// The same of three components.
fn three(vector: &Vector3<f64>, beside: f64) -> String {
    vector.iter().map(|x| digits(*x, beside)).collect::<Vec<_>>().join(" ")
}
