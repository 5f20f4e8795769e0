//! Does the emulation write, bit for bit, what a real WebGL wrote?
fn main() {
    let folder = std::env::args().nth(1).unwrap_or_default();
    let device = gnomon::device::DeviceProfile::WebglSwiftshader.device();
    match gnomon::conformance::compare(std::path::Path::new(&folder), &device) {
        Ok(outcome) => {
            for e in outcome.entries {
                println!(
                    "{} {} compared {} differing {} missing {} {}",
                    e.section,
                    e.file,
                    e.compared,
                    e.differing,
                    e.missing,
                    e.first.unwrap_or_default()
                );
            }
        }
        Err(e) => println!("error: {e}"),
    }
}
