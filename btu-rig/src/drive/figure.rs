//! Figures of a run: one declaration gives a figure's value, and its key, name, unit and decimals in every report.

use super::Metrics;

#[derive(Debug)]
pub struct Figure {
    /// Key in JSON and CSV, ending in its unit.
    pub key: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Unit for people: `%` of a share.
    pub unit: &'static str,
    pub(super) decimals: usize,
    /// Reads the figure's value, in the key's unit, from a run's figures.
    pub of: fn(&Metrics) -> f64,
}

impl Figure {
    /// A value of it for people, without unit.
    pub fn shown(&self, value: f64) -> String {
        let scale = if self.unit == "%" { 100.0 } else { 1.0 };
        format!("{:.*}", self.decimals, value * scale)
    }
}

/// Declares a struct of figures and its table, in the order in which reports have them.
macro_rules! figures {
    (
        $(#[$doc:meta])*
        pub struct $figures:ident {
            $( $(#[$of:meta])+ $key:ident: $kind:ty = $name:literal, $unit:literal, $decimals:literal; )+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $figures { $( $(#[$of])+ pub $key: $kind, )+ }

        impl $figures {
            /// Every figure, in the order in which reports have them.
            pub const ALL: &'static [$crate::drive::Figure] = &[$( $crate::drive::Figure {
                key: stringify!($key),
                name: $name,
                unit: $unit,
                decimals: $decimals,
                of: |figures| figures.$key,
            } ),+];
        }
    };
}

pub(super) use figures;
