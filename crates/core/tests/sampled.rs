//! What a sampled controller does when something goes wrong, and what it needs to know.

use std::sync::Arc;

use forwardstep_core::agent::{FilterError, Inbox, LimiterError, StepError, VelocityFilter};
use forwardstep_core::controller::{PositionOnly, ReferenceModel};
use forwardstep_core::law::SlotineLi;
use forwardstep_core::plant::{Mechanical, Plant, Rotorcraft, Spacecraft, TaskArm, Vehicle, Wheels, total};
use forwardstep_core::reference::{Choice, Consensus, Derived, Position, PositionVelocity, Sliding, SmoothFollowing};
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip, PointMass};
use forwardstep_core::sampled::{
    EncoderFilter, Limits, Motion, Recipe, RecipeError, SafeCommand, Sampled, StartState, Target,
};
use forwardstep_core::signal::Signal;
use forwardstep_core::{Gain, LengthError};

/// A mass on a line that hears positions and velocities.
fn mass() -> Recipe {
    let reference = Consensus::<PositionVelocity>::new([(&[1.0, 2.0][..], 0.0)]).unwrap();
    let gain = |size| Gain::Number(8.0).resolve(size, &[]).unwrap();
    let law = SlotineLi { damping: gain(1), adaptation: Some(gain(1)), bounds: None };
    Recipe::lagrangian(PointMass { dimension: 1 }, reference, law, vec![2.0])
}

/// The same without velocity, towards agreement.
fn blind(knows: ReferenceModel) -> Recipe {
    let plant = Mechanical { robot: PointMass { dimension: 1 }, theta: vec![2.0] };
    let law = PositionOnly {
        axes: 1,
        guide: knows,
        damping: 4.0,
        filter_per_s: 10.0,
        adaptation: 0.5,
        estimate_start: 1.5,
        bounds: None,
    };
    Recipe::feedback(&plant, law)
}

fn agreeing() -> ReferenceModel {
    ReferenceModel::Consensus(Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).unwrap())
}

fn tracking() -> ReferenceModel {
    ReferenceModel::Tracking { alpha: vec![6.0, 11.0, 6.0] }
}

/// t², on one axis.
struct Square;

impl Motion for Square {
    fn axes(&self) -> usize {
        1
    }

    fn known_derivatives(&self) -> usize {
        4
    }

    fn derivatives(&self, _: usize, at_s: f64, out: &mut [f64]) {
        out.fill(0.0);
        out.iter_mut().zip([at_s * at_s, 2.0 * at_s, 2.0]).for_each(|(out, value)| *out = value);
    }
}

/// Steps a mass, or the blind one, with one neighbour that pulls.
fn step(controller: &mut dyn Sampled, now_s: f64, q: f64) -> Result<(), StepError> {
    let measured = [q, 0.0];
    let sums = [3.0, 0.0];
    let inbox = Inbox { degree: 0.5, sums: &sums[..controller.message_len()] };
    controller.step(now_s, &measured[..total(controller.measures())], inbox)
}

#[test]
fn a_failed_step_commands_what_the_recipe_calls_safe_and_leaves_the_state_alone() {
    for mut recipe in [mass(), blind(agreeing())] {
        let cases = [
            (SafeCommand::HoldLast, None),
            (SafeCommand::Zero, Some(0.0)),
            (SafeCommand::Values(vec![-0.25]), Some(-0.25)),
        ];
        for (safe, want) in cases {
            recipe.safe = safe.clone();
            let (mut failing, mut twin) = (recipe.build().unwrap(), recipe.build().unwrap());
            // Before anything was commanded.
            assert_eq!(failing.command(), [want.unwrap_or(0.0)], "{safe:?}");
            for k in 0..5 {
                step(&mut *failing, 0.01 * f64::from(k), 0.1).unwrap();
                step(&mut *twin, 0.01 * f64::from(k), 0.1).unwrap();
            }
            let last = failing.command()[0];
            assert!(last != 0.0 && failing.command() == twin.command());
            let now_s = 0.05;
            let good = vec![0.1; total(failing.measures())];
            let inbox = |sums| Inbox { degree: 0.5, sums };
            let heard = vec![0.0; failing.message_len()];
            let bad: [(f64, Vec<f64>, Inbox<'_>); 5] = [
                (now_s, vec![f64::NAN; good.len()], inbox(&heard)),
                (now_s, Vec::new(), inbox(&heard)),
                (now_s, good.clone(), inbox(&[])),
                (now_s, good.clone(), Inbox { degree: f64::INFINITY, sums: &heard }),
                (0.04, good.clone(), inbox(&heard)),
            ];
            for (now_s, measured, inbox) in bad {
                let before = failing.state().to_vec();
                assert!(failing.step(now_s, &measured, inbox).is_err(), "{safe:?} {measured:?} {inbox:?}");
                assert_eq!(failing.command(), [want.unwrap_or(last)], "{safe:?}");
                assert_eq!(failing.diagnostics(Signal::Torque), Some(failing.command()));
                assert_eq!(failing.state(), before);
            }
            // As if nothing had been: nothing limits how fast the force changes.
            step(&mut *failing, 0.06, 0.1).unwrap();
            step(&mut *twin, 0.06, 0.1).unwrap();
            assert_eq!(failing.state(), twin.state());
            assert!((failing.command()[0] - twin.command()[0]).abs() < 1e-15);
        }
    }
}

#[test]
fn after_a_safe_command_the_force_changes_no_faster_than_it_may_from_there() {
    for mut recipe in [mass(), blind(agreeing())] {
        recipe.limits = Some(Limits { torque: vec![4.0], rate: vec![10.0] });
        recipe.safe = SafeCommand::Values(vec![-2.0]);
        let mut controller = recipe.build().unwrap();
        for k in 0..300 {
            step(&mut *controller, 0.01 * f64::from(k), 0.1).unwrap();
        }
        let last = controller.command()[0];
        assert!(last > 0.5, "{last}");
        assert!(step(&mut *controller, 3.5, f64::NAN).is_err());
        assert_eq!(controller.command(), [-2.0]);
        // The safe command stands since 3.5 s and not since the last sample that went well.
        step(&mut *controller, 3.51, 0.1).unwrap();
        assert!((controller.command()[0] - (-1.9)).abs() < 1e-12, "{}", controller.command()[0]);
        step(&mut *controller, 3.53, 0.1).unwrap();
        assert!((controller.command()[0] - (-1.7)).abs() < 1e-12, "{}", controller.command()[0]);
    }
}

#[test]
fn numbers_beyond_all_bounds_end_in_the_safe_command() {
    let mut recipe = mass();
    recipe.safe = SafeCommand::Zero;
    recipe.start = StartState::State(vec![1e308, 0.0, 2.0]);
    let mut controller = recipe.build().unwrap();
    let error = step(&mut *controller, 0.0, 0.0).unwrap_err();
    assert!(matches!(error, StepError::NotFinite { what: "the command", .. }), "{error}");
    assert_eq!(controller.command(), [0.0]);
    // A limit makes a command of anything but not-a-number.
    recipe.limits = Some(Limits { torque: vec![4.0], rate: vec![f64::INFINITY] });
    let mut controller = recipe.build().unwrap();
    step(&mut *controller, 0.0, 0.0).unwrap();
    assert_eq!(controller.command(), [4.0]);
}

#[test]
fn encoders_give_the_velocity_that_the_filter_gives_and_a_sample_that_was_missed_does_not_double_it() {
    for period_s in [None, Some(0.01)] {
        let mut recipe = mass();
        recipe.filter = Some(EncoderFilter { cut_off_rad_s: 50.0, period_s });
        let mut controller = recipe.build().unwrap();
        assert_eq!(controller.measures(), [(Signal::Position, 1)]);
        let mut filter = VelocityFilter::new(50.0, 1).unwrap();
        // The third sample is missed, and the clock is not quite right.
        let times = [0.0, 0.0101, 0.0299, 0.04];
        for (k, pair) in [0.0, 1.0, 2.0, 1.0].into_iter().zip(times).enumerate() {
            let (periods, now_s) = pair;
            let q = [0.3 * now_s];
            let passed_s = if k == 0 { 0.0 } else { now_s - times[k - 1] };
            let passed_s = period_s.map_or(passed_s, |period_s| periods * period_s);
            let want = filter.feed(passed_s, &q).unwrap()[0];
            let mut message = [0.0; 2];
            // As often as anybody likes.
            for _ in 0..2 {
                controller.message(now_s, &q, &mut message).unwrap();
                assert!((message[1] - want).abs() < 1e-15, "{} {want}", message[1]);
            }
            controller.step(now_s, &q, Inbox { degree: 0.0, sums: &[0.0; 2] }).unwrap();
            assert_eq!(controller.diagnostics(Signal::Velocity), Some(&message[1..]));
            assert_eq!(controller.diagnostics(Signal::Position), Some(&q[..]));
            // A step that fails feeds nothing.
            assert!(controller.step(now_s + 0.001, &[f64::NAN], Inbox { degree: 0.0, sums: &[0.0; 2] }).is_err());
        }
    }
}

#[test]
fn a_target_is_followed_and_an_offset_is_taken_from_what_is_sent() {
    let mut recipe = blind(tracking());
    assert!(matches!(recipe.build().err(), Some(RecipeError::Length(LengthError { what: "target", .. }))));
    recipe.target = Some(Target::Follow(Arc::new(Square)));
    let mut controller = recipe.build().unwrap();
    step(&mut *controller, 0.5, 1.0).unwrap();
    assert_eq!(controller.diagnostics(Signal::Error), Some(&[1.0 - 0.25][..]));
    let mut sent = [0.0];
    controller.message(0.5, &[1.0], &mut sent).unwrap();
    assert_eq!(sent, [1.0]);

    // A vehicle knows offsets.
    let mut recipe = vehicle();
    recipe.target = Some(Target::Offset(Arc::new(Corner)));
    let controller = recipe.build().unwrap();
    let mut sent = [0.0; 3];
    let measured = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    controller.message(2.0, &measured, &mut sent).unwrap();
    assert_eq!(sent, [1.0 - 2.0, 1.0 - 3.0, 1.0 - 4.0]);
    recipe.target = Some(Target::Offset(Arc::new(Square)));
    assert!(matches!(recipe.build().err(), Some(RecipeError::Length(LengthError { need: 3, got: 1, .. }))));
}

/// Axis and time added up.
struct Corner;

impl Motion for Corner {
    fn axes(&self) -> usize {
        3
    }

    fn known_derivatives(&self) -> usize {
        usize::MAX
    }

    fn derivatives(&self, axis: usize, at_s: f64, out: &mut [f64]) {
        out.fill(0.0);
        out.iter_mut().zip([axis as f64 + at_s, 1.0]).for_each(|(out, value)| *out = value);
    }
}

fn vehicle() -> Recipe {
    use forwardstep_core::controller::{Thrust, ThrustDesign};
    let plant = Vehicle { mass: 1.2, gravity: 9.81 };
    Recipe::feedback(&plant, Thrust::new(ThrustDesign::Continuous, [1.0, 1.5], plant.mass, plant.gravity).unwrap())
}

#[test]
fn eq_122_sends_the_reference_acceleration_of_the_sample_before() {
    let choice = Choice::Implicit;
    let sliding = Sliding { derived: Derived::ReferenceAcceleration, alpha: 1.0, beta: 2.0, gamma: 0.5, choice };
    let law = SlotineLi { damping: Gain::Number(8.0).resolve(1, &[]).unwrap(), adaptation: None, bounds: None };
    let reference = SmoothFollowing::new(1, sliding);
    let mut controller = Recipe::lagrangian(PointMass { dimension: 1 }, reference, law, vec![2.0]).build().unwrap();
    assert_eq!(controller.message_len(), 3);
    let mut sent = [9.0; 3];
    controller.message(0.0, &[0.3, -0.1], &mut sent).unwrap();
    assert_eq!(sent, [0.3, -0.1, 0.0]);
    for k in 0..3 {
        let now_s = 0.01 * f64::from(k);
        controller.step(now_s, &[0.3, -0.1], Inbox { degree: 0.5, sums: &[0.6, 0.2, 0.1] }).unwrap();
        let dz = controller.diagnostics(Signal::Reference(1)).unwrap()[0];
        controller.message(now_s + 0.01, &[0.4, -0.2], &mut sent).unwrap();
        assert!(k == 0 || dz != 0.0);
        assert_eq!(sent, [0.4, -0.2, dz]);
    }
}

#[test]
fn a_recipe_that_does_not_fit_is_refused_with_what_is_wrong() {
    let refused = |change: &dyn Fn(&mut Recipe)| {
        let mut recipe = mass();
        change(&mut recipe);
        recipe.build().err().unwrap()
    };
    let square = || -> Arc<dyn Motion> { Arc::new(Square) };
    assert_eq!(refused(&|recipe| recipe.target = Some(Target::Follow(square()))), RecipeError::NoTarget);
    let offset = |recipe: &mut Recipe| {
        *recipe = blind(agreeing());
        recipe.target = Some(Target::Offset(square()));
    };
    assert_eq!(refused(&offset), RecipeError::NoOffsets);
    let five = |recipe: &mut Recipe| {
        *recipe = blind(ReferenceModel::Tracking { alpha: vec![1.0, 5.0, 10.0, 10.0, 5.0] });
        recipe.target = Some(Target::Follow(square()));
    };
    assert_eq!(refused(&five), RecipeError::Derivatives { needed: 5, known: 4 });
    let limits = |torque: Vec<f64>, rate| Some(Limits { torque, rate });
    let length = RecipeError::Length(LengthError { what: "torque limits", need: 1, got: 2 });
    assert_eq!(refused(&|recipe| recipe.limits = limits(vec![1.0; 2], vec![1.0; 2])), length);
    let error = refused(&|recipe| recipe.limits = limits(vec![1.0], vec![0.0]));
    assert!(matches!(error, RecipeError::Limiter(LimiterError::NotPositive { axis: 0, .. })));
    let filter = |cut_off_rad_s, period_s| Some(EncoderFilter { cut_off_rad_s, period_s });
    let error = refused(&|recipe| recipe.filter = filter(-1.0, None));
    assert_eq!(error, RecipeError::Filter(FilterError::CutOff { value: -1.0 }));
    let error = refused(&|recipe| recipe.filter = filter(1.0, Some(0.0)));
    assert_eq!(error, RecipeError::Period { period_s: 0.0 });
    let safe = |recipe: &mut Recipe| {
        recipe.limits = limits(vec![1.0], vec![1.0]);
        recipe.safe = SafeCommand::Values(vec![-1.5]);
    };
    assert_eq!(refused(&safe), RecipeError::Unsafe { axis: 0, value: -1.5, limit: 1.0 });
    for safe in [vec![], vec![0.0; 2]] {
        assert!(matches!(refused(&|recipe| recipe.safe = SafeCommand::Values(safe.clone())), RecipeError::Length(_)));
    }
    for recipe in [mass(), blind(agreeing())] {
        let start = |start| {
            let mut recipe = recipe.clone();
            recipe.start = start;
            recipe.build().err().unwrap()
        };
        assert!(matches!(start(StartState::State(vec![0.0; 9])), RecipeError::Length(_)));
        assert!(matches!(start(StartState::State(vec![f64::NAN])), RecipeError::NotFinite { .. }));
        let wanted = |z| StartState::FirstSample { wanted: vec![vec![z]; 1] };
        assert!(matches!(start(wanted(f64::INFINITY)), RecipeError::NotFinite { .. }));
        let wanted = StartState::FirstSample { wanted: vec![vec![0.0; 2]] };
        assert!(matches!(start(wanted), RecipeError::Length(_)));
    }
    let many = StartState::FirstSample { wanted: vec![vec![0.0]; 3] };
    assert!(matches!(refused(&|recipe| recipe.start = many.clone()), RecipeError::Length(_)));
}

#[test]
fn the_first_sample_starts_as_is_wanted_and_a_state_goes_on_where_it_was() {
    let mut recipe = mass();
    recipe.start = StartState::FirstSample { wanted: vec![vec![0.7], vec![-0.3]] };
    let mut controller = recipe.build().unwrap();
    step(&mut *controller, 0.0, 0.1).unwrap();
    assert_eq!(controller.state(), [0.7, -0.3, 2.0]);
    assert_eq!(controller.diagnostics(Signal::Reference(0)), Some(&[0.7][..]));
    assert_eq!(controller.diagnostics(Signal::Estimate), Some(&[2.0][..]));
    assert_eq!(controller.diagnostics(Signal::Reference(2)), None);
    assert_eq!(controller.diagnostics(Signal::Selection), None);
    for k in 1..4 {
        step(&mut *controller, 0.01 * f64::from(k), 0.1).unwrap();
    }
    recipe.start = StartState::State(controller.state().to_vec());
    let mut next = recipe.build().unwrap();
    assert_eq!(next.state(), controller.state());
    step(&mut *next, 5.0, 0.1).unwrap();
    assert_eq!(next.state(), controller.state());
    assert_eq!(next.command(), controller.command());
}

#[test]
fn outputs_are_listed_as_they_are_counted() {
    fn assert_counted(plant: &impl Plant) {
        assert_eq!(total(&plant.outputs()), plant.output_len());
        assert_eq!(plant.outputs()[0], (Signal::Position, plant.axes()));
    }
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let arm = Mechanical { robot: PlanarArm, theta: links.theta().to_vec() };
    let vehicle = Vehicle { mass: 1.0, gravity: 9.81 };
    assert_counted(&arm);
    assert_counted(&vehicle);
    assert_counted(&Rotorcraft::new(vehicle, &Gain::Number(0.02), None).unwrap());
    let inertia = [[3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
    assert_counted(&Spacecraft::new(inertia, Wheels::orthogonal(), false).unwrap());
    let tip = PlanarTip { length_m: links.length_m };
    assert_counted(&TaskArm { arm, tip, tip_theta: links.length_m.to_vec() });
}
