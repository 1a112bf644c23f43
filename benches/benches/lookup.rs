//! What it costs to look a material up.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ltc_fit::draw;

const COUNT: usize = 1024;

fn benches(c: &mut Criterion) {
    let tables = ltc_tables::shipped().expect("shipped tables are sound");
    let table = tables.find("ggx-anisotropic").expect("it is shipped").table();
    let queries = draw::standard(COUNT, 5, false);
    let mut next = (0..COUNT).cycle();
    c.bench_function("lookup/anisotropic/f64", |b| {
        b.iter(|| table.lookup(black_box(&queries[next.next().unwrap_or(0)])));
    });
}

criterion_group!(all, benches);
criterion_main!(all);
