//! What has arrived from the neighbours, and the weighted sums of it.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use crate::agent::Inbox;
use crate::{Kernel, LengthError, Scalar, dispatch};

/// The newest message of every neighbour, with its weight: what a network does to messages, on the receiving side.
///
/// It knows no clock: whoever posts or reads says what time it is. Messages carry the time at which they were sent, their
/// *stamp*, by a clock that all agents share; where clocks differ by little, let `now_s` of [`Mailbox::post`] be later by as
/// much. Sums are added in the order of the senders, with fused multiply-adds, as the simulator adds them.
///
/// **Guarantees**: no allocation and no panic in any method but [`Mailbox::new`].
///
/// ```
/// use forwardstep_core::sampled::{Arrival, BeforeFirst, Mailbox};
///
/// // Two senders, of which only the second is taken to have sent something before the start.
/// let initial = BeforeFirst::Initial { stamp_s: 0.0, message: vec![3.0] };
/// let mut mailbox = Mailbox::new(1, vec![BeforeFirst::Silent, initial])?;
/// mailbox.set_weights(&[0.5, 1.0])?;
/// mailbox.set_timeouts_s(&[0.4, f64::INFINITY])?;
/// assert_eq!(mailbox.inbox(0.0).sums, [3.0]);
///
/// assert_eq!(mailbox.post(0.1, 0, 0.08, &[2.0])?, Arrival::Heard);
/// // What overtakes others wins; what comes again changes nothing; what comes from the future is refused.
/// assert_eq!(mailbox.post(0.1, 0, 0.06, &[9.0])?, Arrival::Late);
/// assert_eq!(mailbox.post(0.1, 0, 0.08, &[2.0])?, Arrival::Repeated);
/// assert_eq!(mailbox.post(0.1, 0, 7.0, &[9.0])?, Arrival::Refused);
/// let inbox = mailbox.inbox(0.1);
/// assert_eq!((inbox.degree, inbox.sums), (1.5, &[4.0][..]));
/// // Nothing more from the first one: it does not count any longer.
/// let inbox = mailbox.inbox(0.5);
/// assert_eq!((inbox.degree, inbox.sums), (1.0, &[3.0][..]));
/// # Ok::<(), forwardstep_core::sampled::MailboxError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mailbox {
    message_len: usize,
    keep: Keep,
    senders: Vec<Sender>,
    /// Message by message.
    messages: Vec<f64>,
    sums: Vec<f64>,
}

/// Everything about a sender but its message.
#[derive(Clone, Debug)]
struct Sender {
    weight: f64,
    timeout_s: f64,
    /// When the message that stands was sent; nothing stands without.
    stamp_s: Option<f64>,
    counts: Counts,
}

/// What stands for a sender before its first message arrives.
#[derive(Clone, Debug, PartialEq)]
pub enum BeforeFirst {
    /// Nothing: its weight does not count.
    Silent,
    /// A message that is known without being sent, such as where it starts.
    Initial {
        /// When it is taken to have been sent, s.
        stamp_s: f64,
        /// The message.
        message: Vec<f64>,
    },
}

/// Which message of a sender stands.
///
/// ```
/// # use forwardstep_core::sampled::{Arrival, BeforeFirst, Keep, Mailbox};
/// let mut mailbox = Mailbox::new(1, vec![BeforeFirst::Silent])?;
/// mailbox.set_weights(&[1.0])?;
/// mailbox.keep(Keep::Last);
/// mailbox.post(0.5, 0, 0.4, &[4.0])?;
/// assert_eq!(mailbox.post(0.5, 0, 0.3, &[3.0])?, Arrival::Late);
/// assert_eq!(mailbox.inbox(0.5).sums, [3.0]);
/// # Ok::<(), forwardstep_core::sampled::MailboxError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// The one with the latest stamp, whenever it came: what anybody wants of a real network.
    #[default]
    Newest,
    /// The one that came last, however old it is: a delay T(t) that may grow faster than time, which the theory allows. A
    /// message with the stamp of the one that stands is still repeated.
    Last,
}

/// What became of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// It is the newest of its sender and stands from now on.
    Heard,
    /// A newer one stood; it stands from now on only under [`Keep::Last`].
    Late,
    /// It was there already: another with this stamp.
    Repeated,
    /// Its stamp lies in the future, or it holds something that is not a finite number.
    Refused,
}

/// How many messages of one sender became what.
///
/// ```
/// # use forwardstep_core::sampled::{BeforeFirst, Counts, Mailbox};
/// let mut mailbox = Mailbox::new(1, vec![BeforeFirst::Silent])?;
/// for stamp_s in [1.0, 3.0, 2.0, 3.0, f64::NAN] {
///     mailbox.post(3.0, 0, stamp_s, &[0.0])?;
/// }
/// assert_eq!(mailbox.counts(0), Some(Counts { heard: 2, late: 1, repeated: 1, refused: 1 }));
/// # Ok::<(), forwardstep_core::sampled::MailboxError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// [`Arrival::Heard`].
    pub heard: u64,
    /// [`Arrival::Late`].
    pub late: u64,
    /// [`Arrival::Repeated`].
    pub repeated: u64,
    /// [`Arrival::Refused`].
    pub refused: u64,
}

/// A mailbox that cannot be made or used so.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum MailboxError {
    /// A slice of the wrong length.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// No neighbour has this number.
    #[error("there is no sender {sender}: the mailbox has {senders}, counted from zero")]
    Sender {
        /// The number.
        sender: usize,
        /// How many there are.
        senders: usize,
    },
    /// A number that makes no sense.
    #[error("{what} of sender {sender} is {value}, but {requirement}")]
    Number {
        /// Which number.
        what: &'static str,
        /// The sender.
        sender: usize,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
}

impl Mailbox {
    /// For messages of `message_len` numbers, from as many senders as there are entries, in the order of agents. All weights
    /// are zero, and no message is ever too old.
    ///
    /// # Errors
    /// [`MailboxError`] for an initial message of another length, or with a number that is not finite.
    pub fn new(message_len: usize, senders: Vec<BeforeFirst>) -> Result<Self, MailboxError> {
        let silent = Sender { weight: 0.0, timeout_s: f64::INFINITY, stamp_s: None, counts: Counts::default() };
        let mut mailbox = Mailbox {
            message_len,
            keep: Keep::Newest,
            messages: vec![0.0; message_len * senders.len()],
            sums: vec![0.0; message_len],
            senders: vec![silent; senders.len()],
        };
        for (sender, before) in senders.into_iter().enumerate() {
            let BeforeFirst::Initial { stamp_s, message } = before else { continue };
            LengthError::check("initial message", message_len, message.len())?;
            if let Some(&value) = message.iter().chain([&stamp_s]).find(|value| !value.is_finite()) {
                let what = "the initial message";
                return Err(MailboxError::Number { what, sender, value, requirement: "must be finite" });
            }
            mailbox.store(sender, stamp_s, &message);
        }
        Ok(mailbox)
    }

    /// Says which message of a sender stands; the newest unless told otherwise.
    pub fn keep(&mut self, keep: Keep) {
        self.keep = keep;
    }

    /// Sets the weights, 1/s, an entry per sender; zero for those that are not neighbours in this phase.
    ///
    /// # Errors
    /// [`MailboxError`] for a weight that is negative or not finite; nothing has changed then.
    pub fn set_weights(&mut self, weights: &[f64]) -> Result<(), MailboxError> {
        let requirement = "must be finite and not negative";
        self.check("the weight", weights, requirement, |weight| weight >= 0.0 && weight.is_finite())?;
        for (sender, weight) in self.senders.iter_mut().zip(weights) {
            sender.weight = *weight;
        }
        Ok(())
    }

    /// Sets how old a message may become, s, an entry per sender, infinite for any age. While the newest message is older its
    /// sender counts as silent.
    ///
    /// # Errors
    /// [`MailboxError`] for a time that is negative or not a number; nothing has changed then.
    pub fn set_timeouts_s(&mut self, timeouts_s: &[f64]) -> Result<(), MailboxError> {
        self.check("the time-out", timeouts_s, "must not be negative", |timeout_s| timeout_s >= 0.0)?;
        for (sender, timeout_s) in self.senders.iter_mut().zip(timeouts_s) {
            sender.timeout_s = *timeout_s;
        }
        Ok(())
    }

    fn check(
        &self,
        what: &'static str,
        values: &[f64],
        requirement: &'static str,
        fine: impl Fn(f64) -> bool,
    ) -> Result<(), MailboxError> {
        LengthError::check(what, self.senders.len(), values.len())?;
        match values.iter().position(|value| !fine(*value)) {
            Some(sender) => Err(MailboxError::Number { what, sender, value: values[sender], requirement }),
            None => Ok(()),
        }
    }

    /// Takes what `sender` sent at `stamp_s` and what arrives at `now_s`.
    ///
    /// # Errors
    /// [`MailboxError`] for a sender that there is not, or a message of the wrong length; nothing is counted then.
    pub fn post(&mut self, now_s: f64, sender: usize, stamp_s: f64, message: &[f64]) -> Result<Arrival, MailboxError> {
        let senders = self.senders.len();
        LengthError::check("message", self.message_len, message.len())?;
        let Sender { stamp_s: newest_s, counts, .. } =
            self.senders.get_mut(sender).ok_or(MailboxError::Sender { sender, senders })?;
        let sound = stamp_s.is_finite() && stamp_s <= now_s && message.iter().all(|value| value.is_finite());
        let (arrival, count) = match newest_s {
            _ if !sound => (Arrival::Refused, &mut counts.refused),
            Some(newest_s) if stamp_s < *newest_s => (Arrival::Late, &mut counts.late),
            Some(newest_s) if stamp_s == *newest_s => (Arrival::Repeated, &mut counts.repeated),
            _ => (Arrival::Heard, &mut counts.heard),
        };
        *count = count.saturating_add(1);
        if arrival == Arrival::Heard || (arrival, self.keep) == (Arrival::Late, Keep::Last) {
            self.store(sender, stamp_s, message);
        }
        Ok(arrival)
    }

    fn store(&mut self, sender: usize, stamp_s: f64, message: &[f64]) {
        self.senders[sender].stamp_s = Some(stamp_s);
        let first = sender * self.message_len;
        self.messages[first..first + self.message_len].copy_from_slice(message);
    }

    /// What is heard at `now_s`: Σ w and Σ w · message over all senders of whom something stands that is not too old.
    pub fn inbox(&mut self, now_s: f64) -> Inbox<'_> {
        let degree = dispatch(Gather { mailbox: self, now_s });
        Inbox { degree, sums: &self.sums }
    }

    /// The same under a nonlinear protocol: of every number that is heard `taken` of the receiver's own present one, in `own`,
    /// and of it is added up.
    ///
    /// # Errors
    /// [`MailboxError`] when `own` is no message.
    pub fn inbox_through(
        &mut self,
        now_s: f64,
        own: &[f64],
        taken: impl Fn(f64, f64) -> f64,
    ) -> Result<Inbox<'_>, MailboxError> {
        LengthError::check("own message", self.message_len, own.len())?;
        let Mailbox { message_len, senders, messages, sums, .. } = self;
        sums.fill(0.0);
        let mut degree = 0.0;
        for (index, sender) in senders.iter().enumerate() {
            let weight = sender.weight_at(now_s);
            if weight > 0.0 {
                degree += weight;
                for k in 0..*message_len {
                    let heard = messages[index * *message_len + k];
                    sums[k] = Scalar::mul_add(weight, taken(own[k], heard), sums[k]);
                }
            }
        }
        Ok(Inbox { degree, sums })
    }

    /// How old the newest message of a sender is at `now_s`, s; `None` when there is none.
    pub fn age_s(&self, sender: usize, now_s: f64) -> Option<f64> {
        Some(now_s - self.senders.get(sender)?.stamp_s?)
    }

    /// What became of the messages of one sender.
    pub fn counts(&self, sender: usize) -> Option<Counts> {
        Some(self.senders.get(sender)?.counts)
    }
}

impl Sender {
    /// Its weight, or zero while nothing of it stands that is not too old.
    #[inline(always)]
    fn weight_at(&self, now_s: f64) -> f64 {
        match self.stamp_s {
            Some(stamp_s) if now_s - stamp_s <= self.timeout_s => self.weight,
            _ => 0.0,
        }
    }
}

struct Gather<'a> {
    mailbox: &'a mut Mailbox,
    now_s: f64,
}

impl Kernel for Gather<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Mailbox { message_len, senders, messages, sums, .. } = self.mailbox;
        sums.fill(0.0);
        let mut degree = 0.0;
        for (index, sender) in senders.iter().enumerate() {
            let weight = sender.weight_at(self.now_s);
            if weight > 0.0 {
                degree += weight;
                for k in 0..*message_len {
                    sums[k] = Scalar::mul_add(weight, messages[index * *message_len + k], sums[k]);
                }
            }
        }
        degree
    }
}
