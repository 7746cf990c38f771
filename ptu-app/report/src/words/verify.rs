//! Texts of a verification on signatures and changes.

use super::{Words, wordings};

wordings! {
    /// What a verification says of signatures and changes.
    Verify {
        about: "unit {unit}: {verdict}, {steps} steps run, {n} measured values, by {who}, on {source}, begun {at}{injected}", "장치 {unit}: {verdict}, {steps}개 단계 수행, 측정값 {n}개, 시험자 {who}, 연결 {source}, 시작 {at}{injected}";
        injected: ", with injected faults {faults}", ", 주입한 고장 {faults}";
        nobody: "a person not named", "기재 없음";
        event: "event", "고장 조치";
        sheet: "sheet", "성적서";
        database: "database", "이력 파일";
        certificate: "certificate", "증명서";
        instrument: "instrument", "계측기";
        name: "{who} ({kind}, key {key})", "{who} ({kind}, 키 {key})";
        signed: "{what} {id}: signed by {name} at {at}; the key {standing}{about}", "{what} {id}: {name}이(가) {at}에 서명. 키: {standing}{about}";
        key_doubted: "{what} {id}: the key of {name} {standing}", "{what} {id}: {name}의 키: {standing}";
        signed_many: "{name} signed {runs} runs and {others} notes, events and instruments, from {from} to {until}; the key {standing}", "{name}이(가) {from}부터 {until}까지 시험 {runs}건, 메모·조치·계측기 {others}건에 서명. 키: {standing}";
        key_of_doubted: "the key of {name} {standing}", "{name}의 키: {standing}";
        no_run_signed: "no run in it is signed", "서명된 시험이 없음";
        some_unsigned: "{n} of {of} runs are not signed", "시험 {of}건 중 {n}건 서명 없음";
        dated_ahead: "a signature of {name} is dated in the future: {at}", "{name}의 서명 시각이 미래임: {at}";
        valid_until: "departure test of unit {unit}, valid until {at}", "장치 {unit}의 출고 점검, {at}까지 유효";
        not_departure: "not valid as a departure test: {why}", "출고 점검으로 유효하지 않음: {why}";
        was_valid_until: "too old, it was valid until {at}", "유효 기한 지남 ({at}까지)";
        other_unit: "it is of unit {unit}, not of {asked}", "{asked}이(가) 아니라 장치 {unit}의 점검임";
        no_departure: "it is no departure test of unit {asked}", "장치 {asked}의 출고 점검이 아님";
        no_history: "later departure tests were not looked for: the database here does not open", "이력을 열 수 없어 이후 출고 점검은 확인하지 않음";
        later_failed: "the later departure test of {at}, run {run}, failed", "{at}의 이후 출고 점검 불합격 (시험 {run})";
        with_others: "other procedures were run with it", "다른 절차를 함께 시험함";
        step_failed: "\"{step}\" failed", "단계 \"{step}\" 불합격";
        step_skipped: "\"{step}\" was skipped", "단계 \"{step}\" 건너뜀";
        step_not_tested: "\"{step}\" was not tested", "단계 \"{step}\" 시험하지 못함";
        steps_not_run: "{n} of its {of} steps were not run", "단계 {of}개 중 {n}개 미실행";
        is_part: "only a part of it was run", "일부만 시험함";
        with_faults: "with injected faults {faults}", "고장 주입: {faults}";
        of_simulated: "of a simulated unit", "모의 장치의 시험임";
        no_pass: "it did not come to a pass", "합격에 이르지 못함";
        departure_unsigned: "nobody signed it", "서명 없음";
        departure_unverified: "what it says is not verified", "내용이 검증되지 않음";
        of_sheet: "the run in the database is the one of the sheet", "이력의 시험이 성적서의 시험과 같음";
        not_of_sheet: "the run in the database is not the one of the sheet", "이력의 시험이 성적서의 시험과 다름";
        wrong_certificate: "the certificate: {why}", "증명서: {why}";
        run_not_here: "the database here does not have this run", "이 이력에는 없는 시험";
        not_signed_content: "the run in the database is not what was signed", "이력의 시험이 서명된 내용과 다름";
        signed_content: "the run in the database is what was signed", "이력의 시험이 서명된 내용과 같음";
        not_ended: "the run has not ended: nothing is sealed", "시험이 끝나지 않아 봉인되지 않음";
        run_unsigned: "the run is not signed; what its seal says stands below", "시험에 서명 없음. 봉인 내용은 아래와 같음";
        seal: "seal {seal}, entry {entry} of database {file}{found}", "봉인 {seal}, 이력 파일 {file}의 {entry}번 항목{found}";
        as_found: ", as it was found when it came in", ", 외부에서 들어온 시점의 기록";
        pruned: "{what} was pruned", "정리되어 없음: {what}";
        note_unsigned: "note {id} in the name of \"{who}\" is not signed", "\"{who}\" 이름의 메모 {id}에 서명 없음";
        changed: "CHANGED, {n} findings:", "변경됨, {n}건:";
        unchanged_sealed: "unchanged: the {what} is as it was sealed", "변경 없음: {what}이(가) 봉인된 내용과 같음";
        unchanged_signed: "unchanged: the {what} is as it was signed", "변경 없음: {what}이(가) 서명된 내용과 같음";
        not_verified: "NOT VERIFIED:", "검증되지 않음:";
        no_statement: "it is no statement about a run", "시험에 관한 진술이 아님";
        in_certificate: "a signature in its certificate: {why}", "증명서의 서명: {why}";
        foreign: "a {what} is signed in its certificate that is not of the run", "증명서에 이 시험의 것이 아닌 {what} 서명이 있음";
        text_unsigned: "the text of the sheet is not signed: hold it against the database, or write it again with --key", "성적서 본문에 서명 없음: 이력과 대조하거나 --key로 다시 작성하십시오";
        wrong_sheet: "the signature of the sheet: {why}", "성적서의 서명: {why}";
        only_sheet: "the run is not signed, only the sheet is", "성적서에만 서명이 있고 시험에는 없음";
        two_runs: "the sheet and the certificate in it are of two runs", "성적서와 그 안의 증명서가 서로 다른 시험의 것임";
    }
}

impl Words {
    /// Name of a signed or verified thing, by its name in statements.
    pub fn signed_thing<'a>(&self, what: &'a str) -> &'a str {
        match what {
            "run" => self.common.run,
            "note" => self.common.note,
            "event" => self.verify.event,
            "sheet" => self.verify.sheet,
            "database" => self.verify.database,
            "certificate" => self.verify.certificate,
            "instrument" => self.verify.instrument,
            other => other,
        }
    }
}
