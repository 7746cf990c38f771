//! Serialisation of wire enumerations and quantities in recordings.

use serde::{Deserialize, Deserializer, Serializer};

/// A speed, m/s.
pub mod mps {
    use protocol::Speed;

    use super::*;

    pub fn serialize<S: Serializer>(speed: &Speed, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_f64(speed.mps())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Speed, D::Error> {
        f64::deserialize(from).map(Speed::from_mps)
    }
}

/// Stores a wire enumeration by its number, so that a value without a name in this version is kept, too.
macro_rules! by_code {
    ($($name:ident: $word:ident),* $(,)?) => { $(
        #[doc = concat!("[`protocol::message::", stringify!($word), "`] by its number.")]
        pub mod $name {
            use protocol::message::$word;

            use super::*;

            pub fn serialize<S: Serializer>(word: &$word, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_u8(word.code())
            }

            pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<$word, D::Error> {
                u8::deserialize(from).map($word::from_code)
            }
        }
    )* };
}

by_code! {
    mode_switch: ModeSwitch,
    running_mode: RunningMode,
    door_side: DoorSide,
    train_order: TrainOrder,
}
