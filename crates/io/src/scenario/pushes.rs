//! `[[external_wrenches]]` → the pushes of the agents.

use std::collections::HashSet;

use forwardstep_core::plant::total;
use forwardstep_core::robot::tree::{Axes, LinkPoint};
use forwardstep_core::signal::Signal;
use forwardstep_sim::push::{AttachmentPoint, Course, Effect, Push};
use forwardstep_sim::{AgentSetup, Attachments, AxisUnit, SetupError};

use super::agents::Agents;
use super::at::At;
use super::fault::{Fault, fault, filled, not_negative, not_negative_or, positive_or};
use super::inputs::InputFolder;
use super::notice::Notice;
use super::problem::ScenarioProblem;
use super::push_course::{Tables, padded};
use super::push_file::{
    AxesFile, ByFile, CourseFile, PushFile, VirtualSpringOnAxesFile, VirtualSpringOnPointFile, WrenchFile,
};
use super::push_problem::PushProblem;
use super::robots::Body;
use super::value_problem::ValueProblem;
use super::values::Item;
use crate::SourceText;

/// Adds all pushes to their agents, in the order of the file; `folder` is where tables are looked for.
pub(super) fn pushes(
    list: &[At<PushFile>],
    read: &mut Agents,
    end_s: f64,
    source: &SourceText,
    folder: &mut InputFolder,
    notices: &mut Vec<Notice>,
) -> Result<(), Fault> {
    let mut tables = Tables::new(folder);
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

/// A push on its way to one agent.
pub(super) struct Reader<'a, 'b> {
    pub(super) agent: &'a AgentSetup,
    body: &'a Body,
    pub(super) tables: &'a mut Tables<'b>,
    /// From when until when formulas need a value.
    pub(super) times_s: [f64; 2],
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

impl Reader<'_, '_> {
    fn effects(&mut self, by: &At<ByFile>) -> Result<Vec<Effect>, Fault> {
        let all: Vec<usize> = (0..self.agent.robot.axes.len()).collect();
        Ok(match &by.value {
            ByFile::TorqueNM(course) => {
                let effect = self.acts("torque_n_m", course, Signal::External)?;
                self.unit("torque_n_m", course, &all, AxisUnit::Radian, EFFORT)?;
                vec![effect]
            }
            ByFile::ForceN(course) => {
                let effect = self.acts("force_n", course, Signal::External)?;
                self.unit("force_n", course, &all, AxisUnit::Metre, EFFORT)?;
                vec![effect]
            }
            ByFile::Effort(course) => vec![self.acts("effort", course, Signal::External)?],
            ByFile::BodyTorqueNM(course) => vec![self.acts("body_torque_n_m", course, Signal::ExternalTorque)?],
            ByFile::Disturbance(course) => vec![self.acts("disturbance", course, Signal::Disturbance)?],
            ByFile::Wrench(file) => self.wrench(file)?,
            ByFile::VirtualSpringOnAxes(file) => vec![self.virtual_spring_on_axes(file)?],
            ByFile::VirtualSpringOnPoint(file) => vec![self.virtual_spring_on_point(file)?],
        })
    }

    /// What acts on the robot as `signal`, with zeros for the rest.
    fn acts(&mut self, key: &'static str, file: &At<CourseFile>, signal: Signal) -> Result<Effect, Fault> {
        let axes = &self.agent.robot.axes;
        let blocks = self.agent.robot.interface().attachments.blocks(axes.len());
        let Some(at) = blocks.iter().position(|(own, _)| *own == signal) else {
            return Err(fault(file, PushProblem::DoesNotAct { key, agent: self.name(), does: self.acting() }));
        };
        let names: Vec<String> = match signal {
            Signal::External => axes.iter().map(|axis| axis.name.clone()).collect(),
            Signal::ExternalTorque => COORDINATES.map(str::to_owned).to_vec(),
            _ => (1..=blocks[at].1).map(|equation| format!("w{equation}")).collect(),
        };
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let course = self.course(key, file, &names)?;
        Ok(Effect::Torque(padded(course, total(&blocks[..at]), total(&blocks[at + 1..]))))
    }

    /// The keys of what acts on the robot.
    fn acting(&self) -> &'static str {
        match self.agent.robot.interface().attachments {
            Attachments::Body => "`body_torque_n_m`",
            Attachments::AxesAndBody => "`force_n`, `body_torque_n_m` and `virtual_spring_on_axes`",
            Attachments::Equations(_) => "`disturbance`",
            Attachments::Axes => "`effort`, `force_n` or `torque_n_m`, and `virtual_spring_on_axes`",
            Attachments::PlanarTip | Attachments::Links(_) => {
                "`effort`, `force_n` or `torque_n_m`, `wrench`, `virtual_spring_on_axes` and `virtual_spring_on_point`"
            }
        }
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
        let Some(axis) = axes.into_iter().find(|axis| axis.unit != unit && axis.unit != AxisUnit::Own) else {
            return Ok(());
        };
        let unit = match axis.unit {
            AxisUnit::Radian => "rad",
            AxisUnit::Metre => "m",
            AxisUnit::One | AxisUnit::Own => "pure numbers",
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
    fn attachment(
        &self,
        link: Option<&At<String>>,
        at_m: Option<&At<[f64; 3]>>,
        axes: Option<&At<AxesFile>>,
        (held, instead): (&'static str, &'static str),
    ) -> Result<AttachmentPoint, Fault> {
        let agent = self.name();
        match (self.agent.robot.interface().attachments, self.body.tip) {
            (Attachments::PlanarTip, Some(tip)) => {
                let tip_only = |key| PushProblem::TipOnly { agent: agent.clone(), key };
                match (link, at_m, axes) {
                    (Some(link), ..) => Err(fault(link, tip_only("link"))),
                    (_, Some(at_m), _) => Err(fault(at_m, tip_only("at_m"))),
                    (.., Some(axes)) if axes.value == AxesFile::Link => Err(fault(axes, tip_only("axes"))),
                    _ => Ok(AttachmentPoint::Tip(tip)),
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
                Ok(AttachmentPoint::Link { point: LinkPoint { link: *anchor, at }, axes })
            }
            (Attachments::Body | Attachments::Equations(_), _) => {
                let does = self.acting();
                Err(Fault::new(PushProblem::DoesNotAct { key: held, agent, does }))
            }
            _ => Err(Fault::new(PushProblem::NoLinks { agent, instead })),
        }
    }

    /// Force and torque, each with zeros for the other.
    fn wrench(&mut self, file: &WrenchFile) -> Result<Vec<Effect>, Fault> {
        let at = self.attachment(file.link.as_ref(), file.at_m.as_ref(), file.axes.as_ref(), ("wrench", "force_n"))?;
        let whole = at.wrench_components();
        let forces = at.point_components();
        let torques = if whole == 3 { &COORDINATES[2..] } else { &COORDINATES[..] };
        let mut effects = Vec::new();
        if let Some(force) = &file.force_n {
            let course = self.course("force_n", force, &COORDINATES[..forces])?;
            effects.push(Effect::Wrench { at, wrench: padded(course, 0, whole - forces) });
        }
        if let Some(torque) = &file.torque_n_m {
            let course = self.course("torque_n_m", torque, torques)?;
            effects.push(Effect::Wrench { at, wrench: padded(course, forces, 0) });
        }
        if effects.is_empty() { Err(Fault::new(PushProblem::NoWrench)) } else { Ok(effects) }
    }

    fn virtual_spring_on_axes(&mut self, file: &VirtualSpringOnAxesFile) -> Result<Effect, Fault> {
        if let Attachments::Body | Attachments::Equations(_) = self.agent.robot.interface().attachments {
            let does = self.acting();
            return Err(Fault::new(PushProblem::DoesNotAct {
                key: "virtual_spring_on_axes",
                agent: self.name(),
                does,
            }));
        }
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
        Ok(Effect::SpringOnAxes { axes, stiffness, damping, target })
    }

    fn virtual_spring_on_point(&mut self, file: &VirtualSpringOnPointFile) -> Result<Effect, Fault> {
        let at = self.attachment(
            file.link.as_ref(),
            file.at_m.as_ref(),
            None,
            ("virtual_spring_on_point", "virtual_spring_on_axes"),
        )?;
        let stiffness = not_negative("stiffness_n_per_m", &file.stiffness_n_per_m)?;
        let damping = not_negative_or("damping_n_s_m", &file.damping_n_s_m, 0.0)?;
        let target = self.course("target_m", &file.target_m, &COORDINATES[..at.point_components()])?;
        Ok(Effect::SpringOnPoint { at, stiffness, damping, target })
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
}

/// The key that takes torques and forces alike, and what it takes.
const EFFORT: (&str, &str) = ("effort", "N m or N");
