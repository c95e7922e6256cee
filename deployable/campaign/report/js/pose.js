// Where a run's particles, sections, points and hinges are at a time, between its frames.

const MOTION = DATA.motion;

class Pose {
  constructor(run) {
    this.run = run;
    const { particles, elements } = MOTION;
    this.place = new Float64Array(3 * particles);
    this.axes = new Float64Array(9 * particles); // rows of the rotation
    this.corners = new Float64Array(24 * elements); // element, end, corner, axis
    this.stress = new Float64Array(elements); // share of the largest
    this.tension = new Float64Array(MOTION.cables ? MOTION.cables.count : 0); // so is that; 0: slack
  }

  at(time) {
    const frames = MOTION.time, last = frames.length - 1;
    const from = Math.min(below(frames, time), Math.max(0, last - 1)), to = Math.min(from + 1, last);
    const span = frames[to] - frames[from];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - frames[from]) / span)) : 0;
    const { place, turn, stress } = this.run;
    const { particles, elements, low, unit } = MOTION;
    for (let p = 0; p < particles; p++) {
      for (let k = 0; k < 3; k++) {
        const one = place[3 * (from * particles + p) + k], two = place[3 * (to * particles + p) + k];
        this.place[3 * p + k] = low[k] + unit * (32767 + one + share * (two - one));
      }
      this.rotate(p, turn, 4 * (from * particles + p), 4 * (to * particles + p), share);
    }
    for (let e = 0; e < elements; e++) {
      const one = stress[from * elements + e], two = stress[to * elements + e];
      this.stress[e] = (one + share * (two - one)) / 65535;
      for (let end = 0; end < 2; end++) {
        const particle = MOTION.ends[2 * e + end];
        for (let corner = 0; corner < 4; corner++) {
          const at = 3 * (8 * e + 4 * end + corner);
          this.carry(particle, this.run.corners, at, this.corners, at);
        }
      }
    }
    const cables = this.tension.length;
    for (let c = 0; c < cables; c++) {
      const one = this.run.tension[from * cables + c], two = this.run.tension[to * cables + c];
      this.tension[c] = (one + share * (two - one)) / 65535;
    }
    return this;
  }

  // The rotation of particle p between two unit quaternions (x, y, z, w).
  rotate(p, q, one, two, share) {
    const dot = q[one] * q[two] + q[one + 1] * q[two + 1] + q[one + 2] * q[two + 2] + q[one + 3] * q[two + 3];
    const other = dot < 0 ? -share : share;
    let x = (1 - share) * q[one] + other * q[two], y = (1 - share) * q[one + 1] + other * q[two + 1];
    let z = (1 - share) * q[one + 2] + other * q[two + 2], w = (1 - share) * q[one + 3] + other * q[two + 3];
    const size = Math.hypot(x, y, z, w) || 1;
    x /= size; y /= size; z /= size; w /= size;
    this.axes.set([
      1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    ], 9 * p);
  }

  // Put the free end of an arm of a particle into out[to..to+2].
  carry(particle, arms, at, out, to) {
    for (let k = 0; k < 3; k++) {
      const row = 9 * particle + 3 * k;
      out[to + k] = this.place[3 * particle + k] + this.axes[row] * arms[at]
        + this.axes[row + 1] * arms[at + 1] + this.axes[row + 2] * arms[at + 2];
    }
  }

  point(index) {
    const out = [0, 0, 0];
    this.carry(MOTION.pointOn[index], MOTION.pointArm, 3 * index, out, 0);
    return out;
  }

  // Point `index` of all cables' points.
  cablePoint(index) {
    const out = [0, 0, 0];
    this.carry(MOTION.cables.on[index], MOTION.cables.arm, 3 * index, out, 0);
    return out;
  }

  // The ends of a piece of a hinge's line, `half` to either side.
  hinge(index, half) {
    const ends = [0, 0, 0, 0, 0, 0], arm = [0, 0, 0];
    for (const [end, sign] of [[0, -half], [1, half]]) {
      for (let k = 0; k < 3; k++) arm[k] = MOTION.hingeArm[3 * index + k] + sign * MOTION.hingeAxis[3 * index + k];
      this.carry(MOTION.hingeOn[index], arm, 0, ends, 3 * end);
    }
    return ends;
  }
}

// The middle of all frames of the first run, and the radius around it that holds them.
function extent() {
  const { place } = MOTION.runs[0], low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
  for (let i = 0; i < place.length; i++) {
    low[i % 3] = Math.min(low[i % 3], place[i]);
    high[i % 3] = Math.max(high[i % 3], place[i]);
  }
  const metres = (value, k) => MOTION.low[k] + MOTION.unit * (32767 + value);
  const middle = low.map((value, k) => 0.5 * (metres(value, k) + metres(high[k], k)));
  let square = 0, size = 0;
  for (let i = 0; i < place.length; i += 3) {
    let distance = 0;
    for (let k = 0; k < 3; k++) distance += (place[i + k] - 0.5 * (low[k] + high[k])) ** 2;
    square = Math.max(square, distance);
  }
  let radius = MOTION.unit * Math.sqrt(square) || 1;
  for (let e = 0; e < MOTION.elements; e++) {
    if (MOTION.ends[2 * e] === MOTION.ends[2 * e + 1]) continue; // a rigid body: as large as it is
    for (const value of MOTION.runs[0].corners.subarray(24 * e, 24 * e + 24)) size = Math.max(size, Math.abs(value));
  }
  size ||= 0.03 * radius;
  const every = Math.max(1, Math.ceil(place.length / 12000)), places = [];
  for (let i = 0; i < place.length / 3; i += every) {
    for (let k = 0; k < 3; k++) places.push(metres(place[3 * i + k], k));
  }
  for (const corner of bodyCorners()) {
    radius = Math.max(radius, Math.hypot(...corner.map((value, k) => value - middle[k])));
    places.push(...corner);
  }
  return { middle, radius: radius + 0.5 * size, size, places, floor: metres(low[2], 2) - 1.3 * size };
}

// Where the corners of rigid bodies, which reach beyond their particles, are at some moments.
function bodyCorners() {
  const found = [], pose = new Pose(MOTION.runs[0]), last = MOTION.time.length - 1;
  for (let e = 0; e < MOTION.elements; e++) {
    if (MOTION.ends[2 * e] !== MOTION.ends[2 * e + 1]) continue;
    for (let n = 0; n <= 8; n++) {
      pose.at(MOTION.time[Math.round(last * n / 8)]);
      for (let at = 24 * e; at < 24 * e + 24; at += 3) found.push([...pose.corners.slice(at, at + 3)]);
    }
  }
  return found;
}
