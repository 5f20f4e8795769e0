//! In what the parameter of a bias strategy is measured.

crate::catalogue! {
    /// The unit of a strategy's parameter.
    pub enum Unit {
        /// The parameter does nothing.
        Nothing = "nothing",
        /// Window depth, 0 at the near and 1 at the far plane.
        WindowDepth = "window depth",
        /// World length.
        WorldUnits = "world units",
        /// Edges of a texel at the receiver or caster.
        Texels = "texels",
        /// Steps of the map's format at the receiver's depth.
        FormatSteps = "format steps",
        /// Depth slopes m, window depth per texel.
        Slopes = "slopes per texel",
        /// Tens of slopes and of units r together.
        TenthsOfASlope = "tenths of a slope",
        /// Smallest resolvable differences r of the depth attachment.
        UnitsR = "units r",
        /// Diagonals of a texel.
        TexelDiagonals = "texel diagonals",
        /// Halves of a texel's edge.
        HalfTexels = "half texels",
        /// Quarters of a texel's edge.
        QuarterTexels = "quarter texels",
        /// Clip-space depth before the division by w: window depth times w.
        ClipDepth = "clip-space depth",
        /// Multiples of what the strategy does by itself.
        OwnMultiples = "multiples of its own",
    }
}
