//! One raster of one map size: everything that formats and biases read from it.

use super::drawn::{Drawn, Known};
use super::field::Field;
use super::reads::{Reads, wanted_texels};
use crate::analysis::classify::StoredCaster;
use crate::depth::{DepthFormat, Packing};
use crate::device::Device;
use crate::light::Layout;
use crate::raster::passes::{MapPass, MapRaster, Transformed};
use crate::raster::{Fragments, PolygonOffset, Slots};
use crate::scene::{Filter, MapSpec, TexelFormat};
use crate::shadow::bias::{Recipe, Site, Weights};
use crate::shadow::{self, Footprints, Sampling};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock};

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

/// What a byte says of a tap.
const CASTERS: [StoredCaster; 5] = [
    StoredCaster::Cleared,
    StoredCaster::Own,
    StoredCaster::Occluder,
    StoredCaster::Other,
    StoredCaster::Culled,
];

/// A case's casters over a map of one size, and where its receivers look.
#[derive(Debug)]
pub struct Chart<'f, 'a> {
    /// The receivers.
    pub field: &'f Field<'a>,
    /// Texels along the longest side of a whole texture.
    pub size: u32,
    /// Where the maps' texels lie.
    pub layout: Layout,
    /// Texels read.
    pub filter: Filter,
    pub(in crate::analysis) attachment: Attachment,
    pub(super) sampling: Sampling,
    pub(super) raster: MapRaster,
    /// The texels that receivers read.
    pub(super) slots: Arc<Slots>,
    /// What the raster holds at each of these; 1 where nothing is.
    pub(super) own: Drawn<'static>,
    /// What each receiver reads.
    pub(super) reads: Reads,
    /// The owner of the surface that each tap holds: 0 not asked yet, else 1 + its place in [`CASTERS`].
    casters: Vec<AtomicU8>,
    /// Every fragment over these texels, once somebody asks.
    fragments: OnceLock<Fragments>,
    /// Weights of the receivers in no format, once somebody asks.
    weights: OnceLock<Vec<Weights>>,
    /// The maps without a bias that were asked for.
    pub(super) stored: Mutex<Vec<Known>>,
}

impl<'f, 'a> Chart<'f, 'a> {
    /// Draws the casters once and finds the texels that every receiver reads.
    #[must_use]
    pub fn new(field: &'f Field<'a>, size: u32, filter: Filter, attachment: Attachment) -> Self {
        let case = field.case();
        let subject = &field.observer.subject;
        let device = subject.device;
        let depth_buffer = match attachment {
            Attachment::Colour => {
                TexelFormat::Packed(Packing::R8).attachment(case.map.depth_buffer)
            }
            Attachment::Depth => DepthFormat::F32,
        };
        let layout = case.light.layout(size);
        let pass = MapPass { cull: case.map.cull, depth_buffer, offset: PolygonOffset::default() };
        let raster = MapRaster::draw(&case.light, layout.clone(), &device, &subject.vertices, pass);
        let fixed = attachment == Attachment::Colour
            && shadow::fixed_coordinates(&device, TexelFormat::Packed(Packing::R8));
        let sampling = Sampling { filter, wrap: case.lookup.wrap, fixed };
        let receivers = &field.receivers;
        let at = |i: usize| {
            let sample = &field.samples[i];
            (layout.rect(sample.map), [receivers.u[i], receivers.v[i]], sample.pixel)
        };
        let footprints = Footprints::of(sampling, &at, receivers.len());
        // Where receivers choose among maps, a move may lead them to any.
        let slots = match field.chooses() {
            true => Slots::of(layout.clone(), (0..layout.texels() as u32).into_par_iter()),
            false => Slots::of(layout.clone(), wanted_texels(&footprints)),
        };
        let reads = Reads::new(footprints, &slots);
        let drawn = |t: u32| layout.compared(raster.depth[t as usize]);
        let own = Drawn {
            depth: slots.over_texels(drawn).into(),
            triangle: slots.over_texels(|t| raster.triangle[t as usize]).into(),
        };
        Self {
            field,
            size,
            layout,
            filter,
            attachment,
            sampling,
            raster,
            own,
            casters: (0..reads.taps()).map(|_| AtomicU8::new(0)).collect(),
            reads,
            slots: Arc::new(slots),
            fragments: OnceLock::new(),
            weights: OnceLock::new(),
            stored: Mutex::default(),
        }
    }

    /// The owner of the surface that a tap of a receiver reads without a bias; asked once.
    #[inline]
    pub(super) fn own_caster(&self, i: usize, tap: usize) -> StoredCaster {
        match self.casters[self.reads.range(i).start + tap].load(Relaxed) {
            0 => self.find_caster(i, tap),
            place => CASTERS[usize::from(place) - 1],
        }
    }

    #[cold]
    fn find_caster(&self, i: usize, tap: usize) -> StoredCaster {
        let slot = self.reads.slots(i)[tap] as usize;
        let (texel, triangle) = (self.slots.texel(slot), self.own.triangle[slot]);
        let caster = self.field.caster(&self.field.samples[i], triangle, texel, &self.layout);
        let place = CASTERS.iter().position(|&c| c == caster).map_or(0, |place| place as u8 + 1);
        self.casters[self.reads.range(i).start + tap].store(place, Relaxed);
        caster
    }

    /// Every fragment over the texels that receivers read; found once, on one thread: others wait for
    /// it, so that it may not wait for them.
    pub(super) fn fragments(&self) -> &Fragments {
        let vertices = &self.field.observer.subject.vertices;
        self.fragments.get_or_init(|| {
            let maps = self.field.case().light.maps().iter().zip(&vertices.maps);
            let maps: Vec<_> = maps.map(|(map, v)| (map.clip, v.clip.as_slice())).collect();
            let Transformed { triangles, surfaces, .. } = vertices;
            Fragments::collect(self.device(), &maps, triangles, surfaces, &self.slots)
        })
    }

    pub(super) fn device(&self) -> &Device {
        &self.field.observer.subject.device
    }

    /// The map of a format on this chart.
    ///
    /// # Panics
    /// Where the format belongs to another attachment.
    #[must_use]
    pub fn spec(&self, texel: TexelFormat) -> MapSpec {
        assert_eq!(Attachment::of(texel), self.attachment, "the format's own chart");
        self.field.case().map.with(self.size, texel)
    }

    /// What a bias may know of a receiver under this map size.
    #[must_use]
    pub fn site(&self, i: usize) -> Site {
        self.field.site(&self.field.samples[i], &self.layout)
    }

    /// Weights of the tap-side parameters of every receiver, in no format: a step is 0. Found once, on
    /// one thread, like [`Self::fragments`].
    pub(super) fn site_weights(&self) -> &[Weights] {
        let of = |i: usize| Weights::at(&self.site(i), 0.0);
        self.weights.get_or_init(|| (0..self.field.samples.len()).map(of).collect())
    }

    /// Weights of the tap-side parameters of a receiver under a format.
    #[must_use]
    pub fn weights(&self, texel: TexelFormat, i: usize) -> Weights {
        let z = self.layout.compared(self.field.receivers.z[i]);
        self.site_weights()[i].with_step(texel.step(z))
    }

    /// This answer in one of several maps.
    #[must_use]
    pub fn weights_in(&self, texel: TexelFormat, i: usize, map: usize) -> Weights {
        let sample = &self.field.samples[i];
        if map == sample.map {
            return self.weights(texel, i);
        }
        let there = self.field.in_map(sample, map);
        let z = self.layout.compared(there.coord[2]);
        Weights::at(&self.field.site(&there, &self.layout), texel.step(z))
    }

    /// The bias of a recipe's taps in a map.
    #[must_use]
    pub fn tap_bias(&self, recipe: &Recipe, texel: TexelFormat, i: usize, map: usize) -> f32 {
        let weighed = || recipe.tap_bias(&self.weights_in(texel, i, map));
        recipe.common_bias().unwrap_or_else(weighed)
    }

    /// The bias of every tap of a receiver under a format.
    #[must_use]
    pub fn bias(&self, recipe: &Recipe, texel: TexelFormat, i: usize) -> f32 {
        recipe.bias(&self.weights(texel, i), || self.site(i))
    }

    /// The indices of all receivers.
    #[must_use]
    pub fn all(&self) -> Vec<u32> {
        (0..self.field.samples.len() as u32).collect()
    }
}
