//! Runs on a bad line or with an untrustworthy unit: the embedded unit behind a link that
//! harms what passes.

use btu_rig::procedure::{Procedure, Verdict};
use btu_rig::rig::{LinkTrouble, UnitLink};
use protocol::frame::{self, Decoder};
use protocol::message::{Channel, Message, SelfTest};
use protocol::{Duration, Instant, Random};
use std::sync::Arc;

use super::bench_setup::SWITCHED_OFF;
use super::settle::{READY_WITHIN, settled};
use super::workers::run_task;
use super::{BenchSetup, Task};
use crate::stop::Stop;
use crate::test_support::{Heard, procedures, setup};

/// When what is wrong begins: the first procedure is under way.
const FROM: Duration = Duration::from_ms(SWITCHED_OFF.as_ms() + 3_500);

/// Fault between bench and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LinkFault {
    Nothing,
    /// This share of bytes has a bit flipped, both ways.
    Flips(f64),
    /// The unit's answers to a question for its log do not come.
    NoLog,
    OtherSerial,
    OtherDatabase,
    /// The unit says that every item of its self-test failed.
    SelfTest,
}

struct FaultyLink<L> {
    link: L,
    wrong: LinkFault,
    random: Random,
    decoder: Decoder,
    /// Frames of the tester's channel that were left out: nothing of them shows in the sequence.
    left_out: u16,
}

impl<L> FaultyLink<L> {
    fn pass(&mut self, bytes: &[u8]) -> Vec<u8> {
        let LinkFault::Flips(share) = self.wrong else {
            return bytes.to_vec();
        };
        let random = &mut self.random;
        let lost_or_damaged = bytes.iter().map(|byte| match random.unit() < share {
            true => byte ^ (1 << random.below(8)),
            false => *byte,
        });
        lost_or_damaged.collect()
    }

    /// The unit's frames, those of the tester's channel changed.
    fn change(&mut self, bytes: &[u8], out: &mut Vec<u8>) {
        self.decoder.push(bytes);
        while let Some(Ok((mut header, payload))) = self.decoder.next_frame() {
            let mut payload = payload.to_vec();
            if header.channel == Channel::Ptu {
                header.seq = header.seq.wrapping_sub(self.left_out);
                match (Message::decode(header.channel, &payload), self.wrong) {
                    (Ok(Message::LogEntry(_) | Message::LogEnd(_)), LinkFault::NoLog) => {
                        self.left_out += 1;
                        continue;
                    }
                    (Ok(Message::Identity(mut identity)), wrong) => {
                        match wrong {
                            LinkFault::OtherSerial => identity.serial[0] = b'X',
                            LinkFault::OtherDatabase => identity.tdb_crc ^= 1,
                            _ => {}
                        }
                        payload.clear();
                        Message::from(identity).encode(&mut payload);
                    }
                    (Ok(Message::Status(mut status)), LinkFault::SelfTest) => {
                        status.self_test = SelfTest::from_bits_retain(u16::MAX);
                        payload.clear();
                        Message::from(status).encode(&mut payload);
                    }
                    _ => {}
                }
            }
            frame::encode(&header, &payload, out);
        }
    }
}

impl<L: UnitLink> UnitLink for FaultyLink<L> {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        if now.since(Instant::ZERO) < FROM || self.wrong == LinkFault::Nothing {
            return self.link.exchange(now, to_unit, from_unit);
        }
        let there = self.pass(to_unit);
        let mut back = Vec::new();
        self.link.exchange(now, &there, &mut back)?;
        let back = self.pass(&back);
        match self.wrong {
            LinkFault::Flips(_) => from_unit.extend(back),
            _ => self.change(&back, from_unit),
        }
        Ok(())
    }
}

struct FaultyBench {
    setup: BenchSetup,
    procedures: Vec<Arc<Procedure>>,
}

impl FaultyBench {
    fn new() -> Self {
        let setup = setup(&[]);
        let procedures = procedures(&setup);
        Self { setup, procedures }
    }

    fn run(&self, id: &str, wrong: LinkFault, seed: u64) -> Heard {
        let procedure = self.procedures.iter().find(|p| p.id == id).expect("there");
        let task = Task::from(procedure.clone());
        let mut session = self
            .setup
            .sim_session_by(id, &Stop::default(), |link| FaultyLink {
                link,
                wrong,
                random: Random::new(seed),
                decoder: Decoder::new(),
                left_out: 0,
            });
        let (ready, found) = session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
        assert!(ready, "the unit is good so far");
        let mut heard = Heard::default();
        let mut sink = |event| heard.take(event);
        run_task(
            &mut session,
            &task,
            found,
            Instant::ZERO,
            &mut sink,
            &|| true,
        );
        heard
    }
}

/// Procedures that judge what a bad line would blame: modem, link, inputs, and the tester's own session.
const JUDGE: [&str; 4] = ["twc/exchange", "tcms/link", "atp/limit_speed", "ptu/twc"];

#[test]
fn on_a_good_line_a_good_unit_passes() {
    let bed = FaultyBench::new();
    for id in JUDGE {
        let heard = bed.run(id, LinkFault::Nothing, 1);
        assert_eq!(
            heard.verdict,
            Some(Verdict::Passed),
            "{id}: {}",
            heard.message
        );
    }
}

#[test]
fn a_log_that_stops_answering_is_an_error_and_no_fault() {
    let bed = FaultyBench::new();
    for id in JUDGE {
        let heard = bed.run(id, LinkFault::NoLog, 1);
        assert_eq!(heard.faults, [""; 0], "{id}");
        // A procedure in which nothing is logged has nothing to read.
        if heard.verdict != Some(Verdict::Passed) {
            assert_eq!(
                heard.verdict,
                Some(Verdict::Error),
                "{id}: {}",
                heard.message
            );
            let told = heard
                .message
                .contains("the unit's log could not be read: asked ");
            assert!(told, "{id}: {}", heard.message);
        }
    }
    assert_eq!(
        bed.run("twc/exchange", LinkFault::NoLog, 1).verdict,
        Some(Verdict::Error)
    );
}

/// Goal: a bad line is never a part's fault, however bad it is. Method: one byte in a hundred to one in a
/// hundred thousand flipped, some seeds each. Nearly good, it may pass.
#[test]
fn a_bad_line_blames_no_part() {
    let bed = FaultyBench::new();
    for share in [1e-2, 1e-3, 1e-4, 1e-5] {
        for seed in 1..=3 {
            for id in JUDGE {
                let heard = bed.run(id, LinkFault::Flips(share), seed);
                let what = format!("{id}, {share}, seed {seed}: {}", heard.message);
                assert_eq!(heard.faults, [""; 0], "{what} {:?}", heard.steps);
                assert_ne!(heard.verdict, Some(Verdict::Failed), "{what}");
                if share >= 1e-3 {
                    assert_eq!(heard.verdict, Some(Verdict::Error), "{what}");
                    let told = "the line between tester and unit is bad";
                    assert!(heard.message.contains(told), "{what}");
                    assert_eq!(heard.message.matches(told).count(), 1, "{what}");
                }
            }
        }
    }
}

#[test]
fn another_unit_in_the_middle_of_a_procedure_is_an_error() {
    let bed = FaultyBench::new();
    for (wrong, words) in [
        (
            LinkFault::OtherSerial,
            "its serial number was \"SIM-0001\" and is \"XIM-0001\"",
        ),
        (
            LinkFault::OtherDatabase,
            "its track database's checksum was ",
        ),
    ] {
        let heard = bed.run("twc/exchange", wrong, 1);
        assert_eq!(heard.verdict, Some(Verdict::Error), "{}", heard.message);
        assert!(heard.message.contains(words), "{}", heard.message);
        assert_eq!(heard.faults, [""; 0]);
    }
}

#[test]
fn a_unit_that_says_its_self_test_failed_does_not_pass() {
    let bed = FaultyBench::new();
    let heard = bed.run("tcms/link", LinkFault::SelfTest, 1);
    assert_eq!(heard.verdict, Some(Verdict::Failed));
    let items = [
        "Memory pattern test",
        "TRA did not answer",
        "TEST board",
        "bit 15",
    ];
    for item in items {
        assert!(heard.message.contains(item), "{item}: {}", heard.message);
    }
}
