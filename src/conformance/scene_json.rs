//! `scene.json` → a case: every parameter from the file's own words, nothing from its name.

use super::json::{self, Field};
use crate::Result;
use crate::camera::Camera;
use crate::depth::{DepthFormat, Packing};
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::scene::{
    Case, CompareRule, CoordForm, Cull, DepthBuffer, Filter, LookupSpec, MapSpec, MatrixChain,
    Mesh, Object, Shading, TexelFormat, Wrap,
};
use crate::view::{Projection, View};
use glam::{DVec3, Vec3};
use std::path::Path;

/// Map and canvas sizes beyond this are refused (2²⁶ texels).
const LARGEST_SIDE: u32 = 8192;

/// A parsed scene with the files that its folder may hold.
#[derive(Clone, Debug)]
pub struct SceneDump {
    /// The case; bias and filter are the first of the lists.
    pub case: Case,
    /// Listed files, in the file's order.
    pub files: Vec<FileEntry>,
    /// Expected histograms of visibility files: name → value of a byte → count.
    pub counts: Vec<(String, Histogram)>,
}

/// Value of a byte → number of covered pixels.
pub type Histogram = Vec<(u8, u64)>;

/// One listed binary file.
#[derive(Clone, Debug)]
pub struct FileEntry {
    /// File name.
    pub name: String,
    /// Values per pixel.
    pub channels: usize,
    /// Whether values are f32 rather than bytes.
    pub float: bool,
    /// x, y, width, height of the part that the file holds.
    pub crop: [u32; 4],
    /// Value of every texel outside the crop.
    pub outside: Vec<f32>,
    /// The bias of a visibility file, positive repairing acne.
    pub bias: Option<f32>,
    /// The filter of a visibility file.
    pub filter: Option<Filter>,
}

/// Reads `scene.json`.
///
/// # Errors
/// [`crate::Error::BadInput`] naming file and field where something is missing, malformed or contradictory.
pub fn read(path: &Path) -> Result<SceneDump> {
    parse(path, &json::bytes(path)?)
}

/// Reads the scene from the file's bytes; `path` names it in complaints.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<SceneDump> {
    let value = json::parse(path, bytes)?;
    let root = Field::root(path, &value);
    let rules = root.get("rules")?;
    let lookup = lookup(&root, &rules)?;
    let chain = chain(&rules)?;
    let map = map(&root, &rules)?;
    let canvas = size(&root.get("canvas")?)?;
    let biases = root.get("biases")?.floats()?;
    let bias = biases.first().copied().ok_or_else(|| root.bad("no bias", "list one in biases"))?;
    let eye = root.get("light")?;
    let light = Light::new(view(&eye)?, projection(&eye, 1.0)?, None);
    let camera = camera(&root.get("camera")?, canvas)?;
    let case = Case {
        name: root.get("id")?.text()?.to_string(),
        document: root.get("document")?.text()?.to_string(),
        objects: objects(&root, chain, (&light, &camera))?,
        light,
        camera,
        canvas,
        chain,
        map,
        lookup,
        camera_cull: cull(&rules.get("cullCamera")?)?,
        bias: bias * lookup.compare.bias_sign(),
        shading: Shading::Tint,
        device: DeviceProfile::WebglSwiftshader,
        assumptions: Vec::new(),
        skipped: Vec::new(),
        facts: Vec::new(),
    };
    let files = files(&root, &case)?;
    Ok(SceneDump { counts: counts(&root)?, case, files })
}

fn lookup(root: &Field<'_>, rules: &Field<'_>) -> Result<LookupSpec> {
    let forms: Vec<_> = CoordForm::ALL.iter().map(|&f| (f.name(), f)).collect();
    let rule_text = rules.get("shadowIf")?;
    let (range_in_rule, bare) = match rule_text.text()?.strip_prefix("inRange && ") {
        Some(rest) => (true, rest),
        None => (false, rule_text.text()?),
    };
    let compare = CompareRule::ALL.iter().copied().find(|r| r.name() == bare).ok_or_else(|| {
        let names = CompareRule::ALL.iter().map(|r| r.name()).collect::<Vec<_>>().join("', '");
        rule_text.bad(format!("'{bare}' is not known"), format!("use one of '{names}'"))
    })?;
    let range_field = rules.get("rangeTest")?;
    let range_test = range_field.flag()?;
    if range_test != range_in_rule {
        return Err(
            range_field.bad("contradicts shadowIf", "make both name or omit the range test")
        );
    }
    let taps_field = rules.get("taps")?;
    let taps = taps_field.count(9)?;
    let filter_field = root.get("filters")?;
    let empty = || filter_field.bad("is empty", "list one filter");
    let own = filter(filter_field.items()?.first().ok_or_else(empty)?)?;
    let filter = match taps {
        1 => own,
        9 if own == Filter::Nearest => Filter::Pcf3,
        _ => return Err(taps_field.bad("fits no known filter", "give 1, or 9 with NEAREST")),
    };
    let wrap =
        root.get("wrap")?.word(&[("REPEAT", Wrap::Repeat), ("CLAMP_TO_EDGE", Wrap::Clamp)])?;
    Ok(LookupSpec { coord: rules.get("coord")?.word(&forms)?, compare, range_test, filter, wrap })
}

fn filter(field: &Field<'_>) -> Result<Filter> {
    field.word(&[("NEAREST", Filter::Nearest), ("LINEAR", Filter::Linear)])
}

fn chain(rules: &Field<'_>) -> Result<MatrixChain> {
    let words: Vec<_> = MatrixChain::ALL.iter().map(|&c| (c.statement(), c)).collect();
    rules.get("matrixChain")?.word(&words)
}

fn cull(field: &Field<'_>) -> Result<Cull> {
    let words: Vec<_> = Cull::ALL.iter().map(|&c| (c.name(), c)).collect();
    field.word(&words)
}

fn map(root: &Field<'_>, rules: &Field<'_>) -> Result<MapSpec> {
    let encoding_field = root.get("encoding")?;
    let encoding = encoding_field.text()?;
    if rules.get("encoding")?.text()? != encoding {
        return Err(encoding_field.bad("contradicts rules.encoding", "make both the same"));
    }
    let texel = if encoding == "depth" {
        TexelFormat::Depth(depth_format(&root.get("depthFormat")?)?)
    } else {
        let words: Vec<_> = Packing::ALL.iter().map(|&p| (p.name(), p)).collect();
        TexelFormat::Packed(encoding_field.word(&words)?)
    };
    let buffers: Vec<_> = DepthBuffer::ALL.iter().map(|&b| (b.name(), b)).collect();
    let clear = match texel {
        TexelFormat::Packed(_) => root.get("mapClear")?.array()?,
        TexelFormat::Depth(_) => [1.0; 4],
    };
    Ok(MapSpec {
        size: root.get("mapSize")?.count(LARGEST_SIDE)?,
        texel,
        clear,
        depth_buffer: rules.get("depthBuffer")?.word(&buffers)?,
        cull: cull(&rules.get("cullMap")?)?.into(),
    })
}

fn depth_format(field: &Field<'_>) -> Result<DepthFormat> {
    let text = field.text()?;
    let has = |word: &str| text.contains(word);
    if has("UNSIGNED_SHORT") || has("COMPONENT16") {
        Ok(DepthFormat::Unorm16)
    } else if has("32F") {
        Ok(DepthFormat::F32)
    } else if has("UNSIGNED_INT") || has("DEPTH24") || has("COMPONENT24") {
        Ok(DepthFormat::Unorm24)
    } else {
        Err(field.bad(
            format!("'{text}' names no known depth format"),
            "name UNSIGNED_SHORT, UNSIGNED_INT, DEPTH24 or 32F",
        ))
    }
}

fn size(field: &Field<'_>) -> Result<[u32; 2]> {
    let items = field.items()?;
    match items.as_slice() {
        [w, h] => Ok([w.count(LARGEST_SIDE)?, h.count(LARGEST_SIDE)?]),
        _ => Err(field.bad(format!("has {} numbers", items.len()), "give width and height")),
    }
}

fn view(field: &Field<'_>) -> Result<View> {
    let up = field.optional("up").map_or(Ok(DVec3::Y), |up| up.point())?;
    let view = View {
        position: field.get("position")?.point()?,
        target: field.get("target")?.point()?,
        up,
    };
    view.checked(&field.place())
}

fn projection(field: &Field<'_>, aspect: f64) -> Result<Projection> {
    let (near, far) = (field.get("near")?.number()?, field.get("far")?.number()?);
    let projection = match (field.optional("fovy"), field.optional("ortho")) {
        (Some(fovy), None) => {
            Projection::Perspective { fovy_degrees: fovy.number()?, aspect, near, far }
        }
        (None, Some(ortho)) => {
            let [width, height] = ortho.array::<2>()?.map(f64::from);
            Projection::Orthographic { width, height, near, far }
        }
        _ => return Err(field.bad("has not exactly one of fovy and ortho", "give one of them")),
    };
    projection.checked(&field.place())
}

fn camera(field: &Field<'_>, canvas: [u32; 2]) -> Result<Camera> {
    let aspect = f64::from(canvas[0]) / f64::from(canvas[1]);
    Ok(Camera { view: view(field)?, projection: projection(field, aspect)? })
}

fn objects(root: &Field<'_>, chain: MatrixChain, eyes: (&Light, &Camera)) -> Result<Vec<Object>> {
    let globals = root.get("matrices")?;
    let object = |field: &Field<'_>| -> Result<Object> {
        let matrices = chain.read(|name| {
            let found = field.optional(name).or_else(|| globals.optional(name));
            let found = found.ok_or_else(|| {
                field.bad(format!("matrix {name} is missing"), "rules.matrixChain needs it")
            })?;
            found.matrix()
        })?;
        let (name, model) = (field.get("name")?.text()?, field.get("model")?.matrix()?);
        let object = Object::new(name, mesh(field)?, model);
        // A scene of the dumps has one map: its matrices are those of every map of the light.
        let uploaded = |o: Object, map| o.with_uploaded(matrices.clone(), map, eyes.1);
        Ok(eyes.0.maps().iter().fold(object, uploaded))
    };
    root.get("objects")?.items()?.iter().map(object).collect()
}

fn mesh(field: &Field<'_>) -> Result<Mesh> {
    let positions_field = field.get("positions")?;
    let flat = positions_field.floats()?;
    if flat.len() % 3 != 0 {
        return Err(positions_field.bad("length is no multiple of 3", "give x, y, z each"));
    }
    let positions: Vec<Vec3> = flat.chunks_exact(3).map(Vec3::from_slice).collect();
    let indices_field = field.get("indices")?;
    let indices = indices_field.floats()?;
    if indices.len() % 3 != 0 {
        return Err(indices_field.bad("length is no multiple of 3", "give whole triangles"));
    }
    let bad =
        indices.iter().position(|&i| i < 0.0 || i.fract() != 0.0 || i as usize >= positions.len());
    if let Some(at) = bad {
        let reason =
            format!("[{at}] is {}, but there are {} vertices", indices[at], positions.len());
        return Err(indices_field.bad(reason, "give indices below the number of vertices"));
    }
    let triangle = |t: &[f32]| [t[0] as u32, t[1] as u32, t[2] as u32];
    Ok(Mesh::new(positions, indices.chunks_exact(3).map(triangle).collect(), Vec3::ONE))
}

fn files(root: &Field<'_>, case: &Case) -> Result<Vec<FileEntry>> {
    let entry = |(name, field): (&str, Field<'_>)| file(name, &field, case);
    let all = root.get("files")?.members()?;
    all.into_iter().filter(|(name, _)| name.ends_with(".bin")).map(entry).collect()
}

fn file(name: &str, field: &Field<'_>, case: &Case) -> Result<FileEntry> {
    let crop = match (field.optional("crop"), field.optional("size")) {
        (Some(crop), _) => {
            let at = |side: &str| crop.get(side).and_then(|f| f.number()).map(|x| x as u32);
            [
                at("x")?,
                at("y")?,
                crop.get("w")?.count(LARGEST_SIDE)?,
                crop.get("h")?.count(LARGEST_SIDE)?,
            ]
        }
        (None, Some(given)) => {
            let [w, h] = size(&given)?;
            [0, 0, w, h]
        }
        (None, None) => return Err(field.bad("has neither size nor crop", "give one")),
    };
    let outside = match field.optional("outside") {
        Some(list) => list.floats().or_else(|_| list.float().map(|x| vec![x]))?,
        None => Vec::new(),
    };
    let bias = field.optional("bias").map(|b| b.float()).transpose()?;
    Ok(FileEntry {
        name: name.to_string(),
        channels: field.get("channels")?.count(4)? as usize,
        float: field.get("type")?.word(&[("u8", false), ("f32", true)])?,
        crop,
        outside,
        bias: bias.map(|b| b * case.lookup.compare.bias_sign()),
        filter: field.optional("filter").map(|f| filter(&f)).transpose()?,
    })
}

fn counts(root: &Field<'_>) -> Result<Vec<(String, Histogram)>> {
    let Some(counts) = root.optional("counts") else { return Ok(Vec::new()) };
    let histogram = |field: &Field<'_>| -> Result<Histogram> {
        if let Some(hist) = field.optional("hist") {
            let items = hist.items()?;
            let bin = |(i, f): (usize, &Field<'_>)| Ok((i as u8, f.number()? as u64));
            return items.iter().enumerate().map(bin).collect();
        }
        Ok(vec![
            (255, field.get("lit")?.number()? as u64),
            (0, field.get("shadow")?.number()? as u64),
        ])
    };
    let entry = |(name, field): (&str, Field<'_>)| Ok((name.to_string(), histogram(&field)?));
    counts.members()?.into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use {crate::Error, serde_json::Value};

    fn complaint(edit: impl FnOnce(&mut Value)) -> String {
        let mut value = minimal();
        edit(&mut value);
        match parse(Path::new("scene.json"), value.to_string().as_bytes()) {
            Ok(_) => "accepted".to_string(),
            Err(e) => e.to_string(),
        }
    }

    fn minimal() -> Value {
        let eye = |near: f64| {
            serde_json::json!({"position": [0, 5, 1], "target": [0, 0, 0], "fovy": 60,
                               "near": near, "far": 10})
        };
        let identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
        serde_json::json!({
            "id": "t", "document": "d", "canvas": [4, 4], "mapSize": 8, "encoding": "r8",
            "mapClear": [0, 0, 0, 1], "biases": [0.5], "filters": ["NEAREST"], "wrap": "REPEAT",
            "light": eye(1.0), "camera": eye(1.0), "matrices": {},
            "objects": [{"id": 1, "name": "o", "model": identity, "positions": [0, 0, 0, 1, 0, 0, 0, 1, 0],
                         "indices": [0, 1, 2], "lightMVP": identity, "camMVP": identity}],
            "files": {},
            "rules": {"coord": "xyz / w", "cullMap": "none", "cullCamera": "none", "rangeTest": false,
                      "taps": 1, "depthBuffer": "d16", "encoding": "r8", "shadowIf": "z > D + b",
                      "matrixChain": MatrixChain::Combined.statement()}
        })
    }

    #[test]
    fn the_minimal_scene_is_accepted() {
        assert_eq!(complaint(|_| ()), "accepted");
    }

    #[test]
    fn every_mistake_is_named_with_file_and_field() {
        let expect = |text: String, words: &[&str]| {
            assert!(text.starts_with("scene.json: "), "{text}");
            assert!(words.iter().all(|w| text.contains(w)), "{text} lacks {words:?}");
        };
        expect(complaint(|v| v["light"]["near"] = 20.into()), &["light.near", "far"]);
        expect(complaint(|v| v["light"]["fovy"] = Value::Null), &["light", "fovy"]);
        expect(complaint(|v| v["mapSize"] = 0.into()), &["mapSize"]);
        expect(complaint(|v| v["rules"]["encoding"] = "book".into()), &["encoding", "contradicts"]);
        expect(
            complaint(|v| v["rules"]["rangeTest"] = true.into()),
            &["rules.rangeTest", "contradicts"],
        );
        expect(complaint(|v| v["objects"][0]["indices"][2] = 3.into()), &["indices", "3 vertices"]);
        expect(
            complaint(|v| v["objects"][0]["positions"][2] = "x".into()),
            &["positions[2]", "number"],
        );
        expect(complaint(|v| v["rules"]["shadowIf"] = "z < D".into()), &["shadowIf", "use one of"]);
        expect(
            complaint(|v| {
                v.as_object_mut().unwrap().remove("biases");
            }),
            &["biases", "missing"],
        );
    }

    #[test]
    fn errors_are_bad_input() {
        let mut value = minimal();
        value["canvas"] = serde_json::json!([0, 4]);
        let error = parse(Path::new("scene.json"), value.to_string().as_bytes()).unwrap_err();
        assert!(matches!(error, Error::BadInput { .. }), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}
