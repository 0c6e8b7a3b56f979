//! One colour per agent, the same in every plot, told apart with any colour vision.

/// For up to eight agents: the colours of Okabe and Ito, darkened where they are faint on white.
const LIGHT: [u32; 8] = [0x0072b2, 0xd55e00, 0x009e73, 0xc4579a, 0xc58b00, 0x46a5dd, 0x555b66, 0x8f8f00];
/// The same on a dark ground.
const DARK: [u32; 8] = [0x3f9bd8, 0xf07f3c, 0x2fbf93, 0xe08cc0, 0xf0b43a, 0x92d2f8, 0xa9b0bc, 0xe8e04a];
/// For more: viridis, even in lightness, at nine places.
const VIRIDIS: [u32; 9] = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];

/// The ground that colours are drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    Light,
    Dark,
}

/// Lines and discs are told from the ground by at least this contrast, as WCAG 2.1 asks of what is drawn.
const CONTRAST: f64 = 3.0;

impl Ground {
    /// Of cards, on which everything is drawn.
    const fn colour(self) -> [u8; 3] {
        match self {
            Ground::Light => [0xff; 3],
            Ground::Dark => [0x17, 0x1a, 0x20],
        }
    }
}

/// The same hue, so much darker or lighter that it is seen on the ground.
fn seen_on(ground: Ground, mut colour: [u8; 3]) -> [u8; 3] {
    while contrast(colour, ground.colour()) < CONTRAST {
        colour = colour.map(|part| match ground {
            Ground::Light => (f64::from(part) * 0.97) as u8,
            Ground::Dark => (f64::from(part) + 0.03 * (255.0 - f64::from(part))).ceil() as u8,
        });
    }
    colour
}

/// The ratio of two luminances, each with the light that screens reflect.
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let linear = |part: u8| {
        let part = f64::from(part) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    };
    let luminance = |[r, g, b]: [u8; 3]| 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
    a.max(b) / a.min(b)
}

/// The colour of one of `count` agents as red, green, blue.
pub(crate) fn agent(agent: usize, count: usize, ground: Ground) -> [u8; 3] {
    let few = if ground == Ground::Light { LIGHT } else { DARK };
    match few.get(agent) {
        Some(colour) if count <= few.len() => seen_on(ground, rgb(*colour)),
        _ => ramp(agent, count, ground),
    }
}

/// One of `count` colours in order, for things that are not agents.
pub(crate) fn ramp(index: usize, count: usize, ground: Ground) -> [u8; 3] {
    // The ends that vanish on the ground are left out.
    let (first, last) = if ground == Ground::Light { (0.0, 0.82) } else { (0.3, 1.0) };
    let share = if count > 1 { index as f64 / (count - 1) as f64 } else { 0.5 };
    let place = (first + (last - first) * share) * (VIRIDIS.len() - 1) as f64;
    let below = (place.floor() as usize).min(VIRIDIS.len() - 2);
    let part = place - below as f64;
    let (a, b) = (rgb(VIRIDIS[below]), rgb(VIRIDIS[below + 1]));
    let between = [0, 1, 2].map(|k| (f64::from(a[k]) + part * (f64::from(b[k]) - f64::from(a[k]))).round() as u8);
    seen_on(ground, between)
}

/// As in CSS.
pub(crate) fn css([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn rgb(colour: u32) -> [u8; 3] {
    let [_, r, g, b] = colour.to_be_bytes();
    [r, g, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_is_seen_on_its_ground() {
        assert!((contrast([0; 3], [255; 3]) - 21.0).abs() < 1e-9);
        for ground in [Ground::Light, Ground::Dark] {
            for count in [1, 2, 3, 8, 9, 17, 100] {
                for k in 0..count {
                    for colour in [agent(k, count, ground), ramp(k, count, ground)] {
                        let found = contrast(colour, ground.colour());
                        assert!(found >= CONTRAST, "{k} of {count} on {ground:?}: {} has {found}", css(colour));
                    }
                }
            }
        }
    }
}
