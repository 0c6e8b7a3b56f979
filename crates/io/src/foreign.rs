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
    /// Variables of an environment, some of which may be secrets.
    Variables,
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
            Foreign::Variables => "variables of an environment",
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
const SECRETS: [&str; 10] = [
    "PASSWORD",
    "PASSWD",
    "PASSPHRASE",
    "SECRET",
    "TOKEN",
    "API_KEY",
    "APIKEY",
    "ACCESS_KEY",
    "PRIVATE_KEY",
    "CREDENTIAL",
];
/// Words that the names of secret variables end in; in small letters they may be words of a scenario.
const LAST_WORDS: [&str; 4] = ["PASS", "PWD", "PSK", "PIN"];
/// No token is shorter.
const TOKEN: usize = 16;
/// How tokens begin, whatever they are called.
const TOKENS: [&str; 10] =
    ["ghp_", "gho_", "ghs_", "github_pat_", "glpat-", "sk_live_", "sk_test_", "xoxb-", "xoxp-", "AKIA"];

/// How passwords begin that were hashed.
const HASHES: [&str; 3] = ["$", "{SHA}", "{SSHA}"];

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
    if is_account(first) || is_hashed(first) {
        return Some(Foreign::Accounts);
    }
    let is_for_machines = has_logins(first, text) || is_login(first);
    if is_for_machines || text.lines().any(is_secret) {
        return Some(Foreign::Secrets);
    }
    is_variable(first).then_some(Foreign::Variables)
}

/// A line such as `PATH=/bin`. Keys of a scenario have small letters.
fn is_variable(line: &str) -> bool {
    let line = line.strip_prefix("export ").unwrap_or(line);
    let Some((name, value)) = line.split_once('=') else { return false };
    // Numbers and texts in quotes may be meant for a scenario.
    let is_bare = value.starts_with(|first: char| !first.is_ascii_digit() && !"\"'+-[{ ".contains(first));
    is_bare
        && name.starts_with(|first: char| first.is_ascii_uppercase())
        && name.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_')
}

fn is_number(field: &str) -> bool {
    !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_name(field: &str) -> bool {
    !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.$@".contains(&byte))
}

/// A line of `passwd`, `group` or `shadow`: fields between colons of which the third is a number.
fn is_account(line: &str) -> bool {
    let fields: Vec<&str> = line.split(':').collect();
    matches!(fields.len(), 4 | 7 | 9) && is_name(fields[0]) && is_number(fields[2])
}

/// A line of `.htpasswd`: a name and the hash of a password.
fn is_hashed(line: &str) -> bool {
    let fields = line.split_once(':');
    fields.is_some_and(|(name, hash)| is_name(name) && HASHES.iter().any(|begins| hash.starts_with(begins)))
}

/// A line of `.pgpass`: host, port, database, user and password between colons.
fn is_login(line: &str) -> bool {
    // A colon within a field has a stroke before it.
    let line = line.replace("\\\\", "").replace("\\:", "");
    let fields: Vec<&str> = line.split(':').collect();
    let is_plain = |field: &str| field == "*" || is_name(field);
    matches!(&*fields, [host, port, rest @ .., _] if rest.len() == 2
        && is_plain(host) && (*port == "*" || is_number(port)) && rest.iter().all(|field| is_plain(field)))
}

/// A `.netrc`: words by the name of a machine, one after the other.
fn has_logins(first: &str, text: &str) -> bool {
    let begins = first.split_whitespace().next();
    let names = ["login", "password", "account"];
    matches!(begins, Some("machine" | "default")) && text.split_whitespace().any(|word| names.contains(&word))
}

/// A line such as `export API_TOKEN=…`, `aws_secret_access_key = …` or `"password": …`. Keys of a scenario say nothing of the kind.
fn is_secret(line: &str) -> bool {
    let line = line.trim_start();
    let line = line.strip_prefix("export ").unwrap_or(line);
    let Some((name, value)) = line.split_once(['=', ':']) else { return false };
    let written = name.trim().trim_matches(['"', '\'']);
    let name = written.to_ascii_uppercase();
    let plain = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    let value = value.trim().trim_matches(['"', '\'']);
    let last = name.rsplit('_').next().unwrap_or_default();
    let is_variable = written == name && LAST_WORDS.contains(&last);
    let is_named = SECRETS.iter().any(|secret| name.contains(secret)) || is_variable || written == "psk";
    let is_word =
        value.len() >= TOKEN && value.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-".contains(&byte));
    let is_token = is_word && TOKENS.iter().any(|begins| value.starts_with(begins));
    plain && !value.is_empty() && (is_named || is_token || has_login(value))
}

/// An address with a name and a password in it.
fn has_login(value: &str) -> bool {
    let Some((_, behind)) = value.split_once("://") else { return false };
    let host = behind.split(['/', '?', '#']).next().unwrap_or_default();
    host.rsplit_once('@').is_some_and(|(login, _)| login.contains(':'))
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
            ("aws_access_key_id = AKIA\n", Foreign::Secrets),
            ("machine example.org login me password hunter2\n", Foreign::Secrets),
            ("# mine\nmachine example.org\n  login me\n  password hunter2\n", Foreign::Secrets),
            ("default login anonymous\n", Foreign::Secrets),
            ("db.example.org:5432:orders:me:hunter2\n", Foreign::Secrets),
            ("*:*:*:me:a\\:b\n", Foreign::Secrets),
            ("{\n  \"client_secret\": \"abc\"\n}\n", Foreign::Secrets),
            ("user: me\npassword: hunter2\n", Foreign::Secrets),
            ("DB_PASS=hunter2\n", Foreign::Secrets),
            ("apikey: abc\n", Foreign::Secrets),
            ("network={\n\tpsk=\"hunter2\"\n}\n", Foreign::Secrets),
            ("CARD_PIN=1234\n", Foreign::Secrets),
            ("GH=ghp_0123456789abcdef\n", Foreign::Secrets),
            ("key = \"sk_live_0123456789abcdef\"\n", Foreign::Secrets),
            ("url = \"postgres://me:hunter2@example.org/db\"\n", Foreign::Secrets),
            ("HOME=/root\nPATH=/bin\n", Foreign::Variables),
            ("export LANG=C\n", Foreign::Variables),
            ("me:$apr1$abc$def\n", Foreign::Accounts),
            ("me@example.org:{SHA}abc=\n", Foreign::Accounts),
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
        for text in [
            "",
            "\n",
            "format = 2",
            "from,to\n1:2:3:4,5",
            "<robot name=\"a\"/>",
            "{\"a\": 1}",
            "a:b",
            "token",
            "machine = 1",
            "title = \"see https://example.org/a@b:c\"",
            "spin = 1",
            "lock_pin = 0.02",
            "low_pass = 20",
            "pin: 4",
            "name = \"gho_m\"",
            "title = \"AKIA rover at home\"",
            "FORMAT=2",
            "Mass = 1",
            "a:1:b",
        ] {
            assert_eq!(foreign_text(text), None, "{text}");
        }
    }
}
