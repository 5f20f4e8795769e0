//! How much acne and peter-panning do the documents' systems have, and why?
fn main() {
    let step = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(4);
    for case in gnomon::scene::cases::all() {
        let t = std::time::Instant::now();
        let m = gnomon::analysis::measure::measure(&case, step);
        println!(
            "{} {:?}\n{}",
            case.name,
            t.elapsed(),
            serde_json::to_string(&m.measurement).unwrap()
        );
    }
}
