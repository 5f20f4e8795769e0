//! What documents and engines claim about packings, and what the certificates say.

use super::{Dossier, FP16, Measured, RECIPROCAL};
use crate::analysis::roundtrip::verdict::Advice;
use crate::report::{Cell, Finding, Section, Verdict};

fn found<'a>(measured: &'a Measured, name: &str) -> Option<&'a Dossier> {
    measured.dossiers.iter().find(|d| d.name == name)
}

/// The few sentences on top.
pub(super) fn lead(measured: &Measured) -> Vec<String> {
    let names = |advice: Advice| -> Vec<&str> {
        measured.dossiers.iter().filter(|d| d.advice == advice).map(|d| d.name.as_str()).collect()
    };
    let total = measured.dossiers.len();
    let (good, care) = (names(Advice::Use), names(Advice::Care));
    let or_none =
        |list: &[&str]| if list.is_empty() { "none".to_string() } else { list.join(", ") };
    let mut lead = vec![
        format!(
            "{} of {total} packings keep their bits on every store and sampler: {}.",
            good.len(),
            or_none(&good)
        ),
        format!("With samplers of full precision also: {}.", or_none(&care)),
    ];
    if let Some(book) = found(measured, "book") {
        let c = &book.certificates[0];
        lead.push(format!(
            "The book's four bytes keep {:.1} bits (largest error {:.3e} at {:.4}) and read the far \
             plane as {}.",
            c.equivalent_bits, c.max.error, c.max.at, c.at_one
        ));
    }
    lead
}

/// Claims against certificates.
pub(super) fn section(measured: &Measured) -> Section {
    let mut section = Section::new(
        "claims",
        "Claims against certificates",
        "What documents and engines say about packings.",
    );
    section.push(
        [
            book_precision(measured),
            aras_samplers(measured),
            aras_one(measured),
            three_far(measured),
            truncation(measured),
            digits_exact(measured),
            mediump(measured),
        ]
        .into_iter()
        .flatten()
        .collect::<Vec<Finding>>(),
    );
    section
}

fn decided(supported: bool) -> Verdict {
    if supported { Verdict::Supported } else { Verdict::Contradicted }
}

fn book_precision(measured: &Measured) -> Option<Finding> {
    let (book, r8) = (found(measured, "book")?, found(measured, "r8")?);
    let (four, one) = (book.certificates[0].max.error, r8.certificates[0].max.error);
    Some(Finding {
        id: "book-precision".into(),
        claim: "Programming Guide, ch. 10: four channels in base 256 give the precision that one \
                lacks"
            .into(),
        verdict: decided(four < one / 2.0),
        sentence: format!(
            "Four channels err by up to {four:.4e}, one by {one:.4e}: bytes hold k/255, the digits \
             are k/256, and the next digit does not make up for it."
        ),
        expression: "packings[book].certificates[0].max < packings[r8]….max / 2".into(),
        values: vec![("book".into(), Cell::Number(four, 5)), ("r8".into(), Cell::Number(one, 5))],
    })
}

fn aras_samplers(measured: &Measured) -> Option<Finding> {
    let aras = found(measured, "aras-2009")?;
    let (divided, product) = (&aras.certificates[0], &aras.certificates[RECIPROCAL]);
    let (few, more) = (divided.order?.inversions, product.order?.inversions);
    Some(Finding {
        id: "aras-samplers".into(),
        claim: "Aras 2009 keeps 23 bits in order".into(),
        verdict: decided(few == 0 && more == 0),
        sentence: format!(
            "Below 1 it errs by up to {:.4e} with {few} neighbours in the wrong order where bytes are \
             read as rounded k/255, by {:.4e} with {more} where as k·f32(1/255).",
            divided.max.error, product.max.error
        ),
        expression: "packings[aras-2009].certificates[0].inversions == 0".into(),
        values: vec![
            ("k/255".into(), Cell::count(few)),
            ("k·f32(1/255)".into(), Cell::count(more)),
        ],
    })
}

fn digits_exact(measured: &Measured) -> Option<Finding> {
    let digits = found(measured, "digits-32")?;
    let from = f64::from(digits.certificates[0].exact_from?);
    Some(Finding {
        id: "digits-exact".into(),
        claim: "32 bits hold a 32-bit float".into(),
        verdict: decided(from == 0.0),
        sentence: format!(
            "Integer digits return every f32 from {from} (2^{:.0}) on unchanged; nearer to 0 floats \
             are finer than 2^-32, and the largest error is {:.3e}.",
            libm::log2(from),
            digits.certificates[0].max.error
        ),
        expression: "packings[digits-32].certificates[0].exact_from == 0".into(),
        values: vec![("exact_from".into(), Cell::Number(from, 6))],
    })
}

fn mediump(measured: &Measured) -> Option<Finding> {
    let fp16 = |d: &Dossier| d.certificates[FP16].sound.broken > 0;
    let broken = measured.dossiers.iter().filter(|d| fp16(d)).count();
    let book = found(measured, "book")?;
    Some(Finding {
        id: "mediump".into(),
        claim: "Documents 001 and 004: precision mediump is enough to pack".into(),
        verdict: decided(!fp16(book)),
        sentence: format!(
            "In half precision {broken} of {} packings meet infinity: 256³ and 255³ exceed 65504.",
            measured.dossiers.len()
        ),
        expression: "packings[book].certificates[7].not_sound == 0".into(),
        values: vec![("packings that overflow".into(), Cell::count(broken))],
    })
}

fn aras_one(measured: &Measured) -> Option<Finding> {
    let unity = found(measured, "unity-rgba")?;
    let at_one = unity.certificates[0].at_one;
    Some(Finding {
        id: "unity-one".into(),
        claim: "UnityCG.cginc: 1.0 will not be encoded properly".into(),
        verdict: decided(at_one < 0.99),
        sentence: format!("1.0 decodes to {at_one}: the far plane becomes the nearest depth."),
        expression: "packings[unity-rgba].certificates[0].at_one < 0.99".into(),
        values: vec![("at_one".into(), Cell::Number(at_one, 6))],
    })
}

fn three_far(measured: &Measured) -> Option<Finding> {
    let (old, new) = (found(measured, "three-r86")?, found(measured, "three-rgba")?);
    let (old, new) = (old.certificates[0].at_one, new.certificates[0].at_one);
    Some(Finding {
        id: "three-far".into(),
        claim: "three.js #28692: the packing is wrong at 1.0; #28789 mends it".into(),
        verdict: decided(old != 1.0 && new == 1.0),
        sentence: format!("1.0 reads {old} with r86…r166 and {new} with r167 and later."),
        expression: "packings[three-r86]….at_one != 1 and packings[three-rgba]….at_one == 1".into(),
        values: vec![("r86".into(), Cell::Number(old, 9)), ("r167".into(), Cell::Number(new, 9))],
    })
}

fn truncation(measured: &Measured) -> Option<Finding> {
    let (aras, digits) = (found(measured, "aras-2009")?, found(measured, "digits-24")?);
    let (bad, good) = (&aras.certificates[1].max.error, &digits.certificates[1].max.error);
    Some(Finding {
        id: "truncation".into(),
        claim: "Base 255 needs hardware that rounds (Vulkan only asks for one of the two nearest \
                bytes)"
            .into(),
        verdict: decided(*bad > 1e-3 && *good < 1e-7),
        sentence: format!(
            "Truncated, Aras 2009 errs by up to {bad:.3e}; integer digits still by {good:.3e}."
        ),
        expression: "packings[aras-2009].certificates[1].max > 0.001".into(),
        values: vec![
            ("aras-2009".into(), Cell::Number(*bad, 4)),
            ("digits-24".into(), Cell::Number(*good, 4)),
        ],
    })
}
