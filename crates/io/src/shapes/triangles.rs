//! Triangles: of simple bodies, and of files.

use std::f64::consts::PI;

use super::collada;

/// Triangles that a robot may have before they are made fewer.
pub(super) const MOST_TRIANGLES: usize = 4_000_000;
/// Edges of a circle.
const ROUND: usize = 24;

/// Points, and three numbers of points for each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Triangles {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl Triangles {
    /// A box about the origin with edges of these lengths.
    pub(super) fn cuboid(size: [f64; 3]) -> Triangles {
        let corner = |k: usize| [0, 1, 2].map(|axis| size[axis] * if k >> axis & 1 == 1 { 0.5 } else { -0.5 });
        let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let faces = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Triangles { points: (0..8).map(corner).collect(), faces }
    }

    /// A cylinder about z, with its middle at the origin.
    pub(super) fn cylinder(radius: f64, length: f64) -> Triangles {
        Triangles::turned(&[[0.0, -0.5 * length], [radius, -0.5 * length], [radius, 0.5 * length], [0.0, 0.5 * length]])
    }

    /// A ball about the origin.
    pub(super) fn sphere(radius: f64) -> Triangles {
        let rows = ROUND / 2;
        let at = |row: usize| {
            let angle = PI * row as f64 / rows as f64;
            [radius * angle.sin(), -radius * angle.cos()]
        };
        Triangles::turned(&(0..=rows).map(at).collect::<Vec<_>>())
    }

    /// A line of distances from z and heights, turned about z.
    fn turned(line: &[[f64; 2]]) -> Triangles {
        let ring = |[distance, height]: &[f64; 2]| {
            let (distance, height) = (*distance, *height);
            (0..ROUND).map(move |k| {
                let angle = 2.0 * PI * k as f64 / ROUND as f64;
                [distance * angle.cos(), distance * angle.sin(), height]
            })
        };
        let round = ROUND as u32;
        let points = line.iter().flat_map(ring).collect();
        let faces = (1..line.len() as u32).flat_map(|row| {
            (0..round).flat_map(move |k| {
                let next = (k + 1) % round;
                let [a, b, c, d] =
                    [(row - 1, k), (row - 1, next), (row, next), (row, k)].map(|(row, k)| round * row + k);
                [[a, b, c], [a, c, d]]
            })
        });
        Triangles { points, faces: faces.collect() }
    }

    /// Those of a file whose name ends as its format does.
    pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Triangles, String> {
        let format = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
        let read = match format.as_str() {
            "stl" => scene(mesh_loader::stl::from_slice(bytes)).and_then(|read| whole(read, bytes)),
            // What an OBJ says of colours is in other files.
            "obj" => scene(mesh_loader::obj::from_slice(bytes, None, |_| {
                Err::<&[u8], _>(std::io::Error::other("no other files"))
            })),
            "dae" => collada::triangles(bytes),
            _ => return Err("it is no STL, OBJ or DAE".to_owned()),
        }?;
        let read = read.sound();
        if read.faces.is_empty() { Err("it has no triangles".to_owned()) } else { Ok(read) }
    }

    /// Without triangles whose points are not there, are not finite, or are so large that they are no robot's.
    pub(super) fn sound(mut self) -> Triangles {
        const MOST_METRES: f64 = 1e6;
        let is_sound =
            |k: &u32| self.points.get(*k as usize).is_some_and(|point| point.iter().all(|x| x.abs() <= MOST_METRES));
        self.faces.retain(|face| face.iter().all(is_sound));
        self.points.iter_mut().flatten().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
        self
    }

    /// Each coordinate multiplied.
    pub(super) fn scaled(mut self, by: [f64; 3]) -> Triangles {
        self.points.iter_mut().for_each(|point| point.iter_mut().zip(by).for_each(|(x, by)| *x *= by));
        self
    }
}

/// A binary STL says how many triangles it has; one that was cut off has fewer.
fn whole(read: Triangles, bytes: &[u8]) -> Result<Triangles, String> {
    let stated = bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    match stated {
        Some(stated) if !bytes.starts_with(b"solid") && read.faces.len() != stated as usize => {
            Err(format!("it states {stated} triangles and has {}", read.faces.len()))
        }
        _ => Ok(read),
    }
}

fn scene(read: std::io::Result<mesh_loader::Scene>) -> Result<Triangles, String> {
    let scene = read.map_err(|error| format!("it cannot be read: {error}"))?;
    let mut all = Triangles::default();
    for mesh in scene.meshes {
        let first = u32::try_from(all.points.len()).map_err(|_| "it has too many points")?;
        all.points.extend(mesh.vertices.iter().map(|point| point.map(f64::from)));
        let moved = mesh.faces.iter().map(|face| face.map(|k| k.saturating_add(first)));
        all.faces.extend(moved);
        if all.faces.len() > MOST_TRIANGLES {
            return Err("it has too many triangles".to_owned());
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The volume that triangles enclose, if all face the same way.
    fn volume(of: &Triangles) -> f64 {
        let det = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|k| of.points[k as usize]);
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        of.faces.iter().map(det).sum::<f64>() / 6.0
    }

    #[test]
    fn simple_bodies_enclose_their_volumes() {
        assert!((volume(&Triangles::cuboid([1.0, 2.0, 3.0])).abs() - 6.0).abs() < 1e-12);
        let cylinder = volume(&Triangles::cylinder(0.5, 2.0)).abs();
        assert!((cylinder - PI * 0.5).abs() < 0.03 * cylinder, "{cylinder}");
        let sphere = volume(&Triangles::sphere(0.5)).abs();
        assert!((sphere - PI / 6.0).abs() < 0.05 * sphere, "{sphere}");
    }

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1//1 3//1 4//1\n";
    const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

    #[test]
    fn files_are_read_by_their_endings() {
        assert_eq!(Triangles::read("a.OBJ", OBJ.replace("//1", "").as_bytes()).unwrap().faces.len(), 2);
        assert_eq!(Triangles::read("a.stl", STL.as_bytes()).unwrap().points[1], [1.0, 0.0, 0.0]);
        let mut binary = vec![0; 80];
        binary.extend(1u32.to_le_bytes());
        binary.extend([0f32; 3].iter().chain(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]).flat_map(|x| x.to_le_bytes()));
        binary.extend([0, 0]);
        assert_eq!(Triangles::read("a.stl", &binary).unwrap().faces.len(), 1);
        // What is claimed is not there.
        binary[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        let stated = Err("it states 4294967295 triangles and has 1".into());
        assert_eq!(Triangles::read("a.stl", &binary), stated);
        assert_eq!(Triangles::read("a.step", b"x"), Err("it is no STL, OBJ or DAE".into()));
        for (name, bytes) in [
            ("a.stl", &b""[..]),
            ("a.obj", b""),
            ("a.obj", b"f 1 2 3\n"),
            ("a.obj", b"v nan 0 0\nf 1 1 1\n"),
            ("a.dae", b"<x/>"),
        ] {
            assert!(Triangles::read(name, bytes).is_err(), "{name} {bytes:?}");
        }
    }

    #[test]
    fn broken_files_are_refused_and_nothing_panics() {
        let mut random = 1u64;
        let mut next = || {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (random >> 33) as usize
        };
        let texts = [("a.obj", OBJ), ("a.stl", STL), ("a.dae", collada::tests::DAE)];
        for _ in 0..4000 {
            for (name, text) in texts {
                let mut bytes = text.as_bytes().to_vec();
                for _ in 0..1 + next() % 4 {
                    let at = next() % bytes.len();
                    match next() % 3 {
                        0 => bytes[at] = next() as u8,
                        1 => bytes.truncate(at.max(1)),
                        _ => bytes[at] = b"0-9e./<>\" "[next() % 10],
                    }
                }
                let _ = Triangles::read(name, &bytes);
            }
        }
    }
}
