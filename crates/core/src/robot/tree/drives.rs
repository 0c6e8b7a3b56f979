//! The drives of a tree, whose parameters close ϑ.

use super::model::Tree;
use crate::robot::{DriveError, Drives};

impl Tree {
    /// The same tree with `drives` in the place of what acts at its joints, the dampings of [`Tree::assemble`] included. Their parameters
    /// close ϑ: a damping in N m s or N s/m for each damped joint, an armature in kg m² or kg for each geared one, F in N m or N for each
    /// with friction.
    ///
    /// # Errors
    /// [`DriveError`] when a joint does not exist or is out of order, or a width is not positive.
    pub fn with_drives(mut self, drives: Drives) -> Result<Tree, DriveError> {
        drives.check(self.joint_count())?;
        let [_, armatures, _] = drives.ranges();
        let first = self.body_parameters() + armatures.start;
        for (joint, body) in self.bodies.iter_mut().enumerate() {
            body.armature = drives.geared.iter().position(|geared| *geared == joint).map(|k| first + k);
        }
        self.drives = drives;
        Ok(self)
    }

    /// What acts at the joints.
    pub fn drives(&self) -> &Drives {
        &self.drives
    }

    /// Length of ϑ.
    pub fn theta_len(&self) -> usize {
        self.body_parameters() + self.drives.count()
    }

    /// How many parameters the bodies have, which begin ϑ.
    #[inline(always)]
    pub(super) fn body_parameters(&self) -> usize {
        10 * self.bodies.len()
    }
}
