//! Recorded traces.

use super::wordings;

wordings! {
    /// Recorded traces.
    Traces {
        title: "Traces", "신호 기록";

        // Values.
        on: "on", "켜짐";
        off: "off", "꺼짐";
        not_known: "not known", "알 수 없음";

        // The list.
        recorded: "recorded traces", "기록된 신호 기록";
        filter: "filter: unit, run, date, fault", "필터: 장치, 시험, 날짜, 고장";
        no_fault: "no fault", "고장 없음";
        none_recorded: "No trace is recorded yet. Traces are recorded when a check fails or a fault shows.", "아직 기록된 신호 기록이 없습니다. 점검이 불합격이거나 고장이 나타나면 기록됩니다.";
        none_fits: "no trace fits the filter", "필터에 맞는 신호 기록이 없음";
        only_newest: "only the newest {runs} runs are listed", "최근 시험 {runs}건만 표시됨";
        cannot_list: "The traces cannot be listed", "신호 기록 목록을 불러올 수 없습니다";
        cannot_open: "The trace cannot be opened", "신호 기록을 열 수 없습니다";
        choose_one: "Choose a trace in the list.", "목록에서 신호 기록을 선택하십시오.";
        of_unit: "unit {unit}, {when}", "장치 {unit}, {when}";
        cut_short: "cut short: the link dropped or the program was closed", "도중에 끊김: 링크가 끊어졌거나 프로그램이 종료됨";
        has_gaps: "some samples are missing", "일부 표본 없음";
        to_report: "Test sheet", "시험 성적서";
        to_diagnosis: "Diagnosis", "진단";

        // The axis.
        over_time: "time", "시간";
        over_distance: "distance", "거리";
        seconds: "s from the trigger", "s (트리거 기준)";
        metres: "m from the trigger", "m (트리거 기준)";
        no_distance: "no signal of this trace tells where the train was", "이 신호 기록에는 열차 위치를 알려 주는 신호가 없음";
        moved_back: "the train moved back by up to {metres} m ({seconds} s): those rows stand at the farthest point", "열차가 최대 {metres} m 후퇴함 ({seconds} s): 그 구간은 가장 멀리 간 지점에 표시됨";
        zoom_in: "Zoom in", "확대";
        zoom_out: "Zoom out", "축소";
        fit: "Fit", "전체 보기";
        zoom_back: "Zoom back", "이전 구간";
        zoom_back_hint: "What was in view before; a drag with the right button zooms to a stretch", "이전에 보던 구간. 오른쪽 단추로 끌면 그 구간이 확대됨";
        close_axes: "Scale to view", "세로축 맞춤";
        close_axes_hint: "axes of quantities as long as what is in view needs, or as the whole trace needs", "세로축을 보이는 구간에 맞추거나 전체 신호 기록에 맞춤";
        trigger: "trigger", "트리거";
        events: "events", "이벤트";
        note_field: "note at cursor A", "커서 A 위치의 메모";
        note_at: "trace {trace}, {time}: {text}", "신호 기록 {trace}, {time}: {text}";
        lanes: "lanes", "신호 칸";
        keys: "wheel or + and −: zoom; drag or arrows: pan; right drag: zoom to a stretch; Backspace: zoom back; F: all; click or A: cursor A; Shift+click or B: cursor B; , and .: move A by a row (with Shift: B); Esc: no cursors", "휠 또는 + −: 확대/축소, 끌기 또는 화살표: 이동, 오른쪽 단추로 끌기: 구간 확대, Backspace: 이전 구간, F: 전체, 클릭 또는 A: 커서 A, Shift+클릭 또는 B: 커서 B, , 와 .: 커서 A를 한 행씩 이동 (Shift와 함께 B), Esc: 커서 지우기";

        // Lanes.
        signals: "Signals", "신호";
        find_signal: "find a signal", "신호 찾기";
        shown_signals: "shown, from top to bottom", "표시 중 (위에서 아래로)";
        all_signals: "all signals", "전체 신호";
        usual_signals: "Automatic", "자동 선택";
        layouts: "layouts", "저장한 배치";
        save_layout: "Save this layout", "이 배치 저장";
        forget_layout: "Forget it", "저장한 배치 삭제";
        no_signals: "Choose signals to show.", "표시할 신호를 선택하십시오.";
        up: "up: {signal}", "위로: {signal}";
        down: "down: {signal}", "아래로: {signal}";
        higher: "taller: {signal}", "높게: {signal}";
        lower: "flatter: {signal}", "낮게: {signal}";
        hide: "hide: {signal}", "숨기기: {signal}";
        join: "in one lane with the signal above: {signal}", "위 신호와 한 칸에: {signal}";
        not_in_trace: "not in this trace", "이 신호 기록에 없음";

        // Cursors.
        cursor_a: "Cursor A", "커서 A";
        cursor_b: "Cursor B", "커서 B";
        clear_cursors: "Clear", "지우기";
        statistics: "Statistics", "통계";
        between_cursors: "between the cursors: {length}", "두 커서 사이: {length}";
        in_view: "in view: {length}", "보이는 구간: {length}";
        signal: "signal", "신호";
        least: "min", "최소";
        greatest: "max", "최대";
        mean: "mean", "평균";
        rms: "rms dev.", "RMS 편차";
        changes: "changes", "변화 횟수";
        shares: "share of time", "시간 비율";

        // Overlay.
        overlay: "Compare with", "비교 대상";
        overlay_choice: "what to compare with", "비교할 대상";
        no_overlay: "nothing", "없음";
        good_twin: "good twin", "정상 비교 장치";
        making_twin: "running the same stimuli on a sound unit …", "같은 시험 입력을 정상 장치에 다시 주는 중 …";
        drop_here: "Drop the file: it is laid behind this trace", "놓으면 이 신호 기록 뒤에 파일이 겹쳐집니다";
        open_first: "Open a trace first: a file is laid behind it", "먼저 신호 기록을 여십시오. 파일은 그 뒤에 겹쳐집니다";
        not_importable: "Only .csv, .parquet and .mcap files can be laid behind a trace", ".csv, .parquet, .mcap 파일만 신호 기록과 비교할 수 있습니다";
        cannot_overlay: "There is nothing to compare with", "비교할 수 없습니다";
        cannot_compare: "Where they differ cannot be told", "차이를 판단할 수 없습니다";
        offset: "offset", "이동";
        offset_hint: "how much later the other one is laid, s", "비교 대상을 뒤로 옮기는 시간, s";
        no_deviation: "no signal differs", "다른 신호 없음";
        deviations: "{count} signals deviate, first {signal} at {place}", "신호 {count}개가 벗어남, 처음은 {place}의 {signal}";
        show_deviating: "Show them", "표시";
        deviates: "deviates", "벗어남";

        compared: "compared from {from} s to {to} s of the trigger", "트리거 기준 {from} s ~ {to} s 비교";
        not_in: "not in {of}: {names}", "{of}에 없음: {names}";
        of_trace: "trace {trace} of {procedure}, {source}", "신호 기록 {trace}: {procedure}, {source}";
        replayed: "replay: trace {trace}, run {run}, unit {unit}", "재현: 신호 기록 {trace}, 시험 {run}, 장치 {unit}";
        again: "{signal}, which deviated first in the trace, deviates again", "신호 기록에서 처음 벗어난 {signal}: 다시 벗어남";
        not_again: "{signal}, which deviated first in the trace, does not deviate", "신호 기록에서 처음 벗어난 {signal}: 벗어나지 않음";
        broken_off: "cut short: {why}", "중단됨: {why}";
        refused: "refused by the bench: {what}", "시험대가 거부함: {what}";
        of_replay: "replay", "재현";
        of_original: "trace", "신호 기록";

        // Export.
        exported: "trace {trace}: {rows} rows of {signals} signals to {file}", "신호 기록 {trace}: 신호 {signals}개, 행 {rows}개를 {file}에 저장함";
        file_name: "file name, without its ending", "파일 이름 (확장자 제외)";
        save: "Save", "저장";
        save_png: "Save PNG", "PNG 저장";
        save_csv: "Save CSV", "CSV 저장";
        cannot_save: "The file cannot be written", "파일을 쓸 수 없습니다";
    }
}
