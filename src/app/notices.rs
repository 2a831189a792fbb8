//! Messages to the user: shown until dismissed, the same one only once, warnings and errors of one kind together.
//! Confirmations disappear by themselves.

use crate::messages::kind_of;

use std::time::Duration;

/// Severity of a notice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Info,
    /// Hint on a prerequisite of the requested action.
    Hint,
    /// Something was not as expected; the program continues.
    Warning,
    /// A requested action failed.
    Error,
}

impl Severity {
    /// Returns true if messages disappear by themselves.
    fn is_brief(self) -> bool {
        matches!(self, Self::Info | Self::Hint)
    }
}

/// One message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// Number within the session.
    pub id: u64,
    /// Severity of the notice.
    pub severity: Severity,
    /// The full text.
    pub text: String,
    /// Number of occurrences.
    pub count: u64,
    /// Other messages of its kind, each once, in the order in which they came up.
    pub others: Vec<String>,
    /// Text without numbers and file names, which identifies its kind.
    kind: String,
    /// Time at which it disappears.
    until: Option<Duration>,
}

/// The messages that were not dismissed, oldest first.
#[derive(Debug, Default)]
pub struct Notices {
    notices: Vec<Notice>,
    next_id: u64,
}

/// Display time of a confirmation or a hint.
const INFO_TIME: Duration = Duration::from_secs(6);

/// Max number of notices, so that they do not hide the image: the oldest are dropped.
const MAX_NOTICES: usize = 6;

/// Max stored number of one kind; nobody reads more.
const MAX_OTHERS: usize = 1000;

impl Notices {
    /// Shows `text`. The same text again only counts up, however often a broken frame is drawn; a warning or an error
    /// of a kind that is shown already is listed with it, however many frames are broken.
    pub fn post(&mut self, severity: Severity, text: impl Into<String>) {
        let text = text.into();
        if let Some(known) = self
            .notices
            .iter_mut()
            .find(|notice| notice.text == text && notice.severity == severity)
        {
            known.count += 1;
            known.until = None;
            return;
        }
        let kind = kind_of(&text);
        let same_kind = self.notices.iter_mut().find(|notice| {
            // Each confirmation is about something different.
            !severity.is_brief() && notice.severity == severity && notice.kind == kind
        });
        if let Some(known) = &same_kind
            && (known.others.contains(&text) || known.others.len() == MAX_OTHERS)
        {
            return;
        }
        match severity {
            Severity::Info | Severity::Hint => log::info!("{text}"),
            Severity::Warning => log::warn!("{text}"),
            Severity::Error => log::error!("{text}"),
        }
        if let Some(known) = same_kind {
            known.others.push(text);
            return;
        }
        if self.notices.len() == MAX_NOTICES {
            self.notices.remove(0);
        }
        self.notices.push(Notice {
            id: self.next_id,
            severity,
            text,
            count: 1,
            others: Vec::new(),
            kind,
            until: None,
        });
        self.next_id += 1;
    }

    /// [`Notices::post`] for completed actions.
    pub fn info(&mut self, text: impl Into<String>) {
        self.post(Severity::Info, text);
    }

    /// [`Notices::post`] for prerequisites.
    pub fn hint(&mut self, text: impl Into<String>) {
        self.post(Severity::Hint, text);
    }

    /// [`Notices::post`] for warnings.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.post(Severity::Warning, text);
    }

    /// [`Notices::post`] for failures.
    pub fn error(&mut self, text: impl Into<String>) {
        self.post(Severity::Error, text);
    }

    /// Forgets one message.
    pub fn dismiss(&mut self, id: u64) {
        self.notices.retain(|notice| notice.id != id);
    }

    /// Forgets the message with this text, as it is true no longer; others that are listed with it stay.
    pub(in crate::app) fn dismiss_text(&mut self, text: &str) {
        self.dismiss_where(|other| other == text);
    }

    /// Forgets messages that begin with `begin`, followed by a number and `next`: they are no longer true.
    pub(in crate::app) fn dismiss_begun(&mut self, begin: &str, next: &str) {
        self.dismiss_where(|text| {
            let rest = text.strip_prefix(begin);
            let is_of_number = |c: char| c.is_ascii_digit() || c == ',';
            rest.is_some_and(|rest| rest.trim_start_matches(is_of_number).starts_with(next))
        });
    }

    fn dismiss_where(&mut self, is_untrue: impl Fn(&str) -> bool) {
        self.notices.retain_mut(|notice| {
            notice.others.retain(|other| !is_untrue(other));
            if !is_untrue(&notice.text) {
                return true;
            }
            if notice.others.is_empty() {
                return false;
            }
            (notice.text, notice.count) = (notice.others.remove(0), 1);
            true
        });
    }

    /// Lets confirmations and hints go whose time is over. True if one went.
    pub fn expire(&mut self, now: Duration) -> bool {
        for notice in &mut self.notices {
            if notice.severity.is_brief() {
                notice.until.get_or_insert(now + INFO_TIME);
            }
        }
        let count = self.notices.len();
        self.notices
            .retain(|notice| notice.until.is_none_or(|until| now < until));
        self.notices.len() < count
    }

    /// When [`Notices::expire`] has something to do.
    pub fn next_deadline(&self) -> Option<Duration> {
        self.notices.iter().filter_map(|notice| notice.until).min()
    }

    /// Returns the notices to be shown, oldest first.
    pub fn list(&self) -> &[Notice] {
        &self.notices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notices_of_a_frame_are_withdrawn_when_it_is_read_again() {
        let mut notices = Notices::default();
        notices.error("Frame 1 of 1 is skipped. /a/f_0.ply is empty");
        notices.error("Frame 11 of 12 is skipped. /a/f_10.ply is empty");
        notices.error("Frame 1 of 12,345 is skipped. /a/f_0.ply is empty");
        notices.dismiss_begun("Frame 1 of ", " is skipped.");
        assert_eq!(notices.list().len(), 1);
        assert!(notices.list()[0].text.starts_with("Frame 11"), "{:?}", notices.list());
        notices.dismiss_begun("Frame 11 of ", " is skipped.");
        assert!(notices.list().is_empty());
    }

    #[test]
    fn the_same_error_sixty_times_is_one_notice() {
        let mut notices = Notices::default();
        for _ in 0..60 {
            notices.error("frame 3 is broken");
        }
        notices.warn("frame 3 is broken");
        assert_eq!(notices.list().len(), 2);
        assert_eq!(notices.list()[0].count, 60);
        assert_eq!(notices.list()[1].count, 1);
    }

    #[test]
    fn a_hundred_frames_with_one_fault_are_one_notice() {
        let mut notices = Notices::default();
        for frame in (0..100).chain(0..100) {
            notices.error(format!("Frame {frame} is skipped. /a/f_{frame}.ply is empty"));
        }
        notices.error("Frame 3 is skipped. /a/f_3.ply cannot be read");
        let [empty, unreadable] = notices.list() else {
            panic!("{:?}", notices.list())
        };
        assert_eq!((empty.count, empty.others.len()), (2, 99));
        assert_eq!(empty.others[98], "Frame 99 is skipped. /a/f_99.ply is empty");
        assert_eq!(unreadable.others, [""; 0]);
        notices.info("1 is saved");
        notices.info("2 is saved");
        assert_eq!(notices.list().len(), 4);
    }

    #[test]
    fn confirmations_expire_and_errors_stay() {
        let mut notices = Notices::default();
        notices.error("broken");
        notices.info("saved");
        notices.hint("pick a point");
        assert!(!notices.expire(Duration::from_secs(10)));
        assert_eq!(notices.next_deadline(), Some(Duration::from_secs(16)));
        assert!(!notices.expire(Duration::from_millis(15_999)));
        assert!(notices.expire(Duration::from_secs(16)));
        assert_eq!(notices.next_deadline(), None);
        assert_eq!(notices.list().len(), 1);
        assert_eq!(notices.list()[0].text, "broken");
    }

    #[test]
    fn outdated_notices_are_removed_and_others_of_their_kind_stay() {
        let mut notices = Notices::default();
        notices.warn("part 1 is missing");
        notices.warn("part 2 is missing");
        notices.warn("the disk is slow");
        notices.dismiss_text("part 1 is missing");
        let texts = |notices: &Notices| {
            notices
                .list()
                .iter()
                .map(|notice| notice.text.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(&notices), ["part 2 is missing", "the disk is slow"]);
        notices.dismiss_text("part 2 is missing");
        notices.dismiss_text("nothing like that");
        assert_eq!(texts(&notices), ["the disk is slow"]);
    }

    #[test]
    fn old_notices_are_evicted_and_ids_stay_distinct() {
        let mut notices = Notices::default();
        for number in 0..20 {
            notices.info(format!("saved {number}"));
        }
        assert_eq!(notices.list().len(), MAX_NOTICES);
        assert_eq!(notices.list()[0].text, "saved 14");
        let id = notices.list()[2].id;
        notices.dismiss(id);
        assert!(notices.list().iter().all(|notice| notice.id != id));
        assert_eq!(notices.list().len(), MAX_NOTICES - 1);
    }
}
