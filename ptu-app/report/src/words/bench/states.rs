//! Names of the states and the bits of signals.

use protocol::message::SelfTest;
use protocol::signal::Signal;

use super::Bench;

impl Bench {
    /// Names of a signal's states by their numbers; empty for a signal without states.
    pub fn states(&self, signal: Signal) -> Vec<&'static str> {
        match signal {
            Signal::Eb
            | Signal::Fsb
            | Signal::HoldingBrake
            | Signal::EbLoop
            | Signal::TcmsFsb
            | Signal::TcmsMsb
            | Signal::TcmsHolding
            | Signal::AskedEb
            | Signal::AskedFsb
            | Signal::TcmsBraking
            | Signal::TcmsLineOpen => vec![self.released, self.applied],
            Signal::Doors | Signal::TcmsDoors => vec![self.doors_open, self.doors_closed],
            Signal::DoorsLeft | Signal::DoorsRight => {
                vec![self.doors_open, self.doors_unlocked, self.doors_closed]
            }
            Signal::Marker | Signal::MarkerCoil => vec![self.none, "PSM1", "PSM2", "PSM3", "PSM4"],
            Signal::Wayside => vec![self.silent, self.good, self.wayside_corrupt],
            Signal::Tacho1 | Signal::Tacho2 => {
                vec![
                    self.good,
                    self.tacho_dead,
                    self.tacho_noisy,
                    self.tacho_scaled,
                    self.tacho_reversed,
                ]
            }
            Signal::WaysideDoorSide => {
                vec![self.none, self.side_left, self.side_right, self.side_both]
            }
            Signal::WaysideMode => vec![
                self.running_normal,
                self.running_recovery,
                self.running_slow,
            ],
            Signal::WaysideOrder => vec![
                self.none,
                self.order_turn_back,
                self.order_put_away,
                self.order_wake_up,
            ],
            Signal::NumberState => vec![
                self.number_configured,
                self.number_keyed,
                self.number_confirmed,
            ],
            Signal::OrderState => vec![
                self.none,
                self.order_turning_back,
                self.order_handed_over,
                self.order_taking_over,
                self.order_is_put_away,
                self.order_waking,
                self.order_ready,
                self.order_failed,
            ],
            Signal::AtoState => {
                vec![
                    self.ato_inspection,
                    self.ato_stop,
                    self.ato_start,
                    self.ato_run,
                ]
            }
            Signal::Mode | Signal::AskedMode | Signal::TrainMode => vec![
                self.mode_off,
                self.mode_yard,
                self.mode_manual,
                self.mode_automatic,
                self.mode_automatic_run,
                self.mode_emergency,
            ],
            Signal::ModeSwitch => vec![
                self.mode_off,
                self.mode_yard,
                self.mode_manual,
                self.mode_automatic,
                self.mode_driverless,
                self.mode_emergency,
            ],
            Signal::TcmsMode => vec![
                self.none,
                self.mode_emergency,
                self.mode_yard,
                self.mode_manual,
                self.mode_automatic,
                self.mode_driverless,
            ],
            Signal::EbCause => vec![
                self.none,
                self.eb_not_released,
                self.overspeed,
                self.eb_ineffective,
                self.eb_tachometer,
                self.eb_rollback,
                self.eb_door,
                self.eb_inputs,
                self.eb_self_test,
                self.eb_internal,
                self.test_mode,
                self.eb_jog,
                self.eb_line_opened,
            ],
            Signal::FsbCause => vec![
                self.none,
                self.overspeed,
                self.no_code,
                self.fsb_twc,
                self.fsb_tcms,
                self.fsb_ato,
                self.fsb_not_permitted,
                self.test_mode,
                self.fsb_stop_code,
                self.fsb_door,
                self.fsb_jog,
                self.fsb_eb_failed,
            ],
            Signal::IdentitySerial
            | Signal::IdentitySoftware
            | Signal::IdentityConfig
            | Signal::IdentityLine => vec![self.differs, self.same, self.not_stated],
            Signal::ArmRefusal => vec![
                self.none,
                self.arm_key_off,
                self.refused_moving,
                self.arm_bad_answer,
                self.arm_busy,
                self.arm_tester_silent,
                self.arm_disarmed,
                self.arm_starting_up,
                self.arm_brakes_released,
                self.arm_train_moved,
                self.arm_code_changed,
                self.arm_mode_changed,
                self.arm_doors_open,
            ],
            _ => Vec::new(),
        }
    }

    /// Name of a measurement of the unit's self-test; `None` for any other.
    pub fn self_test_item(&self, measurement: &str) -> Option<String> {
        let item = measurement.strip_prefix("self_test.")?;
        let mut known = SelfTest::SPEC.entries.iter();
        let bit = known.find(|entry| entry.1.eq_ignore_ascii_case(item))?.0;
        let item = *self.bits(Signal::SelfTest).get(usize::from(bit))?;
        Some(format!("{}: {item}", self.self_test))
    }

    /// Names of a signal's bits, bit 0 first; empty for a signal whose bits have no names here.
    pub fn bits(&self, signal: Signal) -> Vec<&'static str> {
        match signal {
            Signal::PowerCutCauses => vec![
                self.cause_doors,
                self.hcr,
                self.cause_reverser,
                self.cause_emergency,
                self.cause_full_service,
                self.cause_atc,
                self.cause_atc_silent,
                self.cause_holding,
                self.security_brake,
                self.parking_brake,
                self.cause_not_released,
                self.main_reservoir_low,
                self.cause_mode,
                self.turn_back,
            ],
            Signal::EbSources => vec![
                self.controller,
                self.button_1,
                self.button_2,
                self.cause_atc,
                self.main_reservoir_low,
                self.hcr,
            ],
            Signal::Lamps => vec![
                self.cause_emergency,
                self.eb_cut_out,
                self.security_brake,
                self.parking_brake,
                self.forced_release,
                self.cause_not_released,
                self.cause_failure,
            ],
            Signal::Refusals => vec![
                self.refused_moving,
                self.cause_doors,
                self.refused_no_twc,
                self.refused_station,
                self.no_code,
                self.hcr,
                self.refused_mode_switch,
                self.refused_controller,
                self.refused_eb,
                self.refused_tcms,
                self.refused_ato,
                self.item_tra,
                self.self_test,
                self.refused_departure,
                self.refused_doors,
                self.refused_ordered,
            ],
            Signal::SelfTest => vec![
                self.item_memory,
                self.item_configuration,
                self.item_track_database,
                self.item_eb_relay,
                self.item_atp_receiver,
                self.item_tra,
                self.item_twc_modem,
                self.item_test_board,
                self.item_twc_cpu,
                self.item_tcms_link,
            ],
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use btu_rig::tcms::{EbSources, Lamps, PowerCuts};
    use protocol::signal::Kind;

    use super::*;

    /// Goal: no state and no bit is without its word. Method: counts against the catalogue of signals and
    /// of TCMS's causes, in both languages.
    #[test]
    fn every_state_and_every_bit_has_a_text() {
        for words in [&Bench::ENGLISH, &Bench::KOREAN] {
            for &signal in Signal::ALL {
                if let Kind::Enum(labels) = signal.definition().kind {
                    assert_eq!(words.states(signal).len(), labels.len(), "{signal:?}");
                } else {
                    assert!(words.states(signal).is_empty(), "{signal:?}");
                }
            }
            for (signal, count) in [
                (Signal::PowerCutCauses, PowerCuts::all().iter().count()),
                (Signal::EbSources, EbSources::all().iter().count()),
                (Signal::Lamps, Lamps::all().iter().count()),
                (Signal::Refusals, 16),
                (Signal::SelfTest, SelfTest::SPEC.entries.len()),
            ] {
                assert_eq!(words.bits(signal).len(), count, "{signal:?}");
            }
        }
    }
}
