//! Names of cards.

/// Cards of analyses, output and numbering, which are nothing of a body.
const SILENT: &[&str] = &[
    "BEGIN", "DCONSTR", "DESVAR", "DRESP1", "DRESP2", "EIGB", "EIGC", "EIGR", "EIGRL", "EIGP", "FREQ", "FREQ1",
    "FREQ2", "FREQ3", "FREQ4", "FREQ5", "GRDSET", "MDLPRM", "NLPARM", "NLPCI", "PARAM", "TSTEP", "TSTEPNL", "TSTEP1",
];

/// Cards that are counted by their names. Others may be lines of any file, and are not shown.
const KNOWN: &[&str] = &[
    "ACCEL", "ACCEL1", "ASET", "ASET1", "BCONP", "BCTABLE", "BCTSET", "BSURF", "BSURFS", "BLSEG", "BSET", "BSET1",
    "CAERO1", "CBAR", "CBARAO", "CBEAM", "CBEAM3", "CBEND", "CBUSH", "CBUSH1D", "CBUSH2D", "CCONEAX", "CDAMP1",
    "CDAMP2", "CDAMP3", "CDAMP4", "CDAMP5", "CELAS1", "CELAS2", "CELAS3", "CELAS4", "CFAST", "CGAP", "CHBDYE",
    "CHBDYG", "CHBDYP", "CMASS1", "CMASS2", "CMASS3", "CMASS4", "CONM1", "CONROD", "CORD3G", "CORD3R", "CONV", "CQUAD",
    "CQUAD4", "CQUAD8", "CQUADR", "CQUADX", "CROD", "CSEAM", "CSET", "CSET1", "CSHEAR", "CTRIAX", "CTRIAX6", "CTUBE",
    "CVISC", "CWELD", "DAMPING", "DAREA", "DEFORM", "DEQATN", "DELAY", "DLOAD", "DMI", "DMIG", "DPHASE", "DTI",
    "EPOINT", "FORCE", "FORCE1", "FORCE2", "GENEL", "GRAV", "LOAD", "LSEQ", "MAT10", "MAT11", "MAT2", "MAT3", "MAT4",
    "MAT5", "MAT8", "MAT9", "MATS1", "MATT1", "MATT9", "MOMENT", "MOMENT1", "MOMENT2", "MPC", "MPCADD", "NSM", "NSM1",
    "NSMADD", "NSML", "NSML1", "OMIT", "OMIT1", "PBAR", "PBARL", "PBEAM", "PBEAML", "PBEND", "PBUSH", "PBUSH1D",
    "PBUSHT", "PCOMP", "PCOMPG", "PCOMPS", "PDAMP", "PELAS", "PELAST", "PFAST", "PGAP", "PLOAD", "PLOAD1", "PLOAD2",
    "PLOAD4", "PLOTEL", "PLSOLID", "PMASS", "PROD", "PSHEAR", "PSHELL", "PTUBE", "PVISC", "PWELD", "QSET", "QSET1",
    "RANDPS", "RBAR", "RBAR1", "RBE1", "RBE2", "RBE3", "RFORCE", "RJOINT", "RLOAD1", "RLOAD2", "ROD", "RROD",
    "RSPLINE", "RSSCON", "RTRPLT", "SET", "SET1", "SET3", "SPC", "SPC1", "SPCADD", "SPCD", "SPOINT", "SUPORT",
    "SUPORT1", "TABDMP1", "TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABLES1", "TABLEM1", "TABRND1", "TABRNDG",
    "TEMP", "TEMPD", "TIC", "TLOAD1", "TLOAD2", "USET", "USET1",
];

/// Elements that fill a volume and are no tetrahedra.
pub(super) const SOLIDS: &[&str] = &["CHEXA", "CPENTA", "CPYRA", "CPYRAM", "CHEXA20", "CIFHEX", "CIFPENT"];

pub(super) fn is_silent(name: &str) -> bool {
    SILENT.contains(&name)
}

/// The name of a card that is not used, as it is told.
pub(super) fn known(name: &str) -> Option<&'static str> {
    KNOWN.iter().find(|known| **known == name).copied()
}
