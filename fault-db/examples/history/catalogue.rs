//! What can fail, how often, when, and what is really behind it. Numbers and names are those of the
//! unit's event dictionary; rates are made up.

/// When in the year something happens more often than else.
#[derive(Clone, Copy)]
pub enum Season {
    Any,
    /// Cold: air, doors, contacts.
    Winter,
    /// Heat: electronics.
    Summer,
    /// Leaves and rain: wheels slide.
    Autumn,
}

impl Season {
    /// How much more often, by the part of the year that is over.
    pub fn factor(self, of_year: f64) -> f64 {
        let peak = match self {
            Self::Any => return 1.0,
            Self::Winter => 0.04,
            Self::Summer => 0.58,
            Self::Autumn => 0.83,
        };
        1.0 + 0.7 * (std::f64::consts::TAU * (of_year - peak)).cos()
    }
}

/// One way to fail, as it is seen.
pub struct Kind {
    pub code: i64,
    pub name: &'static str,
    /// Part the event names.
    pub lru: &'static str,
    pub severity: &'static str,
    pub text: &'static str,
    /// How often, against the others.
    pub rate: f64,
    pub season: Season,
    /// The rate doubles in so many days without a repair; 0: it does not age.
    pub doubles_days: f64,
    /// How often it was nothing that lasts.
    pub passing: f64,
}

macro_rules! kinds {
    ($($code:literal $name:literal $lru:literal $severity:literal $text:literal
        $rate:literal $season:ident $doubles:literal $passing:literal;)*) => {
        pub const KINDS: &[Kind] = &[$(Kind {
            code: $code, name: $name, lru: $lru, severity: $severity, text: $text, rate: $rate,
            season: Season::$season, doubles_days: $doubles, passing: $passing,
        }),*];
    };
}

kinds! {
    101 "self_test_failed" "atp_receiver" "critical" "Start-up self-test failed" 0.9 Summer 400.0 0.2;
    101 "self_test_failed" "eb_relay" "critical" "Start-up self-test failed" 0.8 Winter 300.0 0.2;
    101 "self_test_failed" "fsk_board" "critical" "Start-up self-test failed" 0.5 Summer 0.0 0.3;
    101 "self_test_failed" "test_board" "critical" "Start-up self-test failed" 0.3 Any 0.0 0.5;
    101 "self_test_failed" "tra" "critical" "Start-up self-test failed" 0.4 Any 0.0 0.3;
    105 "internal_error" "atp_cpu" "critical" "Broken invariant on board" 0.05 Any 0.0 0.5;
    106 "supply_dip" "power_supply" "major" "Restarted after a dip of the supply voltage" 6.0 Summer 500.0 0.6;
    110 "inputs_lost" "io_board" "critical" "I/O inputs fell silent" 1.2 Summer 600.0 0.4;
    112 "frames_rejected" "rs485_link" "minor" "Many frames rejected on one channel" 12.0 Any 400.0 0.5;
    112 "frames_rejected" "fsk_board" "minor" "Many frames rejected on one channel" 9.0 Summer 500.0 0.5;
    112 "frames_rejected" "io_board" "minor" "Many frames rejected on one channel" 2.0 Any 0.0 0.5;
    201 "code_unknown" "atp_receiver" "minor" "Signal present but not in the code table" 18.0 Summer 500.0 0.5;
    212 "overspeed_eb" "unknown" "major" "Overspeed: emergency brake" 3.0 Autumn 0.0 0.8;
    213 "service_brake_ineffective" "fsb_output" "major" "Full service brake did not slow the train" 2.5 Autumn 700.0 0.4;
    220 "tacho_disagree" "unknown" "critical" "The two tachometers disagree" 8.0 Autumn 400.0 0.4;
    221 "tacho1_dead" "speed_sensor_1" "critical" "No pulses on tachometer 1 while 2 turns" 3.0 Winter 350.0 0.1;
    222 "tacho2_dead" "speed_sensor_2" "critical" "No pulses on tachometer 2 while 1 turns" 2.6 Winter 350.0 0.1;
    223 "tacho_direction" "unknown" "critical" "Tachometers differ in direction" 0.4 Any 0.0 0.3;
    224 "tacho1_noise" "speed_sensor_1" "major" "Speed from tachometer 1 jumps impossibly" 14.0 Autumn 300.0 0.2;
    225 "tacho2_noise" "speed_sensor_2" "major" "Speed from tachometer 2 jumps impossibly" 11.0 Autumn 300.0 0.2;
    226 "rollback" "unknown" "major" "Moving against the reverser" 1.0 Any 0.0 0.7;
    230 "eb_relay_welded" "eb_relay" "critical" "EB relay dropped but the brake line stays energised" 0.5 Any 250.0 0.0;
    231 "eb_relay_open" "eb_relay" "critical" "EB relay energised but the brake line stays dead" 1.5 Winter 250.0 0.1;
    240 "door_open_moving" "io_board" "critical" "Doors open while moving" 4.0 Winter 500.0 0.3;
    300 "marker_order" "marker_antenna" "minor" "Marker out of order" 5.0 Any 0.0 0.7;
    301 "marker_missing" "marker_antenna" "minor" "Marker missed" 30.0 Winter 400.0 0.5;
    302 "marker_position" "marker_antenna" "minor" "Marker away from its place" 20.0 Autumn 0.0 0.6;
    303 "tra_failed" "tra" "major" "TRA did not answer its test" 4.0 Summer 400.0 0.3;
    305 "wheel_diameter" "unknown" "major" "Way by wheels and way between markers differ" 7.0 Any 200.0 0.1;
    306 "position_unsure" "marker_antenna" "minor" "No marker where one must be: position unsure" 16.0 Winter 400.0 0.5;
    400 "twc_lost" "twc_cpu" "minor" "TWC communication lost" 40.0 Any 500.0 0.6;
    402 "twc_station_invalid" "twc_cpu" "minor" "Station data do not match the track database" 3.0 Any 0.0 0.7;
    500 "tcms_lost" "rs485_link" "major" "TCMS communication lost or stale" 10.0 Summer 450.0 0.4;
    500 "tcms_lost" "tcms" "major" "TCMS communication lost or stale" 3.0 Any 0.0 0.5;
    600 "ato_failed" "ato_cpu" "major" "ATO failed" 4.0 Summer 600.0 0.4;
    600 "ato_failed" "tra" "major" "ATO failed" 1.5 Any 0.0 0.4;
    600 "ato_failed" "unknown" "major" "ATO failed" 1.5 Any 0.0 0.5;
    601 "ato_not_following" "ato_cpu" "major" "The train does not do what ATO's effort asks" 9.0 Autumn 0.0 0.5;
    602 "stop_overrun" "ato_cpu" "major" "Passed the stop point" 13.0 Autumn 0.0 0.7;
    603 "stop_short" "ato_cpu" "minor" "Stopped short of the stop point" 24.0 Autumn 0.0 0.7;
    604 "ato_input_absurd" "unknown" "major" "ATO was given what no train can do" 0.6 Any 0.0 0.4;
    605 "train_withholds" "unknown" "minor" "The train gives less than it was sent, as TCMS itself says" 6.0 Winter 0.0 0.6;
    800 "inverter_failed" "inverter" "major" "TCMS: inverter does not answer" 3.0 Summer 700.0 0.2;
    801 "brake_unit_failed" "brake_unit" "major" "TCMS: brake control unit does not answer" 2.0 Winter 600.0 0.2;
    802 "brake_cylinder_failed" "brake_cylinder" "major" "TCMS: brake cylinders do not follow the demand" 2.4 Winter 350.0 0.2;
    803 "regeneration_cut_out" "inverter" "minor" "TCMS: inverter cut its electric brake out" 22.0 Summer 600.0 0.6;
    803 "regeneration_cut_out" "unknown" "minor" "TCMS: inverter cut its electric brake out" 10.0 Any 0.0 0.9;
    804 "brake_not_released" "brake_cylinder" "major" "TCMS: brake not released" 5.0 Winter 350.0 0.3;
    805 "controller_failed" "master_controller" "major" "TCMS: master controller value in its failure range" 1.6 Any 300.0 0.2;
    806 "controller_contradicts" "master_controller" "minor" "TCMS: power and brake contacts both on" 3.4 Winter 300.0 0.4;
    807 "two_cabs_active" "head_control_relay" "critical" "TCMS: two head control relays energised" 0.3 Winter 0.0 0.2;
    808 "ato_order_contradicts" "ato_cpu" "minor" "TCMS: power, brake and effort of ATO contradict each other" 2.0 Any 0.0 0.6;
    809 "atc_silent" "rs485_link" "major" "TCMS: no frames from the unit" 3.0 Summer 450.0 0.3;
    811 "atc_frames_refused" "rs485_link" "minor" "TCMS: frames of the unit refused" 8.0 Any 400.0 0.5;
    812 "main_reservoir_low" "air_supply" "major" "TCMS: main reservoir pressure low" 5.0 Winter 400.0 0.3;
    9000 "check_failed" "atp_antenna" "major" "atp/limit_speed, weak signal just above the threshold: code level too low" 1.5 Winter 400.0 0.2;
    9000 "check_failed" "atp_receiver" "major" "atp/limit_speed, decoded too late" 1.0 Summer 500.0 0.2;
    9000 "check_failed" "brake_cylinder" "major" "tcms/not_released, air stays in a cylinder" 0.6 Winter 350.0 0.1;
    9000 "check_failed" "door_contact" "major" "door/interlocks, departure not free" 2.0 Winter 250.0 0.3;
    9000 "check_failed" "eb_relay" "major" "atp/overspeed, EB came too late" 0.8 Any 250.0 0.0;
    9000 "check_failed" "fsb_output" "major" "atp/overspeed, FSB came too late" 0.7 Any 500.0 0.1;
    9000 "check_failed" "fsk_board" "major" "twc/exchange, no answer" 0.8 Summer 500.0 0.3;
    9000 "check_failed" "head_control_relay" "major" "tcms/driving_control, no cab counts" 0.5 Winter 300.0 0.2;
    9000 "check_failed" "io_board" "major" "atp/power_up, mode switch not seen" 0.5 Any 0.0 0.4;
    9000 "check_failed" "marker_antenna" "major" "ato/markers, not detected" 1.0 Winter 400.0 0.2;
    9000 "check_failed" "rs485_link" "major" "tcms/link, recovery too late" 0.7 Any 400.0 0.3;
    9000 "check_failed" "test_board" "minor" "ptu/limit_speed, test code not measured" 0.4 Any 0.0 0.4;
    9000 "check_failed" "twc_antenna" "major" "twc/exchange, loop not heard" 1.2 Winter 400.0 0.2;
    9001 "eb_unrequested" "unknown" "critical" "emergency brake applied in a step that did not ask for it" 0.8 Any 0.0 0.5;
}

/// The kind of a check that failed on a part.
pub fn failed_check(lru: &str) -> usize {
    let found = KINDS
        .iter()
        .position(|kind| kind.code == 9000 && kind.lru == lru);
    found.expect("every part that is measured has a check that can fail")
}

/// Parts that are behind it when it is not the one the event names.
pub fn others(lru: &str) -> &'static [&'static str] {
    match lru {
        "atp_receiver" => &["atp_antenna"],
        "atp_antenna" => &["atp_receiver"],
        "twc_cpu" => &["twc_antenna", "fsk_board"],
        "fsk_board" => &["twc_antenna", "twc_cpu"],
        "eb_relay" => &["io_board", "power_supply"],
        "io_board" => &["door_contact", "power_supply"],
        "rs485_link" => &["tcms", "power_supply"],
        "ato_cpu" => &["speed_sensor_1", "tra", "brake_unit"],
        "marker_antenna" => &["tra"],
        "tra" => &["marker_antenna", "power_supply"],
        "brake_cylinder" => &["brake_unit", "air_supply"],
        "brake_unit" => &["brake_cylinder", "tcms"],
        "inverter" => &["tcms", "power_supply"],
        "fsb_output" => &["brake_unit", "eb_relay"],
        "unknown" => &["speed_sensor_1", "speed_sensor_2", "ato_cpu", "atp_cpu"],
        _ => &["power_supply", "io_board"],
    }
}
