//! PTU stimuli as requests to the unit's TEST board: from typed values to what the wire carries.

use protocol::Speed;
use protocol::message::{
    ClearLog, Message, RunSelfTest, TestCode, TestMarker, TestRelease, TestSignals, TestSpeed,
    TestTwc,
};

use crate::procedure::Refusal;
use crate::stimulus::{CodeSignal, StationData};

use super::request::Request;
use crate::rig::wayside::wire_data;
use crate::stimulus::ranges::{U16_MAX, in_range};

/// Signal into the ATP test coil.
///
/// # Errors
/// A value the wire cannot carry. What the TEST board cannot make, the unit refuses.
pub fn code(session: u32, signal: CodeSignal) -> Result<Request, Refusal> {
    let carrier_hz = in_range("test carrier", signal.carrier_hz, 0.0, U16_MAX, "Hz")?;
    let rate_hz = in_range("test code rate", signal.rate_hz, 0.0, U16_MAX / 100.0, "Hz")?;
    let level_mv = in_range("test level", signal.level_mv, 0.0, U16_MAX, "mV")?;
    let message = TestCode {
        session,
        carrier_hz: carrier_hz.round() as u16,
        code_rate_chz: (rate_hz * 100.0).round() as u16,
        level_mv: level_mv.round() as u16,
    };
    Ok(repeatable("the test code", message))
}

/// Speed signal in place of the tachometers.
///
/// # Errors
/// As for [`code`].
pub fn speed(
    session: u32,
    channels: u8,
    backward: bool,
    to: Speed,
    accel_mps2: f64,
) -> Result<Request, Refusal> {
    in_range(
        "test speed",
        to.kmh(),
        0.0,
        Speed::from_cms(u16::MAX).kmh(),
        "km/h",
    )?;
    let accel = in_range(
        "test acceleration",
        accel_mps2,
        0.0,
        U16_MAX / 1000.0,
        "m/s²",
    )?;
    let message = TestSpeed {
        session,
        channels,
        backward: u8::from(backward),
        speed_cms: to.to_cms(),
        accel_mms2: (accel * 1000.0).round() as u16,
    };
    Ok(repeatable("the test speed", message))
}

/// One pulse of the test marker. It is sent once: a second one would be a second marker.
pub fn marker(session: u32, psm: u8) -> Request {
    Request::Stimulus {
        message: TestMarker {
            session,
            marker: psm,
        }
        .into(),
        what: "the test marker",
        repeatable: false,
    }
}

/// Station data from the TEST modem into the TWC antenna; `train` is the number of the train.
pub fn station(session: u32, data: &StationData, train: u16) -> Request {
    let data = wire_data(data, train);
    let message = TestTwc {
        session,
        route: data.route,
        section: data.section,
        station: data.station,
        next_station: data.next_station,
        loop_id: data.loop_id,
        fixed_speed_kmh: data.fixed_speed_kmh,
        running_mode: data.running_mode,
        door_side: data.door_side,
        departure: data.departure,
        train_number: data.train_number,
    };
    repeatable("the test station data", message)
}

pub fn release(session: u32) -> Request {
    repeatable(
        "the release of test signals",
        TestRelease {
            session,
            signals: TestSignals::all(),
        },
    )
}

/// Asks the unit to test itself; when asked again during the test, the unit goes on with it.
pub fn self_test(session: u32) -> Request {
    repeatable("the request for a self-test", RunSelfTest { session })
}

/// Clears the unit's event log.
pub fn clear_log(session: u32) -> Request {
    repeatable("the request to clear the log", ClearLog { session })
}

fn repeatable(what: &'static str, message: impl Into<Message>) -> Request {
    Request::Stimulus {
        message: message.into(),
        what,
        repeatable: true,
    }
}
