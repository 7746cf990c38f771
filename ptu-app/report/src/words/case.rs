//! One case: from the symptom to the signed sheet.

use super::wordings;

wordings! {
    /// One case: from the symptom to the signed sheet.
    Case {
        title: "Case", "정비 작업";
        stage_start: "Connect", "연결";
        stage_unit: "Symptom", "증상";
        stage_run: "Test", "시험";
        stage_result: "Result", "결과";
        stage_repair: "Repair", "수리";
        stage_prove: "Proof", "확인 시험";
        stage_sheet: "Sheet", "성적서";
        new_case: "New case", "새 작업";
        your_name: "Your name", "시험자 이름";
        name_first: "Write your name first", "먼저 이름을 적으십시오";
        reached_at: "The unit is reached at {place}; another place is chosen above, at Setup.", "장치 연결 위치: {place}. 다른 위치는 위의 설정에서 고르십시오.";
        seen_last: "Units seen last", "최근 시험한 장치";
        first_start: "Nothing is recorded yet. A demonstration shows the way of a case on the simulated unit, which has a fault: its brakes come late.", "아직 기록이 없습니다. 고장이 하나 있는 모의 장치로 작업 순서를 시연할 수 있습니다. 증상: 제동이 늦음.";
        demonstrate: "Start the demonstration", "시연 시작";
        open_faults: "Open faults of this unit", "이 장치의 미해결 고장";
        repairs: "Earlier repairs", "이전 수리";
        nothing_known: "Nothing is recorded about this unit.", "이 장치에 대한 기록이 없습니다.";
        what_is_wrong: "What is wrong with it?", "증상이 무엇입니까?";
        unknown: "not known", "모름";
        find_part: "Find the part", "고장 부품 찾기";
        preparing: "The run is being prepared", "시험을 준비하는 중";
        not_begun: "No run is under way.", "진행 중인 시험이 없습니다.";
        back: "Back", "뒤로";
        is_failed: "Failed", "불합격";
        is_unsure: "Not certain yet", "아직 불확실";
        is_not_found: "Nothing found", "고장 미발견";
        is_not_tested: "Could not be tested", "판정 불가";
        is_stopped: "Stopped", "중단";
        is_passed: "Passed", "합격";
        replace: "Replace {part}", "교체 대상: {part}";
        probably: "Probably {part}", "추정: {part}";
        no_part_explains: "No single part explains it", "한 부품으로 설명되지 않음";
        not_everything: "Not everything was run", "일부만 시험함";
        stopped_at: "Stopped at step {n} of {all}", "{all}단계 중 {n}단계에서 중단";
        no_fault: "No fault found", "고장이 발견되지 않음";
        of_run: "Run {id}, ended {time}", "시험 {id}, 종료 {time}";
        run_next: "Run the next check, {time}", "다음 점검 시험, {time}";
        show_failed: "Show what failed", "불합격 항목 보기";
        run_whole: "Run the whole suite", "전체 시험";
        run_again: "Run again", "다시 시험";
        because: "Because", "근거";
        next_check: "Next check: {check}", "다음 점검: {check}";
        way: "The way of the signal, from the sensor to what the check judges", "센서에서 판정 신호까지의 신호 경로";
        suspected: "suspected", "고장 추정";
        fails_with_it: "fails with it", "함께 불합격";
        needed_by_all: "needed by all", "모두에 필요";
        beside_twin: "In colour this unit, in grey a good one with the same inputs", "색: 이 장치, 회색: 같은 입력을 준 정상 장치";
        no_twin: "The trace of the failed check; a good unit could not be run with the same inputs", "불합격한 점검의 신호 기록. 같은 입력으로 정상 장치를 시험하지 못함";
        record_repair: "Record repair", "수리 기록";
        to_sheet: "Sheet", "성적서";
        part: "Part", "부품";
        serial_old: "Serial number taken out", "떼어 낸 부품의 일련번호";
        serial_new: "Serial number put in", "새 부품의 일련번호";
        note: "Note", "비고";
        save: "Save", "저장";
        serial_or_note: "Write the new serial number, or in the note what was done instead", "새 일련번호를 적거나, 다른 조치를 했으면 비고에 적으십시오";
        recorded: "Repair of {part} recorded", "{part} 수리를 기록함";
        not_recorded: "The repair was not recorded", "수리를 기록하지 못했습니다";
        fitted: "Fitted: connect again", "조립 완료: 다시 연결";
        fitted_hint: "Switch the unit off before the part is changed. In practice the injected faults of the part go with it.", "부품을 바꾸기 전에 장치 전원을 끄십시오. 연습에서는 그 부품에 주입한 고장도 함께 없어집니다.";
        prove: "Prove the repair", "수리 확인 시험";
        prove_hint: "Runs what failed, and what this part can break", "불합격한 절차와 이 부품이 영향을 주는 절차를 시험합니다";
        sign: "Checked", "확인";
        signed: "Checked", "확인함";
        signed_by: "Checked by {who}", "확인: {who}";
        not_signed: "That it was checked was not stored", "확인한 것을 저장하지 못했습니다";
        print: "PDF", "PDF";
    }
}
