//! Trouble of the link to a unit, in Korean.

use btu_rig::procedure::link_trouble::{
    GarbageCause, InstrumentFault, LinkFailure, LinkTrouble, PortFailure, Property, Refused,
    channel_name,
};

/// The trouble as a sentence.
#[rustfmt::skip]
pub fn korean(trouble: &LinkTrouble) -> String {
    use LinkTrouble as T;
    match trouble {
        T::Broken(LinkFailure { link, why }) => format!("{link}: {}", port(why)),
        T::Instrument { instrument, fault } => format!("시험대 계측기 {instrument}: {}", of_instrument(fault)),
        T::Taken { by, held, silent } => {
            let silent = silent.map_or_else(String::new, |silent| format!(", 그중 {:.0} s 동안 무응답", silent.as_secs()));
            format!("다른 시험기가 장치를 사용 중입니다 ({by}, {:.0} s 전부터{silent})", held.as_secs())
        }
        T::NotOneByte { within } => format!("장치 무응답: {:.1} s 동안 수신한 데이터 없음. 케이블, 포트, 장치 전원을 확인하십시오", within.as_secs()),
        T::OtherVersion { frames } => format!("통신 버전이 다른 전문 {frames}개 수신: 장치와 시험기의 프로그램 버전이 다릅니다"),
        T::Garbage { bytes, refused, cause } => {
            let refused = refused.map_or_else(String::new, |(frames, _)| format!(", {frames}개 거부"));
            let cause = match cause {
                GarbageCause::BaudRate => "통신 속도를 확인하십시오",
                GarbageCause::Echo => "시험기가 보낸 전문이 되돌아옵니다. 이 포트에 장치가 연결되었는지 확인하십시오",
                GarbageCause::OtherDevice => "케이블과 이 포트에 연결된 기기를 확인하십시오",
            };
            format!("올바른 전문 없이 {bytes} B 수신{refused}: {cause}")
        }
        T::Silent { channel, silence, refused } => {
            let meanwhile = match refused {
                None => String::new(),
                Some(Refused::OfStarts(frames)) => format!(". 그동안 앞과 이어지지 않는 전문 {frames}개 수신: 장치가 재기동을 되풀이합니다. 전원을 확인하십시오"),
                Some(Refused::Frames(frames)) => format!(". 그동안 거부한 전문 {frames}개: 시험기와 장치 사이의 회선을 점검하십시오"),
            };
            format!("장치 무응답: {} 채널 {:.1} s{meanwhile}", channel_name(*channel), silence.as_secs())
        }
        T::BadLine { within, from_unit, came, to_unit } => format!(
            "시험기와 장치 사이의 회선 불량: {:.0} s 동안 장치의 전문 {came}개 중 {from_unit}개가 전달되지 않았고 장치가 {to_unit}개를 거부함. 케이블과 커넥터, 다른 프로그램의 포트 사용 여부를 확인하십시오",
            within.as_secs()
        ),
        T::OtherUnit(changed) => {
            let changed = changed.iter().map(|one| {
                let what = match one.property {
                    Property::Serial => "일련번호",
                    Property::Configuration => "장치 구성",
                    Property::ConfigurationChecksum => "장치 구성 체크섬",
                    Property::TrackChecksum => "선로 데이터베이스 체크섬",
                };
                format!("{what} {} → {}", one.was, one.is)
            });
            format!("다른 장치가 응답함: {}", changed.collect::<Vec<_>>().join(", "))
        }
        T::LogWithoutEnd { entries } => format!("장치의 고장 기록이 끝없이 늘어남: 기록 용량을 넘은 항목 {entries}개 수신"),
        T::LogNotAnswered { times } => format!("장치의 고장 기록을 읽지 못함: {times}회 요청, 응답 없음"),
        T::EntryNeverCame { times, entry, of } => format!("장치의 고장 기록을 읽지 못함: {of}개 중 {entry}번 항목을 {times}회 요청했으나 오지 않음"),
        T::Overwritten { entries } => format!("장치의 고장 기록 {entries}개를 읽기 전에 장치가 덮어씀"),
        T::MemoryNotAnswered => "장치의 저장 메모리를 읽지 못함: 응답이 끊김".to_owned(),
        T::MemoryTooLarge { entries } => format!("장치가 알린 저장 항목 수 {entries}개는 장치의 용량을 넘음"),
        T::MemoryExchanged => "읽는 동안 장치의 저장 메모리가 교체되었거나 고장남".to_owned(),
    }
}

#[rustfmt::skip]
impl super::Say for InstrumentFault {
    fn say(&self, how: super::TextStyle) -> String {
        match how.korean {
            true => of_instrument(self),
            false => self.to_string(),
        }
    }
}

fn of_instrument(fault: &InstrumentFault) -> String {
    use InstrumentFault as F;
    let ms = |duration: &protocol::Duration| duration.as_secs() * 1000.0;
    match fault {
        F::NotThere { at, why } => format!("{at}에 연결하지 못함: {why}"),
        F::Disconnected(why) => format!("연결이 끊어짐: {why}"),
        F::Closed => "계측기가 연결을 닫음".to_owned(),
        F::Silent(within) => format!("{:.2} s 동안 응답 없음", within.as_secs()),
        F::Slow { took, stated } => format!(
            "응답 지연: {:.0} ms 걸림 (시험대 파일에는 {:.0} ms)",
            ms(took),
            ms(stated)
        ),
        F::OtherModel { found, expected } => format!("기종이 다름: {found} 응답 (예상 {expected})"),
        F::OtherSerial { found, expected } => {
            format!("다른 계측기: 일련번호 {found} 응답 (예상 {expected})")
        }
        F::Taken => "이 컴퓨터의 다른 프로그램이 사용 중".to_owned(),
        F::NoUnmodulated => "드라이버에 무변조 반송파 명령이 없음".to_owned(),
        F::TooLoud => "파형이 음향 장치의 최대 출력을 넘음".to_owned(),
        F::TakesNoSamples => "음향 장치가 샘플을 받지 않음".to_owned(),
        F::NoPlayer { server, alsa } => {
            format!("음향을 전달할 프로그램이 없음: {server}와(과) {alsa} 모두 설치되지 않음")
        }
        F::NotHeard(at) => format!("{at}에서 소리가 들리지 않음"),
        F::PlayerEnded => "음향을 전달하는 프로그램이 종료됨".to_owned(),
        F::Refused { command, error } => format!("명령 {command}을(를) 거부함: {error}"),
        F::QueueFull(error) => format!("오류 대기열이 가득 참: {error}"),
        F::OutOfRange {
            what,
            value,
            low,
            high,
        } => format!("{what} 값 {value}이(가) 범위 {low}~{high}를 벗어남"),
        F::NoAnswer { asked, found } => format!("{asked}의 응답 {found}을(를) 해석할 수 없음"),
        F::Stuck { contact, ordered } => format!(
            "{contact} 릴레이 고착: 명령 {ordered}, 확인 접점 {}",
            1 - ordered
        ),
    }
}

#[rustfmt::skip]
fn port(failure: &PortFailure) -> String {
    match failure {
        PortFailure::Closed => "상대편에서 연결을 닫음".to_owned(),
        PortFailure::Reading(why) => format!("수신 실패: {why}"),
        PortFailure::Writing(why) => format!("송신 실패: {why}"),
        PortFailure::NotInLockStep(why) => format!("장치가 동기 방식으로 응답하지 않음 ({why}). 장치를 --pty --lock-step(으)로 실행하십시오"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trouble of each kind, as it is stored, with numbers of its own.
    const ALL: &str = r#"[
        {"broken": {"link": "tcp:31", "why": "closed"}},
        {"broken": {"link": "tcp:31", "why": {"reading": "22"}}},
        {"broken": {"link": "tcp:31", "why": {"writing": "23"}}},
        {"broken": {"link": "tcp:31", "why": {"not_in_lock_step": "24"}}},
        {"instrument": {"instrument": "io1", "fault": {"not_there": {"at": "h:25", "why": "26"}}}},
        {"instrument": {"instrument": "io2", "fault": {"disconnected": "27"}}},
        {"instrument": {"instrument": "io3", "fault": {"silent": 1500000}}},
        {"instrument": {"instrument": "io4", "fault": {"slow": {"took": 71000, "stated": 20000}}}},
        {"instrument": {"instrument": "io5", "fault": {"other_model": {"found": "28", "expected": "29"}}}},
        {"instrument": {"instrument": "io51", "fault": {"other_serial": {"found": "52", "expected": "53"}}}},
        {"instrument": {"instrument": "io54", "fault": "taken"}},
        {"instrument": {"instrument": "io62", "fault": "closed"}},
        {"instrument": {"instrument": "io63", "fault": {"not_heard": "p64"}}},
        {"instrument": {"instrument": "io55", "fault": "no_unmodulated"}},
        {"instrument": {"instrument": "io56", "fault": "too_loud"}},
        {"instrument": {"instrument": "io57", "fault": "takes_no_samples"}},
        {"instrument": {"instrument": "io58", "fault": {"no_player": {"server": "p59", "alsa": "p60"}}}},
        {"instrument": {"instrument": "io61", "fault": "player_ended"}},
        {"instrument": {"instrument": "io6", "fault": {"refused": {"command": "30", "error": "-222"}}}},
        {"instrument": {"instrument": "io7", "fault": {"queue_full": "-350"}}},
        {"instrument": {"instrument": "io8", "fault": {"out_of_range": {"what": "p1", "value": "81", "low": "2", "high": "3"}}}},
        {"instrument": {"instrument": "io9", "fault": {"no_answer": {"asked": "32", "found": "33"}}}},
        {"instrument": {"instrument": "io0", "fault": {"stuck": {"contact": "k7", "ordered": 1}}}},
        {"taken": {"by": "10.0.0.1:4711", "held": 61000000, "silent": 62000000}},
        {"not_one_byte": {"within": 3000000}},
        {"other_version": {"frames": 63}},
        {"garbage": {"bytes": 903, "refused": [41, "checksum"], "cause": "baud_rate"}},
        {"garbage": {"bytes": 904, "refused": [42, "address"], "cause": "echo"}},
        {"garbage": {"bytes": 905, "refused": null, "cause": "other_device"}},
        {"silent": {"channel": "io", "silence": 1600000, "refused": null}},
        {"silent": {"channel": "io", "silence": 1600000, "refused": {"of_starts": 51}}},
        {"silent": {"channel": "ptu", "silence": 1600000, "refused": {"frames": 52}}},
        {"bad_line": {"within": 10000000, "from_unit": 64, "came": 65, "to_unit": 66}},
        {"other_unit": [{"property": "serial", "was": "11", "is": "12"}]},
        {"other_unit": [{"property": "track_checksum", "was": "13", "is": "14"}]},
        {"log_without_end": {"entries": 67}},
        {"log_not_answered": {"times": 68}},
        {"entry_never_came": {"times": 69, "entry": 70, "of": 71}},
        {"overwritten": {"entries": 72}},
        {"memory_too_large": {"entries": 73}}
    ]"#;

    fn numbers(text: &str) -> Vec<&str> {
        let all = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
        let all = all.map(|number| number.trim_matches('.'));
        let mut all: Vec<_> = all.filter(|number| !number.is_empty()).collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn both_languages_tell_the_same_numbers() {
        let all: Vec<LinkTrouble> = serde_json::from_str(ALL).expect("troubles");
        for trouble in all {
            let (english, korean) = (trouble.to_string(), korean(&trouble));
            assert!(!numbers(&english).is_empty(), "{english}");
            assert_eq!(numbers(&english), numbers(&korean), "{english}\n{korean}");
            // What is typed as it stands, and short names, are the only English in it.
            let typed = korean.replace("--lock-step", "");
            let mut words = typed.split(|c: char| !c.is_ascii_alphabetic());
            assert!(words.all(|word| word.len() < 4), "{korean}");
        }
    }
}
