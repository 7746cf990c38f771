//! Recordings as other programs write them, of any form.

use protocol::Random;

use super::super::wav_head::{W64_RIFF, W64_WAVE};
use super::*;

/// Forms of the samples: whether they are floats, bytes of one, and its bits, which are its highest.
const SAMPLES: [(bool, usize, u32); 9] = [
    (false, 1, 8),
    (false, 2, 16),
    (false, 2, 12),
    (false, 3, 24),
    (false, 3, 20),
    (false, 4, 32),
    (false, 4, 24),
    (true, 4, 32),
    (true, 8, 64),
];

/// How a file is laid out, and what it says of its length.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Riff,
    /// The lengths stand in a piece of their own.
    Rf64,
    Wave64,
    /// The recorder was killed before it knew the length.
    Open(u32),
}
const FORMS: [Form; 5] = [
    Form::Riff,
    Form::Rf64,
    Form::Wave64,
    Form::Open(0),
    Form::Open(u32::MAX),
];

/// Adds a piece, filled up as its form wants.
fn piece(file: &mut Vec<u8>, form: Form, name: &[u8; 4], said: Option<u32>, bytes: &[u8]) {
    file.extend(name);
    if form == Form::Wave64 {
        file.extend(&W64_WAVE[4..]);
        file.extend((bytes.len() as u64 + 24).to_le_bytes());
    } else {
        file.extend(said.unwrap_or(bytes.len() as u32).to_le_bytes());
    }
    file.extend(bytes);
    let step = if form == Form::Wave64 { 8 } else { 2 };
    file.resize(file.len().next_multiple_of(step), 0);
}

/// A sample of full scale 1 as bytes, and what these mean exactly.
fn sample(chance: &mut Random, (is_float, bytes, bits): (bool, usize, u32)) -> (Vec<u8>, f64) {
    let part = 2.0 * chance.unit() - 1.0;
    if is_float {
        return match bytes {
            4 => ((part as f32).to_le_bytes().to_vec(), f64::from(part as f32)),
            _ => (part.to_le_bytes().to_vec(), part),
        };
    }
    let steps = 2f64.powi(bits as i32 - 1);
    let number = (part * steps).floor();
    let stored = number as i64 + if bytes == 1 { 128 } else { 0 };
    let stored = stored << (8 * bytes as u32 - bits);
    (stored.to_le_bytes()[..bytes].to_vec(), number / steps)
}

/// Goal: samples of a recording of another program are right. Method: 200 files of random form, container, channels and pieces
/// around the samples; each sample is held against the number that was written.
#[test]
fn recordings_of_any_form_keep_their_samples() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.wav");
    for seed in 0..200 {
        let chance = &mut Random::new(seed);
        let form = FORMS[chance.below(FORMS.len())];
        let of = SAMPLES[chance.below(SAMPLES.len())];
        let (channels, frames) = (1 + chance.below(3), chance.below(50));
        let samples: Vec<_> = (0..frames * channels).map(|_| sample(chance, of)).collect();
        let data: Vec<u8> = samples
            .iter()
            .flat_map(|(bytes, _)| bytes.clone())
            .collect();
        let file = file(chance, form, (of, channels), &data);
        std::fs::write(&path, file).expect("written");
        let mut wav = Wav::open(&path).unwrap_or_else(|refused| panic!("seed {seed}: {refused}"));
        assert_eq!((wav.sample_hz(), wav.channels()), (48_000, channels));
        let (block, end) = wav.block(60, 3, 1_000.0);
        assert!(matches!(end, Some(End::Whole)), "seed {seed}");
        for (channel, read) in block.iter().enumerate() {
            let written = samples.iter().skip(channel).step_by(channels);
            let written: Vec<_> = written.map(|(_, part)| (part * 1_000.0) as f32).collect();
            assert_eq!(*read, written, "seed {seed}, channel {channel}");
        }
    }
}

/// A whole file with these samples.
fn file(
    chance: &mut Random,
    form: Form,
    ((is_float, bytes, bits), channels): ((bool, usize, u32), usize),
    data: &[u8],
) -> Vec<u8> {
    let is_extensible = chance.chance(0.5) || bits != 8 * bytes as u32;
    let kind: u16 = if is_float { 3 } else { 1 };
    let frame = bytes * channels;
    let mut format = Vec::new();
    format.extend(if is_extensible { 0xfffe } else { kind }.to_le_bytes());
    format.extend((channels as u16).to_le_bytes());
    format.extend(48_000u32.to_le_bytes());
    format.extend((48_000 * frame as u32).to_le_bytes());
    format.extend((frame as u16).to_le_bytes());
    format.extend((8 * bytes as u16).to_le_bytes());
    if is_extensible {
        format.extend(22u16.to_le_bytes());
        format.extend((bits as u16).to_le_bytes());
        format.extend(0u32.to_le_bytes());
        format.extend(kind.to_le_bytes());
        format.extend(b"\0\0\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71");
    }
    let said = match form {
        Form::Rf64 => Some(u32::MAX),
        Form::Open(said) => Some(said),
        Form::Riff | Form::Wave64 => None,
    };
    let mut pieces = Vec::new();
    if form == Form::Rf64 {
        let lengths = [0, data.len() as u64, 0].map(u64::to_le_bytes).concat();
        piece(&mut pieces, form, b"ds64", None, &lengths);
    }
    for name in [b"JUNK", b"LIST", b"bext"] {
        if chance.chance(0.3) {
            let text = vec![b'x'; chance.below(30)];
            piece(&mut pieces, form, name, None, &text);
        }
    }
    piece(&mut pieces, form, b"fmt ", None, &format);
    if chance.chance(0.3) {
        piece(&mut pieces, form, b"fact", None, &[1, 2, 3]);
    }
    piece(&mut pieces, form, b"data", said, data);
    match form {
        // What comes after samples of unknown length cannot be told from them.
        Form::Open(_) => pieces.truncate(pieces.len() - data.len() % 2),
        _ => piece(&mut pieces, form, b"LIST", None, b"behind the samples"),
    }
    let size = said.unwrap_or(pieces.len() as u32 + 4).to_le_bytes();
    match form {
        Form::Wave64 => {
            let size = (pieces.len() as u64 + 40).to_le_bytes();
            [&W64_RIFF[..], &size, &W64_WAVE, &pieces].concat()
        }
        Form::Rf64 => [b"RF64", &size[..], b"WAVE", &pieces].concat(),
        _ => [b"RIFF", &size[..], b"WAVE", &pieces].concat(),
    }
}
