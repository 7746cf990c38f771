//! Automatic runs of a whole train.

use super::wordings;

wordings! {
    /// Automatic runs of a whole train.
    Drive {
        title: "Drive", "자동 주행";
        explained: "A simulated unit drives a whole train from station to station in virtual time. A connected unit takes no part in it, and nothing is recorded.", "내장된 모의 장치가 가상 시간으로 열차를 역에서 역까지 운전합니다. 연결된 장치는 관여하지 않으며, 기록도 남지 않습니다.";
        nothing: "Nothing has been driven yet", "아직 주행한 결과가 없습니다";
        under_way: "a run is under way", "주행 중입니다";

        // What is asked for.
        line: "line", "노선";
        section: "section", "구간";
        all_sections: "all", "전체";
        controller: "speed controller", "속도 제어기";
        configured: "as configured", "장치 구성대로";
        side_by_side: "all side by side", "전체 비교";
        train: "train", "열차";
        load: "passengers", "승객";
        empty: "empty", "공차";
        full: "full", "만차";
        disturbance: "disturbance", "외란";
        no_disturbance: "none", "없음";
        s1: "S1, 20 kN·s/m at 1 Hz", "S1, 20 kN·s/m, 1 Hz";
        drive: "Start the run", "주행 시작";
        cannot_list: "Lines and trains cannot be listed", "노선과 열차 목록을 읽을 수 없습니다";

        // Progress and result.
        driving: "driven: {done} of {of}", "주행: {of}건 중 {done}건";
        stopped: "Stopped: {done} of {of} were driven.", "정지함: {of}건 중 {done}건을 주행했습니다.";
        cannot_drive: "It cannot be driven", "주행할 수 없습니다";
        report: "Report of automatic runs", "자동 주행 보고서";
        many: "Monte Carlo of automatic runs", "자동 주행 몬테카를로 보고서";
        section_of: "{line}, section {section}", "{line} 노선 {section} 구간";
        before_within: "{error} before the stop point, within ±{tolerance} cm", "정위치 {error} 미달, 허용 ±{tolerance} cm 이내";
        before_outside: "{error} before the stop point, outside ±{tolerance} cm", "정위치 {error} 미달, 허용 ±{tolerance} cm 초과";
        past_within: "{error} past the stop point, within ±{tolerance} cm", "정위치 {error} 초과, 허용 ±{tolerance} cm 이내";
        past_outside: "{error} past the stop point, outside ±{tolerance} cm", "정위치 {error} 초과, 허용 ±{tolerance} cm 초과";
        did_not_stop: "no stop", "정차하지 않음";
        figures: "Figures", "측정값";
        plots: "Plots", "그래프";
        shaded: "{plot} (shaded: a car slips or slides)", "{plot} (음영: 차륜 공전 또는 활주)";
        on_the_way: "On the way", "주행 중 이벤트";
    }
}
