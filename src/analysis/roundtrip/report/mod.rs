//! The report: every packing and format certified, and one sentence on each.

mod figures;
mod findings;
mod results;
mod tables;

use super::certificate::Certificate;
use super::combination::Certifier;
use super::conditions::Conditions;
use super::survey::Method;
use super::verdict::{Advice, Evidence, verdict};
use crate::depth::packing::TextPair;
use crate::depth::{
    Arithmetic, ByteStore, DepthFormat, FormatTrip, Packing, UnormLoad, UnormStore,
};
use crate::report::{Profile, Report, Section};
use crate::simd::Level;
use rayon::prelude::*;

/// Version of the layout of `results.json`.
pub const SCHEMA: &str = "gnomon-roundtrip-1";

/// What to certify.
#[derive(Clone, Debug)]
pub struct CertifyOptions {
    /// Quick or full.
    pub profile: Profile,
    /// Carried into the report; nothing here is random.
    pub seed: u64,
    /// Answer for every float under every store (else only under the rounding one, or three in full).
    pub exhaustive: bool,
    /// Evaluate every float instead of proving intervals.
    pub brute: bool,
    /// The packings, in report order; all where empty.
    pub packings: Vec<Packing>,
    /// A user's own pair with its name.
    pub pair: Option<(String, TextPair)>,
    /// The LINEAR filter's fraction that has a column of its own, in [0, 1].
    pub fraction: f32,
}

/// One column of the heat map: conditions by name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub(super) name: &'static str,
    pub(super) conditions: Conditions,
}

/// The settings, the plain one first; [`evidence`] counts on the order.
const SETTINGS: [Setting; 9] = {
    use Arithmetic::{F32, Fma, Fp16, Real};
    use UnormLoad::{Divide, Half, Reciprocal};
    const fn set(name: &'static str, s: ByteStore, l: UnormLoad, a: Arithmetic) -> Setting {
        Setting { name, conditions: Conditions { store: s, load: l, arithmetic: a } }
    }
    [
        set("rounds", ByteStore::HalfEven, Divide, F32),
        set("truncates", ByteStore::Truncate, Divide, F32),
        set("D3D 0.6", ByteStore::Admissible, Divide, F32),
        set("half up", ByteStore::HalfUp, Divide, F32),
        set("k·f32(1/255)", ByteStore::HalfEven, Reciprocal, F32),
        set("FMA", ByteStore::HalfEven, Divide, Fma),
        set("fp16 sampler", ByteStore::HalfEven, Half, F32),
        set("fp16 shader", ByteStore::HalfEven, Divide, Fp16),
        set("real", ByteStore::HalfEven, Divide, Real),
    ]
};

/// Where the sampler's other rule stands in [`SETTINGS`].
pub(super) const RECIPROCAL: usize = 4;
/// Where half-precision arithmetic stands.
pub(super) const FP16: usize = 7;

/// All certificates of one packing, in the order of the settings.
#[derive(Clone, Debug)]
pub(super) struct Dossier {
    pub(super) name: String,
    pub(super) about: String,
    pub(super) packing: Option<Packing>,
    pub(super) certificates: Vec<Certificate>,
    pub(super) advice: Advice,
    pub(super) sentence: String,
}

/// Everything measured.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) dossiers: Vec<Dossier>,
    pub(super) formats: Vec<Certificate>,
}

impl Measured {
    /// One dossier of those whose packings have the same operations.
    pub(super) fn distinct(&self) -> impl Iterator<Item = &Dossier> {
        let first = |(i, d): &(usize, &Dossier)| !self.dossiers[..*i].iter().any(|e| e.same_as(d));
        self.dossiers.iter().enumerate().filter(first).map(|(_, dossier)| dossier)
    }
}

impl Dossier {
    fn same_as(&self, other: &Self) -> bool {
        let original = |d: &Self| d.packing.map(Packing::original);
        original(self).is_some() && original(self) == original(other)
    }
}

impl CertifyOptions {
    /// Settings whose every float is answered for: those with wide loops, as far as asked; and Aras
    /// 2009 under both samplers, whose counts of inversions are known.
    fn method(&self, packing: Option<Packing>, setting: usize) -> Method {
        let whole = match (self.exhaustive, self.profile) {
            (true, _) => 6,
            (false, Profile::Full) => 3,
            (false, Profile::Quick) => 1,
        };
        let known = packing == Some(Packing::Aras2009) && setting == RECIPROCAL;
        match (setting < whole || known, self.brute) {
            (true, true) => Method::Brute,
            (true, false) => Method::Pruned,
            (false, _) => Method::Sampled,
        }
    }

    fn effort(&self, packing: Option<Packing>, setting: usize) -> Certifier {
        Certifier { method: self.method(packing, setting), level: Level::best() }
    }

    /// How many steps `report` announces.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.originals().len() + usize::from(self.pair.is_some()) + DepthFormat::ALL.len()
    }

    fn chosen(&self) -> Vec<Packing> {
        if self.packings.is_empty() { Packing::ALL.to_vec() } else { self.packings.clone() }
    }

    /// The packings to compute: of those with the same operations, one.
    fn originals(&self) -> Vec<Packing> {
        let mut originals: Vec<Packing> = self.chosen().iter().map(|p| p.original()).collect();
        originals.sort_unstable();
        originals.dedup();
        originals
    }
}

fn certificates(packing: Packing, options: &CertifyOptions) -> Vec<Certificate> {
    let certify = |(i, setting): (usize, &Setting)| {
        options.effort(Some(packing), i).certify_packing(packing, setting.conditions)
    };
    SETTINGS.iter().enumerate().map(certify).collect()
}

fn evidence(certificates: &[Certificate]) -> Evidence<'_> {
    Evidence {
        rounded: &certificates[0],
        truncated: &certificates[1],
        admissible: &certificates[2],
        half_sampler: &certificates[6],
        fp16: &certificates[FP16],
    }
}

fn dossier(
    name: &str,
    about: String,
    packing: Option<Packing>,
    certificates: Vec<Certificate>,
) -> Dossier {
    let renamed = |c: Certificate| Certificate { name: name.to_string(), ..c };
    let certificates: Vec<Certificate> = certificates.into_iter().map(renamed).collect();
    let (advice, sentence) = verdict(evidence(&certificates));
    Dossier { name: name.to_string(), about, packing, certificates, advice, sentence }
}

fn measure(options: &CertifyOptions, progress: &(impl Fn() + Sync)) -> Measured {
    let computed: Vec<(Packing, Vec<Certificate>)> = options
        .originals()
        .into_par_iter()
        .map(|packing| {
            let done = (packing, certificates(packing, options));
            progress();
            done
        })
        .collect();
    let of = |packing: Packing| {
        let original = packing.original();
        let found = computed.iter().find(|(p, _)| *p == original).expect("computed above");
        dossier(packing.name(), packing.about(), Some(packing), found.1.clone())
    };
    let mut dossiers: Vec<Dossier> = options.chosen().into_iter().map(of).collect();
    dossiers.extend(options.pair.as_ref().map(|(name, pair)| {
        let certify = |(i, setting): (usize, &Setting)| {
            options.effort(None, i).certify_text(name, *pair, setting.conditions)
        };
        let certificates = SETTINGS.iter().enumerate().map(certify).collect();
        progress();
        dossier(name, "the pair given with --pair".to_string(), None, certificates)
    }));
    let format = |&format: &DepthFormat| {
        let certificate = certify_format(format, options);
        progress();
        certificate
    };
    Measured { dossiers, formats: DepthFormat::ALL.par_iter().map(format).collect() }
}

/// Formats by break points; f32 itself loses nothing and is only sampled, as is in the quick profile
/// a format with more codes than most binades have floats.
fn certify_format(format: DepthFormat, options: &CertifyOptions) -> Certificate {
    let quick = options.profile == Profile::Quick && !options.exhaustive;
    let sampled = format == DepthFormat::F32 || (quick && format == DepthFormat::Unorm32);
    let method = if sampled { Method::Sampled } else { Method::BreakPoints };
    let trip = FormatTrip { format, store: UnormStore::Exact, load: UnormLoad::Divide };
    Certifier { method, level: Level::best() }.certify_format(trip)
}

/// Certifies and builds the report. `progress` is called [`CertifyOptions::steps`] times.
#[must_use]
pub fn report(options: &CertifyOptions, progress: impl Fn() + Sync) -> Report {
    let measured = measure(options, &progress);
    let mut report = Report {
        name: "roundtrip".into(),
        title: "Depth packings and formats".into(),
        question: "Does this pack/unpack pair lose bits, where, why, and on which hardware?".into(),
        lead: findings::lead(&measured),
        profile: options.profile,
        seed: options.seed,
        command: command(options),
        results_csv: Some(tables::summary(&measured)),
        ..Report::default()
    };
    let parameters = [
        ("floats", "every f32 of [0, 1] where the method is pruned, brute or break-points"),
        ("weights", "mean and rms are over uniform depth: each float weighs its spacing"),
    ];
    report.parameters = parameters.map(|(k, v)| (k.to_string(), v.to_string())).into();
    report.sections = sections(&measured, options);
    report.results = results::results(options, &measured);
    report
}

fn command(options: &CertifyOptions) -> String {
    let mut words = vec!["gnomon-roundtrip".to_string()];
    let mut say = |given: bool, word: &str| words.extend(given.then(|| word.to_string()));
    say(options.profile == Profile::Quick, "--quick");
    say(options.exhaustive, "--exhaustive");
    say(options.brute, "--brute");
    let names: Vec<&str> = options.packings.iter().map(|p| p.name()).collect();
    say(!names.is_empty(), &format!("--packing {}", names.join(",")));
    let pair = options.pair.as_ref().map_or("", |(name, _)| name);
    say(!pair.is_empty(), &format!("--pair {pair}.toml"));
    say(options.fraction != 0.5, &format!("--fraction {}", options.fraction));
    words.join(" ")
}

fn sections(measured: &Measured, options: &CertifyOptions) -> Vec<Section> {
    let mut advice = Section::new(
        "advice",
        "Which packing to use",
        "One sentence each, from the certificates below: f32 shader; rounding, truncating and \
         D3D-tolerant stores; half-precision samplers and shaders.",
    );
    advice.push(tables::advice(measured));
    let mut copy = Section::new(
        "copy",
        "The recommended pair to copy",
        "digits-24: integer digits in three bytes. No store, sampler or contraction changes a byte; \
         in [1/2, 1) it holds every f32. Only the last division may err, by the 2.5 ulp that GLSL \
         and WGSL allow.",
    );
    for shader in super::shaders::RECOMMENDED {
        copy.push(crate::report::Block::Code {
            language: shader.language.to_string(),
            text: shader.text.to_string(),
        });
    }
    let mut sections = vec![advice, figures::heat(measured), copy];
    sections.push(findings::section(measured));
    sections.push(tables::certificates(measured));
    sections.push(figures::curves(measured));
    sections.push(tables::details(measured));
    sections.push(figures::filters(options.fraction));
    sections.push(figures::resolution());
    sections.push(tables::formats(measured));
    sections.push(tables::moments());
    sections
}
