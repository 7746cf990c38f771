//! I/O channel: what the bench harness carries, once per 10 ms scan each way.

use super::enums::{Coil, ModeSwitch};
use alloc::string::String;
use alloc::vec::Vec;

use super::layout::{Cursor, DecodeError, Field, layout, wire_bits};

wire_bits! {
    /// Train lines and cab contacts; a set bit is an energised line.
    TrainLines {
        /// All doors proved closed.
        DOORS_CLOSED = 0,
        /// Head control relay: this cab is active.
        HCR = 1,
        /// Maintenance key on.
        MAINTENANCE_KEY = 2,
        /// Acknowledge button pressed.
        ACKNOWLEDGE = 3,
        /// ATO start button pressed.
        START = 4,
        /// Emergency brake train line energised (brake released), read back from the train.
        EB_LOOP = 5,
        /// Reverser forward.
        FORWARD = 6,
        /// Reverser backward.
        BACKWARD = 7,
        /// The emergency brake train line is fed as far as the unit's own relay contact: nothing else
        /// on the train opens it.
        EB_LOOP_FED = 8,
        /// The four lines below show the doors of each side; without this bit `DOORS_CLOSED` shows both sides.
        DOORS_BY_SIDE = 9,
        /// Doors on the left closed.
        LEFT_CLOSED = 10,
        /// Doors on the left locked.
        LEFT_LOCKED = 11,
        /// Doors on the right closed.
        RIGHT_CLOSED = 12,
        /// Doors on the right locked.
        RIGHT_LOCKED = 13,
    }
}

wire_bits! {
    /// Output contacts of the unit.
    Outputs {
        /// EB relay energised: emergency brake released. De-energised = braking.
        EB_RELAY = 0,
        /// Full service brake requested.
        FSB = 1,
        /// Powering cut.
        POWER_CUT = 2,
        /// Overspeed alarm sounding.
        ALARM = 3,
        /// Holding brake requested.
        HOLDING_BRAKE = 4,
        /// Doors enabled on the left.
        DOOR_ENABLE_LEFT = 5,
        /// Doors enabled on the right.
        DOOR_ENABLE_RIGHT = 6,
        /// A valid speed code is being received.
        CODE_VALID = 7,
        /// Standstill detected.
        STANDSTILL = 8,
        /// Unit healthy.
        HEALTHY = 9,
        /// Doors on the left ordered to open, in series with their enable.
        OPEN_LEFT = 10,
        /// Doors on the right ordered to open, in series with their enable.
        OPEN_RIGHT = 11,
        /// All doors ordered to close.
        CLOSE_DOORS = 12,
    }
}

layout! {
    /// Inputs of the unit at the frame's time stamp.
    IoInput, Io, 0x01 {
        /// Carrier in the ATP antenna, Hz; 0 = none.
        carrier_hz: u16,
        /// Code rate modulating the carrier, 0.01 Hz; 0 = unmodulated.
        code_rate_chz: u16,
        /// Antenna signal level, mV.
        level_mv: u16,
        /// Pulses counted on tachometer 1, wrapping.
        tacho1_count: u16,
        /// Age of tachometer 1's last pulse at the time stamp, µs, at most 65535.
        tacho1_edge_us: u16,
        /// Pulses counted on tachometer 2, wrapping.
        tacho2_count: u16,
        /// Age of tachometer 2's last pulse at the time stamp, µs, at most 65535.
        tacho2_edge_us: u16,
        /// Phase of the tachometers: bit 0 set = channel 1 runs backward, bit 1 = channel 2.
        tacho_backward: u8,
        /// Marker whose coil was entered last, 1 to 4 = PSM1 to PSM4; 0 = none yet.
        marker: u8,
        /// Markers entered so far, wrapping.
        marker_edges: u8,
        /// Age of the last marker edge at the time stamp, µs, at most 65535.
        marker_edge_us: u16,
        /// Train lines.
        lines: TrainLines,
        /// Mode switch.
        mode_switch: ModeSwitch,
        /// Master controller: -8 emergency, -7 to -1 brake notches, 0 neutral, 1 to 4 power.
        controller: i8,
    }
}

layout! {
    /// Train number that is keyed in at the cab; sent while it is keyed in.
    CabEntries, Io, 0x02 {
        /// Train number; 0 = that of the unit configuration.
        train_number: u16,
    }
}

layout! {
    /// Wheel diameter that is keyed in at the cab; sent while it is keyed in.
    WheelEntry, Io, 0x04 {
        /// Diameter, 0.1 mm; 0 = that of the unit configuration.
        diameter_01mm: u16,
    }
}

layout! {
    /// A second code in the ATP antenna, of a neighbouring track circuit; sent while it is there.
    Crosstalk, Io, 0x03 {
        /// Carrier, Hz.
        carrier_hz: u16,
        /// Code rate, 0.01 Hz; 0 = unmodulated.
        code_rate_chz: u16,
        /// Level, mV; 0 = the second code has gone.
        level_mv: u16,
    }
}

/// Samples of one [`CoilSamples`].
pub const COIL_PART: usize = 96;
/// Parts of a scan.
pub const COIL_PARTS: usize = 5;
/// Samples of a coil in a scan.
pub const COIL_SAMPLES: usize = COIL_PART * COIL_PARTS;
/// Samples of a coil in a second.
pub const COIL_SAMPLE_HZ: u32 = 48_000;
/// Voltage of one step of a sample, mV: a coil takes up to 3.2 V.
pub const COIL_STEP_MV: f32 = 0.1;

/// The samples of a [`CoilSamples`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples(pub [i16; COIL_PART]);

/// Silence.
impl Default for Samples {
    fn default() -> Self {
        Self([0; COIL_PART])
    }
}

/// Big-endian, one sample after the other; shown as bytes.
impl Field for Samples {
    const SIZE: usize = 2 * COIL_PART;
    fn put(&self, out: &mut Vec<u8>) {
        for sample in self.0 {
            out.extend_from_slice(&sample.to_be_bytes());
        }
    }
    fn get(cursor: &mut Cursor<'_>, name: &'static str) -> Result<Self, DecodeError> {
        let bytes: [u8; Self::SIZE] = cursor.take(name)?;
        let mut samples = Self::default();
        for (sample, bytes) in samples.0.iter_mut().zip(bytes.as_chunks().0) {
            *sample = i16::from_be_bytes(*bytes);
        }
        Ok(samples)
    }
    fn show(&self) -> String {
        let mut bytes = Vec::with_capacity(Self::SIZE);
        self.put(&mut bytes);
        bytes
            .iter()
            .map(|byte| alloc::format!("{byte:02x}"))
            .collect()
    }
}

layout! {
    /// Samples of one coil; sent before the `IoInput` of the same scan, whose code, tachometers and marker are then
    /// ignored. A coil without samples is silent.
    CoilSamples, Io, 0x05 {
        /// Coil.
        coil: Coil,
        /// Part of the scan, 0 to 4.
        part: u8,
        /// 96 samples of 0.1 mV, i16 each.
        samples: Samples,
    }
}

layout! {
    /// Outputs of the unit after a scan.
    IoOutput, Io, 0x81 {
        /// Output contacts.
        outputs: Outputs,
        /// Speed limit on the cab display, cm/s.
        limit_cms: u16,
        /// Measured speed on the cab display, cm/s.
        speed_cms: u16,
        /// Last marker the unit detected, 1 to 4; 0 = none.
        marker: u8,
        /// Markers the unit detected so far, wrapping.
        marker_count: u8,
    }
}
