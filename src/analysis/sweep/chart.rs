//! One raster of one map size: everything that formats and biases read from it.

use super::field::{Field, Sample};
use super::looks::{Look, Looks};
use super::tally::SHARE;
use crate::analysis::classify::StoredCaster;
use crate::depth::{DepthFormat, Packing};
use crate::device::Device;
use crate::raster::{Fragments, Layer, NO_TRIANGLE, Pass, PolygonOffset, Raster, Resolve, draw};
use crate::scene::{Cull, DepthBuffer, Filter, MapSpec, TexelFormat};
use crate::shadow::bias::{Layers, Recipe, Site, Weights};
use crate::shadow::{self, Footprint, Texels};
use glam::{DMat4, DVec3, DVec4, Vec4};

/// The formats of one raster: colour-packed passes keep the case's depth attachment and fixed-point
/// coordinates, depth textures are their own attachment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// A depth texture.
    Depth,
    /// A colour-packed pass.
    Colour,
}

impl Attachment {
    /// Where a format is drawn.
    #[must_use]
    pub const fn of(format: TexelFormat) -> Self {
        match format {
            TexelFormat::Depth(_) => Self::Depth,
            TexelFormat::Packed(_) => Self::Colour,
        }
    }
}

/// The map of a case with another size and format. A case's own format keeps its clear colour; other
/// packings clear to white. Depth textures are their own depth attachment.
#[must_use]
pub fn map_spec(own: &MapSpec, size: u32, texel: TexelFormat) -> MapSpec {
    let packed = |t: TexelFormat| matches!(t, TexelFormat::Packed(_));
    MapSpec {
        size,
        texel,
        clear: if packed(own.texel) && packed(texel) { own.clear } else { [1.0; 4] },
        depth_buffer: if packed(texel) { own.depth_buffer } else { DepthBuffer::Texture },
        cull: own.cull,
    }
}

/// LINEAR reads 0 from depth textures without a compare mode, so they are read NEAREST instead.
#[must_use]
pub fn usable_filter(filter: Filter, texel: TexelFormat) -> Filter {
    match (filter, texel) {
        (Filter::Linear, TexelFormat::Depth(_)) => Filter::Nearest,
        _ => filter,
    }
}

/// A case's casters over a map of one size, and where its receivers look.
#[derive(Debug)]
pub struct Chart<'f, 'a> {
    /// The receivers.
    pub field: &'f Field<'a>,
    /// Texels per side.
    pub size: u32,
    /// Texels read.
    pub filter: Filter,
    attachment: Attachment,
    raster: Raster,
    fragments: Fragments,
    footprints: Vec<Footprint>,
    casters: Vec<Vec<StoredCaster>>,
    sites: Vec<Site>,
}

/// One receiver's look-up: where, and at which tap bias only wrong taps are named.
struct Glance<'g> {
    sample: &'g Sample,
    coord: [f32; 3],
    footprint: &'g Footprint,
    bias: Option<f32>,
}

/// A map that is encoded texel by texel as it is read.
struct Store<'s> {
    spec: MapSpec,
    drawn: &'s dyn Fn(u32) -> Option<f32>,
    device: Device,
}

impl Texels for Store<'_> {
    fn size(&self) -> u32 {
        self.spec.size
    }

    fn format(&self) -> TexelFormat {
        self.spec.texel
    }

    fn depth(&self, device: &Device, texel: usize) -> f32 {
        shadow::texel_depth(device, &self.spec, (self.drawn)(texel as u32))
    }

    fn bytes(&self, texel: usize) -> Option<[u8; 4]> {
        shadow::texel_bytes(&self.device, &self.spec, (self.drawn)(texel as u32))
    }
}

impl<'f, 'a> Chart<'f, 'a> {
    /// Draws the casters once and finds the texels that every receiver reads.
    #[must_use]
    pub fn new(field: &'f Field<'a>, size: u32, filter: Filter, attachment: Attachment) -> Self {
        let case = field.case();
        let subject = &field.observer.subject;
        let device = subject.device;
        let own = matches!(case.map.texel, TexelFormat::Packed(_));
        let depth_buffer = match (attachment, case.map.depth_buffer) {
            (Attachment::Colour, DepthBuffer::Unorm16) if own => DepthFormat::Unorm16,
            _ => DepthFormat::F32,
        };
        let offset = PolygonOffset::default();
        let pass = Pass { size: [size; 2], cull: case.map.cull, depth_buffer, offset };
        let (clip, triangles) = (&subject.vertices.light_clip, &subject.vertices.triangles);
        let raster = draw(&device, &pass, clip, triangles);
        let fixed = attachment == Attachment::Colour
            && shadow::fixed_coordinates(&device, TexelFormat::Packed(Packing::R8));
        let place = |s: &Sample| {
            let mut footprint = Footprint::default();
            footprint.place(filter, case.lookup.wrap, size, fixed, [s.coord[0], s.coord[1]]);
            footprint
        };
        let footprints: Vec<Footprint> = field.samples.iter().map(place).collect();
        let wanted = wanted_texels(&footprints);
        let fragments = Fragments::collect(&device, size, clip, triangles, wanted.into_iter());
        let of = |(s, f): (&Sample, &Footprint)| {
            let taps = f.taps().iter();
            let caster = |t: u32| field.caster(s, raster.triangle[t as usize], t, size);
            taps.map(|tap| caster(tap.texel)).collect()
        };
        let casters = field.samples.iter().zip(&footprints).map(of).collect();
        let sites = field.samples.iter().map(|s| field.site(s, size)).collect();
        Self { field, size, filter, attachment, raster, fragments, footprints, casters, sites }
    }

    fn device(&self) -> &Device {
        &self.field.observer.subject.device
    }

    /// The map of a format on this chart.
    ///
    /// # Panics
    /// Where the format belongs to another attachment.
    #[must_use]
    pub fn spec(&self, texel: TexelFormat) -> MapSpec {
        assert_eq!(Attachment::of(texel), self.attachment, "the format's own chart");
        map_spec(&self.field.case().map, self.size, texel)
    }

    /// Places of the receivers under this map size.
    #[must_use]
    pub fn sites(&self) -> &[Site] {
        &self.sites
    }

    /// Weights of the tap-side parameters of every receiver under a format.
    #[must_use]
    pub fn weights(&self, texel: TexelFormat) -> Vec<Weights> {
        let of =
            |(sample, site): (&Sample, &Site)| Weights::at(site, quantum(texel, sample.coord[2]));
        self.field.samples.iter().zip(&self.sites).map(of).collect()
    }

    /// All comparisons under a format and a recipe. Where `weights` are given, only the casters of
    /// taps that are wrong at the recipe's own tap bias are looked up; others read as *own*.
    #[must_use]
    pub fn looks(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        weights: Option<&[Weights]>,
    ) -> Vec<Looks> {
        if recipe.moves_vertices() {
            let fragments = self.fragments_moved(recipe);
            self.looks_resolved(texel, recipe, weights, &fragments)
        } else if recipe.changes_map() {
            self.looks_resolved(texel, recipe, weights, &self.fragments)
        } else if recipe.moves_receiver() {
            self.looks_moved(texel, recipe, weights)
        } else {
            let drawn = |t: u32| self.drawn(t);
            let casters = &self.casters;
            self.looks_with(texel, recipe, None, &drawn, &|i, tap, _| (casters[i][tap], 0.0))
        }
    }

    /// All comparisons without a bias under reversed depth (1 at near, 0 at far, clip z in [0,1]): the
    /// same coverage, depths of the reversed f32 matrix, both sides negated so that the case's rule holds.
    #[must_use]
    pub fn looks_reversed(&self, texel: TexelFormat) -> Vec<Looks> {
        let observer = &self.field.observer;
        let subject = &observer.subject;
        let z_column = DVec4::new(0.0, 0.0, -0.5, 0.0);
        let w_column = DVec4::new(0.0, 0.0, 0.5, 1.0);
        let reverse = DMat4::from_cols(DVec4::X, DVec4::Y, z_column, w_column);
        let matrix = (reverse * observer.clip_from_world).as_mat4();
        let clip = |p: &DVec3| self.device().mat_vec(&matrix, p.as_vec3().extend(1.0));
        let clip: Vec<Vec4> = observer.geometry.positions.iter().map(clip).collect();
        let corners = |t: u32| observer.geometry.triangles[t as usize].map(|v| clip[v as usize]);
        let drawn = |t: u32| {
            let triangle = self.raster.triangle[t as usize];
            let depth = |id: u32| self.fragments.value(t, id, corners(id).map(|v| v.z));
            Some(if triangle == NO_TRIANGLE { 0.0 } else { depth(triangle) })
        };
        let receiver = |sample: &Sample| {
            let triangle = sample.receiver.triangle;
            let varyings = subject.camera_setup(triangle).varyings(self.device());
            let [x, y] = sample.pixel.map(|c| c as f32);
            let of = |pick: fn(Vec4) -> f32| varyings.scalar(corners(triangle).map(pick), x, y);
            of(|v| v.z) / of(|v| v.w)
        };
        let casters = &self.casters;
        let mut looks = self.looks_with(texel, &Recipe::default(), None, &drawn, &|i, tap, _| {
            (casters[i][tap], 0.0)
        });
        for (look, sample) in looks.iter_mut().zip(&self.field.samples) {
            let z = receiver(sample);
            for tap in &mut look.taps {
                (tap.z, tap.stored) = (-z, -tap.stored);
            }
        }
        looks
    }

    fn drawn(&self, texel: u32) -> Option<f32> {
        let i = texel as usize;
        (self.raster.triangle[i] != NO_TRIANGLE).then(|| self.raster.depth[i])
    }

    /// Receivers at their own places; `drawn` gives a texel's depth, `stored` whose surface tap `tap`
    /// of sample i holds and how far the bias moved it.
    fn looks_with(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        weights: Option<&[Weights]>,
        drawn: &dyn Fn(u32) -> Option<f32>,
        stored: &dyn Fn(usize, usize, u32) -> (StoredCaster, f64),
    ) -> Vec<Looks> {
        let store = Store { spec: self.spec(texel), drawn, device: *self.device() };
        let of = |(i, sample): (usize, &Sample)| {
            let footprint = &self.footprints[i];
            let caster = |tap: usize, texel: u32| stored(i, tap, texel);
            let bias = weights.map(|w| recipe.tap_bias(&w[i]));
            let at = Glance { sample, coord: sample.coord, footprint, bias };
            self.look(&store, recipe, &at, &caster)
        };
        self.field.samples.iter().enumerate().map(of).collect()
    }

    /// The comparisons of one receiver.
    fn look(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        at: &Glance<'_>,
        stored: &dyn Fn(usize, u32) -> (StoredCaster, f64),
    ) -> Looks {
        let Glance { sample, coord, footprint, bias } = *at;
        let spec = &self.field.case().lookup;
        let empty = unlooked(sample);
        if spec.range_test && !shadow::in_square(coord) {
            return empty;
        }
        let device = self.device();
        let taps = footprint.taps();
        let mixed = footprint.mixed.is_some();
        let one = |i: usize, depth: f32, share: f64| {
            let shift = recipe.follow.shift(sample.gradient, taps[i].sample, taps[i].centre);
            let z = coord[2] + shift;
            let share = (share * SHARE) as i64;
            let right = |b: f32| spec.compare.is_lit(z, depth, b) == sample.lit;
            if bias.is_some_and(right) {
                let caster = StoredCaster::Own;
                return Look { z, stored: depth, share, caster, sound: true, gained: 0.0 };
            }
            let texel = taps[i].texel;
            let (caster, gained) = stored(i, texel);
            let read = if mixed { store.depth(device, texel as usize) } else { depth };
            let sound = is_sound((store.drawn)(texel), read);
            Look { z, stored: depth, share, caster, sound, gained }
        };
        if mixed {
            let depth = shadow::mixed_depth(store, device, footprint);
            let i = self.mixed_tap(store, sample, footprint);
            return Looks { taps: vec![one(i, depth, 1.0)], ..empty };
        }
        let depth = |tap: &shadow::Tap| store.depth(device, tap.texel as usize);
        let list = taps.iter().enumerate().map(|(i, tap)| one(i, depth(tap), tap.weight));
        let heaviest = |best: usize, i: usize| {
            if taps[i].weight > taps[best].weight { i } else { best }
        };
        let centre =
            if footprint.weighted { (0..taps.len()).fold(0, heaviest) } else { taps.len() / 2 };
        Looks { taps: list.collect(), centre, ..empty }
    }

    /// The texel that decides a mix: the nearest to the light for a truly lit receiver, else the one
    /// that NEAREST reads.
    fn mixed_tap(&self, store: &Store<'_>, sample: &Sample, footprint: &Footprint) -> usize {
        if !sample.lit {
            return 0;
        }
        let depth = |i: usize| store.depth(self.device(), footprint.taps()[i].texel as usize);
        let nearer = |best: usize, i: usize| if depth(i) < depth(best) { i } else { best };
        (0..footprint.taps().len()).fold(0, nearer)
    }

    /// Receivers moved in f64; the change of their exact window coordinates is added to the subject's
    /// own with one rounding.
    fn looks_moved(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        weights: Option<&[Weights]>,
    ) -> Vec<Looks> {
        let case = self.field.case();
        let observer = &self.field.observer;
        let drawn = |t: u32| self.drawn(t);
        let store = Store { spec: self.spec(texel), drawn: &drawn, device: *self.device() };
        let fixed = shadow::fixed_coordinates(self.device(), texel);
        let mut footprint = Footprint::default();
        let mut one = |(i, sample): (usize, &Sample)| {
            let offset = recipe.receiver_offset(&self.sites[i]);
            let moved = sample.receiver.position + offset;
            let Some(window) = case.light.window_from_world(&observer.clip_from_world, moved)
            else {
                return unlooked(sample);
            };
            let coord = added(sample.coord, window - sample.exact);
            footprint.place(self.filter, case.lookup.wrap, self.size, fixed, [coord[0], coord[1]]);
            let caster = |_: usize, t: u32| {
                (self.field.caster(sample, self.raster.triangle[t as usize], t, self.size), 0.0)
            };
            let bias = weights.map(|w| recipe.tap_bias(&w[i]));
            let at = Glance { sample, coord, footprint: &footprint, bias };
            let mut looks = self.look(&store, recipe, &at, &caster);
            let rule = case.lookup.compare;
            let lit = |l: &Look| rule.is_lit(l.z, l.stored, bias.unwrap_or(0.0));
            if !sample.lit && looks.taps.iter().any(lit) {
                looks.moved_into_light = self.field.is_lit_from(sample, offset);
            }
            looks
        };
        self.field.samples.iter().enumerate().map(&mut one).collect()
    }

    /// Casters under another offset, culling or layer: resolved from the fragments of each texel.
    fn looks_resolved(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        weights: Option<&[Weights]>,
        fragments: &Fragments,
    ) -> Vec<Looks> {
        let spec = self.spec(texel);
        let attachment = match texel {
            TexelFormat::Depth(format) => format,
            TexelFormat::Packed(_) if spec.depth_buffer == DepthBuffer::Unorm16 => {
                DepthFormat::Unorm16
            }
            TexelFormat::Packed(_) => DepthFormat::F32,
        };
        let offsets = fragments.offsets(attachment, recipe.polygon);
        let light = &self.field.case().light;
        let (near, far) = light.projection.near_far();
        let per_world = |z: f32| {
            let distance = light.world_from_window(f64::from(z));
            match light.is_directional() {
                true => 1.0 / (far - near),
                false => near * far / ((far - near) * distance * distance),
            }
        };
        let write = |front: bool, z: f32| {
            if recipe.oriented == 0.0 {
                return z;
            }
            let world = f64::from(if front { recipe.oriented } else { -recipe.oriented });
            z + (world * per_world(z)) as f32
        };
        let cull = match recipe.layers {
            Layers::Nearest => spec.cull,
            Layers::BackFaces => Cull::Front,
            Layers::Second | Layers::Midpoint | Layers::Dual => Cull::None,
        };
        let depth_buffer =
            if attachment == DepthFormat::Unorm16 && self.attachment == Attachment::Colour {
                attachment
            } else {
                DepthFormat::F32
            };
        let pass = Resolve { depth_buffer, cull, offsets: &offsets, write: &write };
        let resolve = |t: u32| -> Option<(f32, Layer)> {
            let [first, second] = fragments.layers(t, &pass);
            let first = first?;
            let depth =
                recipe.layers.combine(first.depth, second.map(|l| l.depth), recipe.layer_offset)?;
            let moved = recipe.layers == Layers::Second;
            Some((depth, if moved { second? } else { first }))
        };
        let resolved = fragments.over_texels(resolve);
        let at = |t: u32| resolved[fragments.slot(t)];
        let drawn = |t: u32| at(t).map(|(depth, _)| depth);
        self.looks_with(texel, recipe, weights, &drawn, &|i, _, t| {
            let triangle = at(t).map_or(NO_TRIANGLE, |(_, layer)| layer.triangle);
            let caster = self.field.caster(&self.field.samples[i], triangle, t, self.size);
            let gained = drawn(t).unwrap_or(1.0) - self.drawn(t).unwrap_or(1.0);
            (caster, f64::from(gained))
        })
    }

    /// The fragments after casters' vertices have moved in world space (f64), transformed by the f32
    /// clip matrix of the light.
    fn fragments_moved(&self, recipe: &Recipe) -> Fragments {
        let observer = &self.field.observer;
        let case = self.field.case();
        let device = self.device();
        let normals = vertex_normals(self.field);
        let matrix = observer.clip_from_world.as_mat4();
        let clip = |(&p, &normal): (&DVec3, &DVec3)| -> Vec4 {
            let distance = case.light.axial_distance(p);
            let site = Site {
                position: p,
                normal,
                to_light: case.light.direction_from(p),
                texel_world: case.light.texel_world(self.size, distance),
                window_per_world: 0.0,
                gradient: glam::DVec2::ZERO,
                map_size: self.size,
            };
            let moved = p + recipe.vertex_offset(&site);
            device.mat_vec(&matrix, moved.as_vec3().extend(1.0))
        };
        let geometry = &observer.geometry;
        let clip: Vec<Vec4> = geometry.positions.iter().zip(&normals).map(clip).collect();
        let wanted = wanted_texels(&self.footprints);
        Fragments::collect(device, self.size, &clip, &geometry.triangles, wanted.into_iter())
    }
}

fn wanted_texels(footprints: &[Footprint]) -> Vec<u32> {
    let plain = footprints.iter().flat_map(|f| f.taps().iter().map(|t| t.texel));
    let mixed = footprints.iter().filter_map(|f| f.mixed).flat_map(|m| m.texels);
    plain.chain(mixed).collect()
}

/// Unit vertex normals: the triangles' area normals summed over each vertex, zero where there are none.
fn vertex_normals(field: &Field<'_>) -> Vec<DVec3> {
    let geometry = &field.observer.geometry;
    let mut normals = vec![DVec3::ZERO; geometry.positions.len()];
    for (id, triangle) in geometry.triangles.iter().enumerate() {
        let area = geometry.area_normal(id as u32);
        triangle.iter().for_each(|&v| normals[v as usize] += area);
    }
    let unit = |n: DVec3| {
        let size = crate::view::length(n);
        if size > 0.0 { n / size } else { n }
    };
    normals.into_iter().map(unit).collect()
}

/// A receiver without comparisons.
fn unlooked(sample: &Sample) -> Looks {
    Looks { lit: sample.lit, gap: sample.gap, inside: sample.inside, ..Looks::default() }
}

/// The subject's coordinates after an exact change, one rounding each.
fn added(coord: [f32; 3], change: DVec3) -> [f32; 3] {
    let change = change.as_vec3().to_array();
    std::array::from_fn(|i| coord[i] + change[i])
}

fn is_sound(drawn: Option<f32>, read: f32) -> bool {
    drawn.is_some_and(|z| (f64::from(read) - f64::from(z.clamp(0.0, 1.0))).abs() <= 2.0 / 255.0)
}

/// One step of a format at a window depth; of a packing, one step of all its channels together.
#[must_use]
pub fn quantum(texel: TexelFormat, depth: f32) -> f64 {
    match texel {
        TexelFormat::Depth(format) => format.quantum(depth.clamp(0.0, 1.0)),
        TexelFormat::Packed(packing) => crate::num::exp2(-8 * packing.channels() as i32),
    }
}
