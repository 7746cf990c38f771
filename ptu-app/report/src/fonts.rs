//! The font that is shipped: Korean and Latin, under the SIL Open Font License 1.1, unmodified.

/// Pretendard Regular, an OpenType font with all 11 172 Hangul syllables.
pub static PRETENDARD: &[u8] = include_bytes!("../fonts/Pretendard-Regular.otf");

/// The licence it comes under.
pub static PRETENDARD_LICENCE: &str = include_str!("../fonts/Pretendard-LICENSE.txt");
