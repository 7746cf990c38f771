//! Test sheet.

use protocol::event::Severity;

use super::wordings;
use ptu_runs::run_diagnosis::Origin;

wordings! {
    /// Test sheet.
    Report {
        title: "Report", "시험 성적서";
        sheet: "Test sheet", "시험 성적서";
        of_unit: "Unit {serial}, run {run}", "장치 {serial}, 시험 {run}";
        not_passed: "{n} of {of} steps did not pass", "{of}개 단계 중 {n}개 미합격";
        none_run: "0 of {of} steps run", "{of}개 단계 중 0개 수행";
        part_passed: "{run} of {of} steps run, all passed; {left} not run", "{of}개 단계 중 {run}개 수행, 모두 합격; {left}개 미실행";
        part_not_passed: "{run} of {of} steps run, {n} did not pass; {left} not run", "{of}개 단계 중 {run}개 수행, {n}개 미합격; {left}개 미실행";
        attempts: "; {n} attempts", "; 시도 {n}회";
        needs_bench: "; {n} need the bench harness: {what}", "; {n}개는 시험대 하네스 필요: {what}";
        and_others: " and {n} more", " 외 {n}건";
        repair_proven: "Fault {fault}: the repair is verified. With the fault still there, the runs since it would all have passed in {hidden} of 100 cases", "고장 {fault}: 조치가 검증되었습니다. 고장이 남아 있다면 이후 시험이 모두 합격할 확률은 100회 중 {hidden}회입니다";
        repair_claimed: "Fault {fault}: the repair is not proven yet. Runs passed since it: {passed}; such a fault hides in {hidden} of 100 such runs. More such runs needed: {more}", "고장 {fault}: 조치가 아직 검증되지 않았습니다. 조치 이후 합격 {passed}회; 이런 고장은 이런 시험 100회 중 {hidden}회 드러나지 않습니다. {more}회 더 시험하십시오";
        repair_not_shown: "Fault {fault}: the repair is not proven. Runs passed since it: {passed}; such a fault hides in {hidden} of 100 such runs. Run the whole procedures that saw it", "고장 {fault}: 조치가 검증되지 않았습니다. 조치 이후 합격 {passed}회; 이런 고장은 이런 시험 100회 중 {hidden}회 드러나지 않습니다. 고장이 나타난 절차 전체를 시험하십시오";
        all_passed: "{of} steps", "{of}개 단계";
        outside: "outside steps", "단계 외 미합격";
        outside_steps: "; outside steps: {n}", "; 단계 외 미합격: {n}건";
        no_steps: "No steps were run.", "수행된 단계가 없습니다.";
        not_finished: "The run has no verdict: it is under way or was broken off. What is here was recorded until then.",
            "판정이 없는 시험입니다. 진행 중이거나 도중에 끊겼으며, 그때까지 기록된 내용만 실었습니다.";
        the_run: "Run", "시험 개요";
        run_id: "Run number", "시험 번호";
        continues: "Continues run", "이어서 한 시험";
        unit_serial: "Serial number of the unit", "장치 일련번호";
        unit_kind: "Kind of unit", "장치 종류";
        unit_config: "Unit configuration", "장치 구성";
        tester: "Tested by", "시험자";
        nobody: "not stated", "기재 없음";
        seed: "Seed", "시드";
        source: "Connection", "연결";
        started: "Started", "시작";
        finished: "Finished", "종료";
        bench_time: "Time on the bench", "시험대 시간";
        wall_time: "Time by the clock", "실제 소요 시간";
        program: "Program version", "프로그램 버전";
        not_valid: "Not valid as a departure test", "출고 점검으로 유효하지 않음";
        valid_until: "Departure test, valid until", "출고 점검 유효 기한";
        injected: "Faults injected", "주입한 고장";
        scripts_hash: "SHA-256 of all scripts", "전체 스크립트 SHA-256";
        seal: "Seal", "봉인";
        seal_of: "{digits}, entry {n} of database {file}", "{digits}, 데이터베이스 {file}의 {n}번 항목";
        seal_found: "as the run was found when it came in", "외부에서 들어온 시점의 기록 그대로 봉인";
        clock: "Clock of the computer", "컴퓨터 시계";
        clock_set: "set by the network, within {ms} ms", "네트워크로 설정, 오차 {ms} ms 이내";
        clock_not_set: "not set by the network", "네트워크로 설정되지 않음";
        clock_not_known: "error not known", "오차 알 수 없음";
        instruments: "Instruments", "계측기";
        instrument: "{kind} {serial}, calibrated {day}, due {due}", "{kind} {serial}, 교정 {day}, 기한 {due}";
        instrument_over: "{kind} {serial}, not calibrated (last {day}, due {due})", "{kind} {serial}, 교정되지 않음 (최근 {day}, 기한 {due})";
        no_instruments: "none registered", "등록된 것 없음";
        decision_rule: "Decision rule (ISO/IEC 17025 7.8.6)", "판정 규칙 (ISO/IEC 17025 7.8.6)";
        rule_guard_band: "guard band: each limit is narrowed by the expanded uncertainty (k = 2) of its instrument", "가드 밴드: 각 한계값을 계측기의 확장 불확도(k = 2)만큼 좁힘";
        rule_simple: "limits as stated; what is outside by no more than the resolution of the measurement passes", "한계값 그대로 적용, 측정 분해능 이내의 초과는 합격";
        signed_by: "Signed with a key by", "전자 서명";
        signed: "{who}, key {key}, {at}", "{who}, 키 {key}, {at}";
        unsigned: "unsigned", "서명 없음";
        scanned: "For a scanner: the run, and the SHA-256 of its content as this sheet has it", "스캐너용: 시험 번호와, 이 성적서가 나타내는 시험 내용의 SHA-256";
        scripts: "Scripts", "스크립트";
        script: "Script", "스크립트";
        summary: "Verdicts", "판정 요약";
        steps: "Steps", "단계 수";
        failures: "What did not pass", "미합격 항목";
        step_or_measurement: "Step, measurement", "단계, 측정 항목";
        measurement: "Measurement", "측정 항목";
        unit_of_value: "Unit", "단위";
        within: "Within limits", "한계 내 위치";
        source_number: "Src.", "출처";
        limit_source: "Source", "내용";
        limit_sources: "Sources of limits", "한계값 출처";
        from_configuration: "unit configuration {key}", "장치 구성 {key}";
        from_track: "track database {key}", "선로 데이터베이스 {key}";
        from_train: "train data {key}", "열차 데이터 {key}";
        from_measurement: "measured before: {key}", "앞 단계 측정값: {key}";
        from_standard: "standard {key}", "표준 {key}";
        from_unit: "the unit's own limits", "장치 자체 한계값";
        by_default: "bench default", "시험기 기본값";
        by_default_because: "bench default: {key}", "시험기 기본값: {key}";
        seconds: "Time s", "시간 s";
        no_value: "no value", "값 없음";
        faults: "Faults", "고장";
        no_faults: "No faults were seen.", "발생한 고장이 없습니다.";
        minor: "minor", "경미";
        major: "major", "중대";
        critical: "critical", "치명";
        seen: "Seen", "횟수";
        first_seen: "First seen", "최초 발생";
        trace: "Trace", "신호 기록";
        trace_of_passed: "Trace {id}: passed after the repair", "신호 기록 {id}: 수리 후 합격";
        trace_of: "Trace {id}: {faults}", "신호 기록 {id}: {faults}";
        trace_shown: "Trace {id} is shown above.", "신호 기록 {id}은(는) 위에 있습니다.";
        trace_missing: "Trace {id} cannot be shown: {why}", "신호 기록 {id}을(를) 표시할 수 없음: {why}";
        more_traces: "{n} more traces are in the database.",
            "그 밖의 신호 기록 {n}개는 데이터베이스에 있습니다.";
        cut_short: "cut short", "중간에 끊김";
        other_traces: "Traces of other faults", "그 밖의 고장 신호 기록";
        from_trigger: "Time from the trigger, s", "트리거 기준 시간, s";
        trigger: "trigger", "트리거";
        speeds: "Speeds", "속도";
        changes: "What changed", "변화한 신호";
        diagnosis: "Diagnosis", "진단";
        no_diagnosis: "No diagnosis: {why}", "진단 불가: {why}";
        conclusion: "Conclusion", "결론";
        probability: "Probability", "확률";
        mode: "Fault mode", "고장 모드";
        speaks_for: "For it", "근거";
        next_check: "Next best check", "다음 권장 점검";
        dictionary: "Fault dictionary", "고장 사전";
        current: "made of these scripts", "현재 스크립트 기준";
        stale: "not made of these scripts", "현재 스크립트 기준 아님";
        procedures: "All steps", "전체 단계";
        procedure_passed: "{passed} of {of} passed", "{of}개 중 {passed}개 합격";
        signatures: "Signatures", "서명";
        tester_signs: "Tester", "시험자";
        approver_signs: "Approver", "승인자";
        date: "Date", "일자";
        notes: "Notes", "메모";
        noted_by: "Noted by", "작성자";
        noted: "Note", "메모 내용";
        note_field: "note on this run", "이 시험의 메모";
        note_save: "Save note", "메모 저장";
        note_hint: "State the operator's name, then write what is to be said; it stands on the test sheet",
            "시험자 이름을 먼저 적으십시오. 저장한 내용은 시험 성적서에 실립니다";
        note_saved: "Note saved", "메모를 저장했습니다";
        note_not_saved: "The note was not saved", "메모를 저장하지 못했습니다";
        from_scripts: "the scripts directory", "스크립트 폴더";
        from_campaign: "a campaign on this machine", "이 컴퓨터에서 수행한 캠페인";
        choose_run: "Choose a run in the list.", "목록에서 시험을 고르십시오.";
        not_read: "The run cannot be read", "시험 기록을 읽을 수 없습니다";
        language: "language of the sheet", "성적서 언어";
        file: "file", "파일";
        write_html: "HTML", "HTML";
        write_pdf: "PDF", "PDF";
        write_csv: "CSV", "CSV";
        write_hint: "Written to the file named beside it, with its own ending; never over one that is there, but beside it as -2, -3 …", "옆에 적은 파일에 해당 확장자로 저장합니다. 같은 파일이 있으면 덮어쓰지 않고 -2, -3 …을 붙입니다";
        writing: "writing …", "저장하는 중 …";
        written: "Written: {file}", "저장 완료: {file}";
        not_written: "The report was not written", "성적서를 저장하지 못했습니다";
        open_file: "Open, print", "열기, 인쇄";
        not_opened: "The file cannot be opened", "파일을 열 수 없습니다";
        name_file: "name a file", "파일 이름을 적으십시오";
        to_diagnosis: "Diagnosis", "진단";
        all_right: "nothing failed in it", "미합격 항목 없음";
        strip: "Compare, note, files", "비교, 메모, 파일";
        to_trace: "Trace", "신호 기록";
        to_traces: "Traces ({n})", "신호 기록 ({n})";
        case_sheet: "Repair sheet", "수리 성적서";
        document: "Document {number}", "문서 번호 {number}";
        simulated: "Simulated", "모의 시험";
        with_injected: "faults injected: {faults}", "주입한 고장: {faults}";
        simulated_unit: "simulated unit", "모의 장치";
        depot: "depot", "차량기지";
        symptom: "Symptom", "증상";
        found_by: "Found by", "검출 단계";
        repair_made: "Repaired", "수리";
        run_before: "Run before the repair", "수리 전 시험";
        run_after: "Run after the repair", "수리 후 시험";
        before: "before", "수리 전";
        after: "after", "수리 후";
        before_then_after: "{before} (before), {after} (after)", "{before} (수리 전), {after} (수리 후)";
        before_and_after: "Before and after the repair", "수리 전후 비교";
        allowed: "Allowed", "허용";
        at_most: "at most {high} {unit}", "{high} {unit} 이하";
        at_least: "at least {low} {unit}", "{low} {unit} 이상";
        from_to: "{low} to {high} {unit}", "{low} ~ {high} {unit}";
        not_tested_again: "not tested", "미시험";
        no_step_saw_it: "No step of a run saw the fault.", "시험 단계에서 나타난 고장이 아닙니다.";
        more_compared: "On the next page: {n} more.", "그 밖의 {n}건은 다음 쪽에 있습니다.";
        more_steps: "Further failed steps in run {run}: {n}.", "그 밖의 미합격 단계 {n}건은 시험 {run}에 있습니다.";
        more_faults: "Further faults in the database: {n}.", "그 밖의 고장 {n}건은 데이터베이스에 있습니다.";
        close_up: "{when}: {what} (trace {id})", "{when}: {what} (신호 기록 {id})";
        comparison: "Two runs compared", "시험 비교";
        of_two_runs: "Run A {a}, run B {b}", "시험 A {a}, 시험 B {b}";
        run_a: "Run A", "시험 A";
        run_b: "Run B", "시험 B";
        change: "change", "변화";
        compared_said: "Steps that pass in B and did not in A: {now}. That passed in A and do not in B: {before}. That pass in neither: {neither}. Skipped steps are not counted.", "A 미합격, B 합격: {now}건. A 합격, B 미합격: {before}건. 두 시험 모두 미합격: {neither}건. 생략한 단계는 제외.";
        only_in_a: "Steps of A alone: {n}.", "A에만 있는 단계: {n}건.";
        only_in_b: "Steps of B alone: {n}.", "B에만 있는 단계: {n}건.";
        passed_in_both: "Further steps, passed in both runs: {n}.", "그 밖에 두 시험 모두 합격한 단계: {n}건.";
        other_units: "The runs are of different units: {a} and {b}.", "서로 다른 장치의 시험입니다: {a}, {b}.";
        other_configs: "The units had different configurations: {a} and {b}.", "장치 구성이 서로 다릅니다: {a}, {b}.";
        changed_config: "The unit configuration was changed between the runs.", "두 시험 사이에 장치 구성이 바뀌었습니다.";
        other_lines: "The runs were made for different lines: {a} and {b}.", "서로 다른 노선의 시험입니다: {a}, {b}.";
        other_scripts: "Scripts that are not the same in both runs: {names}.", "두 시험에서 서로 다른 스크립트: {names}.";
        other_directory: "The scripts directory was not the same; the scripts that both runs used are.", "스크립트 폴더가 서로 다르나, 두 시험에 모두 쓰인 스크립트는 같습니다.";
        run_unfinished: "Run {run} has no verdict: it is under way or was broken off.", "시험 {run}은(는) 판정이 없습니다. 진행 중이거나 도중에 끊겼습니다.";
        other_order: "Run A was made after run B.", "시험 A는 시험 B보다 나중에 한 시험입니다.";
        compare_with: "compare with", "비교할 시험";
        no_comparison: "no other run", "비교 안 함";
        all_steps: "also what passed in both", "모두 합격한 단계 포함";
        proved: "Repair proved", "수리 입증";
        passed_since: "run {run} passed, {at}; runs passed since the repair: {n}", "시험 {run} 합격, {at}; 수리 후 합격 {n}회";
        vouched: "Repair verified by a person", "담당자 검증";
        vouched_by: "{who}, {at}; no run proves it", "{who}, {at}; 시험으로 입증되지 않음";
        claimed: "Repair not proved", "수리 미입증";
        no_run_since: "no run passed since", "수리 후 합격한 시험 없음";
        came_back: "Fault came back", "고장 재발";
        seen_again: "seen after the repair, {at}", "수리 후 재발생, {at}";
        not_repaired: "Not repaired", "미수리";
        faults_of_case: "Faults of the case", "같은 건의 고장";
        settled: "Repairs this run proves", "이 시험으로 입증된 수리";
        what: "What", "내용";
        by_whom: "By", "담당자";
        event_repair: "repair", "수리";
        event_passed: "run passed", "시험 합격";
        event_proved: "proved by run", "시험으로 입증";
        annex: "Annex: run {when} the repair, {run}", "부록: {when} 시험, {run}";
        page: "page {n} of {of}", "{of}쪽 중 {n}쪽";
        codes: "[U+…]: a character that the font of this sheet does not have, by its Unicode number", "[U+…]: 이 문서의 글꼴에 없는 글자를 유니코드 번호로 적음";
    }
}

impl Report {
    /// The severity of a stored fault; a word of another program stays as it is.
    pub fn severity<'a>(&self, severity: &'a str) -> &'a str {
        match Severity::of_fault(severity) {
            Some(Severity::Minor) => self.minor,
            Some(Severity::Major) => self.major,
            Some(Severity::Critical) => self.critical,
            Some(Severity::Info) | None => severity,
        }
    }

    /// Where a fault dictionary is from.
    pub fn origin(&self, origin: Origin) -> &'static str {
        match origin {
            Origin::Scripts => self.from_scripts,
            Origin::Campaign => self.from_campaign,
        }
    }
}
