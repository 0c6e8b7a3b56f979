//! Steps do not allocate: only history, waiting events and the recording grow, in chunks.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod cases;

use std::alloc::{GlobalAlloc, Layout, System};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use cases::{cases, setup};
use forwardstep_sim::push::{Between, Course, Effect, Push, Table};
use forwardstep_sim::simulate;

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: passes everything on to the system allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn alloc_steps_do_not_allocate() {
    for case in cases() {
        let mut setup = setup(&case);
        setup.time.record_every_s = 0.01;
        let axes = setup.agents[0].robot.axes.len();
        let times_s: Vec<f64> = (0..200).map(|k| 0.05 * k as f64).collect();
        let values = (0..200 * axes).map(|k| 0.01 * k as f64).collect();
        let table = Course::Table(Table { times_s, values, between: Between::Linear });
        let (stiffness, damping) = (vec![3.0; axes], vec![1.0; axes]);
        let hand = Effect::HandOnAxes { axes: (0..axes).collect(), stiffness, damping, target: table };
        setup.agents[0].pushes = vec![Push { effect: hand, from_s: 0.1, until_s: f64::INFINITY }];
        let (mut before, mut steps) = (None, 0_u64);
        simulate(&setup, &mut |progress| {
            // The first quarter fills the ring of history and the queue of events.
            if progress.t_s > 0.25 * progress.end_s {
                before.get_or_insert_with(|| ALLOCATIONS.load(Ordering::Relaxed));
                steps += 1;
            }
            ControlFlow::Continue(())
        })
        .unwrap();
        let grown = ALLOCATIONS.load(Ordering::Relaxed) - before.unwrap();
        assert!(steps > 100, "{}: {steps} steps", case.name);
        assert!(grown <= 6, "{}: {grown} allocations in {steps} steps", case.name);
    }
}
