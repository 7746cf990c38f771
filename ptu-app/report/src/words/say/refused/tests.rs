//! Each refusal in both languages.

use fault_db::Id;
use protocol::Duration;
use ptu_runs::failure::Trouble;
use ptu_runs::link::Endpoint;
use ptu_runs::run_diagnosis::Warning;

use super::super::super::Language;
use super::*;

const AREAS: &str = include_str!("../../../../../runs/src/failure/refused.rs");

/// One of each, with numbers of its own.
fn all() -> Vec<Trouble> {
    let (id, near) = (Id::from_bytes([7; 16]), || Near(Some("n9".into())));
    let of = |number: u32| format!("x{number}");
    let sought = |folder: Option<&str>| Sought {
        file: "f90".into(),
        folder: folder.map(Into::into),
    };
    let whys = [
        Why::Said(of(10)),
        Why::NoFileName,
        Why::NoFolder(of(11)),
        Why::Folder,
        Why::NoFile,
        Why::History,
        Why::OtherKind,
        Why::Taken,
        Why::NoText,
        Why::NoPrivateKey,
        Why::OtherPublicKey,
    ];
    let standings = [
        Standing::Held,
        Standing::Unknown,
        Standing::OtherName(of(12)),
        Standing::NotYet(of(13)),
        Standing::Expired(of(14)),
        Standing::Revoked(of(15)),
    ];
    let ends = [
        BrokenOff::Link(btu_rig::rig::LinkTrouble::LogNotAnswered { times: 16 }),
        BrokenOff::Stopped,
        BrokenOff::TooLong(Duration::from_us(17_000_000)),
    ];
    let at: Endpoint = "tcp:h:18".parse().expect("a place");
    let mut all: Vec<Trouble> = vec![
        Unknown::Fault(of(20), near()).into(),
        Unknown::Part(of(21), near()).into(),
        Unknown::Symptom(of(22), near()).into(),
        Unknown::Procedure(of(23), near()).into(),
        Unknown::Step(of(24)).into(),
        Unknown::Signal(of(25)).into(),
        Unknown::Unit(of(26), near()).into(),
        Unknown::Instrument(of(27), near()).into(),
        Unknown::Key(of(28), Near(None)).into(),
        Unknown::DataFile("line", of(29), near(), of(30)).into(),
        Unknown::Section(of(31), 32).into(),
        FileTrouble::Unwritten(of(33), Why::Taken).into(),
        FileTrouble::Unmade(of(34), Why::Taken).into(),
        FileTrouble::Exists(of(35)).into(),
        FileTrouble::Missing(of(36)).into(),
        FileTrouble::NoUserFolder("--keys").into(),
        FileTrouble::ScriptsTooLong(of(37), 38).into(),
        FileTrouble::Shared(of(39), of(40), "chmod".into()).into(),
        FileTrouble::Unanswered(of(41)).into(),
        KeyTrouble::ShortPin(42).into(),
        KeyTrouble::PinsDiffer.into(),
        KeyTrouble::NoPin.into(),
        KeyTrouble::WrongPin(of(43)).into(),
        KeyTrouble::NotMade(of(44)).into(),
        KeyTrouble::Missing(sought(Some("d91"))).into(),
        KeyTrouble::NoList(sought(None)).into(),
        KeyTrouble::NoPublicFile(sought(Some("d92"))).into(),
        KeyTrouble::NoKeyFile(of(45), Why::NoText).into(),
        KeyTrouble::NoKeyList(of(46), Why::NoText).into(),
        KeyTrouble::Damaged(of(47), Why::NoText).into(),
        RunTrouble::Endpoint(EndpointError::Unknown).into(),
        RunTrouble::Endpoint(EndpointError::Address(of(48))).into(),
        RunTrouble::Endpoint(EndpointError::Baud(of(49))).into(),
        RunTrouble::Endpoint(EndpointError::NoPort).into(),
        RunTrouble::NoPort.into(),
        RunTrouble::PortsNotListed(of(50)).into(),
        RunTrouble::InjectElsewhere.into(),
        RunTrouble::SampledOnSerial.into(),
        RunTrouble::SerialNumber(51).into(),
        RunTrouble::NoUncertainty.into(),
        RunTrouble::Glob(of(52), of(53)).into(),
        RunTrouble::NotLoadedApart(of(54)).into(),
        RunTrouble::NotStarted(Some(of(55)), of(56)).into(),
        RunTrouble::NotStarted(None, of(57)).into(),
        RunTrouble::WriterEnded.into(),
        RunTrouble::ProgramFailed(id).into(),
        FieldTrouble::Simulated.into(),
        FieldTrouble::LockStep.into(),
        FieldTrouble::NotRead(at, BrokenOff::Stopped).into(),
        FieldTrouble::NoMemory.into(),
        RecordTrouble::NoRecording(id).into(),
        RecordTrouble::NoRows(id).into(),
        RecordTrouble::NoTimes(id).into(),
        RecordTrouble::OtherVersion(of(58), of(59)).into(),
        RecordTrouble::NotWhole(of(60), 61).into(),
        RecordTrouble::Gone("line", of(62), Box::new(RecordTrouble::NotReady.into())).into(),
        RecordTrouble::Changed("train", of(63), of(64), of(65)).into(),
        RecordTrouble::Periods(66, 67).into(),
        RecordTrouble::NoCommonTime.into(),
        RecordTrouble::Stopped.into(),
        RecordTrouble::NoRunRecord(of(68)).into(),
        RecordTrouble::NeverMoves.into(),
        RecordTrouble::NoMarkers.into(),
        RecordTrouble::NoSectionFits(of(69)).into(),
        RecordTrouble::SectionsAlike(of(70)).into(),
        DiagnosisTrouble::RunTwice(id).into(),
        DiagnosisTrouble::OtherUnit(id, of(71), of(72), of(73), of(74)).into(),
        DiagnosisTrouble::NoDictionary.into(),
        DiagnosisTrouble::Damaged(of(75), of(76)).into(),
        DiagnosisTrouble::Stale(vec![Warning::KnowsPart { modes: 77, of: 78 }]).into(),
        DiagnosisTrouble::OtherBench("unit79", of(80), of(81)).into(),
    ];
    all.extend(whys.map(|why| FileTrouble::Unread("f93".into(), why).into()));
    all.extend(standings.map(|held| KeyTrouble::NotHeld("f94".into(), held).into()));
    all.extend(ends.map(|end| FieldTrouble::NotWhole(end).into()));
    all
}

fn numbers(text: &str) -> Vec<&str> {
    let all = text.split(|c: char| !c.is_ascii_digit());
    let mut all: Vec<_> = all.filter(|number| !number.is_empty()).collect();
    all.sort_unstable();
    all
}

#[test]
fn each_refusal_is_said_in_both_languages_with_the_same_numbers() {
    let all = all();
    let made = format!("{all:?}");
    for variant in AREAS.split(")]\n    ").skip(1) {
        let name = variant.split(['(', ',']).next().expect("a name");
        assert!(made.contains(name), "{name} is not among them");
    }
    for trouble in &all {
        let [english, korean] = Language::ALL.map(|language| language.words().trouble(trouble));
        let hangul = |letter: char| ('가'..='힣').contains(&letter);
        assert!(korean.contains(hangul), "{trouble:?}: {korean:?}");
        assert!(
            !english.is_empty() && !english.contains(hangul),
            "{english}"
        );
        assert_eq!(numbers(&english), numbers(&korean), "{english}\n{korean}");
    }
}
