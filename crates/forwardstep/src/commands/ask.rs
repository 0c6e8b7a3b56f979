//! Questions to a person, when there is one.

use std::fmt::Display;
use std::io::{self, BufRead, IsTerminal, Write};

use clap::ValueEnum;
use forwardstep::io::shown;

/// Asks for what is missing, or takes the default.
pub(crate) struct Asker {
    is_there_anybody: bool,
}

impl Asker {
    /// There is a person where input and output are terminals.
    pub(crate) fn new() -> Self {
        Asker { is_there_anybody: io::stdin().is_terminal() && io::stdout().is_terminal() }
    }

    /// What was given, else the answer, else the default. Asks again as long as `parse` has an objection.
    pub(crate) fn ask<T: Display, E: Display>(
        &self,
        given: Option<T>,
        question: &str,
        usual: T,
        parse: impl Fn(&str) -> Result<T, E>,
    ) -> T {
        if let Some(given) = given {
            return given;
        }
        if !self.is_there_anybody {
            return usual;
        }
        loop {
            // On standard error, since standard output may become the scenario.
            let _ = write!(io::stderr(), "{question} [{usual}]: ").and_then(|()| io::stderr().flush());
            let mut line = String::new();
            let read = io::stdin().lock().read_line(&mut line);
            let answer = line.trim();
            if answer.is_empty() || read.is_err() {
                return usual;
            }
            match parse(answer) {
                Ok(value) => return value,
                // It may repeat the answer.
                Err(objection) => drop(writeln!(io::stderr(), "  {}", shown(objection.to_string().as_str()))),
            }
        }
    }

    /// The same for yes or no, which is the default.
    pub(crate) fn confirm(&self, question: &str) -> bool {
        let parse = |answer: &str| match answer.to_lowercase().as_str() {
            "y" | "yes" => Ok("yes"),
            "n" | "no" => Ok("no"),
            _ => Err("yes or no"),
        };
        self.ask(None, &format!("{question}: yes, no"), "no", parse) == "yes"
    }

    /// The same for one of several.
    pub(crate) fn choose<T: ValueEnum + Clone>(&self, given: Option<T>, question: &str, usual: T) -> T {
        let names: Vec<String> = T::value_variants().iter().map(name).collect();
        let question = format!("{question}: {}", names.join(", "));
        let found = self.ask(given.as_ref().map(name), &question, name(&usual), |answer| {
            T::from_str(answer, true).map(|value| name(&value)).map_err(|_| format!("`{answer}` is none of these"))
        });
        T::from_str(&found, true).unwrap_or(usual)
    }
}

/// As the command line spells it.
fn name<T: ValueEnum>(value: &T) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
