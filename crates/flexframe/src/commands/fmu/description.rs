//! `modelDescription.xml`.

use std::collections::BTreeMap;
use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use scene::{Rows, StepControl};

use super::manifest::Manifest;
use super::model::FmuModel;
use super::si_unit::Powers;
use super::variables::{Source, Variable};

/// Communication points of the default experiment, where the scene does not say when it has rows.
const DEFAULT_POINTS: f64 = 500.0;

/// The description of an FMU whose library is called `identifier`.
pub(super) fn describe(fmu: &FmuModel, manifest: &Manifest, identifier: &str) -> io::Result<Vec<u8>> {
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 2);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let attributes = [
        ("fmiVersion", "2.0"),
        ("modelName", identifier),
        ("guid", &manifest.guid),
        ("description", &fmu.scene.title),
        ("generationTool", concat!("flexframe ", env!("CARGO_PKG_VERSION"))),
        ("variableNamingConvention", "structured"),
        ("numberOfEventIndicators", "0"),
    ];
    out.create_element("fmiModelDescription").with_attributes(attributes).write_inner_content(|out| {
        out.create_element("CoSimulation")
            .with_attributes([
                ("modelIdentifier", identifier),
                ("canHandleVariableCommunicationStepSize", "true"),
                ("canInterpolateInputs", "false"),
                ("maxOutputDerivativeOrder", "0"),
                ("canRunAsynchronuously", "false"),
                ("canBeInstantiatedOnlyOncePerProcess", "false"),
                ("canNotUseMemoryManagementFunctions", "true"),
                ("canGetAndSetFMUstate", "true"),
                ("canSerializeFMUstate", "true"),
                ("providesDirectionalDerivative", "false"),
            ])
            .write_empty()?;
        units(out, fmu)?;
        out.create_element("LogCategories").write_inner_content(|out| {
            for (name, description) in [
                ("logStatusWarning", "what of the model may be wrong"),
                ("logStatusError", "what has failed, and what to do"),
            ] {
                out.create_element("Category")
                    .with_attributes([("name", name), ("description", description)])
                    .write_empty()?;
            }
            Ok(())
        })?;
        let step = communication_step(fmu);
        out.create_element("DefaultExperiment")
            .with_attributes([
                ("startTime", "0"),
                ("stopTime", &(fmu.scene.time.end * fmu.seconds).to_string()),
                ("stepSize", &(step * fmu.seconds).to_string()),
            ])
            .write_empty()?;
        out.create_element("ModelVariables").write_inner_content(|out| {
            fmu.variables.iter().enumerate().try_for_each(|(reference, variable)| scalar(out, fmu, reference, variable))
        })?;
        structure(out, &fmu.variables)
    })?;
    let mut text = out.into_inner();
    text.push(b'\n');
    Ok(text)
}

/// The time between two rows of the scene.
fn communication_step(fmu: &FmuModel) -> f64 {
    match (fmu.scene.rows, fmu.scene.time.control) {
        (Rows::Interval(interval), _) => interval,
        (Rows::EverySteps(steps), StepControl::Fixed(step)) => steps as f64 * step,
        (Rows::EverySteps(_), StepControl::Tolerance(_)) => fmu.scene.time.end / DEFAULT_POINTS,
    }
}

/// The name of a variable's unit; none of a pure number.
fn unit_name(fmu: &FmuModel, variable: &Variable) -> Option<String> {
    if variable.source == Source::Time && Powers::of("time").and_then(|time| time.factor(&fmu.scene.units)).is_some() {
        // FMI counts time in seconds.
        return Some("s".to_owned());
    }
    match Powers::of(variable.unit) {
        Some(powers) if powers == Powers::default() => None,
        Some(powers) => Some(powers.name(&fmu.scene.units)),
        None => {
            let scene::Units { length, mass, time } = &fmu.scene.units;
            let named = variable.unit.replace("length", length).replace("mass", mass).replace("time", time);
            Some(named)
        }
    }
}

fn units(out: &mut Writer<Vec<u8>>, fmu: &FmuModel) -> io::Result<()> {
    let mut all = BTreeMap::new();
    for variable in &fmu.variables {
        if let Some(name) = unit_name(fmu, variable) {
            let known = Powers::of(variable.unit).and_then(|powers| Some((powers, powers.factor(&fmu.scene.units)?)));
            let known = match variable.source {
                Source::Time => known.map(|(powers, _)| (powers, 1.0)),
                _ => known,
            };
            all.insert(name, known);
        }
    }
    out.create_element("UnitDefinitions").write_inner_content(|out| {
        for (name, known) in &all {
            let unit = out.create_element("Unit").with_attribute(("name", name.as_str()));
            let Some((Powers { length, mass, time, angle }, factor)) = known else {
                unit.write_empty()?;
                continue;
            };
            let powers = [("kg", mass), ("m", length), ("s", time), ("rad", angle)];
            let powers = powers.into_iter().filter(|(_, power)| **power != 0);
            let mut attributes: Vec<(&str, String)> = powers.map(|(name, power)| (name, power.to_string())).collect();
            if *factor != 1.0 {
                attributes.push(("factor", format!("{factor:e}")));
            }
            let attributes: Vec<(&str, &str)> =
                attributes.iter().map(|(name, value)| (*name, value.as_str())).collect();
            unit.write_inner_content(|out| {
                out.create_element("BaseUnit").with_attributes(attributes).write_empty().map(|_| ())
            })?;
        }
        Ok(())
    })?;
    Ok(())
}

fn scalar(out: &mut Writer<Vec<u8>>, fmu: &FmuModel, reference: usize, variable: &Variable) -> io::Result<()> {
    let (causality, initial) = match variable.source {
        Source::Time => ("independent", None),
        Source::Input(_) => ("input", None),
        Source::Row { is_output: true, .. } => ("output", Some("calculated")),
        Source::Row { is_output: false, .. } => ("local", Some("calculated")),
    };
    let reference = reference.to_string();
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("description", &variable.description),
        ("causality", causality),
        ("variability", "continuous"),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial)));
    out.create_element("ScalarVariable").with_attributes(attributes).write_inner_content(|out| {
        let (start, unit) = (
            match variable.source {
                Source::Input(input) => Some(input.start().to_string()),
                _ => None,
            },
            unit_name(fmu, variable),
        );
        let named = [("unit", unit), ("start", start)].into_iter();
        let attributes: Vec<(&str, String)> = named.filter_map(|(name, value)| Some((name, value?))).collect();
        let attributes: Vec<(&str, &str)> = attributes.iter().map(|(name, value)| (*name, value.as_str())).collect();
        out.create_element("Real").with_attributes(attributes).write_empty().map(|_| ())
    })?;
    Ok(())
}

/// Which outputs there are, and which follow the inputs at once: those that do not have no dependencies; of the others all
/// may be.
fn structure(out: &mut Writer<Vec<u8>>, variables: &[Variable]) -> io::Result<()> {
    let unknowns = |out: &mut Writer<Vec<u8>>| -> io::Result<()> {
        for (i, variable) in variables.iter().enumerate() {
            let Source::Row { is_direct, is_output: true, .. } = variable.source else { continue };
            let index = (i + 1).to_string();
            let unknown = out.create_element("Unknown").with_attribute(("index", index.as_str()));
            let unknown = if is_direct { unknown } else { unknown.with_attribute(("dependencies", "")) };
            unknown.write_empty()?;
        }
        Ok(())
    };
    out.create_element("ModelStructure").write_inner_content(|out| {
        out.create_element("Outputs").write_inner_content(unknowns)?;
        out.create_element("InitialUnknowns").write_inner_content(unknowns)?;
        Ok(())
    })?;
    Ok(())
}
