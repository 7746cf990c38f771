//! What is refused of what a person asked for, in both languages: `name(what it names): English, Korean;`.

use std::fmt::Display;

use ptu_runs::failure::Trouble;

macro_rules! said {
    ($($name:ident($($arg:ident),*): $english:literal, $korean:literal;)*) => {
        $(
            #[doc = $english]
            pub fn $name($($arg: impl Display),*) -> Trouble {
                Trouble::Said([format!($english), format!($korean)])
            }
        )*

        #[cfg(test)]
        pub(super) const ALL: &[(&str, &str, &str)] = &[$((stringify!($name), $english, $korean)),*];
    };
}

said! {
    // A run.
    error_in_scripts(): "1 error in the scripts; nothing was driven", "스크립트 오류 1건. 아무것도 구동하지 않았습니다";
    errors_in_scripts(n): "{n} errors in the scripts; nothing was driven", "스크립트 오류 {n}건. 아무것도 구동하지 않았습니다";
    needs_cars(train, procedures): "the train \"{train}\" has no cars, which these test: {procedures}", "열차 \"{train}\"에는 차량이 없어 다음을 시험할 수 없습니다: {procedures}";
    jobs_on_port(): "--jobs works on simulated units only; one port is one unit", "--jobs: 모의 장치에만 쓸 수 있습니다. 포트 하나에는 장치 하나만 있습니다";
    slower_without_clock(): "--slower is for what goes by the clock: a unit on a port, or --realtime", "--slower: 포트의 장치나 --realtime과 함께 씁니다";
    adaptive_once(): "--adaptive does one step after the other, each once; leave --repeat and --jobs out", "--adaptive: 단계를 하나씩 한 번만 시험합니다. --repeat와 --jobs를 빼십시오";
    excludes_none(name, near): "--exclude: no procedure \"{name}\" would be run{near}; `ptu run --list` shows all", "--exclude: 시험할 절차 중에 \"{name}\"이(가) 없습니다{near:#}. 전체 목록: `ptu run --list`";
    excludes_all(name): "--exclude {name} leaves nothing to run", "--exclude {name}: 시험할 것이 남지 않습니다";
    no_step_chosen(): "no step is chosen", "선택한 단계가 없습니다";
    not_answered(): "the query was not answered", "조회에 응답이 없습니다";
    still_running(run): "run {run} is still under way; wait for its end, or stop it first", "시험 {run}이(가) 아직 진행 중입니다. 끝나기를 기다리거나 먼저 중지하십시오";
    ran_nothing(run, source): "run {run} ({source}) ran no procedures; name a run of `ptu run`, see `ptu runs list`", "시험 {run} ({source})에는 시험한 절차가 없습니다. `ptu run`의 시험을 지정하십시오. 목록: `ptu runs list`";
    all_judged(run): "each procedure of run {run} has a verdict; `ptu runs show {run}` lists them, and --retry-errors runs those again that could not be tested", "시험 {run}의 모든 절차에 판정이 있습니다. 목록: `ptu runs show {run}`. 판정 불가인 절차는 --retry-errors로 다시 시험합니다";
    none_in_error(run): "no procedure of run {run} ended as an error; `ptu runs show {run}` lists their verdicts", "시험 {run}에 판정 불가로 끝난 절차가 없습니다. 판정: `ptu runs show {run}`";
    was_on_no_unit(run, source, error): "run {run} was on \"{source}\", which is no unit to connect to: {error}", "시험 {run}의 장치 \"{source}\"에는 연결할 수 없습니다: {error}";
    was_on_other_unit(run, place, unit): "run {run} was on {place}, and --unit says {unit}: another unit does not continue a run; leave --unit out, or begin a new run", "시험 {run}의 장치는 {place}이고 --unit은 {unit}입니다. 다른 장치로 이어서 시험할 수 없습니다. --unit을 빼거나 새로 시험하십시오";
    was_of_other_serial(run, was, serial): "run {run} tested unit {was}, and --serial-no says {serial}: another unit does not continue a run; leave --serial-no out, or begin a new run", "시험 {run}의 장치는 {was}이고 --serial-no는 {serial}입니다. 다른 장치로 이어서 시험할 수 없습니다. --serial-no를 빼거나 새로 시험하십시오";
    not_all_events(place, why): "{place} has not all events: {why}; `ptu runs show latest` has the run", "{place}에 이벤트가 모두 있지 않습니다: {why}. 시험 기록: `ptu runs show latest`";
    // Faults and repairs.
    no_part_here(part, near): "no part \"{part}\"{near}; `ptu catalog parts` lists them, and --other-part names one that the catalogue lacks", "부품 \"{part}\"이(가) 없습니다{near:#}. 목록: `ptu catalog parts`. 목록에 없는 부품은 --other-part로 지정합니다";
    repair_without_part(): "a repair is of a part; name it with --part", "수리한 부품을 --part로 지정하십시오";
    other_part_unnamed(): "--other-part names a part", "--other-part에 부품을 지정하십시오";
    empty_note(): "a note says something", "메모에 내용을 적으십시오";
    code_never(code, near): "no fault \"{code}\" was ever recorded{near}", "고장 \"{code}\"의 기록이 없습니다{near:#}";
    part_never(part, near): "no fault ever named the part \"{part}\"{near}", "부품 \"{part}\"의 고장 기록이 없습니다{near:#}";
    cause_never(part, near): "no fault ever came from the part \"{part}\"{near}", "부품 \"{part}\"이(가) 원인인 고장 기록이 없습니다{near:#}";
    train_never(train, near): "no run in the train \"{train}\" was ever recorded{near}", "열차 \"{train}\"의 시험 기록이 없습니다{near:#}";
    line_never(line, near): "no fault was ever seen on the line \"{line}\"{near}", "노선 \"{line}\"의 고장 기록이 없습니다{near:#}";
    procedure_never(procedure, near): "no fault was ever seen in the procedure \"{procedure}\"{near}", "절차 \"{procedure}\"의 고장 기록이 없습니다{near:#}";
    serial_never(serial, near): "no part with the serial number \"{serial}\" was ever taken out or put in{near}", "일련번호 \"{serial}\"인 부품을 떼거나 단 기록이 없습니다{near:#}";
    measurement_never(name, near): "no measurement \"{name}\" recorded{near}; `ptu run --list` shows what is measured", "측정 \"{name}\"의 기록이 없습니다{near:#}. 측정 항목: `ptu run --list`";
    repair_never(part, unit, near): "no repair of {part} on unit {unit} recorded{near}", "장치 {unit}에서 {part}의 수리 기록이 없습니다{near:#}";
    distances_by_month(): "distances are known by month only: add --by month", "주행거리는 월별로만 알 수 있습니다. --by month를 추가하십시오";
    // Sheets, seals and signatures.
    annex_of_run(): "--annex is of a case; the sheet of a run has all of it already", "--annex: 정비 작업에만 씁니다. 시험 성적서에는 이미 모두 있습니다";
    case_unsigned(): "the page of a case carries no signature: leave --key and PTU_KEY out, and sign the sheet of each run", "정비 작업의 문서에는 서명하지 않습니다. --key와 PTU_KEY를 빼고 각 시험의 성적서에 서명하십시오";
    fits_run_and_fault(id): "\"{id}\" fits a run and a fault; give more digits, or --case for the fault", "\"{id}\"에 해당하는 시험과 고장이 모두 있습니다. 더 길게 입력하거나, 고장이면 --case를 쓰십시오";
    fits_nothing(id): "no run and no fault \"{id}\"; `ptu runs list` and `ptu faults list` show what there is", "\"{id}\"에 해당하는 시험과 고장이 없습니다. 목록: `ptu runs list`, `ptu faults list`";
    unsigned(run): "run {run} is not signed and has no certificate; `ptu run --key FILE` signs one", "시험 {run}에는 서명과 증명서가 없습니다. `ptu run --key FILE`로 서명합니다";
    changed(run, change): "the run was changed, and no sheet of it is signed: {change}; `ptu verify {run}` tells all", "시험 기록이 변경되어 성적서에 서명하지 않습니다: {change}. 전체 내용: `ptu verify {run}`";
    no_code_of_sheet(): "a code of a sheet reads ptu:RUN/SHA-256", "성적서의 코드는 ptu:RUN/SHA-256 형식입니다";
    pin_unread(why): "no PIN could be read: {why}", "PIN을 읽지 못했습니다: {why}";
    no_key_in(file): "{file} names no key", "{file}에 키가 없습니다";
    keys_alike(n, asked): "{n} keys are of \"{asked}\"; give the beginning of the key, as `ptu key list` shows it", "\"{asked}\"의 키가 {n}개 있습니다. `ptu key list`에 표시된 키의 앞부분을 입력하십시오";
    key_stays(file): "{file} is there already and stays; name another file with --out", "{file}이(가) 이미 있어 그대로 둡니다. --out으로 다른 파일을 지정하십시오";
    run_beside_itself(run): "both are run {run}: a run is compared with another one", "둘 다 시험 {run}입니다. 서로 다른 시험을 비교하십시오";
    no_run_saw(fault): "no run saw fault {fault}", "고장 {fault}이(가) 나타난 시험이 없습니다";
    // Instruments.
    instrument_unnamed(): "an instrument has a serial number and a kind", "계측기의 일련번호와 종류를 지정하십시오";
    instrument_known(serial): "{serial} is registered already; `ptu instrument list` shows it", "{serial}은(는) 이미 등록되어 있습니다. 목록: `ptu instrument list`";
    due_before(due, on): "it is due on {due}, before it was calibrated on {on}", "교정 기한 {due}이(가) 교정일 {on}보다 빠릅니다";
    // Traces.
    no_trace_format(): "the file to export to must end in .csv, .parquet or .mcap", "내보낼 파일의 확장자는 .csv, .parquet 또는 .mcap이어야 합니다";
    no_comparable(file): "cannot compare with {file}: a file to compare with must end in .csv, .parquet or .mcap", "{file}과(와) 비교할 수 없습니다. 비교할 파일의 확장자는 .csv, .parquet 또는 .mcap이어야 합니다";
    shift_of_file(): "--shift lays a file elsewhere; traces are laid at their triggers", "--shift: 파일에만 씁니다. 신호 기록은 트리거에 맞춥니다";
    columns_of_file(): "--map, --time and --time-unit say what the columns of a file are; B is none", "--map, --time, --time-unit: 파일의 열을 지정합니다. B는 파일이 아닙니다";
    outside_trace(from, to): "the trace has no row in that span; it goes from {from} to {to} s of its trigger", "그 구간에는 신호 기록이 없습니다. 신호 기록은 트리거 기준 {from} ~ {to} s입니다";
    file_outside_trace(from, to, begin, end): "the file has no time in common with the trace: from its trigger the file goes from {from} to {to} s, the trace from {begin} to {end} s; lay it elsewhere with --shift SECONDS", "파일과 신호 기록에 공통 시간이 없습니다. 트리거 기준으로 파일은 {from} ~ {to} s, 신호 기록은 {begin} ~ {end} s입니다. --shift SECONDS로 옮기십시오";
    comes_twice(signal): "signal \"{signal}\" comes twice in the file", "파일에 신호 \"{signal}\"이(가) 두 번 있습니다";
    trace_damaged(trace, period): "trace {trace} has rows of {period} µs: it is damaged", "신호 기록 {trace}의 주기가 {period} µs입니다: 손상되었습니다";
    // The window.
    opens_by_hand(program, file): "{program} is not there: open {file} by hand", "{program} 프로그램이 없습니다. {file}을(를) 직접 여십시오";
    server_is_read(): "a server's history is only read: without --unit, or with --db FILE", "서버의 이력은 읽기만 합니다. --unit을 빼거나 --db FILE을 쓰십시오";
    run_unnamed(): "name a run", "시험을 지정하십시오";
    variable_empty(name): "{name} is empty; let it name a database, or unset it", "{name}이(가) 비어 있습니다. 데이터베이스를 지정하거나 변수를 지우십시오";
}
