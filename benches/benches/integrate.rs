//! What one light over one lobe costs on the CPU, form by form, with its error.
//!
//! A pass is over 1,000 lights: microseconds of a pass are nanoseconds of a light. Forms, inputs and oracle are those of
//! [`ltc_benches::study::integrals`]; the errors are printed beside the times.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ltc_benches::study::integrals::{Lights, forms};

const COUNT: usize = 1000;

fn benches(c: &mut Criterion) {
    let tables = ltc_tables::shipped().expect("shipped tables are sound");
    let table = tables.find("ggx-anisotropic").expect("it is shipped").table();
    let lights = Lights::new(table, COUNT).expect("a shipped table answers");
    let mut group = c.benchmark_group("integral");
    group.throughput(Throughput::Elements(COUNT as u64));
    for mut form in forms(&lights, &[3, 4, 8, 16, 32, 64]).expect("the lights are sound") {
        let (max, rms) = form.errors().expect("every form is within its bound");
        println!("integral/{}: error {max:.1e} at most, {rms:.1e} RMS", form.name);
        group.bench_function(form.name.clone(), |b| b.iter(|| form.run()));
    }
}

criterion_group!(all, benches);
criterion_main!(all);
