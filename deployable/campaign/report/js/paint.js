// Painting on a canvas: floor, shadow, and faces from far to near.

const LIGHT = [0.32, -0.48, 0.82];
const FACES = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]; // along an element
const CAPS = [[0, 3, 2, 1], [4, 5, 6, 7]]; // at the ends of a bar

// Viridis, whose order the colour-blind and a grey print keep.
const SCALE = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
  [92, 200, 99], [170, 220, 50], [253, 231, 37]];

function scaleColour(share) {
  const at = Math.min(1, Math.max(0, share)) * (SCALE.length - 1), index = Math.min(SCALE.length - 2, Math.floor(at));
  return SCALE[index].map((value, k) => value + (at - index) * (SCALE[index + 1][k] - value));
}

// The middle of the scale, which neither a light nor a dark page swallows.
const cableColour = (share) => scaleColour(0.3 + 0.5 * share).map(Math.round);

function rgb(colour) {
  const digitsOf = colour.replace("#", "");
  return [0, 2, 4].map((at) => parseInt(digitsOf.slice(at, at + 2), 16));
}

// Which ends of elements are ends of a bar, where a cap is drawn.
function capsOf() {
  return MOTION.bar.map((bar, e) => [MOTION.bar[e - 1] !== bar, MOTION.bar[e + 1] !== bar]);
}

class Painter {
  constructor() {
    this.poses = MOTION.runs.map((run) => new Pose(run));
    this.caps = capsOf();
    this.extent = extent();
    this.readColours();
  }

  readColours() {
    this.colours = MOTION.runs.map((_, i) => rgb(themeColour(i === 0 ? "--steel" : SHOWN.colour(i))));
    for (const name of ["edge", "floor", "shadow", "ink", "card", "soft"]) this[name] = themeColour(`--${name}`);
  }

  // Paint at a time the runs that are shown; options: byStress, names.
  paint(context, camera, width, height, time, options) {
    context.clearRect(0, 0, width, height);
    camera.aim(width, height, options.fill);
    this.paintFloor(context, camera, options);
    context.lineCap = context.lineJoin = "round";
    const ghosts = [], solid = [];
    this.poses.forEach((pose, i) => {
      if (!SHOWN.has(i)) return;
      pose.at(time);
      if (i === 0) this.paintShadow(context, camera, pose);
      this.addFaces(i ? ghosts : solid, camera, pose, i, options.byStress);
      if (MOTION.cables) this.addCables(i ? ghosts : solid, camera, pose, i > 0);
    });
    if (SHOWN.first) this.addHinges(solid, camera, this.poses[0]);
    for (const pieces of [ghosts, solid]) {
      pieces.sort((one, two) => one.depth - two.depth);
      for (const piece of pieces) this.paintPiece(context, piece);
    }
    for (const piece of ghosts) if (piece.outline) this.paintEdges(context, piece, 0.3); // shine through
    if (options.names && SHOWN.first) this.paintNames(context, camera);
  }

  addFaces(pieces, camera, pose, run, byStress) {
    const page = new Float64Array(pose.corners.length), { corners } = pose;
    for (let i = 0; i < corners.length; i += 3) camera.project(corners[i], corners[i + 1], corners[i + 2], page, i);
    const ghost = run > 0, plain = this.colours[run];
    for (let e = 0; e < MOTION.elements; e++) {
      const stressed = byStress && !ghost && MOTION.ends[2 * e] !== MOTION.ends[2 * e + 1]; // no rigid body
      const colour = stressed ? scaleColour(pose.stress[e] / this.topShare) : plain;
      const sides = FACES.map((face) => [face, false]);
      this.caps[e].forEach((capped, end) => capped && sides.push([CAPS[end], true]));
      for (const [face, isCap] of sides) {
        const at = face.map((corner) => 3 * (8 * e + corner));
        const normal = normalOf(corners, at);
        const facing = normal[0] * camera.towards[0] + normal[1] * camera.towards[1] + normal[2] * camera.towards[2];
        if (facing < -0.25) continue;
        const lit = Math.max(0, normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]);
        const bright = (byStress ? 0.82 : 0.7) + (byStress ? 0.22 : 0.42) * lit;
        const depth = 0.25 * at.reduce((sum, i) => sum + page[i + 2], 0);
        const fill = colour.map((value) => Math.min(255, Math.round(value * bright)));
        pieces.push({ depth, outline: at.map((i) => [page[i], page[i + 1]]), fill, ghost, isCap });
      }
    }
  }

  addHinges(pieces, camera, pose) {
    const page = [0, 0, 0, 0, 0, 0];
    for (let h = 0; h < MOTION.hinges.length; h++) {
      const ends = pose.hinge(h, 0.9 * this.extent.size);
      camera.project(ends[0], ends[1], ends[2], page, 0);
      camera.project(ends[3], ends[4], ends[5], page, 3);
      const depth = 0.5 * (page[2] + page[5]) + this.extent.size;
      pieces.push({ depth, line: page.slice(), width: Math.max(1.5, 0.22 * this.extent.size * camera.scale) });
    }
  }

  // Stretches of cables: by tension where they are tight, dashed where they are slack.
  addCables(pieces, camera, pose, ghost) {
    const { of } = MOTION.cables, page = [0, 0, 0, 0, 0, 0];
    for (let j = 1; j < of.length; j++) {
      if (of[j] !== of[j - 1]) continue;
      camera.project(...pose.cablePoint(j - 1), page, 0);
      camera.project(...pose.cablePoint(j), page, 3);
      const tension = pose.tension[of[j]], slack = !(tension > 0);
      const colour = slack ? this.soft : `rgb(${cableColour(tension).join(",")})`;
      const depth = 0.5 * (page[2] + page[5]), width = ghost ? 1 : 2;
      pieces.push({ depth, line: page.slice(), width, colour, dash: slack ? [4, 4] : [], alpha: ghost ? 0.4 : 1 });
    }
  }

  paintLine(context, { line, width, colour = this.ink, dash = [], alpha = 1 }) {
    context.moveTo(line[0], line[1]);
    context.lineTo(line[3], line[4]);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.globalAlpha = alpha;
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  paintPiece(context, piece) {
    context.beginPath();
    if (piece.line) {
      this.paintLine(context, piece);
      return;
    }
    const [a, b, c, d] = piece.outline;
    context.moveTo(...a); context.lineTo(...b); context.lineTo(...c); context.lineTo(...d); context.closePath();
    const colour = `rgb(${piece.fill.join(",")})`;
    context.globalAlpha = piece.ghost ? 0.22 : 1;
    context.fillStyle = context.strokeStyle = colour;
    context.fill();
    context.lineWidth = 0.7;
    if (!piece.ghost) context.stroke(); // closes the seams between elements
    this.paintEdges(context, piece, piece.ghost ? 0.8 : 0.6);
  }

  paintEdges(context, piece, alpha) {
    const [a, b, c, d] = piece.outline;
    context.strokeStyle = piece.ghost ? `rgb(${piece.fill.join(",")})` : this.edge;
    context.globalAlpha = alpha;
    context.beginPath();
    if (piece.isCap) {
      context.moveTo(...a); context.lineTo(...b); context.lineTo(...c); context.lineTo(...d); context.closePath();
    } else { // along the bar: corners run a b at one end, c d at the other
      context.moveTo(...b); context.lineTo(...c); context.moveTo(...d); context.lineTo(...a);
    }
    context.lineWidth = 0.8;
    context.stroke();
    context.globalAlpha = 1;
  }

  paintFloor(context, camera, { grid = true }) {
    if (!grid || camera.towards[2] < 0.02) return;
    const { middle, radius, floor } = this.extent, step = this.gridStep();
    const half = Math.ceil((1.25 * radius) / step);
    const x0 = Math.round(middle[0] / step), y0 = Math.round(middle[1] / step), page = [0, 0, 0, 0, 0, 0];
    context.strokeStyle = this.floor;
    context.lineWidth = 1;
    context.beginPath();
    for (let i = -half; i <= half; i++) {
      for (const along of [0, 1]) {
        const across = (along ? y0 : x0) + i;
        for (const end of [0, 1]) {
          const far = ((along ? x0 : y0) + (end ? half : -half)) * step;
          camera.project(along ? far : across * step, along ? across * step : far, floor, page, 3 * end);
        }
        context.moveTo(page[0], page[1]); context.lineTo(page[3], page[4]);
      }
    }
    context.stroke();
  }

  gridStep() {
    return roundStep(2.5 * this.extent.radius, 12);
  }

  paintShadow(context, camera, pose) {
    if (camera.towards[2] < 0.02) return;
    const page = [0, 0, 0];
    context.strokeStyle = this.shadow;
    context.lineCap = "round";
    context.lineWidth = Math.max(2, 1.6 * this.extent.size * camera.scale);
    context.beginPath();
    for (let e = 0; e < MOTION.elements; e++) {
      for (const end of [0, 1]) {
        const p = 3 * MOTION.ends[2 * e + end];
        camera.project(pose.place[p], pose.place[p + 1], this.extent.floor, page, 0);
        if (end) context.lineTo(page[0], page[1]);
        else if (!e || MOTION.ends[2 * e - 1] !== MOTION.ends[2 * e]) context.moveTo(page[0], page[1]);
      }
    }
    context.stroke();
  }

  paintNames(context, camera) {
    const page = [0, 0, 0], centre = [0, 0], places = MOTION.points.map((_, i) => {
      camera.project(...this.poses[0].point(i), page, 0);
      return [page[0], page[1]];
    });
    for (const place of places) { centre[0] += place[0] / places.length; centre[1] += place[1] / places.length; }
    context.font = "600 13px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 3.5;
    context.strokeStyle = this.card;
    context.fillStyle = this.ink;
    places.forEach(([x, y], i) => {
      let dx = x - centre[0], dy = y - centre[1];
      if (Math.hypot(dx, dy) < 1) [dx, dy] = [0, -1];
      const size = Math.hypot(dx, dy), away = 10 + 1.3 * this.extent.size * camera.scale;
      context.strokeText(MOTION.points[i], x + (away * dx) / size, y + (away * dy) / size);
      context.fillText(MOTION.points[i], x + (away * dx) / size, y + (away * dy) / size);
    });
  }
}

// The outer unit normal of a face whose corners start at the indices `at`.
function normalOf(corners, at) {
  const u = [0, 1, 2].map((k) => corners[at[2] + k] - corners[at[0] + k]);
  const v = [0, 1, 2].map((k) => corners[at[3] + k] - corners[at[1] + k]);
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const size = Math.hypot(...n) || 1;
  return n.map((value) => value / size);
}
