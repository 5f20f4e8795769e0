//! The scenes section: map texels, object ids, coordinates and visibility of every scene.

use super::outcome::{Entry, Tally};
use super::scene_json::{FileEntry, SceneDump};
use super::{dump, scene_json};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::light::Lookup;
use crate::raster::passes::{Subject, Transformed};
use crate::raster::{NO_TRIANGLE, Raster};
use crate::scene::{Case, Filter, Geometry, LookupSpec, MatrixChain};
use crate::shadow::{self, Few, ShadowMap};
use crate::{Error, Result};
use rayon::prelude::*;
use std::path::Path;

/// What a float dump holds where nothing was drawn.
const BACKGROUND: f32 = -9.0;

/// Compares every `*/scene.json` under `folder`.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let mut scenes = Vec::new();
    let listing = std::fs::read_dir(folder).map_err(|e| Error::read(folder, e))?;
    for entry in listing {
        let path = entry.map_err(|e| Error::read(folder, e))?.path().join("scene.json");
        if path.is_file() {
            scenes.push(path);
        }
    }
    scenes.sort();
    let compared: Vec<Result<Vec<Entry>>> =
        scenes.par_iter().map(|path| compare_scene(path, device)).collect();
    compared.into_iter().collect::<Result<Vec<_>>>().map(|entries| entries.concat())
}

fn compare_scene(path: &Path, device: &Device) -> Result<Vec<Entry>> {
    let dump = scene_json::read(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let section = format!("scenes/{}", dump.case.name);
    let scene = Scene::draw(&dump, device);
    let mut entries = Vec::new();
    for file in &dump.files {
        entries.push(scene.compare_file(&section, folder, file)?);
    }
    for (name, histogram) in &dump.counts {
        if let Some(file) = dump.files.iter().find(|f| &f.name == name) {
            entries.push(scene.compare_counts(&section, file, histogram));
        }
    }
    Ok(entries)
}

/// A scene drawn once, from which every file can be answered.
struct Scene<'a> {
    case: &'a Case,
    device: Device,
    subject: Subject<'a>,
    geometry: Geometry,
    /// The camera pass over a 16-bit depth buffer, from which coordinates were dumped.
    coarse_canvas: Raster,
}

impl<'a> Scene<'a> {
    fn draw(dump: &'a SceneDump, device: &Device) -> Self {
        let subject = Subject::draw(&dump.case, device);
        let coarse_canvas = subject.canvas_with(DepthFormat::Unorm16);
        let geometry = dump.case.geometry();
        Self { case: &dump.case, device: *device, subject, geometry, coarse_canvas }
    }

    fn compare_file(&self, section: &str, folder: &Path, file: &FileEntry) -> Result<Entry> {
        let values = file.crop[2] as usize * file.crop[3] as usize * file.channels;
        let path = folder.join(&file.name);
        let read = if file.float {
            dump::floats(&path, values)?
        } else {
            dump::bytes(&path, values)?.map(|b| b.into_iter().map(f32::from).collect())
        };
        let Some(expected) = read else { return Ok(Tally::missing(section, &file.name)) };
        let mut tally = Tally::new(section, &file.name);
        let map = self.subject.map_raster.layout.picture();
        let size = if file.name == "map.bin" { map } else { self.case.canvas };
        let [x0, y0, w, h] = file.crop;
        if x0 + w > size[0] || y0 + h > size[1] {
            let reason =
                format!("the crop of {} does not fit {} x {}", file.name, size[0], size[1]);
            return Err(Error::bad_input(
                folder.join("scene.json").display().to_string(),
                reason,
                "correct it",
            ));
        }
        let found = self.picture(file)?;
        for y in 0..size[1] {
            for x in 0..size[0] {
                let inside = x >= x0 && x < x0 + w && y >= y0 && y < y0 + h;
                for c in 0..file.channels {
                    let want = if inside {
                        expected[((y - y0) * w + x - x0) as usize * file.channels + c]
                    } else {
                        file.outside.get(c).or(file.outside.first()).copied().unwrap_or(BACKGROUND)
                    };
                    let got = found((y * size[0] + x) as usize)[c];
                    tally.float(|| format!("x {x} y {y} channel {c}"), want, got);
                }
            }
        }
        Ok(tally.finish())
    }

    /// The subject's values of a file, pixel by pixel.
    fn picture<'s>(&'s self, file: &'s FileEntry) -> Result<Box<dyn Fn(usize) -> [f32; 4] + 's>> {
        let width = self.case.canvas[0];
        let one = |x: f32| [x, 0.0, 0.0, 0.0];
        Ok(match file.name.as_str() {
            "map.bin" => Box::new(move |i| match self.subject.map.bytes(i) {
                Some(bytes) => bytes.map(f32::from),
                None => one(self.subject.map.depth(&self.device, i)),
            }),
            "obj.bin" => Box::new(move |i| {
                let id = self.subject.canvas.triangle[i];
                let object = self.geometry.object.get(id as usize).map_or(0, |&o| o + 1);
                one(f32::from(object))
            }),
            "coord.bin" => Box::new(move |i| {
                let id = self.coarse_canvas.triangle[i];
                if id == NO_TRIANGLE {
                    return [BACKGROUND; 4];
                }
                let place = [i as u32 % width, i as u32 / width];
                let lookups = lookups(&self.subject, &self.geometry, id, place);
                lookups.iter().next().map_or([BACKGROUND; 4], |l| {
                    let [u, v, z] = l.coord;
                    [u, v, z, 0.0]
                })
            }),
            "mapdepth_linear.bin" => {
                // The dump comes from the coordinate pass' depth buffer too.
                Box::new(move |i| one(self.linear_depth(i).unwrap_or(BACKGROUND)))
            }
            name if name.starts_with("vis_") => {
                let values = self.visibility(file);
                Box::new(move |i| one(f32::from(values[i])))
            }
            name => {
                return Err(Error::bad_input(
                    format!("{}: files.{name}", self.case.name),
                    "is of no known kind",
                    "the layout knows map, obj, coord, mapdepth_linear and vis_*",
                ));
            }
        })
    }

    fn linear_depth(&self, pixel: usize) -> Option<f32> {
        let id = self.subject.canvas.triangle[pixel];
        let width = self.case.canvas[0];
        (id != NO_TRIANGLE).then(|| {
            let place = [pixel as u32 % width, pixel as u32 / width];
            let spec = LookupSpec { filter: Filter::Linear, ..self.case.lookup };
            let lookups = lookups(&self.subject, &self.geometry, id, place);
            self.subject.map.taps(&self.device, &spec, &lookups, place).depths()[0]
        })
    }

    /// The bytes of a visibility file: 255 lit, 0 not; or the number of lit taps.
    fn visibility(&self, file: &FileEntry) -> Vec<u8> {
        let lookup = LookupSpec {
            filter: file.filter.unwrap_or(self.case.lookup.filter),
            ..self.case.lookup
        };
        let bias = file.bias.unwrap_or(self.case.bias);
        let as_printed = file.name == "vis_asprinted_matrix.bin";
        let printed = as_printed.then(|| {
            let mut subject = self.subject.clone();
            let chain = MatrixChain::BiasMatrixAsPrinted;
            let printed = Transformed::new(self.case, chain, &self.device).maps;
            for (map, printed) in subject.vertices.maps.iter_mut().zip(printed) {
                map.coord = printed.coord;
            }
            subject
        });
        visibility_picture(
            printed.as_ref().unwrap_or(&self.subject),
            &self.subject.map,
            &self.geometry,
            (&lookup, bias),
        )
    }

    fn compare_counts(&self, section: &str, file: &FileEntry, histogram: &[(u8, u64)]) -> Entry {
        let values = self.visibility(file);
        let covered = |i: usize| self.subject.canvas.triangle[i] != NO_TRIANGLE;
        let mut tally = Tally::new(section, format!("scene.json counts.{}", file.name));
        for &(value, expected) in histogram {
            let found =
                values.iter().enumerate().filter(|&(i, &v)| v == value && covered(i)).count();
            tally.integer(|| format!("pixels of value {value}"), expected, found as u64);
        }
        tally.finish()
    }
}

fn visibility_picture(
    subject: &Subject<'_>,
    map: &ShadowMap,
    geometry: &Geometry,
    (lookup, bias): (&LookupSpec, f32),
) -> Vec<u8> {
    let width = subject.canvas.size[0];
    let pixel = |(i, &id): (usize, &u32)| {
        if id == NO_TRIANGLE {
            return 0;
        }
        let place = [i as u32 % width, i as u32 / width];
        let lookups = lookups(subject, geometry, id, place);
        let taps = map.taps(&subject.device, lookup, &lookups, place);
        let lit = shadow::visibility(lookup, &lookups, &taps, bias) as u8;
        if taps.depths().len() == 1 { lit * 255 } else { lit }
    };
    subject.canvas.triangle.iter().enumerate().map(pixel).collect()
}

/// What the fragment of a triangle at a pixel looks up.
fn lookups(
    subject: &Subject<'_>,
    geometry: &Geometry,
    triangle: u32,
    [x, y]: [u32; 2],
) -> Few<Lookup> {
    let interpolator = subject.interpolator(triangle);
    let (weights, [a, b, c]) = (interpolator.barycentrics(x, y), geometry.corners(triangle));
    let position = a * weights.x + b * weights.y + c * weights.z;
    subject.lookups(position, &subject.coordinates(&interpolator, x, y))
}
