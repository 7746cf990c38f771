//! Event dictionary: stable numbers, never reused, each with severity and suspected part.

use serde::{Deserialize, Serialize};

use crate::LruId;
use crate::message::{AtoFailure, Channel, SelfTest};

/// Entries a unit's log keeps: the oldest fall off.
pub const LOG_ENTRIES: usize = 256;

crate::labelled! {
    /// Severity of an event or a fault, least first. The database stores its [`label`](Severity::label).
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Severity: label {
        /// Part of normal operation; not a fault by itself.
        Info = "info",
        /// Something is not as it should be; operation goes on.
        Minor = "minor",
        /// A function is lost or a brake was needed.
        Major = "major",
        /// Safety relevant.
        Critical = "critical",
    }
}

impl Severity {
    /// Severities of faults.
    pub const OF_FAULTS: [Self; 3] = [Self::Minor, Self::Major, Self::Critical];

    /// The severity of a fault by its word; `None` for any other word.
    pub fn of_fault(label: &str) -> Option<Self> {
        Self::OF_FAULTS.into_iter().find(|one| one.label() == label)
    }
}

/// Definition of one event.
#[derive(Debug, PartialEq, Eq)]
pub struct Definition {
    /// Number in the log.
    pub code: u16,
    /// Name in scripts, databases and reports.
    pub name: &'static str,
    /// Severity in the event log.
    pub severity: Severity,
    /// Part under suspicion when only this event is known.
    pub lru: Option<LruId>,
    /// Text in English.
    pub text: &'static str,
    /// Text in Korean.
    pub text_ko: &'static str,
    /// Meaning of the parameter; empty = not used.
    pub parameter: &'static str,
}

macro_rules! events {
    ($( $variant:ident = $code:literal $name:literal $severity:ident $lru:literal $text:literal $ko:literal $parameter:literal; )*) => {
        /// Events the unit and TCMS log.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
        )]
        pub enum Event { $( #[doc = $text] #[serde(rename = $name)] $variant ),* }

        impl Event {
            /// All events by number.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Code, name, severity, part and texts.
            pub const fn definition(self) -> &'static Definition {
                match self { $( Self::$variant => const { &Definition {
                    code: $code, name: $name, severity: Severity::$severity, lru: LruId::listed($lru),
                    text: $text, text_ko: $ko, parameter: $parameter,
                } }, )* }
            }
            /// The event of a number; `None` for one this version does not know.
            pub const fn from_code(code: u16) -> Option<Self> {
                match code { $( $code => Some(Self::$variant), )* _ => None }
            }
            /// The event called `name`.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $( $name => Some(Self::$variant), )* _ => None }
            }
        }
    };
}

events! {
    PowerUp = 100 "power_up" Info "-" "Unit powered up" "장치 기동" "";
    SelfTestFailed = 101 "self_test_failed" Critical "atp_cpu" "Self-test failed" "자체시험 실패" "failed items as bits";
    Armed = 102 "armed" Info "-" "Armed for maintenance" "정비 시험 허가" "";
    ArmingLapsed = 103 "arming_lapsed" Info "-" "Arming lapsed, test signals taken away" "정비 시험 허가 해제" "refusal code";
    LogCleared = 104 "log_cleared" Info "-" "Event log cleared" "이벤트 기록 삭제" "";
    InternalError = 105 "internal_error" Critical "atp_cpu" "Broken invariant on board" "내부 논리 오류" "number of the invariant";
    SupplyDip = 106 "supply_dip" Major "power_supply" "Restarted after a dip of the supply voltage" "전원 순간 저하로 재기동" "";
    TestModeBroken = 107 "test_mode_broken" Minor "-" "Train moved or an input changed while armed: emergency brake" "정비 시험 중 차량 이동 또는 입력 변화: 비상제동" "refusal code";
    MemoryFailed = 109 "memory_failed" Minor "ato_cpu" "Stored memory failed: log and run record are lost at power off" "저장 메모리 고장" "";
    InputsLost = 110 "inputs_lost" Critical "io_board" "I/O inputs fell silent" "입력 신호 두절" "";
    InputsRestored = 111 "inputs_restored" Info "-" "I/O inputs are back" "입력 신호 복귀" "";
    FramesRejected = 112 "frames_rejected" Minor "rs485_link" "Many frames rejected on one channel" "수신 전문 다수 폐기" "channel number";
    CodeLost = 200 "code_lost" Info "-" "No valid speed code any more: most restrictive limit" "속도 코드 상실" "";
    CodeUnknown = 201 "code_unknown" Minor "atp_receiver" "Signal present but not in the code table" "미등록 속도 코드 수신" "code rate, 0.01 Hz";
    CodeFlickers = 202 "code_flickers" Minor "atp_receiver" "Speed codes do not stay long enough to be detected: the most restrictive one holds" "속도 코드 불안정: 최저 제한속도 적용" "time for which the last one was heard within the hold time, ms";
    Overspeed = 210 "overspeed" Info "-" "Speed above limit and alarm margin" "과속 경보" "excess, cm/s";
    OverspeedFsb = 211 "overspeed_fsb" Info "-" "Overspeed: full service brake" "과속 상용전제동" "excess, cm/s";
    OverspeedEb = 212 "overspeed_eb" Major "-" "Overspeed: emergency brake" "과속 비상제동" "excess, cm/s";
    ServiceBrakeIneffective = 213 "service_brake_ineffective" Major "fsb_output" "Full service brake did not slow the train" "상용제동 효과 없음" "deceleration, mm/s²";
    EbReleased = 214 "eb_released" Info "-" "Emergency brake released" "비상제동 완해" "";
    MovedAtStop = 215 "moved_at_stop" Minor "-" "Moved after it had stood under a stop code or none: full service brake" "정지신호 하에서 이동: 상용전제동" "speed, cm/s";
    EbReleaseRefused = 216 "eb_release_refused" Info "-" "Acknowledgement refused: the emergency brake's cause still holds" "비상제동 원인 지속: 완해 불허" "what holds, `EbCause`; 0 = the train moves";
    LineOpened = 217 "line_opened" Info "-" "Emergency brake line opened by others: automatic run ended, emergency brake on a train that moves" "외부 비상제동 인통선 차단: 자동운전 종료, 주행 중 비상제동" "1 = only TCMS tells it";
    StopAndProceed = 218 "stop_and_proceed" Info "-" "Stop and proceed: stopped without a code, the driver acknowledged it by a brake notch" "정지 후 진행: 코드 없이 정차하여 확인제동 취급" "limit, cm/s";
    YardEnded = 219 "yard_ended" Info "-" "A code of the line, or one that cancels yard mode, ended the yard's limit" "구내운전 해제 코드 또는 본선 코드 수신" "";
    TachoDisagree = 220 "tacho_disagree" Critical "-" "The two tachometers disagree" "속도센서 불일치" "difference, cm/s";
    TachoDead1 = 221 "tacho1_dead" Critical "speed_sensor_1" "No pulses on tachometer 1 while 2 turns" "속도센서 1 무신호" "speed 2, cm/s";
    TachoDead2 = 222 "tacho2_dead" Critical "speed_sensor_2" "No pulses on tachometer 2 while 1 turns" "속도센서 2 무신호" "speed 1, cm/s";
    TachoDirection = 223 "tacho_direction" Critical "-" "Tachometers differ in direction" "속도센서 방향 불일치" "";
    TachoNoise1 = 224 "tacho1_noise" Major "speed_sensor_1" "Speed from tachometer 1 jumps impossibly" "속도센서 1 잡음" "jump, cm/s";
    TachoNoise2 = 225 "tacho2_noise" Major "speed_sensor_2" "Speed from tachometer 2 jumps impossibly" "속도센서 2 잡음" "jump, cm/s";
    Rollback = 226 "rollback" Major "-" "Moving against the reverser" "후진 검지" "distance, cm";
    TachoRatio = 227 "tacho_ratio" Minor "-" "Tachometers differ by a share of the way: worn wheel or missing teeth" "속도센서 비율 차이: 차륜 마모 또는 치 결손" "1 over 2, 0.01 %";
    TachoShare1 = 228 "tacho1_share" Minor "speed_sensor_1" "Tachometer 1 counts another way than lies between markers: worn wheel if more, missing teeth if less" "속도센서 1 거리 비율 오차" "difference, 0.01 %";
    TachoShare2 = 229 "tacho2_share" Minor "speed_sensor_2" "Tachometer 2 counts another way than lies between markers: worn wheel if more, missing teeth if less" "속도센서 2 거리 비율 오차" "difference, 0.01 %";
    EbRelayWelded = 230 "eb_relay_welded" Critical "eb_relay" "EB relay dropped but the brake line stays energised" "EB 계전기 용착" "";
    EbRelayOpen = 231 "eb_relay_open" Critical "eb_relay" "EB relay energised but the brake line stays dead" "EB 계전기 개방" "";
    WheelSlip = 232 "wheel_slip" Info "-" "A wheel spins or slides: its speed changes faster than adhesion lets a train" "차륜 공전/활주" "acceleration, cm/s²";
    SpeedVanished = 233 "speed_vanished" Critical "io_board" "Speed fell faster than a train can slow: no tachometer is believed" "속도 신호 소실: 속도센서 전체 불신" "last speed that is believed, cm/s";
    NoPulses = 234 "no_pulses" Major "-" "No pulses although power is asked for: powering cut" "역행 중 속도 신호 없음: 역행 차단" "time, ms";
    SpeedContradicted = 235 "speed_contradicted" Critical "io_board" "TCMS says that the train moves, or is much faster than both tachometers" "TCMS 속도와 속도센서 불일치" "speed that TCMS tells, cm/s";
    EbIneffective = 236 "eb_ineffective" Critical "-" "Emergency brake asked for, and it does not act: full service brake" "비상제동 불발: 상용전제동 체결" "1 = only TCMS tells it";
    ClockContradicted = 237 "clock_contradicted" Major "atp_cpu" "Clock ahead of TCMS's alive counter: speeds are raised by as much" "시계가 TCMS 동작 계수보다 빠름: 속도를 그만큼 상향" "difference, 0.01 %";
    DoorOpenMoving = 240 "door_open_moving" Critical "io_board" "Doors open while moving" "주행 중 출입문 열림" "speed, cm/s";
    DoorEnableRefused = 241 "door_enable_refused" Info "-" "Doors not enabled at standstill" "출입문 열림 불허" "";
    DoorNotEnabled = 242 "door_not_enabled" Critical "io_board" "Door open on a side that is not enabled" "허용되지 않은 쪽 출입문 열림" "sides";
    DoorLinesContradict = 243 "door_lines_contradict" Major "io_board" "Door lines contradict each other" "출입문 인통선 불일치" "sides";
    DoorObstructed = 244 "door_obstructed" Minor "-" "Doors not proved closed after the last try: departure refused" "출입문 닫힘 실패: 출발 불허" "sides";
    DoorOrderRefused = 245 "door_order_refused" Major "ato_cpu" "Doors ordered to open on a side that is not enabled: order stopped" "허용되지 않은 쪽 출입문 열림 지령 차단" "sides";
    DoorsStayClosed = 246 "doors_stay_closed" Major "io_board" "Doors that are enabled and ordered to open stay closed" "출입문 열림 지령에 무응답" "sides";
    DoorChatters = 247 "door_chatters" Minor "door_contact" "A door line opens more often than doors can: a contact chatters" "출입문 접점 떨림" "openings within a second";
    MarkerOrder = 300 "marker_order" Minor "marker_antenna" "Marker out of order" "마커 순서 오류" "marker";
    MarkerMissing = 301 "marker_missing" Minor "marker_antenna" "Marker missed" "마커 누락" "marker";
    MarkerPosition = 302 "marker_position" Minor "marker_antenna" "Marker away from its place" "마커 위치 오차" "difference, cm";
    TraFailed = 303 "tra_failed" Major "tra" "TRA did not answer its test" "TRA 시험 실패" "";
    TraRestored = 304 "tra_restored" Info "-" "TRA answers again" "TRA 복귀" "";
    WheelDiameter = 305 "wheel_diameter" Major "-" "Way by wheels and way between markers differ" "차륜 직경 오차" "difference, 0.01 %";
    PositionUnsure = 306 "position_unsure" Minor "marker_antenna" "No marker where one must be: position unsure" "위치 불확실" "PSM that did not come";
    TraBounces = 307 "tra_bounces" Minor "tra" "The same marker again after its debounce time: TRA bounces" "TRA 접점 떨림" "after its first edge, ms";
    WheelEntered = 308 "wheel_entered" Info "-" "Wheel diameter keyed in at the cab" "차륜 직경 입력" "diameter, 0.1 mm";
    WheelRefused = 309 "wheel_refused" Minor "-" "Wheel diameter keyed in that no wheel of the train has, or under way: not taken" "차륜 직경 입력 불허" "diameter, 0.1 mm";
    JogBegun = 310 "jog_begun" Info "-" "ATO jogs to the stop point" "정위치 인칭 시작" "way to go, cm; backward negative";
    JogFailed = 311 "jog_failed" Major "-" "Not aligned: too far to jog, or no try left" "인칭 실패: 정위치 불일치" "distance short of the stop point, cm; past it negative";
    JogOverspeed = 312 "jog_overspeed" Major "-" "Faster than a jog may be: full service brake" "인칭 과속: 상용전제동" "speed, cm/s";
    JogWrongWay = 313 "jog_wrong_way" Critical "-" "Moving forward while ATO jogs backward: emergency brake" "인칭 방향 불일치: 비상제동" "distance, cm";
    JogRefused = 314 "jog_refused" Minor "-" "ATP does not let ATO jog backward: powering cut" "후진 인칭 불허" "overrun as ATP knows it, cm; 0 = none, or not known";
    MarkersDisplaced = 315 "markers_displaced" Minor "-" "Ways between markers contradict each other: no doors enabled" "마커 간 거리 상호 모순: 출입문 불허" "difference, 0.01 %";
    TwcLost = 400 "twc_lost" Minor "twc_cpu" "TWC communication lost" "TWC 통신 두절" "";
    TwcRestored = 401 "twc_restored" Info "-" "TWC communication restored" "TWC 통신 복귀" "";
    TwcStationInvalid = 402 "twc_station_invalid" Minor "twc_cpu" "Station data do not match the track database" "역 정보 불일치" "station number";
    TwcWrongNext = 403 "twc_wrong_next_station" Minor "twc_cpu" "Station data refused: next station contradicts the track database" "다음 역 불일치" "next station";
    TwcWrongSide = 404 "twc_wrong_side" Major "twc_cpu" "Station data refused: door side contradicts the track database" "출입문 방향 불일치" "door side";
    TwcWrongMode = 406 "twc_wrong_running_mode" Minor "twc_cpu" "Station data refused: no such running mode" "운행 모드 오류" "running mode";
    TwcOtherTrain = 409 "twc_other_train" Minor "twc_cpu" "Station data for another train, not acted on" "다른 열차의 역 정보 수신" "train number";
    TwcWrongDestination = 410 "twc_wrong_destination" Minor "twc_cpu" "Orders refused: the destination is no station of the route" "행선지 불일치" "destination";
    TwcWrongLength = 411 "twc_wrong_length" Minor "twc_cpu" "Orders refused: section length contradicts the track database" "구간 길이 불일치" "length, 0.1 m";
    TwcWrongOrder = 412 "twc_wrong_order" Minor "twc_cpu" "Orders refused: no such order" "지령 오류" "order";
    OrderRefused = 413 "order_refused" Minor "-" "Order refused: the train is not in the state for it" "지령 수행 불가" "what is lacking as bits, `OrderLacks`";
    TrainNumberSet = 414 "train_number_set" Info "-" "Train number keyed in at the cab" "열차번호 입력" "train number";
    TrainNumberRefused = 415 "train_number_refused" Minor "-" "Train number keyed in under way: not taken" "주행 중 열차번호 입력 불허" "train number";
    ChangeOfCabs = 416 "change_of_cabs" Info "-" "Change of cabs at a turn-back" "회차 운전실 교체" "1 = handed over, 2 = taken over";
    CabsNotChanged = 417 "cabs_not_changed" Major "tcms" "Turn-back: the cabs were not changed in time, the train stays held" "운전실 교체 실패" "1 = TCMS reads the head control relay as dropped";
    PutAway = 418 "put_away" Info "-" "Train put away" "열차 유치" "";
    WokenUp = 419 "woken_up" Info "-" "Train woken up, self-test done" "열차 기동" "failed items as bits";
    TcmsLost = 500 "tcms_lost" Major "rs485_link" "TCMS communication lost or stale" "TCMS 통신 두절" "1 = frames come; their alive counter stands";
    TcmsRestored = 501 "tcms_restored" Info "-" "TCMS communication restored" "TCMS 통신 복귀" "";
    AtoFailed = 600 "ato_failed" Major "ato_cpu" "ATO failed" "ATO 고장" "reason, `AtoFailure`";
    AtoNotFollowing = 601 "ato_not_following" Major "ato_cpu" "The train does not do what ATO's effort asks" "목표속도 추종 불량" "speed less what effort should have made, cm/s";
    StopOverrun = 602 "stop_overrun" Major "ato_cpu" "Passed the stop point" "정위치 초과" "distance, cm";
    StopShort = 603 "stop_short" Minor "ato_cpu" "Stopped short of the stop point" "정위치 미달" "distance, cm";
    AtoInputAbsurd = 604 "ato_input_absurd" Major "-" "ATO was given what no train can do" "ATO 입력 이상" "inputs as bits, `AbsurdInputs`";
    TrainWithholds = 605 "train_withholds" Minor "-" "The train gives less than it was sent, as TCMS itself says" "차량 출력 부족" "speed less what effort should have made, cm/s";
    ModeChanged = 700 "mode_changed" Info "-" "Operating mode changed" "운전 모드 변경" "mode";
    AutomaticRefused = 701 "automatic_refused" Info "-" "Automatic mode or run refused" "자동운전 불허" "refusals as bits";
    ModeSwitchChatters = 702 "mode_switch_chatters" Minor "-" "The mode switch comes to rest at no position: mode off, emergency brake" "모드 스위치 접점 떨림: 운전 모드 차단, 비상제동" "";
    ReverserChatters = 703 "reverser_chatters" Minor "-" "The reverser comes to rest at no position: no way is permitted" "역전기 접점 떨림: 이동 불허" "";
    InverterFailed = 800 "inverter_failed" Major "inverter" "TCMS: inverter does not answer" "추진장치 고장" "car";
    BrakeUnitFailed = 801 "brake_unit_failed" Major "brake_unit" "TCMS: brake control unit does not answer" "제동장치 고장" "car";
    BrakeCylinderFailed = 802 "brake_cylinder_failed" Major "brake_cylinder" "TCMS: brake cylinders do not follow the demand" "제동실린더 압력 이상" "car";
    RegenerationCutOut = 803 "regeneration_cut_out" Minor "inverter" "TCMS: inverter cut its electric brake out" "회생제동 차단" "car; 0 = all, the line takes nothing";
    BrakeNotReleased = 804 "brake_not_released" Major "brake_cylinder" "TCMS: brake not released" "제동불완해" "car";
    ControllerFailed = 805 "controller_failed" Major "master_controller" "TCMS: master controller value in its failure range" "주간제어기 고장" "mV";
    ControllerContradicts = 806 "controller_contradicts" Minor "master_controller" "TCMS: power and brake contacts both on" "역행/제동 동시 입력" "";
    TwoCabsActive = 807 "two_cabs_active" Critical "head_control_relay" "TCMS: two head control relays energised" "전두계전기 중복" "";
    AtoOrderContradicts = 808 "ato_order_contradicts" Minor "ato_cpu" "TCMS: power, brake and effort of ATO contradict each other" "ATO 지령 모순" "effort";
    AtcSilent = 809 "atc_silent" Major "rs485_link" "TCMS: no frames from the unit" "ATC 통신 두절" "";
    AtcRestored = 810 "atc_restored" Info "-" "TCMS: frames from the unit again" "ATC 통신 복귀" "";
    AtcFramesRefused = 811 "atc_frames_refused" Minor "rs485_link" "TCMS: frames of the unit refused" "ATC 수신 전문 폐기" "how many so far";
    MainReservoirLow = 812 "main_reservoir_low" Major "air_supply" "TCMS: main reservoir pressure low" "주공기압 저하" "";
    DeadMan = 813 "dead_man" Info "-" "TCMS: dead man released too long" "데드맨 동작" "";
}

/// Parameter of [`Event::TcmsLost`] when frames still come and their alive counter stands.
pub const COUNTER_STANDS: i32 = 1;

/// Parameter of [`Event::CabsNotChanged`] when TCMS reads the relay as dropped.
pub const RELAY_DROPPED: i32 = 1;

/// Parameter of [`Event::RegenerationCutOut`] when all inverters cut out together.
pub const ALL_CARS: i32 = 0;

impl Event {
    /// The part under suspicion, given the event's parameter.
    pub fn suspect(self, parameter: i32) -> Option<LruId> {
        let named = match self {
            Self::SelfTestFailed => {
                let failed = SelfTest::from_bits_retain(parameter as u16);
                let parts = [
                    (SelfTest::ATP_RECEIVER, "atp_receiver"),
                    (SelfTest::TRA, "tra"),
                    (SelfTest::TWC_MODEM, "fsk_board"),
                    (SelfTest::TWC_CPU, "twc_cpu"),
                    (SelfTest::TCMS_LINK, "rs485_link"),
                    (SelfTest::TEST_BOARD, "test_board"),
                    (SelfTest::EB_RELAY, "eb_relay"),
                    (SelfTest::MEMORY.union(SelfTest::CONFIGURATION), "atp_cpu"),
                    (SelfTest::TRACK_DATABASE, "ato_cpu"),
                ];
                let part = parts.iter().find(|(items, _)| failed.intersects(*items));
                part.map(|(_, part)| *part)
            }
            // The parameter is the channel that loses frames.
            Self::FramesRejected if parameter == i32::from(Channel::Twc.code()) => {
                Some("fsk_board")
            }
            Self::AtoFailed if parameter == i32::from(AtoFailure::Tra.code()) => Some("tra"),
            Self::AtoFailed
                if parameter == i32::from(AtoFailure::Tachometers.code())
                    || parameter == i32::from(AtoFailure::Inputs.code())
                    || parameter == i32::from(AtoFailure::TrainWithholds.code()) =>
            {
                return None;
            }
            // The relay dropped, and the unit does not see it.
            Self::CabsNotChanged if parameter == RELAY_DROPPED => Some("io_board"),
            // The contact line takes no power: no inverter is at fault.
            Self::RegenerationCutOut if parameter == ALL_CARS => return None,
            // Frames arrive, and their counter stands: TCMS, which makes the frames, is at fault.
            Self::TcmsLost if parameter == COUNTER_STANDS => Some("tcms"),
            Self::FramesRejected if parameter != i32::from(Channel::Tcms.code()) => {
                Some("io_board")
            }
            _ => None,
        };
        named.map_or_else(|| self.definition().lru.clone(), LruId::listed)
    }

    /// Whether TCMS logs the event, and not the unit.
    pub const fn by_tcms(self) -> bool {
        self.definition().code / 100 == 8
    }

    /// Whether the unit logs the event because a failed part of it made the unit restart.
    pub const fn restarts_unit(self) -> bool {
        matches!(self, Self::SupplyDip)
    }

    /// Whether the event is about the train's own equipment, which stays broken whatever is tested next; what TCMS logs
    /// about the unit and the link to it is not.
    pub const fn about_train(self) -> bool {
        matches!(
            self,
            Self::InverterFailed
                | Self::BrakeUnitFailed
                | Self::BrakeCylinderFailed
                | Self::RegenerationCutOut
                | Self::BrakeNotReleased
                | Self::ControllerFailed
                | Self::ControllerContradicts
                | Self::TwoCabsActive
                | Self::MainReservoirLow
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_lead_back_to_events_and_rise() {
        for pair in Event::ALL.windows(2) {
            assert!(pair[0].definition().code < pair[1].definition().code);
        }
        for &event in Event::ALL {
            assert_eq!(Event::from_code(event.definition().code), Some(event));
            assert_eq!(Event::from_name(event.definition().name), Some(event));
        }
    }
}
