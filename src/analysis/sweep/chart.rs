//! One raster of one map size: everything that formats and biases read from it.

use super::field::{Field, Sample};
use super::looks::Looks;
use super::reading::Reading;
use super::reads::{Reads, wanted_texels};
use super::store::{Drawn, Known};
use crate::analysis::classify::StoredCaster;
use crate::depth::{DepthFormat, Packing};
use crate::device::Device;
use crate::raster::{Fragments, NO_TRIANGLE, Pass, PolygonOffset, Raster, draw};
use crate::scene::{DepthBuffer, Filter, MapSpec, TexelFormat};
use crate::shadow::bias::{Recipe, Site, Weights};
use crate::shadow::{self, Footprints, Sampling};
use rayon::prelude::*;
use std::sync::Mutex;

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
    pub(in crate::analysis) attachment: Attachment,
    pub(super) sampling: Sampling,
    pub(super) raster: Raster,
    pub(super) fragments: Fragments,
    /// What the raster holds at every slot of the fragments; 1 where nothing is.
    pub(super) own: Drawn<'static>,
    /// What each receiver reads.
    pub(super) reads: Reads,
    /// Whose surface each of these slots holds.
    casters: Vec<StoredCaster>,
    pub(super) sites: Vec<Site>,
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
        let sampling = Sampling { filter, wrap: case.lookup.wrap, size, fixed };
        let coord = |i: usize| [0, 1].map(|axis| field.heads[i].coord[axis]);
        let footprints = Footprints::of(sampling, &coord, field.heads.len());
        let wanted = wanted_texels(&footprints);
        let fragments = Fragments::collect(&device, size, clip, triangles, wanted);
        let reads = Reads::new(footprints, &fragments);
        let of = |(i, sample): (usize, &Sample)| -> Vec<StoredCaster> {
            let caster = |t: u32| field.caster(sample, raster.triangle[t as usize], t, size);
            reads.footprint(i).taps.iter().map(|tap| caster(tap.texel)).collect()
        };
        let drawn = |t: u32| match raster.triangle[t as usize] {
            NO_TRIANGLE => 1.0,
            _ => raster.depth[t as usize],
        };
        let own = Drawn {
            depth: fragments.over_texels(drawn).into(),
            triangle: fragments.over_texels(|t| raster.triangle[t as usize]).into(),
        };
        let casters = field.samples.par_iter().enumerate().flat_map_iter(of).collect();
        Self {
            field,
            size,
            filter,
            attachment,
            sampling,
            raster,
            own,
            reads,
            fragments,
            casters,
            sites: field.samples.par_iter().map(|s| field.site(s, size)).collect(),
            stored: Mutex::default(),
        }
    }

    /// Whose surface each tap of a receiver reads without a bias.
    pub(super) fn own_casters(&self, i: usize) -> &[StoredCaster] {
        self.reads.of(i, &self.casters)
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

    /// All comparisons of all receivers under a format and a recipe.
    #[must_use]
    pub fn looks(&self, texel: TexelFormat, recipe: &Recipe) -> Vec<Looks> {
        self.read(texel, recipe, Reading::All).into_iter().map(|(_, looks)| looks).collect()
    }

    /// The comparisons of those receivers that can be wrong at some tap bias ≥ 0; of all where the effort
    /// leaves nothing out.
    #[must_use]
    pub fn breakable(&self, texel: TexelFormat, recipe: &Recipe) -> Vec<(u32, Looks)> {
        let reading = if self.field.skips() { Reading::Breakable } else { Reading::All };
        self.read(texel, recipe, reading)
    }

    /// The indices of all receivers.
    #[must_use]
    pub fn all(&self) -> Vec<u32> {
        (0..self.field.samples.len() as u32).collect()
    }
}

/// One step of a format at a window depth; of a packing, one step of all its channels together.
#[must_use]
pub fn quantum(texel: TexelFormat, depth: f32) -> f64 {
    match texel {
        TexelFormat::Depth(format) => format.quantum(depth.clamp(0.0, 1.0)),
        TexelFormat::Packed(packing) => crate::num::exp2(-8 * packing.channels() as i32),
    }
}
