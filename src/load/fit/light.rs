//! The light of a case: stated by the settings, taken from the file, or fitted.

use super::bounds::Bounds;
use super::{chosen, sized, unit};
use crate::config::{LightSettings, LightType, Settings, no_cube};
use crate::{LightKind, LoadedLight, LoadedScene, LoadedShadow, range};
use glam::DVec3;
use gnomon_core::light::{Choice, Light, Viewport};
use gnomon_core::view::{Projection, View};
use gnomon_core::{Error, Result};

/// Texels along each side where nobody says how many.
const SIDE: u32 = 2048;

/// The light with its map, and what its light in the file says of the look-up.
pub(super) struct Lit {
    pub light: Light,
    /// Width and height of the map in texels.
    pub size: [u32; 2],
    /// What the file says of its map.
    pub shadow: Option<LoadedShadow>,
}

/// Where the light comes from.
enum Source<'a> {
    Stated(LightType),
    File(&'a LoadedLight),
    Nothing,
}

/// What is measured, with the words that go with it.
pub(super) struct Fit<'a> {
    pub bounds: &'a Bounds,
    pub scene: &'a LoadedScene,
    pub settings: &'a Settings,
    pub notes: &'a mut Vec<String>,
    pub skipped: &'a mut Vec<String>,
}

/// Whether a light can have one map.
pub(super) fn is_mapped(light: &LoadedLight) -> bool {
    light.kind != LightKind::Point
}

/// Whether a light is of a kind.
fn is_of(light: &LoadedLight, kind: LightType) -> bool {
    match light.kind {
        LightKind::Directional => kind == LightType::Directional,
        LightKind::Spot { .. } => kind == LightType::Spot,
        LightKind::Point => kind == LightType::Point,
    }
}

impl<'a> Fit<'a> {
    /// What the settings say of the light.
    pub(super) const fn given(&self) -> &'a LightSettings {
        &self.settings.light
    }

    /// The light that the settings ask for.
    pub(super) fn light(&mut self) -> Result<Lit> {
        let given = self.given();
        for (key, point) in [("light.position", given.position), ("light.target", given.target)] {
            range::setting(key, point)?;
        }
        match self.source()? {
            Source::Stated(LightType::Directional) => self.stated_directional(),
            Source::Stated(LightType::Spot | LightType::Point) => self.stated_spot(),
            Source::File(light) => self.of_file(light),
            Source::Nothing => {
                self.nothing();
                let direction = unit(DVec3::new(-0.5, -1.0, -0.3), "light")?;
                self.along(direction, None)
            }
        }
    }

    fn source(&self) -> Result<Source<'a>> {
        let (given, lights) = (self.given(), &self.scene.lights);
        let kind = given.stated()?;
        let stands = given.direction.is_some() || given.position.is_some();
        if stands {
            let reason = "has no effect: the settings say where the light is";
            let fix = "leave it out, or light.position and light.direction";
            self.settings.idle(&[("light.name", given.name.is_some())], reason, fix)?;
            return Ok(kind.map_or(Source::Nothing, Source::Stated));
        }
        if let Some(name) = &given.name {
            let light = chosen("light", lights, |light| &light.name, name)?;
            return match kind.filter(|&kind| !is_of(light, kind)) {
                Some(_) => Err(Error::bad_input(
                    "light.type",
                    format!("light '{}' of the file is of another kind", light.name),
                    "leave it out",
                )),
                None if is_mapped(light) => Ok(Source::File(light)),
                None => Err(no_cube(&format!("light.name '{name}'"))),
            };
        }
        match (kind, lights.iter().find(|light| kind.map_or(is_mapped(light), |k| is_of(light, k))))
        {
            (_, Some(light)) => Ok(Source::File(light)),
            (None, None) => Ok(Source::Nothing),
            (Some(kind), None) => Err(Error::bad_input(
                format!("light.type '{kind}'"),
                "the scene file has no such light",
                "say where it is: light.position, light.target or light.direction",
            )),
        }
    }

    fn nothing(&mut self) {
        let words = "directional along (-0.5, -1, -0.3)";
        match self.scene.lights.first() {
            None => self.notes.push(format!("no light is given: {words}")),
            Some(point) => self.skipped.push(format!(
                "light '{}' is a point light, whose cube of maps is not measured yet: in its place a \
                 light {words}",
                point.name
            )),
        }
    }

    /// A light of the file, and a word on the others.
    fn of_file(&mut self, light: &LoadedLight) -> Result<Lit> {
        let reason = "has no effect: the light stands where the scene file says";
        let fix = "give light.position too, or leave it out";
        self.settings.idle(&[("light.target", self.given().target.is_some())], reason, fix)?;
        let count = self.scene.lights.len();
        if count > 1 {
            self.notes.push(format!(
                "light '{}' is measured, one of {count}: choose with --light NAME, or --light all",
                light.name
            ));
        }
        let shadow = light.shadow.as_ref();
        match (light.kind, shadow.filter(|shadow| shadow.sides.is_some())) {
            (LightKind::Spot { cone_degrees }, _) => {
                let target = light.position + light.direction * self.bounds.radius;
                let reach = light.range;
                self.spot(light.position, target, Some(cone_degrees), reach, shadow)
            }
            (LightKind::Directional | LightKind::Point, Some(shadow)) => {
                self.standing(light.position, light.position + light.direction, Some(shadow))
            }
            (LightKind::Directional | LightKind::Point, None) => {
                self.along(light.direction, shadow)
            }
        }
    }

    fn stated_directional(&mut self) -> Result<Lit> {
        let given = self.given().clone();
        let direction = given.direction.map(|d| unit(DVec3::from_array(d), "light.direction"));
        let direction = direction.transpose()?;
        if let (Some(_), Some(_)) = (direction, given.target) {
            let (reason, fix) = match given.position {
                Some(_) => {
                    ("and light.direction both say where it shines", "leave one of them out")
                }
                None => (
                    "has no effect on a directional light without a position",
                    "leave it out, or give light.position in place of light.direction",
                ),
            };
            return Err(Error::bad_input("light.target", reason, fix));
        }
        match (given.position.map(DVec3::from_array), direction) {
            (None, direction) => {
                let direction = direction.ok_or_else(|| {
                    Error::bad_input("light", "shines nowhere", "give light.direction")
                })?;
                self.along(direction, None)
            }
            (Some(position), Some(direction)) => {
                self.standing(position, position + direction, None)
            }
            (Some(position), None) => {
                let target = given.target.map(DVec3::from_array).unwrap_or_else(|| {
                    let words = "the light looks at the origin, since light.target is not given";
                    self.skipped.push(words.to_string());
                    DVec3::ZERO
                });
                self.standing(position, target, None)
            }
        }
    }

    fn stated_spot(&mut self) -> Result<Lit> {
        let given = self.given().clone();
        let Some(position) = given.position.map(DVec3::from_array) else {
            let fix = "give light.position, or light.type = \"directional\"";
            return Err(Error::bad_input("light.type 'spot'", "stands nowhere", fix));
        };
        let target = match (given.direction, given.target) {
            (Some(_), Some(_)) => {
                let reason = "and light.direction both say where it shines";
                return Err(Error::bad_input("light.target", reason, "leave one of them out"));
            }
            (Some(direction), None) => {
                position + unit(DVec3::from_array(direction), "light.direction")?
            }
            (None, target) => target.map_or(self.bounds.centre, DVec3::from_array),
        };
        self.spot(position, target, None, None, None)
    }

    /// Width and height of the map in texels: the settings', else the file's.
    ///
    /// # Errors
    /// [`Error::BadInput`] beyond the limits of a map.
    pub(super) fn size(&self, shadow: Option<&LoadedShadow>) -> Result<[u32; 2]> {
        let of_file = || shadow.and_then(|shadow| shadow.size);
        let size = self.settings.map.size.or_else(of_file).unwrap_or([SIDE; 2]);
        sized("map.size", size).map(|()| size)
    }

    /// The light with its one map.
    pub(super) fn mapped(
        &self,
        view: View,
        projection: Projection,
        cone: Option<f64>,
        shadow: Option<&LoadedShadow>,
    ) -> Result<Lit> {
        let size = self.size(shadow)?;
        let light = Light::new(view.checked("light")?, projection.checked("light")?, cone);
        let map = light.only_map().copied().filter(|_| size[0] != size[1]);
        let light = match map {
            Some(map) => light.with_maps(vec![map.on(Viewport::rectangle(size))], Choice::Only)?,
            None => light,
        };
        Ok(Lit { light, size, shadow: shadow.cloned() })
    }
}
