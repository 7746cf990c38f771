//! Answers of the command line: headings of its tables, and the lines around them.

use std::borrow::Cow;

use btu_rig::procedure::Verdict;
use btu_rig::procedure::finding::{Finding, Findings};
use btu_rig::procedure::plan::Action;
use fault_db::{FaultState, RunState, RunSummary, StepRecord};

use super::{Language, Words, wordings};
use ptu_runs::stored::from_stored;
use ptu_runs::words::{event_kind, fault_state};

wordings! {
    /// Answers of the command line.
    Terminal {
        after_run: "; `ptu diagnose {run}` says why", "; 이유: `ptu diagnose {run}`";
        forgotten: "\"{name}\" is forgotten", "\"{name}\" 삭제함";
        nothing_there: "nothing there", "없음";
        first_rows: "only the first {n} rows; allow more with --max-rows N, or ask for less", "처음 {n}행만 표시함. 더 보려면 --max-rows N";
        change_it: "change it, then `{check}`; `{next}`", "내용을 고친 뒤 `{check}`, `{next}`";
        each_sourced: "each limit names its source", "모든 한계에 출처 있음";
        unsourced: "{n} limits name no source", "출처 없는 한계 {n}개";
        no_korean: "no Korean in korean.toml: \"{text}\"", "korean.toml에 한국어 없음: \"{text}\"";
        each_korean: "each text has its Korean", "모든 문장에 한국어 있음";
        without_korean: "{n} texts have no Korean", "한국어 없는 문장 {n}개";
        bench_checked: "bench {bench}: its file and drivers have no errors, it does {n} of {of} steps", "시험대 {bench}: 파일과 드라이버에 오류 없음, 단계 {of}개 중 {n}개 수행 가능";
        bench_leaves_out: "{procedure}: {n} of {of} steps are left out: {why}", "{procedure}: 단계 {of}개 중 {n}개 제외: {why}";
        departure_goes_on: "A departure test finds no part: its failed steps point at {parts}. `ptu run --adaptive` on this unit finds it, with the fault dictionary", "출고 점검은 부품을 찾지 않습니다. 불합격 단계가 가리키는 부품: {parts}. 이 장치에서 `ptu run --adaptive`를 실행하면 고장 사전으로 부품을 찾습니다";
        checked: "{procedures} procedures, {steps} steps, {files} data files, no errors", "절차 {procedures}개, 단계 {steps}개, 데이터 파일 {files}개, 오류 없음";
        other_time: "{file} is of another time: its beginning is laid at that of the trace; --shift SECONDS lays it elsewhere", "{file}은(는) 다른 시각의 기록이라 시작을 신호 기록의 시작에 맞췄습니다. 옮기려면 --shift SECONDS";
        pin_of: "PIN of {who}'s key: ", "{who} 키의 PIN: ";
        new_pin: "PIN for the new key: ", "새 키의 PIN: ";
        same_again: "the same again: ", "한 번 더: ";
        allowed: ", allowed {limit}", ", 허용 {limit}";
        asks: "asks", "확인 요청";
        at_most: "at most", "최대 시간";
        back: "back", "재발";
        bench_time: "bench time", "시험대 시간";
        begins: "begins", "시작";
        by: "by", "작성자";
        bringing_up: "bringing the unit up", "장치 기동 중";
        calibrated: "calibrated", "교정";
        case_sheet: "`ptu report {fault} --out case.pdf` writes the sheet of the repair", "수리 성적서: `ptu report {fault} --out case.pdf`";
        comes_from: "fault {fault} comes from {part}", "고장 {fault}의 원인: {part}";
        continues: "continues run {run}", "시험 {run}에 이어서 한 시험";
        course: "course", "추이";
        cumulated: "cum", "누계";
        counts: "run {run}  unit {unit}  {steps} steps, {failed} not passed, {faults} faults", "시험 {run}  장치 {unit}  {steps}개 단계, {failed}개 미합격, 고장 {faults}건";
        deviates: "first deviation from the good twin", "정상 기준과의 첫 차이";
        diagnose_all: "`ptu diagnose {run} --all` shows all reasons, and what the dictionary has", "모든 근거와 고장 사전의 내용: `ptu diagnose {run} --all`";
        direction: "direction", "방향";
        due: "due", "기한";
        faults: "faults", "고장";
        files_written: "written: {files}", "저장 완료: {files}";
        first_n: "only the first {n}; see --limit", "처음 {n}건만 표시함. --limit 참조";
        is_now: "fault {fault} is {state}", "고장 {fault} 상태: {state}";
        injected: "injected", "주입한 고장";
        from_where: "from", "출처";
        locale: "locale", "로캘";
        program: "program", "프로그램";
        option: "option", "옵션";
        not_there: "not there", "없음";
        script_changed: "{path} was changed since run {run}: its verdict is not that of the procedure that was due there", "시험 {run} 이후 {path}이(가) 바뀜: 판정이 당시 절차의 판정과 다를 수 있음";
        config_changed: "the unit configuration is not that of run {run}: what both came to does not add up to one test", "장치 구성이 시험 {run}과(와) 다름: 두 결과를 한 시험으로 합칠 수 없음";
        other_part: "no part \"{part}\" is known{near}; recorded as it is", "부품 \"{part}\"은(는) 목록에 없음{near}. 적은 대로 기록함";
        letters_coded: "{file}: the font of sheets lacks \"{letters}\", so codes such as [U+4e2d] stand there; pages (.html) have the letters", "{file}: 성적서 글꼴에 없는 글자 \"{letters}\"은(는) [U+4e2d]와 같은 코드로 표시함. .html에는 그대로 표시됨";
        instrument_new: "registered: {kind} {serial}; until `ptu instrument calibrate {serial}` runs on a port do not begin", "등록함: {kind} {serial}. `ptu instrument calibrate {serial}`로 교정을 기록할 때까지 포트 시험을 시작할 수 없음";
        instrument_calibrated: "calibrated: {serial} on {on}, due {due}", "교정 기록함: {serial}, 교정 {on}, 기한 {due}";
        instrument_retired: "retired: {serial}", "등록 해제함: {serial}";
        key: "key", "키";
        key_of: "{key} of {who}:", "{who}의 키 {key}:";
        key_from: "from {from}", "{from}부터";
        key_until: "from {from} until {until}", "{from}부터 {until}까지";
        key_revoked: "revoked from {day}: key {key} of {who}, in {file}; hand the new list to all who verify", "{day}부터 폐기: {who}의 키 {key} ({file}). 새 목록을 검증하는 모든 사람에게 전달하십시오";
        key_trusted: "trusted: {who}, key {key}, {span}, in {file}", "신뢰 목록에 추가함: {who}, 키 {key}, {span} ({file})";
        kind: "kind", "종류";
        later_earlier: "later/earlier", "후반/전반";
        left_seconds: "{what}, {n} s left", "{what}, {n}초 남음";
        length: "length", "길이";
        lines_lost: "{n} lines were left out because nothing took them; `ptu runs show latest` has all", "출력이 밀려 {n}줄을 생략함. 전체: `ptu runs show latest`";
        after_trigger: "{n} s after the trigger", "트리거 {n}초 후";
        as_expected: "as expected: no signal deviates from the good twin's", "예상과 같음: 정상 기준과 다른 신호 없음";
        at: "at", "시점";
        at_trigger: "at the trigger", "트리거 시점";
        before_trigger: "{n} s before the trigger", "트리거 {n}초 전";
        begins_at: "begins {at}, {rows} rows, {long}", "시작 {at}, {rows}행, {long}";
        came: "came", "실제";
        chain: "chain", "진행 순서";
        choose_signals: "and {n} more; choose with --signal", "그 밖의 {n}개는 --signal로 선택";
        cut_short: ", cut short", ", 중간에 끊김";
        deviate_later: "and {n} more signals, which deviate later", "나중에 달라진 신호 {n}개 더 있음";
        expected: "expected", "예상";
        is_expected: "{signal} is {value}, expected {expected}, {when}", "{signal}: {value} (예상 {expected}), {when}";
        instead_of: "{signal} {value} instead of {expected}", "{signal}: {value} (예상 {expected})";
        largest: "largest", "최대 차이";
        not_expected: "what was expected is not known: {why}", "예상 신호를 알 수 없음: {why}";
        of_trigger: "{before} s before the trigger and {after} s after", "트리거 전 {before}초, 후 {after}초";
        points_at: "fault {code} {name}, points at {part}", "고장 {code} {name}, 의심 부품 {part}";
        rows: "rows", "행";
        without_trigger: "{n} s, without the trigger", "{n}초, 트리거 없음";
        and_more: "… and more; see --limit", "… 더 있음. --limit 참조";
        mean: "mean", "평균";
        name: "name", "이름";
        named_only: "run only when named: {names}", "지정할 때만 수행: {names}";
        no_instrument: "no instrument is registered; `ptu instrument add` registers one", "등록된 계측기가 없음. `ptu instrument add`로 등록";
        no_keys: "no keys; `ptu key new` makes one, `ptu key trust FILE.pub` adds another's", "키가 없음. `ptu key new`로 만들거나 `ptu key trust FILE.pub`으로 추가";
        not_calibrated: "not calibrated", "교정되지 않음";
        no_question: "no question was saved; add --save NAME to one", "저장한 조건이 없음. 조회에 --save NAME을 붙이면 저장됨";
        no_ports: "no serial ports found; name one with --unit serial:PATH", "직렬 포트를 찾지 못함. --unit serial:PATH로 지정";
        no_runs: "no runs recorded; `ptu run` makes one", "기록된 시험이 없음. `ptu run`으로 시험을 수행";
        no_traces: "no traces recorded; a run that finds a fault makes one", "신호 기록이 없음. 고장을 찾은 시험에서 만들어짐";
        no_steps: "{source}, no steps", "{source}, 수행된 단계 없음";
        noted: "noted", "작성 시각";
        noted_on_fault: "noted on fault {fault}", "고장 {fault}에 메모를 기록함";
        noted_on_run: "noted on run {run}", "시험 {run}에 메모를 기록함";
        of_case: "and {fault} of the same case, {name} {part}", "같은 건의 {fault}, {name} {part}";
        of_n: "{run} of {of}", "{run}/{of}";
        of_these: "of these", "이 중";
        other_faults: "other faults", "그 밖의 고장";
        question: "question", "조회";
        reason: "why", "이유";
        repeat: "repeat", "재시도";
        repeated_step: "repeated step", "다시 한 단계";
        resumed_on: "run {run} was on {line}; what is left is run on {now}", "시험 {run}의 노선은 {line}, 나머지는 {now}에서 수행";
        share: "share", "비율";
        signed: "signed by {who} ({kind}, key {key}) at {at}; `ptu verify {run}` verifies it", "전자 서명: {who} ({kind}, 키 {key}), {at}. 검증: `ptu verify {run}`";
        skipped: "skipped, {why}", "미실행, {why}";
        skipped_steps: "skipped steps", "미실행 단계";
        source: "source", "연결";
        stands_alone: "fault {fault} stands alone", "고장 {fault}: 다른 원인 없음";
        started: "started", "시작";
        step_count: "{pos}/{len} steps  {elapsed} (left {eta})  {msg}", "{pos}/{len} 단계  {elapsed} (남은 시간 {eta})  {msg}";
        steps: "steps", "단계";
        serial: "serial", "일련번호";
        summary: "run {run}  unit {unit}  {steps} steps, {faults} faults: {verdict}", "시험 {run}  장치 {unit}  {steps}개 단계, 고장 {faults}건: {verdict}";
        times: "bench time {bench} s in {wall} s", "시험대 시간 {bench} s, 실제 {wall} s";
        title: "title", "제목";
        trace: "trace", "신호 기록";
        traces_naming: "traces of faults that name {part}: {ids}", "{part} 관련 고장의 신호 기록: {ids}";
        today: "today", "오늘";
        uncertainty: "uncertainty", "불확도";
        valid: "valid", "유효";
        who: "who", "이름";
        type_yes_no: "type y for yes or n for no", "예는 y, 아니요는 n을 입력";
        values: "values", "값의 수";
        why_not: "why not {part}; of its faults the likeliest is", "{part}이(가) 아닌 이유. 이 부품의 가장 유력한 고장:";
        left_out: "left out: {why}", "제외함: {why}";
    }
}

impl Words {
    /// Words in the language that the terminal of this process shows.
    pub fn shown() -> &'static Self {
        Language::shown().words()
    }

    /// A verdict in tables and lines of a terminal; in English by its name in files and filters.
    pub fn verdict_name(&self, verdict: Verdict) -> &'static str {
        match self.language {
            Language::English => verdict.label(),
            Language::Korean => self.common.verdict(verdict),
        }
    }

    /// The verdict of a stored run, or else its state; in English by its name in files and filters.
    pub fn run_verdict(&self, run: &RunSummary) -> &'static str {
        match (run.verdict, self.language, run.state) {
            (Some(verdict), ..) => self.verdict_name(from_stored(verdict)),
            (None, Language::English, state) => state.as_str(),
            (None, _, RunState::Running) => self.common.running,
            (None, _, RunState::Interrupted) => self.common.interrupted,
            (None, _, RunState::Finished) => self.report.finished,
        }
    }

    /// A fault's state; in English by its name in filters.
    pub fn fault_state(&self, state: FaultState) -> &'static str {
        self.choose([state.as_str(), fault_state(state)])
    }

    /// Kind of an event of a fault, as text; an unknown kind stays as it is.
    pub fn event_kind<'a>(&self, kind: &'a str) -> &'a str {
        self.choose([kind, event_kind(kind)])
    }

    /// A severity in tables of a terminal; in English by its name in filters.
    pub fn severity_name<'a>(&self, severity: &'a str) -> &'a str {
        match self.language {
            Language::English => severity,
            Language::Korean => self.report.severity(severity),
        }
    }

    /// Findings of a step, in tables of a terminal: in English by the names in scripts.
    pub fn found_in<'a>(&self, step: &'a StepRecord) -> Cow<'a, str> {
        match self.language {
            Language::English => Cow::Borrowed(&step.message),
            Language::Korean => self.found(&step.findings, &step.message),
        }
    }

    /// Findings in one place, in tables of a terminal: in English by the names in scripts.
    pub fn short_findings(&self, all: &Findings) -> String {
        match self.language {
            Language::English => all.to_string(),
            Language::Korean => self.findings(all),
        }
    }

    /// Condition that an action waits for, in tables of a terminal: in English by the names in scripts.
    pub fn awaited_briefly(&self, action: &Action) -> String {
        match self.language {
            Language::English => action.to_string(),
            Language::Korean => self.awaited(action),
        }
    }

    /// One finding, in tables of a terminal: in English by the names in scripts.
    pub fn short_finding(&self, one: &Finding) -> String {
        match self.language {
            Language::English => one.to_string(),
            Language::Korean => self.finding(one),
        }
    }
}
