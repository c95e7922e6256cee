// The view from which the structure is seen: turn, height, zoom and shift; slight perspective.

const VIEWS = { free: [-0.95, 0.42], front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2] };
const DISTANCE = 5; // of the eye from the middle, in radii

class Camera {
  // places: coordinates, three by three, that the views are to hold; size: of what is around them.
  constructor({ middle, radius, places, size }) {
    Object.assign(this, { middle, radius, places, room: 2 * size });
    this.look("free");
  }

  look(name) {
    [this.azimuth, this.elevation] = VIEWS[name];
    this.zoom = 1;
    this.shift = [0, 0];
    this.fit();
  }

  // The middle and the size of all places as they are seen, on a page without scale.
  fit() {
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity], page = [0, 0, 0];
    this.face();
    Object.assign(this, { scale: 1, centre: [0, 0] });
    for (let i = 0; i < this.places.length; i += 3) {
      this.project(this.places[i], this.places[i + 1], this.places[i + 2], page, 0);
      for (let k = 0; k < 2; k++) {
        low[k] = Math.min(low[k], page[k]);
        high[k] = Math.max(high[k], page[k]);
      }
    }
    this.seen = { middle: [0, 1].map((k) => 0.5 * (low[k] + high[k])), size: [0, 1].map((k) => high[k] - low[k] + this.room || 1) };
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + up));
  }

  magnify(factor) {
    this.zoom = Math.min(40, Math.max(0.3, this.zoom * factor));
  }

  // The directions of the page in space.
  face() {
    const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
    const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    this.right = [-sa, ca, 0];
    this.towards = [ce * ca, ce * sa, se];
    this.up = [-se * ca, -se * sa, ce];
  }

  // Prepare for a canvas of this size (pixels); `fill` is the share that the places take.
  aim(width, height, fill = 0.78) {
    const { size, middle } = this.seen;
    this.face();
    this.scale = this.zoom * fill * Math.min(width / size[0], height / size[1]);
    this.centre = [width, height].map((whole, k) => whole / 2 + this.shift[k] * this.zoom - this.scale * middle[k]);
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
