//! The mailbox against a list of everything that was ever posted.

use forwardstep_core::LengthError;
use forwardstep_core::sampled::{Arrival, BeforeFirst, Counts, Keep, Mailbox, MailboxError};
use proptest::prelude::*;

const SENDERS: usize = 4;
const LEN: usize = 3;

/// Something that happens to a mailbox. Times are in eighths of a second, so that stamps coincide.
#[derive(Clone, Debug)]
enum Happens {
    Post { sender: usize, stamp: i32, spoilt: bool },
    Weigh([u8; SENDERS]),
    Read,
}

fn happens() -> impl Strategy<Value = (u8, Happens)> {
    let post = (0..SENDERS, -4..40_i32, prop::bool::weighted(0.1)).prop_map(|(sender, stamp, spoilt)| Happens::Post {
        sender,
        stamp,
        spoilt,
    });
    let weigh = prop::array::uniform4(0..4_u8).prop_map(Happens::Weigh);
    (0..3_u8, prop_oneof![8 => post, 1 => weigh, 3 => Just(Happens::Read)])
}

/// A message that nothing but its sender and its stamp decide, with sums that are not exact.
fn message(sender: usize, stamp: i32) -> [f64; LEN] {
    core::array::from_fn(|k| 0.1 + sender as f64 / 3.0 + f64::from(stamp) * 0.7 + k as f64 / 7.0)
}

/// Everything that was ever posted, in order, with when it came; nothing is thrown away.
struct Oracle {
    initial: [Option<i32>; SENDERS],
    posted: Vec<(usize, i32, bool)>,
    weights: [f64; SENDERS],
}

impl Oracle {
    /// What stands of a sender, from first principles.
    fn stands(&self, sender: usize, keep: Keep) -> Option<i32> {
        let accepted = self.posted.iter().filter(|(from, _, refused)| *from == sender && !refused);
        let stamps = self.initial[sender].into_iter().chain(accepted.map(|(_, stamp, _)| *stamp));
        match keep {
            Keep::Newest => stamps.max(),
            Keep::Last => stamps.last(),
        }
    }

    /// Degree and sums at `now`, in the order of senders.
    fn inbox(&self, now: i32, keep: Keep, timeouts: [f64; SENDERS]) -> (f64, [f64; LEN]) {
        let (mut degree, mut sums) = (0.0, [0.0; LEN]);
        for sender in 0..SENDERS {
            let Some(stamp) = self.stands(sender, keep) else { continue };
            if f64::from(now - stamp) / 8.0 > timeouts[sender] {
                continue;
            }
            degree += self.weights[sender];
            for (sum, value) in sums.iter_mut().zip(message(sender, stamp)) {
                *sum = self.weights[sender].mul_add(value, *sum);
            }
        }
        (degree, sums)
    }
}

proptest! {
    #[test]
    fn prop_whatever_the_order_a_mailbox_is_a_list_of_all_that_came(
        all in prop::collection::vec(happens(), 1..80),
        initial in prop::array::uniform4(prop::option::of(-3..2_i32)),
        timeouts in prop::array::uniform4(prop_oneof![Just(f64::INFINITY), (0..12_u8).prop_map(|t| f64::from(t) / 8.0)]),
        keep in prop_oneof![Just(Keep::Newest), Just(Keep::Last)],
    ) {
        let before = |(sender, stamp): (usize, &Option<i32>)| match stamp {
            Some(stamp) => BeforeFirst::Initial {
                stamp_s: f64::from(*stamp) / 8.0,
                message: message(sender, *stamp).to_vec(),
            },
            None => BeforeFirst::Silent,
        };
        let mut mailbox = Mailbox::new(LEN, initial.iter().enumerate().map(before).collect()).unwrap();
        mailbox.set_timeouts_s(&timeouts).unwrap();
        mailbox.keep(keep);
        let mut oracle = Oracle { initial, posted: Vec::new(), weights: [0.0; SENDERS] };
        let mut counts = [Counts::default(); SENDERS];
        let mut now = 0;
        for (passed, happened) in all {
            now += i32::from(passed);
            let now_s = f64::from(now) / 8.0;
            match happened {
                Happens::Post { sender, stamp, spoilt } => {
                    let refused = stamp > now || spoilt;
                    let mut sent = message(sender, stamp);
                    if spoilt {
                        sent[1] = f64::NAN;
                    }
                    let stood = oracle.stands(sender, keep);
                    let (want, count) = match stood {
                        _ if refused => (Arrival::Refused, &mut counts[sender].refused),
                        Some(stood) if stamp == stood => (Arrival::Repeated, &mut counts[sender].repeated),
                        Some(stood) if stamp < stood => (Arrival::Late, &mut counts[sender].late),
                        _ => (Arrival::Heard, &mut counts[sender].heard),
                    };
                    *count += 1;
                    prop_assert_eq!(mailbox.post(now_s, sender, f64::from(stamp) / 8.0, &sent), Ok(want));
                    oracle.posted.push((sender, stamp, refused));
                }
                Happens::Weigh(weights) => {
                    oracle.weights = weights.map(|weight| f64::from(weight) / 3.0);
                    mailbox.set_weights(&oracle.weights).unwrap();
                }
                Happens::Read => {
                    let inbox = mailbox.inbox(now_s);
                    let (degree, sums) = oracle.inbox(now, keep, timeouts);
                    prop_assert_eq!(inbox.degree.to_bits(), degree.to_bits());
                    prop_assert_eq!(inbox.sums, sums);
                }
            }
            for sender in 0..SENDERS {
                prop_assert_eq!(mailbox.counts(sender), Some(counts[sender]));
                let age = oracle.stands(sender, keep).map(|stamp| f64::from(now - stamp) / 8.0);
                prop_assert_eq!(mailbox.age_s(sender, now_s), age);
            }
        }
    }

    #[test]
    fn prop_a_linear_protocol_read_as_any_other_gives_the_same_bits(stamps in prop::array::uniform4(0..20_i32)) {
        let mut mailbox = Mailbox::new(LEN, vec![BeforeFirst::Silent; SENDERS]).unwrap();
        mailbox.set_weights(&[0.3, 0.0, 0.7, 0.1]).unwrap();
        mailbox.set_timeouts_s(&[1.0; SENDERS]).unwrap();
        for (sender, stamp) in stamps.into_iter().enumerate() {
            mailbox.post(3.0, sender, f64::from(stamp) / 8.0, &message(sender, stamp)).unwrap();
        }
        let plain = mailbox.inbox(2.5);
        let (degree, sums) = (plain.degree, plain.sums.to_vec());
        let own = [0.5, -0.5, 0.25];
        let through = mailbox.inbox_through(2.5, &own, |_, heard| heard).unwrap();
        prop_assert_eq!((through.degree, through.sums), (degree, &sums[..]));
        // What is taken depends on what the receiver itself has, entry by entry.
        let through = mailbox.inbox_through(2.5, &own, |own, _| own).unwrap();
        for (sum, own) in through.sums.iter().zip(own) {
            prop_assert!((sum - degree * own).abs() < 1e-12);
        }
    }
}

#[test]
fn what_makes_no_sense_is_an_error_and_changes_nothing() {
    let initial = |stamp_s, message| vec![BeforeFirst::Initial { stamp_s, message }];
    assert!(matches!(Mailbox::new(2, initial(0.0, vec![1.0])), Err(MailboxError::Length(_))));
    for (stamp_s, value) in [(f64::NAN, 0.0), (0.0, f64::INFINITY)] {
        let error = Mailbox::new(1, initial(stamp_s, vec![value])).unwrap_err();
        assert!(matches!(error, MailboxError::Number { sender: 0, .. }), "{error}");
    }
    let mut mailbox = Mailbox::new(1, initial(0.0, vec![2.0])).unwrap();
    mailbox.set_weights(&[0.5]).unwrap();
    for weight in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(mailbox.set_weights(&[weight]), Err(MailboxError::Number { .. })));
    }
    for timeout_s in [-1.0, f64::NAN] {
        assert!(matches!(mailbox.set_timeouts_s(&[timeout_s]), Err(MailboxError::Number { .. })));
    }
    let length = |what, need, got| Err(MailboxError::Length(LengthError { what, need, got }));
    assert_eq!(mailbox.set_weights(&[]), length("the weight", 1, 0));
    assert_eq!(mailbox.post(1.0, 0, 0.5, &[]).map(|_| ()), length("message", 1, 0));
    assert_eq!(mailbox.post(1.0, 3, 0.5, &[1.0]), Err(MailboxError::Sender { sender: 3, senders: 1 }));
    assert!(mailbox.inbox_through(1.0, &[], |_, heard| heard).is_err());
    assert_eq!((mailbox.counts(0), mailbox.counts(1)), (Some(Counts::default()), None));
    // A clock that is broken hears nobody and lets nobody in.
    assert_eq!(mailbox.post(f64::NAN, 0, 0.5, &[1.0]), Ok(Arrival::Refused));
    assert_eq!(mailbox.inbox(f64::NAN).degree, 0.0);
    let inbox = mailbox.inbox(1.0);
    assert_eq!((inbox.degree, inbox.sums), (0.5, &[1.0][..]));
}
