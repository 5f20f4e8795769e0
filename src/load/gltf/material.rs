//! Materials as far as shadows go: sides, and where a surface has holes.

use super::super::Blend;
use super::super::files::Budget;
use super::super::picture;
use super::document::File;
use glam::Vec2;
use gltf::material::AlphaMode;
use gltf::texture::{MagFilter, WrappingMode};
use gnomon_core::scene::alpha::{AlphaImage, Mask, Tiling};
use gnomon_core::scene::{Sides, Surface};
use std::borrow::Cow;
use std::sync::Arc;

/// The cutoff of a material that is blended and shall be cut out.
const HALF: f32 = 0.5;

/// How a material draws, with what has to be said of every part that it is on.
#[derive(Clone)]
pub(super) struct Look {
    pub(super) surface: Surface,
    /// The set of texture coordinates that its mask uses, where it has a picture.
    pub(super) uv_set: Option<u32>,
    pub(super) says: Vec<String>,
}

pub(super) fn look(
    place: &str,
    material: &gltf::Material<'_>,
    file: &File<'_>,
    budget: &mut Budget<'_>,
) -> Look {
    let sides = if material.double_sided() { Sides::Both } else { Sides::Front };
    let surface = Surface { sides, ..Surface::default() };
    let mut look = Look { surface, uv_set: None, says: Vec::new() };
    match (material.alpha_mode(), budget.wanted().blend) {
        (AlphaMode::Opaque, _) => {}
        (AlphaMode::Mask, _) => {
            look.cut(place, material, material.alpha_cutoff().unwrap_or(HALF), file, budget);
        }
        (AlphaMode::Blend, Blend::Opaque) => look.says.push(
            "with blended alpha: taken as opaque, as three.js draws them into maps (--blend)"
                .into(),
        ),
        (AlphaMode::Blend, Blend::Cutout) => {
            look.says.push("with blended alpha: cut out where alpha < 0.5 (--blend)".into());
            look.cut(place, material, HALF, file, budget);
        }
        (AlphaMode::Blend, Blend::None) => {
            look.says.push("with blended alpha: throw no shadow (--blend)".into());
            look.surface.casts = false;
        }
    }
    look
}

impl Look {
    /// Holes where factor · texture is below the cutoff.
    fn cut(
        &mut self,
        place: &str,
        material: &gltf::Material<'_>,
        cutoff: f32,
        file: &File<'_>,
        budget: &mut Budget<'_>,
    ) {
        let pbr = material.pbr_metallic_roughness();
        let (texture, [.., factor]) = match material.pbr_specular_glossiness() {
            Some(other) => (other.diffuse_texture(), other.diffuse_factor()),
            None => (pbr.base_color_texture(), pbr.base_color_factor()),
        };
        let mut mask = Mask {
            image: None,
            factor,
            cutoff,
            scale_rotate: [Vec2::X, Vec2::Y],
            offset: Vec2::ZERO,
        };
        if let Some(info) = texture {
            match image(place, &info, file, budget) {
                Ok(image) => mask.image = image,
                // The texture's own alpha is not known; an engine that cannot read it draws it whole.
                Err(why) => {
                    self.says.push(format!("whose alpha texture is not read ({why}): opaque"));
                    return;
                }
            }
            let transform = info.texture_transform();
            let own_set = transform.as_ref().and_then(gltf::texture::TextureTransform::tex_coord);
            self.uv_set = mask.image.is_some().then(|| own_set.unwrap_or(info.tex_coord()));
            if let Some(transform) = transform {
                place_texture(&mut mask, &transform);
            }
        }
        let whole = mask.image.is_none() && mask.factor >= mask.cutoff;
        self.surface.mask = (!whole).then(|| Arc::new(mask));
    }

    /// This look where all vertices have this alpha, which multiplies the mask's.
    pub(super) fn with_alpha(&mut self, alpha: f32) {
        if let Some(mask) = &mut self.surface.mask {
            Arc::make_mut(mask).factor *= alpha;
        }
    }
}

/// `KHR_texture_transform`: scale, then a turn (counter-clockwise as seen with v downwards), then offset.
fn place_texture(mask: &mut Mask, transform: &gltf::texture::TextureTransform<'_>) {
    let angle = f64::from(transform.rotation());
    let [sine, cosine] = [libm::sin(angle), libm::cos(angle)];
    let [x, y] = transform.scale().map(f64::from);
    let column = |x: f64, y: f64| Vec2::new(x as f32, y as f32);
    mask.scale_rotate = [column(cosine * x, -sine * x), column(sine * y, cosine * y)];
    mask.offset = Vec2::from_array(transform.offset());
}

/// The number of the image that a texture shows: WebP where the file gives one, else its own source.
fn source(texture: &gltf::Texture<'_>) -> Option<usize> {
    let of = |name: &str| {
        let source = texture.extension_value(name)?.get("source")?.as_u64()?;
        usize::try_from(source).ok()
    };
    let plain = || texture.source().map(|image| image.index());
    let others = || of("KHR_texture_basisu").or(of("MSFT_texture_dds")).or(of("EXT_texture_avif"));
    of("EXT_texture_webp").or_else(plain).or_else(others)
}

/// The alpha of a texture with its sampler; `None` where it is 1 throughout.
fn image(
    place: &str,
    info: &gltf::texture::Info<'_>,
    file: &File<'_>,
    budget: &mut Budget<'_>,
) -> std::result::Result<Option<AlphaImage>, String> {
    let texture = info.texture();
    let index = source(&texture).ok_or("it names no image")?;
    let images = &file.document.as_json().images;
    let image = images.get(index).ok_or_else(|| format!("images[{index}] of {}", images.len()))?;
    let at = format!("{place}: images[{index}]");
    let name = image.name.as_deref().or(image.uri.as_deref().filter(|u| !u.starts_with("data:")));
    let named = |what: String| match name {
        Some(name) => format!("'{name}': {what}"),
        None => format!("images[{index}]: {what}"),
    };
    let view = image.buffer_view.and_then(|view| file.document.views().nth(view.value()));
    let bytes = match (image.uri.as_deref(), view) {
        (Some(uri), _) => {
            let missing = || "it is not beside the scene, or broken".to_string();
            budget.resource(&at, uri).map(Cow::Owned).map_err(|_| missing())
        }
        (None, Some(view)) => {
            let (buffer, range) = (view.buffer().index(), [view.offset(), view.length()]);
            let [offset, length] = range.map(|n| n as u64);
            let bytes = file.buffers.range(buffer, offset, length);
            bytes.map(Cow::Borrowed).ok_or_else(|| "it reads beyond its buffer".into())
        }
        (None, None) => Err("it has neither a URI nor a buffer view".into()),
    };
    let alpha = bytes.and_then(|b| picture::alpha(&b, budget.most_memory())).map_err(named)?;
    let sampler = texture.sampler();
    Ok(alpha.map(|alpha| AlphaImage {
        size: alpha.size,
        alpha: alpha.values,
        tiling: [sampler.wrap_s(), sampler.wrap_t()].map(tiling),
        linear: sampler.mag_filter() != Some(MagFilter::Nearest),
    }))
}

fn tiling(wrap: WrappingMode) -> Tiling {
    match wrap {
        WrappingMode::ClampToEdge => Tiling::Clamp,
        WrappingMode::Repeat => Tiling::Repeat,
        WrappingMode::MirroredRepeat => Tiling::Mirror,
    }
}
