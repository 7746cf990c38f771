//! Figures of a run: one declaration gives a figure's value, and its key, name, unit and decimals in every report.

/// A figure of the runs whose figures are an `F`.
#[derive(Debug)]
pub struct Figure<F> {
    /// Key in JSON and CSV, ending in its unit.
    pub key: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Unit for people: `%` of a share, `kN` of newtons.
    pub unit: &'static str,
    pub(super) decimals: usize,
    /// Its value, if the run shows it.
    pub of: fn(&F) -> Option<f64>,
}

impl<F> Figure<F> {
    /// A value of it for people, without unit.
    pub fn shown(&self, value: f64) -> String {
        let scale = match self.unit {
            "%" => 100.0,
            "kN" => 1e-3,
            _ => 1.0,
        };
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
            pub const ALL: &'static [$crate::drive::Figure<Self>] = &[$( $crate::drive::Figure {
                key: stringify!($key),
                name: $name,
                unit: $unit,
                decimals: $decimals,
                of: |figures| figures.$key.into(),
            } ),+];
        }
    };
}

pub(super) use figures;
