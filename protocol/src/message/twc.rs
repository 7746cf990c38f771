//! TWC channel: station and train data through the loop.

use super::enums::{DoorSide, Mode, RunningMode};
use super::layout::{layout, wire_bits};

wire_bits! {
    /// Train states in the answer.
    TwcTrainBits {
        /// Doors proved closed.
        DOORS_CLOSED = 0,
        /// Stopped at the stop point.
        ALIGNED = 1,
        /// The station data match the track database.
        STATION_VALID = 2,
        /// Standstill detected.
        STANDSTILL = 3,
    }
}

layout! {
    /// Station data, wayside → unit.
    TwcWayside, Twc, 0x01 {
        /// Route number.
        route: u16,
        /// Section number in the track database.
        section: u16,
        /// This station's number.
        station: u16,
        /// The next station's number.
        next_station: u16,
        /// Number of the loop the train stands on.
        loop_id: u16,
        /// Fixed speed ordered by the wayside, km/h; 255 = none.
        fixed_speed_kmh: u8,
        /// Running mode.
        running_mode: RunningMode,
        /// Side on which doors may open.
        door_side: DoorSide,
        /// Departure: 1 = given, 0 = held.
        departure: u8,
        /// Train number.
        train_number: u16,
    }
}

layout! {
    /// Train data in answer to each accepted `TwcWayside`, unit → wayside.
    TwcTrain, Twc, 0x81 {
        /// Sequence number of the frame answered.
        answered_seq: u16,
        /// Station number received.
        station: u16,
        /// Train number received.
        train_number: u16,
        /// Operating mode.
        mode: Mode,
        /// Train states.
        bits: TwcTrainBits,
        /// Measured speed, cm/s.
        speed_cms: u16,
    }
}
