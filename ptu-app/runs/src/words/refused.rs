//! Refusals of benches, files, keys, units, traces and diagnoses.

use std::fmt::Display;
use std::path::Path;

use btu_rig::rig::LinkTrouble;
use fault_db::Id;
use protocol::Duration;

use super::{Near, Say, TextStyle, sentences};
use crate::endpoint::Endpoint;
use crate::keys::Standing;

sentences! {
    /// A name that nothing has.
    Unknown {
        Fault(asked: String, near: Near): "no fault \"{asked}\"{near}" ["; `ptu catalog faults` lists them"], "고장 모드 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu catalog faults`"];
        FaultGlob(asked: String, near: Near): "no fault mode matches \"{asked}\"{near}" ["; `ptu catalog faults` lists them"], "\"{asked}\"에 맞는 고장 모드가 없습니다{near}" [". 목록: `ptu catalog faults`"];
        Part(asked: String, near: Near): "no part \"{asked}\"{near}" ["; `ptu catalog parts` lists them"], "부품 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu catalog parts`"];
        Symptom(asked: String, near: Near): "no symptom \"{asked}\"{near}" ["; `ptu catalog symptoms` lists them"], "증상 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu catalog symptoms`"];
        Procedure(asked: String, near: Near): "no procedure or file \"{asked}\"{near}" ["; `ptu run --list` shows all"], "절차 또는 파일 \"{asked}\"이(가) 없습니다{near}" [". 전체 목록: `ptu run --list`"];
        Step(asked: String): "no step matches \"{asked}\"" ["; `ptu run --list --steps` shows all"], "\"{asked}\"에 맞는 단계가 없습니다" [". 전체 목록: `ptu run --list --steps`"];
        Signal(asked: String, near: Near): "no signal \"{asked}\" in the traces{near}" ["; `ptu catalog signals` lists them"], "신호 기록에 신호 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu catalog signals`"];
        Unit(asked: String, near: Near): "no unit \"{asked}\" was ever tested{near}" ["; `ptu runs list` shows the units"], "장치 \"{asked}\"의 시험 기록이 없습니다{near}" [". 장치 목록: `ptu runs list`"];
        Instrument(asked: String, near: Near): "no instrument \"{asked}\" is registered{near}" ["; `ptu instrument list` shows them, `ptu instrument add` registers one"], "계측기 \"{asked}\"이(가) 등록되어 있지 않습니다{near}" [". 목록: `ptu instrument list`, 등록: `ptu instrument add`"];
        Key(asked: String, near: Near): "no key \"{asked}\" in the list{near}" ["; `ptu key list` shows them"], "목록에 키 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu key list`"];
        Question(asked: String, near: Near): "no question \"{asked}\" was saved{near}" ["; `ptu saved` lists them"], "저장된 질문 \"{asked}\"이(가) 없습니다{near}" [". 목록: `ptu saved`"];
        DataFile(what: &'static str, asked: String, near: Near, known: String): "no {what} \"{asked}\"{near}; known: {known}", "{what} \"{asked}\"이(가) 없습니다{near}. 있는 것: {known}";
        Section(line: String, section: u16): "line {line} has no section {section}", "노선 {line}에 구간 {section}이(가) 없습니다";
        SectionOf(line: String, section: u16, known: String): "line {line} has no section {section}; it has {known}", "노선 {line}에 구간 {section}이(가) 없습니다. 있는 구간: {known}";
        Code(asked: String, known: String): "the unit configuration has no code \"{asked}\"; it has {known}", "장치 구성에 속도 코드 \"{asked}\"이(가) 없습니다. 있는 코드: {known}";
    }

    /// Reasons for which a file does not serve.
    Why {
        Said(said: String): "{said}", "{said}";
        NoFileName: "it has no file name", "파일 이름이 없음";
        NoFolder(folder: String): "there is no folder {folder}", "폴더가 없음: {folder}";
        Folder: "it is a folder", "폴더임";
        NoFile: "it is no regular file", "일반 파일이 아님";
        History: "it is a history or another database, or belongs to one", "이력 또는 다른 데이터베이스이거나 그 일부임";
        OtherKind: "what is there was not written as this kind by this program; name another file", "기존 파일은 이 프로그램이 만든 같은 종류의 파일이 아님. 다른 파일을 지정하십시오";
        Taken: "it is there already", "이미 있음";
        NoText: "it is not UTF-8", "UTF-8 텍스트가 아님";
        NoPrivateKey: "it holds no private key", "개인 키가 없음";
        OtherPublicKey: "its public key is not that of its private key", "공개 키가 개인 키의 것이 아님";
        OtherWriter: "another campaign writes it", "다른 작업이 쓰는 중임";
        MoreBytes(most: u64): "it has more than {most} bytes", "{most}바이트를 넘음";
        TrainTwice(number: String): "train {number} stands in it twice", "열차 {number}이(가) 두 번 있음";
        UnitTwice(serial: String, one: String, other: String): "unit {serial} stands in it for trains {one} and {other}", "장치 {serial}이(가) 열차 {one}와(과) {other}에 있음";
        SlowReader: "whoever reads it takes too few", "읽는 쪽이 느림";
        ThreadEnded: "its thread broke off", "스레드가 중단됨";
        ProgramEnded: "the program ended", "프로그램이 끝남";
        NoFullScale(mv: f64): "a full scale of {mv} mV", "최대값 {mv} mV";
        OtherCampaign(runs: usize, what: String): "its {runs} runs are of another campaign ({what})", "시험 {runs}건이 다른 작업({what})의 것임";
        Heading: "line 1: the columns train, date and km are expected", "1행에 train, date, km 열이 있어야 합니다";
        Values(line: u32): "line {line}: three values are expected", "{line}행에 값 세 개가 있어야 합니다";
        Cell(line: u32, column: usize, name: String, what: WrongCell): "line {line}, column {column} ({name}): {what}", "{line}행 {column}열({name}): {what}";
        Unsigned: "a sheet of a run that was not signed has none", "서명하지 않은 시험의 성적서에는 없음";
        NoStatement: "it is no statement about a run", "시험에 대한 증명이 아님";
        NotInstalled(package: &'static str): "it is not installed ({package})", "설치되어 있지 않음 ({package})";
    }

    /// Errors in the cell of an odometer's reading.
    WrongCell {
        Empty: "there is no value", "값이 없습니다";
        NoDate(text: String): "\"{text}\" is no date like 2026-03-21", "\"{text}\"은(는) 2026-03-21 형식의 날짜가 아닙니다";
        NoDistance(text: String): "\"{text}\" is no number of kilometres", "\"{text}\"은(는) 거리(km) 값이 아닙니다";
        Twice: "the train has another reading of this day", "같은 열차의 같은 날 값이 또 있습니다";
        GoesBack(km: f64): "{km} does not fit the train's other readings: an odometer never goes back", "{km}은(는) 이 열차의 다른 값과 맞지 않습니다. 주행거리는 줄지 않습니다";
    }

    /// Reasons for which a receiver does not hear a code of its own table.
    Unheard {
        Short(detect_ms: u32, least_ms: u32): "receiver.detect_ms = {detect_ms} is too short for the slowest code, {least_ms} or more are needed", "receiver.detect_ms = {detect_ms}은(는) 가장 느린 코드에 너무 짧습니다. {least_ms} 이상이어야 합니다";
        As(heard_hz: String): "the receiver hears it as {heard_hz} Hz", "수신기가 {heard_hz} Hz로 수신합니다";
        Nothing: "the receiver hears no code in it; its rate is too fast for the receiver, or its carrier too slow for the rate", "수신기가 코드를 수신하지 못합니다. 코드 주파수가 너무 빠르거나 반송파가 그에 비해 너무 느립니다";
    }

    /// Refusals about a file or a folder.
    FileTrouble {
        Unread(file: String, why: Why): "cannot read {file}: {why}", "읽을 수 없습니다: {file} ({why})";
        Unwritten(file: String, why: Why): "cannot write {file}: {why}", "쓸 수 없습니다: {file} ({why})";
        Unmade(what: String, why: Why): "cannot make {what}: {why}", "만들 수 없습니다: {what} ({why})";
        NotPrinted(what: &'static str, why: Why): "cannot make {what}: {why}", "{what}을(를) 만들 수 없습니다 ({why})";
        Wrong(file: String, why: Why): "{file}: {why}", "{file}에 오류가 있습니다: {why}";
        Damaged(file: String, why: Why): "{file} is damaged ({why}); correct or delete it", "파일이 손상되었습니다: {file} ({why}). 고치거나 삭제하십시오";
        Exists(file: String): "{file} is there already; name another file" [", or say --force to replace it"], "이미 있습니다: {file}. 다른 파일을 지정하십시오" [". --force로 덮어쓸 수 있습니다"];
        NoPreset(file: String, option: String, near: Near): "{file}: no option \"{option}\" has a default here{near}", "{file}: \"{option}\"은(는) 기본값을 정할 수 있는 옵션이 아닙니다{near}";
        PresetNoText(file: String, option: String): "{file}: write the default of {option} in quotation marks", "{file}: {option}의 기본값은 따옴표 안에 적으십시오";
        Missing(file: String): "there is no file {file}", "파일이 없습니다: {file}";
        NoDatabase(file: String): "there is no database {file}; choose another file", "데이터베이스가 없습니다: {file}. 다른 파일을 선택하십시오";
        NoDirectory(folder: String): "{folder} is not a directory", "폴더가 아닙니다: {folder}";
        NoUserFolder(option: &'static str): "no user data directory" ["; name a place with {option}"], "사용자 데이터 폴더가 없습니다" [". {option}(으)로 위치를 지정하십시오"];
        NoSettingsFolder: "no user configuration directory to save it in", "저장할 사용자 설정 폴더가 없습니다";
        ScriptsTooLong(folder: String, most: usize): "the scripts in {folder} are longer than {most} bytes together", "스크립트가 모두 합하여 {most}바이트를 넘습니다: {folder}";
        Shared(file: String, rights: String, command: String): "a secret that is shared protects nothing: {file} is open to others ({rights}); " ["to keep it to yourself: {command}" "keep it to yourself"], "비밀은 공유되면 보호되지 않습니다: 다른 사용자가 읽을 수 있는 파일입니다: {file} ({rights}). 본인만 읽을 수 있게 하십시오" [": {command}"];
        OpenToOthers(file: String, rights: String, command: String): "{file} is open to others ({rights}); to keep it to yourself: {command}", "{file}을(를) 다른 사용자도 열 수 있습니다 ({rights}). 막으려면: {command}";
        Unanswered(why: String): "cannot write the answer: {why}; make room on standard output or send it elsewhere", "결과를 출력할 수 없습니다: {why}. 공간을 확보하거나 다른 곳으로 출력하십시오";
        FontUnread(why: Why): "the shipped font cannot be read: {why}", "내장 글꼴을 읽을 수 없습니다 ({why})";
        LongRow(view: String): "a row of {view} is too long to be exported", "내보내기에는 행이 너무 깁니다: {view}";
        OddValue(column: String, value: String): "the history has {value} in {column}, which no other row has" ["; look with `ptu db check`" "; check the history"], "이력의 {column} 값 {value}이(가) 다른 행과 다른 종류입니다. 이력을 검사하십시오" [": `ptu db check`"];
        NotCopied(why: String): "it cannot be copied to be checked: {why}", "검사할 사본을 만들 수 없습니다: {why}";
        OfTrain(file: String, number: String): "{file}: train {number}", "{file}: 열차 {number}";
        NoTrainNumber: "its number is empty", "열차번호가 비어 있습니다";
        IsCopy: "this history file is a copy of one that the server knows, and goes on by itself; go on with the file that it was copied from, or import this one into it", "이 이력 파일은 서버가 아는 파일의 사본이며 따로 이어졌습니다. 원본 파일을 쓰거나, 이 파일을 원본에 가져오십시오";
        OfKeys(file: String): "{file} is no list of keys", "키 목록이 아닙니다: {file}";
        NoCatalogue: "there is no fault catalogue", "고장 목록이 없습니다";
        NoWav(file: String, why: String): "{file} is no WAV file that can be read ({why}); give a file of PCM or floating-point samples", "읽을 수 있는 WAV 파일이 아닙니다: {file} ({why}). PCM 또는 부동소수점 샘플 파일을 지정하십시오";
        Unheard(file: String, code: String, rate: String, carrier: String, why: Unheard): "{file}: code {code} of {rate} Hz on {carrier} Hz: {why}", "{file}: 코드 {code}({rate} Hz, 반송파 {carrier} Hz): {why}";
        NoSamples(file: String, channels: u16, hz: u32): "{file} has {channels} channels at {hz} Hz: nothing that can be read", "{file}: 채널 {channels}개, {hz} Hz는 읽을 수 없습니다";
    }

    /// Refusals about keys that sign.
    KeyTrouble {
        ShortPin(least: usize): "a PIN has at least {least} letters or digits", "PIN은 글자나 숫자가 {least}자 이상이어야 합니다";
        PinsDiffer: "the two PINs differ; no key was made", "두 PIN이 서로 다릅니다. 키를 만들지 않았습니다";
        NoPin: "the key is protected by a PIN, and there is no terminal to ask for it" ["; put it into a file that only you can read and name that with --pin-file, or set PTU_PIN"], "키가 PIN으로 보호되어 있으나 PIN을 물을 터미널이 없습니다" [". PIN을 본인만 읽을 수 있는 파일에 두고 --pin-file로 지정하거나 PTU_PIN을 설정하십시오"];
        WrongPin(file: String): "the PIN of {file} is wrong; nothing was signed", "PIN이 틀렸습니다: {file}. 아무것도 서명하지 않았습니다";
        NotMade(why: String): "no key was made: {why}", "키를 만들지 못했습니다: {why}";
        Missing(file: Sought): "there is no key file {file}" ["; `ptu key new` makes one, `ptu key list` shows yours"], "키 파일이 없습니다: {file}" [". 만들기: `ptu key new`, 목록: `ptu key list`"];
        NoList(file: Sought): "there is no list of keys {file}" ["; `ptu key trust FILE.pub --keys FILE` begins one"], "키 목록이 없습니다: {file}" [". 만들기: `ptu key trust FILE.pub --keys FILE`"];
        NoPublicFile(file: Sought): "there is no file {file}" ["; it is the `.pub` file that `ptu key new` made"], "파일이 없습니다: {file}" [". `ptu key new`가 만든 `.pub` 파일을 지정하십시오"];
        NoKeyFile(file: String, why: Why): "{file} is no key file" [" of `ptu key new`: {why}" ": {why}"], "키 파일이 아닙니다: {file} ({why})" [". 만들기: `ptu key new`"];
        NoKeyList(file: String, why: Why): "{file} is no list of keys: {why}", "키 목록이 아닙니다: {file} ({why})";
        Damaged(file: String, why: Why): "the key file {file} is damaged: {why}; take your copy of it", "키 파일이 손상되었습니다: {file} ({why}). 사본을 쓰십시오";
        NotHeld(file: String, standing: Standing): "the key in {file} {standing}: nothing is signed with it" ["; `ptu key new` makes another"], "{file}의 키: {standing}. 이 키로 서명하지 않습니다. 새 키를 만드십시오" [": `ptu key new`"];
        OfTwo(one: String, other: String): "one key is listed as that of {one} and of {other}", "한 키가 {one}와(과) {other}의 키로 등록되어 있습니다";
    }

    /// Reasons for which a text is no endpoint of a unit.
    EndpointError {
        Unknown: "a unit is sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH", "장치는 sim, serial:PATH[@BAUD], tcp:HOST:PORT 또는 lockstep:PATH 형식으로 지정합니다";
        Address(text: String): "\"{text}\" is not HOST:PORT", "\"{text}\"은(는) HOST:PORT 형식이 아닙니다";
        Baud(text: String): "\"{text}\" is not a baud rate", "\"{text}\"은(는) 통신 속도가 아닙니다";
        NoPort: "serial: needs a port" ["; `ptu ports` lists them"], "serial: 뒤에 포트를 지정하십시오" [". 목록: `ptu ports`"];
    }

    /// Why a unit on a port cannot be tested, and the next move.
    NoUnit {
        PortHeld(port: String, who: String): "another program holds the port {port}: {who}; end it, or choose" [" one of `ptu ports`" " another port"], "다른 프로그램이 포트를 사용 중입니다: {port}, {who}. 그 프로그램을 끝내거나 다른 포트를 선택하십시오" [": `ptu ports`"];
        PortClosed(port: String, why: String): "cannot open port {port}: {why}; check the cable, or choose" [" one of `ptu ports`" " another port"], "포트를 열 수 없습니다: {port} ({why}). 케이블을 확인하거나 다른 포트를 선택하십시오" [": `ptu ports`"];
        NotServed(at: String, why: String): "cannot connect to {at}: {why}; check that the unit is served there", "{at}에 연결할 수 없습니다 ({why}). 장치가 그 주소에 있는지 확인하십시오";
        Taken(at: Endpoint, why: LinkTrouble): "{at}: {why}; wait until it has left, or end it there", "{at}: {why}. 끝날 때까지 기다리거나 그 시험기를 끝내십시오";
        PortFailed(why: LinkTrouble): "{why}; check the cable and that the unit is served there", "{why}. 케이블과 장치를 확인하십시오";
        BadBench(bench: String, why: LinkTrouble): "{why}" ["; `ptu doctor --bench {bench}` checks each instrument" ""], "{why}" [". 계측기 점검: `ptu doctor --bench {bench}`" ""];
        BadLink(at: Endpoint, why: LinkTrouble): "{at}: {why}", "{at}: {why}";
        NotReady(at: Endpoint, within: Duration): "{at}: the unit answers but does not become ready within {within}; power it off and on", "{at}: 장치가 응답하지만 {within} 안에 준비되지 않습니다. 전원을 껐다 켜십시오";
        OtherPace(at: Endpoint, times: String): "{at}: the unit's clock goes {times} times as fast as the tester's; slow both ends down alike, or neither", "{at}: 장치의 시계가 시험기보다 {times}배 빠릅니다. 양쪽의 속도를 같게 하십시오";
        Other(at: Endpoint, serial: String, expected: String): "the unit on {at} is {serial}, not {expected}; check the port and the serial number asked for", "{at}의 장치는 {serial}이며 {expected}이(가) 아닙니다. 포트와 일련번호를 확인하십시오";
        OtherConfiguration(serial: String, unit: String, ours: String): "the unit configuration of unit {serial} has checksum {unit}, the tests were loaded for {ours}; choose the unit configuration of that unit", "장치 {serial}의 장치 구성이 시험용과 다릅니다 (체크섬 {unit}, 시험용 {ours}). 그 장치의 구성을 선택하십시오";
        OtherTrack(serial: String, unit: String, ours: String): "the track database of unit {serial} has checksum {unit}, the tests were loaded for {ours}; choose the track database of that unit", "장치 {serial}의 선로 데이터베이스가 시험용과 다릅니다 (체크섬 {unit}, 시험용 {ours}). 그 장치의 노선을 선택하십시오";
    }

    /// Refusals about a bench, or a run on it.
    RunTrouble {
        NoUnit: "no unit is connected", "연결된 장치가 없습니다";
        NotReached(at: Endpoint): "{at}: stopped before the unit was reached", "{at}: 장치에 연결하기 전에 중지되었습니다";
        NoStand(why: String): "{why}", "열차를 그곳에 둘 수 없습니다: {why}";
        NoPort: "the embedded unit has no port", "모의 장치에는 포트가 없습니다";
        PortsNotListed(why: String): "cannot list serial ports: {why}", "직렬 포트 목록을 읽을 수 없습니다: {why}";
        PortGone: "the unit on the port is gone", "포트의 장치가 없어졌습니다";
        InjectElsewhere: "" ["--inject puts faults of a unit into the embedded one only; inject into a served one with `ato-under-test --inject`" "faults of a unit can be injected into the embedded one only"], "장치의 고장 모드는 모의 장치에만 주입할 수 있습니다" [" (--inject). 서비스하는 장치에는 `ato-under-test --inject`로 주입합니다"];
        BenchFault(fault: String): "{fault} is a fault of the simulated bench: it acts on numbers in frames between bench and unit" ["; `ptu run` without --signals, --bench and --harness has them"], "{fault}은(는) 모의 시험대의 고장 모드이며, 시험대와 장치 사이 전문의 수치에만 작용합니다" [". --signals, --bench, --harness 없이 `ptu run`을 실행하십시오"];
        SampledOnSerial: "" ["--signals sampled needs 6 Mbit/s, more than a serial port: use sim, tcp:HOST:PORT or lockstep:PATH" "sampled waveforms need 6 Mbit/s, more than a serial port: use sim, tcp:HOST:PORT or lockstep:PATH"], "" ["--signals sampled에는 6 Mbit/s가 필요하여 직렬 포트로는 보낼 수 없습니다. sim, tcp:HOST:PORT 또는 lockstep:PATH를 쓰십시오" "파형 신호에는 6 Mbit/s가 필요하여 직렬 포트로는 보낼 수 없습니다. sim, tcp:HOST:PORT 또는 lockstep:PATH를 쓰십시오"];
        SerialNumber(longest: usize): "a serial number is 1 to {longest} ASCII characters", "일련번호는 ASCII 문자 1~{longest}자입니다";
        NoVersion(text: String): "\"{text}\" is not a version such as 0.1.0", "\"{text}\"은(는) 0.1.0과 같은 버전이 아닙니다";
        NoSetting: "a setting is KEY=VALUE, as ato.gently_mps2=0.4", "설정은 ato.gently_mps2=0.4와 같이 KEY=VALUE 형식입니다";
        Misplaced(why: String): "{why}", "고장 모드를 주입할 수 없습니다: {why}";
        Uncalibrated(kind: String, serial: String, due: String): "the calibration of {kind} {serial} was due on {due}; nothing was driven." [" `ptu instrument calibrate {serial}` states a new calibration, --uncalibrated goes on without one, and the sheet says so" " Have it calibrated and its new calibration registered"], "교정 기한이 지났습니다: {kind} {serial} ({due}). 아무것도 구동하지 않았습니다. 교정한 후 새 교정을 등록하십시오" [": `ptu instrument calibrate {serial}`. --uncalibrated로 교정 없이 시험하면 성적서에 표시됩니다"];
        NeverCalibrated(kind: String, serial: String): "{kind} {serial} was never calibrated; nothing was driven." [" `ptu instrument calibrate {serial}` states a new calibration, --uncalibrated goes on without one, and the sheet says so" " Have it calibrated and its calibration registered"], "교정한 적이 없습니다: {kind} {serial}. 아무것도 구동하지 않았습니다. 교정한 후 등록하십시오" [": `ptu instrument calibrate {serial}`. --uncalibrated로 교정 없이 시험하면 성적서에 표시됩니다"];
        NoUncertainty: "no instrument is registered with an uncertainty, by which limits could be narrowed" ["; `ptu instrument calibrate` states one"], "불확도가 등록된 계측기가 없어 한계값을 좁힐 수 없습니다" [". 등록: `ptu instrument calibrate`"];
        Glob(glob: String, why: String): "\"{glob}\" is not a glob: {why}", "\"{glob}\"은(는) 올바른 패턴이 아닙니다: {why}";
        Script(error: String): "{error}" ["; `ptu run --check` shows all errors"], "스크립트 오류: {error}" [". 모든 오류: `ptu run --check`"];
        NotLoadedApart(why: String): "cannot load scripts in a process of their own: {why}", "스크립트를 별도 프로세스에서 읽을 수 없습니다: {why}";
        NoThread(why: String): "cannot start a thread: {why}", "스레드를 시작할 수 없습니다: {why}";
        NotStarted(program: String, why: String): "cannot start {program}: {why}", "시작할 수 없습니다: {program} ({why})";
        NotServed(why: String): "the train cannot be served: {why}", "열차를 서비스할 수 없습니다: {why}";
        WriterEnded: "the writer ended unexpectedly", "기록이 예기치 않게 끝났습니다";
        ProgramFailed(run: Id): "the program failed in run {run}, which is recorded as an error; please report what stands before this", "시험 {run} 중 프로그램에 결함이 발생했습니다. 시험은 판정 불가로 기록되었습니다. 앞에 표시된 내용을 알려 주십시오";
    }

    /// Refusals about the log or the memory of a unit.
    FieldTrouble {
        Simulated: "the simulated unit keeps no log from run to run; choose a unit on a port" [" with --unit serial:PATH or tcp:HOST:PORT"], "모의 장치에는 시험 사이에 남는 고장 기록이 없습니다. 포트에 연결된 장치를 선택하십시오" [": --unit serial:PATH 또는 tcp:HOST:PORT"];
        LockStep: "the clock of a unit in lock step stands between scans, which dates no entry; choose a unit on a port" [" with --unit serial:PATH or tcp:HOST:PORT"], "동기 방식 장치의 시계는 스캔 사이에 멈추어 기록의 날짜를 알 수 없습니다. 포트에 연결된 장치를 선택하십시오" [": --unit serial:PATH 또는 tcp:HOST:PORT"];
        NotRead(at: Endpoint, why: BrokenOff): "{at}: {why}", "{at}: {why}";
        NotWhole(why: BrokenOff): "{why}; the log was not read to its end, what was read is kept; read it again", "{why}. 기록을 끝까지 읽지 못했습니다. 읽은 내용은 보관했습니다. 다시 읽으십시오";
        NoMemory: "this unit has no stored memory: its run record is lost at power off, and cannot be pulled", "이 장치에는 저장 메모리가 없습니다. 주행 기록이 전원 차단 시 없어지므로 가져올 수 없습니다";
    }

    /// Why reading a log ended before it did.
    BrokenOff {
        Link(why: LinkTrouble): "{why}", "{why}";
        Stopped: "stopped by the operator", "시험자가 중지함";
        TooLong(within: Duration): "the log does not end within {within}", "기록이 {within} 안에 끝나지 않음";
    }

    /// Refusals about a trace, or the recording that belongs to it.
    RecordTrouble {
        NoRecording(trace: Id): "trace {trace} has no recording of what was done to the bench: it is of an earlier version, or its run broke off", "신호 기록 {trace}에는 시험대 조작 기록이 없습니다: 이전 버전의 기록이거나 시험이 중단되었습니다";
        NoRows(trace: Id): "trace {trace} has no rows", "신호 기록 {trace}에 행이 없습니다";
        NoTimes(trace: Id): "trace {trace} names times at which no procedure was under way", "신호 기록 {trace}의 시각에 진행 중인 절차가 없었습니다";
        OtherVersion(procedure: String, why: String): "the recording of {procedure} cannot be read by this version: {why}", "{procedure}의 조작 기록을 이 버전에서 읽을 수 없습니다: {why}";
        NotWhole(procedure: String, lost: u32): "the recording of {procedure} is not whole: {lost} stimuli found no room in it", "{procedure}의 조작 기록이 온전하지 않습니다: 조작 {lost}개를 기록하지 못함";
        Gone(what: &'static str, name: String): "the recording was made with {what} \"{name}\", which cannot be had any more", "기록할 때의 {what} \"{name}\"을(를) 쓸 수 없습니다";
        Changed(what: &'static str, name: String, was: String, is: String): "the {what} \"{name}\" was changed since the recording (sha256 {was}, now {is}): what was expected then cannot be told" ["; give the scripts directory of that time with --scripts"], "기록 후 {what} \"{name}\"이(가) 변경되어 (sha256 {was} → {is}) 당시 기대값을 알 수 없습니다" [". 당시의 스크립트 폴더를 --scripts로 지정하십시오"];
        Periods(one: i64, other: i64): "the traces have rows of {one} ms and {other} ms: they cannot be laid side by side", "신호 기록의 주기가 {one} ms와 {other} ms로 달라 비교할 수 없습니다";
        NoCommonTime: "the traces have no time in common around their triggers, or the recording begins after the end of the trace", "두 신호 기록에 트리거 전후의 공통 시간이 없거나, 조작 기록이 신호 기록의 끝보다 늦게 시작합니다";
        Stopped: "stopped before anything was recorded", "기록되기 전에 중지되었습니다";
        NotReady: "the embedded unit does not become ready", "모의 장치가 준비되지 않습니다";
        NoRunRecord(signal: String): "the trace has no signal {signal}: it is no run record of a unit", "신호 기록에 {signal} 신호가 없습니다: 장치의 주행 기록이 아닙니다";
        NeverMoves: "the train never moves in this trace", "이 신호 기록에서 열차가 움직이지 않습니다";
        NoMarkers: "the trace passes no marker and does not stop: name its section" [" with --section"], "신호 기록에 마커 통과와 정차가 없습니다. 구간을 지정하십시오" [": --section"];
        NoSectionFits(line: String): "no section of line {line} has its markers and its stop where this run found them: name the line or the section" [" with --line or --section"], "노선 {line}에 마커와 정차 위치가 이 운행과 맞는 구간이 없습니다. 노선이나 구간을 지정하십시오" [": --line 또는 --section"];
        SectionsAlike(sections: String): "sections {sections} fit this run alike: name one" [" with --section"], "구간 {sections}이(가) 이 운행과 똑같이 맞습니다. 하나를 지정하십시오" [": --section"];
    }

    /// Refusals about a diagnosis.
    DiagnosisTrouble {
        RunTwice(run: Id): "run {run} is named twice", "시험 {run}을(를) 두 번 지정했습니다";
        OtherUnit(run: Id, unit: String, config: String, of: String, of_config: String): "run {run} is of unit {unit}, {config}, and not of {of}, {of_config}; runs of one unit alone are diagnosed together", "시험 {run}은(는) 장치 {of} ({of_config})이(가) 아니라 {unit} ({config})의 시험입니다. 한 장치의 시험만 함께 진단합니다";
        NoDictionary: "there is no fault dictionary" ["; `ptu campaign` makes one in a few minutes"], "고장 사전이 없습니다" [". `ptu campaign`으로 몇 분 안에 만들 수 있습니다"];
        Damaged(file: String, why: String): "{file}: a fault dictionary is damaged: {why}", "고장 사전이 손상되었습니다: {file} ({why})";
        OtherBench(config: &'static str, line: String, train: String): "the fault dictionary was made with unit configuration {config}, {line} and train {train}; an adaptive run needs the same", "고장 사전의 조건은 장치 구성 {config}, 노선 {line}, 열차 {train}입니다. 적응 시험에는 같은 조건이 필요합니다";
    }
}

impl From<LinkTrouble> for BrokenOff {
    fn from(why: LinkTrouble) -> Self {
        Self::Link(why)
    }
}

impl Why {
    /// Message of the system or of a reader.
    pub fn of(said: impl Display) -> Self {
        Self::Said(said.to_string())
    }
}

impl FileTrouble {
    /// The file cannot be read; `why` is the reader's error.
    pub fn unread(file: &Path, why: impl Display) -> Self {
        Self::Unread(file.display().to_string(), Why::of(why))
    }

    /// The content is wrong; `why` is the reader's error.
    pub fn wrong(file: impl Display, why: impl Display) -> Self {
        Self::Wrong(file.to_string(), Why::of(why))
    }
}

/// A file that was looked for in vain.
#[derive(Clone, Debug, PartialEq)]
pub struct Sought {
    /// The file, as a person named it.
    pub file: String,
    /// The folder of a user's own keys; none if it was not looked in.
    pub folder: Option<String>,
}

impl Say for Sought {
    fn say(&self, how: TextStyle) -> String {
        let Self { file, folder } = self;
        folder.as_ref().map_or_else(
            || file.clone(),
            |folder| {
                how.choose([
                    format!("{file}, neither in the current folder nor in {folder}"),
                    format!("{file}. 현재 폴더와 {folder}에 없습니다"),
                ])
            },
        )
    }
}

impl Say for Standing {
    #[rustfmt::skip]
    fn say(&self, how: TextStyle) -> String {
        how.choose([self.text(), match self {
            Self::Held => "목록에 있고 당시 유효함".to_owned(),
            Self::Unknown => "키 목록에 없음".to_owned(),
            Self::OtherName(name) => format!("키 목록에는 {name}의 키임"),
            Self::NotYet(day) => format!("{day}부터 유효함"),
            Self::Expired(day) => format!("{day}에 만료됨"),
            Self::Revoked(day) => format!("{day}부터 폐지됨"),
        }])
    }
}
