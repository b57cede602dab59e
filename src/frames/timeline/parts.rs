//! The scene of an animated drawing at a time: only what moves is parsed anew.

use super::document::Values;
use super::Timeline;
use crate::frames::cels::Cels;
use crate::frames::split::Split;
use crate::{Error, Options, Scene};

impl Timeline {
    /// The scene that is seen `seconds` after the start: that of [`Timeline::document_at`]. `cels` keeps what
    /// was seen before.
    ///
    /// # Errors
    /// As [`Scene::from_bytes`].
    pub fn scene_at(&self, seconds: f64, cels: &Cels, options: &Options) -> Result<Scene, Error> {
        let split = self.split.get_or_init(|| self.template.split(options.usvg.style_sheet.as_deref()));
        let mut values = Values::new();
        self.values_at(seconds, &mut values);
        let fill = |bytes, out: &mut String| self.template.fill(bytes, &values, out);
        if let Some(scene) = split.as_ref().and_then(|split| cels.of_split(split, &fill, options)) {
            return Ok(scene);
        }
        Scene::from_bytes(self.template.filled(&values).as_bytes(), options)
    }
}

impl super::Template {
    fn split(&self, style_sheet: Option<&str>) -> Option<Split> {
        let holes: Vec<usize> = self.holes().collect();
        Split::new(self.text(), style_sheet, &holes)
    }
}
