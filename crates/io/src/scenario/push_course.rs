//! Numbers over time in a push: lists of numbers and formulas, tables written out, tables from files.

use std::collections::HashMap;

use forwardstep_core::expression::Expression;
use forwardstep_sim::push::{Between, Course, Function, Table};

use super::at::At;
use super::fault::{Fault, fault, length, values};
use super::formula::formula;
use super::formula_text::FormulaText;
use super::inputs::InputFolder;
use super::push_file::{CourseFile, CourseRowsFile, CourseTableFile, FunctionFile, InterpolateFile};
use super::push_problem::PushProblem;
use super::pushes::Reader;
use super::table::{over_time, rising, table_text};
use super::values::Item;
use crate::SourceText;

/// Numbers in the tables of all pushes of all agents.
const MOST_NUMBERS: usize = 10_000_000;

/// Tables, each read from its file once, and formulas, each looked at once.
pub(super) struct Tables<'a> {
    folder: &'a mut InputFolder,
    texts: HashMap<String, SourceText>,
    numbers: usize,
    /// By their text and the bits of the times between which they have a value: every axis of every agent of a population
    /// asks for the same ones.
    formulas: HashMap<(FormulaText, [u64; 2]), Expression>,
}

impl Reader<'_, '_> {
    /// Numbers over time, one per name.
    pub(super) fn course(&mut self, key: &'static str, file: &At<CourseFile>, names: &[&str]) -> Result<Course, Fault> {
        match &file.value {
            CourseFile::Each(list) => {
                length(key, &file.span, list.len(), names.len(), &self.agent.name)?;
                Ok(Course::Each(list.iter().map(|entry| self.function(entry)).collect::<Result<_, _>>()?))
            }
            CourseFile::Table(table) => {
                let (times_s, values, between) = match &**table {
                    CourseTableFile::Csv(csv) => {
                        let (times_s, values) = self.tables.csv(&csv.file, names)?;
                        (times_s, values, csv.interpolate)
                    }
                    CourseTableFile::Rows(rows) => {
                        let (times_s, values) = self.rows(key, rows, names.len())?;
                        (times_s, values, rows.interpolate)
                    }
                };
                if times_s.len() < 2 {
                    return Err(fault(file, PushProblem::FewRows { found: times_s.len() }));
                }
                self.tables.numbers += times_s.len() + values.len();
                if self.tables.numbers > MOST_NUMBERS {
                    let (numbers, most) = (self.tables.numbers as f64, MOST_NUMBERS as f64);
                    return Err(fault(file, PushProblem::TooLarge { numbers, most }));
                }
                let between = match between {
                    InterpolateFile::Linear => Between::Linear,
                    InterpolateFile::Hold => Between::Hold,
                };
                Ok(Course::Table(Table { times_s, values, between }))
            }
        }
    }

    fn function(&mut self, entry: &At<FunctionFile>) -> Result<Function, Fault> {
        match &entry.value {
            FunctionFile::Number(value) => Ok(Function::Constant(*value)),
            FunctionFile::Formula(text) => {
                let key = (text.clone(), self.times_s.map(f64::to_bits));
                if let Some(known) = self.tables.formulas.get(&key) {
                    return Ok(Function::Formula(known.clone()));
                }
                let formula = formula(&At { value: text.clone(), span: entry.span.clone() })?;
                let [from_s, until_s] = self.times_s;
                if from_s < until_s && !formula.is_bounded(from_s, until_s) {
                    return Err(fault(entry, PushProblem::FormulaValue { from_s, until_s }));
                }
                self.tables.formulas.insert(key, formula.clone());
                Ok(Function::Formula(formula))
            }
        }
    }

    /// Rows that are written in the scenario.
    fn rows(&self, key: &'static str, file: &CourseRowsFile, width: usize) -> Result<(Vec<f64>, Vec<f64>), Fault> {
        let times_s = rising("times_s", &file.times_s.value)?;
        let rows = &file.values.value;
        if rows.len() != times_s.len() {
            let problem = PushProblem::TimesAndRows { times: times_s.len(), rows: rows.len() };
            return Err(fault(&file.values, problem));
        }
        let mut values = Vec::with_capacity(rows.len() * width);
        for row in rows {
            match &row.value {
                // A row of one number may stand without brackets.
                Item::Number(value) => {
                    length(key, &row.span, 1, width, &self.agent.name)?;
                    values.push(*value);
                }
                Item::List(list) => {
                    length(key, &row.span, list.len(), width, &self.agent.name)?;
                    values.extend(list.iter().map(|number| number.value));
                }
            }
        }
        Ok((times_s, values))
    }
}

impl<'a> Tables<'a> {
    /// None yet; `folder` is where they are looked for.
    pub(super) fn new(folder: &'a mut InputFolder) -> Self {
        Tables { folder, texts: HashMap::new(), numbers: 0, formulas: HashMap::new() }
    }

    /// The times and the rows of a CSV file.
    fn csv(&mut self, file: &At<String>, names: &[&str]) -> Result<(Vec<f64>, Vec<f64>), Fault> {
        if !self.texts.contains_key(&file.value) {
            self.texts.insert(file.value.clone(), table_text(file, self.folder)?);
        }
        let Some(source) = self.texts.get(&file.value) else { return Ok((Vec::new(), Vec::new())) };
        let (times, numbers) = over_time(source, names)?;
        Ok((values(&times), numbers))
    }
}

/// The same with zeros before and after.
pub(super) fn padded(course: Course, before: usize, after: usize) -> Course {
    match course {
        Course::Each(functions) => {
            let zeros = |count| std::iter::repeat_n(Function::Constant(0.0), count);
            Course::Each(zeros(before).chain(functions).chain(zeros(after)).collect())
        }
        Course::Table(table) => {
            let width = table.components().max(1);
            let zeros = |count| std::iter::repeat_n(0.0, count);
            let rows = table.values.chunks_exact(width);
            let values = rows.flat_map(|row| zeros(before).chain(row.iter().copied()).chain(zeros(after))).collect();
            Course::Table(Table { values, ..table })
        }
    }
}
