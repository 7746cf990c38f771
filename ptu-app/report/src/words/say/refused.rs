//! What was refused or did not work, by area; where its own English names a command, the window's does not.

use ptu_runs::failure::{
    BrokenOff, DiagnosisTrouble, FieldTrouble, FileTrouble, KeyTrouble, Near, RecordTrouble,
    RunTrouble, Sought, Unknown, Why,
};
use ptu_runs::keys::Standing;
use ptu_runs::link::EndpointError;

use super::super::content;
use super::diagnosis::Both;
use super::reasons::warned;
use super::{link, trouble};

#[rustfmt::skip]
pub(super) fn unknown(what: &Unknown) -> Both {
    use Unknown as U;
    let none = |english: &str, korean: &str, asked: &str, near: &Near| [
        format!("no {english} \"{asked}\"{near}"),
        format!("{korean} \"{asked}\"이(가) 없습니다{near:#}"),
    ];
    match what {
        U::Fault(asked, near) => none("fault", "고장 모드", asked, near),
        U::Part(asked, near) => none("part", "부품", asked, near),
        U::Symptom(asked, near) => none("symptom", "증상", asked, near),
        U::Procedure(asked, near) => none("procedure or file", "절차 또는 파일", asked, near),
        U::Step(asked) => none("step", "단계", asked, &Near(None)),
        U::Signal(asked) => none("signal", "신호", asked, &Near(None)),
        U::Unit(asked, near) => none("tested unit", "시험한 장치", asked, near),
        U::Instrument(asked, near) => none("registered instrument", "등록된 계측기", asked, near),
        U::Key(asked, near) => none("listed key", "목록의 키", asked, near),
        U::DataFile(what, asked, near, known) => {
            let [english, korean] = none(what, trouble::noun(what), asked, near);
            [format!("{english}; known: {known}"), format!("{korean}. 있는 것: {known}")]
        }
        U::Section(line, number) => [what.to_string(), format!("노선 {line}에 구간 {number}이(가) 없습니다")],
    }
}

/// What the system or a reader said stays as it is where it has no Korean.
#[rustfmt::skip]
fn why(why: &Why) -> String {
    match why {
        Why::Said(said) => content::korean(said).into_owned(),
        Why::NoFileName => "파일 이름이 없음".to_owned(),
        Why::NoFolder(folder) => format!("폴더가 없음: {folder}"),
        Why::Folder => "폴더임".to_owned(),
        Why::NoFile => "일반 파일이 아님".to_owned(),
        Why::History => "이력 또는 다른 데이터베이스이거나 그 일부임".to_owned(),
        Why::OtherKind => "기존 파일은 이 프로그램이 만든 같은 종류의 파일이 아님. 다른 파일을 지정하십시오".to_owned(),
        Why::Taken => "이미 있음".to_owned(),
        Why::NoText => "UTF-8 텍스트가 아님".to_owned(),
        Why::NoPrivateKey => "개인 키가 없음".to_owned(),
        Why::OtherPublicKey => "공개 키가 개인 키의 것이 아님".to_owned(),
    }
}

#[rustfmt::skip]
pub(super) fn file(what: &FileTrouble) -> Both {
    use FileTrouble as F;
    let same = |korean: String| [what.to_string(), korean];
    match what {
        F::Unread(file, reason) => same(format!("읽을 수 없습니다: {file} ({})", why(reason))),
        F::Unwritten(file, reason) => same(format!("쓸 수 없습니다: {file} ({})", why(reason))),
        F::Unmade(folder, reason) => same(format!("폴더를 만들 수 없습니다: {folder} ({})", why(reason))),
        F::Exists(file) => [
            format!("{file} is there already; name another file"),
            format!("이미 있습니다: {file}. 다른 파일을 지정하십시오"),
        ],
        F::Missing(file) => same(format!("파일이 없습니다: {file}")),
        F::NoUserFolder(_) => [
            "no user data directory".to_owned(),
            "사용자 데이터 폴더가 없습니다".to_owned(),
        ],
        F::ScriptsTooLong(folder, most) => same(format!("스크립트가 모두 합하여 {most}바이트를 넘습니다: {folder}")),
        F::Shared(file, rights, _) => [
            format!("a secret that is shared protects nothing: {file} is open to others ({rights}); keep it to yourself"),
            format!("비밀은 공유되면 보호되지 않습니다: 다른 사용자가 읽을 수 있는 파일입니다: {file} ({rights}). 본인만 읽을 수 있게 하십시오"),
        ],
        F::Unanswered(reason) => same(format!("결과를 출력할 수 없습니다: {reason}. 공간을 확보하거나 다른 곳으로 출력하십시오")),
    }
}

fn sought(of: &Sought) -> String {
    match &of.folder {
        Some(folder) => format!("{}. 현재 폴더와 {folder}에 없습니다", of.file),
        None => of.file.clone(),
    }
}

#[rustfmt::skip]
pub(super) fn key(what: &KeyTrouble) -> Both {
    use KeyTrouble as K;
    let same = |korean: String| [what.to_string(), korean];
    match what {
        K::ShortPin(letters) => same(format!("PIN은 글자나 숫자가 {letters}자 이상이어야 합니다")),
        K::PinsDiffer => same("두 PIN이 서로 다릅니다. 키를 만들지 않았습니다".to_owned()),
        K::NoPin => [
            "the key is protected by a PIN, and there is no terminal to ask for it".to_owned(),
            "키가 PIN으로 보호되어 있으나 PIN을 물을 터미널이 없습니다. PIN을 본인만 읽을 수 있는 파일에 두고 그 파일을 지정하십시오".to_owned(),
        ],
        K::WrongPin(file) => same(format!("PIN이 틀렸습니다: {file}. 아무것도 서명하지 않았습니다")),
        K::NotMade(reason) => same(format!("키를 만들지 못했습니다: {reason}")),
        K::Missing(file) => [format!("there is no key file {file}"), format!("키 파일이 없습니다: {}", sought(file))],
        K::NoList(file) => [format!("there is no list of keys {file}"), format!("키 목록이 없습니다: {}", sought(file))],
        K::NoPublicFile(file) => [format!("there is no file {file}"), format!("파일이 없습니다: {}", sought(file))],
        K::NoKeyFile(file, reason) => [format!("{file} is no key file: {reason}"), format!("키 파일이 아닙니다: {file} ({})", why(reason))],
        K::NoKeyList(file, reason) => same(format!("키 목록이 아닙니다: {file} ({})", why(reason))),
        K::Damaged(file, reason) => same(format!("키 파일이 손상되었습니다: {file} ({}). 사본을 쓰십시오", why(reason))),
        K::NotHeld(file, held) => [
            format!("the key in {file} {}: nothing is signed with it", held.text()),
            format!("{file}의 키: {}. 이 키로 서명하지 않습니다. 새 키를 만드십시오", standing(held)),
        ],
    }
}

#[rustfmt::skip]
fn standing(of: &Standing) -> String {
    match of {
        Standing::Held => "목록에 있고 당시 유효함".to_owned(),
        Standing::Unknown => "키 목록에 없음".to_owned(),
        Standing::OtherName(name) => format!("키 목록에는 {name}의 키임"),
        Standing::NotYet(day) => format!("{day}부터 유효함"),
        Standing::Expired(day) => format!("{day}에 만료됨"),
        Standing::Revoked(day) => format!("{day}부터 폐지됨"),
    }
}

#[rustfmt::skip]
pub(super) fn run(what: &RunTrouble) -> Both {
    use RunTrouble as R;
    let same = |korean: String| [what.to_string(), korean];
    match what {
        R::Endpoint(EndpointError::Unknown) => [
            "a unit is sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH".to_owned(),
            "장치는 sim, serial:PATH[@BAUD], tcp:HOST:PORT 또는 lockstep:PATH 형식으로 지정합니다".to_owned(),
        ],
        R::Endpoint(EndpointError::Address(text)) => same(format!("\"{text}\"은(는) HOST:PORT 형식이 아닙니다")),
        R::Endpoint(EndpointError::Baud(text)) => same(format!("\"{text}\"은(는) 통신 속도가 아닙니다")),
        R::Endpoint(EndpointError::NoPort) => ["serial: needs a port".to_owned(), "serial: 뒤에 포트를 지정하십시오".to_owned()],
        R::NoPort => same("모의 장치에는 포트가 없습니다".to_owned()),
        R::PortsNotListed(reason) => same(format!("직렬 포트 목록을 읽을 수 없습니다: {reason}")),
        R::InjectElsewhere => [
            "faults of a unit can be injected into the simulated one only".to_owned(),
            "장치의 고장 모드는 모의 장치에만 주입할 수 있습니다".to_owned(),
        ],
        R::SampledOnSerial => [
            "sampled waveforms need 6 Mbit/s, more than a serial port: use sim, tcp:HOST:PORT or lockstep:PATH".to_owned(),
            "파형 신호에는 6 Mbit/s가 필요하여 직렬 포트로는 보낼 수 없습니다. sim, tcp:HOST:PORT 또는 lockstep:PATH를 쓰십시오".to_owned(),
        ],
        R::SerialNumber(longest) => same(format!("일련번호는 ASCII 문자 1~{longest}자입니다")),
        R::NoUncertainty => [
            "no instrument is registered with an uncertainty, by which limits could be narrowed".to_owned(),
            "불확도가 등록된 계측기가 없어 한계값을 좁힐 수 없습니다".to_owned(),
        ],
        R::Glob(glob, reason) => same(format!("\"{glob}\"은(는) 올바른 패턴이 아닙니다: {reason}")),
        R::NotLoadedApart(reason) => same(format!("스크립트를 별도 프로세스에서 읽을 수 없습니다: {reason}")),
        R::NotStarted(Some(program), reason) => same(format!("시작할 수 없습니다: {program} ({reason})")),
        R::NotStarted(None, reason) => same(format!("스레드를 시작할 수 없습니다: {reason}")),
        R::WriterEnded => same("기록이 예기치 않게 끝났습니다".to_owned()),
        R::ProgramFailed(run) => same(format!("시험 {} 중 프로그램에 결함이 발생했습니다. 시험은 판정 불가로 기록되었습니다. 앞에 표시된 내용을 알려 주십시오", run.short())),
    }
}

#[rustfmt::skip]
pub(super) fn field(what: &FieldTrouble) -> Both {
    use FieldTrouble as F;
    match what {
        F::Simulated => [
            "the simulated unit keeps no log from run to run; choose a unit on a port".to_owned(),
            "모의 장치에는 시험 사이에 남는 고장 기록이 없습니다. 포트에 연결된 장치를 선택하십시오".to_owned(),
        ],
        F::LockStep => [
            "the clock of a unit in lock step stands between scans, which dates no entry; choose a unit on a port".to_owned(),
            "동기 방식 장치의 시계는 스캔 사이에 멈추어 기록의 날짜를 알 수 없습니다. 포트에 연결된 장치를 선택하십시오".to_owned(),
        ],
        F::NotRead(at, why) => [what.to_string(), format!("{at}: {}", log_end(why))],
        F::NotWhole(why) => [what.to_string(), format!("{}. 기록을 끝까지 읽지 못했습니다. 읽은 내용은 보관했습니다. 다시 읽으십시오", log_end(why))],
        F::NoMemory => [what.to_string(), "이 장치에는 저장 메모리가 없습니다. 주행 기록이 전원 차단 시 없어지므로 가져올 수 없습니다".to_owned()],
    }
}

fn log_end(why: &BrokenOff) -> String {
    match why {
        BrokenOff::Link(why) => link::korean(why),
        BrokenOff::Stopped => "시험자가 중지함".to_owned(),
        BrokenOff::TooLong(within) => format!("기록이 {within} 안에 끝나지 않음"),
    }
}

#[rustfmt::skip]
pub(super) fn recorded(what: &RecordTrouble) -> Both {
    use RecordTrouble as R;
    let same = |korean: String| [what.to_string(), korean];
    match what {
        R::NoRecording(trace) => same(format!("신호 기록 {}에는 시험대 조작 기록이 없습니다: 이전 버전의 기록이거나 시험이 중단되었습니다", trace.short())),
        R::NoRows(trace) => same(format!("신호 기록 {}에 행이 없습니다", trace.short())),
        R::NoTimes(trace) => same(format!("신호 기록 {}의 시각에 진행 중인 절차가 없었습니다", trace.short())),
        R::OtherVersion(procedure, reason) => same(format!("{procedure}의 조작 기록을 이 버전에서 읽을 수 없습니다: {reason}")),
        R::NotWhole(procedure, lost) => same(format!("{procedure}의 조작 기록이 온전하지 않습니다: 조작 {lost}개를 기록하지 못함")),
        R::Gone(kind, name, reason) => {
            let [english, korean] = trouble::both(reason);
            [
                format!("the recording was made with {kind} \"{name}\", which cannot be had any more: {english}"),
                format!("기록할 때의 {} \"{name}\"을(를) 쓸 수 없습니다: {korean}", trouble::noun(kind)),
            ]
        }
        R::Changed(kind, name, was, is) => [
            format!("the {kind} \"{name}\" was changed since the recording (sha256 {was}, now {is}): what was expected then cannot be told"),
            format!("기록 후 {} \"{name}\"이(가) 변경되어 (SHA-256 {was} → {is}) 당시 기대값을 알 수 없습니다", trouble::noun(kind)),
        ],
        R::Periods(one, other) => same(format!("신호 기록의 주기가 {one} ms와 {other} ms로 달라 비교할 수 없습니다")),
        R::NoCommonTime => same("두 신호 기록에 트리거 전후의 공통 시간이 없거나, 조작 기록이 신호 기록의 끝보다 늦게 시작합니다".to_owned()),
        R::Stopped => same("기록되기 전에 중지되었습니다".to_owned()),
        R::NotReady => same("모의 장치가 준비되지 않습니다".to_owned()),
        R::NoRunRecord(signal) => same(format!("신호 기록에 {signal} 신호가 없습니다: 장치의 주행 기록이 아닙니다")),
        R::NeverMoves => same("이 신호 기록에서 열차가 움직이지 않습니다".to_owned()),
        R::NoMarkers => [
            "the trace passes no marker and does not stop: name its section".to_owned(),
            "신호 기록에 마커 통과와 정차가 없습니다. 구간을 지정하십시오".to_owned(),
        ],
        R::NoSectionFits(line) => [
            format!("no section of line {line} has its markers and its stop where this run found them: name the line or the section"),
            format!("노선 {line}에 마커와 정차 위치가 이 운행과 맞는 구간이 없습니다. 노선이나 구간을 지정하십시오"),
        ],
        R::SectionsAlike(sections) => [
            format!("sections {sections} fit this run alike: name one"),
            format!("구간 {sections}이(가) 이 운행과 똑같이 맞습니다. 하나를 지정하십시오"),
        ],
    }
}

#[rustfmt::skip]
pub(super) fn diagnosis(what: &DiagnosisTrouble) -> Both {
    use DiagnosisTrouble as D;
    let same = |korean: String| [what.to_string(), korean];
    match what {
        D::RunTwice(run) => same(format!("시험 {run}을(를) 두 번 지정했습니다")),
        D::OtherUnit(run, unit, config, of, of_config) => same(format!("시험 {run}은(는) 장치 {of} ({of_config})이(가) 아니라 {unit} ({config})의 시험입니다. 한 장치의 시험만 함께 진단합니다")),
        D::NoDictionary => ["there is no fault dictionary".to_owned(), "고장 사전이 없습니다".to_owned()],
        D::Damaged(file, reason) => same(format!("고장 사전이 손상되었습니다: {file} ({reason})")),
        D::Stale(warnings) => {
            let each = |n: usize| warnings.iter().map(|one| warned(one)[n].clone()).collect::<Vec<_>>().join("; ");
            [each(0), each(1)]
        }
        D::OtherBench(config, line, train) => same(format!("고장 사전의 조건은 장치 구성 {config}, 노선 {line}, 열차 {train}입니다. 적응 시험에는 같은 조건이 필요합니다")),
    }
}

#[cfg(test)]
mod tests;
