//! What the command line asks of the main job: which cases, on which device, by which map and effort.

use super::{Options, Which};
use crate::analysis::captured::{self, CapturedArguments};
use crate::analysis::effort::EffortArguments;
use crate::analysis::need::Need;
use crate::device::DeviceProfile;
use crate::raster::passes::Subject;
use crate::report::Profile;
use crate::scene::{Case, cases};
use crate::scene_file::UserScene;
use crate::{Error, Result};
use std::path::PathBuf;

/// What to measure and how; flatten it into a binary's arguments.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Ask {
    /// Only this case
    #[arg(long, value_name = "NAME", conflicts_with = "scene")]
    pub case: Option<String>,
    /// A scene of the user's own.
    #[command(flatten)]
    pub scene: UserScene,
    /// Measure on this device profile instead of each case's own
    #[arg(long, value_name = "PROFILE")]
    pub device: Option<DeviceProfile>,
    /// A map that an engine drew.
    #[command(flatten)]
    pub captured: CapturedArguments,
    /// Also write the map of the one case here, as it would be captured (.png, .exr or .raw)
    #[arg(long, value_name = "FILE")]
    pub save_map: Option<PathBuf>,
    /// How to measure.
    #[command(flatten)]
    pub effort: EffortArguments,
}

impl Ask {
    /// The options of the main job. Reads the scene and the captured map, writes the asked map.
    ///
    /// # Errors
    /// As reading and writing them.
    pub fn options(&self, profile: Profile, seed: u64) -> Result<Options> {
        let mut asked = self.asked()?;
        let captured = match asked.as_mut_slice() {
            [case] => self.captured.apply(case, self.scene.file.scene.is_some())?,
            _ if self.captured.map_file.is_none() && self.save_map.is_none() => None,
            _ => {
                let fix = "give --case, or --scene with one light";
                return Err(Error::bad_input("--map-file, --save-map", "belong to one case", fix));
            }
        };
        for case in &asked {
            let step = Options { profile, ..Options::default() }.step();
            Need::REPORT.check(case, step)?;
        }
        if let (Some(path), [case]) = (&self.save_map, asked.as_slice()) {
            let device = case.device.device();
            captured::write(&Subject::draw(case, &device).map, &device, path)?;
        }
        Ok(Options {
            profile,
            seed,
            which: match asked.len() {
                0 => Which::All,
                1 => asked.pop().map_or(Which::All, |case| Which::Own(Box::new(case))),
                _ => Which::Each(asked),
            },
            device: self.device,
            effort: self.effort.effort(),
            captured,
        })
    }

    /// The cases asked for, on the device asked for; none where nobody asks.
    fn asked(&self) -> Result<Vec<Case>> {
        let mut list = self.scene.cases()?;
        if let (true, Some(name)) = (list.is_empty(), &self.case) {
            list.push(cases::named(name)?);
        }
        list.iter_mut().for_each(|case| case.device = self.device.unwrap_or(case.device));
        Ok(list)
    }
}
