//! Waveforms: read, made, recorded and played.

use super::wordings;

wordings! {
    /// Waveforms: read, made, recorded and played.
    Signals {
        title: "Waves", "신호 파형";
        report: "Waveforms in a file", "파일의 신호 파형";
        file: "file", "파일";
        length: "length", "길이";
        full_scale: "full scale", "최대 눈금";

        // Signals that were detected.
        heard: "What was heard", "수신 결과";
        nothing: "No code, no TWC and no marker.", "속도 코드, TWC, 마커가 없습니다.";
        channel: "channel", "채널";
        from: "from s", "시작 s";
        to: "to s", "끝 s";
        kind: "kind", "종류";
        what: "what", "내용";
        carrier: "carrier Hz", "반송파 Hz";
        rate: "rate Hz", "주파수 Hz";
        level: "level mV", "레벨 mV";
        snr: "SNR dB", "SNR dB";
        code: "code", "속도 코드";
        twc: "TWC", "TWC";
        marker: "marker", "마커";
        tacho: "speed sensor", "속도센서";
        of_tacho: "{forward} pulses forward, {backward} backward; {mean} km/h ({low} to {high}); line B {phase}° behind; high {a}, {b} %; teeth missing: {missing}", "정방향 {forward}, 역방향 {backward} 펄스; {mean} km/h ({low} ~ {high}); B선 {phase}° 뒤; 듀티 {a}, {b} %; 빠진 이: {missing}";
        no_sensor: "channel {n}: noise, or no speed sensor: its pulses come too unevenly for a wheel", "채널 {n}: 잡음이거나 속도센서가 아닙니다. 펄스 간격이 차륜이라기에는 너무 불규칙합니다";
        clipped: "channel {n}: clipped, {samples} samples are as great as the file holds; record with less gain", "채널 {n}: 파형이 잘렸습니다. 샘플 {samples}개가 파일의 최댓값입니다. 이득을 낮추어 다시 녹음하십시오";
        one_line: "one channel: a speed sensor has two lines, A and B", "채널이 하나입니다. 속도센서는 A, B 두 선입니다";
        no_code: "carrier without a code", "코드 없는 반송파";
        unknown_code: "no code of this unit configuration", "이 장치 구성에 없는 코드";
        damaged_bytes: "{bytes} ({n} bytes damaged)", "{bytes} (손상 {n}바이트)";
        meter: "channel {n}: {level} mV rms, at most {most} mV rms in 0.1 s{strongest}", "채널 {n}: {level} mV rms, 0.1 s 구간 최대 {most} mV rms{strongest}";
        strongest: "; the strongest line is {hz} Hz with {mv} mV rms", "; 가장 강한 성분 {hz} Hz, {mv} mV rms";
        not_understood: "Not understood", "해석하지 못한 부분";
        at: "{from} to {to} s: {why}", "{from} ~ {to} s: {why}";
        too_slow: "{n} samples a second are too few for {hz} Hz; record with 48 000", "초당 표본 {n}개로는 {hz} Hz를 읽을 수 없습니다. 48 000으로 녹음하십시오";
        loud: "channel {n}: {level} mV rms that are no code of this unit configuration and no TWC", "채널 {n}: {level} mV rms, 이 장치 구성의 코드도 TWC도 아닙니다";
        many_channels: "{n} channels: only the first {most} are read", "채널 {n}개 중 처음 {most}개만 읽습니다";
        broken: "the file is cut off or damaged from here on ({why})", "여기서부터 파일이 잘렸거나 손상되었습니다 ({why})";

        // Plots.
        of_channel: "Channel {n}", "채널 {n}";
        waveform: "Waveform", "파형";
        spectrogram: "Spectrum over time, lighter is stronger: {low} to {high} dB over 1 mV", "시간별 스펙트럼, 밝을수록 강함: 1 mV 기준 {low} ~ {high} dB";
        spectrum: "Mean spectrum", "평균 스펙트럼";
        envelope: "Level at the {hz} Hz of the code's carrier", "코드 반송파 {hz} Hz의 레벨";
        eye: "Eye of the TWC bits", "TWC 비트 아이 패턴";
        time: "time, s", "시간, s";
        frequency: "frequency, Hz", "주파수, Hz";
        millivolts: "mV", "mV";
        millivolts_rms: "mV rms", "mV rms";
        decibels: "dB over 1 mV", "1 mV 기준 dB";
        bits: "bits from a decision on", "판정 시점 기준 비트";
        // The page.
        none_open: "No recording is open", "열린 녹음이 없습니다";
        recording_of: "Recording", "녹음 파일";
        under_way: "work on a signal is under way", "작업이 진행 중입니다";
        explained: "Open a WAV file, or record from a sound card: codes and bytes are shown as the unit's receivers hear them.", "WAV 파일을 열거나 사운드 카드에서 녹음하십시오. 장치의 수신기가 해석한 속도 코드와 바이트를 표시합니다.";
        open: "Open", "열기";
        record: "Record", "녹음";
        record_hint: "Recorded to the named file, never over one that is there, but beside it as -2, -3 …", "적은 파일에 녹음합니다. 같은 파일이 있으면 덮어쓰지 않고 -2, -3 …을 붙입니다";
        recording: "recording: {time}", "녹음 중: {time}";
        recorded: "Recorded: {file}, {time} s", "녹음 완료: {file}, {time} s";
        input: "input", "입력 장치";
        output: "output", "출력 장치";
        no_sound: "No sound device can be listed.", "사운드 장치 목록을 읽을 수 없습니다.";
        heard_in: "What was heard in {time}", "수신 결과 ({time})";
        more: "Further signals: {n}.", "그 밖의 신호: {n}건.";
        generator: "Generator", "신호 발생기";
        code_name: "name of the code", "코드 이름";
        bytes: "bytes", "바이트";
        bytes_hint: "Bytes are pairs of hex digits, at most 200.", "바이트는 16진수 두 자리씩, 최대 200바이트입니다.";
        seconds: "length s", "길이 s";
        noise: "noise", "잡음";
        made: "What is made", "만들 파형";
        play: "Play", "재생";
        playing: "playing …", "재생 중 …";
        played: "Played: {time} s", "재생 완료: {time} s";
        stopped: "stopped", "중지됨";
        no_device: "no device for sound", "사운드 장치 없음";
        device: "device", "장치";
        direction: "direction", "방향";
        calibrated: "calibrated", "교정";
        play_reference: "a carrier of {mv} mV rms is played: type what the instrument at the coil shows, mV rms, and Enter", "{mv} mV rms 반송파를 재생합니다. 코일의 계측기 값(mV rms)을 입력하고 Enter를 누르십시오";
        not_stored: "stopped: nothing was stored", "중지됨: 저장하지 않았습니다";
        scale_of: "{device}, channel {channel}: full scale is {mv} mV ± {percent} %, by {by}", "{device}, {channel} 채널: 최대 눈금 {mv} mV ± {percent} %, 계측기 {by}";
        save: "Save", "저장";
        save_hint: "Saved to the named file, never over one that is there, but beside it as -2, -3 …", "적은 파일에 저장합니다. 같은 파일이 있으면 덮어쓰지 않고 -2, -3 …을 붙입니다";
        cut_off: "{n} samples were too strong and were cut off: lower the level.", "표본 {n}개가 범위를 넘어 잘렸습니다. 레벨을 낮추십시오.";
        too_loud: "{n} samples of the channel {channel} are at the end of the device's range: it was too loud.", "{channel} 채널 표본 {n}개가 장치 범위 끝에 있습니다. 입력이 너무 큽니다.";
        gaps: "The device had no samples in time, or lost some: {n} times.", "장치가 표본을 제때 받지 못했거나 잃었습니다: {n}회.";
        uncalibrated: "{device}: not calibrated for {channels}; levels are nominal.", "{device}: {channels} 채널을 교정하지 않았습니다. 레벨은 공칭값입니다.";
        not_done: "The signal was not read, recorded, saved or played", "신호를 읽기, 녹음, 저장 또는 재생하지 못했습니다";

        lean: "upper tone over lower", "상측·하측 톤 차";
    }
}
