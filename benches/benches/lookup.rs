//! What it costs to look a material up, in tables of each shape, and to read a table.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ltc_fit::draw;
use ltc_table::{Kind, Precision, TableVersion};

const COUNT: usize = 1000;

fn lookups(c: &mut Criterion) {
    let tables = ltc_tables::shipped().expect("shipped tables are sound");
    let mut group = c.benchmark_group("lookup");
    group.throughput(Throughput::Elements(COUNT as u64));
    for name in ["ggx-isotropic", "ggx-anisotropic"] {
        let table = tables.find(name).expect("it is shipped").table();
        let queries = draw::standard(COUNT, 5, table.kind() == Kind::Isotropic);
        for precision in [Precision::F16, Precision::F64] {
            let table = table.rounded(precision).expect("it can be rounded");
            let differ = |q| table.lookup(q).expect("it answers").magnitude;
            let exact = tables.find(name).expect("it is shipped").table();
            let error = queries
                .iter()
                .map(|q| (differ(q) - exact.lookup(q).expect("it answers").magnitude).abs())
                .fold(0.0, f64::max);
            println!("lookup/{name}/{}: magnitude off by {error:.1e} at most", precision.name());
            group.bench_function(format!("{name}/{}", precision.name()), |b| {
                b.iter(|| {
                    for query in &queries {
                        let _ = black_box(table.lookup(black_box(query)));
                    }
                });
            });
        }
    }
}

fn decoding(c: &mut Criterion) {
    let tables = ltc_tables::shipped().expect("shipped tables are sound");
    let mut group = c.benchmark_group("decode");
    for name in ["ggx-isotropic", "ggx-anisotropic"] {
        let version = tables.find(name).expect("it is shipped");
        let (manifest, payload) = (version.manifest().clone(), version.payload().to_vec());
        group.throughput(Throughput::Bytes(payload.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| TableVersion::new(black_box(manifest.clone()), black_box(payload.clone())));
        });
    }
}

criterion_group!(all, lookups, decoding);
criterion_main!(all);
