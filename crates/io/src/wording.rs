//! Numbers and near matches in messages.

pub(crate) use forwardstep_sim::quantity::{about, entries as entry_count, number, rounded};

use crate::shown;

/// Mistakes that are only counted, `7 more mistakes are reported once these are mended`.
pub(crate) fn more_mistakes(count: usize) -> String {
    let words = if count == 1 { "mistake is" } else { "mistakes are" };
    format!("{count} more {words} reported once these are mended")
}

/// So many letters of a text, with a mark where there is more: what a file holds where a name should be can be anything.
pub(crate) fn beginning(text: &str, letters: usize) -> String {
    match text.char_indices().nth(letters) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A time of a run in s, to a hundredth, or four digits of a shorter one.
pub fn instant(t_s: f64) -> String {
    if t_s == 0.0 || t_s.abs() >= 0.1 || !t_s.is_finite() {
        return format!("{t_s:.2}");
    }
    number(format!("{t_s:.3e}").parse().unwrap_or(t_s)).to_string()
}

/// "1 list", "2 lists".
pub(crate) fn count(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what}") } else { format!("{number} {what}s") }
}

/// "is 1 agent", "are 2 agents".
pub(crate) fn are(number: usize, what: &str) -> String {
    format!("{} {}", if number == 1 { "is" } else { "are" }, count(number, what))
}

/// "1 axis", "2 axes".
pub(crate) fn axes(number: usize) -> String {
    if number == 1 { "1 axis".into() } else { format!("{number} axes") }
}

/// "a, b and c", or "a, b and 17 more".
pub(crate) fn enumerate(items: impl ExactSizeIterator<Item = String>) -> String {
    const MOST: usize = 8;
    let count = items.len();
    let mut text = String::new();
    for (k, item) in items.take(MOST).enumerate() {
        if k > 0 {
            text.push_str(if k + 1 == count { " and " } else { ", " });
        }
        text.push_str(&item);
    }
    if count > MOST {
        text.push_str(&format!(" and {} more", count - MOST));
    }
    text
}

/// The candidate nearest to `word`, if it is near enough to be a slip of the pen.
pub(crate) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    // Comparing takes as long as the product of both lengths, and so much is not typed by hand.
    const LONGEST: usize = 200;
    if word.len() > LONGEST {
        return None;
    }
    let folded = word.to_lowercase();
    let slips = (folded.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .filter_map(|candidate| {
            let other = candidate.to_lowercase();
            let (distance, likeness) = (strsim::osa_distance(&folded, &other), strsim::jaro_winkler(&folded, &other));
            (distance <= slips || likeness > 0.9).then_some((distance, likeness, candidate))
        })
        .min_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)))
        .map(|(_, _, candidate)| candidate.to_owned())
}

/// Whether a word differs from a candidate by two letters at most, and by one where it is short: then that is what was meant, whatever else
/// it may mean.
pub(crate) fn is_slip<'a>(word: &str, mut candidates: impl Iterator<Item = &'a str>) -> bool {
    let folded = word.to_lowercase();
    let most = (folded.chars().count() / 3).clamp(1, 2);
    // More letters than that make a difference of more.
    let is_near = |candidate: &str| candidate.len().abs_diff(folded.len()) <= 4 * most;
    candidates.any(|candidate| is_near(candidate) && strsim::osa_distance(&folded, &candidate.to_lowercase()) <= most)
}

/// A name as a shell takes it for one word, to be pasted.
pub fn for_shell(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._/-+:=@%,".contains(c);
    if !name.is_empty() && name.chars().all(is_plain) {
        name.to_owned()
    } else {
        format!("'{}'", name.replace('\'', r"'\''"))
    }
}

/// "did you mean `x` or `y`?", if anything was meant.
pub(crate) fn did_you_mean<'a>(meant: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let meant: Vec<_> = meant.into_iter().map(|name| format!("`{}`", shown(name))).collect();
    (!meant.is_empty()).then(|| format!("did you mean {}?", meant.join(" or ")))
}

/// The candidates that have `word` as whole parts of their names, as `theorem-3` is of `theorem-3-24-order-4`.
fn with_part<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let parts = |name: &str| -> Vec<String> { name.to_lowercase().split(['-', '_', '.']).map(str::to_owned).collect() };
    let wanted = parts(word);
    let has = |name: &&str| !word.is_empty() && parts(name).windows(wanted.len()).any(|part| part == wanted);
    candidates.filter(has).collect()
}

/// "`а` is U+0430": letters of a word that look like others, or like nothing, and that no candidate has.
fn strange_letters<'a>(word: &str, candidates: impl Iterator<Item = &'a str> + Clone) -> Option<String> {
    const MOST: usize = 3;
    let is_mixed = word.chars().any(|c| c.is_ascii_alphanumeric());
    let known = |c: char| candidates.clone().any(|candidate| candidate.contains(c));
    let mut strange: Vec<char> = word.chars().filter(|c| is_mixed && !c.is_ascii() && !known(*c)).collect();
    strange.dedup();
    strange.truncate(MOST);
    let named = |c: &char| format!("`{}` is U+{:04X}", shown(c.encode_utf8(&mut [0; 4])), u32::from(*c));
    let named: Vec<String> = strange.iter().map(named).collect();
    (!named.is_empty()).then(|| enumerate(named.into_iter()))
}

/// "did you mean `x`? `kind` are `a`, `b`, `c`": those of which the word is a part, else the near match, if any; and what there is.
pub fn choose(word: &str, kind: &str, candidates: &[impl AsRef<str>]) -> String {
    // All that ships fits; of a folder with many files the first are named, and how many there are besides.
    const MOST: usize = 100;
    // A part that more have tells nothing.
    const MEANT: usize = 3;
    let names = || candidates.iter().map(AsRef::as_ref);
    let listed: Vec<_> = names().take(MOST).map(|name| format!("`{}`", shown(name))).collect();
    let more = match candidates.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let listed = format!("{kind} {}{more}", listed.join(", "));
    let listed = match strange_letters(word, names()) {
        Some(letters) => format!("{letters}; {listed}"),
        None => listed,
    };
    let meant = with_part(word, names());
    let question = match meant.len() {
        1..=MEANT => did_you_mean(meant),
        _ => did_you_mean(nearest(word, names()).as_deref()),
    };
    match question {
        Some(question) => format!("{question} {listed}"),
        None => listed,
    }
}

/// The same text with a blank at which no line may break, U+00A0, within numbers, before units and within these, and before a noun that is counted.
pub fn unbroken(text: &str) -> String {
    let is_digit = |letter: char| letter.is_ascii_digit() || "⁰¹²³⁴⁵⁶⁷⁸⁹".contains(letter);
    let mut words = text.split(' ');
    let mut before = words.next().unwrap_or_default();
    let mut tied = before.to_owned();
    for word in words {
        let is_unit =
            word.starts_with(|letter: char| letter.is_alphabetic() || letter == '%') || word.starts_with("1/s");
        let is_unit = is_unit && !matches!(word, "with" | "or" | "and");
        let holds = [before, word].contains(&"×") || before == "N" || before.ends_with(is_digit) && is_unit;
        tied.push(if holds { '\u{a0}' } else { ' ' });
        tied.push_str(word);
        before = word;
    }
    tied
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_tied_to_its_unit_and_not_to_what_is_said_of_it() {
        let shown = |text: &str| unbroken(text).replace('\u{a0}', "_");
        assert_eq!(shown("29.38 N m"), "29.38_N_m");
        assert_eq!(shown("0.1674 ± 2.1 × 10⁻⁵ m with s ≡ 0"), "0.1674 ± 2.1_×_10⁻⁵_m with s ≡ 0");
        assert_eq!(shown("3.4 × 10⁻³ rad or m"), "3.4_×_10⁻³_rad or m");
        assert_eq!([shown("not yet"), shown(""), shown("12 %")], ["not yet", "", "12_%"]);
        let sentence = "at 33.68 N m, 2.5 × 10⁻⁴ rad/s (12 %), −0.5 1/s by 40 s; 3 robots and 2 and a half";
        let tied = "at 33.68_N_m, 2.5_×_10⁻⁴_rad/s (12_%), −0.5_1/s by 40_s; 3_robots and 2 and a half";
        assert_eq!([shown(sentence), shown("  two  gaps stay")], [tied, "  two  gaps stay"]);
    }

    #[test]
    fn numbers_read_as_written() {
        let written: Vec<String> = [0.0, -1.5, 1234567.0, 1e7, 1e-4, 9e-5, -1e300, f64::INFINITY]
            .into_iter()
            .map(|value| number(value).to_string())
            .collect();
        assert_eq!(written, ["0", "-1.5", "1234567", "1e7", "0.0001", "9e-5", "-1e300", "inf"]);
    }

    #[test]
    fn noise_is_rounded_away() {
        let values = [0.1 + 0.2, -1.0 / 3.0, 0.0, 4e-300, f64::MAX];
        assert_eq!(values.map(rounded), [0.3, -0.333333, 0.0, 4e-300, 1.79769e308]);
        assert!(rounded(f64::NAN).is_nan());
    }

    #[test]
    fn nearest_forgives_slips_only() {
        let joints = ["elbow_joint", "wrist_1_joint", "wrist_2_joint"];
        assert_eq!(nearest("wrist1_joint", joints).as_deref(), Some("wrist_1_joint"));
        assert_eq!(nearest("ELBOW_JOINT", joints).as_deref(), Some("elbow_joint"));
        assert_eq!(nearest("gripper", joints), None);
        assert_eq!(nearest("", joints), None);
        assert_eq!(nearest("arm", ["amr", "base"]).as_deref(), Some("amr"));
    }

    /// `theorem-3` asked for `theorem-1`, one letter away, though there are two of which it is the beginning.
    #[test]
    fn regress_what_a_word_is_a_part_of_is_meant_rather_than_what_is_near() {
        let names =
            ["theorem-1", "theorem-2", "theorem-3-a5", "theorem-3-24", "five-ships", "my_ships.toml", "ships.csv"];
        let question = |word: &str| choose(word, "there are", &names).split('?').next().map(str::to_owned).unwrap();
        assert_eq!(question("theorem-3"), "did you mean `theorem-3-a5` or `theorem-3-24`");
        assert_eq!(question("A5"), "did you mean `theorem-3-a5`");
        assert_eq!(question("ships"), "did you mean `five-ships` or `my_ships.toml` or `ships.csv`");
        // Of what four have in common, and of what none has, the nearest is meant.
        assert_eq!(question("theorem"), "did you mean `theorem-1`");
        assert_eq!(question("theorem-4"), "did you mean `theorem-1`");
        for word in ["", "-", "order"] {
            assert!(question(word).starts_with("there are"), "{word}");
        }
        // Nothing is part of anything, even where a part is nothing.
        assert!(choose("", "there are", &[".hidden.toml"]).starts_with("there are"));
    }

    #[test]
    fn letters_that_look_like_others_are_named() {
        let keys = ["title", "time"];
        assert_eq!(
            choose("titl\u{435}", "keys are", &keys),
            "did you mean `title`? `\u{435}` is U+0435; keys are `title`, `time`"
        );
        assert!(choose("time\u{200b}", "keys are", &keys).contains("`\\u{200b}` is U+200B; keys are"));
        for word in ["titel", "größe.toml", "時間"] {
            assert!(!choose(word, "there are", &["größe-2.toml", "time"]).contains("U+"), "{word}");
        }
    }

    #[test]
    fn long_lists_are_cut() {
        let list = |count: usize| enumerate((0..count).map(|k| k.to_string()));
        assert_eq!([list(0), list(1), list(2), list(3)], ["", "0", "0 and 1", "0, 1 and 2"]);
        assert_eq!(list(11), "0, 1, 2, 3, 4, 5, 6, 7 and 3 more");
    }
}
