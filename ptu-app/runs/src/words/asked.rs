//! Refusals of requests at a command line or in a window.

use btu_rig::rig::LinkTrouble;
use fault_db::Id;

use super::{EndpointError, Near, OfUnit, Why, sentences};

sentences! {
    /// Request of a person at a command line or in a window that cannot be met.
    Asked {
        // A run.
        ErrorInScripts: "1 error in the scripts; nothing was driven", "스크립트 오류 1건. 아무것도 구동하지 않았습니다";
        ErrorsInScripts(n: usize): "{n} errors in the scripts; nothing was driven", "스크립트 오류 {n}건. 아무것도 구동하지 않았습니다";
        NeedsCars(train: String, procedures: String): "the train \"{train}\" has no cars, which these test: {procedures}", "열차 \"{train}\"에는 차량이 없어 다음을 시험할 수 없습니다: {procedures}";
        JobsOnPort: "--jobs works on simulated units only; one port is one unit", "--jobs: 모의 장치에만 쓸 수 있습니다. 포트 하나에는 장치 하나만 있습니다";
        BenchByTheClock: "--bench is for a unit on a port that goes by the clock, as instruments do", "--bench: 계측기처럼 실제 시간으로 동작하는, 포트의 장치에만 쓸 수 있습니다";
        SlowerWithoutClock: "--slower is for what goes by the clock: a unit on a port, or --realtime", "--slower: 포트의 장치나 --realtime과 함께 씁니다";
        AdaptiveOnce: "--adaptive does one step after the other, each once; leave --repeat and --jobs out", "--adaptive: 단계를 하나씩 한 번만 시험합니다. --repeat와 --jobs를 빼십시오";
        ExcludesNone(name: String, near: Near): "--exclude: no procedure \"{name}\" would be run{near}; `ptu run --list` shows all", "--exclude: 시험할 절차 중에 \"{name}\"이(가) 없습니다{near}. 전체 목록: `ptu run --list`";
        ExcludesAll(name: String): "--exclude {name} leaves nothing to run", "--exclude {name}: 시험할 것이 남지 않습니다";
        NoStepChosen: "no step is chosen", "선택한 단계가 없습니다";
        NotAnswered: "the query was not answered", "조회에 응답이 없습니다";
        StillRunning(run: Id): "run {run} is still under way; wait for its end, or stop it first", "시험 {run}이(가) 아직 진행 중입니다. 끝나기를 기다리거나 먼저 중지하십시오";
        RanNothing(run: Id, source: String): "run {run} ({source}) ran no procedures; name a run of `ptu run`, see `ptu runs list`", "시험 {run} ({source})에는 시험한 절차가 없습니다. `ptu run`의 시험을 지정하십시오. 목록: `ptu runs list`";
        AllJudged(run: Id): "each procedure of run {run} has a verdict; `ptu runs show {run}` lists them, and --retry-errors runs those again that could not be tested", "시험 {run}의 모든 절차에 판정이 있습니다. 목록: `ptu runs show {run}`. 판정 불가인 절차는 --retry-errors로 다시 시험합니다";
        NoneInError(run: Id): "no procedure of run {run} ended as an error; `ptu runs show {run}` lists their verdicts", "시험 {run}에 판정 불가로 끝난 절차가 없습니다. 판정: `ptu runs show {run}`";
        WasOnNoUnit(run: Id, source: String, error: EndpointError): "run {run} was on \"{source}\", which is no unit to connect to: {error}", "시험 {run}의 장치 \"{source}\"에는 연결할 수 없습니다: {error}";
        WasOnOtherUnit(run: Id, place: String, unit: String): "run {run} was on {place}, and --unit says {unit}: another unit does not continue a run; leave --unit out, or begin a new run", "시험 {run}의 장치는 {place}이고 --unit은 {unit}입니다. 다른 장치로 이어서 시험할 수 없습니다. --unit을 빼거나 새로 시험하십시오";
        WasOfOtherSerial(run: Id, was: String, serial: String): "run {run} tested unit {was}, and --serial-no says {serial}: another unit does not continue a run; leave --serial-no out, or begin a new run", "시험 {run}의 장치는 {was}이고 --serial-no는 {serial}입니다. 다른 장치로 이어서 시험할 수 없습니다. --serial-no를 빼거나 새로 시험하십시오";
        NotAllEvents(place: String, why: Why): "{place} has not all events: {why}; `ptu runs show latest` has the run", "{place}에 이벤트가 모두 있지 않습니다: {why}. 시험 기록: `ptu runs show latest`";
        // Faults and repairs.
        NoPartHere(part: String, near: Near): "no part \"{part}\"{near}; `ptu catalog parts` lists them, and --other-part names one that the catalogue lacks", "부품 \"{part}\"이(가) 없습니다{near}. 목록: `ptu catalog parts`. 목록에 없는 부품은 --other-part로 지정합니다";
        RepairWithoutPart: "a repair is of a part; name it with --part", "수리한 부품을 --part로 지정하십시오";
        OtherPartUnnamed: "--other-part names a part", "--other-part에 부품을 지정하십시오";
        EmptyNote: "a note says something", "메모에 내용을 적으십시오";
        CodeNever(code: String, near: Near): "no fault \"{code}\" was ever recorded{near}", "고장 \"{code}\"의 기록이 없습니다{near}";
        PartNever(part: String, near: Near): "no fault ever named the part \"{part}\"{near}", "부품 \"{part}\"의 고장 기록이 없습니다{near}";
        CauseNever(part: String, near: Near): "no fault ever came from the part \"{part}\"{near}", "부품 \"{part}\"이(가) 원인인 고장 기록이 없습니다{near}";
        TrainNever(train: String, near: Near): "no run in the train \"{train}\" was ever recorded{near}", "열차 \"{train}\"의 시험 기록이 없습니다{near}";
        LineNever(line: String, near: Near): "no fault was ever seen on the line \"{line}\"{near}", "노선 \"{line}\"의 고장 기록이 없습니다{near}";
        ProcedureNever(procedure: String, near: Near): "no fault was ever seen in the procedure \"{procedure}\"{near}", "절차 \"{procedure}\"의 고장 기록이 없습니다{near}";
        SerialNever(serial: String, near: Near): "no part with the serial number \"{serial}\" was ever taken out or put in{near}", "일련번호 \"{serial}\"인 부품을 떼거나 단 기록이 없습니다{near}";
        MeasurementNever(name: String, near: Near): "no measurement \"{name}\" recorded{near}; `ptu run --list` shows what is measured", "측정 \"{name}\"의 기록이 없습니다{near}. 측정 항목: `ptu run --list`";
        MeasuredBy(name: String, unit: OfUnit, procedure: String, others: String): "no measurement \"{name}\"{unit} recorded by \"{procedure}\"; it was measured by {others}", "측정 \"{name}\"{unit}: 절차 \"{procedure}\"의 기록이 없습니다. 측정한 절차: {others}";
        MeasuredInNo(name: String, unit: OfUnit, step: String, near: Near): "no measurement \"{name}\"{unit} recorded by a step \"{step}\"{near}", "측정 \"{name}\"{unit}: 단계 \"{step}\"의 기록이 없습니다{near}";
        MeasuredFrom(name: String, unit: OfUnit, span: String, first: String, last: String): "no measurement \"{name}\"{unit} recorded in {span}; it was recorded from {first} to {last}", "측정 \"{name}\"{unit}: {span}의 기록이 없습니다. 기록 기간: {first} ~ {last}";
        NotMeasured(name: String, unit: OfUnit): "no measurement \"{name}\"{unit} recorded so; `ptu runs list` shows the units", "측정 \"{name}\"{unit}: 그러한 기록이 없습니다. 장치 목록: `ptu runs list`";
        RepairNever(part: String, unit: String, near: Near): "no repair of {part} on unit {unit} recorded{near}", "장치 {unit}에서 {part}의 수리 기록이 없습니다{near}";
        DistancesByMonth: "distances are known by month only: add --by month", "주행거리는 월별로만 알 수 있습니다. --by month를 추가하십시오";
        // Sheets, seals and signatures.
        AnnexOfRun: "--annex is of a case; the sheet of a run has all of it already", "--annex: 정비 작업에만 씁니다. 시험 성적서에는 이미 모두 있습니다";
        CaseUnsigned: "the page of a case carries no signature: leave --key and PTU_KEY out, and sign the sheet of each run", "정비 작업의 문서에는 서명하지 않습니다. --key와 PTU_KEY를 빼고 각 시험의 성적서에 서명하십시오";
        FitsRunAndFault(id: String): "\"{id}\" fits a run and a fault; give more digits, or --case for the fault", "\"{id}\"에 해당하는 시험과 고장이 모두 있습니다. 더 길게 입력하거나, 고장이면 --case를 쓰십시오";
        FitsNothing(id: String): "no run and no fault \"{id}\"; `ptu runs list` and `ptu faults list` show what there is", "\"{id}\"에 해당하는 시험과 고장이 없습니다. 목록: `ptu runs list`, `ptu faults list`";
        Unsigned(run: Id): "run {run} is not signed and has no certificate; `ptu run --key FILE` signs one", "시험 {run}에는 서명과 증명서가 없습니다. `ptu run --key FILE`로 서명합니다";
        Changed(run: Id, change: String): "the run was changed, and no sheet of it is signed: {change}" ["; `ptu verify {run}` tells all"], "시험 기록이 변경되어 성적서에 서명하지 않습니다: {change}" [". 전체 내용: `ptu verify {run}`"];
        NoCodeOfSheet: "a code of a sheet reads ptu:RUN/SHA-256", "성적서의 코드는 ptu:RUN/SHA-256 형식입니다";
        PinUnread(why: String): "no PIN could be read: {why}", "PIN을 읽지 못했습니다: {why}";
        NoKeyIn(file: String): "{file} names no key", "{file}에 키가 없습니다";
        KeysAlike(n: usize, asked: String): "{n} keys are of \"{asked}\"; give the beginning of the key, as `ptu key list` shows it", "\"{asked}\"의 키가 {n}개 있습니다. `ptu key list`에 표시된 키의 앞부분을 입력하십시오";
        KeyStays(file: String): "{file} is there already and stays; name another file with --out", "{file}이(가) 이미 있어 그대로 둡니다. --out으로 다른 파일을 지정하십시오";
        RunBesideItself(run: Id): "both are run {run}: a run is compared with another one", "둘 다 시험 {run}입니다. 서로 다른 시험을 비교하십시오";
        NoRunSaw(fault: Id): "no run saw fault {fault}", "고장 {fault}이(가) 나타난 시험이 없습니다";
        // Instruments.
        InstrumentUnnamed: "an instrument has a serial number and a kind", "계측기의 일련번호와 종류를 지정하십시오";
        InstrumentKnown(serial: String): "{serial} is registered already; `ptu instrument list` shows it", "{serial}은(는) 이미 등록되어 있습니다. 목록: `ptu instrument list`";
        DueBefore(due: String, on: String): "it is due on {due}, before it was calibrated on {on}", "교정 기한 {due}이(가) 교정일 {on}보다 빠릅니다";
        // Traces.
        NoTraceFormat: "the file to export to must end in .csv, .parquet or .mcap", "내보낼 파일의 확장자는 .csv, .parquet 또는 .mcap이어야 합니다";
        NoComparable(file: String): "cannot compare with {file}: a file to compare with must end in .csv, .parquet or .mcap", "{file}과(와) 비교할 수 없습니다. 비교할 파일의 확장자는 .csv, .parquet 또는 .mcap이어야 합니다";
        ShiftOfFile: "--shift lays a file elsewhere; traces are laid at their triggers", "--shift: 파일에만 씁니다. 신호 기록은 트리거에 맞춥니다";
        ColumnsOfFile: "--map, --time and --time-unit say what the columns of a file are; B is none", "--map, --time, --time-unit: 파일의 열을 지정합니다. B는 파일이 아닙니다";
        OutsideTrace(from: String, to: String): "the trace has no row in that span; it goes from {from} to {to} s of its trigger", "그 구간에는 신호 기록이 없습니다. 신호 기록은 트리거 기준 {from} ~ {to} s입니다";
        FileOutsideTrace(from: String, to: String, begin: String, end: String): "the file has no time in common with the trace: from its trigger the file goes from {from} to {to} s, the trace from {begin} to {end} s; lay it elsewhere with --shift SECONDS", "파일과 신호 기록에 공통 시간이 없습니다. 트리거 기준으로 파일은 {from} ~ {to} s, 신호 기록은 {begin} ~ {end} s입니다. --shift SECONDS로 옮기십시오";
        ComesTwice(signal: String): "signal \"{signal}\" comes twice in the file", "파일에 신호 \"{signal}\"이(가) 두 번 있습니다";
        TraceDamaged(trace: Id, period: i64): "trace {trace} has rows of {period} µs: it is damaged", "신호 기록 {trace}의 주기가 {period} µs입니다: 손상되었습니다";
        // The window.
        OpensByHand(program: String, file: String): "{program} is not there: open {file} by hand", "{program} 프로그램이 없습니다. {file}을(를) 직접 여십시오";
        ServerIsRead: "a server's history is only read: without --unit, or with --db FILE", "서버의 이력은 읽기만 합니다. --unit을 빼거나 --db FILE을 쓰십시오";
        RunUnnamed: "name a run", "시험을 지정하십시오";
        VariableEmpty(name: String): "{name} is empty; let it name a database, or unset it", "{name}이(가) 비어 있습니다. 데이터베이스를 지정하거나 변수를 지우십시오";
        // Files and settings.
        NoReport: "a report ends in .html, .pdf, .csv, .json or .junit.xml", "보고서 파일의 확장자는 .html, .pdf, .csv, .json 또는 .junit.xml이어야 합니다";
        NoDriveReport: "a report of a drive ends in .html, .json or .csv", "주행 보고서 파일의 확장자는 .html, .json 또는 .csv여야 합니다";
        NoComparison(file: String): "--report {file}: the file must end in .json or .txt", "--report {file}: 파일의 확장자는 .json 또는 .txt여야 합니다";
        Option(option: &'static str): "{option}", "{option}";
        NoneShared(file: String, names: String): "{file}: none of its signals is one of the trace's: {names}; `--map NAME=SIGNAL` says what one is", "{file}: 신호 기록에 있는 신호가 없습니다: {names}. `--map NAME=SIGNAL`로 지정하십시오";
        NoColumn(file: String, column: String, near: Near): "{file}: --map names \"{column}\", which is no signal in it{near}", "{file}: --map의 \"{column}\"이(가) 파일에 없습니다{near}";
        NoNewName(name: String, form: &'static str): "\"{name}\" is no name here: {form}, in small letters, digits and _", "\"{name}\"은(는) 이름으로 쓸 수 없습니다: 소문자, 숫자, _로 된 {form}";
        NewExists(file: String): "{file} is there already; choose another name, or change that one", "이미 있습니다: {file}. 다른 이름을 쓰거나 그 파일을 고치십시오";
        Password: "the command line holds a password, and every program on this computer can read it there: leave it out of the address and put it into ~/.pgpass (a line HOST:PORT:DATABASE:USER:PASSWORD, chmod 600), into a file named with ?passfile=FILE, or into PGPASSWORD; and change it, if others work here", "명령줄에 비밀번호가 있어 이 컴퓨터의 모든 프로그램이 읽을 수 있습니다. 주소에서 빼고 ~/.pgpass(HOST:PORT:DATABASE:USER:PASSWORD 한 줄, chmod 600), ?passfile=FILE로 지정한 파일 또는 PGPASSWORD에 두십시오. 다른 사람도 쓰는 컴퓨터라면 비밀번호를 바꾸십시오";
        NoSignature(file: String, why: Why): "{file} carries no signature: it is no database, no HTML sheet with a certificate and no certificate ({why}). Nothing in it is covered; `ptu verify RUN` verifies the run that it names", "{file}에 서명이 없습니다: 데이터베이스, 증명서가 있는 HTML 성적서 또는 증명서가 아닙니다 ({why}). 보호되는 내용이 없습니다. 그 시험의 확인: `ptu verify RUN`";
        NoLife(serial: String, near: Near): "Nothing with the serial number {serial} is stored: no unit, no train, no part that a repair put in or took out{near}", "일련번호 {serial}의 기록이 없습니다. 장치, 편성, 수리로 장착하거나 제거한 부품을 찾았습니다{near}";
        // Starting the window.
        NoWindow(program: String): "the window is a program of its own, and {program} is not there: install the package `ptu`, which has both, or build it with `cargo build --release -p ptu-window`; `ptu help` says what is done without a window", "창은 별도의 프로그램이며 {program}이(가) 없습니다. 둘 다 들어 있는 `ptu` 패키지를 설치하거나 `cargo build --release -p ptu-window`로 만드십시오. 창 없이 할 수 있는 일: `ptu help`";
        NoDisplay: "no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set); start it from a desktop, or use `ptu run`, `ptu faults` and `ptu diagnose` here", "창을 열 화면이 없습니다(DISPLAY와 WAYLAND_DISPLAY가 설정되지 않음). 데스크톱에서 시작하거나 여기에서 `ptu run`, `ptu faults`, `ptu diagnose`를 쓰십시오";
        NotOpened(why: String): "cannot open a window: {why}; check the display and its OpenGL driver, or use `ptu run` here", "창을 열 수 없습니다: {why}. 화면과 OpenGL 드라이버를 확인하거나 여기에서 `ptu run`을 쓰십시오";
        Creates: "`ptu gui --create` makes it", "만들기: `ptu gui --create`";
    }

    /// Refusals about automatic runs, trains and test matrices.
    DriveTrouble {
        Outside(option: String, value: String, low: String, high: String): "{option} {value} is outside {low} .. {high}", "{option} {value}이(가) 범위 {low} .. {high}를 벗어납니다";
        BrakesLess(train: String, brakes: f64, counts_on: f64): "the train \"{train}\" brakes at {brakes} km/h/s, and ATO counts on {counts_on} (ato.decel_kmh_per_s): it may overrun its stop points" ["; --set ato.decel_kmh_per_s={brakes} tells ATO"], "열차 \"{train}\"의 제동 감속도는 {brakes} km/h/s이고 ATO는 {counts_on}(ato.decel_kmh_per_s)을 기준으로 하므로 정차 위치를 지나칠 수 있습니다" [". ATO에 알리려면 --set ato.decel_kmh_per_s={brakes}"];
        NoEffect(option: &'static str, train: String): "{option} does not act on train {train}; use --train line6", "{option}: 열차 {train}에는 작용하지 않습니다. --train line6을 쓰십시오";
        ControllerTwice(setting: String): "--set {setting} beside --controller or --compare: give one of them", "--set {setting}은(는) --controller나 --compare와 함께 쓸 수 없습니다. 하나만 쓰십시오";
        Twice(name: &'static str): "--compare names {name} twice", "--compare에 {name}이(가) 두 번 있습니다";
        LinkLost(why: LinkTrouble): "link lost: {why}", "통신 두절: {why}";
        Refused(why: String): "the bench refused: {why}", "시험대가 거부했습니다: {why}";
        NoPlan(why: String): "{why}", "이 주행을 할 수 없습니다: {why}";
        PointMass(train: String): "--train {train}: a point mass has no cars", "--train {train}: 질점에는 차량이 없습니다";
        Outcome(text: String): "--outcomes: \"{text}\" is not TEST=0 (passed), TEST=1 (failed) or TEST=WORD", "--outcomes: \"{text}\"은(는) TEST=0(합격), TEST=1(불합격) 또는 TEST=WORD가 아닙니다";
    }

    /// Refusals about waveforms and sound devices.
    SoundTrouble {
        NoMarker: "markers are PSM1 to PSM4: give 1, 2, 3 or 4", "마커는 PSM1에서 PSM4까지입니다. 1, 2, 3, 4 중 하나를 지정하십시오";
        NoBytes: "bytes are pairs of hex digits, as '01 fe 3c'", "바이트는 '01 fe 3c'와 같이 16진수 두 자리씩 적습니다";
        HowManyBytes(most: usize): "1 to {most} bytes are needed, each of two hex digits", "16진수 두 자리인 바이트 1~{most}개가 필요합니다";
        Calibrations(file: String, why: Why): "cannot read the calibrations of sound devices in {file}: {why}; correct or delete it", "음향 장치의 교정값을 읽을 수 없습니다: {file} ({why}). 고치거나 삭제하십시오";
        Device(what: &'static str, device: String, why: Why): "cannot {what} {device}: {why}", "{device}에서 {what} 실패: {why}";
        NoProgram(server: &'static str, alsa: &'static str): "no program carries sound here: neither {server} (pulseaudio-utils) nor {alsa} (alsa-utils) is installed", "음향을 전달할 프로그램이 없습니다: {server} (pulseaudio-utils)와 {alsa} (alsa-utils)가 모두 설치되어 있지 않습니다";
        NotListed(program: String, why: Why): "cannot list devices for sound: {program}: {why}", "음향 장치 목록을 읽을 수 없습니다: {program} ({why})";
        Implausible(channel: &'static str, measured: String, level: f64): "channel {channel}: {measured} mV where {level} mV were expected cannot be right", "채널 {channel}: {level} mV가 예상되는 곳에서 {measured} mV는 옳을 수 없습니다";
        NobodyAsked: "nobody can be asked here: give what the instrument showed with --measured", "여기에서는 시험자에게 물을 수 없습니다. 계측기의 값을 --measured로 지정하십시오";
        TooLoud(level: f64): "the device cannot make {level} mV: choose a lower --level", "장치가 {level} mV를 낼 수 없습니다. 더 낮은 --level을 지정하십시오";
        NoCode: "name the speed code, or the bytes in hex, as in `ptu signal play code 55`", "`ptu signal play code 55`와 같이 속도 코드 또는 16진수 바이트를 지정하십시오";
        OneValue: "a code or bytes follow `code` or `twc`, and nothing follows a file", "`code`나 `twc` 뒤에는 코드나 바이트를 적고, 파일 뒤에는 아무것도 적지 않습니다";
        Rate(hz: u32, to: u32): "the file has {hz} samples a second: make it one of {to}, as with `sox IN.wav -r {to} OUT.wav`", "파일의 샘플이 초당 {hz}개입니다. `sox IN.wav -r {to} OUT.wav`와 같이 {to}개로 바꾸십시오";
    }

    /// Refusals about runs, questions and answers that are kept.
    KeepTrouble {
        Unusable(file: String, why: Why): "cannot use {file}: {why}; name another file", "쓸 수 없는 파일입니다: {file} ({why}). 다른 파일을 지정하십시오";
        Unwritten(file: String, why: String): "cannot write {file}: {why}; it keeps the runs before, and the campaign goes on with the same command", "쓸 수 없습니다: {file} ({why}). 그 전의 시험은 남아 있으며 같은 명령으로 이어집니다";
        Unordered(file: String, why: String): "cannot put {file} in order: {why}; it keeps its runs", "파일을 정렬할 수 없습니다: {file} ({why}). 시험은 그대로 있습니다";
        Again(file: String, why: String): "{file}: {why}; make its runs again with another file, or leave it out", "{file}: {why}. 그 시험을 다른 파일로 다시 하거나 이 파일을 빼십시오";
        Cut(file: String, why: String): "{file}: {why}; give its own command once more, with this file, and then merge", "{file}: {why}. 이 파일로 같은 명령을 한 번 더 실행한 후 병합하십시오";
        OtherResult(file: String, run: String, other: String): "{file}: its run {run} has another result than in {other}; one of them was changed, or made by another build of the program: make both again", "{file}: 시험 {run}의 결과가 {other}와(과) 다릅니다. 하나가 변경되었거나 다른 빌드의 프로그램으로 만들었습니다. 둘 다 다시 만드십시오";
        Unlike(file: String, why: Why, first: String, what: String): "{file}: {why}, unlike those of {first} ({what}); leave one of the two out", "{file}: {first} ({what})과(와) 다릅니다: {why}. 둘 중 하나를 빼십시오";
        NoFile: "no file is named", "파일을 지정하십시오";
        RunsOfMany: "--runs goes with --monte-carlo", "--runs는 --monte-carlo와 함께 씁니다";
        Shard(why: String): "--shard: {why}", "--shard에 오류가 있습니다: {why}";
        Circle(name: String, way: String, file: String): "the saved question \"{name}\" asks itself: {way} → {name}; correct {file} or remove one with --forget", "저장된 질문 \"{name}\"이(가) 자신을 부릅니다: {way} → {name}. {file}을(를) 고치거나 하나를 --forget으로 지우십시오";
        SavedAlready(name: String): "\"{name}\" is saved already; ask it in full to save it under another name", "\"{name}\"은(는) 이미 저장되었습니다. 다른 이름으로 저장하려면 전체를 적으십시오";
        NotAsked(name: String, why: String): "the saved question \"{name}\" cannot be asked so: {why}", "저장된 질문 \"{name}\"을(를) 이렇게 쓸 수 없습니다: {why}";
        NoName(name: String): "\"{name}\" is no name for a question", "\"{name}\"은(는) 질문의 이름이 될 수 없습니다";
        NoText(word: String): "{word} is no text to save", "저장할 수 있는 글자가 아닙니다: {word}";
        Disk(mb: u64): "the question was given up: it takes more than {mb} MB of temporary disk; ask for less, or allow more with --max-disk MB", "조회를 중단했습니다: 임시 디스크 {mb} MB를 넘습니다. 범위를 줄이거나 --max-disk MB로 늘리십시오";
        Time(seconds: u64): "the question was given up: it takes longer than {seconds} s; ask for less, or allow more with --max-time SECONDS", "조회를 중단했습니다: {seconds} s를 넘습니다. 범위를 줄이거나 --max-time SECONDS로 늘리십시오";
        Memory(mb: u64): "the question was given up: it takes more than {mb} MB of memory; ask for less, or allow more with --max-memory MB", "조회를 중단했습니다: 메모리 {mb} MB를 넘습니다. 범위를 줄이거나 --max-memory MB로 늘리십시오";
        Row(most: usize): "the question was given up: a row is longer than {most} bytes; ask for less of it, as with substr()", "조회를 중단했습니다: 한 행이 {most}바이트를 넘습니다. substr() 등으로 줄이십시오";
    }
}
