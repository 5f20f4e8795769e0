//! Animations: where nodes and morph weights are at a time, in seconds.

use super::super::Wanted;
use super::super::told::Told;
use super::accessor::{AGAIN, Source};
use super::document::File;
use super::nodes::Placed;
use glam::{DQuat, DVec3};
use gltf::animation::{Interpolation, Property};
use gnomon_core::{Error, Result};
use std::collections::HashMap;

/// Sets the nodes of a file to the wanted time of the wanted animation, each channel held within its own
/// range; gives the weights of morph targets that it sets, by node. Without a time nothing moves.
pub(super) fn play(
    place: &str,
    file: &mut File<'_>,
    wanted: &Wanted,
    told: &mut Told,
) -> Result<HashMap<usize, Vec<f64>>> {
    let mut weights = HashMap::new();
    let Some(time) = wanted.time else { return Ok(weights) };
    for _ in 0..file.unread {
        told.add("animation channel", "of other things than nodes: not played", "");
    }
    let File { document, buffers, nodes, .. } = file;
    let animation = chosen(place, document, wanted)?;
    for (i, channel) in animation.channels().enumerate() {
        let at = format!("{place}: animations[{}].channels[{i}]", animation.index());
        let node = channel.target().node();
        if channel.target().property() == Property::MorphTargetWeights && node.mesh().is_none() {
            told.add("animated weight", "without a mesh: left out", node.name().unwrap_or(""));
            continue;
        }
        let source = Source::all(&at, buffers);
        let value = Curve::read(&source, &channel)?.at(time);
        let Some(placed) = nodes.get_mut(node.index()) else { continue };
        match channel.target().property() {
            Property::MorphTargetWeights => drop(weights.insert(node.index(), value)),
            property @ (Property::Translation | Property::Rotation | Property::Scale) => {
                set(placed, property, &value);
            }
        }
    }
    Ok(weights)
}

fn chosen<'d>(
    place: &str,
    document: &'d gltf::Document,
    wanted: &Wanted,
) -> Result<gltf::Animation<'d>> {
    let count = document.animations().len();
    let (found, reason) = match &wanted.animation {
        Some(name) => {
            let named = document.animations().find(|a| a.name() == Some(name.as_str()));
            let numbered = || document.animations().nth(name.parse().ok()?);
            (named.or_else(numbered), format!("none of {count} is '{name}'"))
        }
        None => (document.animations().next(), "there is none, but a time is given".to_string()),
    };
    let fix = "give the name or number of one of its animations, or no time";
    found.ok_or_else(|| Error::bad_input(format!("{place}: animations"), reason, fix))
}

/// Sets one property of a node; one that is given by a matrix is taken apart.
fn set(placed: &mut Placed, property: Property, value: &[f64]) {
    let (mut t, mut r, mut s) = match *placed {
        Placed::Parts { translation, rotation, scale } => (translation, rotation, scale),
        Placed::Matrix(matrix) => {
            let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
            (translation, rotation, scale)
        }
    };
    match (property, value) {
        (Property::Translation, &[x, y, z]) => t = DVec3::new(x, y, z),
        (Property::Scale, &[x, y, z]) => s = DVec3::new(x, y, z),
        (Property::Rotation, &[x, y, z, w]) => r = DQuat::from_xyzw(x, y, z, w),
        (Property::Translation | Property::Scale | Property::Rotation, _)
        | (Property::MorphTargetWeights, _) => {}
    }
    *placed = Placed::Parts { translation: t, rotation: r, scale: s };
}

/// Keys of one property over time.
struct Curve {
    times: Vec<f64>,
    /// Numbers of all keys; a cubic key has an in-tangent, a value and an out-tangent.
    values: Vec<f64>,
    /// Numbers of one value.
    width: usize,
    interpolation: Interpolation,
    turns: bool,
}

fn numbers<const N: usize>(source: &Source<'_>, accessor: &gltf::Accessor<'_>) -> Result<Vec<f64>> {
    let read = source.vectors::<N>("the numbers of an animation", accessor)?;
    Ok(read.into_iter().flatten().map(f64::from).collect())
}

impl Curve {
    fn read(source: &Source<'_>, channel: &gltf::animation::Channel<'_>) -> Result<Self> {
        let (sampler, property) = (channel.sampler(), channel.target().property());
        let times = numbers::<1>(source, &sampler.input())?;
        let output = sampler.output();
        let values = match property {
            Property::Translation | Property::Scale => numbers::<3>(source, &output)?,
            Property::Rotation => numbers::<4>(source, &output)?,
            Property::MorphTargetWeights => numbers::<1>(source, &output)?,
        };
        let interpolation = sampler.interpolation();
        let each = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let keys = times.len() * each;
        let width = values.len() / keys.max(1);
        if width == 0 || width * keys != values.len() {
            let reason = format!("has {} times for {} numbers", times.len(), values.len());
            return Err(Error::bad_input(source.place, reason, AGAIN));
        }
        Ok(Self { times, values, width, interpolation, turns: property == Property::Rotation })
    }

    /// Numbers of `part` (of those of a cubic key: 0 in, 1 value, 2 out) of a key.
    fn key(&self, key: usize, part: usize) -> &[f64] {
        let place = match self.interpolation {
            Interpolation::CubicSpline => 3 * key + part,
            Interpolation::Linear | Interpolation::Step => key,
        };
        self.values.get(place * self.width..(place + 1) * self.width).unwrap_or_default()
    }

    /// The value at a time: that of the first key before it begins, of the last after it has ended.
    fn at(&self, time: f64) -> Vec<f64> {
        let after = self.times.partition_point(|&t| t <= time);
        let Some(before) = after.checked_sub(1) else { return self.key(0, 1).to_vec() };
        let (from, to) = (self.key(before, 1), self.key(after, 1));
        let span = self.times.get(before).zip(self.times.get(after)).map(|(a, b)| (*a, b - a));
        let Some((begin, span)) = span else { return from.to_vec() };
        let t = (time - begin) / span;
        match self.interpolation {
            Interpolation::Step => from.to_vec(),
            Interpolation::Linear if self.turns => slerp(from, to, t),
            Interpolation::Linear => from.iter().zip(to).map(|(a, b)| a + (b - a) * t).collect(),
            Interpolation::CubicSpline => {
                let out = self.key(before, 2).iter().zip(self.key(after, 0));
                let value = from.iter().zip(to).zip(out).map(|((a, b), (m, n))| {
                    let (t2, t3) = (t * t, t * t * t);
                    (2.0 * t3 - 3.0 * t2 + 1.0) * a
                        + (t3 - 2.0 * t2 + t) * span * m
                        + (3.0 * t2 - 2.0 * t3) * b
                        + (t3 - t2) * span * n
                });
                let value: Vec<f64> = value.collect();
                if self.turns { unit(&value) } else { value }
            }
        }
    }
}

fn unit(v: &[f64]) -> Vec<f64> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.iter().map(|x| x / length).collect()
}

/// The shorter way round from one rotation to another (glTF 2.0, appendix C.4).
fn slerp(from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
    let dot: f64 = from.iter().zip(to).map(|(a, b)| a * b).sum();
    let angle = libm::acos(dot.abs().min(1.0));
    let sine = libm::sin(angle);
    let (a, b) = match sine > 1e-9 {
        true => (libm::sin((1.0 - t) * angle) / sine, libm::sin(t * angle) / sine),
        false => (1.0 - t, t),
    };
    let value: Vec<f64> = from.iter().zip(to).map(|(x, y)| a * x + b * dot.signum() * y).collect();
    unit(&value)
}
