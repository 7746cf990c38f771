//! The ring under power that fails anywhere, under damage and over many laps.

use alloc::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::flash::RamFlash;

const BLOCKS: usize = 3;
const KIND: u8 = 0;

fn mounted(flash: &RamFlash) -> LogRing {
    LogRing::mount(flash, KIND, 1, BLOCKS).expect("readable")
}

/// Content that tells its number and is no other's.
fn content(sequence: u32) -> [u8; 8] {
    u64::from(sequence)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .to_be_bytes()
}

fn fill(flash: &mut RamFlash, ring: &mut LogRing, until: u32) {
    while ring.next < until {
        let sequence = ring.next;
        ring.append(flash, 7, &content(sequence)).expect("stored");
    }
}

/// Numbers kept, each with the content it was given.
fn kept(flash: &RamFlash, ring: &LogRing) -> Vec<u32> {
    let found = (ring.oldest()..ring.next).filter(|sequence| {
        match ring.read(flash, *sequence).expect("readable") {
            Slot::Entry(stored) => {
                assert_eq!(stored.content[..8], content(*sequence));
                assert_eq!((stored.sequence, stored.power_up), (*sequence, 7));
                true
            }
            _ => false,
        }
    });
    found.collect()
}

#[test]
fn an_erased_device_holds_nothing_and_entries_are_found_again() {
    let mut flash = RamFlash::default();
    let mut ring = mounted(&flash);
    assert_eq!((ring.oldest(), ring.next, ring.last_power_up), (0, 0, 0));
    for until in [1, SLOTS - 1, SLOTS, SLOTS + 1, 2 * SLOTS, 5 * SLOTS + 3] {
        fill(&mut flash, &mut ring, until);
        ring = mounted(&flash);
        assert_eq!((ring.next, ring.last_power_up), (until, 7));
        let oldest = (until - 1) / SLOTS * SLOTS;
        let oldest = oldest.saturating_sub((BLOCKS as u32 - 1) * SLOTS);
        assert_eq!(kept(&flash, &ring), (oldest..until).collect::<Vec<_>>());
    }
}

/// Blocks take turns, so none is erased more than once more often than another; those of others never.
#[test]
fn wear_is_spread_over_all_blocks() {
    let mut flash = RamFlash::default();
    let mut ring = mounted(&flash);
    fill(&mut flash, &mut ring, 40 * SLOTS);
    let counts = flash.erase_counts();
    let (own, others) = (&counts[1..=BLOCKS], &counts[1 + BLOCKS..]);
    let (least, most) = (own.iter().min(), own.iter().max());
    assert!(most.unwrap() - least.unwrap() <= 1, "{own:?}");
    assert!(*least.unwrap() >= 12);
    assert!(counts[0] == 0 && others.iter().all(|count| *count == 0));
}

/// Goal: whatever byte of whatever write or erasing the power fails at, every entry before it is there, and
/// writing goes on. Method: every byte of the writing of an entry, a block's header and the erasing before
/// it; a second failure at once after the first.
#[test]
fn power_that_fails_at_any_byte_loses_the_entry_being_written_at_most() {
    for before in [0, 5, SLOTS - 1, SLOTS, 3 * SLOTS, 3 * SLOTS + 1] {
        let mut whole = RamFlash::default();
        let mut ring = mounted(&whole);
        fill(&mut whole, &mut ring, before);
        let kept_before = kept(&whole, &ring);
        let costs = HEADER_BYTES + SLOT_BYTES;
        let erases = before % SLOTS == 0 && before >= BLOCKS as u32 * SLOTS;
        let most = if erases { costs + BLOCK_BYTES } else { costs };
        for cut in 0..most {
            let mut flash = whole.clone();
            for cut in [cut, cut / 2] {
                let mut ring = mounted(&flash);
                flash.fail_after(Some(cut));
                let _ = ring.append(&mut flash, 7, &content(ring.next));
                flash.fail_after(None);
            }
            let mut ring = mounted(&flash);
            let found = kept(&flash, &ring);
            // The oldest block may have been erased for it.
            let expected = kept_before.iter().filter(|s| **s >= ring.oldest());
            assert!(
                expected.clone().all(|s| found.contains(s)),
                "{before} {cut}"
            );
            let given_up = kept_before.len() - expected.count();
            assert!(
                given_up == 0 || erases && given_up <= SLOTS as usize,
                "{before} {cut}"
            );
            let next = ring.next;
            fill(&mut flash, &mut ring, next + 2 * SLOTS);
            let found = kept(&flash, &mounted(&flash));
            assert!(
                (next..next + 2 * SLOTS).all(|s| found.contains(&s)),
                "{before} {cut}"
            );
        }
    }
}

#[test]
fn a_damaged_header_hides_no_entry_of_its_block() {
    let mut flash = RamFlash::default();
    let mut ring = mounted(&flash);
    fill(&mut flash, &mut ring, 2 * SLOTS + 4);
    for block in 1..=BLOCKS {
        flash.block_mut(block)[9] ^= 0x40;
    }
    let ring = mounted(&flash);
    assert_eq!(kept(&flash, &ring), (0..2 * SLOTS + 4).collect::<Vec<_>>());
}

proptest! {
    /// Goal: no damage makes an entry of something else, hides what is whole, or stops the log. Method: bytes
    /// anywhere are changed, or whole blocks are another device's.
    #[test]
    fn damage_costs_the_damaged_entries_alone(
        until in 1u32..4 * SLOTS,
        hits in prop::collection::vec((1..=BLOCKS, HEADER_BYTES..BLOCK_BYTES, 1u8..), 0..20),
        foreign in prop::option::of((1..=BLOCKS, any::<u8>())),
    ) {
        let mut flash = RamFlash::default();
        let mut ring = mounted(&flash);
        fill(&mut flash, &mut ring, until);
        let before = kept(&flash, &ring);
        for (block, offset, bits) in &hits {
            flash.block_mut(*block)[*offset] ^= bits;
        }
        if let Some((block, byte)) = foreign {
            flash.block_mut(block).fill(byte);
        }
        let mut ring = mounted(&flash);
        let found = kept(&flash, &ring);
        let hit = |sequence: u32| {
            let (block, slot) = (1 + (sequence / SLOTS) as usize % BLOCKS, sequence % SLOTS);
            let begin = offset_of(slot);
            foreign.is_some_and(|(foreign, _)| foreign == block)
                || hits.iter().any(|(b, at, _)| *b == block && (begin..begin + SLOT_BYTES).contains(at))
        };
        for sequence in before {
            prop_assert!(found.contains(&sequence) || hit(sequence), "{sequence} of {until}");
        }
        let next = ring.next;
        fill(&mut flash, &mut ring, next + SLOTS);
        let ring = mounted(&flash);
        let found = kept(&flash, &ring);
        prop_assert!((next..next + SLOTS).all(|sequence| found.contains(&sequence)));
    }

    /// Any bytes at all: mounted, read and written without a panic.
    #[test]
    fn a_device_of_any_content_is_mounted(seed in any::<u64>()) {
        let mut flash = RamFlash::default();
        let mut random = protocol::Random::new(seed);
        for block in 1..=BLOCKS {
            let whole = random.bits();
            for cell in flash.block_mut(block) {
                *cell = if whole & 1 == 0 { random.bits() as u8 } else { whole as u8 };
            }
        }
        let mut ring = mounted(&flash);
        let next = ring.next;
        fill(&mut flash, &mut ring, next + SLOTS + 1);
        prop_assert_eq!(mounted(&flash).next, next + SLOTS + 1);
    }
}
