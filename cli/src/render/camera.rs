//! A pinhole camera in orbit around a body.

use glam::DVec3;

use crate::support::error::{Error, Result};

/// Largest side of a picture in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// Largest number of pixels of a picture: a gigabyte of R, G, B and coverage.
const MAX_PIXELS: u64 = 1 << 26;

/// Distance of a camera that fits the body into the picture, over the distance at which its bounding sphere fills it.
const MARGIN: f64 = 1.02;

/// The position and the picture of a [`Camera`], as a user gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Azimuth of the eye around z from +x, in degrees: 0 looks along −x, −90 along +y.
    pub azimuth_deg: f64,
    /// Elevation of the eye above the horizon, from −90 to 90 degrees.
    pub elevation_deg: f64,
    /// Angle that the shorter side of the picture spans, in degrees.
    pub field_of_view_deg: f64,
    /// Distance from the centre of the body's bounding sphere to the eye, in radii of this sphere; `None` fits the
    /// sphere into the picture.
    pub distance: Option<f64>,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Default for View {
    /// The view of the teapot with its spout to the right and towards the viewer.
    fn default() -> Self {
        Self { azimuth_deg: -60.0, elevation_deg: 24.0, field_of_view_deg: 30.0, distance: None, size: [1024, 1024] }
    }
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point from which all rays start.
    pub eye: DVec3,
    /// Unit vector to the right in the picture.
    pub right: DVec3,
    /// Unit vector upwards in the picture.
    pub up: DVec3,
    /// Unit vector from the body to the eye.
    pub backward: DVec3,
    /// Tangent of the angle from the middle to the edge of the shorter side.
    pub tangent: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Camera {
    /// The camera of a view that looks at a bounding sphere.
    ///
    /// # Errors
    /// An angle, a distance or a size that is out of range, as wrong usage.
    pub fn new(view: &View, centre: DVec3, radius: f64) -> Result<Self> {
        view.check()?;
        let (sin_azimuth, cos_azimuth) = view.azimuth_deg.to_radians().sin_cos();
        let (sin_elevation, cos_elevation) = view.elevation_deg.to_radians().sin_cos();
        let backward = DVec3::new(cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation);
        let right = DVec3::new(-sin_azimuth, cos_azimuth, 0.0);
        let half = 0.5 * view.field_of_view_deg.to_radians();
        let distance = view.distance.unwrap_or(MARGIN / half.sin()) * radius;
        Ok(Self {
            eye: centre + distance * backward,
            right,
            up: backward.cross(right),
            backward,
            tangent: half.tan(),
            size: view.size,
        })
    }

    /// The unit direction of the ray through a place of the picture, in pixels from its upper left corner; the centre
    /// of the first pixel is (½, ½).
    #[must_use]
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let [width, height] = self.size.map(f64::from);
        let per_pixel = 2.0 * self.tangent / width.min(height);
        let (x, y) = ((x - 0.5 * width) * per_pixel, (0.5 * height - y) * per_pixel);
        (x * self.right + y * self.up - self.backward).normalize()
    }
}

impl View {
    fn check(&self) -> Result<()> {
        let [width, height] = self.size;
        let in_range = |side: u32| (1..=MAX_SIDE).contains(&side);
        let refuse = |what: std::fmt::Arguments<'_>| Err(Error::usage(what));
        if !(in_range(width) && in_range(height)) {
            return refuse(format_args!("--size {width}x{height}: sides go from 1 to {MAX_SIDE} pixels"));
        }
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return refuse(format_args!("--size {width}x{height}: more than {MAX_PIXELS} pixels"));
        }
        let Self { azimuth_deg: azimuth, elevation_deg: elevation, field_of_view_deg: fov, distance, .. } = *self;
        if !azimuth.is_finite() {
            return refuse(format_args!("--azimuth {azimuth}: must be finite"));
        }
        if !(-90.0..=90.0).contains(&elevation) {
            return refuse(format_args!("--elevation {elevation}: must lie from -90 to 90 degrees"));
        }
        if !(0.1..=170.0).contains(&fov) {
            return refuse(format_args!("--fov {fov}: must lie from 0.1 to 170 degrees"));
        }
        match distance {
            Some(distance) if !(distance > 0.0 && distance <= 1e6) => {
                refuse(format_args!("--distance {distance}: must be positive, in radii of the mesh, and at most 1e6"))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_just_fits_and_up_is_up() {
        for (size, side) in [([400, 300], 300.0), ([300, 400], 300.0)] {
            let view = View { size, elevation_deg: 35.0, ..View::default() };
            let centre = DVec3::new(1.0, 2.0, 3.0);
            let camera = Camera::new(&view, centre, 2.0).unwrap();
            let middle = size.map(|s| 0.5 * f64::from(s));
            assert!(camera.direction(middle[0], middle[1]).distance(-camera.backward) < 1e-12);
            // The ray through the middle of an edge misses the sphere by less than the margin.
            let edge = camera.direction(
                middle[0] - if size[0] == 300 { 150.0 } else { 0.0 },
                middle[1] - if size[1] == 300 { 150.0 } else { 0.0 },
            );
            let miss = (centre - camera.eye).cross(edge).length();
            assert!((2.0..2.0 * MARGIN + 1e-9).contains(&miss), "{side}: {miss}");
            assert!(camera.up.z > 0.0 && camera.right.z.abs() < 1e-12);
            assert!(
                camera.direction(0.0, 0.0).dot(camera.right) < 0.0 && camera.direction(0.0, 0.0).dot(camera.up) > 0.0
            );
            let [r, u, b] = [camera.right, camera.up, camera.backward];
            assert!(r.cross(u).distance(b) < 1e-12);
        }
    }

    #[test]
    fn poles_have_a_right_side_too() {
        for elevation_deg in [-90.0, 90.0] {
            let camera = Camera::new(&View { elevation_deg, ..View::default() }, DVec3::ZERO, 1.0).unwrap();
            assert!(camera.direction(3.0, 5.0).is_finite() && (camera.up.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_out_of_range_is_named_by_its_option() {
        let refusal = |change: fn(&mut View)| {
            let mut view = View::default();
            change(&mut view);
            let error = Camera::new(&view, DVec3::ZERO, 1.0).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            error.to_string()
        };
        assert_eq!(refusal(|v| v.size = [0, 9]), "--size 0x9: sides go from 1 to 16384 pixels");
        assert!(refusal(|v| v.azimuth_deg = f64::NAN).starts_with("--azimuth NaN"));
        assert!(refusal(|v| v.elevation_deg = 91.0).starts_with("--elevation 91"));
        assert!(refusal(|v| v.field_of_view_deg = 180.0).starts_with("--fov 180"));
        assert!(refusal(|v| v.distance = Some(0.0)).starts_with("--distance 0"));
    }
}
