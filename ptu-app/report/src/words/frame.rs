//! Connection bar, navigation and messages.

use super::wordings;

wordings! {
    /// Connection bar, navigation and messages.
    Frame {
        title: "Maintenance test unit", "정비 시험기";
        connect: "Connect", "연결";
        disconnect: "Disconnect", "연결 해제";
        connecting: "connecting …", "연결 중 …";
        not_connected: "not connected", "연결 안 됨";
        connected: "connected", "연결됨";
        simulated: "simulated unit", "모의 장치";
        armed: "ARMED: test signals act", "ARMED: 시험 신호 작동";
        disarmed: "disarmed", "시험 허가 해제됨";
        stop_all: "Stop all", "전체 정지";
        language: "language", "언어";
        operator: "operator view", "시험자 화면";
        operator_hint: "Large text and buttons on the page of a case and around it", "정비 작업 화면의 글자와 단추를 크게";
        engineer: "engineer view", "기술자 화면";
        engineer_hint: "As much as there is room for on the page of a case and around it", "정비 작업 화면에 더 많은 내용 표시";
        lock: "Lock", "잠금";
        lock_hint: "Nothing can be started, armed or written until somebody gives a name; a run under way goes on", "누군가 이름을 적을 때까지 시험 시작, 시험 허가, 기록을 할 수 없습니다. 진행 중인 시험은 계속됩니다";
        locked: "Locked: give a name to work on. Stop all (F12) works.", "잠김: 이름을 적으면 계속할 수 있습니다. 전체 정지(F12)는 언제나 됩니다.";
        unlock: "Unlock", "잠금 해제";
        lock_is_no_password: "It is a name and no password: it says who tests from now on.", "암호가 아니라 이름입니다. 지금부터 누가 시험하는지를 나타냅니다.";
        dark: "dark", "어둡게";
        light: "light", "밝게";
        scale: "size", "크기";
        cannot_connect: "Not connected", "연결하지 못했습니다";
        database_gone: "The database is gone: put it back, or open the window again to begin a new one", "데이터베이스 파일이 없어졌습니다. 제자리에 돌려놓거나, 창을 다시 열어 새로 시작하십시오";
        stopping: "stopping: outputs are being made safe …", "정지 중: 출력을 안전 상태로 전환 중 …";
        is_connected: "Connected to unit {unit}", "장치 {unit} 연결됨";
        is_disconnected: "Disconnected; outputs safe, unit disarmed", "연결 해제됨: 출력은 안전하고 시험 허가는 해제됨";
        link_gone: "link lost", "링크 끊김";
        go_on: "Reconnect and continue", "다시 연결하고 계속";
        go_on_not: "The scripts are others since: the run cannot go on", "그 뒤 스크립트가 바뀌어 계속할 수 없습니다";
        go_on_hint: "Connects the unit, sets the procedure up again and repeats its step. Another unit does not continue the run.", "장치를 연결하고 절차를 다시 준비한 뒤 중단된 단계를 반복합니다. 다른 장치로는 계속할 수 없습니다.";
        end_run: "End the run", "시험 끝내기";
        link_lost: "The connection to the unit is lost", "장치와의 링크가 끊어졌습니다";
        broken: "The bench's program failed: switch the unit off and report what was done", "시험대 프로그램에 오류가 발생했습니다: 장치 전원을 끄고 상황을 보고하십시오";
        cannot_list: "Ports, lines or units cannot be listed", "포트, 노선, 장치 목록을 읽을 수 없습니다";
        close_anyway: "Close", "닫기";
        dismiss: "Noted", "확인";
        armed_unit: "ARMED: {unit}", "ARMED: {unit}";
        running: "run {share} %", "시험 {share} %";
        asks: "a script asks", "스크립트 질문 있음";
        is_paused: "run paused", "시험 일시 정지";
        not_safe: "Outputs were not confirmed safe: switch the unit off", "출력이 안전한지 확인되지 않았습니다: 장치 전원을 끄십시오";
        unit_restarted: "The unit was started again", "장치가 다시 시작되었습니다";
        not_done: "Not done: {what}", "실행되지 않음: {what}";
        run_ended: "Run over: {verdict}", "시험 종료: {verdict}";
        run_failed: "The run could not be recorded", "시험을 기록할 수 없습니다";
        undo: "Undo", "되돌리기";
        undone: "{what} – undone", "{what} – 되돌렸습니다";
        undo_reason: "undone at once", "기록 직후 되돌림";
        not_undone: "It was not undone", "되돌리지 못했습니다";
        messages: "Messages", "알림";
        clear: "Clear", "지우기";
        closing: "Stopping the run and making outputs safe …", "시험을 멈추고 출력을 안전하게 하는 중 …";
        other_port: "other: serial:PATH or tcp:HOST:PORT", "직접 입력: serial:PATH 또는 tcp:HOST:PORT";
        page: "page", "화면";
        setup: "Setup", "설정";
        harness_auto: "found out", "자동 판별";
        as_btu: "BTU (bench)", "BTU (시험대)";
        as_ptu: "PTU (laptop)", "PTU (노트북)";
        connection_kind: "connected as", "연결 방식";
        line: "line", "노선";
        unit_config: "unit configuration", "장치 구성";
        train: "train", "열차";
        serial: "serial number", "일련번호";
        seed: "seed", "시드";
        scatter: "vary as good units do", "정상 장치의 편차 적용";
        realtime: "real-time runs", "실시간 시험";
        inject: "injected faults", "주입 고장";
        take_out: "Remove", "제거";
        find: "find a fault", "고장 찾기";
        injected: "injected: {faults}", "주입됨: {faults}";
        none: "none", "없음";
        link_good: "link {share} %", "링크 {share} %";
        add_unit: "Add a unit", "장치 추가";
        remove_unit: "Remove", "제거";
        arm: "Arm", "시험 허가";
        arm_hint: "Hold it down for a second", "1초 동안 누르고 계십시오";
        disarm: "Disarm", "시험 허가 해제";
        about: "About", "정보";
        versions: "software {software}, unit configuration {config}, track database {line}",
            "소프트웨어 {software}, 장치 구성 {config}, 선로 데이터 {line}";
        not_as_recorded: "not as the train's record says: {what}", "편성 기록과 다름: {what}";
        recorded_serial: "serial number", "일련번호";
        recorded_software: "software", "소프트웨어";
        recorded_config: "unit configuration", "장치 구성";
        recorded_line: "track database", "선로 데이터";
        database: "database", "데이터베이스";
        scripts: "scripts", "스크립트";
        font_licence: "Licence of the font Pretendard (SIL Open Font License 1.1)", "Pretendard 글꼴 라이선스 (SIL Open Font License 1.1)";
    }
}
