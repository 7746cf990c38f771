//! The unit served on a TCP socket, by the clock: one client at a time; others get a message, and a silent one is disconnected.

use std::io::Write;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use protocol::message::{
    ArmChallenge, ArmRequest, Identify, IoInput, KeepAlive, Message, ModeSwitch, TrainLines,
};

use crate::common::all;
use crate::served::{Client, Unit};

/// A client of which nothing is heard is let go after this time, and what a busy machine may add.
const SILENT: Duration = Duration::from_secs(10);
const SLACK: Duration = Duration::from_secs(3);
/// Interval at which a client acts.
const EVERY: Duration = Duration::from_millis(100);

#[test]
fn who_comes_second_is_told_who_has_the_unit_and_is_never_heard() {
    let unit = Unit::serve();
    let mut first = Client::connect(&unit);
    assert!(first.is_answered(Duration::from_secs(2)));
    let mut second = Client::connect(&unit);
    second.send(Identify {});
    second.send(ArmRequest { session: 7 });
    second.send(KeepAlive { session: 7 });
    let heard = second.hear_for(Duration::from_secs(2));
    let [Message::Taken(taken)] = heard[..] else {
        panic!("{heard:?}")
    };
    let own = first.stream.local_addr().expect("its address");
    let ip = std::net::Ipv6Addr::from(taken.address).to_canonical();
    assert_eq!(SocketAddr::new(ip, taken.port), own);
    assert!(second.closed, "the end of the stream follows");
    // Nothing of what it sent has become anybody's.
    let heard = first.hear_for(Duration::from_millis(500));
    let answers = |m: &Message| {
        matches!(
            m,
            Message::Identity(_) | Message::ArmState(_) | Message::Status(_)
        )
    };
    assert!(!heard.iter().any(answers), "{heard:?}");
    assert!(first.is_answered(Duration::from_secs(2)));
}

/// Goal: a tester does not wait for its predecessor's sequence numbers and clock to be forgotten. Method: one that is far
/// ahead leaves in the middle of a frame; the next begins at 0, and asks once.
#[test]
fn who_follows_on_a_connection_of_its_own_is_heard_at_once() {
    let unit = Unit::serve();
    for _ in 0..3 {
        let mut client = Client::connect(&unit);
        assert!(client.is_answered(Duration::from_millis(500)));
        for _ in 0..50 {
            client.send(KeepAlive { session: 0 });
        }
        client
            .stream
            .write_all(&[0x7E, 1, 1, 0x10])
            .expect("half a frame");
        client.hear_for(Duration::from_millis(300));
    }
}

/// How long the unit keeps a client that does this every 100 ms: without the time in which the computer stands still,
/// which the unit may count or not, and with it.
fn kept_for(at_most: Duration, act: impl Fn(&mut Client)) -> (Duration, Duration) {
    let unit = Unit::serve();
    let mut client = Client::connect(&unit);
    let (mut kept, began) = (Duration::ZERO, Instant::now());
    assert!(client.is_answered(Duration::from_secs(2)));
    while kept < at_most && !client.closed {
        act(&mut client);
        client.hear_for(EVERY);
        kept += EVERY;
    }
    (kept, began.elapsed())
}

#[test]
fn a_client_that_falls_silent_is_let_go_and_one_that_speaks_on_any_channel_is_not() {
    let longest = SILENT + SLACK;
    let noise = |client: &mut Client| drop(client.stream.write_all(&[0x7E, 1, 2, 3, 0x7E]));
    let rack = |client: &mut Client| client.send(IoInput::default());
    let [silent, noisy, speaking] = std::thread::scope(|scope| {
        let silent = scope.spawn(|| kept_for(longest, |_| {}));
        let noisy = scope.spawn(|| kept_for(longest, noise));
        let speaking = scope.spawn(|| kept_for(longest, rack));
        [silent, noisy, speaking].map(|kept| kept.join().expect("a client"))
    });
    for (kept, by_the_clock) in [silent, noisy] {
        assert!(
            kept < longest && by_the_clock >= SILENT,
            "{kept:?}, {by_the_clock:?}"
        );
    }
    assert!(speaking.0 >= longest, "{speaking:?}");
}

#[test]
fn a_hang_up_closes_the_socket_like_a_termination() {
    for signal in ["TERM", "HUP"] {
        let mut unit = Unit::serve();
        let mut client = Client::connect(&unit);
        assert!(client.is_answered(Duration::from_secs(5)));
        unit.signal(signal);
        client.hear_for(Duration::from_secs(5));
        assert!(client.closed, "{signal}");
        let ended = unit.program.0.wait().expect("the unit's end");
        assert!(!ended.success(), "{signal}");
    }
}

/// Goal: who heard the challenge of one start cannot answer that of the next in advance. Method: the program is started twice.
#[test]
fn the_challenge_of_another_start_is_another() {
    let challenge = || {
        let unit = Unit::serve();
        let mut client = Client::connect(&unit);
        let lines = TrainLines::DOORS_CLOSED | TrainLines::MAINTENANCE_KEY;
        let began = Instant::now();
        loop {
            client.send(IoInput {
                lines,
                mode_switch: ModeSwitch::Manual,
                ..IoInput::default()
            });
            client.send(ArmRequest { session: 7 });
            let challenges: Vec<ArmChallenge> = all(&client.hear_for(EVERY));
            if let [challenge, ..] = challenges[..] {
                return challenge.challenge;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "no challenge");
        }
    };
    assert_ne!(challenge(), challenge());
}
