//! `[[external_wrenches]]` → the pushes of the agents.

use std::collections::{HashMap, HashSet};

use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{Axes, LinkPoint};
use forwardstep_sim::push::{Between, Course, Effect, Function, Grip, Push, Table};
use forwardstep_sim::{AgentSetup, Attachments, AxisUnit, SetupError};

use super::agents::Agents;
use super::at::At;
use super::fault::{Fault, fault, filled, length, not_negative, not_negative_or, positive_or, values};
use super::formula::formula;
use super::inputs::InputFolder;
use super::notice::Notice;
use super::problem::ScenarioProblem;
use super::push_file::{
    AxesFile, ByFile, CourseFile, CourseRowsFile, CourseTableFile, FunctionFile, InterpolateFile, PushFile,
    VirtualSpringOnAxesFile, VirtualSpringOnPointFile, WrenchFile,
};
use super::push_problem::PushProblem;
use super::robots::Body;
use super::table::{over_time, rising, table_text};
use super::value_problem::ValueProblem;
use super::values::Item;
use crate::SourceText;

/// Numbers in the tables of all pushes of all agents.
const MOST_NUMBERS: usize = 10_000_000;

/// Adds all pushes to their agents, in the order of the file; `folder` is where tables are looked for.
pub(super) fn pushes(
    list: &[At<PushFile>],
    read: &mut Agents,
    end_s: f64,
    source: &SourceText,
    folder: &mut InputFolder,
    notices: &mut Vec<Notice>,
) -> Result<(), Fault> {
    let mut tables = Tables { folder, texts: HashMap::new(), numbers: 0, formulas: HashMap::new() };
    for At { value: file, span } in list {
        let from_s = not_negative_or("from_s", &file.from_s, 0.0)?;
        let lasts_s = positive_or("for_s", &file.for_s, f64::INFINITY)?;
        let until_s = from_s + lasts_s;
        let mut idle = true;
        for index in who(&file.on, read)? {
            let (agent, body) = (&read.agents[index], &read.bodies[index]);
            let mut reader = Reader { agent, body, tables: &mut tables, times_s: [from_s, until_s.min(end_s)] };
            let effects = reader.effects(&file.by).map_err(|fault| fault.at(&file.by.span))?;
            let pushes = effects.into_iter().map(|effect| Push { effect, from_s, until_s });
            for push in pushes {
                let [begins_s, ends_s] = push.span_s();
                idle &= begins_s >= end_s.min(ends_s);
                read.agents[index].pushes.push(push);
            }
        }
        if idle {
            notices.push(Notice::IdlePush { line: source.line_column(span.start).0 });
        }
    }
    Ok(())
}

/// The agents that are named, each once; the name of a population stands for its members.
fn who(on: &At<Vec<At<String>>>, read: &Agents) -> Result<Vec<usize>, Fault> {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    for name in filled("on", on)? {
        let agent = read.agents.iter().position(|agent| agent.name == name.value);
        let members = match agent {
            Some(agent) => agent..agent + 1,
            None => match read.populations.iter().find(|(population, _)| *population == name.value) {
                Some((_, members)) => members.clone(),
                None => {
                    let populations = read.populations.iter().map(|(name, _)| name.clone());
                    let agents = read.agents.iter().map(|agent| agent.name.clone()).chain(populations).collect();
                    return Err(fault(name, ScenarioProblem::NoSuchAgent { name: name.value.clone(), agents }));
                }
            },
        };
        for member in members {
            let agent = &read.agents[member];
            if !agent.interface().is_some_and(|interface| interface.pushed) {
                let error = SetupError::NotPushed { agent: agent.name.clone(), law: agent.law.words().name };
                return Err(fault(name, ScenarioProblem::Setup(error)));
            }
            if !seen.insert(member) {
                let twice = read.agents[member].name.clone();
                return Err(fault(name, PushProblem::OnTwice { name: twice }));
            }
            found.push(member);
        }
    }
    Ok(found)
}

/// Tables, each read from its file once, and formulas, each looked at once.
struct Tables<'a> {
    folder: &'a mut InputFolder,
    texts: HashMap<String, SourceText>,
    numbers: usize,
    /// By their text and the bits of the times between which they have a value: every axis of every agent of a population
    /// asks for the same ones.
    formulas: HashMap<(String, [u64; 2]), Expression>,
}

/// A push on its way to one agent.
struct Reader<'a, 'b> {
    agent: &'a AgentSetup,
    body: &'a Body,
    tables: &'a mut Tables<'b>,
    /// From when until when formulas need a value.
    times_s: [f64; 2],
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

impl Reader<'_, '_> {
    fn effects(&mut self, by: &At<ByFile>) -> Result<Vec<Effect>, Fault> {
        let all: Vec<usize> = (0..self.agent.robot.axes.len()).collect();
        Ok(match &by.value {
            ByFile::TorqueNM(course) => {
                self.unit("torque_n_m", course, &all, AxisUnit::Radian, EFFORT)?;
                vec![Effect::Torque(self.on_axes("torque_n_m", course, &all)?)]
            }
            ByFile::ForceN(course) => {
                self.unit("force_n", course, &all, AxisUnit::Metre, EFFORT)?;
                vec![Effect::Torque(self.on_axes("force_n", course, &all)?)]
            }
            ByFile::Effort(course) => vec![Effect::Torque(self.on_axes("effort", course, &all)?)],
            ByFile::Wrench(file) => self.wrench(file)?,
            ByFile::VirtualSpringOnAxes(file) => vec![self.virtual_spring_on_axes(file)?],
            ByFile::VirtualSpringOnPoint(file) => vec![self.virtual_spring_on_point(file)?],
        })
    }

    fn name(&self) -> String {
        self.agent.name.clone()
    }

    /// Refuses a key whose unit some of the axes do not have.
    fn unit<T>(
        &self,
        key: &'static str,
        place: &At<T>,
        axes: &[usize],
        unit: AxisUnit,
        (any, takes): (&'static str, &'static str),
    ) -> Result<(), Fault> {
        let axes = axes.iter().filter_map(|axis| self.agent.robot.axes.get(*axis));
        let Some(axis) = axes.into_iter().find(|axis| axis.unit != unit) else { return Ok(()) };
        let unit = match axis.unit {
            AxisUnit::Radian => "rad",
            AxisUnit::Metre => "m",
            AxisUnit::One => "pure numbers",
        };
        let axis = axis.name.clone();
        Err(fault(place, PushProblem::Unit { key, agent: self.name(), axis, unit, any, takes }))
    }

    /// One number per axis, by the names of the axes.
    fn on_axes(&mut self, key: &'static str, file: &At<CourseFile>, axes: &[usize]) -> Result<Course, Fault> {
        let names: Vec<&str> =
            axes.iter().filter_map(|axis| Some(self.agent.robot.axes.get(*axis)?.name.as_str())).collect();
        self.course(key, file, &names)
    }

    /// Where a force acts. Without a link, the tip of a planar arm.
    fn grip(
        &self,
        link: Option<&At<String>>,
        at_m: Option<&At<[f64; 3]>>,
        axes: Option<&At<AxesFile>>,
        instead: &'static str,
    ) -> Result<Grip, Fault> {
        let agent = self.name();
        match (self.agent.robot.interface().attachments, self.body.tip) {
            (Attachments::PlanarTip, Some(tip)) => {
                let tip_only = |key| PushProblem::TipOnly { agent: agent.clone(), key };
                match (link, at_m, axes) {
                    (Some(link), ..) => Err(fault(link, tip_only("link"))),
                    (_, Some(at_m), _) => Err(fault(at_m, tip_only("at_m"))),
                    (.., Some(axes)) if axes.value == AxesFile::Link => Err(fault(axes, tip_only("axes"))),
                    _ => Ok(Grip::Tip(tip)),
                }
            }
            (Attachments::Links(_), _) => {
                let links = &self.body.links;
                let Some(name) = link else {
                    return Err(Fault::new(PushProblem::WhichLink { agent, links: links.len() }));
                };
                let Some((_, anchor)) = links.iter().find(|(known, _)| *known == name.value) else {
                    let links = links.iter().map(|(name, _)| name.clone()).collect();
                    return Err(fault(name, PushProblem::NoSuchLink { link: name.value.clone(), agent, links }));
                };
                if anchor.body.is_none() {
                    return Err(fault(name, PushProblem::FixedLink { link: name.value.clone(), agent }));
                }
                let axes = match axes.map(|axes| axes.value) {
                    None | Some(AxesFile::Base) => Axes::Base,
                    Some(AxesFile::Link) => Axes::Link,
                };
                let at = at_m.map_or([0.0; 3], |at| at.value);
                Ok(Grip::Link { point: LinkPoint { link: *anchor, at }, axes })
            }
            (Attachments::Axes | Attachments::PlanarTip, _) => Err(Fault::new(PushProblem::NoLinks { agent, instead })),
        }
    }

    /// Force and torque, each with zeros for the other.
    fn wrench(&mut self, file: &WrenchFile) -> Result<Vec<Effect>, Fault> {
        let grip = self.grip(file.link.as_ref(), file.at_m.as_ref(), file.axes.as_ref(), "force_n")?;
        let whole = grip.wrench_components();
        let forces = grip.point_components();
        let torques = if whole == 3 { &COORDINATES[2..] } else { &COORDINATES[..] };
        let mut effects = Vec::new();
        if let Some(force) = &file.force_n {
            let course = self.course("force_n", force, &COORDINATES[..forces])?;
            effects.push(Effect::Wrench { grip, wrench: padded(course, 0, whole - forces) });
        }
        if let Some(torque) = &file.torque_n_m {
            let course = self.course("torque_n_m", torque, torques)?;
            effects.push(Effect::Wrench { grip, wrench: padded(course, forces, 0) });
        }
        if effects.is_empty() { Err(Fault::new(PushProblem::NoWrench)) } else { Ok(effects) }
    }

    fn virtual_spring_on_axes(&mut self, file: &VirtualSpringOnAxesFile) -> Result<Effect, Fault> {
        let axes = self.held(file.axes.as_ref())?;
        let stiffness = self.each("stiffness", &file.stiffness, axes.len())?;
        let damping = file.damping.as_ref().map(|damping| self.each("damping", damping, axes.len())).transpose()?;
        let keys = [
            ("target_rad", Some(AxisUnit::Radian), &file.target_rad),
            ("target_m", Some(AxisUnit::Metre), &file.target_m),
            ("target", None, &file.target),
        ];
        let mut given = keys.into_iter().filter_map(|(key, unit, course)| Some((key, unit, course.as_ref()?)));
        let Some((key, unit, course)) = given.next() else {
            return Err(Fault::new(PushProblem::NoTarget));
        };
        if let Some((second, _, place)) = given.next() {
            return Err(fault(place, ValueProblem::SameQuantity { first: key, second }));
        }
        if let Some(unit) = unit {
            self.unit(key, course, &axes, unit, ("target", "rad or m"))?;
        }
        let target = self.on_axes(key, course, &axes)?;
        let damping = damping.unwrap_or_else(|| vec![0.0; axes.len()]);
        Ok(Effect::HandOnAxes { axes, stiffness, damping, target })
    }

    fn virtual_spring_on_point(&mut self, file: &VirtualSpringOnPointFile) -> Result<Effect, Fault> {
        let grip = self.grip(file.link.as_ref(), file.at_m.as_ref(), None, "virtual_spring_on_axes")?;
        let stiffness = not_negative("stiffness_n_per_m", &file.stiffness_n_per_m)?;
        let damping = not_negative_or("damping_n_s_m", &file.damping_n_s_m, 0.0)?;
        let target = self.course("target_m", &file.target_m, &COORDINATES[..grip.point_components()])?;
        Ok(Effect::HandOnPoint { grip, stiffness, damping, target })
    }

    /// The axes of these names; without any, all.
    fn held(&self, names: Option<&At<Vec<At<String>>>>) -> Result<Vec<usize>, Fault> {
        let axes = &self.agent.robot.axes;
        let Some(names) = names else { return Ok((0..axes.len()).collect()) };
        let mut held = Vec::new();
        for name in filled("axes", names)? {
            let Some(axis) = axes.iter().position(|axis| axis.name == name.value) else {
                let axes = axes.iter().map(|axis| axis.name.clone()).collect();
                let problem = PushProblem::NoSuchAxis { axis: name.value.clone(), agent: self.name(), axes };
                return Err(fault(name, problem));
            };
            if held.contains(&axis) {
                return Err(fault(name, PushProblem::AxisTwice { axis: name.value.clone() }));
            }
            held.push(axis);
        }
        Ok(held)
    }

    /// One number for every axis held.
    fn each(&self, key: &'static str, item: &At<Item>, need: usize) -> Result<Vec<f64>, Fault> {
        match &item.value {
            Item::Number(value) => {
                let value = not_negative(key, &At { value: *value, span: item.span.clone() })?;
                Ok(vec![value; need])
            }
            Item::List(list) if list.len() == need => list.iter().map(|value| not_negative(key, value)).collect(),
            Item::List(list) => {
                let problem = PushProblem::Held { key, found: list.len(), need, agent: self.name() };
                Err(fault(item, problem))
            }
        }
    }

    /// Numbers over time, one per name.
    fn course(&mut self, key: &'static str, file: &At<CourseFile>, names: &[&str]) -> Result<Course, Fault> {
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

/// The key that takes torques and forces alike, and what it takes.
const EFFORT: (&str, &str) = ("effort", "N m or N");

impl Tables<'_> {
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
fn padded(course: Course, before: usize, after: usize) -> Course {
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
