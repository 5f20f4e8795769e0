//! tmp
use gnomon::analysis::sweep::*;
use gnomon::shadow::bias::Strategy;
fn main() {
    let f = |n: &str| plan::format_named(n).unwrap();
    let a: Vec<String> = std::env::args().collect();
    let plan = Plan {
        cases: plan::cases_named(&[a[1].clone()]).unwrap(),
        sizes: vec![256, 512, 1024, 2048],
        formats: ["r8", "book", "unorm16", "unorm24", "f16", "f32"].map(f).to_vec(),
        filters: vec![None],
        strategies: vec![
            Strategy::Constant,
            Strategy::SlopeRaster,
            Strategy::ReceiverSlope,
            Strategy::NormalOffset,
            Strategy::ReceiverPlane,
            Strategy::Adaptive,
            Strategy::FrontCulling,
            Strategy::Midpoint,
        ],
        bias: "1e-6:1e-1:log:200".parse().unwrap(),
        step: a[2].parse().unwrap(),
        max_acne: 0.0,
    };
    let t = std::time::Instant::now();
    let r = run(&plan, || {});
    println!("{:?}", t.elapsed());
    for c in &r {
        for s in &c.swept {
            println!(
                "{} {} {} {} {} free {:?} gap {:?} pp {:?} ff {:?}",
                c.name,
                s.size,
                s.format.name(),
                s.filter,
                s.strategy,
                s.acne_free.map(|p| p.amount),
                s.acne_free.map(|p| p.gap),
                s.detachment,
                s.acne_free.map(|p| p.tally.kinds)
            );
        }
    }
}
