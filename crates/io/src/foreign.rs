//! Texts that are clearly meant for something else. Nothing of them is ever quoted: who gives one by mistake should not find it in a
//! log.

use std::fmt;

/// What a file holds that is no scenario, robot or table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Foreign {
    /// A program, an archive, a picture, a database.
    Binary,
    /// A private key or a certificate.
    Key,
    /// A list of accounts or groups, with or without passwords.
    Accounts,
    /// Passwords or tokens under their names.
    Secrets,
    /// A page of the web.
    Page,
}

impl fmt::Display for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Foreign::Binary => "a program, an archive, a picture or the like",
            Foreign::Key => "a key or a certificate",
            Foreign::Accounts => "a list of accounts",
            Foreign::Secrets => "passwords or tokens",
            Foreign::Page => "a page of the web",
        })
    }
}

/// How files begin that are no text.
const BINARY: [&[u8]; 12] = [
    b"\x7fELF",
    b"MZ\x90\0",
    b"\xcf\xfa\xed\xfe",
    b"PK\x03\x04",
    b"\x1f\x8b",
    b"\xfd7zXZ\0",
    b"\x28\xb5\x2f\xfd",
    b"%PDF-",
    b"\x89PNG",
    b"\xff\xd8\xff",
    b"PAR1",
    b"SQLite format 3\0",
];

/// What stands at the beginning of a line in keys, theirs and others'.
const KEYS: [&str; 6] =
    ["-----BEGIN ", "---- BEGIN ", "PuTTY-User-Key-File-", "AGE-SECRET-KEY-", "ssh-rsa AAAA", "ssh-ed25519 AAAA"];

/// Parts of names under which secrets are kept and nothing else.
const SECRETS: [&str; 6] = ["PASSWORD", "PASSWD", "SECRET", "TOKEN", "API_KEY", "CREDENTIAL"];

/// What these bytes are, if they are clearly something else.
pub(crate) fn foreign_bytes(bytes: &[u8]) -> Option<Foreign> {
    BINARY.iter().any(|magic| bytes.starts_with(magic)).then_some(Foreign::Binary)
}

/// What this text is, if it is clearly something else.
pub(crate) fn foreign_text(text: &str) -> Option<Foreign> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.clone().next()?;
    // A key may stand behind other words; in a scenario no line begins so.
    if lines.any(|line| KEYS.iter().any(|key| line.starts_with(key))) {
        return Some(Foreign::Key);
    }
    let begins = first.get(..14).unwrap_or(first).to_ascii_lowercase();
    if begins.starts_with("<html") || begins.starts_with("<!doctype html") {
        return Some(Foreign::Page);
    }
    if is_account(first) {
        return Some(Foreign::Accounts);
    }
    text.lines().any(is_secret).then_some(Foreign::Secrets)
}

/// A line of `passwd`, `group` or `shadow`: fields between colons of which the third is a number.
fn is_account(line: &str) -> bool {
    let fields: Vec<&str> = line.split(':').collect();
    let is_number = |field: &str| !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_digit());
    let is_name = |field: &str| {
        !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.$".contains(&byte))
    };
    matches!(fields.len(), 4 | 7 | 9) && is_name(fields[0]) && is_number(fields[2])
}

/// A line such as `export API_TOKEN=…` or `aws_secret_access_key = …`. Keys of a scenario say nothing of the kind.
fn is_secret(line: &str) -> bool {
    let line = line.trim_start();
    let line = line.strip_prefix("export ").unwrap_or(line);
    let Some((name, value)) = line.split_once('=') else { return false };
    let name = name.trim().to_ascii_uppercase();
    let plain = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    plain && !value.trim().is_empty() && SECRETS.iter().any(|secret| name.contains(secret))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::SHIPPED_SCENARIOS;

    #[test]
    fn what_is_clearly_something_else_is_recognised() {
        for (text, what) in [
            ("-----BEGIN OPENSSH PRIVATE KEY-----\nb3BlbnNzaC1rZXktdjEA\n", Foreign::Key),
            ("Bag Attributes\n  x: y\n-----BEGIN CERTIFICATE-----\nMII\n", Foreign::Key),
            ("root:x:0:0:root:/root:/bin/bash\n", Foreign::Accounts),
            ("root:$6$abc$def:19000:0:99999:7:::\n", Foreign::Accounts),
            ("# groups\nwheel:x:10:\n", Foreign::Accounts),
            ("HOST=a\nexport DB_PASSWORD=hunter2\n", Foreign::Secrets),
            ("[default]\naws_secret_access_key = abc\n", Foreign::Secrets),
            ("\n<!DOCTYPE HTML>\n<title>", Foreign::Page),
        ] {
            assert_eq!(foreign_text(text), Some(what), "{text}");
        }
        assert_eq!(foreign_bytes(b"\x7fELF\x02\x01"), Some(Foreign::Binary));
    }

    #[test]
    fn what_may_be_meant_is_read() {
        for shipped in SHIPPED_SCENARIOS {
            assert_eq!((foreign_text(shipped.text), foreign_bytes(shipped.text.as_bytes())), (None, None));
        }
        for text in ["", "\n", "format = 2", "from,to\n1:2:3:4,5", "<robot name=\"a\"/>", "{\"a\": 1}", "a:b", "token"]
        {
            assert_eq!(foreign_text(text), None, "{text}");
        }
    }
}
