//! What was refused or did not work, by area, as data. The English stands beside it; `words/say` has the Korean, and the
//! English without commands that a window shows.

use btu_rig::rig::LinkTrouble;
use fault_db::Id;
use protocol::Duration;
use thiserror::Error;

use super::{Near, Trouble};
use crate::keys::Standing;
use crate::link::{Endpoint, EndpointError};
use crate::run_diagnosis::Warning;

/// A name that is none.
#[derive(Clone, Debug, Error)]
pub enum Unknown {
    /// A fault mode.
    #[error("no fault \"{0}\"{1}; `ptu catalog faults` lists them")]
    Fault(String, Near),
    /// A part of the catalogue.
    #[error("no part \"{0}\"{1}; `ptu catalog parts` lists them")]
    Part(String, Near),
    /// A symptom that the catalogue does not have.
    #[error("no symptom \"{0}\"{1}; `ptu catalog symptoms` lists them")]
    Symptom(String, Near),
    /// A procedure, or a file with one.
    #[error("no procedure or file \"{0}\"{1}; `ptu run --list` shows all")]
    Procedure(String, Near),
    /// A step, by a glob.
    #[error("no step matches \"{0}\"; `ptu run --list` shows all steps")]
    Step(String),
    /// A signal of two traces.
    #[error("no signal \"{0}\" in the traces; `ptu catalog signals` lists them")]
    Signal(String),
    /// A unit that has runs.
    #[error("no unit \"{0}\" was ever tested{1}; `ptu runs list` shows the units")]
    Unit(String, Near),
    /// An instrument of the bench.
    #[error(
        "no instrument \"{0}\" is registered{1}; `ptu instrument list` shows them, `ptu instrument add` registers one"
    )]
    Instrument(String, Near),
    /// A key, by its owner or its beginning.
    #[error("no key \"{0}\" in the list{1}; `ptu key list` shows them")]
    Key(String, Near),
    /// A data file: which kind, its name, what is near, and all there are.
    #[error("no {0} \"{1}\"{2}; known: {3}")]
    DataFile(&'static str, String, Near, String),
    /// A section of a line.
    #[error("line {0} has no section {1}")]
    Section(String, u16),
}

/// Why a file does not serve.
#[derive(Clone, Debug, Error)]
pub enum Why {
    /// What the system or a reader said.
    #[error("{0}")]
    Said(String),
    /// A path that ends in none.
    #[error("it has no file name")]
    NoFileName,
    /// Nothing is there that could hold it.
    #[error("there is no folder {0}")]
    NoFolder(String),
    /// A folder stands there.
    #[error("it is a folder")]
    Folder,
    /// A device or a pipe stands there.
    #[error("it is no regular file")]
    NoFile,
    /// A history stands there.
    #[error("it is a history or another database, or belongs to one")]
    History,
    /// What stands there is not of this kind.
    #[error("what is there was not written as this kind by this program; name another file")]
    OtherKind,
    /// Something came there meanwhile.
    #[error("it is there already")]
    Taken,
    /// The file's bytes are not UTF-8.
    #[error("it is not UTF-8")]
    NoText,
    /// It begins as none of `ptu key new`.
    #[error("it holds no private key")]
    NoPrivateKey,
    /// Its two halves are of two keys.
    #[error("its public key is not that of its private key")]
    OtherPublicKey,
}

impl Why {
    /// What the system or a reader said.
    pub fn of(said: impl std::fmt::Display) -> Self {
        Self::Said(said.to_string())
    }
}

/// A file or a folder.
#[derive(Clone, Debug, Error)]
pub enum FileTrouble {
    /// It cannot be read.
    #[error("cannot read {0}: {1}")]
    Unread(String, Why),
    /// It cannot be written.
    #[error("cannot write {0}: {1}")]
    Unwritten(String, Why),
    /// The folder cannot be made.
    #[error("cannot make {0}: {1}")]
    Unmade(String, Why),
    /// A file that may not be replaced.
    #[error("{0} is there already; name another file, or say --force to replace it")]
    Exists(String),
    /// The file that was named does not exist.
    #[error("there is no file {0}")]
    Missing(String),
    /// The system says no place for files of this user; the option that names one.
    #[error("no user data directory; name a place with {0}")]
    NoUserFolder(&'static str),
    /// All scripts under this folder have more bytes than that.
    #[error("the scripts in {0} are longer than {1} bytes together")]
    ScriptsTooLong(String, usize),
    /// Others can read this secret; their rights, and the command that takes them.
    #[error(
        "a secret that is shared protects nothing: {0} is open to others ({1}); to keep it to yourself: {2}"
    )]
    Shared(String, String, String),
    /// Standard output did not take an answer.
    #[error("cannot write the answer: {0}; make room on standard output or send it elsewhere")]
    Unanswered(String),
}

impl FileTrouble {
    /// It cannot be read, and who reads it says why.
    pub fn unread(file: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::Unread(file.display().to_string(), Why::of(why))
    }
}

/// Keys that sign.
#[derive(Clone, Debug, Error)]
pub enum KeyTrouble {
    /// So many letters or digits at least.
    #[error("a PIN has at least {0} letters or digits")]
    ShortPin(usize),
    /// The PIN that was typed first is not that of the second time.
    #[error("the two PINs differ; no key was made")]
    PinsDiffer,
    /// Nobody can be asked for it.
    #[error(
        "the key is protected by a PIN, and there is no terminal to ask for it; put it into a file that only you can \
         read and name that with --pin-file, or set PTU_PIN"
    )]
    NoPin,
    /// It is not that of this key file.
    #[error("the PIN of {0} is wrong; nothing was signed")]
    WrongPin(String),
    /// Why none was made.
    #[error("no key was made: {0}")]
    NotMade(String),
    /// Looked for where.
    #[error("there is no key file {0}; `ptu key new` makes one, `ptu key list` shows yours")]
    Missing(Sought),
    /// A list that is looked for.
    #[error("there is no list of keys {0}; `ptu key trust FILE.pub --keys FILE` begins one")]
    NoList(Sought),
    /// The public key file that is to be trusted does not exist.
    #[error("there is no file {0}; it is the `.pub` file that `ptu key new` made")]
    NoPublicFile(Sought),
    /// A file that `ptu key new` did not make.
    #[error("{0} is no key file of `ptu key new`: {1}")]
    NoKeyFile(String, Why),
    /// A file that is no list.
    #[error("{0} is no list of keys: {1}")]
    NoKeyList(String, Why),
    /// A file that was changed.
    #[error("the key file {0} is damaged: {1}; take your copy of it")]
    Damaged(String, Why),
    /// A key that does not hold today.
    #[error("the key in {0} {text}: nothing is signed with it; `ptu key new` makes another", text = .1.text())]
    NotHeld(String, Standing),
}

/// A file that was looked for, and the folder of one's own keys if it was looked for there, too.
#[derive(Clone, Debug)]
pub struct Sought {
    /// As it was named.
    pub file: String,
    /// Where else.
    pub folder: Option<String>,
}

impl std::fmt::Display for Sought {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.file)?;
        match &self.folder {
            Some(folder) => write!(f, ", neither in the current folder nor in {folder}"),
            None => Ok(()),
        }
    }
}

/// A bench, or a run on it.
#[derive(Clone, Debug, Error)]
pub enum RunTrouble {
    /// The unit's place is written wrong.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// The embedded unit is reached without one.
    #[error("the embedded unit has no port")]
    NoPort,
    /// The system does not tell which ports there are.
    #[error("cannot list serial ports: {0}")]
    PortsNotListed(String),
    /// A fault of a unit that runs elsewhere.
    #[error(
        "--inject puts faults of a unit into the embedded one only; inject into a served one with `ato-under-test --inject`"
    )]
    InjectElsewhere,
    /// Waveforms over a serial port.
    #[error(
        "--signals sampled needs 6 Mbit/s, more than a serial port: use sim, tcp:HOST:PORT or lockstep:PATH"
    )]
    SampledOnSerial,
    /// Longest serial number.
    #[error("a serial number is 1 to {0} ASCII characters")]
    SerialNumber(usize),
    /// No limit can be narrowed.
    #[error(
        "no instrument is registered with an uncertainty, by which limits could be narrowed; `ptu instrument calibrate` \
         states one"
    )]
    NoUncertainty,
    /// A pattern of names, and what is wrong with it.
    #[error("\"{0}\" is not a glob: {1}")]
    Glob(String, String),
    /// Why scripts cannot be loaded apart.
    #[error("cannot load scripts in a process of their own: {0}")]
    NotLoadedApart(String),
    /// What cannot be started, or a thread; and why.
    #[error("cannot start {what}: {1}", what = .0.as_deref().unwrap_or("a thread"))]
    NotStarted(Option<String>, String),
    /// What writes a run ended before it.
    #[error("the writer ended unexpectedly")]
    WriterEnded,
    /// A defect of this program, in this run.
    #[error(
        "the program failed in run {}, which is recorded as an error; please report what stands before this",
        .0.short()
    )]
    ProgramFailed(Id),
}

/// The log or the memory of a unit.
#[derive(Clone, Debug, Error)]
pub enum FieldTrouble {
    /// A unit whose log cannot be dated.
    #[error(
        "the simulated unit keeps no log from run to run; name a unit on a port with --unit serial:PATH or tcp:HOST:PORT"
    )]
    Simulated,
    /// A unit in lock step: its clock dates no entry.
    #[error(
        "the clock of a unit in lock step stands between scans, which dates no entry; name a unit on a port with \
         --unit serial:PATH or tcp:HOST:PORT"
    )]
    LockStep,
    /// Nothing was read.
    #[error("{0}: {1}")]
    NotRead(Endpoint, BrokenOff),
    /// Part of it was read.
    #[error("{0}; the log was not read to its end, what was read is kept; read it again")]
    NotWhole(BrokenOff),
    /// An older unit.
    #[error(
        "this unit has no stored memory: its run record is lost at power off, and cannot be pulled"
    )]
    NoMemory,
}

/// Why reading a log ended before it did.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BrokenOff {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkTrouble),
    /// Somebody stopped it.
    #[error("stopped by the operator")]
    Stopped,
    /// It grows as fast as it is read.
    #[error("the log does not end within {0}")]
    TooLong(Duration),
}

/// A trace, or the recording that belongs to it.
#[derive(Clone, Debug, Error)]
pub enum RecordTrouble {
    /// A trace without one.
    #[error(
        "trace {} has no recording of what was done to the bench: it is of an earlier version, or its run broke off",
        .0.short()
    )]
    NoRecording(Id),
    /// A trace without rows.
    #[error("trace {} has no rows", .0.short())]
    NoRows(Id),
    /// A trace of no time of its procedure.
    #[error("trace {} names times at which no procedure was under way", .0.short())]
    NoTimes(Id),
    /// A recording of another version: of which procedure, and what its reader says.
    #[error("the recording of {0} cannot be read by this version: {1}")]
    OtherVersion(String, String),
    /// A recording of this procedure that lacks so many stimuli.
    #[error("the recording of {0} is not whole: {1} stimuli found no room in it")]
    NotWhole(String, u32),
    /// It was made with this kind of data file, of this name, which fails so now.
    #[error("the recording was made with {0} \"{1}\", which cannot be had any more: {2}")]
    Gone(&'static str, String, Box<Trouble>),
    /// The same, with the checksums of then and now.
    #[error(
        "the {0} \"{1}\" was changed since the recording (sha256 {2}, now {3}): what was expected then cannot be told; \
         give the scripts directory of that time with --scripts"
    )]
    Changed(&'static str, String, String, String),
    /// Rows of so many ms each.
    #[error("the traces have rows of {0} ms and {1} ms: they cannot be laid side by side")]
    Periods(i64, i64),
    /// Two traces of two times.
    #[error(
        "the traces have no time in common around their triggers, or the recording begins after the end of the trace"
    )]
    NoCommonTime,
    /// A replay that was stopped.
    #[error("stopped before anything was recorded")]
    Stopped,
    /// A replay whose unit does not start.
    #[error("the embedded unit does not become ready")]
    NotReady,
    /// A trace that is no run record lacks this signal.
    #[error("the trace has no signal {0}: it is no run record of a unit")]
    NoRunRecord(String),
    /// A run record of a train that stands.
    #[error("the train never moves in this trace")]
    NeverMoves,
    /// A run record by which no section is found.
    #[error("the trace passes no marker and does not stop: name its section with --section")]
    NoMarkers,
    /// No section of this line fits.
    #[error(
        "no section of line {0} has its markers and its stop where this run found them: name the line with --line, or \
         the section with --section"
    )]
    NoSectionFits(String),
    /// Several sections of the line fit.
    #[error("sections {0} fit this run alike: name one with --section")]
    SectionsAlike(String),
}

/// A diagnosis.
#[derive(Clone, Debug, Error)]
pub enum DiagnosisTrouble {
    /// A run beside itself.
    #[error("run {0} is named twice")]
    RunTwice(Id),
    /// A run, its unit and configuration, and those of the run that it was named beside.
    #[error(
        "run {0} is of unit {1}, {2}, and not of {3}, {4}; runs of one unit alone are diagnosed together"
    )]
    OtherUnit(Id, String, String, String, String),
    /// Nothing to diagnose by.
    #[error("there is no fault dictionary; `ptu campaign` makes one in a few minutes")]
    NoDictionary,
    /// A history whose dictionary cannot be read.
    #[error("{0}: a fault dictionary is damaged: {1}")]
    Damaged(String, String),
    /// What an adaptive run must not go by.
    #[error("{}", .0.iter().map(Warning::to_string).collect::<Vec<_>>().join("; "))]
    Stale(Vec<Warning>),
    /// The configuration, line and train that it was made on.
    #[error(
        "the fault dictionary was made with unit configuration {0}, {1} and train {2}; an adaptive run needs the same"
    )]
    OtherBench(&'static str, String, String),
}

/// Makes a trouble of each area.
macro_rules! areas {
    ($($area:ident($of:ident),)*) => { $(
        impl From<$of> for Trouble {
            fn from(of: $of) -> Self {
                Self::$area(of)
            }
        }
    )* };
}
areas! {
    Unknown(Unknown), File(FileTrouble), Key(KeyTrouble), Run(RunTrouble), Field(FieldTrouble),
    Recorded(RecordTrouble), Diagnosis(DiagnosisTrouble),
}
