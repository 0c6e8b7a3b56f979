//! Random trees of physical bodies, and random numbers for them, from a seed.

use forwardstep_core::robot::tree::{Assembled, JointKind, LinkJoint, LinkSpec, Placement, Tree};
use forwardstep_core::robot::{Drives, Friction};

/// A small generator of our own: the same trees on every machine and with every version of every crate.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(2).wrapping_add(1))
    }

    /// Uniform in [−1, 1).
    pub(crate) fn number(&mut self) -> f64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.number() < 2.0 * probability - 1.0
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (((self.number() + 1.0) / 2.0 * end as f64) as usize).min(end - 1)
    }

    pub(crate) fn vector(&mut self, scale: f64) -> [f64; 3] {
        [self.number() * scale, self.number() * scale, self.number() * scale]
    }

    pub(crate) fn column(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| self.number() * scale).collect()
    }

    pub(crate) fn placement(&mut self) -> Placement {
        Placement::from_xyz_rpy(self.vector(0.5), self.vector(3.0))
    }

    /// Mass points: whatever they add up to is a body that can exist.
    pub(crate) fn cloud(&mut self) -> Vec<(f64, [f64; 3])> {
        (0..6).map(|_| (0.1 + (self.number() + 1.0) / 2.0, self.vector(0.3))).collect()
    }

    fn axis(&mut self) -> [f64; 3] {
        let mut axis = [0.0; 3];
        if self.chance(0.7) {
            let sign = if self.chance(0.5) { 1.0 } else { -1.0 };
            axis[self.below(3)] = sign;
            return axis;
        }
        loop {
            axis = self.vector(1.0);
            let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
            if length > 0.1 {
                return axis.map(|x| x / length);
            }
        }
    }

    /// Moving links only, some of them damped; branches may start anywhere.
    pub(crate) fn links(&mut self, joints: usize) -> Vec<LinkSpec> {
        (0..joints)
            .map(|link| LinkSpec {
                parent: match link {
                    0 => None,
                    _ if self.chance(0.2) => None,
                    _ if self.chance(0.4) => Some(self.below(link)),
                    _ => Some(link - 1),
                },
                x_parent_joint: self.placement(),
                joint: LinkJoint::Moving {
                    kind: if self.chance(0.25) { JointKind::Prismatic } else { JointKind::Revolute },
                    axis: self.axis(),
                    damping: if self.chance(0.5) { 1.0 + self.number() } else { 0.0 },
                },
                inertia: inertia_of(&self.cloud()),
            })
            .collect()
    }

    pub(crate) fn tree(&mut self, joints: usize) -> Assembled {
        let links = self.links(joints);
        let gravity = self.vector(9.81);
        Tree::assemble(&links, gravity).unwrap()
    }

    /// The same with rotors and friction at some joints.
    pub(crate) fn driven_tree(&mut self, joints: usize, dry: bool) -> Assembled {
        let mut assembled = self.tree(joints);
        let geared: Vec<usize> = (0..joints).filter(|_| self.chance(0.5)).collect();
        let rubbing: Vec<usize> = (0..joints).filter(|_| self.chance(0.7)).collect();
        assembled.theta.extend((0..geared.len() + rubbing.len()).map(|_| 1.0 + 0.9 * self.number()));
        let friction = rubbing.into_iter().map(|joint| Friction { joint, width: 0.3 + 0.2 * self.number() }).collect();
        let drives = Drives { geared, friction, dry_s: dry.then_some(1e-3), ..assembled.tree.drives().clone() };
        assembled.tree = assembled.tree.with_drives(drives).unwrap();
        assembled
    }
}

/// π of mass points about the frame they are stated in.
pub(crate) fn inertia_of(cloud: &[(f64, [f64; 3])]) -> [f64; 10] {
    let mut pi = [0.0; 10];
    for (m, [x, y, z]) in cloud {
        let entries = [1.0, *x, *y, *z, y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y];
        for (sum, entry) in pi.iter_mut().zip(entries) {
            *sum += m * entry;
        }
    }
    pi
}
