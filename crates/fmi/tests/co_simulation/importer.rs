//! An importing program: it unpacks an FMU and calls the functions of the standard.
#![allow(unsafe_code, non_upper_case_globals)]

use std::ffi::{CString, c_char, c_int, c_void};
use std::fs;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::ptr;

use flexframe::fmu::{FmuModel, FmuSettings, Input, Manifest, Source, Variable, marker, pack};
use flexframe::model::Builder;
use flexframe::scene::{Body, Scene};
use flexframe_fmi::c_interface::*;
use tempfile::TempDir;

/// An FMU that was packed and unpacked.
pub struct Fmu {
    folder: TempDir,
    pub guid: String,
    pub variables: Vec<Variable>,
    pub description: String,
}

impl Fmu {
    pub fn of(body: &Body) -> Self {
        Self::of_bodies(std::slice::from_ref(body))
    }

    pub fn of_bodies(scenes: &[Body]) -> Self {
        Self::of_system(&Scene { bodies: scenes.to_vec(), ..scenes[0].clone().into() })
    }

    pub fn of_system(scene: &Scene) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        // The functions are called in this process: the library in the FMU has only to be taken for it.
        fs::write(place("library"), format!("{} fmi2DoStep", marker())).unwrap();
        let settings = FmuSettings { library: Some(place("library")) };
        let report = pack(scene, &Builder::default(), &place("beam.fmu"), &settings, |_| ()).unwrap();
        let mut zip = zip::ZipArchive::new(Cursor::new(fs::read(place("beam.fmu")).unwrap())).unwrap();
        zip.extract(place("unpacked")).unwrap();
        let mut description = String::new();
        zip.by_name("modelDescription.xml").unwrap().read_to_string(&mut description).unwrap();
        let resources = place("unpacked").join("resources");
        let manifest = Manifest::checked(&resources).unwrap();
        assert_eq!(manifest.guid, report.guid);
        let variables = FmuModel::open(&resources, &manifest).unwrap().variables;
        Self { guid: report.guid, variables, description, folder }
    }

    pub fn resources(&self) -> PathBuf {
        self.folder.path().join("unpacked/resources")
    }

    pub fn reference(&self, name: &str) -> u32 {
        let place = self.variables.iter().position(|variable| variable.name == name);
        place.unwrap_or_else(|| panic!("no variable {name}")) as u32
    }

    /// The variables that are numbers of a row of results, and their places there.
    pub fn of_row(&self) -> (Vec<u32>, Vec<usize>) {
        let of = |(i, variable): (usize, &Variable)| match variable.source {
            Source::Row { place, .. } => Some((i as u32, place)),
            _ => None,
        };
        self.variables.iter().enumerate().filter_map(of).unzip()
    }

    pub fn inputs(&self) -> Vec<(u32, Input)> {
        let of = |(i, variable): (usize, &Variable)| match variable.source {
            Source::Input(input) => Some((i as u32, input)),
            _ => None,
        };
        self.variables.iter().enumerate().filter_map(of).collect()
    }

    /// An instance that has been made, or the words of the refusal.
    pub fn instantiate(&self) -> Result<Instance, String> {
        instantiate(&self.guid, &self.resources())
    }

    /// An instance that is ready for steps.
    pub fn start(&self) -> Instance {
        let mut instance = self.instantiate().unwrap();
        instance.begin().unwrap();
        instance
    }
}

pub fn instantiate(guid: &str, resources: &Path) -> Result<Instance, String> {
    instantiate_at(guid, &format!("file://{}", resources.display()))
}

pub fn instantiate_at(guid: &str, location: &str) -> Result<Instance, String> {
    let said: Box<Vec<(c_int, String)>> = Box::default();
    let said = Box::into_raw(said);
    // SAFETY: the logger only takes its fixed arguments, which are all that this library gives.
    let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(hear as Hear) };
    let functions = Box::new(fmi2CallbackFunctions {
        logger: Some(logger),
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: said.cast(),
    });
    let text = |text: &str| CString::new(text).unwrap();
    let (name, guid, location) = (text("beam"), text(guid), text(location));
    // SAFETY: all live until the call returns, the functions as long as the instance.
    let component = unsafe {
        fmi2Instantiate(name.as_ptr(), fmi2CoSimulation, guid.as_ptr(), location.as_ptr(), &*functions, 0, 0)
    };
    let mut instance = Instance { component, said, _functions: functions };
    if component.is_null() { Err(instance.last_words()) } else { Ok(instance) }
}

type Hear = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);

unsafe extern "C" fn hear(to: *mut c_void, _: *const c_char, status: c_int, _: *const c_char, words: *const c_char) {
    // SAFETY: the environment is the list of this instance, and the words are a text.
    let (said, words) = unsafe { (&mut *to.cast::<Vec<(c_int, String)>>(), std::ffi::CStr::from_ptr(words)) };
    said.push((status, words.to_str().unwrap().replace("%%", "%")));
}

/// An instance, and what its logger has heard.
pub struct Instance {
    component: fmi2Component,
    said: *mut Vec<(c_int, String)>,
    _functions: Box<fmi2CallbackFunctions>,
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: both are taken back once.
        unsafe {
            fmi2FreeInstance(self.component);
            drop(Box::from_raw(self.said));
        }
    }
}

/// Nothing, or the words of the error.
pub type Done = Result<(), String>;

impl Instance {
    /// Messages that the logger has heard since the last call.
    pub fn words(&mut self) -> Vec<(c_int, String)> {
        // SAFETY: the list of this instance.
        std::mem::take(unsafe { &mut *self.said })
    }

    fn last_words(&mut self) -> String {
        let (status, words) = self.words().pop().expect("the logger hears why");
        assert_eq!(status, fmi2Error);
        words
    }

    fn done(&mut self, status: fmi2Status) -> Done {
        match status {
            fmi2OK | fmi2Warning => Ok(()),
            fmi2Error => Err(self.last_words()),
            other => panic!("status {other}"),
        }
    }

    pub fn call(&mut self, function: unsafe extern "C" fn(fmi2Component) -> fmi2Status) -> Done {
        // SAFETY: a component.
        let status = unsafe { function(self.component) };
        self.done(status)
    }

    pub fn set_up(&mut self, start: f64, stop: Option<f64>) -> Done {
        // SAFETY: a component.
        let status = unsafe {
            fmi2SetupExperiment(self.component, 0, 0.0, start, c_int::from(stop.is_some()), stop.unwrap_or(0.0))
        };
        self.done(status)
    }

    pub fn begin(&mut self) -> Done {
        self.set_up(0.0, None)?;
        self.call(fmi2EnterInitializationMode)?;
        self.call(fmi2ExitInitializationMode)
    }

    pub fn get(&mut self, references: &[u32]) -> Result<Vec<f64>, String> {
        let mut values = vec![f64::NAN; references.len()];
        // SAFETY: as many entries.
        let status = unsafe { fmi2GetReal(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) };
        self.done(status).map(|()| values)
    }

    pub fn set(&mut self, references: &[u32], values: &[f64]) -> Done {
        // SAFETY: as many entries.
        let status = unsafe { fmi2SetReal(self.component, references.as_ptr(), references.len(), values.as_ptr()) };
        self.done(status)
    }

    pub fn step(&mut self, point: f64, step: f64) -> Done {
        // SAFETY: a component.
        let status = unsafe { fmi2DoStep(self.component, point, step, 1) };
        self.done(status)
    }

    pub fn time(&mut self) -> f64 {
        let mut time = f64::NAN;
        // SAFETY: a component and a place for a number.
        assert_eq!(unsafe { fmi2GetRealStatus(self.component, fmi2LastSuccessfulTime, &mut time) }, fmi2OK);
        time
    }

    pub fn save(&mut self) -> Result<fmi2FMUstate, String> {
        let mut state = ptr::null_mut();
        // SAFETY: a component and a place for a state.
        let status = unsafe { fmi2GetFMUstate(self.component, &mut state) };
        self.done(status).map(|()| state)
    }

    pub fn restore(&mut self, state: fmi2FMUstate) -> Done {
        // SAFETY: a state that `save` or `deserialized` gave.
        let status = unsafe { fmi2SetFMUstate(self.component, state) };
        self.done(status)
    }

    pub fn free(&mut self, mut state: fmi2FMUstate) {
        // SAFETY: a state that nobody uses afterwards.
        assert_eq!(unsafe { fmi2FreeFMUstate(self.component, &mut state) }, fmi2OK);
        assert!(state.is_null());
    }

    pub fn serialized(&mut self, state: fmi2FMUstate) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: a state and a place for a number.
        assert_eq!(unsafe { fmi2SerializedFMUstateSize(self.component, state, &mut size) }, fmi2OK);
        let mut bytes = vec![0; size];
        // SAFETY: a state, and room for that number of bytes.
        assert_eq!(unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr(), size) }, fmi2OK);
        // SAFETY: the same, with too little room.
        assert_eq!(unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr(), size - 1) }, fmi2Error);
        assert!(self.last_words().contains("too few for the state"));
        bytes
    }

    pub fn deserialized(&mut self, bytes: &[u8]) -> Result<fmi2FMUstate, String> {
        let mut state = ptr::null_mut();
        // SAFETY: the bytes and their number, and a place for a state.
        let status = unsafe { fmi2DeSerializeFMUstate(self.component, bytes.as_ptr(), bytes.len(), &mut state) };
        self.done(status).map(|()| state)
    }

    /// Calls with null pointers and for what there is not.
    pub fn refusals(&mut self) -> Vec<String> {
        let c = self.component;
        let one = 1u32;
        // SAFETY: null pointers are allowed to be told.
        let calls: [&dyn Fn() -> fmi2Status; 7] = unsafe {
            [
                &|| fmi2GetReal(c, ptr::null(), 2, ptr::null_mut()),
                &|| fmi2SetReal(c, &one, 1, ptr::null()),
                &|| fmi2SetFMUstate(c, ptr::null_mut()),
                &|| fmi2GetInteger(c, &one, 1, ptr::null_mut()),
                &|| fmi2SetString(c, &one, 1, ptr::null()),
                &|| fmi2CancelStep(c),
                &|| fmi2SetRealInputDerivatives(c, &one, 1, ptr::null(), ptr::null()),
            ]
        };
        let mut said = Vec::new();
        for call in calls {
            assert_eq!(call(), fmi2Error);
            said.push(self.last_words());
        }
        said
    }
}
