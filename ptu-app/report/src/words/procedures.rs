//! Choosing and running procedures.

use super::wordings;

wordings! {
    /// Choosing and running procedures.
    Procedures {
        title: "Procedures", "시험 절차";
        live_signals: "Live signals", "실시간 신호";
        live_signals_hint: "the signals of the page Bench, drawn below the run as they come", "시험대 화면의 신호를 시험 아래에 실시간으로 표시";
        find: "find", "찾기";
        reload: "Reload scripts", "스크립트 다시 읽기";
        choice: "All, none, reload", "전체, 해제, 다시 읽기";
        all: "All", "전체";
        none: "None", "해제";
        chosen: "{steps} steps chosen, at most {time}", "{steps}개 단계 선택, 최대 {time}";
        on_request: "on request", "요청 시만";
        needs_harness: "Needs the bench harness; only the maintenance port is connected", "시험대 하네스가 필요합니다. 정비 포트만 연결되어 있습니다";
        run: "Run", "시험 시작";
        run_all: "Run on all units", "모든 장치에서 시작";
        find_part: "Find the part", "고장 부품 찾기";
        find_part_hint: "As few of the chosen procedures' steps as it takes to find the part to replace", "교체할 부품을 찾는 데 필요한 만큼만 선택한 절차의 단계를 실행합니다";
        pause: "Pause", "일시 정지";
        resume: "Go on", "계속";
        single_step: "One step", "한 단계";
        stop: "Stop", "정지";
        stop_again: "Cut clean-up short", "정리 단축";
        repeat: "times", "반복";
        stop_on_fail: "stop at the first failure", "첫 불합격에서 정지";
        connect_first: "Connect a unit first", "먼저 장치를 연결하십시오";
        about_to_begin: "A run is about to begin", "시험이 곧 시작됩니다";
        script_errors: "The scripts have errors; nothing can be run until they are corrected", "스크립트에 오류가 있습니다. 고칠 때까지 실행할 수 없습니다";
        scripts_changed: "Scripts changed since they were shown: look again, then run", "표시된 뒤 스크립트가 바뀌었습니다. 다시 확인한 후 시작하십시오";
        not_loaded: "The scripts cannot be read", "스크립트를 읽을 수 없습니다";
        not_begun: "The run was not begun", "시험을 시작하지 못했습니다";
        other_unit: "The diagnosed run is of unit {unit}: connect that one first", "진단한 시험은 장치 {unit}의 것입니다: 먼저 그 장치를 연결하십시오";
        of_unit: "unit {unit}", "장치 {unit}";
        no_such_step: "There is no such step in these scripts", "이 스크립트에는 그런 단계가 없습니다";
        progress: "{done} of {all} steps, {bad} not passed", "{all}개 중 {done}개 단계, 미합격 {bad}";
        elapsed: "{time} elapsed", "경과 {time}";
        left: "at most {time} of bench time left", "시험대 시간 최대 {time} 남음";
        bringing_up: "bringing the unit up", "장치 준비 중";
        waiting: "waiting for {what}: {left} s left", "대기 중: {what}, {left}초 남음";
        paused: "Paused before: {step}", "일시 정지, 다음 단계: {step}";
        asked: "The script asks", "확인 요청";
        yes: "Yes", "예";
        no: "No", "아니요";
        all_passed: "No step failed; passed: {n}", "불합격 단계 없음, 합격 {n}";
        no_measurements: "This step measures nothing", "이 단계에는 측정이 없습니다";
        results: "results", "결과";
        bad_n: "Not passed {n}", "미합격 {n}";
        all_n: "All {n}", "전체 {n}";
        measured: "measured", "측정값";
        limit: "limit", "허용";
        faults_found: "faults found", "발견된 고장";
        suspect: "suspect: {part}", "의심 부품: {part}";
        to_diagnosis: "Diagnosis", "진단";
        to_report: "Report", "성적서";
        of_ato: "Automatic operation", "자동운전";
        of_atp: "Train protection", "열차 방호";
        of_cab: "Cab", "운전실";
        of_door: "Doors", "출입문";
        of_ptu: "Portable unit", "이동식 시험기";
        of_tcms: "TCMS", "TCMS";
        of_twc: "TWC", "TWC";
        choose_and_run: "Choose in the list what to run. Without a choice of your own everything runs but what is on request.", "목록에서 실행할 절차를 고르십시오. 따로 고르지 않으면 요청 시만 하는 것을 빼고 모두 실행합니다.";
    }
}

impl Procedures {
    /// Purpose of a folder's procedures; an own folder keeps its name.
    pub fn folder<'a>(&self, name: &'a str) -> &'a str {
        match name {
            "ato" => self.of_ato,
            "atp" => self.of_atp,
            "cab" => self.of_cab,
            "door" => self.of_door,
            "ptu" => self.of_ptu,
            "tcms" => self.of_tcms,
            "twc" => self.of_twc,
            own => own,
        }
    }
}
