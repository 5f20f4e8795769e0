//! Reports become files: complete, self-contained, reproducible, readable.

mod browser;
mod explored;
mod independent;
mod measured;
mod sample;

use std::path::Path;

use gnomon::output::{self, OutFile};
use gnomon::report::{Block, Cell, Report, Section, Size, Table, Tile, number};

fn bytes<'a>(files: &'a [OutFile], name: &str) -> &'a [u8] {
    let file = files.iter().find(|file| file.name == name);
    &file.unwrap_or_else(|| panic!("{name} is missing")).bytes
}

fn text(files: &[OutFile], name: &str) -> String {
    String::from_utf8(bytes(files, name).to_vec()).unwrap()
}

#[test]
fn every_block_becomes_its_files() {
    let files = sample::report().files();
    let expected = "exr/exr-sample.exr pictures/classes.png plots/trade-off.png plots/trade-off.svg \
        report.json results.csv results.json tables/heat.csv tables/rates.csv index.html manifest.json";
    for name in expected.split(' ') {
        assert!(!bytes(&files, name).is_empty(), "{name} is empty");
    }
    assert_eq!(files.last().unwrap().name, "manifest.json");
}

/// Set `GNOMON_LOOK=DIR` to keep the report for looking at.
#[test]
fn written_files_verify_and_indexes_list_them() {
    let scratch = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("GNOMON_LOOK");
    let root = kept.as_deref().map_or(scratch.path(), Path::new);
    let written = sample::report().write(&root.join("sample")).unwrap();
    assert_eq!(output::verify(&written.folder).unwrap(), written.files.len() - 1);
    let index = gnomon::report::write_index(root, false).unwrap();
    let index = std::fs::read_to_string(index).unwrap();
    assert!(index.contains("sample/index.html") && index.contains("headroom −0.0016"));
}

#[test]
fn the_same_report_gives_the_same_bytes_with_any_number_of_threads() {
    let files = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample::report().files())
    };
    let one = files(1);
    for threads in [2, 3, 8] {
        let many = files(threads);
        assert_eq!(one.len(), many.len());
        for (a, b) in one.iter().zip(&many) {
            assert!(a == b, "{} differs between 1 and {threads} threads", a.name);
        }
    }
}

#[test]
fn the_page_needs_nothing_from_outside() {
    let page = text(&sample::report().files(), "index.html");
    for banned in ["http://", "https://", "@import", "url(", "src=\"//", "<link rel=\"stylesheet"] {
        let named = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!named.contains(banned), "the page contains {banned}");
    }
}

#[test]
fn texts_are_escaped() {
    let page = text(&sample::report().files(), "index.html");
    assert!(page.contains("survive &lt;awkward&gt; &amp;"), "the question is not escaped");
    assert!(page.contains("every &lt;tag&gt; here is text &amp; stays text"));
    assert!(!page.contains("<awkward>") && !page.contains("<tag>"));
}

#[test]
fn every_figure_has_an_accessible_name() {
    let page = text(&sample::report().files(), "index.html");
    let opened = |tag: &str| -> Vec<String> {
        page.split(tag).skip(1).map(|rest| rest.split('>').next().unwrap().to_string()).collect()
    };
    let (plots, pictures) = (opened("<svg"), opened("<img"));
    assert_eq!((plots.len(), pictures.len()), (9, 5));
    for plot in plots {
        assert!(plot.contains("role=\"img\"") && plot.contains("aria-label=\""), "<svg{plot}>");
    }
    for picture in pictures {
        let named = picture.split("alt=\"").nth(1).is_some_and(|rest| !rest.starts_with('"'));
        assert!(named, "<img{}>", &picture[..80]);
    }
}

#[test]
fn a_caveat_stands_beside_what_it_qualifies() {
    let page = text(&sample::report().files(), "index.html");
    let caveat = page.find("12 ambiguous samples are left out.").expect("the caveat is shown");
    let table = page.find("id=\"rates\"").expect("the table is shown");
    assert!(caveat < table && table - caveat < 200, "{} bytes apart", table.abs_diff(caveat));
}

#[test]
fn csv_reads_back_to_the_same_bits() {
    let values = [0.1, 1e-300, -0.0, 5e-324, f64::MAX, 1.0 / 3.0, f64::INFINITY, f64::NEG_INFINITY];
    let mut table = Table::new("t", "").column("a", "m", "").column("b, \"c\"", "", "");
    for value in values {
        table.push(vec![Cell::Number(value, 2), Cell::from("x, \"y\"\nz")]);
    }
    let csv = table.to_csv();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(reader.headers().unwrap(), vec!["a [m]", "b, \"c\""]);
    for (record, value) in reader.records().map(Result::unwrap).zip(values) {
        assert_eq!(record[0].parse::<f64>().unwrap().to_bits(), value.to_bits(), "{}", &record[0]);
        assert_eq!(&record[1], "x, \"y\"\nz");
    }
    assert_eq!(number::shortest(f64::NAN), "NaN");
}

#[test]
fn text_tables_are_aligned_markdown() {
    let text = sample::table().to_text();
    let lines: Vec<_> = text.lines().collect();
    let bars = |line: &str| -> Vec<usize> {
        let chars: Vec<char> = line.chars().collect();
        (0..chars.len()).filter(|i| chars[*i] == '|' && (*i == 0 || chars[i - 1] != '\\')).collect()
    };
    assert_eq!(lines.len(), 5);
    assert!(lines.iter().all(|line| bars(line) == bars(lines[0])), "\n{text}");
    assert!(lines[1].starts_with("| ----") && lines[1].contains("-: |"), "{}", lines[1]);
    assert!(lines[3].contains("a\\|b"), "{}", lines[3]);
}

#[test]
fn pictures_read_back() {
    let picture = sample::picture("p");
    let read = image::load_from_memory(&picture.to_png()).unwrap().into_rgb8();
    assert_eq!((read.width(), read.height()), (picture.width, picture.height));
    assert_eq!(read.into_raw(), picture.rgb);
}

#[test]
fn exr_reads_back_bit_for_bit() {
    use exr::prelude::*;
    let image = sample::exr();
    let read = read_all_flat_layers_from_file_bytes(&image.to_exr());
    let channels = &read.channel_data.list;
    let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "cause.Y", "depth.stored.Z", "margin.Y"]);
    for channel in channels {
        let name = channel.name.to_string();
        let (_, written) = image.channels.iter().find(|(n, _)| *n == name).unwrap();
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("{name} is not f32") };
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(bits(values) == bits(written), "channel {name} changed");
    }
}

fn read_all_flat_layers_from_file_bytes(
    bytes: &[u8],
) -> exr::prelude::Layer<exr::prelude::AnyChannels<exr::prelude::FlatSamples>> {
    use exr::prelude::*;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes))
        .unwrap();
    assert_eq!(image.layer_data.len(), 1);
    let layer = image.layer_data.into_iter().next().unwrap();
    assert_eq!(layer.attributes.layer_name, None, "viewers prefix a named part");
    assert_eq!(layer.encoding.compression, Compression::ZIP16);
    assert_eq!(layer.encoding.line_order, LineOrder::Increasing);
    let attributes = layer.attributes.other.iter().chain(&image.attributes.other);
    let texts: Vec<_> = attributes.filter(|(name, _)| *name == "gnomon").collect();
    assert_eq!(texts.len(), 1, "one text attribute");
    let AttributeValue::Text(json) = texts[0].1 else { panic!("the attribute is no text") };
    let read: serde_json::Value = serde_json::from_str(&json.to_string()).unwrap();
    assert_eq!(read, sample::exr().metadata);
    layer
}

#[test]
fn plots_show_every_series_marker_and_unit() {
    let plot = sample::trade_off();
    let svg = plot.to_svg(Size::Whole);
    let names = plot.series.iter().map(|s| &s.name).chain(plot.markers.iter().map(|m| &m.label));
    for name in names.chain([&plot.x.label, &plot.y.label, &plot.title]) {
        let name = name.replace('\'', "&apos;");
        assert!(svg.contains(&name) || svg.contains(&name.replace("&apos;", "'")), "no {name}");
    }
    for tick in ["10⁻⁷", "10⁻¹", ">0<"] {
        assert!(svg.contains(tick), "no tick {tick}");
    }
}

#[test]
fn a_long_curve_stays_a_small_figure() {
    let mut plot = sample::trade_off();
    plot.series[0].points = (0..1_000_000).map(|i| (f64::from(i), f64::from(i % 97))).collect();
    assert!(plot.to_svg(Size::Whole).len() < 200_000);
}

fn with_blocks(blocks: Vec<Block>) -> Report {
    let section = Section { blocks, ..Section::new("one", "One", "") };
    Report { sections: vec![section], ..sample::report() }
}

#[test]
#[should_panic(expected = "are called 'rates'")]
fn two_blocks_with_one_id_are_a_bug() {
    let _ = with_blocks(vec![sample::table().into(), sample::table().into()]).files();
}

#[test]
fn a_gallery_shows_pictures_again() {
    let page = text(&sample::report().files(), "index.html");
    let (_, gallery) = page.split_once("<ul class=\"gallery\">").unwrap();
    let (gallery, _) = gallery.split_once("</ul>").unwrap();
    assert_eq!(gallery.matches("<a href=\"#tables\">").count(), 2);
    for image in gallery.split("src=\"").skip(1) {
        let (data, _) = image.split_once('"').unwrap();
        assert!(page.matches(data).count() >= 2, "the same bytes as its picture");
    }
}

#[test]
#[should_panic(expected = "no picture is called 'missing'")]
fn a_tile_without_its_picture_is_a_bug() {
    let (to, title, text) = ("#a".into(), "a".into(), String::new());
    let tile = Tile { picture: "missing".into(), to, title, text };
    let _ = with_blocks(vec![Block::Gallery(vec![tile])]).files();
}

#[test]
fn the_committed_index_lists_the_committed_reports() {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let scratch = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(&reports).unwrap() {
        let folder = entry.unwrap().path();
        let summary = folder.join("report.json");
        if summary.is_file() {
            let copy = scratch.path().join(folder.file_name().unwrap());
            std::fs::create_dir(&copy).unwrap();
            std::fs::copy(summary, copy.join("report.json")).unwrap();
        }
    }
    let fresh = gnomon::report::write_index(scratch.path(), false).unwrap();
    let committed = std::fs::read_to_string(reports.join("index.html")).unwrap();
    assert!(std::fs::read_to_string(fresh).unwrap() == committed, "reports/index.html is old");
}

#[test]
#[should_panic(expected = "is no id")]
fn an_id_that_is_no_file_name_is_a_bug() {
    let table = Table { id: "../x".into(), ..sample::table() };
    let _ = with_blocks(vec![table.into()]).files();
}
