//! Who the unit says it is, against what the train's record says it should be.

use protocol::message::Identity;
use protocol::signal::{Sample, Signal};

/// What is known of the unit that should be there; `None` = not stated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExpectedIdentity {
    /// Serial number.
    pub serial: Option<String>,
    /// Software version: major, minor, patch.
    pub software: Option<[u8; 3]>,
    /// Name and CRC-32 of the unit configuration.
    pub config: Option<(String, u32)>,
    /// CRC-32 of the track database.
    pub tdb_crc: Option<u32>,
}

impl ExpectedIdentity {
    /// Sets what a comparison came to, once the unit has said who it is.
    pub(super) fn compare(&self, identity: Option<&Identity>, sample: &mut Sample) {
        let text = |field: [u8; 16]| {
            let end = field.iter().position(|byte| *byte == 0).unwrap_or(16);
            String::from_utf8_lossy(field.get(..end).unwrap_or_default()).into_owned()
        };
        let outcome = |same: Option<bool>| same.map_or(2.0, |same| f64::from(u8::from(same)));
        let Some(identity) = identity else {
            let compared = [
                Signal::IdentitySerial,
                Signal::IdentitySoftware,
                Signal::IdentityConfig,
                Signal::IdentityLine,
            ];
            return compared
                .into_iter()
                .for_each(|signal| sample.forget(signal));
        };
        let serial = self
            .serial
            .as_ref()
            .map(|serial| *serial == text(identity.serial));
        let software = self.software.map(|software| software == identity.software);
        let config = self
            .config
            .as_ref()
            .map(|(name, crc)| *name == text(identity.config) && *crc == identity.config_crc);
        let line = self.tdb_crc.map(|crc| crc == identity.tdb_crc);
        for (signal, same) in [
            (Signal::IdentitySerial, serial),
            (Signal::IdentitySoftware, software),
            (Signal::IdentityConfig, config),
            (Signal::IdentityLine, line),
        ] {
            sample.set(signal, outcome(same));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_compared_with_what_is_stated() {
        let mut identity = Identity {
            software: [0, 1, 0],
            tdb_crc: 7,
            ..Identity::default()
        };
        identity.serial[..4].copy_from_slice(b"SG-1");
        let expected = ExpectedIdentity {
            serial: Some("SG-1".into()),
            software: Some([0, 2, 0]),
            config: None,
            tdb_crc: Some(7),
        };
        let mut sample = Sample::default();
        expected.compare(None, &mut sample);
        assert_eq!(sample.get(Signal::IdentitySerial), None);
        expected.compare(Some(&identity), &mut sample);
        for (signal, outcome) in [
            (Signal::IdentitySerial, 1.0),
            (Signal::IdentitySoftware, 0.0),
            (Signal::IdentityConfig, 2.0),
            (Signal::IdentityLine, 1.0),
        ] {
            assert_eq!(sample.get(signal), Some(outcome), "{}", signal.name());
        }
    }
}
