//! The functions of FMI 2.0 for co-simulation, as C sees them.
//!
//! Every function catches panics, so that none crosses the boundary: the instance is then broken, and says so. Names and
//! types are those of the standard's header files.
//!
//! Rules that C has to keep to, as the standard has it: a component is what [`fmi2Instantiate`] has returned and
//! [`fmi2FreeInstance`] has not taken, and one thread at a time uses it; pointers are null, or point to as many entries as
//! the count beside them says; texts end with a zero. This is what the `SAFETY` comments go by.
#![allow(unsafe_code, non_camel_case_types, non_snake_case, non_upper_case_globals)]

use std::any::Any;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;

use diagnostic::Failure;
use flexframe::forked::in_this_process;

use crate::error::{broken, bug, none, null, refused};
use crate::instance::{Instance, Saved};

/// A status.
pub type fmi2Status = c_int;
/// All is well.
pub const fmi2OK: fmi2Status = 0;
/// Done, but something may be wrong with the model; the logger has heard what.
pub const fmi2Warning: fmi2Status = 1;
/// Not known here.
pub const fmi2Discard: fmi2Status = 2;
/// Not done; the logger has heard why.
pub const fmi2Error: fmi2Status = 3;

/// A truth value.
pub type fmi2Boolean = c_int;
/// Which status is asked for.
pub type fmi2StatusKind = c_int;
/// The time up to which all is computed.
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
/// Asks whether the FMU wants to end the simulation.
pub const fmi2Terminated: fmi2StatusKind = 3;

/// `fmi2CoSimulation` of `fmi2Type`.
pub const fmi2CoSimulation: c_int = 1;

/// An instance.
pub type fmi2Component = *mut c_void;
/// A saved state.
pub type fmi2FMUstate = *mut c_void;

/// Logger of the importing program.
pub type fmi2CallbackLogger =
    unsafe extern "C" fn(*mut c_void, *const c_char, fmi2Status, *const c_char, *const c_char, ...);

/// The functions of the importing program. Memory is our own, and steps are done when [`fmi2DoStep`] returns.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2CallbackFunctions {
    /// Hears messages.
    pub logger: Option<fmi2CallbackLogger>,
    /// Not used.
    pub allocateMemory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub freeMemory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used.
    pub stepFinished: Option<unsafe extern "C" fn(*mut c_void, fmi2Status)>,
    /// Given to the logger.
    pub componentEnvironment: *mut c_void,
}

/// How `flexframe fmu` knows this library.
#[used]
static MARKER: &str = flexframe::fmu::marker();

struct Component {
    instance: Instance,
    logger: Logger,
    is_broken: bool,
}

struct Logger {
    callback: Option<fmi2CallbackLogger>,
    environment: *mut c_void,
    name: CString,
}

impl Logger {
    fn say(&self, status: fmi2Status, category: &CStr, words: &str) {
        let Some(callback) = self.callback else { return };
        // The message is a format of printf, and # begins a reference to a variable.
        let words = words.replace('%', "%%").replace('#', "##").replace('\0', " ");
        let words = CString::new(words).unwrap_or_default();
        // SAFETY: the logger of the importing program, called as the standard says; all texts live until it returns.
        unsafe { callback(self.environment, self.name.as_ptr(), status, category.as_ptr(), words.as_ptr()) }
    }

    fn error(&self, error: &Failure) {
        self.say(fmi2Error, c"logStatusError", &error.to_string());
    }
}

/// The words of a panic.
fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without words".to_owned())
}

/// A value that one thread hands to another, and waits until that is done with it.
struct Handed<T>(T);

// SAFETY: only `in_pool` makes one, whose thread waits: one thread at a time uses what is in it.
unsafe impl<T> Send for Handed<T> {}

impl<T> Handed<T> {
    fn take(self) -> T {
        self.0
    }
}

/// Does work in the pool of this process: it may have been forked from one that has used this library.
fn in_pool<T>(work: impl FnOnce() -> T) -> Result<T, Failure> {
    let work = Handed(work);
    let done = in_this_process(move || Handed(work.take()()));
    Ok(done.map_err(|error| refused(error.to_string()))?.take())
}

/// Calls `work` for a component; errors and panics go to the logger. A broken instance can be reset and freed, and its
/// saved states can be freed.
fn call(
    component: fmi2Component,
    function: &'static str,
    work: impl FnOnce(&mut Component) -> Result<fmi2Status, Failure>,
) -> fmi2Status {
    // SAFETY: null, or a component that only this thread uses now.
    let Some(component) = (unsafe { component.cast::<Component>().as_mut() }) else { return fmi2Error };
    let is_allowed = !component.is_broken || matches!(function, "fmi2Reset" | "fmi2FreeFMUstate");
    let done = match is_allowed {
        true => catch_unwind(AssertUnwindSafe(|| in_pool(|| work(component))?)),
        false => Ok(Err(broken())),
    };
    let error = match done {
        Ok(Ok(status)) => return status,
        Ok(Err(error)) => error,
        Err(panic) => {
            component.is_broken = true;
            bug(function, words_of(&*panic))
        }
    };
    // Not even a message may panic.
    let _ = catch_unwind(AssertUnwindSafe(|| component.logger.error(&error)));
    fmi2Error
}

/// Entries of the importing program.
///
/// # Safety
/// Null, or `count` entries that live and stay as they are while the slice is used.
unsafe fn entries<'a, T>(from: *const T, count: usize, what: &'static str) -> Result<&'a [T], Failure> {
    match (from.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(null(what, count)),
        // SAFETY: by the contract of this function.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(from, count) }),
    }
}

/// Room of the importing program for entries.
///
/// # Safety
/// Null, or room for `count` entries that nobody else uses while the slice is used.
unsafe fn room<'a, T>(to: *mut T, count: usize, what: &'static str) -> Result<&'a mut [T], Failure> {
    match (to.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(null(what, count)),
        // SAFETY: by the contract of this function.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(to, count) }),
    }
}

/// A text of the importing program.
///
/// # Safety
/// Null, or a text that ends with a zero and lives while it is used.
unsafe fn text<'a>(from: *const c_char, what: &'static str) -> Result<&'a str, Failure> {
    if from.is_null() {
        return Err(null(what, 1));
    }
    // SAFETY: by the contract of this function.
    unsafe { CStr::from_ptr(from) }.to_str().map_err(|_| refused(format!("a text of {what} is not UTF-8")))
}

/// "default": the types are those of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// "2.0".
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Makes an instance of the FMU that was unpacked to where `fmuResourceLocation` says; null where that fails, and the
/// logger hears why.
///
/// # Safety
/// As the standard has it: texts end with a zero, and the functions live as long as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: *const c_char,
    fmuType: c_int,
    fmuGUID: *const c_char,
    fmuResourceLocation: *const c_char,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    _loggingOn: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null, or the functions of the importing program.
    let functions = unsafe { functions.as_ref() };
    // SAFETY: null, or a text.
    let name = unsafe { text(instanceName, "the name of the instance") }.unwrap_or_default();
    let logger = Logger {
        callback: functions.and_then(|functions| functions.logger),
        environment: functions.map_or(ptr::null_mut(), |functions| functions.componentEnvironment),
        name: CString::new(name).unwrap_or_default(),
    };
    let make = || {
        if fmuType != fmi2CoSimulation {
            return Err(refused("FMUs of flexframe are for co-simulation; instantiate with fmi2CoSimulation"));
        }
        // SAFETY: null, or texts.
        let guid = unsafe { text(fmuGUID, "the GUID") }?;
        // SAFETY: null, or a text.
        let location = unsafe { text(fmuResourceLocation, "the location of the resources") }?;
        Instance::new(guid, location)
    };
    let made = catch_unwind(AssertUnwindSafe(|| in_pool(make)?))
        .unwrap_or_else(|panic| Err(bug("fmi2Instantiate", words_of(&*panic))));
    match made {
        Ok(instance) => Box::into_raw(Box::new(Component { instance, logger, is_broken: false })).cast(),
        Err(error) => {
            let _ = catch_unwind(AssertUnwindSafe(|| logger.error(&error)));
            ptr::null_mut()
        }
    }
}

/// Frees an instance.
///
/// # Safety
/// `c` is null or a component, and nobody uses it afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    if !c.is_null() {
        // SAFETY: a component, which is taken back here once.
        let component = unsafe { Box::from_raw(c.cast::<Component>()) };
        let _ = catch_unwind(AssertUnwindSafe(|| drop(component)));
    }
}

/// Errors and warnings are always told; there is no further logging to switch on.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    _loggingOn: fmi2Boolean,
    _nCategories: usize,
    _categories: *const *const c_char,
) -> fmi2Status {
    call(c, "fmi2SetDebugLogging", |_| Ok(fmi2OK))
}

/// Sets start and stop time, seconds. The scene's own step or tolerance holds, whatever tolerance is given.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    _toleranceDefined: fmi2Boolean,
    _tolerance: f64,
    startTime: f64,
    stopTimeDefined: fmi2Boolean,
    stopTime: f64,
) -> fmi2Status {
    let stop = (stopTimeDefined != 0).then_some(stopTime);
    call(c, "fmi2SetupExperiment", |component| component.instance.set_up(startTime, stop).map(|()| fmi2OK))
}

/// Makes the motion.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: fmi2Component) -> fmi2Status {
    call(c, "fmi2EnterInitializationMode", |component| component.instance.enter_initialization().map(|()| fmi2OK))
}

/// From here on there are steps.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: fmi2Component) -> fmi2Status {
    call(c, "fmi2ExitInitializationMode", |component| component.instance.exit_initialization().map(|()| fmi2OK))
}

/// Ends the simulation.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: fmi2Component) -> fmi2Status {
    call(c, "fmi2Terminate", |component| component.instance.terminate().map(|()| fmi2OK))
}

/// Back to what it was after [`fmi2Instantiate`].
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    call(c, "fmi2Reset", |component| {
        component.instance.reset()?;
        component.is_broken = false;
        Ok(fmi2OK)
    })
}

/// Reads variables.
///
/// # Safety
/// `c` is null or a component; the pointers are null or have `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(c: fmi2Component, vr: *const u32, nvr: usize, value: *mut f64) -> fmi2Status {
    call(c, "fmi2GetReal", |component| {
        // SAFETY: null, or nvr entries.
        let (references, values) =
            unsafe { (entries(vr, nvr, "the list of value references")?, room(value, nvr, "value")?) };
        component.instance.get_real(references, values).map(|()| fmi2OK)
    })
}

/// Sets inputs: all of these or none. They are held until they are set again.
///
/// # Safety
/// `c` is null or a component; the pointers are null or have `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(c: fmi2Component, vr: *const u32, nvr: usize, value: *const f64) -> fmi2Status {
    call(c, "fmi2SetReal", |component| {
        // SAFETY: null, or nvr entries.
        let (references, values) =
            unsafe { (entries(vr, nvr, "the list of value references")?, entries(value, nvr, "value")?) };
        component.instance.set_real(references, values).map(|()| fmi2OK)
    })
}

/// Refuses variables of types that there are none of.
fn none_of(c: fmi2Component, function: &'static str, kind: &'static str, vr: *const u32, nvr: usize) -> fmi2Status {
    call(c, function, |_| {
        // SAFETY: null, or nvr entries.
        match unsafe { entries(vr, nvr, "the list of value references") }?.first() {
            Some(reference) => Err(refused(format!(
                "there are no {kind} variables in this FMU; all are real (value reference {reference} was asked for)"
            ))),
            None => Ok(fmi2OK),
        }
    })
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(c: fmi2Component, vr: *const u32, nvr: usize, _: *mut c_int) -> fmi2Status {
    none_of(c, "fmi2GetInteger", "integer", vr, nvr)
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(c: fmi2Component, vr: *const u32, nvr: usize, _: *const c_int) -> fmi2Status {
    none_of(c, "fmi2SetInteger", "integer", vr, nvr)
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(c: fmi2Component, vr: *const u32, nvr: usize, _: *mut c_int) -> fmi2Status {
    none_of(c, "fmi2GetBoolean", "Boolean", vr, nvr)
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(c: fmi2Component, vr: *const u32, nvr: usize, _: *const c_int) -> fmi2Status {
    none_of(c, "fmi2SetBoolean", "Boolean", vr, nvr)
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: fmi2Component,
    vr: *const u32,
    nvr: usize,
    _: *mut *const c_char,
) -> fmi2Status {
    none_of(c, "fmi2GetString", "text", vr, nvr)
}

/// There are none.
///
/// # Safety
/// `c` is null or a component; `vr` is null or has `nvr` entries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: fmi2Component,
    vr: *const u32,
    nvr: usize,
    _: *const *const c_char,
) -> fmi2Status {
    none_of(c, "fmi2SetString", "text", vr, nvr)
}

/// Saves the state, with the inputs, to a new state or over an old one.
///
/// # Safety
/// `c` is null or a component; `FMUstate` is null, or points to null or to a state of this library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    call(c, "fmi2GetFMUstate", |component| {
        // SAFETY: null, or a place for one pointer.
        let [place] = unsafe { room(FMUstate, 1, "FMUstate") }? else { return Ok(fmi2Error) };
        let saved = component.instance.save()?;
        // SAFETY: null, or a state of this library, which only this thread uses now.
        match unsafe { place.cast::<Saved>().as_mut() } {
            Some(old) => *old = saved,
            None => *place = Box::into_raw(Box::new(saved)).cast(),
        }
        Ok(fmi2OK)
    })
}

/// Goes to a state.
///
/// # Safety
/// `c` is null or a component; `FMUstate` is null or a state of this library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status {
    call(c, "fmi2SetFMUstate", |component| {
        // SAFETY: null, or a state.
        let saved = unsafe { FMUstate.cast::<Saved>().as_ref() }.ok_or_else(|| null("FMUstate", 1))?;
        component.instance.restore(saved).map(|()| fmi2OK)
    })
}

/// Frees a state.
///
/// # Safety
/// `c` is null or a component; `FMUstate` is null, or points to null or to a state that nobody uses afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    call(c, "fmi2FreeFMUstate", |_| {
        // SAFETY: null, or a pointer to one.
        if let Some(place) = unsafe { FMUstate.as_mut() }
            && !place.is_null()
        {
            // SAFETY: a state of this library, which is taken back here once.
            drop(unsafe { Box::from_raw(place.cast::<Saved>()) });
            *place = ptr::null_mut();
        }
        Ok(fmi2OK)
    })
}

/// How many bytes a state has.
///
/// # Safety
/// `c` is null or a component; `FMUstate` is null or a state; `size` is null or a place for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    call(c, "fmi2SerializedFMUstateSize", |_| {
        // SAFETY: null, or a state.
        let saved = unsafe { FMUstate.cast::<Saved>().as_ref() }.ok_or_else(|| null("FMUstate", 1))?;
        let bytes = saved.to_bytes()?.len();
        // SAFETY: null, or a place for a number.
        unsafe { room(size, 1, "size") }?.fill(bytes);
        Ok(fmi2OK)
    })
}

/// A state as bytes, for another process, too.
///
/// # Safety
/// `c` is null or a component; `FMUstate` is null or a state; there is null or room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut u8,
    size: usize,
) -> fmi2Status {
    call(c, "fmi2SerializeFMUstate", |_| {
        // SAFETY: null, or a state.
        let saved = unsafe { FMUstate.cast::<Saved>().as_ref() }.ok_or_else(|| null("FMUstate", 1))?;
        let bytes = saved.to_bytes()?;
        // SAFETY: null, or room for as many bytes.
        let to = unsafe { room(serializedState, size, "serializedState") }?;
        let needed = bytes.len();
        let too_few =
            || refused(format!("{size} bytes are too few for the state; it has {needed} (fmi2SerializedFMUstateSize)"));
        to.get_mut(..needed).ok_or_else(too_few)?.copy_from_slice(&bytes);
        Ok(fmi2OK)
    })
}

/// A state from bytes.
///
/// # Safety
/// `c` is null or a component; the pointers are null, or `size` bytes and a place for a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serializedState: *const u8,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    call(c, "fmi2DeSerializeFMUstate", |_| {
        // SAFETY: null, or as many bytes.
        let saved = Saved::from_bytes(unsafe { entries(serializedState, size, "serializedState") }?)?;
        // SAFETY: null, or a place for one pointer.
        let [place] = unsafe { room(FMUstate, 1, "FMUstate") }? else { return Ok(fmi2Error) };
        *place = Box::into_raw(Box::new(saved)).cast();
        Ok(fmi2OK)
    })
}

/// There are none.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    _vUnknown_ref: *const u32,
    _nUnknown: usize,
    _vKnown_ref: *const u32,
    _nKnown: usize,
    _dvKnown: *const f64,
    _dvUnknown: *mut f64,
) -> fmi2Status {
    call(c, "fmi2GetDirectionalDerivative", |_| Err(none("directional derivatives")))
}

/// There are none: inputs are held.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    _vr: *const u32,
    _nvr: usize,
    _order: *const c_int,
    _value: *const f64,
) -> fmi2Status {
    call(c, "fmi2SetRealInputDerivatives", |_| Err(none("derivatives of inputs, which are held")))
}

/// There are none; velocities and accelerations are outputs of their own.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    _vr: *const u32,
    _nvr: usize,
    _order: *const c_int,
    _value: *mut f64,
) -> fmi2Status {
    call(c, "fmi2GetRealOutputDerivatives", |_| Err(none("derivatives of outputs")))
}

/// Goes on by a communication step, seconds. After an error everything is as it was before.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    c: fmi2Component,
    currentCommunicationPoint: f64,
    communicationStepSize: f64,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status {
    call(c, "fmi2DoStep", |component| {
        let warnings = component.instance.step(currentCommunicationPoint, communicationStepSize)?;
        warnings.iter().for_each(|words| component.logger.say(fmi2Warning, c"logStatusWarning", words));
        Ok(if warnings.is_empty() { fmi2OK } else { fmi2Warning })
    })
}

/// Steps are done when [`fmi2DoStep`] returns, so that there is none to cancel.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    call(c, "fmi2CancelStep", |_| Err(none("steps that go on by themselves")))
}

/// Nothing is pending.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: fmi2Component, _: fmi2StatusKind, _: *mut fmi2Status) -> fmi2Status {
    call(c, "fmi2GetStatus", |_| Ok(fmi2Discard))
}

/// The time that the FMU has reached, for [`fmi2LastSuccessfulTime`].
///
/// # Safety
/// `c` is null or a component; `value` is null or a place for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: fmi2Component, s: fmi2StatusKind, value: *mut f64) -> fmi2Status {
    call(c, "fmi2GetRealStatus", |component| {
        if s != fmi2LastSuccessfulTime {
            return Ok(fmi2Discard);
        }
        let time = component.instance.time()?;
        // SAFETY: null, or a place for a number.
        unsafe { room(value, 1, "value") }?.fill(time);
        Ok(fmi2OK)
    })
}

/// Nothing is pending.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(c: fmi2Component, _: fmi2StatusKind, _: *mut c_int) -> fmi2Status {
    call(c, "fmi2GetIntegerStatus", |_| Ok(fmi2Discard))
}

/// The FMU never wants to end the simulation: for [`fmi2Terminated`], false.
///
/// # Safety
/// `c` is null or a component; `value` is null or a place for a truth value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    call(c, "fmi2GetBooleanStatus", |_| {
        if s != fmi2Terminated {
            return Ok(fmi2Discard);
        }
        // SAFETY: null, or a place for a truth value.
        unsafe { room(value, 1, "value") }?.fill(0);
        Ok(fmi2OK)
    })
}

/// Nothing is pending.
///
/// # Safety
/// `c` is null or a component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(c: fmi2Component, _: fmi2StatusKind, _: *mut *const c_char) -> fmi2Status {
    call(c, "fmi2GetStringStatus", |_| Ok(fmi2Discard))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use flexframe::fmu::{FmuSettings, pack};
    use flexframe::model::Builder;
    use flexframe::scene::Body;

    use super::*;

    unsafe extern "C" fn hear(to: *mut c_void, _: *const c_char, _: c_int, _: *const c_char, words: *const c_char) {
        // SAFETY: the environment is the list of the test, and the words are a text.
        let (said, words) = unsafe { (&mut *to.cast::<Vec<String>>(), CStr::from_ptr(words)) };
        said.push(words.to_str().unwrap().to_owned());
    }

    fn instance(folder: &Path) -> Instance {
        let text = "title = \"a ball\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[time]\nend = 1.0\nstep = 0.1\n\
                    [body]\nrigid = { mass = 1, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n";
        let body = Body::parse(text, "ball.toml").unwrap();
        let library = folder.join("library");
        std::fs::write(&library, format!("{MARKER} fmi2DoStep")).unwrap();
        let report = pack(
            &body.into(),
            &Builder::default(),
            &folder.join("ball.fmu"),
            &FmuSettings { library: Some(library) },
            |_| (),
        )
        .unwrap();
        let zip = std::fs::File::open(folder.join("ball.fmu")).unwrap();
        zip::ZipArchive::new(zip).unwrap().extract(folder).unwrap();
        Instance::new(&report.guid, folder.join("resources").to_str().unwrap()).unwrap()
    }

    #[test]
    fn a_panic_stays_inside_and_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let mut said: Vec<String> = Vec::new();
        type Hear = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
        // SAFETY: the logger takes its fixed arguments only, which are all that it is given.
        let callback: fmi2CallbackLogger = unsafe { std::mem::transmute(hear as Hear) };
        let environment = ptr::from_mut(&mut said).cast();
        let logger = Logger { callback: Some(callback), environment, name: CString::default() };
        let mut component = Component { instance: instance(folder.path()), logger, is_broken: false };
        let c: fmi2Component = ptr::from_mut(&mut component).cast();
        let mut state: fmi2FMUstate = ptr::null_mut();
        // SAFETY: a component, and a place for a state.
        unsafe {
            assert_eq!(fmi2EnterInitializationMode(c), fmi2OK);
            assert_eq!(fmi2GetFMUstate(c, &mut state), fmi2OK);
        }
        assert!(!state.is_null());
        assert_eq!(call(c, "fmi2GetReal", |_| panic!("100% out of range")), fmi2Error);
        // SAFETY: a component, and a state that nobody uses afterwards.
        unsafe {
            assert_eq!(fmi2ExitInitializationMode(c), fmi2Error);
            assert_eq!(fmi2FreeFMUstate(c, &mut state), fmi2OK);
            assert!(state.is_null());
            assert_eq!(fmi2Reset(c), fmi2OK);
            assert_eq!(fmi2EnterInitializationMode(c), fmi2OK);
            assert_eq!(fmi2EnterInitializationMode(ptr::null_mut()), fmi2Error);
            fmi2FreeInstance(ptr::null_mut());
        }
        let lost = call(c, "fmi2SetFMUstate", |component| {
            component.instance.lose();
            panic!("the model is gone")
        });
        assert_eq!(lost, fmi2Error);
        // SAFETY: a component.
        assert_eq!(unsafe { fmi2Reset(c) }, fmi2Error);
        assert!(said[0].contains("a bug of flexframe, in fmi2GetReal: 100%% out of range"), "{said:?}");
        assert!(said[1].contains("fmi2Reset"), "{said:?}");
        assert!(said[2].contains("in fmi2SetFMUstate: the model is gone"), "{said:?}");
        assert!(said[3].contains("free the instance and make another"), "{said:?}");
        assert_eq!(said.len(), 4);
    }
}
