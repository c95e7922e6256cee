// The view from which the structure is seen: turn, height, zoom and shift; slight perspective.

const VIEWS = { free: [-0.95, 0.42], front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2] };
const DISTANCE = 5; // of the eye from the middle, in radii

class Camera {
  constructor(middle, radius) {
    this.middle = middle;
    this.radius = radius;
    this.look("free");
  }

  look(name) {
    [this.azimuth, this.elevation] = VIEWS[name];
    this.zoom = 1;
    this.shift = [0, 0];
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + up));
  }

  magnify(factor) {
    this.zoom = Math.min(40, Math.max(0.3, this.zoom * factor));
  }

  // Prepare for a canvas of this size (pixels); `fill` is the share that the radius takes.
  aim(width, height, fill = 0.5) {
    const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
    const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    this.right = [-sa, ca, 0];
    this.towards = [ce * ca, ce * sa, se];
    this.up = [-se * ca, -se * sa, ce];
    this.scale = (this.zoom * fill * Math.min(width, 1.1 * height)) / this.radius;
    this.centre = [width / 2 + this.shift[0] * this.zoom, height / 2 + this.shift[1] * this.zoom];
  }

  // Page coordinates and depth (larger is nearer) of a place, into out[at..at+2].
  project(x, y, z, out, at) {
    const dx = x - this.middle[0], dy = y - this.middle[1], dz = z - this.middle[2];
    const { right, up, towards } = this;
    const depth = dx * towards[0] + dy * towards[1] + dz * towards[2];
    const scale = this.scale / Math.max(0.2, 1 - depth / (DISTANCE * this.radius));
    out[at] = this.centre[0] + scale * (dx * right[0] + dy * right[1]);
    out[at + 1] = this.centre[1] - scale * (dx * up[0] + dy * up[1] + dz * up[2]);
    out[at + 2] = depth;
  }
}
