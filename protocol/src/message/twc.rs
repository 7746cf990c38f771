//! TWC channel: station and train data through the loop.

use super::enums::{DoorSide, Mode, NumberState, OrderState, RunningMode, TrainOrder};
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
    /// Station data.
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
    /// Train data in answer to each accepted `TwcWayside`.
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

layout! {
    /// Orders for a train. A wayside that knows them sends them beside `TwcWayside`.
    TwcOrders, Twc, 0x02 {
        /// Train number.
        train_number: u16,
        /// Number, in the track database, of the section whose length follows; 0 = no length is told.
        section: u16,
        /// Length of that section, 0.1 m.
        section_length_dm: u32,
        /// Station at which the train's run ends; 0 = none.
        destination: u16,
        /// Order to the train, other than to run.
        order: TrainOrder,
    }
}

layout! {
    /// State of the train's orders, in answer to each accepted `TwcOrders`.
    TwcReport, Twc, 0x82 {
        /// Sequence number of the frame answered.
        answered_seq: u16,
        /// The unit's own train number; 0 = none.
        train_number: u16,
        /// Where that number is from.
        number_state: NumberState,
        /// Destination in force; 0 = none.
        destination: u16,
        /// State of the last order.
        order_state: OrderState,
        /// TWC frames for this train since power-up, with the refused ones, wrapping.
        received: u16,
        /// TWC frames for this train that contradict the track database, wrapping.
        refused: u16,
        /// TWC frames for other trains since power-up, wrapping.
        others: u16,
    }
}
