//! Where the texels of several maps lie: textures one after the other, rows from the bottom, one number each.

use super::map::{Map, Viewport};

/// A rectangle of texels that one map is drawn into and looked up in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Number of the first texel of the whole texture.
    pub first: u32,
    /// Width and height of the texture.
    pub texture: [u32; 2],
    /// The map's lowest texel within the texture.
    pub low: [u32; 2],
    /// The map's width and height.
    pub size: [u32; 2],
}

impl Rect {
    /// A texture that one map fills.
    #[must_use]
    pub const fn whole(size: [u32; 2]) -> Self {
        Self { first: 0, texture: size, low: [0; 2], size }
    }

    /// Whether the map fills its texture.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.size == self.texture
    }

    /// The number of the map's texel (x, y).
    #[must_use]
    #[inline]
    pub const fn texel(&self, x: u32, y: u32) -> u32 {
        self.first + (y + self.low[1]) * self.texture[0] + x + self.low[0]
    }

    /// Column and row of a numbered texel within the map; negative or beyond it where the texel belongs to
    /// another map of the texture.
    #[must_use]
    pub fn place(&self, texel: u32) -> [i64; 2] {
        let within = texel - self.first;
        let at = [within % self.texture[0], within / self.texture[0]];
        [0, 1].map(|axis| i64::from(at[axis]) - i64::from(self.low[axis]))
    }

    /// Coordinates in the texture of coordinates in the map: u·scale + offset in f32, as a shader forms
    /// them; unchanged where the map fills the texture.
    #[must_use]
    #[inline]
    pub fn in_texture(&self, uv: [f32; 2]) -> [f32; 2] {
        if self.is_whole() {
            return uv;
        }
        [0, 1].map(|axis| {
            let texture = self.texture[axis] as f32;
            uv[axis] * (self.size[axis] as f32 / texture) + self.low[axis] as f32 / texture
        })
    }
}

/// The rectangles of all maps of a light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    side: u32,
    reversed: bool,
    rects: Vec<Rect>,
    texels: u32,
}

impl Layout {
    /// The rectangles of maps whose textures' longest side has `side` texels. Edges between maps stay
    /// shared; a map keeps at least one texel along each axis.
    ///
    /// # Panics
    /// From 2³² texels on.
    #[must_use]
    pub(super) fn new(maps: &[Map], side: u32) -> Self {
        let at = |v: &Viewport, corner: u32| {
            (u64::from(corner) * u64::from(side) / u64::from(v.parts)) as u32
        };
        let corners = |v: &Viewport| {
            let low = v.low.map(|corner| at(v, corner).min(side.saturating_sub(1)));
            let high = [0, 1].map(|axis| at(v, v.high[axis]).max(low[axis] + 1));
            (low, high)
        };
        let mut layers: Vec<u16> = maps.iter().map(|map| map.viewport.layer).collect();
        layers.sort_unstable();
        layers.dedup();
        let mut rects: Vec<Option<Rect>> = vec![None; maps.len()];
        let mut first = 0u32;
        for layer in layers {
            let of_layer = || maps.iter().enumerate().filter(|(_, m)| m.viewport.layer == layer);
            let highest = of_layer().map(|(_, m)| corners(&m.viewport).1);
            let texture = highest.fold([0; 2], |a: [u32; 2], b| [a[0].max(b[0]), a[1].max(b[1])]);
            for (i, map) in of_layer() {
                let (low, high) = corners(&map.viewport);
                let size = [high[0] - low[0], high[1] - low[1]];
                rects[i] = Some(Rect { first, texture, low, size });
            }
            let texels = texture[0].checked_mul(texture[1]).and_then(|n| first.checked_add(n));
            first = texels.expect("fewer than 2^32 texels");
        }
        let reversed = maps.iter().any(|map| map.clip.reversed);
        Self { side, reversed, rects: rects.into_iter().flatten().collect(), texels: first }
    }

    /// One texture that one map fills.
    #[must_use]
    pub fn whole(size: [u32; 2]) -> Self {
        let rects = vec![Rect::whole(size)];
        let side = size[0].max(size[1]);
        Self { side, reversed: false, rects, texels: size[0] * size[1] }
    }

    /// No texels.
    #[must_use]
    pub const fn empty() -> Self {
        Self { side: 0, reversed: false, rects: Vec::new(), texels: 0 }
    }

    /// Texels along the longest side of a whole texture.
    #[must_use]
    pub const fn side(&self) -> u32 {
        self.side
    }

    /// Whether window depths are the largest near the light: of all maps or of none.
    #[must_use]
    pub const fn reversed(&self) -> bool {
        self.reversed
    }

    /// The window depth of a texel that nothing is drawn into.
    #[must_use]
    pub const fn cleared(&self) -> f32 {
        if self.reversed { 0.0 } else { 1.0 }
    }

    /// The depth that comparisons use of a window depth, and the other way round: exact.
    #[must_use]
    #[inline(always)]
    pub const fn compared(&self, depth: f32) -> f32 {
        if self.reversed { -depth } else { depth }
    }

    /// The rectangle of each map.
    #[must_use]
    pub fn rects(&self) -> &[Rect] {
        &self.rects
    }

    /// The rectangle of a map.
    #[must_use]
    #[inline]
    pub fn rect(&self, map: usize) -> &Rect {
        &self.rects[map]
    }

    /// All texels of all textures.
    #[must_use]
    pub const fn texels(&self) -> usize {
        self.texels as usize
    }

    /// The map that a texel belongs to; none beside the viewports of an atlas.
    #[must_use]
    pub fn map_of(&self, texel: u32) -> Option<usize> {
        let inside = |rect: &Rect| {
            let [width, height] = rect.texture;
            texel >= rect.first && texel - rect.first < width * height && {
                let [x, y] = rect.place(texel);
                (0..i64::from(rect.size[0])).contains(&x)
                    && (0..i64::from(rect.size[1])).contains(&y)
            }
        };
        self.rects.iter().position(inside)
    }

    /// The one rectangle, where one map fills one texture.
    #[must_use]
    pub fn only(&self) -> Option<&Rect> {
        match self.rects.as_slice() {
            [rect] if rect.is_whole() => Some(rect),
            _ => None,
        }
    }

    /// Width and height of one picture with all textures from left to right.
    #[must_use]
    pub fn picture(&self) -> [u32; 2] {
        let textures = self.textures();
        let height = textures.iter().map(|t| t.texture[1]).max().unwrap_or(0);
        [textures.iter().map(|t| t.texture[0]).sum(), height]
    }

    /// One rectangle of each texture, in order.
    fn textures(&self) -> Vec<Rect> {
        let mut textures = self.rects.clone();
        textures.sort_by_key(|rect| rect.first);
        textures.dedup_by_key(|rect| rect.first);
        textures
    }

    /// The texel at a place of [`Self::picture`]; `None` beside a lower texture.
    #[must_use]
    pub fn pictured(&self, x: u32, y: u32) -> Option<u32> {
        let mut left = x;
        for rect in self.textures() {
            let [width, height] = rect.texture;
            if left < width {
                return (y < height).then_some(rect.first + y * width + left);
            }
            left -= width;
        }
        None
    }

    /// Column and row of a texel in [`Self::picture`].
    #[must_use]
    pub fn on_picture(&self, texel: u32) -> [u32; 2] {
        let mut left = 0;
        for rect in self.textures() {
            let [width, height] = rect.texture;
            if texel - rect.first < width * height {
                let within = texel - rect.first;
                return [left + within % width, within / width];
            }
            left += width;
        }
        [left, 0]
    }
}
