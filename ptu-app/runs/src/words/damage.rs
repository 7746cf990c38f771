//! Where a check of the history found damage, and which, in both languages.

use fault_db::{Damage, Derived, Samples, SchemaObject, SealPlace, SignatureError, WrongSignature};

use super::store::in_window;
use super::{Say, TextStyle, noun};
use crate::clock;

impl Say for Damage {
    fn say(&self, how: TextStyle) -> String {
        how.choose([self.to_string(), korean(self)])
    }
}

#[rustfmt::skip]
pub(super) fn korean(damage: &Damage) -> String {
    use Damage as D;
    match damage {
        D::Told(words) => words.clone(),
        D::More(n) => format!("같은 종류 {n}건 더 있음"),
        D::Rest(why) => format!("나머지는 검사하지 못함: {}", in_window(why)[1]),
        D::Unread(why) => in_window(why)[1].clone(),
        D::NoParent(Some(row), table, parent) => format!("{table} 테이블의 행 {row}이(가) {parent} 테이블의 없는 행을 가리킴"),
        D::NoParent(None, table, parent) => format!("{table} 테이블의 행이 {parent} 테이블의 없는 행을 가리킴"),
        D::Foreign(object) => format!("이 프로그램의 것이 아님: {}", named(object)),
        D::Remade(object) => format!("이 프로그램이 만든 것과 다름: {}", named(object)),
        D::NoObject(object) => format!("없음: {}", named(object)),
        D::NoName => "파일 고유 번호가 제거됨".to_owned(),
        D::NoSeals(seal, missing) => format!("{}: 앞의 봉인이 제거됨 (번호 {})", at(seal), missing.replace(" to ", "~")),
        D::Unchained(seal, what, id) => format!("{} ({} {id}): 앞의 봉인과 맞지 않음 (변경됨)", at(seal), noun(what)),
        D::Unsealed(seal, what) => format!("{}: 해당 {}이(가) 제거됨", at(seal), noun(what)),
        D::SealChanged(seal) => format!("{}: 변경됨", at(seal)),
        D::Changed(what, id) => format!("{} {id}: 봉인 후 변경됨", noun(what)),
        D::Signature(seal, wrong) => format!("{}의 서명: {}", at(seal), signature(wrong)),
        D::Recounted(at_us, differed) => format!("{}에 다시 집계함: 이전에 {}가지가 달랐음", clock::local(*at_us), differed.len()),
        D::TraceChanged(id) => format!("신호 기록 {id}: 시험 봉인 후 변경됨"),
        D::TraceAdded(id, run) => format!("신호 기록 {id}: 시험 {run} 봉인 후 추가됨"),
        D::RecordingChanged(n, run) => format!("시험 {run}의 기록 {n}: 봉인 후 변경됨"),
        D::RecordingAdded(n, run) => format!("기록 {n}: 시험 {run} 봉인 후 추가됨"),
        D::NoSamples(what) => format!("{}: 제거됨 (정리되었다는 봉인 없음)", samples(what)),
        D::SamplesLeft(what) => format!("{}: 없음 (다른 파일에서 가져올 때 받지 않았거나 제거되었고, 정리되었다는 봉인 없음). 그 파일의 전체 사본을 가져오면 복구됩니다", samples(what)),
        D::NoBeginning => "이 파일의 봉인 사슬의 시작이 없음: 제거됨".to_owned(),
        D::Rewritten(file, n, seen) => format!("파일 {}의 봉인 사슬: 다시 만들어짐 ({n}번 항목이 {} 확인한 것과 다름)", file.short(), when(*seen)),
        D::Cut(file, n, seen) => format!("파일 {}의 봉인 사슬: 잘림 ({} 확인한 {n}번 항목이 없음)", file.short(), when(*seen)),
        D::NoSeal(what, id) => format!("{} 중 {id}에 봉인이 없음: 임의로 추가되었거나 봉인이 제거됨", noun(what)),
        D::NoSealOfRun(id) => format!("시험 {id}: 끝났으나 봉인이 없음 (봉인이 제거되었거나 임의로 추가됨)"),
        D::NoVerdict(id) => format!("시험 {id}: 봉인은 있으나 판정이 제거됨"),
        D::NoRuns(n) => format!("여기서 기록한 시험 {n}건이 없음"),
        D::Miscounted(n, Derived::Repairs) => format!("수리 표의 행 {n}개가 이력과 다름"),
        D::Miscounted(n, Derived::Days) => format!("일별 측정값 합계 {n}개가 이력과 다름"),
        D::Miscounted(n, Derived::Months) => format!("월별 측정값 합계 {n}개가 이력과 다름"),
        D::Miscounted(n, Derived::Packed) => format!("압축된 고장 묶음 {n}개가 이력과 다름"),
        D::Miscounted(n, Derived::FaultNotes) => format!("고장 메모 {n}건이 검색 목록과 다름"),
        D::Miscounted(n, Derived::RunNotes) => format!("시험 메모 {n}건이 검색 목록과 다름"),
        D::FaultNamed(id) => format!("고장 {id}: 이름이나 심각도가 어떤 발생과도 다름"),
        D::OtherFault(id) => format!("발생 {id}: 장치, 코드 또는 부품이 그 고장과 다름"),
        D::OtherRun(id) => format!("발생 {id}: 장치 또는 노선이 그 시험과 다름"),
        D::UnitNamed(unit) => format!("장치 {unit}: 어떤 시험의 결과와도 다름"),
        D::FaultDerived(id) => format!("고장 {id}: 상태, 시각, 노선 또는 횟수가 발생 및 이벤트와 다름"),
        D::NoGuard(trigger, table) => format!("테이블 {table}의 보호 트리거 {trigger}이(가) 꺼졌거나 없음: 행이 변경될 수 있음"),
    }
}

fn signature(wrong: &WrongSignature) -> String {
    use WrongSignature as W;
    match wrong {
        W::Document(SignatureError::Unreadable(why)) => format!("서명 문서가 아님: {why}"),
        W::Document(SignatureError::Form) => "서명할 때의 형식과 다름 (변경됨)".to_owned(),
        W::Document(SignatureError::Wrong) => "서명이 내용과 맞지 않음 (변경됨)".to_owned(),
        W::Document(SignatureError::NoKey) => "개인 키가 아님".to_owned(),
        W::NoStatement => "봉인에 대한 서명이 아님".to_owned(),
        W::NoSeal => "지정한 봉인이 없음".to_owned(),
        W::Other(what, id) => format!("다른 대상의 서명임: {} {id}에 대한 서명", noun(what)),
        W::NotThere(what) => format!("그 자리에는 {}에 대한 서명을 둘 수 없음", noun(what)),
        W::SealGone(what, id) => format!("{} {id}의 봉인: 제거됨", noun(what)),
        W::OtherSeal(what, id, seal) => format!(
            "{} {id}의 봉인 (파일 {}의 {}번 항목): 서명한 것과 다름",
            noun(what),
            seal.file.short(),
            seal.entry
        ),
    }
}

fn at(seal: &SealPlace) -> String {
    format!("파일 {}의 봉인 {}", seal.file.short(), seal.entry)
}

fn samples(what: &Samples) -> String {
    match what {
        Samples::Trace(id) => format!("신호 기록 {id}"),
        Samples::Recording(n, run) => format!("시험 {run}의 기록 {n}"),
    }
}

fn named(object: &SchemaObject) -> String {
    let on = object.on.iter().map(|on| format!(" (테이블 {on})"));
    let on: String = on.collect();
    format!("{} \"{}\"{on}", noun(&object.kind), object.name)
}

fn when(seen_at_us: i64) -> String {
    match seen_at_us {
        0 => "여기에서".to_owned(),
        at_us => format!("{}에", clock::local(at_us)),
    }
}
