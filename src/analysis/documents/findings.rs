//! What the documents get wrong or leave out: claims whose sentences follow the measured numbers.
//!
//! A claim is data: an expression over `results.json` (cases and variants by name) and one sentence
//! for each way it can come out. The expression language and the sentences are minijinja's.

use crate::report::number;
use crate::report::{Cell, Finding, Verdict};
use minijinja::{Environment, UndefinedBehavior};
use serde_json::{Map, Value};

/// One claim about the documents.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Stable id.
    pub id: &'static str,
    /// What is claimed, and against which document.
    pub claim: &'static str,
    /// True while the numbers bear the claim out.
    pub expression: &'static str,
    /// The sentence then.
    pub supported: &'static str,
    /// The sentence otherwise.
    pub contradicted: &'static str,
    /// Numbers shown beside it: name, expression.
    pub values: &'static [(&'static str, &'static str)],
    /// A place in the results and a value there that turns the claim over; tests feed it.
    pub counter_example: (&'static str, f64),
}

/// The eleven points, and what else the measurements show.
pub const CLAIMS: &[Claim] = &[
    Claim {
        id: "base-256-bytes",
        claim: "The book's four-byte packing keeps no more of the depth than one byte, because bytes \
                made for base 256 are stored in steps of 1/255 (000, 001, 004).",
        expression: "probes.packing_max_error.book >= 0.9 * probes.packing_max_error.r8 and probes.packing_max_error.aras_2009 < 1e-6",
        supported: "Largest error over [0,1): book {{ probes.packing_max_error.book|sig }}, one byte {{ probes.packing_max_error.r8|sig }}, the same scheme in base 255 {{ probes.packing_max_error.aras_2009|sig }}. Four bytes in base 256 are no better than one; the mismatch is there even in exact arithmetic, so the book's mediump explanation of its bias 0.0015 is not needed.",
        contradicted: "Here the book's packing ({{ probes.packing_max_error.book|sig }}) does beat one byte ({{ probes.packing_max_error.r8|sig }}), or base 255 is not sound.",
        values: &[
            ("book", "probes.packing_max_error.book"),
            ("r8", "probes.packing_max_error.r8"),
            ("base 255", "probes.packing_max_error.aras_2009"),
        ],
        counter_example: ("/probes/packing_max_error/book", 1e-7),
    },
    Claim {
        id: "one-wraps",
        claim: "Depth 1.0 wraps: fract(1) = 0, so the far plane packs to the nearest depth (000, 001, 004).",
        expression: "probes.packing_of_one.book < 0.01 and probes.packing_of_one.upc < 0.01 and probes.packing_of_one.three_rgba == 1",
        supported: "Depth 1 decodes to {{ probes.packing_of_one.book|sig }} (book) and {{ probes.packing_of_one.upc|sig }} (UPC): an occluder at the near plane. A packing with end cases (three.js since r167) gives {{ probes.packing_of_one.three_rgba|sig }}.",
        contradicted: "Here depth 1 survives: book {{ probes.packing_of_one.book|sig }}, UPC {{ probes.packing_of_one.upc|sig }}.",
        values: &[("book", "probes.packing_of_one.book"), ("upc", "probes.packing_of_one.upc")],
        counter_example: ("/probes/packing_of_one/book", 1.0),
    },
    Claim {
        id: "clear-is-near",
        claim: "The map is cleared to black, which decodes to the nearest depth, not to far (000, 001, 004).",
        expression: "probes.clear.book_opaque_black < 0.01 and probes.clear.upc_transparent_black < 0.01 and probes.clear.upc_opaque_black > 0.99 and cases['runnable-rgba8'].false_shadow.by_artifact['encoding-fault'] > 0",
        supported: "Cleared texels decode to {{ probes.clear.book_opaque_black|sig }} (book, (0,0,0,1)) and {{ probes.clear.upc_transparent_black|sig }} (UPC, (0,0,0,0)); opaque black would have been {{ probes.clear.upc_opaque_black|sig }} in UPC's order. In 004 that darkens {{ cases['runnable-rgba8'].false_shadow.by_artifact['encoding-fault'] }} lit receivers along the border of the drawn surfaces.",
        contradicted: "Here cleared texels do no harm: they decode to {{ probes.clear.book_opaque_black|sig }}, and {{ cases['runnable-rgba8'].false_shadow.by_artifact['encoding-fault'] }} receivers of 004 are darkened by them.",
        values: &[
            ("book clear", "probes.clear.book_opaque_black"),
            (
                "004 receivers darkened",
                "cases['runnable-rgba8'].false_shadow.by_artifact['encoding-fault']",
            ),
        ],
        counter_example: ("/probes/clear/book_opaque_black", 1.0),
    },
    Claim {
        id: "mediump",
        claim: "In a true 16-bit mediump the packings' factor 256³ overflows (000, 001, 004).",
        expression: "probes.mediump.book_overflow_share > 0.5 and probes.mediump.factor > probes.mediump.largest_finite",
        supported: "256³ = {{ probes.mediump.factor|int }} is beyond the largest half-precision number {{ probes.mediump.largest_finite|int }}: {{ probes.mediump.book_overflow_share|pct }} of all depths pack to infinity or NaN, and the depth itself keeps steps of {{ probes.mediump.step_at_three_quarters|sig }} in [1/2, 1). Desktop GPUs, and the WebGL emulated here, run mediump as 32-bit and hide it.",
        contradicted: "Here mediump packs {{ (1 - probes.mediump.book_overflow_share)|pct }} of all depths without overflow.",
        values: &[("share overflowing", "probes.mediump.book_overflow_share")],
        counter_example: ("/probes/mediump/book_overflow_share", 0.0),
    },
    Claim {
        id: "linear-filter",
        claim: "LINEAR on packed bytes decodes correctly, but an average of depths is not an average of verdicts (000, 001, 004).",
        expression: "probes.linear.full_weights < 1e-6 and probes.linear.requantized > 1e-4 and cases['runnable-rgba8'].false_shadow.count > variants['runnable-rgba8-nearest'].false_shadow.count",
        supported: "Filtering then decoding equals decoding then filtering to {{ probes.linear.full_weights|sig }} with full weights ({{ probes.linear.requantized|sig }} where the filtered bytes are stored again). Yet at silhouettes it invents surfaces: in 004 NEAREST falsely shadows {{ variants['runnable-rgba8-nearest'].false_shadow.count }} receivers, LINEAR {{ cases['runnable-rgba8'].false_shadow.count }}.",
        contradicted: "Here LINEAR does not add false shadow: NEAREST {{ variants['runnable-rgba8-nearest'].false_shadow.count }}, LINEAR {{ cases['runnable-rgba8'].false_shadow.count }}.",
        values: &[
            ("nearest", "variants['runnable-rgba8-nearest'].false_shadow.count"),
            ("linear", "cases['runnable-rgba8'].false_shadow.count"),
        ],
        counter_example: ("/cases/runnable-rgba8/false_shadow/count", 0.0),
    },
    Claim {
        id: "bias-exceeds-gap",
        claim: "At light Y=40 the 8-bit map shows no shadow because of the bias, not because of the 8 bits (000, figure 10.24).",
        expression: "cases['book-r8-y40'].exact_gap.max < cases['book-r8-y40'].bias and cases['book-r8-y40'].wrong_on_rung.bias >= cases['book-r8-y40'].shadowed",
        supported: "The exact gap between triangle and plane is {{ cases['book-r8-y40'].exact_gap.max|sig }} in window depth, below the bias {{ cases['book-r8-y40'].bias|sig }}: all {{ cases['book-r8-y40'].shadowed }} truly shadowed receivers are lit with infinite depth precision too.",
        contradicted: "Here the gap {{ cases['book-r8-y40'].exact_gap.max|sig }} is not below the bias {{ cases['book-r8-y40'].bias|sig }}, or some shadow would survive with infinite precision ({{ cases['book-r8-y40'].wrong_on_rung.bias }} of {{ cases['book-r8-y40'].shadowed }} receivers lost): the bias alone does not explain it.",
        values: &[
            ("gap", "cases['book-r8-y40'].exact_gap.max"),
            ("bias", "cases['book-r8-y40'].bias"),
        ],
        counter_example: ("/cases/book-r8-y40/exact_gap/max", 0.02),
    },
    Claim {
        id: "outside-the-map",
        claim: "Receivers outside the map are tested in 002 only; elsewhere they get whatever the wrapped or clamped texel says.",
        expression: "cases['fundamentals-spot'].samples.outside_map_shadowed == 0 and cases['fundamentals-directional'].samples.outside_map_shadowed == 0 and cases['exam-pcf'].samples.outside_map > 0",
        supported: "002 tests the range: of its {{ cases['fundamentals-directional'].samples.outside_map }} receivers outside the directional map none is darkened. 003 does not test: {{ cases['exam-pcf'].samples.outside_map }} receivers lie outside its map and {{ cases['exam-pcf'].samples.outside_map_shadowed }} of them come out darkened; they are kept out of every rate here. No document tests w ≤ 0 or z outside [0,1].",
        contradicted: "Here the range test of 002 does not hold, or no receiver of 003 lies outside the map.",
        values: &[("003 outside", "cases['exam-pcf'].samples.outside_map")],
        counter_example: ("/cases/fundamentals-spot/samples/outside_map_shadowed", 5.0),
    },
    Claim {
        id: "slope-not-quantization",
        claim: "002 blames its acne on quantisation; at 512² the slope over a texel decides.",
        expression: "cases['fundamentals-spot'].interior.sphere.false_shadow > 0 and cases['fundamentals-spot'].false_shadow.by_cause.quantization < cases['fundamentals-spot'].false_shadow.by_cause.sampling and cases['fundamentals-directional'].false_shadow.by_cause.quantization < cases['fundamentals-directional'].false_shadow.by_cause.sampling",
        supported: "With its bias 0.006, {{ cases['fundamentals-spot'].interior.sphere.false_shadow }} interior receivers on the sphere (spot) and {{ cases['fundamentals-directional'].interior.cube.false_shadow }} on the cube (directional) stay dark. Of all false shadow, sampling causes {{ cases['fundamentals-spot'].false_shadow.by_cause.sampling }} and {{ cases['fundamentals-directional'].false_shadow.by_cause.sampling }}, quantization {{ cases['fundamentals-spot'].false_shadow.by_cause.quantization }} and {{ cases['fundamentals-directional'].false_shadow.by_cause.quantization }}. (Likewise the book's stripes: one byte has {{ probes.byte.steps }} steps and rounds, 1/256 is {{ probes.byte.step_256|sig }}, not the printed {{ probes.byte.printed_step|sig }}, and the surface's slope decides which bias suffices.)",
        contradicted: "Here quantization causes at least as much false shadow in 002 as sampling, or no interior receiver of its sphere stays dark.",
        values: &[
            ("sphere, spot", "cases['fundamentals-spot'].interior.sphere.false_shadow"),
            ("cube, directional", "cases['fundamentals-directional'].interior.cube.false_shadow"),
        ],
        counter_example: ("/cases/fundamentals-spot/false_shadow/by_cause/quantization", 1e6),
    },
    Claim {
        id: "front-face-culling",
        claim: "003 calls its front-face culling negligible; it leaks light on the side of casters that faces away.",
        expression: "cases['exam-pcf'].shadow_interior.leak_rate > 0.01 and variants['exam-pcf-cull-none'].shadow_interior.leak_rate < 0.5 * cases['exam-pcf'].shadow_interior.leak_rate",
        supported: "With front faces culled {{ cases['exam-pcf'].shadow_interior.leak_rate|pct }} of the shadow's interior is lit ({{ cases['exam-pcf'].shadow_interior.leaks_by_object.sphere }} of {{ cases['exam-pcf'].shadow_interior.leaks }} such receivers on the sphere, which turn away from the light); without culling {{ variants['exam-pcf-cull-none'].shadow_interior.leak_rate|pct }}.",
        contradicted: "Here culling front faces does not add leaks: {{ cases['exam-pcf'].shadow_interior.leak_rate|pct }} with, {{ variants['exam-pcf-cull-none'].shadow_interior.leak_rate|pct }} without.",
        values: &[
            ("culled", "cases['exam-pcf'].shadow_interior.leak_rate"),
            ("not culled", "variants['exam-pcf-cull-none'].shadow_interior.leak_rate"),
        ],
        counter_example: ("/cases/exam-pcf/shadow_interior/leak_rate", 0.0),
    },
    Claim {
        id: "solid-shadow-without-bias",
        claim: "Without a bias the book's high-precision scenes are not striped but solidly dark; the 8-bit one is half striped (000, figure 10.23).",
        expression: "cases['book-rgba8-y7'].interior_total.acne_rate_without_bias > 0.95 and cases['book-r8-y7'].interior_total.acne_rate_without_bias > 0.25 and cases['book-r8-y7'].interior_total.acne_rate_without_bias < 0.75",
        supported: "Without bias {{ cases['book-rgba8-y7'].interior_total.acne_rate_without_bias|pct }} of the interior lit receivers are dark with the four-byte packing at Y=7, because its error has one sign in that depth range, and {{ cases['book-r8-y7'].interior_total.acne_rate_without_bias|pct }} with one byte.",
        contradicted: "Here the shares without bias are {{ cases['book-rgba8-y7'].interior_total.acne_rate_without_bias|pct }} (four bytes) and {{ cases['book-r8-y7'].interior_total.acne_rate_without_bias|pct }} (one byte).",
        values: &[
            ("four bytes", "cases['book-rgba8-y7'].interior_total.acne_rate_without_bias"),
            ("one byte", "cases['book-r8-y7'].interior_total.acne_rate_without_bias"),
        ],
        counter_example: ("/cases/book-rgba8-y7/interior_total/acne_rate_without_bias", 0.5),
    },
    Claim {
        id: "upc-acne",
        claim: "001 at its own bias 0.001 still has acne.",
        expression: "cases.upc.interior_total.acne_rate > 0.01 and cases.upc.thresholds.critical > cases.upc.bias",
        supported: "{{ cases.upc.interior_total.acne_rate|pct }} of the interior lit receivers are dark at bias {{ cases.upc.bias|sig }}, {{ (cases.upc.interior.triangle.false_shadow / cases.upc.interior.triangle.lit)|pct }} of the triangle's; the packing needs {{ cases.upc.thresholds.critical|sig }} (in the assumed geometry).",
        contradicted: "Here the bias {{ cases.upc.bias|sig }} suffices: {{ cases.upc.interior_total.acne_rate|pct }} of the interior lit receivers are dark.",
        values: &[
            ("interior acne", "cases.upc.interior_total.acne_rate"),
            ("critical bias", "cases.upc.thresholds.critical"),
        ],
        counter_example: ("/cases/upc/interior_total/acne_rate", 0.0),
    },
    Claim {
        id: "depth-attachment",
        claim: "The map passes of 000, 001 and 004 run on a 16-bit depth renderbuffer: surfaces closer than its step may be drawn in the wrong order.",
        expression: "cases['runnable-rgba8'].misordered_texels == 0 and cases.upc.misordered_texels == 0",
        supported: "The renderbuffer's step is 1/65535, but no two surfaces of these scenes come that close: 0 texels keep another triangle than a float attachment would. The danger is real, these scenes do not show it.",
        contradicted: "{{ cases['runnable-rgba8'].misordered_texels }} texels of 004 and {{ cases.upc.misordered_texels }} of 001 keep another triangle than a float attachment would.",
        values: &[("004", "cases['runnable-rgba8'].misordered_texels")],
        counter_example: ("/cases/runnable-rgba8/misordered_texels", 7.0),
    },
];

/// Evaluates every claim over results whose `cases` and `variants` are objects by name.
#[must_use]
pub fn evaluate(results: &Value) -> Vec<Finding> {
    let environment = environment();
    let context = minijinja::Value::from(minijinja::value::Serde(results));
    CLAIMS.iter().map(|claim| finding(&environment, claim, &context)).collect()
}

/// `results.json` with its lists of cases and variants turned into objects by name.
#[must_use]
pub fn by_name(results: &Value) -> Value {
    let mut named = results.clone();
    for list in ["cases", "variants"] {
        let entries = results[list].as_array().into_iter().flatten();
        let entry = |v: &Value| Some((v["name"].as_str()?.to_string(), v.clone()));
        named[list] = Value::Object(entries.filter_map(entry).collect::<Map<_, _>>());
    }
    named
}

fn environment() -> Environment<'static> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_filter("sig", |x: f64| number::pretty(x, 4));
    environment.add_filter("pct", |x: f64| format!("{} %", number::pretty(x * 100.0, 3)));
    environment
}

fn finding(environment: &Environment<'_>, claim: &Claim, results: &minijinja::Value) -> Finding {
    let truth = environment
        .compile_expression(claim.expression)
        .and_then(|expression| expression.eval(results))
        .map(|value| value.is_true());
    let (verdict, template) = match truth {
        Ok(true) => (Verdict::Supported, claim.supported),
        Ok(false) => (Verdict::Contradicted, claim.contradicted),
        Err(_) => (Verdict::Undecided, "This run did not measure what the claim needs."),
    };
    let sentence = environment.render_str(template, results);
    let number = |text: &str| -> Option<f64> {
        environment.compile_expression(text).ok()?.eval(results).ok()?.try_into().ok()
    };
    Finding {
        id: claim.id.to_string(),
        claim: claim.claim.to_string(),
        verdict,
        sentence: sentence.unwrap_or_else(|e| format!("Undecided: {e}.")),
        expression: claim.expression.to_string(),
        values: claim
            .values
            .iter()
            .map(|&(name, text)| (name.to_string(), Cell::number(number(text))))
            .collect(),
    }
}
