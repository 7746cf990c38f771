//! Needs of this computer for testing units, and how to meet them.

use btu_rig::rig::InstrumentFault;

use super::wordings;

wordings! {
    /// What this computer lacks for testing units, and how to get it.
    Doctor {
        ok: "ok", "정상";
        warning: "warning", "주의";
        wrong: "WRONG", "이상";
        scripts: "scripts", "절차";
        ports: "ports", "포트";
        display: "display", "화면";
        database: "database", "이력";
        disk: "disk", "디스크";
        clock: "clock", "시계";
        server: "server", "서버";
        correct_script: "correct the file, or move it away; `ptu run --check` shows all errors", "파일을 고치거나 옮기십시오. 전체 오류: `ptu run --check`";
        other_scripts: "name another with --scripts", "--scripts로 다른 폴더를 지정하십시오";
        loaded: "{n} procedures and {data} data files: {places}", "절차 {n}개, 데이터 파일 {data}개: {places}";
        over: ", over ", " → ";
        replacing: "in place of those of the program: {names}", "프로그램의 것을 대신하는 파일: {names}";
        compare_them: "after an update of the program, compare them with its own; remove those that are no longer needed", "프로그램을 갱신한 뒤에는 프로그램의 것과 비교하고, 필요 없는 것은 지우십시오";
        name_port: "name a port with --unit serial:PATH", "--unit serial:PATH로 포트를 지정하십시오";
        no_port: "none found; the simulated unit and units over TCP need none", "없음. 모의 장치와 TCP 장치에는 필요 없음";
        probed: "ModemManager writes to serial adapters that are plugged in", "ModemManager가 꽂은 직렬 어댑터에 데이터를 씀";
        stop_probing: "install the rule of the package, 60-ptu.rules, or: sudo systemctl disable --now ModemManager", "패키지의 규칙 60-ptu.rules를 설치하거나: sudo systemctl disable --now ModemManager";
        join_group: "sudo usermod -aG {group} $USER, then log out and in again", "로그아웃 후 다시 로그인: sudo usermod -aG {group} $USER";
        install_rule: "install the rule of the package, 60-ptu.rules; then: sudo usermod -aG dialout $USER, and log out and in again", "패키지의 규칙 60-ptu.rules를 설치하고 로그아웃 후 다시 로그인: sudo usermod -aG dialout $USER";
        port_closed: "{path} ({kind}) may not be opened by this user", "{path} ({kind}): 이 사용자는 열 수 없음";
        no_window: "the window is not installed", "창 프로그램이 설치되지 않음";
        own_display: "the system's own", "시스템 화면";
        no_display: "none: neither DISPLAY nor WAYLAND_DISPLAY is set", "없음: DISPLAY와 WAYLAND_DISPLAY가 설정되지 않음";
        begin_at_desktop: "for the window, start `ptu` from a desktop; a bench without a screen needs none", "창은 데스크톱에서 `ptu`로 여십시오. 화면 없는 시험대에는 필요 없음";
        will_be_made: "{file} will be made by the first run", "{file}: 첫 시험 때 만들어짐";
        not_made: "{file} cannot be made: its folder may not be written to", "{file}: 폴더에 쓸 수 없어 만들 수 없음";
        other_database: "name another with --db, or ask for the right", "--db로 다른 파일을 지정하거나 쓰기 권한을 요청하십시오";
        check_database: "`ptu db check` says more; a backup is read with --db", "자세한 내용: `ptu db check`. 백업은 --db로 읽을 수 있음";
        older: "{file} is of an earlier version; the next run brings it up to date", "{file}: 이전 판의 이력. 다음 시험 때 갱신됨";
        read_only: "{file} can be read and not written: runs are not recorded", "{file}: 읽을 수만 있어 시험이 기록되지 않음";
        keep_to_yourself: "keep it to yourself, or leave it if that is meant", "다른 사용자의 접근을 막으십시오. 의도한 것이면 그대로 두십시오";
        later_run: "the newest run is of {run}, later than this computer's clock, {now}", "최근 시험 시각 {run}이 이 컴퓨터의 시계 {now}보다 늦음";
        set_clock: "set the clock: dates in the history come from it", "시계를 맞추십시오. 이력의 날짜는 이 시계를 따름";
        newest: "{file}, newest run of {run}", "{file}, 최근 시험 {run}";
        no_run: "{file}, without a run", "{file}, 시험 없음";
        not_known: "not known yet", "아직 알 수 없음";
        free_space: "free some space, or name a database on another disk with --db", "공간을 비우거나 --db로 다른 디스크의 이력을 지정하십시오";
        room: "{n} MiB free in {folder}", "{folder}: 빈 공간 {n} MiB";
        room_unknown: "the room in {folder} is not told: {why}", "{folder}: 빈 공간을 알 수 없음: {why}";
        look_for_disk: "look whether the disk is there", "디스크가 연결되어 있는지 확인하십시오";
        set_by_network: "{now}, set by the network", "{now}, 네트워크로 맞춤";
        not_set: "{now}, not set by the network since the computer was started", "{now}, 컴퓨터를 켠 뒤 네트워크로 맞추지 않음";
        connect_once: "connect to the network once, or compare it with a clock that is right", "네트워크에 한 번 연결하거나 정확한 시계와 비교하십시오";
        clock_unknown: "{now}; the system does not say whether it is set by the network", "{now}, 네트워크로 맞추는지 알 수 없음";
        no_server: "none named; with --server it is tried", "지정하지 않음. --server로 확인";
        bench: "bench", "시험대";
        acts_and_reads: "acts and reads", "작동과 판독";
        switches_off: "switches off", "출력 차단";
        instrument_ok: "{name} {serial}: {does} within {took} ms, {stated} ms stated; registered", "{name} {serial}: {does} {took} ms (명시 {stated} ms). 등록함";
        instrument_late: "{name} {serial}: {does} within {took} ms, and the bench file states {stated} ms", "{name} {serial}: {does} {took} ms, 시험대 파일에는 {stated} ms";
        state_more: "state more in uncertainty_ms: limits become as much wider", "uncertainty_ms를 늘리십시오. 한계가 그만큼 넓어집니다";
        instrument_wrong: "{name} {serial}: {why}", "{name} (일련번호 {serial}): {why}";
        not_calibrated: "state its calibration with `ptu instrument calibrate {serial}`: until then runs need --uncalibrated", "교정 등록: `ptu instrument calibrate {serial}`. 그 전에는 시험에 --uncalibrated가 필요합니다";
        reach_it: "check its supply, the network or cable, and `at` in the bench file", "전원, 네트워크 또는 케이블, 시험대 파일의 at을 확인하십시오";
        wake_it: "switch it off and on, and close menus on it; another computer may have it", "계측기를 껐다 켜고 열린 메뉴를 닫으십시오. 다른 컴퓨터가 사용 중일 수 있습니다";
        right_model: "correct `at` in the bench file if addresses are mixed up; else `idn` of its driver", "주소가 뒤바뀌었으면 시험대 파일의 at을, 아니면 드라이버의 idn을 고치십시오";
        right_serial: "put the number that it answers into `serial` of the bench file, if it was exchanged", "계측기를 교체했으면 응답한 일련번호를 시험대 파일의 serial에 적으십시오";
        leave_it: "end that program, or wait for its end", "그 프로그램을 끝내거나 끝날 때까지 기다리십시오";
        right_commands: "hold the commands of its driver against its programming manual", "드라이버의 명령을 계측기의 프로그래밍 설명서와 비교하십시오";
        empty_queue: "switch it off and on: errors before filled it", "계측기를 껐다 켜십시오. 이전 오류로 가득 찼습니다";
        right_range: "correct `[ranges]` of its driver, or the value in the bench file or the unit configuration", "드라이버의 [ranges] 또는 시험대 파일·장치 구성의 값을 고치십시오";
        mend_relay: "check the relay, its supply, and the contact that proves it", "릴레이, 릴레이 전원, 확인 접점을 점검하십시오";
        right_sound: "check the sound card, its volume and `ptu signal devices`", "음향 장치와 음량, `ptu signal devices`를 확인하십시오";
        answers: "{server} answers", "{server} 응답함";
        recorded_here: "runs are recorded here all the same; sync them when it answers", "시험은 이 컴퓨터에 기록됨. 서버가 응답하면 동기화하십시오";
    }
}

impl Doctor {
    /// What to do about an instrument that does not do its part.
    pub fn remedy(&self, fault: &InstrumentFault) -> &'static str {
        use InstrumentFault as F;
        match fault {
            F::NotThere { .. } | F::Disconnected(_) | F::Closed => self.reach_it,
            F::Silent(_) => self.wake_it,
            F::Slow { .. } => self.state_more,
            F::OtherModel { .. } => self.right_model,
            F::OtherSerial { .. } => self.right_serial,
            F::Taken => self.leave_it,
            F::Refused { .. } | F::NoAnswer { .. } | F::NoUnmodulated => self.right_commands,
            F::QueueFull(_) => self.empty_queue,
            F::OutOfRange { .. } => self.right_range,
            F::Stuck { .. } => self.mend_relay,
            F::TooLoud
            | F::TakesNoSamples
            | F::NoPlayer { .. }
            | F::PlayerEnded
            | F::NotHeard(_) => self.right_sound,
        }
    }
}
