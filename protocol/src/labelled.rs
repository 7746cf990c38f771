//! Enums whose variants have one fixed text each.

/// Declares an enum with the text of each variant: `ALL` of them in this order, their `LABELS`, and a method of the name
/// behind the enum's that says the text.
#[macro_export]
macro_rules! labelled {
    ($(#[$meta:meta])* $vis:vis enum $name:ident: $text:ident {
        $( $(#[$each:meta])* $variant:ident = $label:literal, )+
    }) => {
        $(#[$meta])*
        $vis enum $name { $( $(#[$each])* $variant, )+ }

        impl $name {
            /// Texts of all, in this order.
            pub const LABELS: &'static [&'static str] = &[$( $label ),+];
            /// All of them, in this order.
            pub const ALL: [Self; Self::LABELS.len()] = [$( Self::$variant ),+];

            /// Text of the variant, as its declaration has it.
            pub const fn $text(self) -> &'static str {
                Self::LABELS[self as usize]
            }
        }
    };
}
