//! Warnings with the answer of a diagnosis.

use super::sentences;

sentences! {
    /// Differences between a dictionary's basis and the present one.
    Differs {
        Configuration: "made of another unit configuration, line, train, scatter or fault catalogue", "장치 구성, 노선, 열차, 산포 또는 고장 목록이 다름";
        Gone(scripts: usize): "made with {scripts} scripts that are gone", "스크립트 {scripts}개가 없어짐";
        Changed(names: String): "made before {names} changed", "변경된 스크립트: {names}";
        ManyChanged(names: String, more: usize): "made before {names} and {more} more scripts changed", "변경된 스크립트: {names} 외 {more}개";
    }

    /// Notes on what a bench of instruments does to a step.
    BenchNote {
        NoPlace(bench: String, what: String): "bench {bench} has no {what}", "시험대 {bench}에 {what} 없음";
        Beyond(bench: String, instrument: String, why: btu_rig::rig::InstrumentFault): "bench {bench}: {instrument} cannot: {why}", "시험대 {bench}: 계측기 {instrument} 불가 ({why})";
        Unread(bench: String, what: String): "bench {bench} does not read {what}", "시험대 {bench}에서 읽을 수 없음: {what}";
        TooSlow(bench: String, what: String): "bench {bench}: a person reads {what}, too slowly for this step", "시험대 {bench}: 사람이 읽기에는 너무 빠름: {what}";
        Do(what: String): "Please do by hand: {what}. Done?", "손으로 조작하십시오: {what}. 완료했습니까?";
        See(what: String): "Please look: {what}. Is it so?", "확인하십시오: {what}. 맞습니까?";
        Wider(bench: String, used: String, by: String): "bench {bench}: {used} (limits wider by {by})", "시험대 {bench}: {used} (한계 확대 {by})";
        Looks(bench: String, within_s: u64): "bench {bench}: a person (limits wider by {within_s} s)", "시험대 {bench}: 사람 (한계 확대 {within_s} s)";
        ByHand(instrument: String, what: String): "{instrument} has no watchdog: if this program is killed, {what}", "{instrument}에 워치독 없음. 이 프로그램이 강제로 종료되면: {what}";
    }

    /// Reasons for which an answer is worth less than others.
    Warning {
        OtherConnection(how: &'static str): "the fault dictionary was made on another connection" [": make one with `ptu campaign{how}`" ": make one"], "고장 사전이 다른 연결 방식으로 만들어짐" [". `ptu campaign{how}`(으)로 다시 만드십시오" ". 사전을 다시 만드십시오"];
        Stale(differs: Differs, how: &'static str): "the fault dictionary is stale, {differs}" [": make a new one with `ptu campaign{how}`" ": make a new one"], "고장 사전이 현재와 맞지 않음 ({differs})" [". `ptu campaign{how}`(으)로 다시 만드십시오" ". 사전을 다시 만드십시오"];
        KnowsPart(modes: usize, of: usize): "the fault dictionary knows {modes} of {of} fault modes only", "고장 사전은 고장 모드 {of}개 중 {modes}개만 알고 있음";
        NothingToDiagnose: "the run has no step and no fault that could be diagnosed", "진단할 수 있는 단계와 고장이 이 시험에 없음";
        NoRelations(why: String): "parts that are hard to tell apart are not known: {why}", "구별하기 어려운 부품의 정보를 읽지 못함: {why}";
        OtherConfiguration(name: String): "the run's unit configuration, {name}, is not the one the dictionary was made with", "시험한 장치 구성 {name}이(가) 고장 사전의 구성과 다름";
        OtherLine(line: String, of_dictionary: String): "the run is on {line}, the dictionary was made on {of_dictionary}", "시험은 {line} 노선, 고장 사전은 {of_dictionary} 노선";
        OtherTrain(train: String, of_dictionary: String): "the run's train is {train}, the dictionary was made on {of_dictionary}", "시험은 {train} 차량, 고장 사전은 {of_dictionary} 차량";
        OtherScripts(scripts: String): "scripts of the run differ from those the dictionary was made with; their steps are left out: {scripts}", "시험 스크립트가 고장 사전과 달라 다음 절차의 단계는 제외됨: {scripts}";
        Departure: "a departure test is in no fault dictionary" ["; `ptu run --adaptive` on this unit finds the part" "; a search on this unit finds the part"], "출고 점검은 고장 사전에 없음" [". 부품 찾기: 이 장치에서 `ptu run --adaptive`" ". 이 장치에서 적응 시험을 하면 부품을 찾을 수 있음"];
        UnknownSteps(steps: usize): "{steps} steps are not in the dictionary and say nothing", "고장 사전에 없는 단계 {steps}개는 판단에 쓰지 않음";
    }
}
