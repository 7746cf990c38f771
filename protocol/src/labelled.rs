//! Enums whose variants have one fixed text each.

/// Declares an enum with a fixed text for each variant: `ALL` variants and their `LABELS`, in the order of declaration,
/// and a method that returns the text; its name stands behind that of the enum.
#[macro_export]
macro_rules! labelled {
    ($(#[$meta:meta])* $vis:vis enum $name:ident: $text:ident {
        $( $(#[$each:meta])* $variant:ident = $label:literal, )+
    }) => {
        $(#[$meta])*
        $vis enum $name { $( $(#[$each])* $variant, )+ }

        impl $name {
            /// Texts of all variants, in the order of declaration.
            pub const LABELS: &'static [&'static str] = &[$( $label ),+];
            /// All variants, in the order of declaration.
            pub const ALL: [Self; Self::LABELS.len()] = [$( Self::$variant ),+];

            /// Text of the variant, as its declaration has it.
            pub const fn $text(self) -> &'static str {
                Self::LABELS[self as usize]
            }
        }
    };
}
