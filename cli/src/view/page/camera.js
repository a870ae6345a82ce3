// A camera in orbit around the unit sphere, as `render` has it: azimuth around z, elevation above the horizon.

const MARGIN = 1.02;

class Camera {
  constructor(view) {
    this.start = view;
    this.fieldOfView = view.fieldOfView;
    this.reset();
  }

  reset() {
    [this.azimuth, this.elevation, this.zoom] = [this.start.azimuth, this.start.elevation, 1];
  }

  orbit(right, up) {
    this.azimuth = ((((this.azimuth - right + 180) % 360) + 360) % 360) - 180;
    this.elevation = clamp(this.elevation - up, -89.9, 89.9);
  }

  /** Zooms by a factor; the distance is the one that fits the body into the picture, over `zoom`. */
  zoomBy(factor) {
    this.zoom = clamp(this.zoom * factor, 0.4, 4);
  }

  /** Eye and axes of the camera for a picture of a size. */
  at(width, height) {
    const [azimuth, elevation] = [radians(this.azimuth), radians(this.elevation)];
    const backward = [
      Math.cos(elevation) * Math.cos(azimuth),
      Math.cos(elevation) * Math.sin(azimuth),
      Math.sin(elevation),
    ];
    const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
    const half = radians(this.fieldOfView) / 2;
    const distance = Math.max(MARGIN / Math.sin(half) / this.zoom, 1.05);
    const scale = Math.min(width, height) / Math.tan(half);
    return {
      eye: times(backward, distance),
      right,
      up: cross(backward, right),
      backward,
      distance,
      /** Distance from the middle, over half the picture, of a direction one unit aside for one forward. */
      scale: [scale / width, scale / height],
    };
  }

  /** Pixels of a picture, as left, bottom, width and height, beyond which no part of the unit sphere is seen. */
  around(width, height) {
    const { distance, scale } = this.at(width, height);
    const reach = 1 / Math.sqrt(distance * distance - 1);
    // Jitter moves the picture by less than a pixel.
    const [x, y] = [width, height].map((side, i) => Math.min(Math.ceil((side / 2) * scale[i] * reach) + 2, side));
    const [left, bottom] = [Math.max(Math.floor(width / 2 - x), 0), Math.max(Math.floor(height / 2 - y), 0)];
    return [left, bottom, Math.min(2 * x, width - left), Math.min(2 * y, height - bottom)];
  }

  /** Origin and direction of the ray through a place of the picture, from −1 to 1 to the right and up. */
  ray(x, y, width, height) {
    const { eye, right, up, backward, scale } = this.at(width, height);
    const aside = plus(times(right, x / scale[0]), up, y / scale[1]);
    return { origin: eye, direction: unit(plus(aside, backward, -1)) };
  }
}
