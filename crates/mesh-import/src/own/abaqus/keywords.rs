//! Keywords that are not read: which matter to nobody, which are counted, and which make nodes or elements.

/// Keywords of output and of the way a deck is computed, and those that only end others.
const SILENT: [&str; 34] = [
    "HEADING",
    "PREPRINT",
    "RESTART",
    "OUTPUT",
    "NODE OUTPUT",
    "ELEMENT OUTPUT",
    "NODE FILE",
    "NODE PRINT",
    "EL FILE",
    "EL PRINT",
    "CONTACT FILE",
    "CONTACT PRINT",
    "CONTACT OUTPUT",
    "SECTION PRINT",
    "FILE FORMAT",
    "ENERGY OUTPUT",
    "ENERGY FILE",
    "ENERGY PRINT",
    "MODAL FILE",
    "MONITOR",
    "FILTER",
    "TIME POINTS",
    "PHYSICAL CONSTANTS",
    "FREQUENCY",
    "STATIC",
    "END STEP",
    "CONTROLS",
    "SOLVER CONTROLS",
    "USER MATERIAL",
    "DEPVAR",
    "DAMPING",
    "EXPANSION",
    "CONDUCTIVITY",
    "SPECIFIC HEAT",
];

/// Keywords that make nodes or elements, or move them: without them the mesh is another one.
const MAKE_MESH: [&str; 11] = [
    "NGEN",
    "NFILL",
    "NCOPY",
    "NMAP",
    "ELGEN",
    "ELCOPY",
    "PARAMETER",
    "IMPERFECTION",
    "SUBMODEL",
    "MODEL CHANGE",
    "SYMMETRIC MODEL GENERATION",
];

/// Keywords that are counted and named.
const COUNTED: [&str; 86] = [
    "MODEL CHANGE",
    "FLUID SECTION",
    "HEAT TRANSFER",
    "FLUID CONSTANTS",
    "SPECIFIC GAS CONSTANT",
    "SENSITIVITY",
    "RADIATE",
    "FILM",
    "NODAL THICKNESS",
    "DFLUX",
    "CFLUX",
    "REFINE MESH",
    "USER ELEMENT",
    "COUPLED TEMPERATURE-DISPLACEMENT",
    "VISCO",
    "CREEP",
    "USER SECTION",
    "GREEN",
    "SUBSTRUCTURE GENERATE",
    "GAP CONDUCTANCE",
    "CONTACT DAMPING",
    "CONSTRAINT",
    "HYPERELASTIC",
    "HYPERFOAM",
    "MOHR COULOMB",
    "DEFORMATION PLASTICITY",
    "COMPLEX FREQUENCY",
    "DESIGN VARIABLES",
    "OBJECTIVE",
    "NETWORK MPC",
    "CYCLIC HARDENING",
    "CLEARANCE",
    "NORMAL",
    "AMPLITUDE",
    "BASE MOTION",
    "BEAM SECTION",
    "BEAM GENERAL SECTION",
    "BOUNDARY",
    "BUSHING",
    "CLOAD",
    "CONNECTOR SECTION",
    "CONNECTOR BEHAVIOR",
    "CONNECTOR ELASTICITY",
    "CONNECTOR DAMPING",
    "CONTACT PAIR",
    "CONTACT",
    "CYCLIC SYMMETRY MODEL",
    "DASHPOT",
    "DISTRIBUTING COUPLING",
    "DLOAD",
    "DSLOAD",
    "DYNAMIC",
    "ELASTIC",
    "EMBEDDED ELEMENT",
    "EQUATION",
    "FASTENER",
    "FRICTION",
    "GAP",
    "INITIAL CONDITIONS",
    "INERTIA RELIEF",
    "KINEMATIC COUPLING",
    "MASS",
    "MEMBRANE SECTION",
    "MPC",
    "MODAL DAMPING",
    "MODAL DYNAMIC",
    "NONSTRUCTURAL MASS",
    "ORIENTATION",
    "PLASTIC",
    "PRE-TENSION SECTION",
    "RIGID BODY",
    "ROTARY INERTIA",
    "SHELL GENERAL SECTION",
    "SHELL SECTION",
    "SHELL TO SOLID COUPLING",
    "SPRING",
    "STEADY STATE DYNAMICS",
    "STEP",
    "SURFACE BEHAVIOR",
    "SURFACE INTERACTION",
    "TEMPERATURE",
    "TIE",
    "TRANSFORM",
    "SURFACE SECTION",
    "BUCKLE",
    "DISTRIBUTION",
];

/// True of a keyword that says nothing of the body.
pub(super) fn is_silent(keyword: &str) -> bool {
    SILENT.contains(&keyword)
}

/// True of a keyword without which the mesh is another one.
pub(super) fn makes_mesh(keyword: &str) -> bool {
    MAKE_MESH.contains(&keyword)
}

/// True of a keyword that may be named: others may be words of any file that the deck includes.
pub(super) fn is_known(keyword: &str) -> bool {
    COUNTED.contains(&keyword)
}

/// Keywords of two words that CalculiX knows without the space, too.
const TOGETHER: [&str; 16] = [
    "SOLID SECTION",
    "SHELL SECTION",
    "MEMBRANE SECTION",
    "SURFACE SECTION",
    "BEAM SECTION",
    "RIGID BODY",
    "END PART",
    "END INSTANCE",
    "END ASSEMBLY",
    "END STEP",
    "NODE FILE",
    "NODE PRINT",
    "EL FILE",
    "EL PRINT",
    "CONTACT PAIR",
    "DESIGN VARIABLES",
];

/// A keyword with the space that it may lack.
pub(super) fn spaced(keyword: String) -> String {
    let known = TOGETHER.iter().find(|known| known.replace(' ', "") == keyword);
    known.map_or(keyword, |known| (*known).to_owned())
}
