//! The step every adaptive law takes, per robot: Yϑ and Yᵀs; and the plant's forward dynamics.
#![allow(clippy::unwrap_used)] // A broken fixture should stop a benchmark.

mod arms;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn slotine_li(criterion: &mut Criterion) {
    for (name, assembled) in arms::arms() {
        let mut group = criterion.benchmark_group(&name);
        group.throughput(Throughput::Elements(1));
        let mut one = arms::one(&assembled);
        group.bench_function("slotine_li, f64", |b| b.iter(|| one.slotine_li()));
        group.bench_function("forward dynamics, f64", |b| b.iter(|| one.acceleration()));
        group.throughput(Throughput::Elements(8));
        let mut eight = arms::lanes::<8>(&assembled);
        group.bench_function("slotine_li, 8 lanes", |b| b.iter(|| eight.slotine_li()));
        group.bench_function("forward dynamics, 8 lanes", |b| b.iter(|| eight.acceleration()));
        group.finish();
    }
}

criterion_group!(benches, slotine_li);
criterion_main!(benches);
