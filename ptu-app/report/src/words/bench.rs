//! Live view and stimuli.

mod states;

use super::wordings;
use ptu_runs::bench_worker::Refused;

wordings! {
    /// Live view and stimuli.
    Bench {
        title: "Bench", "시험대";
        connect_first: "Connect a unit to see it live.", "장치를 연결하면 실시간으로 볼 수 있습니다.";

        // Why a stimulus cannot be given.
        no_unit: "No unit is connected", "연결된 장치가 없습니다";
        run_has_bench: "A run has the bench: stop it first", "시험이 시험대를 사용 중입니다. 먼저 시험을 멈추십시오";
        needs_harness: "Goes through the bench harness; only the maintenance port is connected", "시험대 하네스로 주는 신호입니다. 정비 포트만 연결되어 있습니다";
        in_cab: "A person in the cab does this; only the maintenance port is connected", "운전실에서 사람이 조작합니다. 정비 포트만 연결되어 있습니다";
        not_armed: "The unit is not armed: hold Arm down first", "시험 허가 상태가 아닙니다. 먼저 시험 허가를 1초 동안 누르십시오";
        key_off: "The maintenance key is off", "정비 키가 꺼져 있습니다";

        // States of any value.
        not_known: "not known", "알 수 없음";
        on: "on", "켜짐";
        off: "off", "꺼짐";
        applied: "applied", "체결";
        released: "released", "완해";
        none: "none", "없음";
        good: "good", "정상";

        // Lamps.
        eb: "EB", "EB";
        fsb: "FSB", "FSB";
        overspeed_alarm: "Overspeed alarm", "과속 경보";
        power_cut: "Power cut", "역행 차단";
        holding_brake: "Holding brake", "정차 제동";
        doors: "Doors", "출입문";
        doors_open: "open", "열림";
        doors_closed: "closed", "닫힘";
        doors_unlocked: "closed, not locked", "닫힘, 미쇄정";
        doors_left: "Doors left", "좌측 출입문";
        doors_right: "Doors right", "우측 출입문";
        enable_left: "Doors enabled left", "좌측 출입문 허용";
        enable_right: "Doors enabled right", "우측 출입문 허용";
        doors_ordered_open: "ordered to open", "열림 지령";
        doors_order_close: "Doors ordered to close", "출입문 닫힘 지령";
        enabled: "enabled", "허용";
        not_enabled: "not enabled", "불허";

        // Speeds.
        measured: "measured", "측정";
        true_speed: "true", "실제";
        limit: "limit", "제한";
        target: "ATO target", "ATO 목표";

        // Cab.
        cab: "Cab", "운전실";
        mode: "Mode", "운전 모드";
        mode_switch: "Mode switch", "모드 스위치";
        hcr: "HCR", "HCR";
        key: "Maintenance key", "정비 키";
        controller: "Controller", "주간제어기";
        speed_code: "Speed code", "속도 코드";
        no_code: "no code", "무코드";
        eb_cause: "EB cause", "EB 원인";
        fsb_cause: "FSB cause", "FSB 원인";
        ato: "ATO", "ATO";
        ready: "ready", "준비됨";
        not_ready: "not ready", "준비 안 됨";
        standstill: "Standstill", "정지 검지";
        healthy: "Unit healthy", "장치 정상";
        refused: "Automatic refused", "자동운전 불허";

        // Track strip.
        track: "Track", "선로";
        section_is: "section {section}: {from} → {to}", "구간 {section}: {from} → {to}";
        no_section: "no section laid along the way", "선로 구간이 설정되지 않음";
        to_stop_is: "{way} m to the stop point", "정위치까지 {way} m";
        beyond_stop_is: "{way} m beyond the stop point", "정위치 {way} m 초과";
        detected_is: "last detected: {marker} ({count})", "최근 검지: {marker} ({count}회)";
        stop_point: "stop", "정위치";

        // Effort and TCMS.
        effort: "Effort and TCMS", "견인·제동력과 TCMS";
        effort_ato: "ATO sends", "ATO 지령";
        effort_tcms: "TCMS orders", "TCMS 지령";
        effort_train: "Train gives", "열차 출력";
        coast: "coast", "타행";
        tcms_mode: "TCMS mode", "TCMS 모드";
        tcms_link: "TCMS link", "TCMS 통신";
        tcms_alive: "TCMS alive", "TCMS 생존 신호";
        tcms_fsb: "TCMS FSB", "TCMS FSB";
        tcms_holding: "TCMS holding", "TCMS 정차 제동";
        power_cuts: "Power cut by", "역행 차단 원인";
        eb_line: "EB train line", "EB 인통선";
        eb_sources: "EB line open by", "EB 회로 개방 원인";
        lamps: "Cab lamps", "운전실 표시등";

        // TWC.
        twc: "TWC", "TWC";
        twc_link: "TWC link", "TWC 통신";
        wayside: "Wayside", "지상 신호장치";
        station: "Station", "역";
        next_station: "Next station", "다음 역";
        loop_id: "Loop", "루프";
        fixed_speed: "Fixed speed", "지정 속도";
        running_mode: "Running mode", "운전 패턴";
        door_side: "Door side", "출입문 방향";
        departure: "Departure", "출발 지시";
        train_number: "Train number", "열차 번호";
        station_valid: "Data valid", "역 정보 유효";
        answers: "Answers", "응답 수";
        received: "Frames taken", "수신 전문 수";
        answer_train: "Answer: train", "응답: 열차";
        answer_station: "Answer: station", "응답: 역";
        aligned: "At stop point", "정위치 정차";
        route: "Route", "진로";
        section: "Section", "구간";
        given: "given", "있음";
        held: "not given", "없음";

        // Log.
        log: "Event log", "이벤트 기록";
        log_empty: "no events", "이벤트 없음";
        seconds: "{time} s", "{time} 초";

        // Rolling plot.
        plot: "Plot", "그래프";
        plot_signals: "Signals …", "신호 …";
        plot_last: "{time} s", "{time} 초";
        plot_find: "find", "찾기";
        plot_nothing: "choose signals to plot", "그래프에 표시할 신호를 선택하십시오";

        // Groups of stimuli.
        group_test_board: "TEST board", "TEST 보드";
        group_atp: "ATP signal", "ATP 신호";
        group_speed: "Speed", "속도";
        group_markers: "Markers", "마커";
        group_twc: "TWC", "TWC";
        group_lines: "Train lines", "인통선";
        group_controller: "Controller", "주간제어기";
        group_tcms: "TCMS and train", "TCMS와 열차";

        // What is given.
        give_signal: "Give signal", "신호 인가";
        code_off: "Code off", "코드 끄기";
        codes_along: "Codes along the way", "선로 코드 연동";
        carrier: "Carrier", "반송파";
        rate: "Code rate", "코드 주파수";
        level: "Level", "레벨";
        rate_drift: "Rate drift", "주파수 변화";
        level_drift: "Level drift", "레벨 변화";
        start_drift: "Start drift", "드리프트 시작";
        stop_drift: "Stop drift", "드리프트 정지";
        go_to: "Go to speed", "속도 인가";
        stand: "Stand still", "정지";
        to_speed: "To", "목표 속도";
        acceleration: "Acceleration", "가속도";
        travel: "Travel", "주행";
        distance: "Distance", "거리";
        direction: "Direction", "방향";
        forward: "forward", "전진";
        backward: "backward", "후진";
        neutral: "neutral", "중립";
        tacho: "Tachometer {channel}", "속도센서 {channel}";
        noise: "Noise", "잡음";
        factor: "Scale", "배율";
        train_model: "Train model", "열차 모델";
        marker_pulse: "Marker pulse", "마커 펄스";
        lay: "Lay section", "구간 설정";
        take_up: "Take up", "해제";
        marker: "Marker", "마커";
        move_by: "Moved by", "이동";
        move_marker: "Move", "이동 적용";
        missing: "Missing", "누락";
        send_frame: "Send frame", "전문 송신";
        wayside_order: "Order", "운행 지령";
        destination: "Destination", "행선역";
        no_orders: "not sent", "미송신";
        order_state: "Order state", "지령 수행 상태";
        at_departure: "departure", "출발역";
        at_arrival: "arrival", "도착역";
        order: "ordered", "지시";
        reverser: "Reverser", "역전기";
        buttons: "Buttons", "누름 버튼";
        acknowledge: "Acknowledge", "확인";
        start: "ATO start", "ATO 출발";
        lever: "Lever", "레버";
        volts: "Voltage", "전압";
        contacts: "Contacts", "접점";
        as_lever: "as the lever", "레버대로";
        set: "Set", "적용";
        as_always: "As always", "기본값";
        ato_enable: "ATO permitted", "ATO 허가";
        load: "Load", "승객 하중";
        gradient: "Gradient", "구배";
        adhesion: "Adhesion", "점착계수";
        cut_out: "Cut out, car", "개방, 차호";
        cut_brake: "Brake", "제동";
        cut_inverter: "Inverter", "인버터";
        cut_off: "cut out", "개방";
        cut_in: "cut in", "투입";
        maintenance: "Tester", "시험기";
        silent: "silent", "무응답";
        speaks: "speaks", "통신";
        arm: "Arm unit", "장치 시험 허가";
        disarm: "Disarm unit", "장치 시험 허가 해제";
        inputs: "Inputs", "입력 채널";
        test_code: "Test code", "시험 코드";
        test_speed: "Test speed", "시험 속도";
        test_marker: "Test marker", "시험 마커";
        test_twc: "Test TWC frame", "시험 TWC 전문";
        self_test: "Self-test", "자체시험";
        run_self_test: "Self-test now", "자체시험 실행";
        item_memory: "memory", "메모리";
        item_configuration: "unit configuration", "장치 구성";
        item_track_database: "track database", "선로 데이터";
        item_eb_relay: "EB relay", "EB 릴레이";
        item_atp_receiver: "ATP receiver", "ATP 수신부";
        item_tra: "TRA", "TRA";
        item_twc_modem: "TWC modem loop-back", "TWC 모뎀 루프백";
        item_twc_cpu: "TWC CPU", "TWC CPU";
        item_tcms_link: "link to TCMS", "TCMS 통신 링크";
        item_test_board: "TEST board", "TEST 보드";
        unit_bytes: "bytes", "바이트";
        unit_errors: "errors", "오류";
        unit_answers: "answers", "응답";
        unit_frames: "frames", "전문";
        release_all: "Take test signals away", "시험 신호 제거";
        clear_log: "Clear event log", "이벤트 기록 삭제";
        acting: "acting now", "작동 중인 신호";
        take_all: "Remove all", "모두 제거";
        find: "find a stimulus", "입력 찾기";
        read_back: "Read back", "회신값";

        // Switches of the train.
        other_cab: "HCR of the other cab", "반대 운전실 HCR";
        dead_man: "Dead man held", "운전자 경계장치";
        button_1: "Emergency button 1", "비상 버튼 1";
        button_2: "Emergency button 2", "비상 버튼 2";
        eb_cut_out: "EB cut-out", "EB 개방";
        main_reservoir_low: "Main reservoir low", "주공기압 저하";
        security_brake: "Security brake", "보안 제동";
        parking_brake: "Parking brake", "주차 제동";
        forced_release: "Forced release", "강제 완해";
        turn_back: "Turn-back", "회차";
        regeneration: "Line takes regeneration", "회생 가능";

        // States by name.
        mode_off: "off", "차단";
        mode_yard: "yard", "기지";
        mode_manual: "manual", "수동";
        mode_automatic: "automatic", "자동";
        mode_automatic_run: "automatic run", "자동 주행";
        mode_driverless: "driverless", "무인";
        mode_emergency: "emergency", "비상";
        ato_inspection: "inspection", "점검";
        ato_stop: "stop", "정지";
        ato_start: "start", "출발";
        ato_run: "run", "주행";
        eb_not_released: "not released yet", "아직 완해 전";
        overspeed: "overspeed", "과속";
        eb_ineffective: "FSB ineffective", "FSB 효과 없음";
        eb_tachometer: "tachometers disagree", "속도센서 불일치";
        eb_rollback: "rollback", "후진";
        eb_door: "door open while moving", "주행 중 출입문 열림";
        eb_inputs: "inputs lost", "입력 두절";
        eb_self_test: "self-test failed", "자체시험 실패";
        eb_internal: "broken invariant", "내부 논리 오류";
        eb_jog: "moved forward while jogging backward", "후진 인칭 중 전진";
        eb_line_opened: "brake line opened by others", "외부 비상제동 인통선 차단";
        fsb_twc: "TWC lost", "TWC 두절";
        fsb_tcms: "TCMS lost", "TCMS 두절";
        fsb_ato: "ATO failed", "ATO 고장";
        fsb_not_permitted: "not permitted", "허가 없음";
        fsb_stop_code: "stop code", "정지신호";
        fsb_door: "door open, not enabled", "허용되지 않은 출입문 열림";
        fsb_jog: "jogging too fast", "인칭 과속";
        fsb_eb_failed: "emergency brake does not act", "비상제동 불발";
        test_mode: "test mode", "정비 시험 모드";
        differs: "differs", "불일치";
        same: "same", "일치";
        not_stated: "not stated", "지정 없음";
        arm_key_off: "key off", "정비 키 꺼짐";
        arm_bad_answer: "wrong or late answer", "응답 오류";
        arm_busy: "another session", "다른 시험기 사용 중";
        arm_tester_silent: "tester silent", "시험기 무응답";
        arm_disarmed: "disarmed", "시험 종료";
        arm_starting_up: "starting up", "기동 중";
        arm_brakes_released: "brakes not proved", "제동 미확인";
        arm_train_moved: "train moved", "차량 이동";
        arm_code_changed: "code changed", "속도 코드 변화";
        arm_mode_changed: "mode switch turned", "모드 스위치 변경";
        arm_doors_open: "a door is open", "출입문 열림";
        side_left: "left", "좌측";
        side_right: "right", "우측";
        side_both: "both", "양측";
        running_normal: "normal", "정상";
        running_recovery: "recovery", "회복";
        running_slow: "slow", "서행";
        order_turn_back: "turn back", "회차";
        order_put_away: "put away", "유치";
        order_wake_up: "wake up", "기동";
        order_turning_back: "turning back", "회차 중";
        order_handed_over: "handed over", "운전실 인계";
        order_taking_over: "taking over", "운전실 인수 중";
        order_is_put_away: "put away", "유치됨";
        order_waking: "waking up", "기동 중";
        order_ready: "ready", "출발 준비 완료";
        order_failed: "failed", "수행 실패";
        number_configured: "configured", "설정값";
        number_keyed: "keyed in", "운전실 입력";
        number_confirmed: "confirmed", "지상 확인";
        wayside_corrupt: "corrupt", "손상 전문";
        tacho_dead: "dead", "무신호";
        tacho_noisy: "noisy", "잡음";
        tacho_scaled: "scaled", "배율 오차";
        tacho_reversed: "reversed", "방향 반대";
        tcms_stale: "stale", "카운터 정지";

        // Causes, as bits.
        cause_doors: "doors", "출입문";
        cause_reverser: "reverser", "역전기";
        cause_emergency: "emergency brake", "비상제동";
        cause_full_service: "full service brake", "상용전제동";
        cause_atc: "ATC", "ATC";
        cause_atc_silent: "ATC silent", "ATC 통신 두절";
        cause_holding: "holding brake", "정차 제동";
        cause_not_released: "brake not released", "제동불완해";
        cause_mode: "no mode", "모드 없음";
        cause_failure: "failure", "고장";
        refused_moving: "moving", "정차 아님";
        refused_no_twc: "no TWC", "TWC 없음";
        refused_station: "station data", "역 정보";
        refused_mode_switch: "mode switch", "모드 스위치";
        refused_controller: "controller not neutral", "주간제어기 중립 아님";
        refused_eb: "EB applied", "EB 체결";
        refused_tcms: "TCMS", "TCMS";
        refused_ato: "ATO not ready", "ATO 준비 안 됨";
        refused_departure: "no departure or start", "출발 지시·버튼 없음";
        refused_doors: "door sequence at the station", "정차 출입문 취급 중";
        refused_ordered: "held by an order", "지령에 의한 정차 유지";
    }
}

impl Bench {
    /// Reason for which an act is refused now.
    pub fn refusal(&self, why: Refused) -> &'static str {
        match why {
            Refused::NotConnected => self.no_unit,
            Refused::Running => self.run_has_bench,
            Refused::NeedsHarness => self.needs_harness,
            Refused::InCab => self.in_cab,
            Refused::NotArmed => self.not_armed,
            Refused::KeyOff => self.key_off,
        }
    }
}
