//! The position of each signal on the path from the unit's inputs to the motion of the train.
//!
//! Two signals that deviate from what is expected within one report of the unit are listed in this order,
//! because each is sent at its own time.

/// Signals from the inputs of the unit over its decisions to its outputs, then TCMS, then the train.
const PATH: [&str; 120] = [
    // What the rig gives.
    "carrier_hz",
    "code_rate_hz",
    "level_mv",
    "crosstalk_mv",
    "tacho1",
    "tacho2",
    "marker_coil",
    "wayside",
    "wayside_station",
    "wayside_loop",
    "wayside_door_side",
    "wayside_running_mode",
    "wayside_order",
    "departure",
    "doors",
    "doors_left",
    "doors_right",
    "hcr",
    "maintenance_key",
    "mode_switch",
    "controller_volts",
    "controller",
    "tcms_alive",
    // What the unit's boards make of it.
    "self_test",
    "armed",
    "test_carrier",
    "test_code_rate",
    "test_level",
    "test_speed",
    "test_pulses",
    "test_markers",
    "rejected_frames",
    "speed1",
    "speed2",
    "code_index",
    "code_valid",
    "tra_ok",
    "marker",
    "marker_count",
    "marker_at",
    "twc_received",
    "tcms_ok",
    "twc_ok",
    "twc_station",
    "twc_section",
    "twc_loop",
    "twc_train",
    // What it holds for true.
    "limit",
    "speed",
    "standstill",
    "train_speed1",
    "train_speed2",
    "wheel_correction",
    "position",
    "station_valid",
    "aligned",
    "ato_ready",
    "started",
    // What it decides.
    "mode",
    "ato_state",
    "target",
    "effort",
    "power",
    "brake",
    "alarm",
    "power_cut",
    "fsb_cause",
    "fsb",
    "eb_cause",
    "eb",
    "refusals",
    "healthy",
    "holding_brake",
    "door_enable_left",
    "door_enable_right",
    "door_order_left",
    "door_order_right",
    "door_order_close",
    "asked_mode",
    "asked_effort",
    "asked_power",
    "asked_alarm",
    "asked_power_cut",
    "asked_fsb",
    "asked_eb",
    "asked_door_left",
    "asked_door_right",
    "asked_door_close",
    "train_mode",
    "twc_answer_station",
    "twc_answer_train",
    "twc_answers",
    "twc_sent",
    "test_answers",
    "test_answer_station",
    "test_answer_train",
    "own_train",
    "number_state",
    "destination",
    "order_state",
    "twc_heard",
    "twc_refused",
    "twc_others",
    // What TCMS makes of that.
    "tcms_hears",
    "tcms_mode",
    "eb_sources",
    "eb_loop",
    "power_cut_causes",
    "tcms_fsb",
    "tcms_msb",
    "tcms_power",
    "tcms_brake",
    "tcms_coast",
    "tcms_braking",
    "tcms_eb",
    "tcms_given",
    "tcms_load",
    "tcms_tells_lines",
    "tcms_doors",
    "tcms_hcr",
];

/// Rows within which the unit has reported everything once.
pub const REPORT_ROWS: usize = 2;

/// Left out of every comparison: the number of log entries says nothing that the events themselves, named
/// by name, do not; and what the unit's identity is compared with is the tester's, not the unit's.
pub const LEFT_OUT: [&str; 6] = [
    "events",
    "orders_answered",
    "identity_serial",
    "identity_software",
    "identity_config",
    "identity_line",
];

/// Told when they deviate, but never links of a chain: bulk of the train's equipment, and what only
/// follows from it.
const BESIDE: [&str; 7] = [
    "lamps",
    "train_accel",
    "train_jerk",
    "train_position",
    "to_stop",
    "twc_answers",
    "marker_count",
];

/// Signals that are the brake.
const BRAKES: [&str; 4] = ["eb", "fsb", "tcms_fsb", "eb_loop"];

/// Its place on the way; what is not named is the train's, at the end.
pub fn place(signal: &str) -> usize {
    PATH.iter()
        .position(|name| *name == signal)
        .unwrap_or(PATH.len())
}

/// A deviation of it is a link of a chain.
pub fn is_link(signal: &str) -> bool {
    let bulk = ["motor_", "air_"]
        .iter()
        .any(|kind| signal.starts_with(kind));
    !bulk && !BESIDE.contains(&signal)
}

/// It is a brake, which a chain ends with.
pub fn is_brake(signal: &str) -> bool {
    BRAKES.contains(&signal)
}

#[cfg(test)]
mod tests {
    use protocol::signal::{Origin, Signal};

    use super::*;

    #[test]
    fn every_signal_of_the_unit_has_a_position_on_the_path() {
        for name in PATH.iter().chain(&LEFT_OUT).chain(&BESIDE).chain(&BRAKES) {
            assert!(Signal::from_name(name).is_some(), "{name}");
        }
        for signal in Signal::ALL {
            let named = PATH.contains(&signal.name()) || LEFT_OUT.contains(&signal.name());
            let of_unit = signal.definition().origin == Origin::Unit;
            assert!(named || !of_unit, "{}", signal.name());
        }
    }
}
